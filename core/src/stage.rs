//! Stages of the work on a frame, and the clock that tells what each costs.

/// A stage of the way from raw camera bytes to the disparity row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// Raw bytes of the camera to two rows.
    Unpack,
    /// Rows of both views brought together, where a rig is put right.
    Rectify,
    /// Noise, exposure, smoothing, gradients: what is kept of the rows.
    Features,
    /// Contours of both views and grey levels of the blocks.
    Contours,
    /// Pairs of contours.
    Seeds,
    /// Costs of the blocks' hypotheses, and the search among them.
    Blocks,
    /// Messages between neighbouring blocks.
    Agreement,
    /// Choice between surfaces at their boundary, texture test, confidence, left-right check.
    Consistency,
    /// Disparity rows handed over to whoever takes them.
    Output,
    /// Packets made of them. No method's own work.
    Packets,
}

impl Stage {
    /// How many there are.
    pub const COUNT: usize = Self::ALL.len();

    /// All of them, in the order of the work.
    pub const ALL: [Self; 10] = [
        Self::Unpack,
        Self::Rectify,
        Self::Features,
        Self::Contours,
        Self::Seeds,
        Self::Blocks,
        Self::Agreement,
        Self::Consistency,
        Self::Output,
        Self::Packets,
    ];

    /// Its name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unpack => "unpack",
            Self::Rectify => "rectify",
            Self::Features => "features",
            Self::Contours => "contours",
            Self::Seeds => "seeds",
            Self::Blocks => "blocks",
            Self::Agreement => "agreement",
            Self::Consistency => "consistency",
            Self::Output => "output",
            Self::Packets => "packets",
        }
    }

    /// Its place in [`ALL`](Self::ALL).
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Whoever wants to know when a method goes from one stage to the next.
///
/// The core has no clock. On a board this is one of the chip's counters, in an emulator its count of
/// instructions, and [`Untimed`] costs nothing.
pub trait StageClock {
    /// What is executed from here on belongs to `stage`, until the next call.
    fn enter(&self, stage: Stage);
}

/// Nobody wants to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Untimed;

impl StageClock for Untimed {
    #[inline(always)]
    fn enter(&self, _: Stage) {}
}

impl<C: StageClock> StageClock for &C {
    #[inline(always)]
    fn enter(&self, stage: Stage) {
        (**self).enter(stage);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::contour_stereo::rows_for;
    use crate::{Config, ContourStereo, EnvelopeStereo, Full, Lite, ScanlinePair, StereoMethod, blocks_for};
    use core::cell::RefCell;
    extern crate std;
    use std::vec::Vec;

    /// Remembers the order of the stages.
    #[derive(Default)]
    struct Log(RefCell<Vec<Stage>>);

    impl StageClock for Log {
        fn enter(&self, stage: Stage) {
            self.0.borrow_mut().push(stage);
        }
    }

    const WIDTH: u16 = 64;

    fn run(method: &mut dyn StereoMethod) -> Vec<i16> {
        let mut bits = Vec::new();
        for y in 0..21u32 {
            let row: [u8; WIDTH as usize + 5] = core::array::from_fn(|x| {
                let cell =
                    u32::try_from(x / 3).unwrap().wrapping_mul(2_654_435_761) ^ (y / 3).wrapping_mul(0x85EB_CA77);
                (cell >> 24).to_le_bytes()[0]
            });
            let pair = ScanlinePair { left: &row[..usize::from(WIDTH)], right: &row[5..] };
            method.push(pair, &mut |row| bits.extend(row.disparity.iter().map(|d| d.into_bits()))).unwrap();
        }
        method.finish(&mut |row| bits.extend(row.disparity.iter().map(|d| d.into_bits())));
        bits
    }

    #[test]
    fn a_clock_sees_every_stage_and_changes_nothing() {
        let config = Config::for_width(WIDTH);
        let log = Log::default();
        let lite = run(&mut Lite::<{ blocks_for(WIDTH) }, _>::timed(config, &log).unwrap());
        assert_eq!(lite, run(&mut Lite::<{ blocks_for(WIDTH) }>::new(config).unwrap()));
        let seen = log.0.take();
        // Six rows of tiles, the last of them of one row.
        let entered = |stage| seen.iter().filter(|&&s| s == stage).count();
        assert_eq!([Stage::Contours, Stage::Seeds, Stage::Blocks, Stage::Output].map(entered), [6, 6, 6, 21]);
        assert_eq!([Stage::Unpack, Stage::Agreement].map(entered), [0, 0]);

        let full = run(&mut Full::<{ blocks_for(WIDTH) }, _>::timed(config, &log).unwrap());
        assert_eq!(full, run(&mut Full::<{ blocks_for(WIDTH) }>::new(config).unwrap()));
        let seen = log.0.take();
        let entered = |stage| seen.iter().filter(|&&s| s == stage).count();
        // Once more for the cells that waited for those below.
        assert_eq!([Stage::Seeds, Stage::Blocks, Stage::Agreement, Stage::Output].map(entered), [6, 6, 7, 21]);
    }

    #[test]
    fn a_clock_sees_the_stages_of_points_and_changes_nothing() {
        let config = Config::for_width(WIDTH);
        let log = Log::default();
        type Contours<C> = ContourStereo<{ blocks_for(WIDTH) }, { rows_for(2) }, C>;
        let contour = run(&mut Contours::timed(config, &log).unwrap());
        assert_eq!(contour, run(&mut Contours::new(config).unwrap()));
        let seen = log.0.take();
        let entered = |stage| seen.iter().filter(|&&s| s == stage).count();
        // Upright and lying contours of eleven pairs of rows.
        assert_eq!([Stage::Contours, Stage::Seeds, Stage::Blocks].map(entered), [22, 22, 0]);
        assert_eq!([Stage::Unpack, Stage::Agreement, Stage::Output].map(entered), [0, 0, 21]);

        let envelope = run(&mut EnvelopeStereo::<{ blocks_for(WIDTH) }, _>::timed(config, &log).unwrap());
        assert_eq!(envelope, run(&mut EnvelopeStereo::<{ blocks_for(WIDTH) }>::new(config).unwrap()));
        let seen = log.0.take();
        let entered = |stage| seen.iter().filter(|&&s| s == stage).count();
        assert_eq!([Stage::Contours, Stage::Seeds, Stage::Blocks, Stage::Output].map(entered), [22, 0, 22, 21]);
    }

    #[test]
    fn every_stage_has_its_place_and_a_name_of_its_own() {
        for (place, stage) in Stage::ALL.into_iter().enumerate() {
            assert_eq!(stage.index(), place);
            assert_eq!(Stage::ALL.iter().filter(|other| other.name() == stage.name()).count(), 1);
        }
    }
}
