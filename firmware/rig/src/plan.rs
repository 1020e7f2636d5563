//! A description's figures, as a program is built with them.

use haarline::obstacle::{Mounting, Sectors};
use haarline::setup::Reach;
use haarline::{Config, Rectification, Rig, Setup, Wiring};

use crate::angle::{secant_q14, sin_cos_q14, tangent_q16};

/// The figures of a description, checked, each in the form in which a chip takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Width of a row and range of the search.
    pub config: Config,
    /// Rows of a view.
    pub height: u16,
    /// How the cameras share the port.
    pub wiring: Wiring,
    /// Frames a second that the cameras are to take.
    pub frame_rate_hz: u16,
    /// Integration time of both cameras, lines; `None`: the first one's own control, copied to the second.
    pub exposure_lines: Option<u16>,
    /// What is put right of the views and of disparities.
    pub rectification: Rectification,
    /// Rows of both views that it holds.
    pub ring_rows: usize,
    /// Focal length and baseline.
    pub rig: Rig,
    /// Height of the cameras over the ground, mm.
    pub camera_height_mm: i32,
    /// Pitch of the cameras, degrees; upwards is positive.
    pub pitch_deg: f32,
    /// Least height over the ground that is in the way, mm.
    pub lowest_mm: i32,
    /// Greatest height over the ground that is in the way, mm.
    pub highest_mm: i32,
    /// Number of sectors.
    pub sectors: usize,
    /// Where the sectors are, and how far the rig sees.
    pub reach: Reach,
}

impl Plan {
    /// Rows of both views that rectification holds: its capacity; 0 where nothing is displaced.
    #[must_use]
    pub const fn waiting_rows(&self) -> usize {
        self.ring_rows
    }

    /// What the core works with. `SECTORS` is the capacity; `None` if there are more sectors than that.
    ///
    /// The angles become tangents and cosines here, by [`micromath`], on the chip as on the host.
    #[must_use]
    pub fn setup<const SECTORS: usize>(&self) -> Option<Setup<SECTORS>> {
        let Self { config, height, wiring, rectification, rig, reach, .. } = *self;
        let [sin_pitch_q14, cos_pitch_q14] = sin_cos_q14(self.pitch_deg);
        let mounting = Mounting {
            height_mm: self.camera_height_mm,
            sin_pitch_q14,
            cos_pitch_q14,
            lowest_mm: self.lowest_mm,
            highest_mm: self.highest_mm,
        };
        Some(Setup { config, height, wiring, rectification, rig, mounting, sectors: self.sectors()?, reach })
    }

    /// Bearings of the sectors' middles, degrees clockwise from straight ahead.
    pub fn bearings_deg(&self) -> impl Iterator<Item = i16> + use<> {
        let step = i16::from(self.reach.sector_deg);
        (0..self.sectors).scan(self.reach.first_deg - step, move |bearing, _| {
            *bearing += step;
            Some(*bearing)
        })
    }

    fn sectors<const SECTORS: usize>(&self) -> Option<Sectors<SECTORS>> {
        let count = self.sectors;
        if count > SECTORS {
            return None;
        }
        let half = f32::from(self.reach.sector_deg) / 2.0;
        let mut sectors = Sectors { count, left_q16: [0; SECTORS], right_q16: 0, secant_q14: [0; SECTORS] };
        let places = sectors.left_q16.iter_mut().zip(&mut sectors.secant_q14);
        for (middle, (left, secant)) in self.bearings_deg().map(f32::from).zip(places) {
            *left = tangent_q16(middle - half);
            *secant = secant_q14(middle);
            sectors.right_q16 = tangent_q16(middle + half);
        }
        Some(sectors)
    }
}
