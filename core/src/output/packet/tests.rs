use super::*;
use crate::frame_figures::Input;
use proptest::prelude::*;

const MOST: Counters = Counters {
    frames: u32::MAX,
    rows: u32::MAX,
    dropped_rows: u32::MAX,
    dropped_frames: u32::MAX,
    overruns: u32::MAX,
    short: u32::MAX,
    long: u32::MAX,
    stalled: u32::MAX,
    dma_errors: u32::MAX,
};
const WIDTH: usize = 1280;

/// Widths, and the bytes of the longest packet.
const MOST_BYTES: [(usize, usize); 3] = [(320, 1050), (640, 2013), (1280, 3941)];

struct Row {
    disparity: [Disparity; WIDTH],
    confidence: [u8; WIDTH],
    width: usize,
}

impl Row {
    fn of(pixels: impl IntoIterator<Item = (i16, u8)>) -> Self {
        let mut row = Self { disparity: [Disparity::UNKNOWN; WIDTH], confidence: [0; WIDTH], width: 0 };
        for (bits, confidence) in pixels {
            row.disparity[row.width] = Disparity::from_bits(bits);
            row.confidence[row.width] = confidence;
            row.width += 1;
        }
        row
    }

    fn row(&self, y: u32) -> DisparityRow<'_> {
        DisparityRow { y, disparity: &self.disparity[..self.width], confidence: &self.confidence[..self.width] }
    }

    /// Bytes of its packet, after checking that it comes back.
    fn through(&self) -> usize {
        let mut buffer = [0; max_bytes(1280)];
        let bytes = Encoder::new().row(5, self.row(9), &mut buffer).unwrap();
        let count = bytes.len();
        assert_eq!(bytes.iter().position(|&byte| byte == 0), Some(count - 1));
        let packet = Packet::decode(bytes).unwrap();
        assert_eq!((packet.sequence, packet.frame), (0, 5));
        self.check(&packet, 0);
        assert_eq!(packet.read_row(1, &mut [], &mut []), Err(PacketError::Width));
        count
    }

    /// Bytes of the packet of it and the row below, after checking that both come back; none if they do not go together.
    fn with(&self, below: &Self) -> Option<usize> {
        let mut buffer = [0; max_bytes(1280)];
        let mut encoder = Encoder::new();
        let (together, bytes) = encoder.rows(5, &[self.row(9), below.row(10)], &mut buffer).unwrap();
        if together == 1 {
            return None;
        }
        let count = bytes.len();
        assert_eq!(bytes.iter().position(|&byte| byte == 0), Some(count - 1));
        let packet = Packet::decode(bytes).unwrap();
        let width = u16::try_from(self.width).unwrap();
        assert_eq!(packet.content.rows(), Some(Rows { y: 9, count: 2, width }));
        self.check(&packet, 0);
        below.check(&packet, 1);
        Some(count)
    }

    /// Checks that a row of a packet is this one.
    fn check(&self, packet: &Packet<'_>, nth: u8) {
        let mut back = Self::of([(1, 1); WIDTH]);
        packet.read_row(nth, &mut back.disparity[..self.width], &mut back.confidence[..self.width]).unwrap();
        assert_eq!(back.disparity[..self.width], self.disparity[..self.width]);
        assert_eq!(back.confidence[..self.width], self.confidence[..self.width]);
    }
}

#[test]
fn a_row_of_holes_is_a_few_bytes_and_one_of_noise_the_most() {
    assert_eq!(Row::of([(i16::MIN, 0); 320]).through(), 16);
    let noise = (0..1280u16).map(|x| (x.wrapping_mul(40_503).cast_signed(), 1 + x.to_le_bytes()[0] % 255));
    for (width, most) in MOST_BYTES {
        let row = Row::of(noise.clone().take(width));
        assert!(row.through() <= most, "{width}: {}", row.through());
        assert!(row.through() > 3 * width);
        assert_eq!(max_bytes(u16::try_from(width).unwrap()), most);
    }
}

#[test]
fn packets_are_numbered_and_tell_begin_and_end() {
    let mut encoder = Encoder { sequence: u32::MAX };
    let mut buffer = [0; max_bytes(0)];
    let counters = Counters { frames: 3, ..Counters::ZERO };
    let begin = *Packet::decode(encoder.begin(7, [320, 240], &counters, &mut buffer).unwrap()).as_ref().unwrap();
    assert_eq!((begin.sequence, begin.frame), (u32::MAX, 7));
    assert_eq!(begin.content, Content::Begin { width: 320, height: 240, counters });
    let figures =
        FrameFigures { input: Input::Mismatch, mismatch: Some(u16::MAX), sure: u16::MAX, row_error_q8: Some(i16::MIN) };
    let told = FrameEnd { rows: u32::MAX, unsent_frames: u32::MAX, is_cut: true, figures: Some(figures) };
    let mut encoder = Encoder { sequence: u32::MAX };
    let bytes = encoder.end(u32::MAX, &told, &MOST, &mut buffer).unwrap();
    let longest = stuffing::gap(MAX_HEADER + CRC_BYTES) + MAX_HEADER + CRC_BYTES + 1;
    assert!((longest - 2..=longest).contains(&bytes.len()), "{} of {longest}", bytes.len());
    let end = *Packet::decode(bytes).as_ref().unwrap();
    assert_eq!(end.content, Content::End { end: told, counters: MOST });
    assert_eq!(end.read_row(0, &mut [], &mut []), Err(PacketError::Width));
    encoder.begin(0, [1, 1], &MOST, &mut buffer).unwrap();
    assert_eq!(encoder.sequence, 1);
}

#[test]
fn a_row_that_is_none_and_a_buffer_too_small_are_refused_and_use_no_number() {
    let mut encoder = Encoder::new();
    let row = DisparityRow { y: 0, disparity: &[Disparity::UNKNOWN; 4], confidence: &[0; 4] };
    let needed = max_bytes(4);
    let mut small = [0; max_bytes(4) - 1];
    let refused = encoder.row(0, row, &mut small).unwrap_err();
    assert_eq!(refused, PacketError::Buffer { needed, found: needed - 1 });
    let mut buffer = [0; max_bytes(4)];
    let odd = DisparityRow { confidence: &[0; 3], ..row };
    assert_eq!(encoder.row(0, odd, &mut buffer).unwrap_err(), PacketError::Row);
    for other in [odd, DisparityRow { y: 1, disparity: &[Disparity::UNKNOWN; 3], confidence: &[0; 3] }, row] {
        assert_eq!(encoder.rows(0, &[row, other], &mut buffer).unwrap_err(), PacketError::Row);
    }
    let below = DisparityRow { y: 1, ..row };
    let (together, bytes) = encoder.rows(0, &[row, below], &mut buffer).unwrap();
    assert_eq!(together, 1, "nothing is known");
    let packet = Packet::decode(bytes).unwrap();
    assert_eq!(packet.sequence, 0);
    assert_eq!(packet.read_row(0, &mut [Disparity::UNKNOWN; 5], &mut [0; 5]), Err(PacketError::Width));
}

#[test]
fn another_version_is_named_and_told_from_damage() {
    let mut buffer = [0; 16];
    for version in [1, 2, 16, 17] {
        let told = [9, 8, 7];
        let checksum = (CRC.checksum(&told) ^ mark(version)).to_le_bytes();
        buffer[4..7].copy_from_slice(&told);
        buffer[7..11].copy_from_slice(&checksum);
        let range = stuffing::stuff(&mut buffer, 4, 11).unwrap();
        let wanted = if version > 16 { PacketError::Damaged } else { PacketError::Version { found: version } };
        assert_eq!(Packet::decode(&mut buffer[range]), Err(wanted));
    }
}

#[test]
fn two_rows_of_cells_are_short() {
    // A slanted plane and a jump; what is right of it is a guess.
    let row = |below: i16| {
        let pixel = move |x: i16| match x {
            0..100 => (160 + 2 * (x / 4) + [0, 1, 1, 2][usize::try_from(x % 4).unwrap()] + below, 96),
            _ => (320 + below, 8),
        };
        Row::of((0..320).map(pixel))
    };
    assert!(row(0).with(&row(2)).unwrap() < 150);
    // A lower row of its own costs more, one of another confidence does not go along.
    assert!(row(0).with(&row(1)).unwrap() > 400);
    let mut other = row(2);
    other.confidence[7] = 97;
    assert_eq!(row(0).with(&other), None);
    other.confidence[7] = 96;
    other.disparity[319] = Disparity::UNKNOWN;
    assert_eq!(row(0).with(&other), None);
}

#[test]
fn four_rows_of_cells_are_hardly_longer_than_two() {
    let row_of = |y: i16| {
        Row::of((0..318).map(|x| (160 + 2 * (x / 4) + [0, 1, 1, 2][usize::try_from(x % 4).unwrap()] + 4 * y, 96)))
    };
    let all = [0, 1, 2, 3].map(row_of);
    let mut buffer = [0; max_bytes(1280)];
    let mut length = |rows: &[Row; 4], count: usize| {
        let rows = &rows[..count];
        let told = [0, 1, 2, 3].map(|nth| rows[nth.min(count - 1)].row(9 + u32::try_from(nth).unwrap()));
        let (together, bytes) = Encoder::new().rows(5, &told[..count], &mut buffer).unwrap();
        let length = bytes.len();
        let packet = Packet::decode(bytes).unwrap();
        assert_eq!(packet.content, Content::Cells { y: 9, width: 318, rows: u8::try_from(together).unwrap() });
        (0..).zip(&rows[..together]).for_each(|(nth, row)| row.check(&packet, nth));
        (together, length)
    };
    assert_eq!(length(&all, 4), (4, length(&all, 2).1));
    // What does not go on as it begins is no row of cells: in a whole cell, at the end, in its confidence.
    for (row, column) in [(2, 0), (3, 317), (2, 316), (3, 5)] {
        let mut other = [0, 1, 2, 3].map(row_of);
        other[row].disparity[column] = Disparity::from_bits(7);
        assert_eq!(length(&other, 4).0, 2);
        let mut other = [0, 1, 2, 3].map(row_of);
        other[row].confidence[column] = 95;
        assert_eq!(length(&other, 4).0, 2);
    }
    assert!(Encoder::new().rows(0, &[], &mut buffer).is_err());
}

#[test]
fn one_wrong_byte_anywhere_is_noticed() {
    let row = Row::of((0..40).map(|x| (x / 4, 9)));
    let mut buffer = [0; max_bytes(40)];
    let bytes = Encoder::new().row(5, row.row(9), &mut buffer).unwrap();
    for at in 0..bytes.len() - 1 {
        for flip in [1, 0x10, 0x80, 0xFF] {
            let mut wrong = [0; max_bytes(40)];
            let wrong = &mut wrong[..bytes.len()];
            wrong.copy_from_slice(bytes);
            wrong[at] ^= flip;
            assert!(Packet::decode(wrong).is_err(), "byte {at} ^ {flip:#x}");
        }
    }
}

/// Steps and runs of every size, and pixels a method never delivers.
fn pixels() -> impl Strategy<Value = (i16, u8, usize)> {
    let bits = prop_oneof![Just(i16::MIN), -8i16..8, -200i16..200, any::<i16>()];
    let length = prop_oneof![1usize..6, 1usize..40, 1usize..700];
    (bits, prop_oneof![Just(0), any::<u8>()], length)
}

proptest! {
    #[test]
    fn every_whole_row_comes_back_exactly(steps in prop::collection::vec((-40i16..40, any::<u8>(), 1usize..9), 1..60)) {
        let mut bits = 0;
        let pixels = steps.iter().flat_map(|&(step, confidence, length)| {
            bits += step;
            let level = bits;
            (0i16..).zip(core::iter::repeat_n(confidence, length)).map(move |(i, confidence)| (level + i % 3, confidence))
        });
        Row::of(pixels.take(WIDTH)).through();
    }

    #[test]
    fn every_row_comes_back_exactly(runs in prop::collection::vec(pixels(), 0..40)) {
        let pixels = runs.iter().flat_map(|&(bits, confidence, length)| (0..length).map(move |_| (bits, confidence)));
        Row::of(pixels.take(WIDTH)).through();
    }

    #[test]
    fn every_row_without_any_order_comes_back_exactly(pixels in prop::collection::vec(any::<(i16, u8)>(), 0..80)) {
        Row::of(pixels).through();
    }

    #[test]
    fn every_two_rows_come_back_exactly_or_are_refused(
        cells in prop::collection::vec((-30i16..30, -12i16..13, -7i16..8, 0u8..14, 0u8..40), 1..90),
        cut in 0usize..4,
        bits in prop_oneof![Just(0i16), any::<i16>()],
    ) {
        let (mut before, mut upper, mut lower) = (bits, [(0, 0); 360], [(0, 0); 360]);
        for (nth, &(step, far, down, sure, odd)) in cells.iter().enumerate() {
            let first = before.wrapping_add(step);
            let near = (2 * far + 3).div_euclid(6);
            let mut columns = [0, far - near, far + near, 2 * far].map(|column| first.wrapping_add(column));
            let mut down = [2 * down; 4];
            let mut sures = [8 * sure; 4];
            // Some cells are not as they mostly are.
            match odd {
                0..4 => columns[usize::from(odd)] = before,
                4..6 => down[usize::from(odd - 4)] += 1,
                6..9 => sures[usize::from(odd - 6)] = 8,
                9 => sures = [sure, 9 * sure, 8, 1],
                10 => columns[1] = bits,
                _ => {}
            }
            before = columns[3];
            for i in 0..4 {
                upper[4 * nth + i] = (columns[i], sures[i]);
                lower[4 * nth + i] = (columns[i].wrapping_add(down[i]), sures[i]);
            }
        }
        let width = 4 * cells.len() - cut;
        let rows = [upper, lower].map(|row| Row::of(row[..width].iter().copied()));
        let has_unknown = rows.iter().any(|row| row.disparity[..width].contains(&Disparity::UNKNOWN));
        let count = rows[0].with(&rows[1]);
        // Each cell that is not as they mostly are takes more; of a few cells more may be so.
        let is_mostly_odd = 2 * cells.iter().filter(|cell| cell.4 <= 10).count() > cells.len();
        prop_assert!(count.is_some() || has_unknown || is_mostly_odd || width < 80);
        rows[0].through();
    }

    #[test]
    fn every_two_rows_without_any_order_come_back_exactly_or_are_refused(
        pixels in prop::collection::vec((any::<i16>(), any::<i16>(), any::<u8>()), 0..80),
    ) {
        let upper = Row::of(pixels.iter().map(|&(bits, _, sure)| (bits, sure)));
        let lower = Row::of(pixels.iter().map(|&(_, bits, sure)| (bits, sure)));
        upper.with(&lower);
    }

    #[test]
    fn no_bytes_make_the_decoder_fail(
        mut bytes in prop::collection::vec(any::<u8>(), 0..200),
        nth in any::<u8>(),
        width in 0usize..300,
    ) {
        let (mut disparity, mut confidence) = ([Disparity::UNKNOWN; 300], [0; 300]);
        let room = (&mut disparity[..width], &mut confidence[..width]);
        // What a sender with another idea of the form might have put under a right checksum.
        let _ = cells::read(&bytes, nth, room.0, room.1);
        let _ = runs::read_runs(&bytes, room.0, room.1);
        let _ = runs::read_plain(&bytes, room.0, room.1);
        let _ = Packet::decode(&mut bytes);
    }
}
