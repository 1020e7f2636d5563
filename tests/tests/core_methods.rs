//! What holds for the methods of the core, `lite`, `full`, `wavelet-block`, and the sparse ones, `contour` and `envelope`.

mod common;

use common::map::{Losses, run_with_losses};
use common::property::{cases, samples};
use common::sparse_property::all_sparse_hold;
use common::{Subject, all_hold};
use haarline::contour_stereo::rows_for;
use haarline::{
    Config, ConfigError, ContourSettings, ContourStereo, EnvelopeStereo, Full, Lite, Parts, Reading, Scales, Seeds,
    StereoMethod, WaveletBlock, blocks_for,
};
use proptest::prelude::*;

/// A method with room for rows of `$width` px.
macro_rules! method {
    ($method:ident, $width:expr, $config:expr) => {
        Box::new($method::<{ blocks_for($width) }>::new($config).unwrap())
    };
}

macro_rules! subject {
    ($name:literal, $method:ident, guesses: $guesses:literal) => {
        subject!($name, $method, $method::<0>::LATENCY as usize, guesses: $guesses)
    };
    ($name:literal, $method:ident, $latency:expr, guesses: $guesses:literal) => {
        Subject {
            name: $name,
            build: |config| match config.width {
                0..=200 => method!($method, 204, config),
                201..=400 => method!($method, 400, config),
                _ => method!($method, Config::MAX_WIDTH, config),
            },
            build_tight: |config| match config.width {
                32 => method!($method, 32, config),
                33 => method!($method, 33, config),
                61 => method!($method, 61, config),
                97 => method!($method, 97, config),
                160 => method!($method, 160, config),
                322 => method!($method, 322, config),
                width => panic!("no tight capacity for {width} px"),
            },
            build_widest: |config| method!($method, Config::MAX_WIDTH, config),
            latency: $latency,
            guesses: $guesses,
        }
    };
}

mod lite {
    use super::*;

    const LITE: Subject = subject!("lite", Lite, guesses: true);
    all_hold!(LITE);
}

mod full {
    use super::*;

    const FULL: Subject = subject!("full", Full, guesses: true);
    all_hold!(FULL);
}

mod wavelet_block {
    use super::*;

    const WAVELET_BLOCK: Subject = subject!("wavelet_block", WaveletBlock, guesses: true);
    all_hold!(WAVELET_BLOCK);
}

mod wavelet_block_of_intensities {
    use super::*;

    /// The same with room to spare, of the other reading.
    fn build(config: Config) -> Box<dyn StereoMethod> {
        match config.width {
            0..=200 => Box::new(WaveletBlock::<{ blocks_for(204) }>::with_reading(config, Reading::Intensity).unwrap()),
            _ => Box::new(WaveletBlock::<{ blocks_for(1280) }>::with_reading(config, Reading::Intensity).unwrap()),
        }
    }

    const INTENSITIES: Subject = Subject {
        name: "wavelet_block_of_intensities",
        build,
        build_tight: build,
        build_widest: |config| {
            Box::new(WaveletBlock::<{ blocks_for(1280) }>::with_reading(config, Reading::Intensity).unwrap())
        },
        latency: WaveletBlock::<0>::LATENCY as usize,
        guesses: true,
    };
    // Not those of a changed contrast, of the mirror and of shifts in the narrowest views, which only derivatives keep within
    // their bounds, and no golden maps: it is a study's method.
    all_hold! {
        INTENSITIES;
        any_frame_is_answered_within_bounds,
        any_widest_frame_is_answered_within_bounds,
        rows_come_out_within_the_latency,
        a_reused_pipeline_equals_a_fresh_one,
        lost_rows_come_out_unknown,
        an_offset_changes_nothing,
    }
}

mod contour {
    use super::*;

    const CONTOUR: Subject = subject!("contour", ContourStereo, 8, guesses: false);
    all_sparse_hold!(CONTOUR);
}

mod envelope {
    use super::*;

    const ENVELOPE: Subject = subject!("envelope", EnvelopeStereo, 7, guesses: false);
    all_sparse_hold!(ENVELOPE);
}

#[test]
fn the_state_for_320_px_is_within_its_bounds() {
    let (lite, full) = (size_of::<Lite<{ blocks_for(320) }>>(), size_of::<Full<{ blocks_for(320) }>>());
    assert!(lite <= 22 * 1024, "lite: {lite} bytes");
    assert!(full <= 29 * 1024, "full: {full} bytes");
    let contour = size_of::<ContourStereo<{ blocks_for(320) }>>();
    let envelope = size_of::<EnvelopeStereo<{ blocks_for(320) }>>();
    assert!(contour <= 16 * 1024, "contour: {contour} bytes");
    assert!(envelope <= 20 * 1024, "envelope: {envelope} bytes");
}

#[test]
fn contours_of_all_settings_are_answered_within_bounds() {
    const BLOCKS: usize = blocks_for(200);
    type AnyContour = ContourStereo<BLOCKS, { rows_for(Scales::MAX_HALF_SUPPORT) }>;
    let scales = || prop::collection::vec(1..=16_u8, 0..3).prop_map(|scales| Scales::new(&scales).unwrap());
    let powers = prop::collection::vec(prop::sample::select(vec![1_u8, 2, 4, 8, 16]), 1..3);
    let powers = powers.prop_map(|scales| Scales::new(&scales).unwrap());
    let settings = (scales(), powers, scales(), any::<u8>(), any::<[bool; 2]>());
    proptest!(cases(128), |(sample in samples(), (rows, powers, columns, threshold, [decimated, linked_only]) in settings)| {
        let rows = if decimated || rows.is_empty() { powers } else { rows };
        let settings = ContourSettings { rows, columns, threshold, decimated, linked_only };
        let losses = Losses { seed: 1, one_in: 9 };
        let mut method = AnyContour::with_settings(sample.config, settings).unwrap();
        run_with_losses(&mut method, &sample.frame(), |y| losses.has(y)).check(&sample.config);
    });
}

#[test]
fn contour_settings_out_of_range_are_refused() {
    type Contours = ContourStereo<{ blocks_for(64) }>;
    let refused = |settings| Contours::with_settings(Config::for_width(64), settings).err();
    let scales = |half_support| Scales::new(&[half_support]).unwrap();
    let valid = ContourSettings::DEFAULT;
    assert_eq!(refused(valid), None);
    let none = ContourSettings { rows: Scales::NONE, columns: Scales::NONE, ..valid };
    assert_eq!(refused(none), Some(ConfigError::NoScale));
    let capacity = ConfigError::SupportCapacity { max_half_support: 2 };
    assert_eq!(refused(ContourSettings { columns: scales(3), ..valid }), Some(capacity));
    let decimated = ContourSettings { decimated: true, ..valid };
    assert_eq!(refused(ContourSettings { rows: scales(4), ..decimated }), None);
    assert_eq!(refused(ContourSettings { rows: scales(3), ..decimated }), Some(ConfigError::DecimatedScale));
    assert_eq!([0, 17, 255].map(|s| Scales::new(&[2, s]).err()), [Some(ConfigError::HalfSupport); 3]);
}

#[test]
fn a_width_over_capacity_is_refused_with_the_greatest_that_fits() {
    type Narrow = Lite<{ blocks_for(61) }>;
    let search = |width| Config { num_disparities: 16, ..Config::for_width(width) };
    assert_eq!(Narrow::new(search(65)).err(), Some(ConfigError::Capacity { max_width: 64 }));
    assert_eq!(Narrow::new(search(64)).unwrap().config(), &search(64));
    assert_eq!(Lite::<0>::new(search(32)).err(), Some(ConfigError::Capacity { max_width: 0 }));
}

#[test]
fn an_invalid_configuration_is_refused_whatever_the_capacity() {
    type Narrow = Lite<{ blocks_for(32) }>;
    let refused = |config: Config| Narrow::new(config).err();
    let valid = Config::for_width(32);
    assert_eq!(refused(valid), None);
    assert_eq!(refused(Config { width: 1281, ..valid }), Some(ConfigError::Width));
    assert_eq!(refused(Config { width: 31, ..valid }), Some(ConfigError::Width));
    assert_eq!(refused(Config { num_disparities: 0, ..valid }), Some(ConfigError::NumDisparities));
    assert_eq!(refused(Config { num_disparities: 33, ..valid }), Some(ConfigError::DisparitiesOverWidth));
    assert_eq!(refused(Config { min_disparity: -129, ..valid }), Some(ConfigError::MinDisparity));
}

/// Any parts, left out or not.
fn parts() -> impl Strategy<Value = Parts> {
    let seeds =
        prop_oneof![Just(Seeds::Contours), any::<u32>().prop_map(Seeds::Random), Just(Seeds::Grid), Just(Seeds::None),];
    let reading = prop_oneof![Just(Reading::Haar), Just(Reading::Intensity)];
    (seeds, reading, any::<[bool; 4]>()).prop_map(|(seeds, reading, [extremum, agreement, smoothing, texture])| Parts {
        seeds,
        reading,
        extremum,
        agreement,
        smoothing,
        texture,
    })
}

#[test]
fn a_method_of_some_of_its_parts_answers_within_bounds() {
    const BLOCKS: usize = blocks_for(200);
    proptest!(cases(128), |(sample in samples(), parts in parts(), seed in any::<u32>())| {
        let (frame, losses) = (sample.frame(), Losses { seed, one_in: 9 });
        let mut lite = Lite::<BLOCKS>::with_parts(sample.config, parts).unwrap();
        run_with_losses(&mut lite, &frame, |y| losses.has(y)).check_dense(&sample.config);
        let mut full = Full::<BLOCKS>::with_parts(sample.config, parts).unwrap();
        run_with_losses(&mut full, &frame, |y| losses.has(y)).check_dense(&sample.config);
        let mut paper = WaveletBlock::<BLOCKS>::with_parts(sample.config, parts).unwrap();
        run_with_losses(&mut paper, &frame, |y| losses.has(y)).check_dense(&sample.config);
    });
}
