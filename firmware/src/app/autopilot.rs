//! The task that tells an autopilot: obstacles as they are found, and a heartbeat each second.

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Ticker};
use haarline::setup::Reach;
use haarline_telemetry::{LEAST_FRAMES_IN_10_S, Link, State};

use crate::app::edge::PacketSink;
use crate::app::lookout::Sighting;

/// Where the newest sighting waits: an older one that nobody took is of no use.
pub type Sightings<const SECTORS: usize> = Signal<CriticalSectionRawMutex, Sighting<SECTORS>>;

/// Heartbeats without a sighting after which nothing is seen: two, since frames come once a second at least.
const PATIENCE: u8 = 2;

/// How fast frames come.
#[derive(Debug, Default)]
struct Pace {
    last_us: Option<u64>,
    is_told: bool,
}

impl Pace {
    /// Longest time between frames with which an autopilot always has a fresh distance, µs.
    const MOST_US: u64 = 10_000_000 / LEAST_FRAMES_IN_10_S as u64;

    /// Takes the time of a frame; warns once if they come too slowly.
    fn take(&mut self, begun_us: u64) {
        let between = self.last_us.map_or(0, |last| begun_us.saturating_sub(last));
        self.last_us = Some(begun_us);
        if between > Self::MOST_US && !self.is_told {
            self.is_told = true;
            defmt::warn!("{=u64} ms between frames: autopilots forget a distance after 500 ms", between / 1000);
        }
    }
}

/// Sends messages of vehicle `system` for ever. Without frames there are no obstacles to tell of, and nothing is
/// repeated, of frames that do not match no sector is known: the heartbeat says [`State::Blind`], of a bent rig [`State::Bent`], and the autopilot's own time-out does the rest.
pub async fn autopilot<const SECTORS: usize>(
    sightings: &Sightings<SECTORS>,
    reach: &Reach,
    system: u8,
    mut sink: impl PacketSink,
) -> ! {
    let mut link = Link::new(system);
    let mut ticker = Ticker::every(Duration::from_secs(1));
    let (mut state, mut beats) = (State::Starting, 0_u8);
    let mut pace = Pace::default();
    loop {
        match select(sightings.wait(), ticker.next()).await {
            Either::First(Sighting { frame, begun_us, is_trusted, is_bent, sectors, nearest_mm }) => {
                let now = match (is_trusted, is_bent) {
                    (false, _) => State::Blind,
                    (true, true) => State::Bent,
                    (true, false) => State::Active,
                };
                let before = core::mem::replace(&mut state, now);
                beats = 0;
                if !is_trusted && before != State::Blind {
                    defmt::warn!("the views do not match, or show nothing: telling the autopilot");
                }
                if now == State::Bent && before != State::Bent {
                    defmt::warn!(
                        "the rig has bent, rows are half a pixel off or more: telling the autopilot; align it anew"
                    );
                }
                pace.take(begun_us);
                let nearest_mm = nearest_mm.into_iter().take(sectors);
                sink.send(frame, link.obstacle_distance(begun_us, reach, nearest_mm).as_bytes()).await;
            }
            Either::Second(()) => {
                beats = beats.saturating_add(1);
                if matches!(state, State::Active | State::Bent) && beats > PATIENCE {
                    state = State::Blind;
                    defmt::warn!("no frame for {=u8} s: telling the autopilot", PATIENCE);
                }
                sink.send(0, link.heartbeat(state).as_bytes()).await;
            }
        }
    }
}
