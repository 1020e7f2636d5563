//! The properties of methods that answer some pixels only: as much as can be asked of all pixels is asked of
//! those that are known.

use super::Subject;
use super::content::Content;
use super::frame::Frame;
use super::map::{Map, run, run_with_losses};
use super::property::{a_gain_keeps, capacities_agree, config, right_answers, the_mirror_keeps, upside_down_keeps};

/// Checks that `map` has answers for one pixel in `one_in` at least, and that 96 percent of them are within
/// half a pixel of `disparity` px.
fn check_is_right(map: &Map, disparity: i32, one_in: usize, what: &str) {
    let (right, all) = right_answers(map, disparity, 8, 0);
    let known = map.known().count();
    assert!(100 * right >= 96 * known, "{what}: {right} of {known} answers are right");
    assert!(one_in * known >= all, "{what}: {known} of {all} pixels known");
}

/// A view shifted by k px has disparity k wherever it has one, whatever the width; 0 too is a disparity.
pub fn a_known_disparity_is_the_shift(subject: &Subject) {
    for (width, searches) in [
        (61, [(0, 16, 0), (0, 16, 13), (-16, 32, -7), (-8, 8, -8), (3, 9, 7), (4, 1, 4)]),
        (322, [(0, 32, 5), (0, 80, 70), (-128, 64, -120), (100, 29, 128), (0, 256, 130), (0, 16, 15)]),
    ] {
        for (seed, (min_disparity, num_disparities, disparity)) in (0..).zip(searches) {
            let config = config(width, min_disparity, num_disparities);
            let frame = Frame::shifted(width, 40, Content::Texture { seed }, disparity);
            let map = run(&mut *(subject.build)(config), &frame);
            check_is_right(&map, disparity, 25, &format!("{disparity} px, {config:?}"));
        }
    }
}

/// The same answer from every capacity.
pub fn every_capacity_gives_the_same_sparse_answer(subject: &Subject) {
    capacities_agree(subject, false);
}

/// Lost rows come out unknown, and the rows from `latency` away from them on are those of the whole frame.
pub fn lost_rows_and_no_distant_ones_are_unknown(subject: &Subject) {
    let frame = Frame::shifted(96, 48, Content::Texture { seed: 5 }, 5);
    let config = config(96, 0, 16);
    let whole = run(&mut *(subject.build)(config), &frame);
    for first in 0..48 {
        for count in [1, 2, 5, 13, 48] {
            let lost = first..first + count;
            let map = run_with_losses(&mut *(subject.build)(config), &frame, |y| lost.contains(&y));
            map.check(&config);
            for y in 0..48 {
                assert!(map.is_row_unknown(y) || !lost.contains(&y), "row {y} without {lost:?}");
                if y + subject.latency < first {
                    assert!(map.row(y) == whole.row(y), "row {y} without {lost:?}");
                }
            }
        }
    }
}

/// A frame that begins with lost rows is answered like any other from there on.
pub fn a_sparse_frame_may_begin_with_lost_rows(subject: &Subject) {
    for count in 1..=16 {
        let frame = Frame::shifted(96, 56, Content::Texture { seed: 6 }, 5);
        let map = run_with_losses(&mut *(subject.build)(config(96, 0, 16)), &frame, |y| y < count);
        check_is_right(&map, 5, 40, &format!("{count} rows lost"));
    }
}

/// With the right view at 80 percent of its grey levels 25 percent of the answers stay, and at most 5 percent
/// of them change by more than 1 px.
pub fn a_gain_of_the_right_view_keeps_most_answers(subject: &Subject) {
    a_gain_keeps(subject, 25);
}

/// Upside down 35 percent of the answers stay, and few of them change.
pub fn a_scene_upside_down_keeps_most_answers(subject: &Subject) {
    upside_down_keeps(subject, 35);
}

/// In a mirror 15 percent of the answers stay, as those of the right view: in strong noise envelopes are few.
pub fn the_mirrored_frame_keeps_answers(subject: &Subject) {
    the_mirror_keeps(subject, 15);
}

/// Makes a test of each property that sparse methods have, for one subject.
macro_rules! all_sparse_hold {
    ($subject:expr) => {
        $crate::common::all_hold! {
            $subject;
            any_frame_is_answered_within_bounds,
            any_widest_frame_is_answered_within_bounds,
            every_period_is_answered_within_bounds,
            rows_come_out_within_the_latency,
            a_reused_pipeline_equals_a_fresh_one,
            a_row_of_wrong_width_changes_nothing,
            views_without_texture_have_no_sure_answer,
            an_offset_changes_nothing,
        }
        $crate::common::all_hold! {
            in sparse_property of $subject;
            a_known_disparity_is_the_shift,
            every_capacity_gives_the_same_sparse_answer,
            lost_rows_and_no_distant_ones_are_unknown,
            a_sparse_frame_may_begin_with_lost_rows,
            a_gain_of_the_right_view_keeps_most_answers,
            a_scene_upside_down_keeps_most_answers,
            the_mirrored_frame_keeps_answers,
        }
    };
}
pub(crate) use all_sparse_hold;
