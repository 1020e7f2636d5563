//! The far end of a serial line, which keeps what it hears.

use std::sync::{Arc, Mutex};

use rigless::chip::Timeline;
use rigless::chip::uart::Peer;
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;

/// Bytes that came over a line.
pub type Heard = Arc<Mutex<Vec<u8>>>;

/// Listens.
#[derive(Debug)]
pub struct Wire(pub Heard);

// A run is never kept.
impl Store for Wire {}

impl Peer for Wire {
    fn receive(&mut self, word: u16, _context: &mut Timeline<'_, '_>) {
        self.0.lock().expect("nobody panics").push(word.to_le_bytes()[0]);
    }

    fn transmit(&mut self, _now: VirtualNanos) -> Option<u16> {
        None
    }
}
