//! Obstacles as an autopilot hears of them: MAVLink 2 `HEARTBEAT` and `OBSTACLE_DISTANCE`, for PX4 and
//! ArduPilot.
//!
//! Without heap, for firmware and host alike. The bearing of the first sector is the one number that travels
//! as a float; it is a whole number of degrees.
//!
//! ```
//! use haarline::setup::Reach;
//! use haarline_telemetry::{Link, State};
//! let reach = Reach { sector_deg: 5, first_deg: -5, nearest_cm: 25, farthest_cm: 1200 };
//! let mut link = Link::new(1);
//! assert_eq!(link.heartbeat(State::Active).as_bytes().len(), 21);
//! let message = link.obstacle_distance(0, &reach, [None, Some(1507), None]);
//! assert!(message.as_bytes().len() <= haarline_telemetry::MAX_BYTES);
//! ```
#![no_std]

use haarline::setup::Reach;
use mavlink::dialects::common::{
    HEARTBEAT_DATA, MavAutopilot, MavDistanceSensor, MavFrame, MavModeFlag, MavState, MavType, OBSTACLE_DISTANCE_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};

/// Distance of a sector of which nothing is known.
pub const UNKNOWN_CM: u16 = u16::MAX;
/// Autopilots forget a distance after 0.5 s: with fewer frames in 10 s than this they are blind in between.
pub const LEAST_FRAMES_IN_10_S: u16 = 25;
/// Longest message made here, bytes: header, payload, checksum.
pub const MAX_BYTES: usize = 10 + OBSTACLE_DISTANCE_DATA::ENCODED_LEN + 2;
/// The component that messages come from: `MAV_COMP_ID_OBSTACLE_AVOIDANCE`.
pub const COMPONENT: u8 = 196;

/// `custom_mode` of the heartbeat of a rig that has bent.
pub const BENT: u32 = 1;

/// How the sender does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// No frame came yet: `MAV_STATE_BOOT`.
    Starting,
    /// Frames come and are worked on: `MAV_STATE_ACTIVE`.
    Active,
    /// The same, but the cameras' rows no longer lie as they did, so that distances are in doubt: `MAV_STATE_CRITICAL` with
    /// [`BENT`] as the `custom_mode`.
    Bent,
    /// No frame came out since the last heartbeat, or what came is no stereo pair: `MAV_STATE_CRITICAL`.
    Blind,
}

/// What is told of a sector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sector {
    /// Nothing: it was not measured, or what there is lies beyond the reach.
    Unknown,
    /// The nearest obstacle, mm.
    Obstacle(u32),
    /// Measured up to the reach, and nothing is in the way.
    Free,
}

impl From<Option<u32>> for Sector {
    /// As [`haarline::Obstacles::nearest_mm`] tells.
    fn from(nearest_mm: Option<u32>) -> Self {
        nearest_mm.map_or(Self::Unknown, Self::Obstacle)
    }
}

impl Sector {
    /// Whole cm, within `farthest_cm`; never 0, which autopilots take for no measurement or for an obstacle that
    /// touches them.
    fn cm(self, farthest_cm: u16) -> u16 {
        match self {
            Self::Unknown => UNKNOWN_CM,
            Self::Free => farthest_cm.saturating_add(1),
            Self::Obstacle(mm) => {
                let cm = u16::try_from((mm / 10).max(1)).ok();
                cm.filter(|&cm| cm <= farthest_cm).unwrap_or(UNKNOWN_CM)
            }
        }
    }
}

/// A message, ready to be sent.
#[derive(Debug, Clone)]
pub struct Message(MAVLinkV2MessageRaw);

impl Message {
    /// Its bytes, [`MAX_BYTES`] at most.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        self.0.raw_bytes()
    }
}

/// One sender. Numbers its messages, so that the receiver sees which are lost.
#[derive(Debug, Clone)]
pub struct Link {
    system: u8,
    sequence: u8,
}

impl Link {
    /// A sender on board of vehicle `system`; autopilots are 1 unless set otherwise.
    #[must_use]
    pub const fn new(system: u8) -> Self {
        Self { system, sequence: 0 }
    }

    /// `HEARTBEAT` of a companion computer: to be sent once a second.
    pub fn heartbeat(&mut self, state: State) -> Message {
        self.message(&HEARTBEAT_DATA {
            custom_mode: if state == State::Bent { BENT } else { 0 },
            mavtype: MavType::MAV_TYPE_ONBOARD_CONTROLLER,
            autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
            base_mode: MavModeFlag::empty(),
            system_status: match state {
                State::Starting => MavState::MAV_STATE_BOOT,
                State::Active => MavState::MAV_STATE_ACTIVE,
                State::Bent | State::Blind => MavState::MAV_STATE_CRITICAL,
            },
            mavlink_version: 3,
        })
    }

    /// `OBSTACLE_DISTANCE` of a frame that was taken `time_us` µs after the start: the distance of each sector
    /// in whole cm, [`UNKNOWN_CM`] where it is not known or farther than the rig sees, in the vehicle's own
    /// frame. A sector is free (the greatest distance + 1) only where it is told so.
    ///
    /// Its `min_distance` is that of the reach or the least distance told, whichever is less: ArduPilot drops what is
    /// below, and a tilted camera sees things nearer over the ground than the reach says.
    ///
    /// - `sectors`: what is told of each, [`Option<u32>`] as [`haarline::Obstacles::nearest_mm`] gives it, or
    ///   [`Sector`]; what is beyond 72 is left out.
    pub fn obstacle_distance(
        &mut self,
        time_us: u64,
        reach: &Reach,
        sectors: impl IntoIterator<Item = impl Into<Sector>>,
    ) -> Message {
        let (mut distances, mut least) = ([UNKNOWN_CM; 72], reach.nearest_cm);
        for (distance, sector) in distances.iter_mut().zip(sectors) {
            *distance = sector.into().cm(reach.farthest_cm);
            least = least.min(*distance);
        }
        self.message(&OBSTACLE_DISTANCE_DATA {
            time_usec: time_us,
            distances,
            min_distance: least,
            max_distance: reach.farthest_cm,
            sensor_type: MavDistanceSensor::MAV_DISTANCE_SENSOR_UNKNOWN,
            increment: reach.sector_deg,
            increment_f: 0.0,
            angle_offset: reach.first_deg.into(),
            frame: MavFrame::MAV_FRAME_BODY_FRD,
        })
    }

    fn message(&mut self, data: &impl MessageData) -> Message {
        let header = MavHeader { system_id: self.system, component_id: COMPONENT, sequence: self.sequence };
        self.sequence = self.sequence.wrapping_add(1);
        let mut raw = MAVLinkV2MessageRaw::new();
        raw.serialize_message_data(header, data);
        Message(raw)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavlink::dialects::common::MavMessage;
    use mavlink::{MavlinkVersion, Message as _};

    const REACH: Reach = Reach { sector_deg: 5, first_deg: -40, nearest_cm: 25, farthest_cm: 1200 };

    fn decode(message: &Message) -> MavMessage {
        assert!(message.0.has_valid_crc::<MavMessage>());
        MavMessage::parse(MavlinkVersion::V2, message.0.message_id(), message.0.payload()).unwrap()
    }

    #[test]
    fn distances_are_whole_centimetres_and_unknown_where_nothing_is_known() {
        let cases = [None, Some(0), Some(1507), Some(12_009), Some(12_010), Some(u32::MAX - 1)];
        let message = Link::new(1).obstacle_distance(77, &REACH, cases);
        let MavMessage::OBSTACLE_DISTANCE(data) = decode(&message) else { panic!("another message") };
        assert_eq!(data.distances[..6], [UNKNOWN_CM, 1, 150, 1200, UNKNOWN_CM, UNKNOWN_CM]);
        assert!(data.distances[6..].iter().all(|&cm| cm == UNKNOWN_CM));
        assert_eq!((data.time_usec, data.min_distance, data.max_distance, data.increment), (77, 1, 1200, 5));
        assert_eq!((data.angle_offset, data.frame), (-40.0, MavFrame::MAV_FRAME_BODY_FRD));
    }

    /// What ArduPilot (`AP_Proximity_MAV`) keeps of a message: not 0, not 65535, nothing outside of the two limits.
    fn as_ardupilot_reads(data: &OBSTACLE_DISTANCE_DATA) -> impl Iterator<Item = Option<u16>> {
        let limits = data.min_distance..=data.max_distance;
        data.distances.into_iter().map(move |cm| (cm != 0 && cm != UNKNOWN_CM && limits.contains(&cm)).then_some(cm))
    }

    /// How PX4 (`CollisionPrevention`) reads a bin of a fresh message.
    #[derive(Debug, PartialEq)]
    enum Px4Bin {
        NoData,
        At(u16),
        Free,
    }

    fn as_px4_reads(data: &OBSTACLE_DISTANCE_DATA) -> impl Iterator<Item = Px4Bin> {
        let most = data.max_distance;
        data.distances.into_iter().map(move |cm| match cm {
            UNKNOWN_CM => Px4Bin::NoData,
            cm if cm < most => Px4Bin::At(cm),
            _ => Px4Bin::Free,
        })
    }

    fn sent(sectors: impl IntoIterator<Item = impl Into<Sector>>) -> OBSTACLE_DISTANCE_DATA {
        let message = Link::new(1).obstacle_distance(0, &REACH, sectors);
        let MavMessage::OBSTACLE_DISTANCE(data) = decode(&message) else { panic!("another message") };
        data
    }

    #[test]
    fn every_distance_told_is_kept_by_ardupilot_however_near() {
        for mm in [0, 3, 10, 99, 240, 249, 250, 5000, 12_000, 12_009] {
            let data = sent([Some(6000), Some(mm), None]);
            let cm = u16::try_from((mm / 10).max(1)).unwrap();
            let kept: [Option<u16>; 3] = core::array::from_fn(|sector| as_ardupilot_reads(&data).nth(sector).flatten());
            assert_eq!(kept, [Some(600), Some(cm), None], "{mm} mm");
            assert!(data.min_distance <= cm && data.min_distance <= REACH.nearest_cm);
            assert!(data.distances.iter().all(|&cm| cm != 0));
        }
        // Without anything near the rig's own figure stays.
        assert_eq!(sent([Some(6000)]).min_distance, REACH.nearest_cm);
        assert_eq!(sent([None; 5]).min_distance, REACH.nearest_cm);
    }

    #[test]
    fn free_is_told_only_where_it_is_said_and_px4_reads_it_so() {
        let data = sent([Sector::Unknown, Sector::Obstacle(900), Sector::Free]);
        assert_eq!(data.distances[..4], [UNKNOWN_CM, 90, 1201, UNKNOWN_CM]);
        let bins: [Px4Bin; 3] = core::array::from_fn(|bin| as_px4_reads(&data).nth(bin).unwrap());
        assert_eq!(bins, [Px4Bin::NoData, Px4Bin::At(90), Px4Bin::Free]);
        // ArduPilot takes free for nothing known; what is beyond the reach is unknown for both.
        assert!(as_ardupilot_reads(&data).skip(2).all(|kept| kept.is_none()));
        let beyond = sent([Some(12_010)]);
        assert_eq!(as_px4_reads(&beyond).next(), Some(Px4Bin::NoData));
    }

    #[test]
    fn messages_are_numbered_and_no_longer_than_told() {
        let mut link = Link::new(3);
        for sequence in 0..=256_u16 {
            let message = if sequence % 2 == 0 {
                link.heartbeat(State::Active)
            } else {
                link.obstacle_distance(u64::MAX, &REACH, [Some(9); 99])
            };
            let raw = &message.0;
            let [low, _] = sequence.to_le_bytes();
            assert_eq!((raw.sequence(), raw.system_id(), raw.component_id()), (low, 3, COMPONENT));
            assert!(message.as_bytes().len() <= MAX_BYTES && message.as_bytes()[0] == 0xFD);
            decode(&message);
        }
    }
}
