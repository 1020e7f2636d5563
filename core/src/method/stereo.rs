//! The one interface of all stereo methods: a row in, a row out.

use crate::frame_figures::FrameFigures;
use crate::front_end::noise::RawNoise;
use crate::{Config, DisparityRow, RowError, ScanlinePair};

/// A streaming stereo method.
///
/// Rows go in from the top of the frame, by [`push`](Self::push) or, where the camera lost one, by
/// [`miss`](Self::miss). Disparity rows come out through `sink`, in order and each exactly once, a
/// bounded number of rows later; [`finish`](Self::finish) delivers the last ones. Nothing of one
/// frame changes the next one's result.
pub trait StereoMethod {
    /// What the method was built with.
    fn config(&self) -> &Config;

    /// Begins a frame. Whatever was under way is dropped without delivering its rows.
    fn start(&mut self);

    /// Takes the next row and delivers the rows that are ready.
    ///
    /// # Errors
    /// If a view has not the configured width. The row does not count then.
    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError>;

    /// Tells that the next row was lost. Its disparity row comes out unknown.
    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>));

    /// Ends the frame: delivers what is still inside, and begins the next one.
    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>));

    /// Takes the noise of the rows as they came from the cameras, up to the newest: for the rest of the frame it holds in the
    /// place of that of the rows that are pushed, since these were interpolated.
    #[doc(hidden)]
    fn take_noise(&mut self, _: &RawNoise) {}

    /// What the last frame that was finished is worth as a whole, if the method tells that.
    fn figures(&self) -> Option<FrameFigures> {
        None
    }

    /// Rows of a row of cells, which begin at a multiple of it, are decided together and go together in row packets; 1 if
    /// the method does not answer in cells.
    fn cell_height(&self) -> u32 {
        1
    }
}

impl<M: StereoMethod + ?Sized> StereoMethod for &mut M {
    fn config(&self) -> &Config {
        (**self).config()
    }

    fn start(&mut self) {
        (**self).start();
    }

    fn push(&mut self, pair: ScanlinePair<'_>, sink: &mut dyn FnMut(DisparityRow<'_>)) -> Result<(), RowError> {
        (**self).push(pair, sink)
    }

    fn miss(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        (**self).miss(sink);
    }

    fn finish(&mut self, sink: &mut dyn FnMut(DisparityRow<'_>)) {
        (**self).finish(sink);
    }

    fn take_noise(&mut self, noise: &RawNoise) {
        (**self).take_noise(noise);
    }

    fn figures(&self) -> Option<FrameFigures> {
        (**self).figures()
    }

    fn cell_height(&self) -> u32 {
        (**self).cell_height()
    }
}
