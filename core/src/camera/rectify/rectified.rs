//! A stereo method behind a rig that is rectified as it streams.

use super::plan::Plan;
use super::{Offset, Rectification, Rectifier};
use crate::frame_figures::{FrameFigures, Input};
use crate::front_end::noise::RawNoise;
use crate::front_end::sampling::Sampling;
use crate::row_watch::RowWatch;
use crate::{
    Config, ConfigError, Correction, Disparity, DisparityRow, RowError, ScanlinePair, Stage, StageClock, StereoMethod,
    Untimed,
};

/// A stereo method behind a rig's rectification: takes the rows as they come, hands on rectified ones, corrects the
/// disparities.
///
/// It watches whether the rig bends meanwhile ([`FrameFigures::row_error_q8`]).
///
/// As [`Rectifier`] with the capacities `ROWS` and `WIDTH`. Rows that are missed there are missed by the method: their
/// disparities come out unknown. A rig without displacement costs nothing: its rows are handed on as they are.
#[derive(Debug, Clone)]
pub struct Rectified<M, const ROWS: usize, const WIDTH: usize, C = Untimed> {
    method: M,
    clock: C,
    /// `None` where nothing is displaced.
    rectifier: Option<Rectifier<ROWS, WIDTH>>,
    noise: RawNoise,
    /// Whether the views differ in a row of this frame, before they are rectified.
    differ: bool,
    /// Whether those of the last frame were the same image.
    were_same: bool,
    after: After<WIDTH>,
}

/// What comes before and after the method.
#[derive(Debug, Clone)]
struct After<const WIDTH: usize> {
    watch: RowWatch<WIDTH>,
    correction: Option<Correction>,
    corrected: [Disparity; WIDTH],
}

impl<M: StereoMethod, const ROWS: usize, const WIDTH: usize> Rectified<M, ROWS, WIDTH> {
    /// Puts `method` behind cameras of `height` rows that are put right by `rectification`.
    ///
    /// # Errors
    /// As [`Rectifier::new`].
    pub fn new(method: M, height: u16, rectification: Rectification) -> Result<Self, ConfigError> {
        Self::timed(method, height, rectification, Untimed)
    }
}

impl<M: StereoMethod, const ROWS: usize, const WIDTH: usize, C: StageClock> Rectified<M, ROWS, WIDTH, C> {
    /// The same with a clock that is told when rectification begins; the method tells its own stages.
    ///
    /// # Errors
    /// As [`Rectifier::new`].
    // In line: else the rows are moved from function to function, each with room for all of them on the stack.
    #[inline(always)]
    pub fn timed(method: M, height: u16, rectification: Rectification, clock: C) -> Result<Self, ConfigError> {
        if usize::from(method.config().width) > WIDTH {
            return Err(ConfigError::Capacity { max_width: u16::try_from(WIDTH).unwrap_or(u16::MAX) });
        }
        if rectification.columns.unsigned_abs() > Offset::MAX_COLUMNS.unsigned_abs() {
            return Err(ConfigError::ColumnOffset);
        }
        let size = [method.config().width, height];
        let correction = rectification.correction.map(|correction| correction.of_size(size));
        let plan =
            if rectification.is_straight() { None } else { Some(Plan::new(size, rectification, [ROWS, WIDTH])?) };
        let mut this = Self {
            method,
            clock,
            rectifier: None,
            noise: RawNoise::new(),
            differ: false,
            were_same: false,
            after: After { watch: RowWatch::new(size), correction, corrected: [Disparity::UNKNOWN; WIDTH] },
        };
        if let Some(plan) = plan {
            this.rectifier.insert(Rectifier::of(plan)).start();
        }
        Ok(this)
    }

    /// The method behind.
    #[must_use]
    pub const fn method(&self) -> &M {
        &self.method
    }

    /// The method behind, without what is before it.
    #[must_use]
    pub fn into_method(self) -> M {
        self.method
    }

    /// At most so many rows after a row came it reaches the method.
    #[must_use]
    pub fn waiting_rows(&self) -> usize {
        self.rectifier.as_ref().map_or(0, Rectifier::waiting_rows)
    }
}

/// Hands a row on.
fn hand_on<M: StereoMethod, const WIDTH: usize>(
    method: &mut M,
    after: &mut After<WIDTH>,
    clock: &impl StageClock,
    pair: Option<ScanlinePair<'_>>,
    sink: &mut dyn FnMut(DisparityRow<'_>),
) -> Result<(), RowError> {
    match pair {
        Some(pair) => method.push(pair, &mut |row| after.take(&row, sink))?,
        None => method.miss(&mut |row| after.take(&row, sink)),
    }
    // The watch compares what came out.
    clock.enter(Stage::Output);
    after.watch.push(pair);
    clock.enter(Stage::Rectify);
    Ok(())
}

impl<const WIDTH: usize> After<WIDTH> {
    /// Hands a row of the method on, its disparities corrected.
    fn take(&mut self, row: &DisparityRow<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        self.watch.answer(row);
        match (self.correction, self.corrected.get_mut(..row.disparity.len())) {
            (Some(correction), Some(corrected)) => {
                corrected.copy_from_slice(row.disparity);
                correction.apply(row.y, corrected);
                sink(DisparityRow { disparity: corrected, ..*row });
            }
            _ => sink(*row),
        }
    }
}

impl<M: StereoMethod, const ROWS: usize, const WIDTH: usize, C: StageClock> StereoMethod
    for Rectified<M, ROWS, WIDTH, C>
{
    fn config(&self) -> &Config {
        self.method.config()
    }

    fn start(&mut self) {
        self.rectifier.iter_mut().for_each(Rectifier::start);
        self.noise.clear();
        self.differ = false;
        self.after.watch.start();
        self.method.start();
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        let Self { method, clock, rectifier, noise, differ, after, .. } = self;
        let Some(rectifier) = rectifier else { return hand_on(method, after, clock, Some(pair), sink) };
        clock.enter(Stage::Rectify);
        *differ = *differ || pair.left != pair.right;
        // Noise is that of the rows as they came.
        if let Some(sampling) = Sampling::of(rectifier.came())
            && let Some(rows) = rectifier.newest_three()
        {
            clock.enter(Stage::Features);
            noise.sample(rows, sampling.first, sampling.stride, sampling.weight);
            if rectifier.came() < 16 || rectifier.came().is_multiple_of(8) {
                method.take_noise(noise);
            }
            clock.enter(Stage::Rectify);
        }
        let mut outcome = Ok(());
        rectifier.push(pair, &mut |row| outcome = hand_on(method, after, clock, row.pair, sink))?;
        outcome
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let Self { method, clock, rectifier, after, .. } = self;
        // What is missed is of no width, and the rectifier's width is the method's.
        match rectifier {
            None => _ = hand_on(method, after, clock, None, sink),
            Some(rectifier) => {
                clock.enter(Stage::Rectify);
                rectifier.miss(&mut |row| _ = hand_on(method, after, clock, row.pair, sink));
            }
        }
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let Self { method, clock, rectifier, noise, differ, were_same, after } = self;
        noise.clear();
        if let Some(rectifier) = rectifier {
            *were_same = !core::mem::take(differ);
            clock.enter(Stage::Rectify);
            rectifier.finish(&mut |row| _ = hand_on(method, after, clock, row.pair, sink));
        }
        method.finish(&mut |row| after.take(&row, sink));
        after.watch.start();
    }

    fn cell_height(&self) -> u32 {
        self.method.cell_height()
    }

    fn figures(&self) -> Option<FrameFigures> {
        let figures = self.method.figures()?;
        // Moved against each other, the same images are two.
        let input = if self.were_same && figures.input != Input::NothingSeen { Input::SameView } else { figures.input };
        Some(FrameFigures { input, row_error_q8: self.after.watch.row_error_q8(), ..figures })
    }
}
