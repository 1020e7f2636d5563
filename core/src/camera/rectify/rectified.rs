//! A stereo method behind a rig that is rectified as it streams.

use super::{Offset, Ramp, RectifiedRow, Rectifier};
use crate::frame_figures::{FrameFigures, Input};
use crate::{Config, ConfigError, DisparityRow, RowError, ScanlinePair, StereoMethod};

/// A stereo method behind a pair of displaced cameras: takes the rows as they come, hands on rectified ones.
///
/// As [`Rectifier`] with the capacities `ROWS` and `WIDTH`. Rows that are missed there are missed by the method: their
/// disparities come out unknown. A rig without displacement costs nothing: its rows are handed on as they are.
#[derive(Debug, Clone)]
pub struct Rectified<M, const ROWS: usize, const WIDTH: usize> {
    method: M,
    /// `None` where nothing is displaced.
    rectifier: Option<Rectifier<ROWS, WIDTH>>,
    /// Whether the views differ in a row of this frame, before they are rectified.
    differ: bool,
    /// Whether those of the last frame were the same image.
    were_same: bool,
}

impl<M: StereoMethod, const ROWS: usize, const WIDTH: usize> Rectified<M, ROWS, WIDTH> {
    /// Puts `method` behind cameras of `height` rows whose right one is displaced by `ramp` and by whole `columns`.
    ///
    /// # Errors
    /// As [`Rectifier::new`].
    pub fn new(method: M, height: u16, ramp: Ramp, columns: i16) -> Result<Self, ConfigError> {
        if usize::from(method.config().width) > WIDTH {
            return Err(ConfigError::Capacity { max_width: u16::try_from(WIDTH).unwrap_or(u16::MAX) });
        }
        if columns.unsigned_abs() > Offset::MAX_COLUMNS.unsigned_abs() {
            return Err(ConfigError::ColumnOffset);
        }
        let is_straight = ramp.is_straight() && columns == 0;
        let size = [method.config().width, height];
        let rectifier = if is_straight { None } else { Some(Rectifier::new(size, ramp, columns)?) };
        Ok(Self { method, rectifier, differ: false, were_same: false })
    }

    /// The method behind.
    #[must_use]
    pub const fn method(&self) -> &M {
        &self.method
    }

    /// So many rows after a row came it reaches the method.
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

impl<M: StereoMethod, const ROWS: usize, const WIDTH: usize> StereoMethod for Rectified<M, ROWS, WIDTH> {
    fn config(&self) -> &Config {
        self.method.config()
    }

    fn start(&mut self) {
        self.rectifier.iter_mut().for_each(Rectifier::start);
        self.differ = false;
        self.method.start();
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        let Self { method, rectifier, differ, .. } = self;
        let Some(rectifier) = rectifier else { return method.push(pair, sink) };
        *differ = *differ || pair.left != pair.right;
        let mut outcome = Ok(());
        rectifier.push(pair, &mut |row| outcome = hand_on(method, &row, sink))?;
        outcome
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let Self { method, rectifier, .. } = self;
        let Some(rectifier) = rectifier else { return method.miss(sink) };
        // Its width is the method's.
        rectifier.miss(&mut |row| {
            let _ = hand_on(method, &row, sink);
        });
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        let Self { method, rectifier, differ, were_same } = self;
        if let Some(rectifier) = rectifier {
            *were_same = !core::mem::take(differ);
            rectifier.finish(&mut |row| {
                let _ = hand_on(method, &row, sink);
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
