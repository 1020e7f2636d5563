//! The properties, each a function of the method.

use std::cell::Cell;
use std::env;

use haarline::{Config, RowError, ScanlinePair, StereoMethod};
use proptest::prelude::*;

use super::content::{Content, contents};
use super::frame::Frame;
use super::map::{Losses, Map, run, run_with_losses};
use super::scene::{Scene, noisy_street, street, two_planes};
use super::{Subject, TIGHT_WIDTHS, golden};

/// Few cases, so that a debug run stays short; `PROPTEST_CASES` asks for more.
pub fn cases(count: u32) -> ProptestConfig {
    let default = ProptestConfig::default();
    let cases = if env::var_os("PROPTEST_CASES").is_some() { default.cases } else { count };
    ProptestConfig { cases, failure_persistence: None, ..default }
}

pub(super) fn config(width: usize, min_disparity: i16, num_disparities: u16) -> Config {
    Config { width: u16::try_from(width).unwrap(), min_disparity, num_disparities }
}

/// A frame made of two patterns, and how it is searched.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    pub height: usize,
    pub left: Content,
    /// The right view's pattern; the left one's if there is none.
    pub other: Option<Content>,
    /// By how much the right view's pattern is shifted, px.
    pub shift: i32,
    pub config: Config,
}

impl Sample {
    /// Both views.
    pub fn frame(&self) -> Frame {
        let right = self.other.unwrap_or(self.left);
        let width = usize::from(self.config.width);
        Frame::from_fn(width, self.height, |x, y| self.left.at(x, y), |x, y| right.at(x + self.shift, y))
    }
}

/// Any search range that is valid for that width, mostly one that many columns can be seen in.
fn configs(width: u16) -> impl Strategy<Value = Config> {
    let ranges = prop_oneof![
        3 => (-20..=20_i16, 1..=40_u16),
        1 => (-128..=128_i16, 1..=256_u16),
    ];
    ranges.prop_map(move |(min_disparity, num_disparities)| Config {
        width,
        min_disparity,
        num_disparities: num_disparities.min(width),
    })
}

/// Any frame of that width; three in four have the same pattern in both views.
fn samples_of(width: impl Strategy<Value = u16>) -> impl Strategy<Value = Sample> {
    let frame = (1..=40_usize, contents(), prop::option::weighted(0.25, contents()), -20..=40_i32);
    (width.prop_flat_map(configs), frame).prop_map(|(config, (height, left, other, shift))| Sample {
        height,
        left,
        other,
        shift,
        config,
    })
}

/// Any frame of up to 200 px in width.
pub fn samples() -> impl Strategy<Value = Sample> {
    samples_of(32..=200_u16)
}

fn losses() -> impl Strategy<Value = Losses> {
    (any::<u32>(), 1..=12_u8).prop_map(|(seed, one_in)| Losses { seed, one_in })
}

// Any content, any size

/// The map of any frame is one that [`Map::check`] accepts, lost rows or not.
pub fn any_frame_is_answered_within_bounds(subject: &Subject) {
    let known = Cell::new(0);
    proptest!(cases(512), |(sample in samples(), losses in prop::option::weighted(0.3, losses()))| {
        let losses = losses.unwrap_or_default();
        let map = run_with_losses(&mut *(subject.build)(sample.config), &sample.frame(), |y| losses.has(y));
        subject.check(&map, &sample.config);
        known.set(known.get() + map.known().count());
    });
    assert!(known.get() > 0, "nothing was answered in any case");
}

/// The same for the widest rows.
pub fn any_widest_frame_is_answered_within_bounds(subject: &Subject) {
    proptest!(cases(24), |(sample in samples_of(Just(1280)))| {
        let map = run(&mut *(subject.build)(sample.config), &sample.frame());
        subject.check(&map, &sample.config);
    });
}

/// Stripes and chequers of every period up to 20 px, of full contrast, at the greatest search range.
pub fn every_period_is_answered_within_bounds(subject: &Subject) {
    for period in 1..=20 {
        for content in [Content::Checkers { across: period, down: period }, Content::UprightStripes { across: period }]
        {
            let config = config(72, -8, 72);
            let map = run(&mut *(subject.build)(config), &Frame::shifted(72, 12, content, i32::from(period) / 2));
            subject.check(&map, &config);
        }
    }
}

/// The 32-bit counters of rows hold more than 16 bits, and those of pixels do not overflow.
pub fn a_tall_frame_is_answered_to_its_end(subject: &Subject) {
    for (width, height) in [(1280, 400), (32, 66_000)] {
        let content = Content::Texture { seed: 7 };
        let config = config(width, 0, 8);
        let map = run(&mut *(subject.build)(config), &Frame::shifted(width, height, content, 3));
        subject.check(&map, &config);
        assert!(!map.is_row_unknown(height - 1), "{width} x {height}");
    }
}

// Disparity

/// Counts the pixels of a map that should be `disparity` px everywhere: those within `tolerance` / 16 px
/// of it, and all that both views see at least `border` px from their sides.
pub(super) fn right_answers(map: &Map, disparity: i32, tolerance: i32, border: i32) -> (usize, usize) {
    let inside = border..i32::try_from(map.width).unwrap() - border;
    let (mut right, mut all) = (0, 0);
    for (i, found) in map.disparity.iter().enumerate() {
        let x = i32::try_from(i % map.width).unwrap();
        if inside.contains(&x) && inside.contains(&(x - disparity)) {
            all += 1;
            right += usize::from(found.is_some_and(|bits| (i32::from(bits) - 16 * disparity).abs() <= tolerance));
        }
    }
    (right, all)
}

/// A view shifted by k px has disparity k, whatever the size; 0 too is a disparity. Of the pixels 8 px or
/// more from the sides 99 percent are within 1/2 px and 80 percent within 1/4 px, even in a frame of one
/// row; of all that both views see 84 percent are within 1/2 px, so that nothing is cropped. (98 percent where guesses count, too.)
pub fn a_shift_of_k_pixels_has_disparity_k(subject: &Subject) {
    let searches = [(0, 16, 0), (0, 32, 5), (0, 16, 15), (-16, 32, -7), (-8, 8, -8), (3, 9, 7), (4, 1, 4)];
    let wide = [(-128, 64, -120), (100, 29, 128), (0, 256, 130)];
    for (width, searches) in [(33, &searches[..]), (61, &searches), (322, &searches), (322, &wide)] {
        for (height, &(min_disparity, num_disparities, disparity)) in
            [1, 2, 3, 5, 7, 24].iter().flat_map(|height| searches.iter().map(move |search| (*height, search)))
        {
            let config = config(width, min_disparity, num_disparities);
            let maps = (0..6).map(|seed| {
                let frame = Frame::shifted(width, height, Content::Texture { seed }, disparity);
                run(&mut *(subject.build)(config), &frame)
            });
            let maps: Vec<Map> = maps.collect();
            let most = if subject.guesses { 98 } else { 99 };
            for (tolerance, border, percent) in [(8, 8, most), (4, 8, 80), (8, 0, 84)] {
                let counts = maps.iter().map(|map| right_answers(map, disparity, tolerance, border));
                let (right, all) = counts.fold((0, 0), |sum, count| (sum.0 + count.0, sum.1 + count.1));
                assert!(
                    100 * right >= percent * all,
                    "{right} of {all} pixels within {tolerance}/16 px of {disparity} px, {width} x {height}, {config:?}"
                );
            }
        }
    }
}

/// The same where each pixel is random, so that the texture looks like strong noise: within 1/4 px at 99
/// percent.
pub fn shifted_random_pixels_have_disparity_k(subject: &Subject) {
    for disparity in [0, 5, 11] {
        let frame = Frame::shifted(160, 40, Content::Noise { seed: 1, spread: 100 }, disparity);
        let map = run(&mut *(subject.build)(config(160, 0, 16)), &frame);
        let (right, all) = right_answers(&map, disparity, 4, 8);
        assert!(100 * right >= 99 * all, "{right} of {all} for {disparity} px");
    }
}

/// The same answer from every capacity, and nothing cropped where the width is no multiple of a block.
pub fn every_capacity_gives_the_same_answer(subject: &Subject) {
    capacities_agree(subject, true);
}

/// The same answer from every capacity; `always_known` says whether each frame must have one at all.
pub(super) fn capacities_agree(subject: &Subject, always_known: bool) {
    let contents = [
        (1, Content::Texture { seed: 1 }),
        (23, Content::Texture { seed: 2 }),
        (18, Content::DimTexture { seed: 3 }),
        (18, Content::BlackOrWhite { seed: 4 }),
        (18, Content::Noise { seed: 5, spread: 20 }),
    ];
    for (width, (height, content)) in TIGHT_WIDTHS.iter().flat_map(|width| contents.map(|content| (*width, content))) {
        for disparity in [3, -3] {
            let config = Config { width, min_disparity: -8, num_disparities: 24 };
            let frame = Frame::shifted(usize::from(width), height, content, disparity);
            let builds = [subject.build_tight, subject.build, subject.build_widest];
            let [tight, roomy, widest] = builds.map(|build| run(&mut *build(config), &frame));
            assert!(tight == roomy && roomy == widest, "{width} x {height}, {content:?}, {disparity} px");
            let is_known = tight.known().count() > 0;
            assert!(is_known || !always_known, "{width} x {height}, {content:?}, {disparity} px: nothing known");
        }
    }
    // Jumps between surfaces near the borders, where windows reach beside the view.
    let surfaces = (prop::sample::select(vec![32_u16, 33, 61]), any::<u32>(), [-24..=24_i32, -24..=24_i32], 0..61_i32);
    proptest!(cases(192), |((width, seed, shifts, split) in surfaces, height in 4..=20_usize)| {
        let config = Config { width, min_disparity: -24, num_disparities: 32 };
        let content = Content::Texture { seed };
        let shift = |x: i32| if x < split { shifts[0] } else { shifts[1] };
        let right = |x: i32, y: i32| content.at(x + shift(x), y);
        let frame = Frame::from_fn(usize::from(width), height, |x, y| content.at(x, y), right);
        let [tight, roomy] = [subject.build_tight, subject.build].map(|build| run(&mut *build(config), &frame));
        prop_assert!(tight == roomy, "{width} x {height}, seed {seed}, {shifts:?} px from column {split} on");
    });
}

// Rows and frames

/// Row `y` is delivered by the time row `y + latency` is pushed or missed, and some row not before.
pub fn rows_come_out_within_the_latency(subject: &Subject) {
    for losses in [Losses::default(), Losses { seed: 1, one_in: 3 }, Losses { seed: 1, one_in: 1 }] {
        let mut method = (subject.build)(config(64, 0, 16));
        let frame = Frame::shifted(64, 50, Content::Texture { seed: 1 }, 4);
        let (mut map, mut longest) = (Map::new(64), 0);
        for (y, pair) in frame.rows().enumerate() {
            if losses.has(y) {
                method.miss(&mut |row| map.add(row));
            } else {
                method.push(pair, &mut |row| map.add(row)).unwrap();
            }
            assert!(map.rows <= y + 1, "row {} came out before row {y} came in", map.rows - 1);
            // The oldest row that is still inside waits at least until the next push.
            longest = longest.max(y + 1 - map.rows);
        }
        assert_eq!(longest, subject.latency, "{losses:?}");
    }
}

/// What precedes a frame.
#[derive(Debug, Clone, Copy)]
enum Before {
    /// A whole frame, ended.
    Whole(Losses),
    /// The first rows of a frame, cut short by a new start.
    CutShort { rows: usize, losses: Losses },
    /// A frame of which every row was lost.
    AllLost,
    /// An end without any row.
    Nothing,
}

/// A reused pipeline equals a fresh one, whatever it did before.
pub fn a_reused_pipeline_equals_a_fresh_one(subject: &Subject) {
    let some_losses = || prop::option::of(losses()).prop_map(Option::unwrap_or_default);
    let before = prop_oneof![
        some_losses().prop_map(Before::Whole),
        (0..40_usize, some_losses()).prop_map(|(rows, losses)| Before::CutShort { rows, losses }),
        Just(Before::AllLost),
        Just(Before::Nothing),
    ];
    proptest!(cases(256), |(sample in samples(), other in samples(), before in before, losses in some_losses())| {
        let other = Sample { config: sample.config, ..other }.frame();
        let mut reused = (subject.build)(sample.config);
        match before {
            Before::Whole(losses) => drop(run_with_losses(&mut *reused, &other, |y| losses.has(y))),
            Before::CutShort { rows, losses } => {
                for (y, pair) in other.rows().enumerate().take(rows) {
                    if losses.has(y) {
                        reused.miss(&mut |_| {});
                    } else {
                        reused.push(pair, &mut |_| {}).unwrap();
                    }
                }
                reused.start();
            }
            Before::AllLost => drop(run_with_losses(&mut *reused, &other, |_| true)),
            Before::Nothing => reused.finish(&mut |_| panic!("a row of a frame without rows")),
        }
        let frame = sample.frame();
        let found = run_with_losses(&mut *reused, &frame, |y| losses.has(y));
        let expected = run_with_losses(&mut *(subject.build)(sample.config), &frame, |y| losses.has(y));
        prop_assert!(found == expected);
    });
}

/// A row of a wrong width is refused with both widths named, and the frame goes on as if it had not come.
pub fn a_row_of_wrong_width_changes_nothing(subject: &Subject) {
    let (width, height) = (61, 22);
    let frame = Frame::shifted(width, height, Content::Texture { seed: 4 }, 4);
    let config = config(width, 0, 16);
    let expected = run(&mut *(subject.build)(config), &frame);
    let bytes = [7; 200];
    let mut method = (subject.build)(config);
    let offer_wrong_rows = |method: &mut dyn StereoMethod| {
        for (left, right, found) in
            [(0, 0, 0), (60, 61, 60), (61, 60, 60), (61, 62, 62), (64, 64, 64), (200, 61, 200), (61, 200, 200)]
        {
            let pair = ScanlinePair { left: &bytes[..left], right: &bytes[..right] };
            let refused = method.push(pair, &mut |_| panic!("a row came out"));
            assert_eq!(refused, Err(RowError::Width { expected: 61, found }), "{left} and {right} px");
        }
    };
    let mut map = Map::new(width);
    for pair in frame.rows() {
        offer_wrong_rows(&mut *method);
        method.push(pair, &mut |row| map.add(row)).unwrap();
    }
    offer_wrong_rows(&mut *method);
    method.finish(&mut |row| map.add(row));
    assert!(map == expected);
}

// Lost rows

/// Lost rows come out unknown, and nothing else of the frame is lost, wherever they are.
pub fn lost_rows_come_out_unknown(subject: &Subject) {
    let frame = Frame::shifted(96, 48, Content::Texture { seed: 5 }, 5);
    let config = config(96, 0, 16);
    for first in 0..48 {
        for count in [1, 2, 5, 13, 48] {
            let is_lost = |y: usize| (first..first + count).contains(&y);
            let map = run_with_losses(&mut *(subject.build)(config), &frame, is_lost);
            subject.check(&map, &config);
            for y in 0..48 {
                assert_eq!(map.is_row_unknown(y), is_lost(y), "row {y} of a frame without {count} rows from {first}");
            }
        }
    }
}

/// Row `y` does not depend on a lost row more than `latency` rows below it: it is out by then. Downwards
/// there is no such limit, since blocks hand their disparities on and the noise is estimated from all
/// rows so far; but beyond 16 rows below the lost one no more than 2 percent of the pixels change by
/// more than 1 px, or whether they are known, in the mean over all places of the lost row.
pub fn rows_far_from_a_lost_one_are_as_if_it_were_there(subject: &Subject) {
    for (scene, config) in scenes() {
        let frame = scene.render();
        let whole = run(&mut *(subject.build)(config), &frame);
        let (mut changed, mut all) = (0, 0);
        for lost in 0..scene.height {
            let map = run_with_losses(&mut *(subject.build)(config), &frame, |y| y == lost);
            for y in 0..lost.saturating_sub(subject.latency) {
                assert!(map.row(y) == whole.row(y), "row {y} differs without row {lost}");
            }
            for y in lost + 17..scene.height {
                let pairs = whole.row(y).0.iter().zip(map.row(y).0);
                let is_changed = |pair: &(&Option<i16>, &Option<i16>)| match *pair {
                    (Some(a), Some(b)) => a.abs_diff(*b) > 16,
                    (a, b) => a != b,
                };
                changed += pairs.filter(is_changed).count();
                all += map.width;
            }
        }
        assert!(100 * changed <= 2 * all, "{changed} of {all} pixels changed");
    }
}

/// A frame that begins with lost rows is answered like any other from its first row on: within 1/4 px at
/// 98 percent of the pixels 8 px or more from the sides.
pub fn a_frame_may_begin_with_lost_rows(subject: &Subject) {
    for count in 1..=16 {
        let frame = Frame::shifted(96, 48, Content::Texture { seed: 6 }, 5);
        let map = run_with_losses(&mut *(subject.build)(config(96, 0, 16)), &frame, |y| y < count);
        let rest = Map { disparity: map.disparity[count * 96..].to_vec(), ..map };
        let (right, all) = right_answers(&rest, 5, 4, 8);
        assert!(100 * right >= 98 * all, "{right} of {all} after {count} lost rows");
    }
}

// What is not there is not seen

/// Views without texture across are unknown everywhere, or guessed: nothing tells how far they are.
pub fn views_without_texture_have_no_sure_answer(subject: &Subject) {
    for (width, height) in [(32, 1), (61, 5), (160, 40)] {
        let config = config(width, -4, 24);
        let mut constant: Vec<(Content, Content)> =
            [0, 1, 100, 254, 255].map(|grey| (Content::Constant(grey), Content::Constant(grey))).into();
        constant.push((Content::Constant(0), Content::Constant(255)));
        constant.push((Content::ConstantRows { seed: 1 }, Content::ConstantRows { seed: 1 }));
        constant.push((Content::LyingStripes { down: 3 }, Content::LyingStripes { down: 3 }));
        for (left, right) in constant {
            let frame = Frame::from_fn(width, height, |x, y| left.at(x, y), |x, y| right.at(x, y));
            let map = subject.measure(config, &frame);
            assert_eq!(map.known().count(), 0, "{left:?} and {right:?}, {width} x {height}");
        }
    }
}

// Changed views

/// The scenes that the properties below change, and their search ranges.
fn scenes() -> [(Scene, Config); 3] {
    [(two_planes(), config(96, 0, 24)), (street(), config(96, 0, 24)), (noisy_street(), config(93, -12, 32))]
}

/// Differences of the pixels known in both maps, 1/16 px, from the least to the greatest.
fn differences(a: &Map, b: &Map) -> Vec<u16> {
    let both = a.disparity.iter().zip(&b.disparity).filter_map(|(a, b)| Some((*a)?.abs_diff((*b)?)));
    let mut differences: Vec<u16> = both.collect();
    differences.sort_unstable();
    differences
}

/// What a method measures of a scene; without the blank surfaces where it guesses, since these look like any other wall.
fn measured(subject: &Subject, scene: &Scene, config: Config, frame: &Frame) -> Map {
    let mut map = subject.measure(config, frame);
    if subject.guesses {
        for (i, disparity) in map.disparity.iter_mut().enumerate() {
            *disparity = disparity.filter(|_| scene.truth(i % scene.width, i / scene.width).is_some());
        }
    }
    map
}

/// Checks that `map` has at least `least_known` percent of the pixels that `plain` has, and that at most
/// `most_changed` percent of those differ by more than 1 px.
fn check_is_near(map: &Map, plain: &Map, least_known: usize, most_changed: usize, what: &str) {
    let differences = differences(map, plain);
    let changed = differences.iter().filter(|&&d| d > 16).count();
    let (common, all) = (differences.len(), plain.known().count());
    assert!(100 * common >= least_known * all, "{what}: {common} of {all} pixels known");
    assert!(100 * changed <= most_changed * common, "{what}: {changed} of {common} pixels differ");
}

/// An offset of the grey levels of both views or of one of them changes nothing, as long as it neither clips them nor makes
/// them so dark that the front end gives them gain.
pub fn an_offset_changes_nothing(subject: &Subject) {
    for (scene, config) in scenes() {
        let frame =
            scene.render().map(|v| v.saturating_add(40).clamp(30, 230), |v| v.saturating_add(40).clamp(30, 230));
        let expected = run(&mut *(subject.build)(config), &frame);
        for (left, right) in [(25, 25), (-20, -20), (0, 25), (-20, 0)] {
            let shifted = frame.map(|v| v.checked_add_signed(left).unwrap(), |v| v.checked_add_signed(right).unwrap());
            assert!(run(&mut *(subject.build)(config), &shifted) == expected, "offsets {left} and {right}");
        }
    }
}

/// With the right view at 80 percent of its grey levels, 90 percent of the pixels stay known, and at most
/// 5 percent of them change by more than 1 px.
pub fn a_gain_of_the_right_view_changes_little(subject: &Subject) {
    a_gain_keeps(subject, 90);
}

/// The same where that many percent stay known.
pub(super) fn a_gain_keeps(subject: &Subject, least_known: usize) {
    for (index, (scene, config)) in scenes().iter().enumerate() {
        let frame = scene.render();
        let plain = measured(subject, scene, *config, &frame);
        let darker = frame.map(|v| v, |v| u8::try_from((u16::from(v) * 4 + 2) / 5).unwrap());
        let map = subject.measure(*config, &darker);
        check_is_near(&map, &plain, least_known, 5, &format!("scene {index}"));
    }
}

/// Upside down, 75 percent of the pixels stay known, and few of them change by more than 1 px: 1 percent
/// without noise, 5 with a little noise and a blank wall, 15 with strong noise. Methods work downwards,
/// so the maps are not the same.
pub fn a_scene_upside_down_has_nearly_the_same_map(subject: &Subject) {
    upside_down_keeps(subject, 75);
}

/// The same where that many percent stay known.
pub(super) fn upside_down_keeps(subject: &Subject, least_known: usize) {
    for (index, ((scene, config), most_changed)) in scenes().iter().zip([1, 6, 15]).enumerate() {
        let frame = scene.render();
        let plain = measured(subject, scene, *config, &frame);
        let flipped = subject.measure(*config, &frame.flipped());
        let disparity = flipped.disparity.chunks(frame.width).rev().flatten().copied().collect();
        let map = Map { disparity, ..flipped };
        check_is_near(&map, &plain, least_known, most_changed, &format!("scene {index}"));
    }
}

/// In a mirror the right camera becomes the left one, and the map that of the right view: where both know
/// a pixel, 80 percent at least, they differ by 1/4 px at most in the median and by 1 px, in strong noise
/// by 2 px, at 9 of 10.
pub fn the_mirrored_frame_has_the_map_of_the_right_view(subject: &Subject) {
    the_mirror_keeps(subject, 80);
}

/// The same where that many percent are known in both.
pub(super) fn the_mirror_keeps(subject: &Subject, least_known: usize) {
    for (index, ((scene, config), tenth)) in scenes().iter().zip([16, 16, 32]).enumerate() {
        let frame = scene.render();
        let plain = measured(subject, scene, *config, &frame);
        let mirrored = subject.measure(*config, &frame.mirrored());
        let mut seen_by_right = Map { disparity: vec![None; plain.disparity.len()], ..plain.clone() };
        for (x, y, bits) in plain.known() {
            let column = x.wrapping_add_signed(-isize::from((bits + 8) >> 4));
            if column < frame.width {
                let pixel = &mut seen_by_right.disparity[(y + 1) * frame.width - 1 - column];
                // Of two that are seen in the same place, the nearer one hides the other.
                *pixel = (*pixel).max(Some(bits));
            }
        }
        let differences = differences(&mirrored, &seen_by_right);
        let (count, all) = (differences.len(), plain.known().count());
        assert!(100 * count >= least_known * all, "scene {index}: {count} of {all} pixels known in both");
        assert!(differences[count / 2] <= 4, "scene {index}: median {}/16 px", differences[count / 2]);
        assert!(differences[count * 9 / 10] <= tenth, "scene {index}: {}/16 px", differences[count * 9 / 10]);
    }
}

// Golden maps

/// Compares a scene's map with its golden file, after a look whether it deserves to be one: of the pixels on
/// textured surfaces, 75 percent are known and at most 9 percent of those more than 2 px wrong.
fn scene_is_golden(subject: &Subject, name: &str, scene: &Scene, config: Config) {
    let map = run(&mut *(subject.build)(config), &scene.render());
    subject.check(&map, &config);
    let pixels = (0..scene.height).flat_map(|y| (0..scene.width).map(move |x| (x, y)));
    let answers: Vec<_> = pixels.filter_map(|(x, y)| Some((scene.truth(x, y)?, map.at(x, y)))).collect();
    let known: Vec<_> = answers.iter().filter_map(|&(truth, found)| Some((truth, i32::from(found?)))).collect();
    let wrong = known.iter().filter(|(truth, found)| (truth - found).abs() > 32).count();
    let (known, all) = (known.len(), answers.len());
    assert!(100 * known >= 75 * all, "{name}: {known} of {all} pixels known");
    assert!(100 * wrong <= 9 * known, "{name}: {wrong} of {known} pixels wrong");
    golden::compare(&format!("{}_{name}", subject.name), &map);
}

/// A near and a far plane.
pub fn golden_map_of_two_planes(subject: &Subject) {
    scene_is_golden(subject, "two_planes", &two_planes(), config(96, 0, 24));
}

/// Ground, post and blank wall.
pub fn golden_map_of_a_street(subject: &Subject) {
    scene_is_golden(subject, "street", &street(), config(96, 0, 24));
}

/// The same in strong noise, with disparities from below 0 on.
pub fn golden_map_of_a_noisy_street(subject: &Subject) {
    scene_is_golden(subject, "noisy_street", &noisy_street(), config(93, -12, 32));
}
