//! Obstacles on the host: the core's, of whole maps, as a table and as MAVLink bytes.

use anyhow::{Context, Result};
use haarline::obstacle::{MAX_SECTORS, Obstacles, Settings};
use haarline::setup::Reach;
use haarline::{Config, DisparityRow, Setup, blocks_for};
use haarline_rig::Description;
use haarline_telemetry::{Link, Sector, State};
use serde::Serialize;

use crate::DisparityMap;
use crate::stereo::frame_check::{FrameCheck, Trust};

/// MAVLink system that the messages come from: an autopilot's, unless it was set otherwise.
const SYSTEM: u8 = 1;

/// The nearest obstacles of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameObstacles {
    /// Its place in the recording, from 0.
    pub frame: usize,
    /// Distance over the ground in each sector, mm; none is unknown. Empty where there is no map.
    pub nearest_mm: Vec<Option<u32>>,
    /// Whether each sector is measured and free; empty where that was not asked for.
    pub free: Vec<bool>,
    /// Whether the frame is believed at all ([`Trust`]). Of one that is not no sector is known.
    pub is_trusted: bool,
    /// Whether the rig has bent ([`Bend`](haarline::frame_figures::Bend)): its distances are in doubt.
    pub is_bent: bool,
}

/// Looks for obstacles in maps of one rig.
#[derive(Debug, Clone)]
pub struct ObstacleFinder {
    setup: Setup<MAX_SECTORS>,
    frame_rate_hz: u16,
    bearings_deg: Vec<i16>,
    finder: Obstacles<MAX_SECTORS, { blocks_for(Config::MAX_WIDTH) }>,
    trust: Trust,
}

impl ObstacleFinder {
    /// A finder for the rig's maps.
    ///
    /// # Errors
    /// If the description's fields do not go together.
    pub fn new(description: &Description) -> Result<Self> {
        Self::with_settings(description, Settings::DEFAULT)
    }

    /// The same that believes what `settings` say.
    ///
    /// # Errors
    /// As [`ObstacleFinder::new`].
    pub fn with_settings(description: &Description, settings: Settings) -> Result<Self> {
        let (plan, setup) = (description.plan()?, description.setup::<MAX_SECTORS>()?);
        let size = [setup.config.width, setup.height];
        let finder = Obstacles::new(size, setup.rig, setup.mounting, setup.sectors, settings)?;
        Ok(Self {
            setup,
            frame_rate_hz: plan.frame_rate_hz,
            bearings_deg: plan.bearings_deg().collect(),
            finder,
            trust: Trust::default(),
        })
    }

    /// The same that looks for free sectors, too, and tells of nothing that is farther than `free_beyond_mm`.
    ///
    /// # Errors
    /// As [`ObstacleFinder::new`].
    pub fn with_free_beyond(description: &Description, free_beyond_mm: u32) -> Result<Self> {
        let mut finder = Self::with_settings(description, Settings { free_beyond_mm, ..Settings::DEFAULT })?;
        let reach = &mut finder.setup.reach;
        reach.farthest_cm = u16::try_from(free_beyond_mm / 10).unwrap_or(u16::MAX).min(reach.farthest_cm);
        Ok(finder)
    }

    /// Distance over the ground to the nearest obstacle of each sector, mm.
    pub fn find(&mut self, map: &DisparityMap) -> Vec<Option<u32>> {
        let rows = map.disparity.chunks(map.width).zip(map.confidence.chunks(map.width));
        self.finder.start();
        for (y, (disparity, confidence)) in (0..).zip(rows) {
            self.finder.push(&DisparityRow { y, disparity, confidence });
        }
        self.finder.nearest_mm().collect()
    }

    /// The same in the map of the next frame of a recording, which was checked: as long as the input is not as it should
    /// be ([`Trust`]) nothing is told, and of a frame that does not match never that a sector is free.
    pub fn find_checked(&mut self, frame: usize, map: &DisparityMap, check: &FrameCheck) -> FrameObstacles {
        if self.trust.take(check.input) {
            let nearest_mm = self.find(map);
            let free = self.finder.free().map(|free| free && check.input_ok).collect();
            FrameObstacles { frame, nearest_mm, free, is_trusted: true, is_bent: false }
        } else {
            let sectors = self.setup.sectors.count;
            let (nearest_mm, free) = (vec![None; sectors], vec![false; sectors]);
            FrameObstacles { frame, nearest_mm, free, is_trusted: false, is_bent: false }
        }
    }

    /// The rig in integers.
    #[must_use]
    pub const fn setup(&self) -> &Setup<MAX_SECTORS> {
        &self.setup
    }

    /// The first line of `obstacles.csv`, a line a frame, a column a sector: the bearings of the sectors' middles,
    /// degrees clockwise from straight ahead.
    #[must_use]
    pub fn heads(&self) -> Vec<String> {
        ["frame".to_owned()].into_iter().chain(self.bearings_deg.iter().map(i16::to_string)).collect()
    }

    /// The content of `obstacles.csv`: [`ObstacleFinder::heads`] and the [`FrameObstacles::record`] of each frame.
    ///
    /// # Errors
    /// Never for distances of this finder.
    pub fn encode_csv(&self, frames: &[FrameObstacles]) -> Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.heads())?;
        for frame in frames {
            writer.write_record(frame.record(self.bearings_deg.len()))?;
        }
        writer.into_inner().context("obstacles.csv")
    }

    /// What to tell of a frame in a line.
    #[must_use]
    pub fn summary(&self, frame: &FrameObstacles) -> ObstacleSummary {
        let known = || frame.nearest_mm.iter().zip(&self.bearings_deg).filter_map(|(mm, &deg)| Some(((*mm)?, deg)));
        let nearest = known().min();
        ObstacleSummary {
            obstacle_sectors: known().count(),
            nearest_obstacle_mm: nearest.map(|(mm, _)| mm),
            nearest_obstacle_deg: nearest.map(|(_, deg)| deg),
        }
    }

    /// What a board would send to an autopilot, from the first frame on.
    #[must_use]
    pub fn feed(&self) -> MavlinkFeed {
        let Self { setup, frame_rate_hz, .. } = self;
        MavlinkFeed {
            link: Link::new(SYSTEM),
            reach: setup.reach,
            frame_rate_hz: *frame_rate_hz,
            frames: 0,
            state: State::Starting,
            without_map: 0,
        }
    }
}

/// The obstacles of a frame in a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ObstacleSummary {
    /// Sectors in which an obstacle was measured. Of the others nothing is known.
    pub obstacle_sectors: usize,
    /// Distance of the nearest one over the ground.
    pub nearest_obstacle_mm: Option<u32>,
    /// Bearing of its sector, degrees clockwise from straight ahead.
    pub nearest_obstacle_deg: Option<i16>,
}

impl ObstacleSummary {
    /// In words.
    #[must_use]
    pub fn words(&self) -> String {
        match (self.nearest_obstacle_mm, self.nearest_obstacle_deg) {
            (Some(mm), Some(deg)) => {
                format!("nearest obstacle {:.2} m at {deg} degrees", f64::from(mm) / 1000.0)
            }
            _ => "no obstacle measured".to_owned(),
        }
    }
}

impl FrameObstacles {
    /// Of a frame without a map nothing is known.
    #[must_use]
    pub const fn without_map(frame: usize) -> Self {
        Self { frame, nearest_mm: Vec::new(), free: Vec::new(), is_trusted: false, is_bent: false }
    }

    /// A line of `obstacles.csv`: the frame, and of each of `sectors` whole cm, empty where it is unknown.
    #[must_use]
    pub fn record(&self, sectors: usize) -> Vec<String> {
        let cm = |sector: usize| self.nearest_mm.get(sector).copied().flatten().map(|mm| (mm / 10).to_string());
        let fields = (0..sectors).map(|sector| cm(sector).unwrap_or_default());
        [self.frame.to_string()].into_iter().chain(fields).collect()
    }
}

/// What a board would send to an autopilot: `OBSTACLE_DISTANCE` of each frame that has a map, as if they came at
/// the rig's frame rate, and a `HEARTBEAT` each second: [`State::Bent`] while the rig is, [`State::Blind`] while frames are not believed, or for
/// [`MavlinkFeed::PATIENCE_S`] have no map.
#[derive(Debug, Clone)]
pub struct MavlinkFeed {
    link: Link,
    reach: Reach,
    frame_rate_hz: u16,
    /// Frames so far.
    frames: u64,
    state: State,
    /// Newest frames in a row that have no map.
    without_map: u64,
}

impl MavlinkFeed {
    /// How long frames may have no map, s, as on a board.
    pub const PATIENCE_S: u64 = 2;

    /// The messages of the next frame.
    #[must_use]
    pub fn next(
        &mut self,
        FrameObstacles { frame, nearest_mm, free, is_trusted, is_bent }: &FrameObstacles,
    ) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.without_map = if nearest_mm.is_empty() { self.without_map + 1 } else { 0 };
        self.state = match self.state {
            State::Active | State::Bent if self.without_map > Self::PATIENCE_S * u64::from(self.frame_rate_hz) => {
                State::Blind
            }
            _ if self.without_map == 0 && *is_trusted && *is_bent => State::Bent,
            _ if self.without_map == 0 && *is_trusted => State::Active,
            _ if self.without_map == 0 => State::Blind,
            before => before,
        };
        if self.frames.is_multiple_of(self.frame_rate_hz.into()) {
            bytes.extend_from_slice(self.link.heartbeat(self.state).as_bytes());
        }
        self.frames += 1;
        if !nearest_mm.is_empty() {
            let time_us = *frame as u64 * (1_000_000 / u64::from(self.frame_rate_hz));
            let told = |(sector, &mm): (usize, &Option<u32>)| match free.get(sector) {
                Some(true) => Sector::Free,
                _ => mm.into(),
            };
            let sectors = nearest_mm.iter().enumerate().map(told);
            let message = self.link.obstacle_distance(time_us, &self.reach, sectors);
            bytes.extend_from_slice(message.as_bytes());
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stereo::method::MethodKind;
    use crate::stereo::pipeline;
    use crate::synthetic::Scene;
    use haarline_rig::template;

    fn finder() -> ObstacleFinder {
        ObstacleFinder::new(&Description::parse(&template()).unwrap()).unwrap()
    }

    #[test]
    fn a_post_on_flat_ground_is_the_obstacle_and_the_ground_is_none() {
        let mut finder = finder();
        for seed in 0..4 {
            let scene = Scene::rover(seed);
            let pair = scene.render().pair;
            for method in [MethodKind::Full, MethodKind::Lite] {
                let run = pipeline::run(&mut *method.build(scene.config()).unwrap(), &pair).unwrap();
                let found = finder.find(&run.map);
                let message = format!("{} {seed}: {found:?}", method.name());
                assert_eq!(found.len(), 17);
                let post = found[8].unwrap();
                assert!((1400..=1600).contains(&post), "{message}");
                // Elsewhere the wall at 6 m, or nothing; the sectors beside may see the post's edge.
                for mm in found[..7].iter().chain(&found[10..]).flatten() {
                    assert!(*mm > 4000, "{message}");
                }
            }
        }
    }

    #[test]
    fn the_table_has_a_line_a_frame_and_a_column_a_sector() {
        let mut nearest_mm = vec![None; 17];
        (nearest_mm[0], nearest_mm[8]) = (Some(12_345), Some(1509));
        let free = Vec::new();
        let frames = [
            FrameObstacles { frame: 3, nearest_mm, free, is_trusted: true, is_bent: false },
            FrameObstacles::without_map(4),
        ];
        let csv = String::from_utf8(finder().encode_csv(&frames).unwrap()).unwrap();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines[0], "frame,-40,-35,-30,-25,-20,-15,-10,-5,0,5,10,15,20,25,30,35,40");
        assert_eq!(lines[1], "3,1234,,,,,,,,150,,,,,,,,");
        assert_eq!(lines[2..], ["4,,,,,,,,,,,,,,,,,"]);
    }

    #[test]
    fn the_heartbeat_says_blind_of_frames_that_are_not_believed_or_have_no_map_and_bent_of_a_bent_rig() {
        const CRITICAL: u8 = 5;
        const ACTIVE: u8 = 4;
        let of = |is_trusted, has_map| FrameObstacles {
            frame: 0,
            nearest_mm: vec![None; if has_map { 17 } else { 0 }],
            free: Vec::new(),
            is_trusted,
            is_bent: false,
        };
        let mut feed = finder().feed();
        // A second's frames, of which the first one's heartbeat is read: the status is the last byte but 3 of 9 + 12.
        let second = |frame: &FrameObstacles| {
            let beat = feed.next(frame);
            for _ in 1..feed.frame_rate_hz {
                assert!(feed.next(frame).first().is_none_or(|_| frame.nearest_mm.len() == 17));
            }
            (beat[10 + 7], beat[10])
        };
        let (good, wrong, none) = (of(true, true), of(false, true), of(false, false));
        let bent = FrameObstacles { is_bent: true, ..of(true, true) };
        let found = [&good, &wrong, &good, &none, &none, &none, &bent, &good].map(second);
        let [active, blind, bent] = [(ACTIVE, 0), (CRITICAL, 0), (CRITICAL, 1)];
        assert_eq!(found, [active, blind, active, active, active, blind, bent, active]);
    }
}
