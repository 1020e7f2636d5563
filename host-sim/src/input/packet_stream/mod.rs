//! Maps from the row packets that a chip sends: what came through, and what was lost on the way.

use haarline::frame_figures::FrameFigures;
use haarline::packet::{Content, Packet, PacketError, max_bytes};
use haarline::{Config, Counters, Disparity};

use crate::DisparityMap;
use frame::OpenFrame;
use order::{Arrival, Order};

mod frame;
mod order;
#[cfg(test)]
mod tests;

/// Rows that a frame may have: what a packet announces costs memory before anything of it came.
pub const MAX_HEIGHT: u16 = 4096;

/// What a stream was like so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Packets that came whole.
    pub packets: u64,
    /// Runs of bytes between two zeros that were no packet, and packets that contradict their frame or
    /// announce more than [`MAX_HEIGHT`] rows or [`Config::MAX_WIDTH`] columns.
    pub damaged: u64,
    /// Packets that were sent and did not come whole: gaps in their numbers. Those before the first one
    /// that came are not known.
    pub lost: u64,
    /// Packets left out because they came a second time, or after their frame had ended.
    pub repeated: u64,
    /// Times that the numbers went back: the sender began anew.
    pub restarts: u64,
    /// Frames of which no row came: there is no map of them.
    pub empty: u64,
    /// Frames of which the sender sent a part only, because the wire was too slow: there is no map of them.
    pub cut: u64,
    /// Frames that the sender did not send to their end since it began, as the last end told.
    pub unsent_frames: u64,
    /// Packets of another version, which cannot be read, and the last one's.
    pub other_version: Option<(u64, u32)>,
}

/// A frame put together from its packets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReceivedFrame {
    /// Its number, counted by the sender.
    pub number: u32,
    /// Its disparities; rows that did not come are unknown. At least one came.
    pub map: DisparityMap,
    /// The sender's counts at its end, or at its beginning if no end came.
    pub counters: Counters,
    /// What it is worth as a whole, if the sender told that.
    pub figures: Option<FrameFigures>,
    /// Rows that did not come.
    pub missing_rows: Vec<u32>,
    /// Whether its beginning, its end and every row in between came.
    pub is_whole: bool,
}

/// Takes a stream of bytes apart into frames. Never fails, whatever the bytes are: what is no packet is
/// counted, and the next zero begins a new one. Holds one frame at a time.
#[derive(Debug, Clone, Default)]
pub struct PacketStream {
    /// Bytes since the last zero.
    pending: Vec<u8>,
    /// Whether bytes of the pending packet were thrown away, because it is longer than any.
    overlong: bool,
    order: Order,
    open: Option<OpenFrame>,
    tally: Tally,
}

impl PacketStream {
    /// A stream of which nothing came yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// What the stream was like so far.
    #[must_use]
    pub fn tally(&self) -> Tally {
        Tally { lost: self.order.lost(), ..self.tally }
    }

    /// Takes the next bytes, in pieces of any size; gives the frames that ended with them one after the
    /// other. What the iterator was not asked for is not taken.
    pub fn push<'a>(&'a mut self, bytes: &'a [u8]) -> impl Iterator<Item = ReceivedFrame> + 'a {
        let mut pieces = bytes.split_inclusive(|&byte| byte == 0);
        std::iter::from_fn(move || {
            pieces.by_ref().find_map(|piece| match piece.strip_suffix(&[0]) {
                Some(end) => {
                    self.collect(end);
                    self.end_packet()
                }
                None => {
                    self.collect(piece);
                    None
                }
            })
        })
    }

    /// The stream ends: the frame that had not ended, if there is one.
    pub fn finish(&mut self) -> Option<ReceivedFrame> {
        if !std::mem::take(&mut self.pending).is_empty() {
            self.tally.damaged += 1;
        }
        self.close(None)
    }

    fn collect(&mut self, bytes: &[u8]) {
        let room = max_bytes(Config::MAX_WIDTH).saturating_sub(self.pending.len());
        self.overlong |= bytes.len() > room;
        self.pending.extend_from_slice(&bytes[..bytes.len().min(room)]);
    }

    /// A zero came: the frame that ended with the packet before it. A packet ends one frame at most.
    fn end_packet(&mut self) -> Option<ReceivedFrame> {
        let mut pending = std::mem::take(&mut self.pending);
        let overlong = std::mem::take(&mut self.overlong);
        if pending.is_empty() {
            return None;
        }
        let fingerprint = order::fingerprint(&pending);
        let packet = if overlong { Err(PacketError::Damaged) } else { Packet::decode(&mut pending) };
        let ended = packet.and_then(|packet| self.take(&packet, fingerprint));
        // The room is used again.
        pending.clear();
        self.pending = pending;
        ended.unwrap_or_else(|error| {
            if let PacketError::Version { found } = error {
                let count = self.tally.other_version.map_or(0, |(count, _)| count);
                self.tally.other_version = Some((count + 1, found));
            } else {
                self.tally.damaged += 1;
            }
            None
        })
    }

    /// What a packet tells; the frame that ended with it.
    fn take(&mut self, packet: &Packet<'_>, fingerprint: u64) -> Result<Option<ReceivedFrame>, PacketError> {
        let rows = read_rows(packet)?;
        let arrival = self.order.place(packet.sequence, fingerprint);
        let is_of_open = self.open.as_ref().is_some_and(|open| open.number == packet.frame);
        if arrival == Arrival::Repeated || arrival == Arrival::Late && !is_of_open {
            self.tally.repeated += 1;
            return Ok(None);
        }
        self.tally.packets += 1;
        let is_begin = matches!(packet.content, Content::Begin { .. });
        let is_another = match arrival {
            Arrival::Restart => true,
            Arrival::Late => false,
            _ => is_begin || !is_of_open,
        };
        self.tally.restarts += u64::from(arrival == Arrival::Restart);
        let ended = if is_another { self.close(None) } else { None };
        let open = self.open.get_or_insert_with(|| OpenFrame::new(packet.frame));
        match packet.content {
            Content::Begin { width, height, counters } => {
                open.counters = counters;
                self.tally.damaged += open.begin(width, height);
            }
            Content::End { end, counters } => {
                (open.counters, open.figures) = (counters, end.figures);
                self.tally.unsent_frames = end.unsent_frames.into();
                if end.is_cut {
                    // What came of it is no frame.
                    self.open = None;
                    self.tally.cut += 1;
                    return Ok(ended);
                }
                return Ok(ended.or(self.close(Some(end.rows))));
            }
            _ => {
                let fits = rows.into_iter().fold(true, |fit, (y, disparity, confidence)| {
                    let fits = open.add(y, disparity, confidence);
                    fit && fits
                });
                self.tally.damaged += u64::from(!fits);
            }
        }
        Ok(ended)
    }

    /// Ends the open frame, whose end told `told` rows.
    fn close(&mut self, told: Option<u32>) -> Option<ReceivedFrame> {
        let open = self.open.take()?;
        let frame = open.close(told);
        self.tally.empty += u64::from(frame.is_none());
        frame
    }
}

/// A row: its place, disparities and confidences.
type Row = (u32, Vec<Disparity>, Vec<u8>);

/// The rows of a packet, none of one that has none, and a check of what the others announce.
fn read_rows(packet: &Packet<'_>) -> Result<Vec<Row>, PacketError> {
    let rows = packet.content.rows();
    let (width, height) = match packet.content {
        Content::Begin { width, height, .. } => (width, height.into()),
        Content::End { end, .. } => (0, end.rows),
        _ => rows.map_or((0, 0), |rows| (rows.width, rows.y.saturating_add(rows.count.into()))),
    };
    if width > Config::MAX_WIDTH || height > MAX_HEIGHT.into() {
        return Err(PacketError::Width);
    }
    let Some(rows) = rows else { return Ok(Vec::new()) };
    let read = |nth: u8| {
        let (mut disparity, mut confidence) = (vec![Disparity::UNKNOWN; width.into()], vec![0; width.into()]);
        packet.read_row(nth, &mut disparity, &mut confidence)?;
        Ok((rows.y + u32::from(nth), disparity, confidence))
    };
    (0..rows.count).map(read).collect()
}
