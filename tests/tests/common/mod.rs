//! Properties that hold for every stereo method, and the frames that show them.
//!
//! A test file names its method by a [`Subject`] and makes a test of each property with [`all_hold!`].

pub mod content;
pub mod frame;
pub mod golden;
pub mod map;
pub mod property;
pub mod scene;
pub mod sparse_property;

use haarline::{Config, StereoMethod};

use frame::Frame;
use map::{Map, run};

/// Builds a method.
pub type Build = fn(Config) -> Box<dyn StereoMethod>;

/// The method that the properties are shown for.
pub struct Subject {
    /// Its name, as golden files are named after it.
    pub name: &'static str,
    /// Builds it with room to spare, for any width.
    pub build: Build,
    /// Builds it with the least capacity that holds rows of the configured width, one of
    /// [`TIGHT_WIDTHS`].
    pub build_tight: Build,
    /// Builds it for the widest rows there are.
    pub build_widest: Build,
    /// Rows that come in after a row before it goes out, at most.
    pub latency: usize,
    /// Whether it answers what it has not measured, too, by a guess of little confidence.
    pub guesses: bool,
}

impl Subject {
    /// Checks what holds for the answer to any frame.
    pub fn check(&self, map: &Map, config: &Config) {
        if self.guesses { map.check_dense(config) } else { map.check(config) }
    }

    /// What it makes of a frame, guesses left out.
    pub fn measure(&self, config: Config, frame: &Frame) -> Map {
        let map = run(&mut *(self.build)(config), frame);
        if self.guesses { map.without_guesses() } else { map }
    }
}

/// Widths for which [`Subject::build_tight`] is made, px.
pub const TIGHT_WIDTHS: [u16; 6] = [32, 33, 61, 97, 160, 322];

/// Makes a test of each property, for one subject.
macro_rules! all_hold {
    ($subject:expr) => {
        $crate::common::all_hold! {
            $subject;
            any_frame_is_answered_within_bounds,
            any_widest_frame_is_answered_within_bounds,
            every_period_is_answered_within_bounds,
            a_tall_frame_is_answered_to_its_end,
            a_shift_of_k_pixels_has_disparity_k,
            shifted_random_pixels_have_disparity_k,
            every_capacity_gives_the_same_answer,
            rows_come_out_within_the_latency,
            a_reused_pipeline_equals_a_fresh_one,
            a_row_of_wrong_width_changes_nothing,
            lost_rows_come_out_unknown,
            rows_far_from_a_lost_one_are_as_if_it_were_there,
            a_frame_may_begin_with_lost_rows,
            an_offset_changes_nothing,
            a_gain_of_the_right_view_changes_little,
            a_scene_upside_down_has_nearly_the_same_map,
            the_mirrored_frame_has_the_map_of_the_right_view,
            golden_map_of_two_planes,
            golden_map_of_a_street,
            golden_map_of_a_noisy_street,
        }
    };
    ($subject:expr; $($property:ident),+ $(,)?) => {
        $crate::common::all_hold! { in property of $subject; $($property),+ }
    };
    (in $module:ident of $subject:expr; $($property:ident),+ $(,)?) => {
        $(
            #[test]
            fn $property() {
                $crate::common::$module::$property(&$subject);
            }
        )+
    };
}
pub(crate) use all_hold;
