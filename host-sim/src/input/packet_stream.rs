//! Maps from the row packets that a chip sends: what came through, and what was lost on the way.

use std::collections::BTreeMap;

use haarline::packet::{Content, Packet, PacketError, max_bytes};
use haarline::{Config, Counters, Disparity, DisparityRow};

use crate::DisparityMap;

/// A gap in the numbers from here on is a sender that began anew.
const RESTART_GAP: u32 = u32::MAX / 2;

/// What a stream was like so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Packets that came whole.
    pub packets: u64,
    /// Runs of bytes between two zeros that were no packet.
    pub damaged: u64,
    /// Packets that were sent and did not come whole: gaps in their numbers. Those before the first one
    /// that came are not known.
    pub lost: u64,
    /// Times that the numbers went back: the sender began anew.
    pub restarts: u64,
}

/// A frame put together from its packets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReceivedFrame {
    /// Its number, counted by the sender.
    pub number: u32,
    /// Its disparities; rows that did not come are unknown.
    pub map: DisparityMap,
    /// The sender's counts in the last packet of it that came.
    pub counters: Counters,
    /// Rows that did not come.
    pub missing_rows: Vec<u32>,
    /// Whether its beginning, its end and every row in between came.
    pub is_whole: bool,
}

/// Takes a stream of bytes apart into frames. Never fails, whatever the bytes are: what is no packet is
/// counted, and the next zero begins a new one.
#[derive(Debug, Clone, Default)]
pub struct PacketStream {
    /// Bytes since the last zero.
    pending: Vec<u8>,
    /// Whether bytes of the pending packet were thrown away, because it is longer than any.
    overlong: bool,
    /// The number that the next packet should have.
    next: Option<u32>,
    open: Option<OpenFrame>,
    tally: Tally,
}

/// A frame that is coming in.
#[derive(Debug, Clone)]
struct OpenFrame {
    number: u32,
    counters: Counters,
    begun: Option<[u16; 2]>,
    rows: BTreeMap<u32, (Vec<Disparity>, Vec<u8>)>,
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
        self.tally
    }

    /// Takes the next bytes, in pieces of any size; the frames that ended with them.
    pub fn push(&mut self, bytes: &[u8]) -> Vec<ReceivedFrame> {
        let mut frames = Vec::new();
        let mut parts = bytes.split(|&byte| byte == 0);
        // What follows the last zero, or all if there is none, waits for more.
        let rest = parts.next_back().unwrap_or(&[]);
        for part in parts {
            self.collect(part);
            let mut pending = std::mem::take(&mut self.pending);
            let overlong = std::mem::take(&mut self.overlong);
            if !pending.is_empty() {
                let packet = if overlong { Err(PacketError::Damaged) } else { Packet::decode(&mut pending) };
                let ended = packet.and_then(|packet| self.take(&packet));
                match ended {
                    Ok(ended) => frames.extend(ended),
                    Err(_) => self.tally.damaged += 1,
                }
            }
        }
        self.collect(rest);
        frames
    }

    /// The stream ends: the frame that had not ended, if there is one.
    pub fn finish(&mut self) -> Option<ReceivedFrame> {
        if !std::mem::take(&mut self.pending).is_empty() {
            self.tally.damaged += 1;
        }
        self.open.take().map(|frame| frame.close(None))
    }

    fn collect(&mut self, bytes: &[u8]) {
        let room = max_bytes(Config::MAX_WIDTH).saturating_sub(self.pending.len());
        self.overlong |= bytes.len() > room;
        self.pending.extend_from_slice(&bytes[..bytes.len().min(room)]);
    }

    /// What a packet tells; the frames that ended with it, at most two.
    fn take(&mut self, packet: &Packet<'_>) -> Result<Vec<ReceivedFrame>, PacketError> {
        let row = match packet.content {
            Content::Row { y, width, .. } => Some((y, read_row(packet, y, width)?)),
            Content::Begin { width, .. } if width > Config::MAX_WIDTH => return Err(PacketError::Width),
            Content::End { rows } if rows > u32::from(u16::MAX) => return Err(PacketError::Unknown),
            Content::Begin { .. } | Content::End { .. } => None,
        };
        self.count(packet.sequence);
        let mut ended = Vec::new();
        let is_begin = matches!(packet.content, Content::Begin { .. });
        if let Some(open) = self.open.take_if(|open| is_begin || open.number != packet.frame) {
            ended.push(open.close(None));
        }
        let open = self.open.get_or_insert_with(|| OpenFrame::new(packet.frame));
        open.counters = packet.counters;
        match packet.content {
            Content::Begin { width, height } => open.begun = Some([width, height]),
            Content::Row { .. } => open.rows.extend(row),
            Content::End { rows } => ended.extend(self.open.take().map(|frame| frame.close(Some(rows)))),
        }
        Ok(ended)
    }

    fn count(&mut self, sequence: u32) {
        let gap = self.next.map_or(0, |next| sequence.wrapping_sub(next));
        if gap < RESTART_GAP {
            self.tally.lost += u64::from(gap);
        } else {
            self.tally.restarts += 1;
        }
        self.tally.packets += 1;
        self.next = Some(sequence.wrapping_add(1));
    }
}

fn read_row(packet: &Packet<'_>, y: u32, width: u16) -> Result<(Vec<Disparity>, Vec<u8>), PacketError> {
    if width > Config::MAX_WIDTH || y >= u32::from(u16::MAX) {
        return Err(PacketError::Width);
    }
    let (mut disparity, mut confidence) = (vec![Disparity::UNKNOWN; width.into()], vec![0; width.into()]);
    packet.read_row(&mut disparity, &mut confidence)?;
    Ok((disparity, confidence))
}

impl OpenFrame {
    fn new(number: u32) -> Self {
        Self { number, counters: Counters::ZERO, begun: None, rows: BTreeMap::new() }
    }

    /// The frame as far as it came; `told` are the rows that its end told.
    fn close(self, told: Option<u32>) -> ReceivedFrame {
        let width = self.begun.map(|[width, _]| usize::from(width));
        let width = width.or_else(|| self.rows.values().next().map(|(disparity, _)| disparity.len())).unwrap_or(0);
        let seen = self.rows.last_key_value().map_or(0, |(y, _)| y + 1);
        let height = told.or(self.begun.map(|[_, height]| height.into())).unwrap_or(0).max(seen);
        let (unknown, none) = (vec![Disparity::UNKNOWN; width], vec![0; width]);
        let mut map = DisparityMap::with_capacity(width, height as usize);
        let mut missing_rows = Vec::new();
        for y in 0..height {
            match self.rows.get(&y) {
                Some((disparity, confidence)) if disparity.len() == width => {
                    map.push_row(&DisparityRow { y, disparity, confidence });
                }
                _ => {
                    missing_rows.push(y);
                    map.push_row(&DisparityRow { y, disparity: &unknown, confidence: &none });
                }
            }
        }
        let is_whole = self.begun.is_some() && told == Some(height) && missing_rows.is_empty();
        ReceivedFrame { number: self.number, map, counters: self.counters, missing_rows, is_whole }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::packet::Encoder;

    const SIZE: [u16; 2] = [40, 6];

    fn map(frame: u32) -> DisparityMap {
        let mut map = DisparityMap::with_capacity(40, 6);
        for y in 0..6u32 {
            let disparity: Vec<Disparity> = (0..40)
                .map(|x| if x < 8 { Disparity::UNKNOWN } else { Disparity::from_bits(x / 4 * 9 + y as i16) })
                .collect();
            let confidence: Vec<u8> = (0..40).map(|x| if x < 8 { 0 } else { 100 + x / 4 + frame as u8 }).collect();
            map.push_row(&DisparityRow { y, disparity: &disparity, confidence: &confidence });
        }
        map
    }

    /// The packets of frames 0 and up, one after the other.
    fn packets(frames: u32) -> Vec<Vec<u8>> {
        let (mut encoder, mut buffer, mut packets) = (Encoder::new(), [0; max_bytes(SIZE[0])], Vec::new());
        let mut counters = Counters::ZERO;
        for frame in 0..frames {
            counters.frames += 1;
            packets.push(encoder.begin(frame, SIZE, &counters, &mut buffer).unwrap().to_vec());
            let map = map(frame);
            for (y, (disparity, confidence)) in map.disparity.chunks(40).zip(map.confidence.chunks(40)).enumerate() {
                counters.rows += 1;
                let row = DisparityRow { y: y as u32, disparity, confidence };
                packets.push(encoder.row(frame, row, &counters, &mut buffer).unwrap().to_vec());
            }
            packets.push(encoder.end(frame, 6, &counters, &mut buffer).unwrap().to_vec());
        }
        packets
    }

    #[test]
    fn frames_come_back_whole_in_pieces_of_any_size() {
        let bytes = packets(3).concat();
        for piece in [1, 7, 100, bytes.len()] {
            let mut stream = PacketStream::new();
            let frames: Vec<ReceivedFrame> = bytes.chunks(piece).flat_map(|bytes| stream.push(bytes)).collect();
            assert_eq!(stream.finish(), None);
            assert_eq!(stream.tally(), Tally { packets: 24, ..Tally::default() });
            assert_eq!(frames.len(), 3);
            for (number, frame) in (0..).zip(frames) {
                assert_eq!((frame.number, frame.is_whole, &frame.map), (number, true, &map(number)), "{piece}");
                assert_eq!((frame.counters.frames, frame.counters.rows), (number + 1, 6 * (number + 1)));
            }
        }
    }

    #[test]
    fn lost_and_damaged_rows_are_unknown_counted_and_nothing_else_suffers() {
        let mut packets = packets(2);
        packets.remove(2); // row 1
        packets[3][5] ^= 0x40; // row 3
        let mut stream = PacketStream::new();
        let frames = stream.push(&packets.concat());
        assert_eq!(stream.tally(), Tally { packets: 14, damaged: 1, lost: 2, restarts: 0 });
        let (first, whole) = (&frames[0], map(0));
        assert_eq!((first.is_whole, &first.missing_rows[..]), (false, &[1, 3][..]));
        for y in 0..6 {
            let row = y * 40..(y + 1) * 40;
            let is_missing = [1, 3].contains(&y);
            assert_eq!(first.map.disparity[row.clone()] == whole.disparity[row.clone()], !is_missing);
            assert!(!is_missing || first.map.confidence[row].iter().all(|&confidence| confidence == 0));
        }
        assert!(frames[1].is_whole && frames[1].map == map(1));
    }

    #[test]
    fn a_frame_without_begin_or_end_is_told_as_such() {
        let packets = packets(3);
        let mut stream = PacketStream::new();
        // From the middle of frame 0 up to row 1 of frame 1, then frame 2.
        let bytes = [&packets[3..11], &packets[16..]].concat().concat();
        let frames = stream.push(&bytes[3..]);
        assert_eq!(frames.iter().map(|frame| frame.is_whole).collect::<Vec<_>>(), [false, false, true]);
        assert_eq!(frames[0].missing_rows, [0, 1, 2]);
        assert_eq!(frames[1].missing_rows, [2, 3, 4, 5]);
        assert_eq!(stream.tally(), Tally { packets: 15, damaged: 1, lost: 5, restarts: 0 });
        assert_eq!(frames[2].map, map(2));
    }

    #[test]
    fn a_sender_that_begins_anew_has_lost_nothing() {
        let mut stream = PacketStream::new();
        let frames = stream.push(&[packets(2), packets(1)].concat().concat());
        assert_eq!(frames.iter().map(|frame| frame.number).collect::<Vec<_>>(), [0, 1, 0]);
        assert_eq!(stream.tally(), Tally { packets: 24, damaged: 0, lost: 0, restarts: 1 });
    }

    #[test]
    fn garbage_is_survived_and_the_next_frame_is_whole() {
        let mut garbage: Vec<u8> = (0..20_000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        garbage.extend([7; 9_000]);
        garbage.push(0);
        let mut stream = PacketStream::new();
        assert!(stream.push(&garbage).is_empty());
        assert!(stream.tally().damaged > 0 && stream.tally().packets == 0);
        let frames = stream.push(&packets(1).concat());
        assert!(frames[0].is_whole && frames[0].map == map(0));
        stream.push(&packets(1).concat()[..30]);
        assert!(!stream.finish().unwrap().is_whole);
    }
}
