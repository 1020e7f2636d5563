//! Obstacles on the host: the core's, of whole maps, as a table and as MAVLink bytes.

use anyhow::{Context, Result};
use haarline::obstacle::{MAX_SECTORS, Obstacles, Settings};
use haarline::{Config, DisparityRow, Setup, blocks_for};
use haarline_rig::Description;
use haarline_telemetry::{Link, State};

use crate::DisparityMap;

/// MAVLink system that the messages come from: an autopilot's, unless it was set otherwise.
const SYSTEM: u8 = 1;

/// The nearest obstacles of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameObstacles {
    /// Its place in the recording, from 0.
    pub frame: usize,
    /// Distance over the ground in each sector, mm; none is unknown. Empty where there is no map.
    pub nearest_mm: Vec<Option<u32>>,
}

/// Looks for obstacles in maps of one rig.
#[derive(Debug, Clone)]
pub struct ObstacleFinder {
    setup: Setup<MAX_SECTORS>,
    frame_rate_hz: u16,
    bearings_deg: Vec<i16>,
    finder: Obstacles<MAX_SECTORS, { blocks_for(Config::MAX_WIDTH) }>,
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
        Ok(Self { setup, frame_rate_hz: plan.frame_rate_hz, bearings_deg: plan.bearings_deg().collect(), finder })
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

    /// The rig in integers.
    #[must_use]
    pub const fn setup(&self) -> &Setup<MAX_SECTORS> {
        &self.setup
    }

    /// The content of `obstacles.csv`: a line a frame, a column a sector, headed by the bearing of its middle
    /// in degrees clockwise from straight ahead; whole cm, empty where it is unknown.
    ///
    /// # Errors
    /// Never for distances of this finder.
    pub fn encode_csv(&self, frames: &[FrameObstacles]) -> Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let bearings = self.bearings_deg.iter().map(i16::to_string);
        writer.write_record(["frame".to_owned()].into_iter().chain(bearings))?;
        for FrameObstacles { frame, nearest_mm } in frames {
            let cm = |sector: usize| nearest_mm.get(sector).copied().flatten().map(|mm| (mm / 10).to_string());
            let fields = (0..self.bearings_deg.len()).map(|sector| cm(sector).unwrap_or_default());
            writer.write_record([frame.to_string()].into_iter().chain(fields))?;
        }
        writer.into_inner().context("obstacles.csv")
    }

    /// What a board would send to an autopilot: `OBSTACLE_DISTANCE` of each frame that has a map, as if they came
    /// at the rig's frame rate, and a `HEARTBEAT` each second.
    #[must_use]
    pub fn encode_mavlink(&self, frames: &[FrameObstacles]) -> Vec<u8> {
        let mut link = Link::new(SYSTEM);
        let mut bytes = Vec::new();
        for (index, FrameObstacles { frame, nearest_mm }) in frames.iter().enumerate() {
            if index % usize::from(self.frame_rate_hz) == 0 {
                bytes.extend_from_slice(link.heartbeat(State::Active).as_bytes());
            }
            if !nearest_mm.is_empty() {
                let time_us = *frame as u64 * (1_000_000 / u64::from(self.frame_rate_hz));
                let nearest_mm = nearest_mm.iter().copied();
                let message = link.obstacle_distance(time_us, &self.setup.reach, nearest_mm);
                bytes.extend_from_slice(message.as_bytes());
            }
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
                // Elsewhere the wall at 6 m, or nothing.
                for mm in found[..8].iter().chain(&found[9..]).flatten() {
                    assert!(*mm > 4000, "{message}");
                }
            }
        }
    }

    #[test]
    fn the_table_has_a_line_a_frame_and_a_column_a_sector() {
        let mut nearest_mm = vec![None; 17];
        (nearest_mm[0], nearest_mm[8]) = (Some(12_345), Some(1509));
        let frames = [FrameObstacles { frame: 3, nearest_mm }, FrameObstacles { frame: 4, nearest_mm: Vec::new() }];
        let csv = String::from_utf8(finder().encode_csv(&frames).unwrap()).unwrap();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines[0], "frame,-40,-35,-30,-25,-20,-15,-10,-5,0,5,10,15,20,25,30,35,40");
        assert_eq!(lines[1], "3,1234,,,,,,,,150,,,,,,,,");
        assert_eq!(lines[2..], ["4,,,,,,,,,,,,,,,,,"]);
    }
}
