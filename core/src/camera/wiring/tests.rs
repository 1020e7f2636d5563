use super::*;
use proptest::prelude::*;

const SKEWS: [Skew; 3] = [Skew::None, Skew::Left, Skew::Right];

fn wirings() -> impl Iterator<Item = Wiring> {
    let kinds = Kind::ALL.iter().flat_map(|&kind| First::ALL.iter().map(move |&first| (kind, first)));
    kinds.flat_map(|(kind, first)| SKEWS.map(|skew| Wiring { kind, first, skew }))
}

/// What is left of a pixel when it comes out again.
fn kept(kind: Kind, pixel: u8) -> u8 {
    if kind == Kind::Pairs14 { pixel & 0xFE } else { pixel }
}

fn unpacked(wiring: Wiring, raw: &[u8]) -> ([u8; 3], [u8; 3]) {
    let (mut left, mut right) = ([0; 3], [0; 3]);
    wiring.unpack(raw, &mut left, &mut right).unwrap();
    (left, right)
}

#[test]
fn every_kind_stores_a_row_in_its_order() {
    let pair = ScanlinePair { left: &[0x1A, 0x2B, 0x3C], right: &[0x4D, 0x5E, 0x6F] };
    let cases = [
        (Kind::PixelInterleaved, [0x1A, 0x4D, 0x2B, 0x5E, 0x3C, 0x6F], [0x4D, 0x1A, 0x5E, 0x2B, 0x6F, 0x3C]),
        (Kind::LineInterleaved, [0x1A, 0x2B, 0x3C, 0x4D, 0x5E, 0x6F], [0x4D, 0x5E, 0x6F, 0x1A, 0x2B, 0x3C]),
        (Kind::SideBySide, [0x1A, 0x2B, 0x3C, 0x4D, 0x5E, 0x6F], [0x4D, 0x5E, 0x6F, 0x1A, 0x2B, 0x3C]),
        (Kind::Nibbles, [0x41, 0xDA, 0x52, 0xEB, 0x63, 0xFC], [0x14, 0xAD, 0x25, 0xBE, 0x36, 0xCF]),
        (Kind::Pairs16, [0x1A, 0x4D, 0x2B, 0x5E, 0x3C, 0x6F], [0x4D, 0x1A, 0x5E, 0x2B, 0x6F, 0x3C]),
        // 0x26 << 7 | 0x0D, 0x2F << 7 | 0x15, 0x37 << 7 | 0x1E, and the other way round.
        (Kind::Pairs14, [0x0D, 0x13, 0x95, 0x17, 0x9E, 0x1B], [0xA6, 0x06, 0xAF, 0x0A, 0x37, 0x0F]),
    ];
    for (kind, left_first, right_first) in cases {
        for (first, raw) in [(First::Left, left_first), (First::Right, right_first)] {
            let wiring = Wiring::new(kind, first);
            let mut stored = [0; 6];
            wiring.pack(pair, &mut stored).unwrap();
            assert_eq!(stored, raw, "{wiring:?}");
            let (left, right) = unpacked(wiring, &raw);
            let whole = |view: &[u8]| [0, 1, 2].map(|x| kept(kind, view[x]));
            assert_eq!((left, right), (whole(pair.left), whole(pair.right)), "{wiring:?}");
        }
    }
}

#[test]
fn a_late_camera_is_moved_back_and_its_last_pixel_repeats() {
    let wiring = |first, skew| Wiring { kind: Kind::PixelInterleaved, first, skew };
    // 99 stands for whatever the port holds before the late camera's first pixel.
    assert_eq!(unpacked(wiring(First::Left, Skew::Left), &[99, 4, 1, 5, 2, 6]), ([1, 2, 2], [4, 5, 6]));
    assert_eq!(unpacked(wiring(First::Left, Skew::Right), &[1, 99, 2, 4, 3, 5]), ([1, 2, 3], [4, 5, 5]));
    assert_eq!(unpacked(wiring(First::Right, Skew::Left), &[4, 99, 5, 1, 6, 2]), ([1, 2, 2], [4, 5, 6]));
    assert_eq!(unpacked(wiring(First::Right, Skew::Right), &[99, 1, 4, 2, 5, 3]), ([1, 2, 3], [4, 5, 5]));
    let mut raw = [0; 6];
    let pair = ScanlinePair { left: &[1, 2, 3], right: &[4, 5, 6] };
    wiring(First::Right, Skew::Left).pack(pair, &mut raw).unwrap();
    assert_eq!(raw, [4, 1, 5, 1, 6, 2]);
}

#[test]
fn skew_has_an_effect_on_pixels_by_turns_only() {
    for wiring in wirings().filter(|wiring| wiring.kind != Kind::PixelInterleaved) {
        let plain = Wiring { skew: Skew::None, ..wiring };
        assert_eq!(unpacked(wiring, &[1, 2, 3, 4, 5, 6]), unpacked(plain, &[1, 2, 3, 4, 5, 6]), "{wiring:?}");
    }
}

#[test]
fn lengths_that_are_no_row_are_refused_with_what_was_expected() {
    for wiring in wirings() {
        let mut view = [0; 4];
        let mut refused = |raw: &[u8], right: &mut [u8]| {
            let error = wiring.unpack(raw, &mut view, right).unwrap_err();
            assert_eq!(wiring.pair(raw, &mut [0; 4], right).unwrap_err(), error);
            error
        };
        assert_eq!(refused(&[0; 6], &mut [0; 4]), WiringError::Length { expected: 8, found: 6 });
        assert_eq!(refused(&[0; 9], &mut [0; 4]), WiringError::Odd { found: 9 });
        assert_eq!(refused(&[0; 8], &mut [0; 5]), WiringError::Views { left: 4, right: 5 });
        let pair = ScanlinePair { left: &[0; 4], right: &[0; 4] };
        assert_eq!(wiring.pack(pair, &mut [0; 10]), Err(WiringError::Length { expected: 8, found: 10 }));
    }
}

#[test]
fn a_row_is_two_lines_where_lines_alternate_and_one_elsewhere() {
    for wiring in wirings() {
        let lines = if wiring.kind == Kind::LineInterleaved { 2 } else { 1 };
        assert_eq!((wiring.lines_per_row(), wiring.line_bytes(320)), (lines, 640 / lines));
        assert_eq!(wiring.line_bytes(u16::MAX) * lines, wiring.row_bytes(u16::MAX));
    }
}

#[test]
fn names_are_unique_and_found_again() {
    assert!(Kind::ALL.iter().all(|&kind| Kind::from_name(kind.name()) == Some(kind)));
    assert!(First::ALL.iter().all(|&first| First::from_name(first.name()) == Some(first)));
    assert!(Skew::ALL.iter().all(|&skew| Skew::from_name(skew.name()) == Some(skew)));
    assert_eq!(Kind::from_name("frame"), None);
}

proptest! {
    #[test]
    fn a_packed_row_comes_back_but_for_the_late_camera_s_last_pixel(
        views in prop::collection::vec(any::<(u8, u8)>(), 0..70)
    ) {
        let (mut pixels, mut back, mut raw) = ([[0; 70]; 2], [[0; 70]; 2], [0; 140]);
        let width = views.len();
        for (x, &(left, right)) in views.iter().enumerate() {
            (pixels[0][x], pixels[1][x]) = (left, right);
        }
        for wiring in wirings() {
            let mut expected = pixels.map(|view| view.map(|pixel| kept(wiring.kind, pixel)));
            if wiring.kind == Kind::PixelInterleaved && width > 1 {
                match wiring.skew {
                    Skew::None => {}
                    Skew::Left => expected[0][width - 1] = expected[0][width - 2],
                    Skew::Right => expected[1][width - 1] = expected[1][width - 2],
                }
            }
            let raw = &mut raw[..2 * width];
            wiring.pack(ScanlinePair { left: &pixels[0][..width], right: &pixels[1][..width] }, raw).unwrap();
            let [left, right] = &mut back;
            let pair = wiring.pair(raw, &mut left[..width], &mut right[..width]).unwrap();
            prop_assert_eq!((pair.left, pair.right), (&expected[0][..width], &expected[1][..width]), "{:?}", wiring);
            let [left, right] = &mut back;
            wiring.unpack(raw, &mut left[..width], &mut right[..width]).unwrap();
            prop_assert_eq!((&left[..width], &right[..width]), (&expected[0][..width], &expected[1][..width]));
        }
    }

    #[test]
    fn any_bytes_unpack_and_pack_to_the_same_bytes(raw in prop::collection::vec(any::<u8>(), 0..70)) {
        let (mut left, mut right, mut back) = ([0; 35], [0; 35], [0; 70]);
        let raw = &raw[..raw.len() & !1];
        let width = raw.len() / 2;
        // Fourteen lines hold no sixteen bits.
        let is_whole = |wiring: &Wiring| wiring.skew == Skew::None && wiring.kind != Kind::Pairs14;
        for wiring in wirings().filter(is_whole) {
            wiring.unpack(raw, &mut left[..width], &mut right[..width]).unwrap();
            let pair = ScanlinePair { left: &left[..width], right: &right[..width] };
            wiring.pack(pair, &mut back[..raw.len()]).unwrap();
            prop_assert_eq!(&back[..raw.len()], raw);
        }
    }
}
