//! What a frame is worth as a whole: whether it can be what it should be, two views of one scene, row by row.
//!
//! Where a map is right, what the left view shows in a cell the right view shows where the answer says. The *mismatch* is the
//! sum of absolute differences of their features at the answers, as a share of what it would be if nothing matched:
//! 1000 x sum |left - right| / (2 x sum |left|), over windows of 8 x 2 px that show more than twice what noise makes, of
//! every fourth row of cells. Noise raises both sums, so that one limit does for all light.

use crate::ScanlinePair;
use crate::answer::confidence::SURE;
use crate::answer::evidence::Floor;
use crate::lanes::{add_halves, sad_add, select_ge_halves, splat_half};

/// With a greater mismatch, less a tenth of the share of sure answers, per mille, it is no stereo pair. Of the 36 recorded
/// scenes clean, in noise 5, noise 10 and low light, `full` and `lite`, right ones have at most 208 but for two (these, lit
/// otherwise in one view, up to 239, and 272); swapped, two and six rows off and unrelated ones have at least 217. A wrong pair
/// that matches by accident is not sure of it.
pub const MOST_MISMATCH: u16 = 212;
/// With a smaller share of windows in which there is more than three times what noise makes, per mille, nothing was seen.
/// Recorded scenes have 110 at least, noise alone less than 40 and mostly none.
pub const LEAST_SEEN: u32 = 60;
/// So much of the share of sure answers is taken from the mismatch.
const SURE_PART: u16 = 10;
/// Fewer windows than this say nothing of a frame.
const LEAST_WINDOWS: u32 = 48;
/// One of so many rows of tiles is looked at.
const SAMPLING: u32 = 2;

/// What a frame is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "packet", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Input {
    /// Two views of one scene.
    Ok,
    /// Something, but not two views of one scene, rectified and in order.
    Mismatch,
    /// Nothing to see: dark, a lens cap, fog, a blank wall.
    NothingSeen,
    /// Both views are the same image.
    SameView,
}

impl Input {
    /// As it is called in tables and logs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Mismatch => "mismatch",
            Self::NothingSeen => "nothing-seen",
            Self::SameView => "same-view",
        }
    }

    /// What to check, if it is not as it should be.
    #[must_use]
    pub const fn advice(self) -> Option<&'static str> {
        match self {
            Self::Ok => None,
            Self::Mismatch => Some(
                "the views do not match: check that left and right are not swapped, that both are of one moment, \
                 and that they are rectified, with no rows of offset between them",
            ),
            Self::NothingSeen => Some("nothing to see in the left view: check light, lens cap and exposure"),
            Self::SameView => Some("left and right are the same image: check how the views are named or wired"),
        }
    }
}

/// The figures of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "packet", derive(serde::Serialize, serde::Deserialize))]
pub struct FrameFigures {
    /// What it is.
    pub input: Input,
    /// Share of what the left view shows that the right view contradicts, per mille; none where nothing is seen.
    pub mismatch: Option<u16>,
    /// Share of the pixels with a sure answer, per mille.
    pub sure: u16,
    /// How far the right view lies lower, 1/256 px: a running figure of this frame and those before, told behind
    /// [`Rectified`](crate::Rectified) only; none where too little was sure of late.
    pub row_error_q8: Option<i16>,
}

/// Tells whether a rig has bent, by the running row error of its frames.
#[derive(Debug, Clone, Copy, Default)]
pub struct Bend {
    is_bent: bool,
}

impl Bend {
    /// A row error as great as this is a bent rig's, 1/256 px: half a row, which costs `full` three points of tot2.
    pub const LEAST_Q8: u16 = 128;
    /// Below this it is one no longer.
    pub const OVER_Q8: u16 = 96;

    /// Takes the figures of the next frame; whether the rig is bent. What is not known changes nothing.
    pub fn take(&mut self, figures: Option<FrameFigures>) -> bool {
        if let Some(error) = figures.and_then(|figures| figures.row_error_q8) {
            let limit = if self.is_bent { Self::OVER_Q8 } else { Self::LEAST_Q8 };
            self.is_bent = error.unsigned_abs() >= limit;
        }
        self.is_bent
    }
}

/// Decides frame by frame whether obstacles are told at all. Cameras whose frames matched do not become swapped or bent
/// from one frame to the next, but a thing close to cameras that are not quite rectified does not match: so of cameras
/// that were right once it takes several wrong frames in a row.
#[derive(Debug, Clone, Copy, Default)]
pub struct Trust {
    was_ok: bool,
    mismatches: u32,
}

impl Trust {
    /// Frames in a row that must not match before cameras that matched are no longer believed.
    const PATIENCE: u32 = 8;

    /// Takes the next frame; whether obstacles are told of it.
    pub fn take(&mut self, input: Input) -> bool {
        match input {
            Input::Ok => {
                *self = Self { was_ok: true, mismatches: 0 };
                true
            }
            Input::Mismatch => {
                self.mismatches = self.mismatches.saturating_add(1);
                self.was_ok &= self.mismatches < Self::PATIENCE;
                self.was_ok
            }
            Input::NothingSeen | Input::SameView => false,
        }
    }
}

/// What the figures of a frame are made of.
#[derive(Debug, Clone, Default)]
pub(crate) struct FrameSums {
    windows: u32,
    seen: u32,
    difference: u64,
    strength: u64,
    pixels: u32,
    sure: u32,
    /// Whether the views differ anywhere.
    differ: bool,
}

impl FrameSums {
    /// Takes two rows as they came.
    #[inline(always)]
    pub(crate) fn compare(&mut self, pair: ScanlinePair<'_>) {
        self.differ = self.differ || pair.left != pair.right;
    }

    /// Whether a row of tiles is looked at.
    pub(crate) const fn is_sampled(row: u32) -> bool {
        row.is_multiple_of(SAMPLING)
    }

    /// Takes a row of cells, four a word: sums of absolute differences at what they answer, and of the magnitudes of their
    /// features.
    #[inline(never)]
    pub(crate) fn add<'a>(&mut self, cells: impl ExactSizeIterator<Item = [&'a [u8; 4]; 2]>, floor: Floor) {
        // Features are limited: where noise alone comes near that, it has to do.
        let most = 255_u32.saturating_sub(floor.zero);
        let least = splat_half(floor.noise.saturating_mul(2).min(10 * most));
        let much = splat_half(if floor.is_drowned { 0xffff } else { floor.noise.saturating_mul(3).min(12 * most) });
        // The windows of two cells, two a word; at most 160 of them.
        let windows = |cells: &[u8; 4]| {
            let cells = u32::from_le_bytes(*cells);
            add_halves(cells & 0x00ff_00ff, cells >> 8 & 0x00ff_00ff)
        };
        self.windows = self.windows.saturating_add(2 * u32::try_from(cells.len()).unwrap_or(0));
        let (mut difference, mut strength, mut seen) = (0, 0, 0);
        for cells in cells {
            let [off, here] = cells.map(windows);
            difference = add_halves(difference, select_ge_halves(here, least, off, 0));
            strength = add_halves(strength, select_ge_halves(here, least, here, 0));
            seen = add_halves(seen, select_ge_halves(here, much, splat_half(1), 0));
        }
        let both = |halves: u32| (halves & 0xffff) + (halves >> 16);
        self.seen = self.seen.saturating_add(both(seen));
        self.difference += u64::from(both(difference));
        self.strength += u64::from(both(strength));
    }

    /// Takes the confidences of the columns of a row of cells.
    #[inline(never)]
    pub(crate) fn count_sure(&mut self, confidence: &[[u8; 4]]) {
        const { assert!(SURE == 64) };
        // A lane of 64 and more has one of its two highest bits set.
        let sure = confidence.iter().fold(0, |sum, &cell| {
            let cell = u32::from_le_bytes(cell);
            sad_add((cell | cell << 1) >> 7 & 0x0101_0101, 0, sum)
        });
        self.sure = self.sure.saturating_add(sure);
        self.pixels = self.pixels.saturating_add(4 * u32::try_from(confidence.len()).unwrap_or(0));
    }

    /// The figures of the frame; none before anything was answered.
    ///
    /// - `is_dark`: whether both views are.
    pub(crate) fn figures(&self, is_dark: bool) -> Option<FrameFigures> {
        if self.pixels == 0 {
            return None;
        }
        let mismatch = (self.strength > 0).then(|| per_mille(self.difference, 2 * self.strength));
        let sure = per_mille(self.sure.into(), self.pixels.into());
        let input = if self.windows < LEAST_WINDOWS {
            Input::Ok
        } else if is_dark || 1000 * u64::from(self.seen) < u64::from(LEAST_SEEN * self.windows) {
            Input::NothingSeen
        } else if !self.differ {
            Input::SameView
        } else if mismatch.is_some_and(|mismatch| mismatch.saturating_sub(sure / SURE_PART) > MOST_MISMATCH) {
            Input::Mismatch
        } else {
            Input::Ok
        };
        Some(FrameFigures { input, mismatch, sure, row_error_q8: None })
    }
}

/// A share, per mille.
fn per_mille(part: u64, whole: u64) -> u16 {
    u16::try_from(1000 * part / whole.max(1)).unwrap_or(u16::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Config, Full, Lite, Rectified, StereoMethod, blocks_for, rectify::Ramp};

    const WIDTH: u16 = 160;
    const ROWS: u32 = 60;

    /// A texture of one seed, somewhat smooth.
    fn texture(seed: u32, x: u32, y: u32) -> u8 {
        let corner = |i: u32, j: u32| {
            let mixed = (i.wrapping_mul(0x9e37_79b1) ^ j.wrapping_mul(0x85eb_ca77) ^ seed).wrapping_mul(0xc2b2_ae3d);
            (mixed >> 24) * 3 / 4
        };
        let (i, j, u, v) = (x / 3, y / 3, x % 3, y % 3);
        let along = |j: u32| corner(i, j) * (3 - u) + corner(i + 1, j) * u;
        ((along(j) * (3 - v) + along(j + 1) * v) / 9).to_le_bytes()[0]
    }

    /// The figures of a frame of what the views show at column and row.
    fn figures(
        method: &mut dyn StereoMethod,
        left: impl Fn(u32, u32) -> u8,
        right: impl Fn(u32, u32) -> u8,
    ) -> FrameFigures {
        for y in 0..ROWS {
            let row = |view: &dyn Fn(u32, u32) -> u8| -> [u8; WIDTH as usize] {
                core::array::from_fn(|x| view(u32::try_from(x).unwrap(), y))
            };
            let (left, right) = (row(&left), row(&right));
            method.push(ScanlinePair { left: &left, right: &right }, &mut |_| ()).unwrap();
        }
        method.finish(&mut |_| ());
        method.figures().unwrap()
    }

    fn config() -> Config {
        Config { num_disparities: 32, ..Config::for_width(WIDTH) }
    }

    fn methods() -> (Full<{ blocks_for(WIDTH) }>, Lite<{ blocks_for(WIDTH) }>) {
        (Full::new(config()).unwrap(), Lite::new(config()).unwrap())
    }

    #[test]
    fn a_pair_matches_and_what_is_none_is_told() {
        let (mut full, mut lite) = methods();
        let methods: [&mut dyn StereoMethod; 2] = [&mut full, &mut lite];
        let noise = |x: u32, y: u32| 120 + texture(x * 4 + 77 * y, 4 * x, 4 * y) % 4;
        for method in methods {
            assert_eq!(method.figures(), None);
            let left = |x, y| texture(1, x + 40, y);
            let right = figures(method, left, |x, y| texture(1, x + 48, y));
            assert_eq!(right.input, Input::Ok, "{right:?}");
            assert!(right.mismatch.is_some_and(|mismatch| mismatch < 100) && right.sure > 600, "{right:?}");
            let swapped = figures(method, |x, y| texture(1, x + 48, y), left);
            assert_eq!(swapped.input, Input::Mismatch, "{swapped:?}");
            let lower = figures(method, left, |x, y| texture(1, x + 48, y + 3));
            assert_eq!(lower.input, Input::Mismatch, "{lower:?}");
            let unrelated = figures(method, left, |x, y| texture(9, x, y));
            assert_eq!(unrelated.input, Input::Mismatch, "{unrelated:?}");
            assert_eq!(figures(method, left, left).input, Input::SameView);
            let blank = figures(method, |_, _| 90, |_, _| 91);
            assert_eq!((blank.input, blank.mismatch), (Input::NothingSeen, None));
            assert_eq!(figures(method, noise, |x, y| noise(x + 999, y)).input, Input::NothingSeen);
            // What came before changes nothing.
            assert_eq!(figures(method, left, |x, y| texture(1, x + 48, y)), right);
        }
    }

    #[test]
    fn the_same_view_is_told_behind_rectification_too() {
        let (full, _) = methods();
        let mut behind = Rectified::<_, 8, { WIDTH as usize }>::new(full, 60, Ramp::whole(2).into()).unwrap();
        let left = |x, y| texture(1, x + 40, y + 2);
        assert_eq!(figures(&mut behind, left, left).input, Input::SameView);
        assert_eq!(figures(&mut behind, left, |x, y| texture(1, x + 48, y)).input, Input::Ok);
    }

    #[test]
    fn cameras_that_matched_are_believed_for_a_while_and_others_not_at_all() {
        let told = |inputs: &[Input], wanted: &[bool]| {
            let mut trust = Trust::default();
            assert!(inputs.iter().map(|&input| trust.take(input)).eq(wanted.iter().copied()));
        };
        told(&[Input::Mismatch; 9], &[false; 9]);
        let mut inputs = [Input::Mismatch; 13];
        (inputs[0], inputs[10], inputs[11]) = (Input::Ok, Input::Ok, Input::NothingSeen);
        let (yes, no) = (true, false);
        told(&inputs, &[yes, yes, yes, yes, yes, yes, yes, yes, no, no, yes, no, yes]);
    }

    #[test]
    fn a_rig_is_bent_from_half_a_row_on_and_until_it_is_less_than_three_eighths() {
        let mut bend = Bend::default();
        let mut take = |error| {
            let figures = FrameFigures { input: Input::Ok, mismatch: None, sure: 0, row_error_q8: error };
            bend.take(Some(figures))
        };
        assert_eq!(
            [Some(127), Some(-128), None, Some(97), Some(95), Some(-127)].map(&mut take),
            [false, true, true, true, false, false]
        );
    }

    #[test]
    fn sure_columns_are_counted() {
        let mut sums = FrameSums::default();
        assert_eq!(sums.figures(false), None);
        sums.count_sure(&[[63, 64, 127, 128], [192, 255, 0, 1]]);
        assert_eq!(sums.figures(false).map(|figures| figures.sure), Some(625));
    }
}
