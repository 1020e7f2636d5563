//! Looks for obstacles in the disparity rows as they pass.

use haarline::frame_figures::{Bend, FrameFigures, Input, Trust};
use haarline::obstacle::ObstacleError;
use haarline::{DisparityRow, Obstacles, Setup};

/// What was found in a frame.
#[derive(Debug, Clone, Copy)]
pub struct Sighting<const SECTORS: usize> {
    /// The frame.
    pub frame: u32,
    /// When it began, µs after the start.
    pub begun_us: u64,
    /// Whether the cameras are believed: else nothing is told, and no sector is known.
    pub is_trusted: bool,
    /// Whether the rig has bent: its distances are in doubt.
    pub is_bent: bool,
    /// Sectors that count, from the left.
    pub sectors: usize,
    /// Distance over the ground to the nearest obstacle of each, mm; `None` is unknown.
    pub nearest_mm: [Option<u32>; SECTORS],
}

/// Takes rows, and tells after each frame what was in the way.
pub struct Lookout<const SECTORS: usize, const BLOCKS: usize, T> {
    obstacles: Obstacles<SECTORS, BLOCKS>,
    trust: Trust,
    bend: Bend,
    tell: T,
}

impl<const SECTORS: usize, const BLOCKS: usize, T: FnMut(Sighting<SECTORS>)> Lookout<SECTORS, BLOCKS, T> {
    /// Looks with that rig's eyes.
    ///
    /// # Errors
    /// As [`Obstacles::new`].
    pub fn new(setup: &Setup<SECTORS>, tell: T) -> Result<Self, ObstacleError> {
        let size = [setup.config.width, setup.height];
        let settings = haarline::obstacle::Settings::DEFAULT;
        let obstacles = Obstacles::new(size, setup.rig, setup.mounting, setup.sectors, settings)?;
        Ok(Self { obstacles, trust: Trust::default(), bend: Bend::default(), tell })
    }

    /// Takes the next row of the frame.
    pub fn row(&mut self, row: &DisparityRow<'_>) {
        self.obstacles.push(row);
    }

    /// The frame has ended, with these figures: tells of it, and begins the next one. While the views do not match nothing is
    /// known.
    pub fn end(&mut self, frame: u32, begun_us: u64, figures: Option<FrameFigures>) {
        let is_trusted = self.trust.take(figures.map_or(Input::Ok, |figures| figures.input));
        let is_bent = self.bend.take(figures);
        let mut sighting = Sighting { frame, begun_us, is_trusted, is_bent, sectors: 0, nearest_mm: [None; SECTORS] };
        for (place, nearest_mm) in sighting.nearest_mm.iter_mut().zip(self.obstacles.nearest_mm()) {
            *place = nearest_mm.filter(|_| is_trusted);
            sighting.sectors += 1;
        }
        self.obstacles.start();
        (self.tell)(sighting);
    }
}
