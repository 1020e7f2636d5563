//! A stereo method behind a rig that is rectified as it streams.

use super::{Offset, Rectification, RectifiedRow, Rectifier};
use crate::frame_figures::{FrameFigures, Input};
use crate::{
    Config, ConfigError, Correction, Disparity, DisparityRow, RowError, ScanlinePair, Stage, StageClock, StereoMethod,
    Untimed,
};

/// A stereo method behind a rig's rectification: takes the rows as they come, hands on rectified ones, corrects the
/// disparities.
///
/// As [`Rectifier`] with the capacities `ROWS` and `WIDTH`. Rows that are missed there are missed by the method: their
/// disparities come out unknown. A rig without displacement costs nothing: its rows are handed on as they are.
#[derive(Debug, Clone)]
pub struct Rectified<M, const ROWS: usize, const WIDTH: usize, C = Untimed> {
    method: M,
    clock: C,
    /// `None` where nothing is displaced.
    rectifier: Option<Rectifier<ROWS, WIDTH>>,
    /// Whether the views differ in a row of this frame, before they are rectified.
    differ: bool,
    /// Whether those of the last frame were the same image.
    were_same: bool,
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
    pub fn timed(method: M, height: u16, rectification: Rectification, clock: C) -> Result<Self, ConfigError> {
        if usize::from(method.config().width) > WIDTH {
            return Err(ConfigError::Capacity { max_width: u16::try_from(WIDTH).unwrap_or(u16::MAX) });
        }
        if rectification.columns.unsigned_abs() > Offset::MAX_COLUMNS.unsigned_abs() {
            return Err(ConfigError::ColumnOffset);
        }
        let size = [method.config().width, height];
        let correction = rectification.correction.map(|correction| correction.of_size(size));
        let rectifier = if rectification.is_straight() { None } else { Some(Rectifier::new(size, rectification)?) };
        let corrected = [Disparity::UNKNOWN; WIDTH];
        Ok(Self { method, clock, rectifier, differ: false, were_same: false, correction, corrected })
    }

    /// The method behind.
    #[must_use]
    pub const fn method(&self) -> &M {
        &self.method
    }

    /// At most so many rows after a row came it reaches the method.
    #[must_use]
    pub fn waiting_rows(&self) -> usize {
        self.rectifier.as_ref().map_or(0, Rectifier::waiting_rows)
    }
}

/// Hands a row on.
fn hand_on<M: StereoMethod>(
    method: &mut M,
    row: &RectifiedRow<'_>,
    sink: &mut dyn FnMut(DisparityRow<'_>),
) -> Result<(), RowError> {
    match row.pair {
        Some(pair) => method.push(pair, sink),
        None => {
            method.miss(sink);
            Ok(())
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
        self.differ = false;
        self.method.start();
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        let Self { method, clock, rectifier, differ, correction, corrected, .. } = self;
        let sink = &mut |row: DisparityRow<'_>| correct(*correction, corrected, &row, sink);
        let Some(rectifier) = rectifier else { return method.push(pair, sink) };
        clock.enter(Stage::Rectify);
        *differ = *differ || pair.left != pair.right;
        let mut outcome = Ok(());
        rectifier.push(pair, &mut |row| {
            outcome = hand_on(method, &row, sink);
            clock.enter(Stage::Rectify);
        })?;
        outcome
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let Self { method, clock, rectifier, correction, corrected, .. } = self;
        let sink = &mut |row: DisparityRow<'_>| correct(*correction, corrected, &row, sink);
        let Some(rectifier) = rectifier else { return method.miss(sink) };
        clock.enter(Stage::Rectify);
        // Its width is the method's.
        rectifier.miss(&mut |row| {
            let _ = hand_on(method, &row, sink);
            clock.enter(Stage::Rectify);
        });
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let Self { method, clock, rectifier, differ, were_same, correction, corrected } = self;
        let sink = &mut |row: DisparityRow<'_>| correct(*correction, corrected, &row, sink);
        if let Some(rectifier) = rectifier {
            *were_same = !core::mem::take(differ);
            clock.enter(Stage::Rectify);
            rectifier.finish(&mut |row| {
                let _ = hand_on(method, &row, sink);
                clock.enter(Stage::Rectify);
            });
        }
        method.finish(sink);
    }

    fn figures(&self) -> Option<FrameFigures> {
        let figures = self.method.figures()?;
        // Moved against each other, the same images are two.
        let input = if self.were_same && figures.input != Input::NothingSeen { Input::SameView } else { figures.input };
        Some(FrameFigures { input, ..figures })
    }
}

/// Hands a row on with its disparities corrected.
fn correct(
    correction: Option<Correction>,
    room: &mut [Disparity],
    row: &DisparityRow<'_>,
    sink: &mut dyn FnMut(DisparityRow<'_>),
) {
    match (correction, room.get_mut(..row.disparity.len())) {
        (Some(correction), Some(room)) => {
            room.copy_from_slice(row.disparity);
            correction.apply(row.y, room);
            sink(DisparityRow { disparity: room, ..*row });
        }
        _ => sink(*row),
    }
}
