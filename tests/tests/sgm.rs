//! The streaming semi-global matching against one that follows the definition, and what holds for any frame.

#[allow(dead_code, unused_imports, unused_macros, reason = "the core's methods have more properties")]
mod common;
#[path = "sgm/oracle.rs"]
mod oracle;

use common::content::Content;
use common::frame::Frame;
use common::map::{run, run_with_losses};
use common::property::{cases, samples};
use common::{Subject, all_hold};
use haarline::{Config, ConfigError, StereoMethod};
use haarline_tests::Sgm;
use haarline_tests::sgm::words_for;
use oracle::Oracle;
use proptest::prelude::*;

fn build(config: Config) -> Box<dyn StereoMethod> {
    match config.width {
        0..=100 if config.num_disparities <= 48 => Box::new(Sgm::<100, { words_for(48) }>::new(config).unwrap()),
        0..=200 => Box::new(Sgm::<200, { words_for(Config::MAX_DISPARITIES) }>::new(config).unwrap()),
        _ => Box::new(Sgm::<322, { words_for(Config::MAX_DISPARITIES) }>::new(config).unwrap()),
    }
}

const SGM: Subject = Subject {
    name: "sgm",
    build,
    build_tight: |config| match config.width {
        32 => Box::new(Sgm::<32, 8>::new(config).unwrap()),
        33 => Box::new(Sgm::<33, 8>::new(config).unwrap()),
        61 => Box::new(Sgm::<61, 8>::new(config).unwrap()),
        97 => Box::new(Sgm::<97, 8>::new(config).unwrap()),
        160 => Box::new(Sgm::<160, 8>::new(config).unwrap()),
        _ => Box::new(Sgm::<322, 8>::new(config).unwrap()),
    },
    build_widest: |config| Box::new(Sgm::<{ Config::MAX_WIDTH as usize }, { words_for(24) }>::new(config).unwrap()),
    latency: 3,
    guesses: false,
};

// Not those of views without texture and of answers inside the right view, since it answers everything among all
// disparities; no golden maps, since there is the oracle.
all_hold! {
    SGM;
    a_shift_of_k_pixels_has_disparity_k,
    shifted_random_pixels_have_disparity_k,
    every_capacity_gives_the_same_answer,
    rows_come_out_within_the_latency,
    a_reused_pipeline_equals_a_fresh_one,
    a_row_of_wrong_width_changes_nothing,
    a_frame_may_begin_with_lost_rows,
    an_offset_changes_nothing,
}

fn assert_equals_oracle(frame: &Frame, config: &Config) {
    let map = run(&mut *build(*config), frame);
    let found: Vec<i16> = map.disparity.iter().map(|bits| bits.expect("every pixel is answered")).collect();
    assert!(found == Oracle::new(frame, config).map(), "{} px, {config:?}", frame.width);
    assert!(map.confidence == Oracle::new(frame, config).confidence(), "confidence, {} px, {config:?}", frame.width);
}

#[test]
fn streaming_equals_the_oracle() {
    proptest!(cases(128), |(sample in samples())| {
        assert_equals_oracle(&sample.frame(), &sample.config);
    });
}

#[test]
fn random_views_equal_the_oracle() {
    let views = (32..=56_usize, 1..=12_usize).prop_flat_map(|(width, height)| {
        let view = || prop::collection::vec(prop_oneof![any::<u8>(), Just(0), Just(255)], width * height);
        (Just(width), Just(height), view(), view())
    });
    let ranges = (-40..=40_i16, 1..=32_u16);
    proptest!(cases(128), |((width, height, left, right) in views, (min_disparity, num_disparities) in ranges)| {
        let config = Config { width: u16::try_from(width).unwrap(), min_disparity, num_disparities };
        assert_equals_oracle(&Frame { width, height, left, right }, &config);
    });
}

#[test]
fn lost_rows_and_no_others_come_out_unknown() {
    let frame = Frame::shifted(64, 20, Content::Texture { seed: 5 }, 5);
    let config = Config { num_disparities: 16, ..Config::for_width(64) };
    for (first, count) in [(0, 1), (0, 20), (1, 3), (7, 1), (7, 5), (16, 4), (19, 1)] {
        let is_lost = |y: usize| (first..first + count).contains(&y);
        let map = run_with_losses(&mut *build(config), &frame, is_lost);
        for (at, (disparity, &confidence)) in map.disparity.iter().zip(&map.confidence).enumerate() {
            assert_eq!((disparity.is_none(), confidence == 0), (is_lost(at / 64), is_lost(at / 64)), "{first} {count}");
        }
    }
}

#[test]
fn what_is_out_of_range_or_capacity_is_refused() {
    let refused = |config| Sgm::<64, { words_for(30) }>::new(config).err();
    let valid = Config { num_disparities: 32, ..Config::for_width(64) };
    assert_eq!(refused(valid), None);
    assert_eq!(refused(Config { width: 65, ..valid }), Some(ConfigError::Capacity { max_width: 64 }));
    let capacity = ConfigError::DisparityCapacity { max_disparities: 32 };
    assert_eq!(refused(Config { num_disparities: 33, ..valid }), Some(capacity));
    assert_eq!(refused(Config { num_disparities: 0, ..valid }), Some(ConfigError::NumDisparities));
}

#[test]
fn an_instance_takes_what_its_documentation_says() {
    let by_formula = |width: usize, words: usize| width * (12 * words + 45);
    let (small, large) = (size_of::<Sgm<320, { words_for(48) }>>(), size_of::<Sgm<1280, { words_for(256) }>>());
    assert!((0..2048).contains(&(small - by_formula(320, 12))), "{small}");
    assert!((0..2048).contains(&(large - by_formula(1280, 64))), "{large}");
}
