//! The order in which packets come: what is missing, what comes late, twice or from a sender that began anew.

use std::collections::VecDeque;
use std::hash::{DefaultHasher, Hasher};

/// So many of the last packets are remembered. What is behind by more is of a sender that began anew.
const WINDOW: u32 = 256;
/// A gap in the numbers from here on is a step back.
const BACK: u32 = u32::MAX / 2;

/// How a packet comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Arrival {
    /// After all that came before it.
    InOrder,
    /// After later ones, for the first time.
    Late,
    /// A second time.
    Repeated,
    /// From a sender that began anew.
    Restart,
}

/// The numbers of the packets that came.
#[derive(Debug, Clone, Default)]
pub(super) struct Order {
    /// The first number since the sender began, and the one that should be next.
    span: Option<[u32; 2]>,
    /// The last packets: numbers and fingerprints.
    recent: VecDeque<(u32, u64)>,
    lost: u64,
}

impl Order {
    /// Packets that are missing.
    pub(super) fn lost(&self) -> u64 {
        self.lost
    }

    /// Notes a packet.
    pub(super) fn place(&mut self, sequence: u32, fingerprint: u64) -> Arrival {
        let arrival = self.judge(sequence, fingerprint);
        match arrival {
            Arrival::Repeated => return arrival,
            Arrival::Restart => {
                self.recent.clear();
                self.span = Some([sequence, sequence.wrapping_add(1)]);
            }
            Arrival::InOrder => {
                let [first, next] = self.span.unwrap_or([sequence; 2]);
                self.lost += u64::from(sequence.wrapping_sub(next));
                self.span = Some([first, sequence.wrapping_add(1)]);
            }
            Arrival::Late => {
                let was_counted = self.span.is_some_and(|[first, _]| sequence.wrapping_sub(first) < BACK);
                self.lost -= u64::from(was_counted);
            }
        }
        self.recent.push_back((sequence, fingerprint));
        if self.recent.len() > WINDOW as usize {
            self.recent.pop_front();
        }
        arrival
    }

    fn judge(&self, sequence: u32, fingerprint: u64) -> Arrival {
        let Some([_, next]) = self.span else { return Arrival::InOrder };
        if sequence.wrapping_sub(next) < BACK {
            return Arrival::InOrder;
        }
        let same = self.recent.iter().find(|(seen, _)| *seen == sequence);
        match same {
            Some(&(_, seen)) if seen == fingerprint && next == 1 => Arrival::Repeated,
            // A sender's first packet is the same after each start.
            _ if sequence == 0 || next.wrapping_sub(sequence) > WINDOW => Arrival::Restart,
            Some(&(_, seen)) if seen == fingerprint => Arrival::Repeated,
            Some(_) => Arrival::Restart,
            None => Arrival::Late,
        }
    }
}

/// Two packets of the same fingerprint are the same.
pub(super) fn fingerprint(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}
