extern crate std;

use super::lane::Camera;
use super::*;
use crate::{Depth, Disparity, DisparityRow, Rig, blocks_for};
use core::ops::Range;
use proptest::prelude::*;
use std::vec::Vec;

const WIDTH: usize = 160;
const HEIGHT: u16 = 120;
const SECTORS: usize = 9;
const SIZE_PX: [u16; 2] = [160, HEIGHT];

type Finder = Obstacles<SECTORS, { blocks_for(160) }>;

/// 100 px, 60 mm: 77 degrees wide.
fn rig() -> Rig {
    Rig::new(100 << 8, 60_000).unwrap()
}

#[expect(clippy::cast_possible_truncation, reason = "small figures of a test")]
fn mounting(height_mm: i32, pitch_deg: f64) -> Mounting {
    let (sin, cos) = pitch_deg.to_radians().sin_cos();
    let q14 = |value: f64| (value * 16384.0).round() as i16;
    Mounting { height_mm, sin_pitch_q14: q14(sin), cos_pitch_q14: q14(cos), lowest_mm: 60, highest_mm: 500 }
}

/// `N` sectors of which the first `count` are 10 degrees each, the middle one straight ahead.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small figures of a test")]
fn sectors<const N: usize>(count: u8) -> Sectors<N> {
    let left = |i: u8| (f64::from(i) * 10.0 - f64::from(count) * 5.0).to_radians();
    let mut sectors = Sectors { count: count.into(), left_q16: [0; N], right_q16: 0, secant_q14: [0; N] };
    for ((i, border), secant) in (0..count).zip(&mut sectors.left_q16).zip(&mut sectors.secant_q14) {
        *border = (left(i).tan() * 65536.0).round() as i32;
        *secant = (16384.0 / ((left(i) + left(i + 1)) / 2.0).cos()).round() as u32;
    }
    sectors.right_q16 = (left(count).tan() * 65536.0).round() as i32;
    sectors
}

fn finder(mounting: Mounting) -> Finder {
    Obstacles::new(SIZE_PX, rig(), mounting, sectors(9), Settings::DEFAULT).unwrap()
}

type Map = Vec<[Disparity; WIDTH]>;

fn map(mut disparity: impl FnMut(usize, usize) -> Option<f64>) -> Map {
    #[expect(clippy::cast_possible_truncation, reason = "disparities of a test")]
    let bits = |px: f64| Disparity::from_bits((px * 16.0).round() as i16);
    let mut pixel = |x, y| disparity(x, y).map_or(Disparity::UNKNOWN, bits);
    (0..usize::from(HEIGHT)).map(|y| std::array::from_fn(|x| pixel(x, y))).collect()
}

fn find<const S: usize, const B: usize>(finder: &mut Obstacles<S, B>, map: &Map) -> Vec<Option<u32>> {
    for (y, disparity) in (0..).zip(map) {
        finder.push(&DisparityRow { y, disparity, confidence: &[200; WIDTH] });
    }
    finder.nearest_mm().collect()
}

/// Disparity of the ground in row `y`, px: focal length x baseline / depth, where the ray meets the ground.
fn ground(mounting: &Mounting, y: usize) -> Option<f64> {
    let (sin, cos) = (f64::from(mounting.sin_pitch_q14) / 16384.0, f64::from(mounting.cos_pitch_q14) / 16384.0);
    let rise = sin - (f64::from(u32::try_from(y).unwrap()) - 59.5) / 100.0 * cos;
    (rise < 0.0).then(|| 100.0 * 60.0 * -rise / f64::from(mounting.height_mm))
}

#[test]
fn a_wall_is_an_obstacle_in_every_sector_at_its_range() {
    let found = find(&mut finder(mounting(300, 0.0)), &map(|_, _| Some(4.0)));
    let middle = |i: usize| (f64::from(u8::try_from(i).unwrap()) * 10.0 - 40.0).to_radians().cos();
    for (i, range) in found.into_iter().enumerate() {
        let (range, wanted) = (f64::from(range.unwrap()), 1500.0 / middle(i));
        assert!((range - wanted).abs() < 2.0, "sector {i}: {range} mm for {wanted}");
    }
}

#[test]
fn what_is_unknown_uncertain_or_infinitely_far_is_no_obstacle() {
    let mut finder = finder(mounting(300, 0.0));
    let unknown = [None; SECTORS];
    assert_eq!(find(&mut finder, &map(|_, _| None)), unknown);
    assert_eq!(find(&mut finder, &map(|_, _| Some(0.0))), unknown);
    assert_eq!(find(&mut finder, &map(|_, _| Some(-3.0))), unknown);
    for y in 0..u32::from(HEIGHT) {
        finder.push(&DisparityRow { y, disparity: &[Disparity::from_px(4); WIDTH], confidence: &[55; WIDTH] });
    }
    assert!(finder.nearest_mm().all(|mm| mm.is_none()));
}

#[test]
fn only_what_lies_in_the_band_of_heights_is_in_the_way() {
    // At 1.5 m a row is 15 mm; the camera is 300 mm high in row 59.5.
    for (rows, is_obstacle) in [(0..40, false), (48..60, true), (60..72, true), (80..120, false)] {
        let seen = map(|x, y| (rows.contains(&y) && (70..90).contains(&x)).then_some(4.0));
        let found = find(&mut finder(mounting(300, 0.0)), &seen);
        assert_eq!(found[4].is_some(), is_obstacle, "rows {rows:?}: {found:?}");
        assert!(found[..3].iter().chain(&found[6..]).all(Option::is_none));
    }
}

#[test]
fn fewer_blocks_than_must_agree_are_not_believed() {
    let box_of = |columns: usize, rows: usize, px: f64| {
        let seen = map(move |x, y| {
            let inside = (76..76 + 4 * columns).contains(&x) && (52..52 + 4 * rows).contains(&y);
            if inside { Some(px) } else { Some(2.0) }
        });
        find(&mut finder(mounting(300, 0.0)), &seen)[4].unwrap()
    };
    assert_eq!([box_of(1, 1, 9.0), box_of(1, 4, 9.0), box_of(3, 1, 9.0), box_of(2, 2, 9.0)], [3000; 4]);
    assert_eq!([box_of(1, 5, 10.0), box_of(3, 2, 10.0), box_of(2, 3, 10.0)], [600; 3]);
}

#[test]
fn a_pitched_camera_sees_the_same_ground_and_the_same_post() {
    for pitch in [-20.0, -10.0, 0.0, 8.0_f64] {
        let mounting = mounting(300, pitch);
        let (sin, cos) = pitch.to_radians().sin_cos();
        let post = |y: usize| {
            let v = (f64::from(u32::try_from(y).unwrap()) - 59.5) / 100.0;
            // Ahead is 1.5 m = depth (cos + v sin); height is 300 mm + depth (sin - v cos).
            let depth = 1500.0 / (cos + v * sin);
            (0.0..400.0).contains(&(300.0 + depth * (sin - v * cos))).then_some(6000.0 / depth)
        };
        let seen = map(|x, y| post(y).filter(|_| (74..86).contains(&x)).or_else(|| ground(&mounting, y)));
        let found = find(&mut finder(mounting), &seen);
        let middle = found[4].unwrap();
        assert!((1480..1520).contains(&middle), "{pitch} degrees: {found:?}");
        assert_eq!(found.iter().filter(|mm| mm.is_some()).count(), 1, "{pitch} degrees: {found:?}");
    }
}

/// Which of the sectors are free up to 4 m, of a map of that confidence.
fn free(seen: &Map, confidence: u8) -> Vec<bool> {
    let settings = Settings { free_beyond_mm: 4000, ..Settings::DEFAULT };
    let mut finder = Finder::new(SIZE_PX, rig(), mounting(300, 0.0), sectors(9), settings).unwrap();
    for (y, disparity) in (0..).zip(seen) {
        finder.push(&DisparityRow { y, disparity, confidence: &[confidence; WIDTH] });
    }
    finder.free().collect()
}

#[test]
fn a_sector_is_free_where_it_is_measured_and_empty_and_only_if_that_was_asked() {
    // Ground, and a wall at 8 m.
    let level = mounting(300, 0.0);
    let open = |y: usize| Some(ground(&level, y).unwrap_or(0.0).max(0.75));
    assert_eq!(free(&map(|_, y| open(y)), 64), [true; SECTORS]);
    // Not sure, or not measured at all, or only the ground.
    assert_eq!(free(&map(|_, y| open(y)), 63), [false; SECTORS]);
    assert_eq!(free(&map(|_, _| None), 64), [false; SECTORS]);
    assert_eq!(free(&map(|_, y| ground(&level, y)), 64), [false; SECTORS]);
    // A wall at 3 m, and one at 8 m before which the ground is not seen.
    assert_eq!(free(&map(|_, y| Some(ground(&level, y).unwrap_or(0.0).max(2.0))), 64), [false; SECTORS]);
    assert_eq!(free(&map(|_, y| (y < 62).then_some(0.75)), 64), [false; SECTORS]);
    // A post at 1.5 m takes its sector only; so does a hole of a quarter of the one ahead.
    let post = map(|x, y| if (74..86).contains(&x) && y < 80 { Some(4.0) } else { open(y) });
    assert_eq!(free(&post, 64), [true, true, true, true, false, true, true, true, true]);
    let hole = map(|x, y| if (74..82).contains(&x) { None } else { open(y) });
    assert_eq!(free(&hole, 64), [true, true, true, true, false, true, true, true, true]);
    let mut finder = finder(level);
    find(&mut finder, &map(|_, y| open(y)));
    assert!(finder.free().all(|free| !free));
}

/// What is told of a wall at 3 m before which, in those columns and rows, something of `px` is answered with `confidence`.
fn told_of(columns: Range<usize>, rows: Range<usize>, px: f64, confidence: u8) -> Vec<Option<u32>> {
    told_by(finder(mounting(300, 0.0)), columns, rows, px, confidence)
}

/// The same by a finder of another mounting.
fn told_by(finder: Finder, columns: Range<usize>, rows: Range<usize>, px: f64, confidence: u8) -> Vec<Option<u32>> {
    told(finder, |x, y| if columns.contains(&x) && rows.contains(&y) { (px, confidence) } else { (2.0, 200) })
}

/// What is told of a map of disparities, px, and confidences.
fn told(mut finder: Finder, answer: impl Fn(usize, usize) -> (f64, u8)) -> Vec<Option<u32>> {
    for (y, disparity) in map(|x, y| Some(answer(x, y).0)).iter().enumerate() {
        let confidence: [u8; WIDTH] = std::array::from_fn(|x| answer(x, y).1);
        finder.push(&DisparityRow { y: u32::try_from(y).unwrap(), disparity, confidence: &confidence });
    }
    finder.nearest_mm().collect()
}

#[test]
fn many_doubtful_answers_nearer_than_what_is_sure_make_a_sector_unknown() {
    // The middle sector, of 10 degrees, are columns 71 to 88; the wall is in the band of heights in rows 53 to 67.
    let middle = |px: f64, confidence: u8| told_of(72..80, 52..68, px, confidence)[4];
    assert_eq!(middle(4.0, 64), Some(1500));
    assert_eq!(middle(4.0, 40), None);
    // A guess says nothing, nor what is not nearer by a sixteenth.
    assert_eq!(middle(4.0, 15), Some(3000));
    assert_eq!([middle(2.1, 40), middle(2.4, 40)], [Some(3000), None]);
    // Four blocks make a chain, and two rows of such chains are needed.
    assert_eq!(told_of(76..80, 48..68, 10.0, 40)[4], None);
    assert_eq!(told_of(76..80, 52..68, 10.0, 40)[4], Some(3000));
    assert_eq!(told_of(60..100, 56..60, 10.0, 40)[4], Some(3000));
    // The sectors beside tell what stands in them, unless that may be its outline.
    let unknown = |wall: f64, px: f64| {
        let is_thing = |x, y| (72..80).contains(&x) && (36..84).contains(&y);
        let told = told(finder(mounting(300, 0.0)), |x, y| if is_thing(x, y) { (px, 40) } else { (wall, 200) });
        told.iter().filter(|mm| mm.is_none()).count()
    };
    assert_eq!([unknown(4.25, 6.0), unknown(2.0, 3.0), unknown(2.0, 5.0)], [1, 3, 1]);
}

#[test]
fn a_gap_in_which_something_may_be_hidden_makes_a_sector_unknown() {
    // Guesses in so many columns under two rows of blocks of the wall, and over the rest of it.
    let middle = |columns: usize, rows: usize| told_of(72..72 + columns, 60..60 + rows, 2.0, 8)[4];
    // 480 mm are 16 px at 3 m.
    assert_eq!([middle(16, 20), middle(16, 12), middle(12, 20)], [None, Some(3000), Some(3000)]);
    // As many rows tell of the wall.
    assert_eq!(told_of(72..88, 68..84, 2.0, 8)[4], None);
    let high = finder(Mounting { highest_mm: 2000, ..mounting(300, 0.0) });
    assert_eq!(told_by(high, 72..88, 60..80, 2.0, 8)[4], Some(3000));
}

#[test]
fn what_few_rows_tell_when_others_tell_something_farther_is_unknown() {
    // Sure before a wall at 2 px, six columns of blocks wide, so many rows high: the first row makes no chain.
    let high = Mounting { highest_mm: 2000, ..mounting(300, 0.0) };
    let middle = |rows: usize, px: f64| told_by(finder(high), 68..92, 40..40 + 4 * rows, px, 64)[4];
    assert_eq!([2, 3, 4].map(|rows| middle(rows, 3.25)), [None, None, Some(1846)]);
    // A wall of no more rows than the thing.
    assert_eq!(told_of(68..92, 52..64, 3.25, 64)[4], Some(1846));
    // What is no nearer than by a sixth counts as the same.
    assert_eq!(middle(2, 2.25), Some(2666));
    // From 3.5 px on it is told, unless a sector beside it is unknown; from 4 px on it is told.
    let beside_unknown = |px: f64| {
        told(finder(high), |x, y| match x {
            68..88 if (52..60).contains(&y) => (px, 64),
            0..88 => (2.0, 200),
            _ => (2.0, 8),
        })[4]
    };
    assert_eq!([middle(2, 3.75), beside_unknown(3.75), beside_unknown(4.25)], [Some(1600), None, Some(1411)]);
}

#[test]
fn what_sure_blocks_lead_to_step_by_step_is_unknown_unless_enough_of_it_agree() {
    // A wall at 2 px and, so many block rows high, a column of blocks at 2.8 px beside one at 3.6 px.
    let middle = |rows: usize| {
        let is_thing = |y: usize| (52..52 + 4 * rows).contains(&y);
        let px = |x: usize| if (72..76).contains(&x) { 2.8 } else { 3.6 };
        let seen = map(|x, y| Some(if is_thing(y) && (72..80).contains(&x) { px(x) } else { 2.0 }));
        find(&mut finder(mounting(300, 0.0)), &seen)[4]
    };
    // One row is not believed at all.
    assert_eq!([1, 2, 3].map(middle), [Some(3000), None, Some(1655)]);
}

#[test]
fn what_is_near_must_be_of_more_blocks_and_no_lone_column() {
    // Sure before a wall, so many blocks wide and high.
    let middle = |columns: usize, rows: usize, px: f64| told_of(76..76 + 4 * columns, 40..40 + 4 * rows, px, 64)[4];
    // 40 px are seven blocks. What is less is not told, nor is the wall.
    assert_eq!([middle(2, 4, 40.0), middle(2, 3, 40.0)], [Some(150), None]);
    assert_eq!([middle(1, 12, 40.0), middle(1, 12, 31.0), middle(1, 5, 31.0)], [None, Some(193), None]);
}

#[test]
fn what_is_sure_in_three_times_as_many_rows_outweighs_doubt() {
    // A wall at 1 m, in the band of heights in rows 40 to 83, eleven of blocks; and columns of doubt before it.
    let told = |rows: std::ops::Range<usize>| {
        let mut finder = finder(mounting(300, 0.0));
        for y in 0..usize::from(HEIGHT) {
            let is_doubtful = |x: usize| (76..80).contains(&x) && rows.contains(&y);
            let disparity: [Disparity; WIDTH] =
                std::array::from_fn(|x| Disparity::from_px(if is_doubtful(x) { 10 } else { 6 }));
            let confidence: [u8; WIDTH] = std::array::from_fn(|x| if is_doubtful(x) { 40 } else { 200 });
            let y = u32::try_from(y).unwrap();
            finder.push(&DisparityRow { y, disparity: &disparity, confidence: &confidence });
        }
        finder.nearest_mm().nth(4).unwrap()
    };
    assert_eq!([told(48..72), told(40..84)], [Some(1000), None]);
}

#[test]
fn doubt_is_of_the_whole_gap_between_sure_answers() {
    // A wall, and before its lower part a thing with an outline, doubtful, and nothing between its two sides.
    let mut finder = finder(mounting(300, 0.0));
    let is_thing = |x: usize, y: usize| (40..120).contains(&x) && y >= 60;
    let is_outline = |x: usize| (40..48).contains(&x) || (112..120).contains(&x);
    let seen = map(|x, y| if !is_thing(x, y) { Some(2.0) } else { is_outline(x).then_some(10.0) });
    for (y, disparity) in seen.iter().enumerate() {
        let confidence: [u8; WIDTH] = std::array::from_fn(|x| if is_thing(x, y) { 40 } else { 200 });
        finder.push(&DisparityRow { y: u32::try_from(y).unwrap(), disparity, confidence: &confidence });
    }
    let told: Vec<bool> = finder.nearest_mm().map(|mm| mm.is_some()).collect();
    assert_eq!(told, [true, true, false, false, false, false, false, true, true]);
}

#[test]
fn a_little_more_of_two_blocks_alone_is_not_believed_where_three_agree() {
    // A wall at 2 px, two blocks of which read 0.75 px more.
    let seen = map(|x, y| Some(if (76..80).contains(&x) && (56..64).contains(&y) { 2.75 } else { 2.0 }));
    let found = find(&mut finder(mounting(300, 0.0)), &seen)[4].unwrap();
    // 2 px and 1/8.
    assert_eq!(found, 96_000 / 34);
}

#[test]
fn the_blocks_at_the_border_do_not_count() {
    for columns in [0..4, 156..160] {
        let seen = map(|x, _| Some(if columns.contains(&x) { 20.0 } else { 2.0 }));
        let found = find(&mut finder(mounting(300, 0.0)), &seen);
        assert!(found.iter().flatten().all(|mm| *mm >= 3000), "{found:?}");
    }
}

#[test]
fn what_it_keeps_is_small() {
    let size = size_of::<Obstacles<17, { blocks_for(320) }>>();
    assert!(size <= 3540, "{size}");
}

#[test]
fn arguments_are_held_to_their_ranges() {
    let level = mounting(300, 0.0);
    let new = |size, rig, mounting, sectors: Sectors<3>| {
        Obstacles::<3, { blocks_for(64) }>::new(size, rig, mounting, sectors, Settings::DEFAULT).map(|_| ())
    };
    let (size, three) = ([64, 48], sectors::<3>(3));
    assert_eq!(new(size, rig(), level, three), Ok(()));
    assert_eq!(new([68, 48], rig(), level, three), Err(ObstacleError::Capacity { max_width: 64 }));
    assert_eq!(new([31, 48], rig(), level, three), Err(ObstacleError::Size));
    assert_eq!(new([64, 4097], rig(), level, three), Err(ObstacleError::Size));
    assert_eq!(new(size, Rig::new(u32::MAX, 1).unwrap(), level, three), Err(ObstacleError::Rig));
    for wrong in [
        Mounting { lowest_mm: 500, ..level },
        Mounting { height_mm: 20_001, ..level },
        Mounting { cos_pitch_q14: 0, ..level },
        Mounting { sin_pitch_q14: i16::MIN, ..level },
    ] {
        assert_eq!(new(size, rig(), wrong, three), Err(ObstacleError::Mounting), "{wrong:?}");
    }
    for wrong in [
        Sectors { count: 0, ..three },
        Sectors { count: 4, ..three },
        Sectors { right_q16: three.left_q16[2], ..three },
        Sectors { left_q16: [0, 0, 1], ..three },
        Sectors { secant_q14: [0; 3], ..three },
    ] {
        assert_eq!(new(size, rig(), level, wrong), Err(ObstacleError::Sectors), "{wrong:?}");
    }
}

/// Any map of blocks whose disparities come from a few values, so that they often agree.
fn any_map() -> impl Strategy<Value = Map> {
    prop::collection::vec(prop::sample::select(&[-1_i16, 5, 40, 50, 64, 70, 200][..]), 40 * 30).prop_map(|blocks| {
        let pixel = |x: usize, y: usize| match blocks[y / 4 * 40 + x / 4] {
            -1 => Disparity::UNKNOWN,
            bits => Disparity::from_bits(bits),
        };
        (0..usize::from(HEIGHT)).map(|y| std::array::from_fn(|x| pixel(x, y))).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_ground_is_no_obstacle_whatever_the_camera(
        height_mm in 100..2000_i32, pitch in -40.0..20.0_f64, noise in prop::collection::vec(-0.4..0.4_f64, 30 * 40),
    ) {
        let mounting = mounting(height_mm, pitch);
        let seen = map(|x, y| ground(&mounting, y).map(|px| px + noise[y / 4 * 40 + x / 4]));
        prop_assert_eq!(find(&mut finder(mounting), &seen), [None; SECTORS]);
    }

    #[test]
    fn a_row_holds_the_disparities_whose_height_is_in_the_band(
        height_mm in 0..2000_i32, pitch in -60.0..60.0_f64, y in 0..u32::from(HEIGHT), bits in 1..=i16::MAX,
        (lowest_mm, highest_mm) in (-500..1500_i32, 1..1500_i32).prop_map(|(low, band)| (low, low + band)),
    ) {
        let mounting = Mounting { lowest_mm, highest_mm, ..mounting(height_mm, pitch) };
        let camera = Camera::new(SIZE_PX, rig(), mounting).unwrap();
        let (sin, cos) = (f64::from(mounting.sin_pitch_q14) / 16384.0, f64::from(mounting.cos_pitch_q14) / 16384.0);
        let below = (f64::from(y) - 59.5) / 100.0;
        let (depth, ahead) = (96_000.0 / f64::from(bits), cos + below * sin);
        let over_ground = f64::from(height_mm) + depth * (sin - below * cos);
        let Some(lane) = camera.lane(y, 0) else {
            prop_assert!(ahead < 1e-6);
            return Ok(());
        };
        // But for heights on the very border.
        if (over_ground - f64::from(lowest_mm)).abs() > 1e-6 && (over_ground - f64::from(highest_mm)).abs() > 1e-6 {
            let is_in_band = (f64::from(lowest_mm)..f64::from(highest_mm)).contains(&over_ground);
            prop_assert_eq!(lane.holds(bits.into()), is_in_band, "{} mm over the ground", over_ground);
        }
        prop_assert!((f64::from(lane.range_mm(bits.unsigned_abs().into(), 1 << 14)) - depth * ahead).abs() < 1.0 + depth * 1e-5);
        if let Depth::Millimetres(mm) = rig().depth(Disparity::from_bits(bits)) {
            prop_assert!((f64::from(mm) - depth).abs() <= 0.5);
        }
    }

    #[test]
    fn neither_capacity_nor_the_frame_before_changes_anything(seen in any_map(), before in any_map()) {
        let level = mounting(300, -5.0);
        let mut exact = finder(level);
        let mut roomy = Obstacles::<72, 100>::new(SIZE_PX, rig(), level, sectors(9), Settings::DEFAULT).unwrap();
        let expected = find(&mut exact, &seen);
        prop_assert_eq!(&find(&mut roomy, &seen), &expected);
        // The frame before ends in its middle.
        find(&mut exact, &before[..70].to_vec());
        prop_assert_eq!(&find(&mut exact, &seen), &expected);
    }

    #[test]
    fn what_is_reported_is_no_nearer_than_what_is_there(seen in any_map()) {
        let nearest = seen.iter().flatten().filter_map(|d| d.known()).max().unwrap_or(1);
        let least_mm = 96_000.0 / f64::from(nearest);
        for mm in find(&mut finder(mounting(300, 0.0)), &seen).into_iter().flatten() {
            prop_assert!(f64::from(mm) > least_mm - 1.0);
        }
    }
}
