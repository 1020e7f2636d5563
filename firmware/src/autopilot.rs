//! The task that tells an autopilot: obstacles as they are found, and a heartbeat each second.

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Ticker};
use haarline::setup::Reach;
use haarline_telemetry::{Link, State};

use crate::edge::PacketSink;
use crate::lookout::Sighting;

/// Where the newest sighting waits: an older one that nobody took is of no use.
pub type Sightings<const SECTORS: usize> = Signal<CriticalSectionRawMutex, Sighting<SECTORS>>;

/// Heartbeats without a sighting after which nothing is seen: two, since frames come once a second at least.
const PATIENCE: u8 = 2;

/// Sends messages of vehicle `system` for ever. Without frames there are no obstacles to tell of, and nothing is
/// repeated: the heartbeat says [`State::Blind`], and the autopilot's own time-out does the rest.
pub async fn autopilot<const SECTORS: usize>(
    sightings: &Sightings<SECTORS>,
    reach: &Reach,
    system: u8,
    mut sink: impl PacketSink,
) -> ! {
    let mut link = Link::new(system);
    let mut ticker = Ticker::every(Duration::from_secs(1));
    let (mut state, mut beats) = (State::Starting, 0_u8);
    loop {
        match select(sightings.wait(), ticker.next()).await {
            Either::First(Sighting { frame, begun_us, sectors, nearest_mm }) => {
                (state, beats) = (State::Active, 0);
                let nearest_mm = nearest_mm.into_iter().take(sectors);
                sink.send(frame, link.obstacle_distance(begun_us, reach, nearest_mm).as_bytes()).await;
            }
            Either::Second(()) => {
                beats = beats.saturating_add(1);
                if state == State::Active && beats > PATIENCE {
                    state = State::Blind;
                    defmt::warn!("no frame for {=u8} s: telling the autopilot", PATIENCE);
                }
                sink.send(0, link.heartbeat(state).as_bytes()).await;
            }
        }
    }
}
