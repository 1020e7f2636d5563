//! What a recording says of its rig's description: rows, order of the views, agreement of both, far points.

use anyhow::{Result, ensure};
use haarline::align::{Estimate, Order, Verdict};
use haarline::confidence::SURE;
use haarline::frame_figures::Input;
use haarline::{Rectification, StereoMethod};

use super::align::{self, Displacement, PARTS, Parts};
use crate::stereo::disparity_map::px;
use crate::stereo::pipeline;
use crate::{DisparityMap, Frame, StereoPair};

/// Both maps of a point differ by less than this where they agree, px.
const AGREE_PX: f64 = 1.0;
/// Bins of the histogram of disparities in a pixel.
pub const BINS_A_PX: usize = 4;
/// The least of the sure disparities, per mille, may be errors.
const OUTLIERS_PER_MILLE: usize = 5;
/// So many of the next ones, per mille, make the far end.
const FAR_PER_MILLE: usize = 10;
/// Sure answers in all without which no far end is told.
const LEAST_ANSWERS: usize = 2000;

/// Rectified views whose residual row error is above this cost accuracy, px.
pub const MOST_ROWS: f64 = 0.25;
/// A part of the view whose row error, less that of the whole, is above this shows lenses, px.
pub const MOST_BEND: f64 = 0.5;
/// Least share of sure answers whose disparity the right view's map confirms, percent. The 36 scenes have 88 and more.
pub const LEAST_AGREEMENT: f64 = 80.0;
/// Least share of sure answers, percent.
pub const LEAST_SURE: f64 = 20.0;
/// A far end below this disparity cannot be, px: nothing is farther than infinity.
pub const LEAST_DISPARITY: f64 = -0.5;

/// A share by part of the view.
#[derive(Debug, Clone, Default)]
pub struct Shares {
    counts: [[[usize; 2]; PARTS[0]]; PARTS[1]],
}

impl Shares {
    fn count(&mut self, [x, y]: [usize; 2], size: [usize; 2], is_so: bool) {
        let [all, those] = &mut self.counts[y * PARTS[1] / size[1]][x * PARTS[0] / size[0]];
        *all += 1;
        *those += usize::from(is_so);
    }

    /// Percent in each part; none where nothing was counted.
    #[must_use]
    pub fn parts(&self) -> Parts {
        self.counts.map(|row| row.map(percent))
    }

    /// Percent of the whole view.
    #[must_use]
    pub fn whole(&self) -> Option<f64> {
        let counts = self.counts.as_flattened();
        percent([0, 1].map(|nth| counts.iter().map(|count| count[nth]).sum()))
    }
}

fn percent([all, those]: [usize; 2]) -> Option<f64> {
    (all > 0).then(|| 100.0 * those as f64 / all as f64)
}

/// What the frames of a recording show behind their rig's rectification.
#[derive(Debug, Clone)]
pub struct Seen {
    size: [usize; 2],
    /// Frames.
    pub frames: usize,
    /// Frames that are no stereo pair, and what each of them is.
    pub inputs: Vec<Input>,
    /// Sure answers.
    pub sure: Shares,
    /// Sure answers of the left view's map that the right view's confirms.
    pub agreement: Shares,
    /// Sure disparities, of [`BINS_A_PX`] bins a pixel, from `least_px` on.
    pub histogram: Vec<usize>,
    /// Where the histogram begins, px.
    pub least_px: f64,
}

impl Seen {
    /// Nothing yet, of views of `size` px and a method that searches from `min_disparity` on, `count` px.
    #[must_use]
    pub fn new(size: [usize; 2], min_disparity: i16, count: u16) -> Self {
        let (sure, agreement) = (Shares::default(), Shares::default());
        // A correction may move some beyond the search.
        let least_px = f64::from(min_disparity) - 8.0;
        let histogram = vec![0; BINS_A_PX * (usize::from(count) + 16)];
        Self { size, frames: 0, inputs: Vec::new(), sure, agreement, histogram, least_px }
    }

    /// Takes a frame as its cameras took it; the map of its left view.
    ///
    /// # Errors
    /// If its size is not that of the others, or the rectification is not for it.
    pub fn add(
        &mut self,
        method: &mut dyn StereoMethod,
        rectification: &Rectification,
        pair: &StereoPair,
    ) -> Result<DisparityMap> {
        let size = [pair.width(), pair.height()];
        ensure!(size == self.size, "a frame of {}x{} px, where others have another size", size[0], size[1]);
        let plain = Rectification { correction: None, ..*rectification };
        let run = pipeline::run_rectified(method, &plain, pair)?;
        let mut map = run.map;
        let views = pipeline::rectified_views(&plain, pair)?;
        let mirrored = StereoPair { left: mirror(&views.right), right: mirror(&views.left) };
        let other = pipeline::run(method, &mirrored)?.map;
        for y in 0..size[1] {
            for x in 0..size[0] {
                let is_sure = map.confidence[y * size[0] + x] >= SURE;
                self.sure.count([x, y], size, is_sure);
                let Some(bits) = map.at(x, y).known().filter(|_| is_sure) else { continue };
                if let Some(agrees) = confirmed(&other, [x, y], px(bits)) {
                    self.agreement.count([x, y], size, agrees);
                }
            }
        }
        if let Some(correction) = rectification.correction {
            let correction = correction.of_size(size.map(|side| side as u16));
            for (y, row) in (0..).zip(map.disparity.chunks_mut(size[0])) {
                correction.apply(y, row);
            }
        }
        self.frames += 1;
        self.inputs.extend(run.figures.map(|figures| figures.input).filter(|&input| input != Input::Ok));
        for (disparity, &confidence) in map.disparity.iter().zip(&map.confidence) {
            let Some(bits) = disparity.known().filter(|_| confidence >= SURE) else { continue };
            let bin = ((px(bits) - self.least_px) * BINS_A_PX as f64).floor();
            if let Some(bin) = self.histogram.get_mut(bin.max(0.0) as usize) {
                *bin += 1;
            }
        }
        Ok(map)
    }

    /// The disparity of the farthest things that were seen, px: the mean of a hundredth of all sure answers, the least ones but
    /// for a few. None where little was sure.
    #[must_use]
    pub fn far_px(&self) -> Option<f64> {
        let total: usize = self.histogram.iter().sum();
        let [skip, take] = [OUTLIERS_PER_MILLE, FAR_PER_MILLE].map(|share| total * share / 1000);
        let (mut before, mut sum) = (0, 0.0);
        for (bin, &count) in self.histogram.iter().enumerate() {
            let part = |edge: usize| (edge.saturating_sub(before)).min(count);
            let taken = part(skip + take) - part(skip);
            sum += taken as f64 * (self.least_px + (bin as f64 + 0.5) / BINS_A_PX as f64);
            before += count;
        }
        (total >= LEAST_ANSWERS).then(|| sum / take as f64)
    }
}

/// Whether the map of the mirrored right view has, at the pixel that a disparity names, that disparity too; `None` where it
/// says nothing.
fn confirmed(other: &DisparityMap, [x, y]: [usize; 2], disparity: f64) -> Option<bool> {
    let column = x as f64 - disparity.round();
    let mirrored = other.width as f64 - 1.0 - column;
    if !(0.0..other.width as f64).contains(&mirrored) {
        return None;
    }
    let there = px(other.at(mirrored as usize, y).known()?);
    Some((there - disparity).abs() <= AGREE_PX)
}

fn mirror(frame: &Frame) -> Frame {
    let rows = frame.luma.chunks(frame.width).flat_map(|row| row.iter().rev().copied()).collect();
    Frame::from_luma(frame.width, frame.height, rows)
}

/// What was found, and what to do about it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Advice {
    /// What is not as it should be.
    pub finding: String,
    /// What to turn, swap or run.
    pub to_do: String,
}

/// All that was found of a rig.
#[derive(Debug, Clone)]
pub struct Checked {
    /// Figures of the frames.
    pub seen: Seen,
    /// Alignment of the views that the description's rectification makes.
    pub estimate: Estimate,
    /// Row errors by part of the view, px; positive: the right view lies lower.
    pub rows: Parts,
    /// Of the rig: focal length, px; `doffs`, px.
    pub focal_px: f64,
    /// What is added to disparities before they become depths, px.
    pub doffs: f64,
    /// Whether lens tables straighten the views.
    pub has_lenses: bool,
}

impl Checked {
    /// The alignment in the units of a description.
    #[must_use]
    pub fn displacement(&self) -> Displacement {
        Displacement::from(&self.estimate.ramp)
    }

    /// Whether the row error is known.
    #[must_use]
    pub fn is_observable(&self) -> bool {
        matches!(self.estimate.verdict(), Verdict::Observable | Verdict::OutOfRange)
    }

    /// The greatest row error that the ramp makes anywhere in the view, px.
    #[must_use]
    pub fn worst_ramp(&self) -> f64 {
        let size = self.seen.size.map(|side| side as i32);
        let corners = [[-1, -1], [1, -1], [-1, 1], [1, 1]].map(|[x, y]| [x * (size[0] - 1), y * (size[1] - 1)]);
        let rows = corners.map(|twice| self.estimate.ramp.displacement_q16(twice));
        rows.into_iter().map(|rows| (f64::from(rows) / 65_536.0).abs()).fold(0.0, f64::max)
    }

    /// By how much parts of the view differ at most from the ramp, px.
    #[must_use]
    pub fn worst_bend(&self) -> f64 {
        let size = self.seen.size.map(|side| side as f64);
        let mut worst: f64 = 0.0;
        for (down, row) in self.rows.iter().enumerate() {
            for (across, rows) in row.iter().enumerate() {
                let Some(rows) = rows else { continue };
                let middle = |part: usize, j: usize| (2 * part + 1) as f64 * size[j] / PARTS[j] as f64 - size[j];
                let twice = [middle(across, 0), middle(down, 1)].map(|twice| twice.round() as i32);
                let ramp = f64::from(self.estimate.ramp.displacement_q16(twice)) / 65_536.0;
                worst = worst.max((rows - ramp).abs());
            }
        }
        worst
    }

    /// Disparity of the farthest things, as it becomes depth, px; 0 is infinity.
    #[must_use]
    pub fn far_px(&self) -> Option<f64> {
        self.seen.far_px().map(|px| px + self.doffs)
    }

    /// What is wrong, and what to do; nothing if all is well. What may only follow from views that are swapped or whose rows
    /// are off is told when that is put right.
    #[must_use]
    pub fn advice(&self) -> Vec<Advice> {
        let mut all = Vec::new();
        let mut add = |finding: String, to_do: &str| all.push(Advice { finding, to_do: to_do.to_owned() });
        self.add_order(&mut add);
        self.add_rows(&mut add);
        if all.is_empty() {
            let mut add = |finding: String, to_do: &str| all.push(Advice { finding, to_do: to_do.to_owned() });
            self.add_rest(&mut add);
        }
        all
    }

    fn add_order(&self, add: &mut impl FnMut(String, &str)) {
        match self.estimate.order() {
            Order::Swapped => add(
                "left and right are exchanged".to_owned(),
                "swap the cameras or their folders, or set first = \"right\" (or \"left\") in the description",
            ),
            // Disparities that are too small by themselves are told as such.
            Order::Contradictory if self.far_px().is_some_and(|far| far < LEAST_DISPARITY) => {}
            Order::Contradictory => add(
                "disparities and the ground say different things of which view is the left one".to_owned(),
                "look at the picture: is the left view what the left camera sees? If so, column_offset is missing",
            ),
            Order::AsGiven | Order::NotObservable => {}
        }
    }

    /// What is wrong with many of the frames as a whole; whether there is anything.
    fn add_inputs(&self, add: &mut impl FnMut(String, &str)) -> bool {
        let mut is_any = false;
        for input in [Input::Mismatch, Input::NothingSeen, Input::SameView] {
            let count = self.seen.inputs.iter().filter(|&&found| found == input).count();
            // Single frames may show what cannot be matched.
            if 4 * count > self.seen.frames {
                let advice = input.advice().unwrap_or_default();
                is_any = true;
                add(format!("{count} of {} frames: {}", self.seen.frames, input.name()), advice);
            }
        }
        is_any
    }

    fn add_rest(&self, add: &mut impl FnMut(String, &str)) {
        self.add_inputs(add);
        if let Some(share) = self.seen.sure.whole().filter(|&share| share < LEAST_SURE) {
            add(
                format!("{share:.0} % of the answers are sure"),
                "check light, focus and exposure; show it something with texture",
            );
        }
        if let Some(share) = self.seen.agreement.whole().filter(|&share| share < LEAST_AGREEMENT) {
            add(
                format!("the right view confirms {share:.0} % of the sure answers only"),
                "check that both views are of one moment and equally sharp, and their rows",
            );
        }
        if let Some(far) = self.far_px().filter(|&far| far < LEAST_DISPARITY) {
            add(
                format!("disparities down to {far:.2} px: farther than infinity"),
                &format!("add {} or more to column_offset, or calibrate the rig", (-far).ceil()),
            );
        }
    }

    /// What to turn by hand instead, as far as that makes a tenth of a row or more.
    fn turns(&self) -> String {
        let Displacement { rows, roll_deg, scale_percent } = self.displacement();
        let [width, height] = self.seen.size.map(|side| side as f64);
        let mut all = Vec::new();
        if rows.abs() >= 0.1 {
            let tilt = (rows.abs() / self.focal_px).atan().to_degrees();
            all.push(format!("tilt the right camera {} by {tilt:.2} degrees", if rows > 0.0 { "down" } else { "up" }));
        }
        if roll_deg.to_radians().abs() * width / 2.0 >= 0.1 {
            let side = if roll_deg > 0.0 { "clockwise" } else { "counter-clockwise" };
            all.push(format!("turn it {side} by {:.2} degrees, as seen from behind", roll_deg.abs()));
        }
        if scale_percent.abs() / 100.0 * height / 2.0 >= 0.1 {
            all.push(format!(
                "its view is {scale_percent:.2} % higher: other lenses or focus, which only a calibration mends"
            ));
        }
        if all.is_empty() { String::new() } else { format!("; or {}", all.join("; ")) }
    }

    fn add_rows(&self, add: &mut impl FnMut(String, &str)) {
        match self.estimate.verdict() {
            Verdict::NotObservable if self.add_inputs(add) => {}
            Verdict::NotObservable => add(
                "the row error is not observable".to_owned(),
                "take frames of textured surroundings that are not too near",
            ),
            Verdict::Contradictory => add(
                format!("the row error is contradictory: {}", align::contradiction(&self.estimate).unwrap_or_default()),
                "take both views at one moment (one trigger for both cameras)",
            ),
            Verdict::OutOfRange => add(
                "rows are more than 16 px off, or turned or scaled by more than 5".to_owned(),
                "turn the right camera until both views show the same in the same rows",
            ),
            Verdict::Observable => {
                let (worst, bend) = (self.worst_ramp(), self.worst_bend());
                let off = format!("rows are up to {worst:.2} px off");
                if worst > MOST_ROWS && self.has_lenses {
                    add(
                        off,
                        "the cameras moved since they were calibrated, the calibration is poor, or the frames are rectified already \
                         (haarline rig import --rectified): calibrate anew (docs/rig.md)",
                    );
                } else if worst > MOST_ROWS {
                    add(off, &format!("haarline align RECORDING -o RIG.toml --update{}", self.turns()));
                }
                // Before rows are about right, parts differ by what is to be put right.
                if bend > MOST_BEND && worst <= MOST_ROWS {
                    add(
                        format!("parts of the view are up to {bend:.2} rows off beyond what turning mends: the lenses"),
                        "calibrate with chessboards and haarline rig import (docs/rig.md)",
                    );
                }
            }
        }
    }
}
