//! The far end of a serial line, which keeps what it hears.

use std::sync::{Arc, Mutex};

use rigless::chip::Timeline;
use rigless::chip::uart::Peer;
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;

/// What came over a line.
#[derive(Debug, Default)]
pub struct Bytes {
    pub bytes: Vec<u8>,
    /// When bytes ended that were followed by a pause of a tenth of a millisecond or more, and when the last one came, ns.
    pub ended: Vec<u64>,
}

/// A pause between packets, ns.
const PAUSE: u64 = 100_000;

/// Bytes that came over a line.
pub type Heard = Arc<Mutex<Bytes>>;

/// Listens.
#[derive(Debug)]
pub struct Wire(pub Heard);

// A run is never kept.
impl Store for Wire {}

impl Peer for Wire {
    fn receive(&mut self, word: u16, context: &mut Timeline<'_, '_>) {
        let mut heard = self.0.lock().expect("nobody panics");
        heard.bytes.push(word.to_le_bytes()[0]);
        let now = context.now().0;
        match heard.ended.last_mut() {
            Some(last) if now < *last + PAUSE => *last = now,
            _ => heard.ended.push(now),
        }
    }

    fn transmit(&mut self, _now: VirtualNanos) -> Option<u16> {
        None
    }
}
