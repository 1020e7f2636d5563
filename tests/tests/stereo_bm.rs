//! The streaming StereoBM, SSD and NCC against slow ones that follow the definition, and what holds for any frame.

#[path = "stereo_bm/frame.rs"]
mod frame;
#[path = "stereo_bm/oracle.rs"]
mod oracle;

use haarline::{Config, ConfigError, RowError, ScanlinePair, StereoMethod};
use haarline_tests::{BlockSettings, Ncc, Ssd, StereoBm};
use proptest::prelude::*;

use frame::{Frame, Map, run, run_with_losses};
use oracle::{Cost, Oracle};

/// Large enough for every frame here.
type Bm<const WINDOW: usize> = StereoBm<128, 64, WINDOW>;

fn config(width: usize, min_disparity: i16, num_disparities: u16) -> Config {
    Config { width: u16::try_from(width).unwrap(), min_disparity, num_disparities }
}

fn fresh<const WINDOW: usize>(config: Config, settings: BlockSettings) -> Bm<WINDOW> {
    Bm::new(config, settings).unwrap()
}

/// Pixels of all kinds, of black and white, or of three close grey levels.
fn pixels(count: usize) -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        prop::collection::vec(any::<u8>(), count),
        prop::collection::vec(prop_oneof![Just(0), Just(255)], count),
        prop::collection::vec(100..=102_u8, count),
    ]
}

/// Two unrelated views, or one view and a shift of it.
fn frames() -> impl Strategy<Value = Frame> {
    (32..=56_usize, 1..=26_usize).prop_flat_map(|(width, height)| {
        let shift = prop::option::of(0..20_usize);
        (pixels(width * height), pixels(width * height), shift).prop_map(move |(left, other, shift)| {
            let mut right = other;
            if let Some(shift) = shift {
                right.clone_from(&left);
                right.rotate_left(shift);
            }
            Frame { width, left, right }
        })
    })
}

/// Least disparity and count: mostly ones that leave columns to answer.
fn ranges() -> impl Strategy<Value = (i16, u16)> {
    // Sixteens are worked on together.
    let sixteens = prop::sample::select(vec![16_u16, 32]);
    prop_oneof![3 => (-20..=10_i16, 1..=32_u16), 2 => (-20..=10_i16, sixteens), 1 => (-128..=128_i16, 1..=32_u16)]
}

fn settings() -> impl Strategy<Value = BlockSettings> {
    let gates = (prop_oneof![Just(0), Just(10), 0..9000_u32], prop_oneof![Just(0), Just(15), any::<u8>()]);
    (1..=63_u8, gates).prop_map(|(prefilter_cap, (texture_threshold, uniqueness_ratio))| BlockSettings {
        prefilter_cap,
        texture_threshold,
        uniqueness_ratio,
    })
}

fn assert_equals_oracle<const WINDOW: usize>(frame: &Frame, config: Config, settings: BlockSettings) {
    let map = run(&mut fresh::<WINDOW>(config, settings), frame);
    assert_is_the_oracles::<WINDOW>(&map, frame, config, settings, Cost::Absolute);
}

fn assert_is_the_oracles<const WINDOW: usize>(
    map: &Map,
    frame: &Frame,
    config: Config,
    settings: BlockSettings,
    cost: Cost,
) {
    let expected = Oracle::new(frame, &config, &settings, WINDOW, cost).map();
    let differing = (0..expected.len()).find(|&at| map.disparity[at] != expected[at]);
    let place = differing.map(|at| (at % frame.width, at / frame.width, map.disparity[at], expected[at]));
    assert_eq!(place, None, "{cost:?}, window {WINDOW}, {config:?}, {settings:?}");
}

/// SSD and NCC of the usual window and of the largest.
fn assert_ssd_and_ncc_equal_the_oracle(frame: &Frame, config: Config, settings: BlockSettings) {
    let map = run(&mut Ssd::<128, 64>::new(config, settings).unwrap(), frame);
    assert_is_the_oracles::<9>(&map, frame, config, settings, Cost::Squared);
    let map = run(&mut Ssd::<128, 64, 21>::new(config, settings).unwrap(), frame);
    assert_is_the_oracles::<21>(&map, frame, config, settings, Cost::Squared);
    let map = run(&mut Ncc::<128, 64>::new(config, settings).unwrap(), frame);
    assert_is_the_oracles::<9>(&map, frame, config, settings, Cost::Correlation);
    let map = run(&mut Ncc::<128, 64, 21>::new(config, settings).unwrap(), frame);
    assert_is_the_oracles::<21>(&map, frame, config, settings, Cost::Correlation);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn streaming_equals_the_oracle(frame in frames(), (min, count) in ranges(), settings in settings()) {
        let config = config(frame.width, min, count);
        assert_equals_oracle::<5>(&frame, config, settings);
        assert_equals_oracle::<9>(&frame, config, settings);
        assert_equals_oracle::<15>(&frame, config, settings);
        assert_equals_oracle::<21>(&frame, config, settings);
    }

    #[test]
    fn squared_differences_and_correlations_equal_the_oracle(
        frame in frames(), (min, count) in ranges(), settings in settings(),
    ) {
        assert_ssd_and_ncc_equal_the_oracle(&frame, config(frame.width, min, count), settings);
    }

    #[test]
    fn reused_equals_fresh(
        (before, frame) in (frames(), frames()),
        (min, count) in ranges(),
        settings in settings(),
        lost in prop::collection::vec(0..26_usize, 0..5),
        finished in any::<bool>(),
    ) {
        let config = config(frame.width, min, count);
        let mut reused = fresh::<9>(config, settings);
        for (y, row) in before.left.chunks_exact(frame.width).enumerate() {
            if lost.contains(&y) {
                reused.miss(&mut |_| ());
            } else {
                reused.push(ScanlinePair { left: row, right: row }, &mut |_| ()).unwrap();
            }
        }
        if finished { reused.finish(&mut |_| ()) } else { reused.start() }
        prop_assert_eq!(run(&mut reused, &frame), run(&mut fresh::<9>(config, settings), &frame));
    }

    #[test]
    fn a_lost_row_is_unknown_and_the_row_before_stands_in(
        frame in frames(),
        (min, count) in ranges(),
        lost in prop::collection::vec(0..26_usize, 1..6),
    ) {
        let config = config(frame.width, min, count);
        let map = run_with_losses(&mut fresh::<5>(config, BlockSettings::UNGATED), &frame, &lost);
        let width = frame.width;
        let mut repaired = frame.clone();
        for y in 0..frame.height() {
            if lost.contains(&y) {
                for view in [&mut repaired.left, &mut repaired.right] {
                    match y.checked_sub(1) {
                        Some(before) => view.copy_within(before * width..y * width, y * width),
                        None => view[..width].fill(128),
                    }
                }
            }
        }
        let expected = run(&mut fresh::<5>(config, BlockSettings::UNGATED), &repaired);
        for y in 0..frame.height() {
            let row = y * width..(y + 1) * width;
            if lost.contains(&y) {
                prop_assert!(map.is_row_unknown(y, width), "row {}", y);
                prop_assert!(map.confidence[row].iter().all(|&c| c == 0), "row {}", y);
            } else {
                prop_assert_eq!(&map.disparity[row.clone()], &expected.disparity[row], "row {}", y);
            }
        }
    }
}

#[test]
fn a_pair_shifted_by_k_has_disparity_k() {
    for k in [-9_i16, -1, 0, 1, 7, 15, 20] {
        let frame = Frame::textured(96, 24, i32::from(k));
        let map = run(&mut fresh::<9>(config(96, -16, 40), BlockSettings::default()), &frame);
        let known = map.known();
        // Columns 23 + 4 to 79, rows 4 to 19. Four windows reach over the right edge.
        assert!(known.len() >= (80 - 27 - 4) * 16, "{k} px: {} known", known.len());
        let exact = known.iter().filter(|&&bits| (bits - k * 16).abs() <= 8).count();
        assert!(exact >= (80 - 27 - 4) * 16, "{k} px: {exact} of {} within half a pixel", known.len());
    }
}

#[test]
fn a_perfect_match_is_exact_and_no_more_than_doubtful() {
    let frame = Frame::textured(96, 30, 7);
    let map = run(&mut fresh::<15>(config(96, 7, 1), BlockSettings::default()), &frame);
    // One disparity has no rival: the whole area is known. Columns 7 + 7 to 88, rows 7 to 22.
    assert_eq!(map.known(), vec![7 * 16; (89 - 14) * 16]);
    assert!(map.disparity.iter().zip(&map.confidence).all(|(d, &c)| c == if d.is_known() { 55 } else { 0 }));
}

#[test]
fn the_gates_reject_flat_and_repeated_content() {
    let flat = Frame::from_fn(64, 20, |_, _| (90, 90));
    let repeated = Frame::from_fn(64, 20, |x, _| if x / 2 % 2 == 0 { (0, 0) } else { (255, 255) });
    // Not from 0, where the views' right edges, which are flat, would tell one period from another.
    let config = config(64, 4, 16);
    // Columns 19 + 4 to 59, rows 4 to 15.
    let whole_area = (60 - 23) * 12;
    for (frame, gate) in [
        (&flat, BlockSettings { uniqueness_ratio: 0, ..BlockSettings::default() }),
        (&repeated, BlockSettings { texture_threshold: 0, ..BlockSettings::default() }),
    ] {
        assert_eq!(run(&mut fresh::<9>(config, gate), frame).known(), []);
        let ungated = run(&mut fresh::<9>(config, BlockSettings::UNGATED), frame);
        assert_eq!(ungated.known().len(), whole_area);
        assert!(
            ungated.disparity.iter().zip(&ungated.confidence).all(|(d, &c)| c == if d.is_known() { 12 } else { 0 }),
            "equals are a guess"
        );
    }
}

#[test]
fn extremes_neither_overflow_nor_panic() {
    let settings = BlockSettings { prefilter_cap: 255, ..BlockSettings::UNGATED };
    let black_and_white = |bit: usize| if bit.is_multiple_of(2) { 0 } else { 255 };
    for period in [1, 2, 3, 16] {
        let frame = Frame::from_fn(64, 50, |x, y| {
            (black_and_white(x / period), black_and_white(x / period + 1 + usize::from(y == 30)))
        });
        for (min, count) in [(0, 64), (0, 1), (-128, 64), (128, 64), (-20, 40), (-64, 64)] {
            let map = run(&mut fresh::<21>(config(64, min, count), settings), &frame);
            assert!(map.known().iter().all(|&bits| (min * 16..=(min + 63) * 16).contains(&bits)));
        }
    }
    let full = Frame::from_fn(64, 50, |x, _| (black_and_white(x / 2), black_and_white(x / 2 + 1)));
    let settings = BlockSettings { prefilter_cap: 63, ..settings };
    assert_equals_oracle::<21>(&full, config(64, 0, 9), settings);
    assert_ssd_and_ncc_equal_the_oracle(&full, config(64, 0, 9), settings);
}

#[test]
fn a_frame_lower_than_the_window_is_unknown() {
    for height in 0..9 {
        let map = run(&mut fresh::<9>(config(64, 0, 16), BlockSettings::UNGATED), &Frame::textured(64, height, 3));
        assert_eq!((map.rows as usize, map.known()), (height, vec![]));
    }
    let map = run(&mut fresh::<9>(config(64, 0, 16), BlockSettings::UNGATED), &Frame::textured(64, 9, 3));
    assert!((0..9).all(|y| map.is_row_unknown(y, 64) == (y != 4)));
}

#[test]
fn rows_leave_half_a_window_and_one_row_later() {
    let frame = Frame::textured(64, 30, 3);
    let mut method = fresh::<15>(config(64, 0, 16), BlockSettings::default());
    let mut map = Map::default();
    for (pushed, pair) in frame.rows().enumerate() {
        method.push(pair, &mut map.sink()).unwrap();
        assert_eq!(map.rows as usize, pushed.saturating_sub(7), "after row {pushed}");
    }
}

#[test]
fn a_row_of_wrong_width_changes_nothing() {
    let frame = Frame::textured(64, 20, 3);
    let mut method = fresh::<9>(config(64, 0, 16), BlockSettings::default());
    let mut map = Map::default();
    for pair in frame.rows() {
        for (left, right, found) in [(63, 64, 63), (64, 0, 0), (65, 64, 65), (64, 128, 128)] {
            let wrong = ScanlinePair { left: &[1; 128][..left], right: &[1; 128][..right] };
            let refused = method.push(wrong, &mut |_| panic!("no row is ready"));
            assert_eq!(refused, Err(RowError::Width { expected: 64, found }));
        }
        method.push(pair, &mut map.sink()).unwrap();
    }
    method.finish(&mut map.sink());
    assert_eq!(map, run(&mut fresh::<9>(config(64, 0, 16), BlockSettings::default()), &frame));
}

#[test]
fn what_is_out_of_range_or_capacity_is_refused() {
    let refused = |config| Bm::<9>::new(config, BlockSettings::default()).err();
    assert_eq!(refused(config(128, 0, 64)), None);
    assert_eq!(refused(config(129, 0, 64)), Some(ConfigError::Capacity { max_width: 128 }));
    assert_eq!(refused(config(128, 0, 65)), Some(ConfigError::DisparityCapacity { max_disparities: 64 }));
    assert_eq!(refused(config(128, 0, 0)), Some(ConfigError::NumDisparities));
    assert_eq!(refused(config(31, 0, 16)), Some(ConfigError::Width));
    assert_eq!(refused(config(128, 129, 16)), Some(ConfigError::MinDisparity));
    assert_eq!(refused(config(32, 0, 33)), Some(ConfigError::DisparitiesOverWidth));
}

#[test]
fn the_cap_is_brought_into_its_range() {
    for (asked, taken) in [(0, 1), (1, 1), (31, 31), (63, 63), (64, 63), (255, 63)] {
        let settings = BlockSettings { prefilter_cap: asked, ..BlockSettings::default() };
        assert_eq!(fresh::<9>(config(64, 0, 16), settings).settings().prefilter_cap, taken);
    }
}

#[test]
fn an_instance_takes_what_its_documentation_says() {
    let by_formula = |width: usize, disparities: usize, window: usize| width * (2 * disparities + 2 * window + 13);
    let (small, large) = (size_of::<StereoBm<320, 64>>(), size_of::<StereoBm<1280, 256, 15>>());
    assert!((0..512).contains(&(small - by_formula(320, 64, 9))), "{small}");
    assert!((0..1024).contains(&(large - by_formula(1280, 256, 15))), "{large}");
    let (ssd, ncc) = (size_of::<Ssd<320, 64>>(), size_of::<Ncc<320, 64>>());
    assert!((0..2048).contains(&(ssd - by_formula(320, 128, 9))), "{ssd}");
    assert!((0..512).contains(&(ncc - by_formula(320, 128, 9) - 8 * 320 - 12 * 64)), "{ncc}");
}
