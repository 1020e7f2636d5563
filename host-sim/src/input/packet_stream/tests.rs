use super::*;
use haarline::DisparityRow;
use haarline::packet::{Encoder, FrameEnd};

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

fn end(rows: u32) -> FrameEnd {
    FrameEnd { rows, ..FrameEnd::NONE }
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
            packets.push(encoder.row(frame, row, &mut buffer).unwrap().to_vec());
        }
        packets.push(encoder.end(frame, &end(6), &counters, &mut buffer).unwrap().to_vec());
    }
    packets
}

#[test]
fn frames_come_back_whole_in_pieces_of_any_size() {
    let bytes = packets(3).concat();
    for piece in [1, 7, 100, bytes.len()] {
        let mut stream = PacketStream::new();
        let frames: Vec<ReceivedFrame> =
            bytes.chunks(piece).flat_map(|bytes| stream.push(bytes).collect::<Vec<_>>()).collect();
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
    let bytes = packets.concat();
    let frames: Vec<ReceivedFrame> = stream.push(&bytes).collect();
    assert_eq!(stream.tally(), Tally { packets: 14, damaged: 1, lost: 2, ..Tally::default() });
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
    let frames: Vec<ReceivedFrame> = stream.push(&bytes[3..]).collect();
    assert_eq!(frames.iter().map(|frame| frame.is_whole).collect::<Vec<_>>(), [false, false, true]);
    assert_eq!(frames[0].missing_rows, [0, 1, 2]);
    assert_eq!(frames[1].missing_rows, [2, 3, 4, 5]);
    assert_eq!(stream.tally(), Tally { packets: 15, damaged: 1, lost: 5, ..Tally::default() });
    assert_eq!(frames[2].map, map(2));
}

#[test]
fn a_sender_that_begins_anew_has_lost_nothing() {
    let mut stream = PacketStream::new();
    let bytes = [packets(2), packets(1)].concat().concat();
    let frames: Vec<ReceivedFrame> = stream.push(&bytes).collect();
    assert_eq!(frames.iter().map(|frame| frame.number).collect::<Vec<_>>(), [0, 1, 0]);
    assert_eq!(stream.tally(), Tally { packets: 24, restarts: 1, ..Tally::default() });
}

#[test]
fn garbage_is_survived_and_the_next_frame_is_whole() {
    let mut garbage: Vec<u8> = (0..20_000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    garbage.extend([7; 9_000]);
    garbage.push(0);
    let mut stream = PacketStream::new();
    assert_eq!(stream.push(&garbage).count(), 0);
    assert!(stream.tally().damaged > 0 && stream.tally().packets == 0);
    let bytes = packets(1).concat();
    let frames: Vec<ReceivedFrame> = stream.push(&bytes).collect();
    assert!(frames[0].is_whole && frames[0].map == map(0));
    assert_eq!(stream.push(&bytes[..90]).count(), 0);
    assert!(!stream.finish().unwrap().is_whole);
}

/// Frames of a whole stream, and what it was like.
fn received(packets: &[Vec<u8>]) -> (Vec<ReceivedFrame>, Tally) {
    let (mut stream, bytes) = (PacketStream::new(), packets.concat());
    let mut frames: Vec<ReceivedFrame> = stream.push(&bytes).collect();
    frames.extend(stream.finish());
    (frames, stream.tally())
}

#[test]
fn an_end_without_its_frame_is_no_frame() {
    let packets = packets(4);
    let numbers = |packets: &[Vec<u8>]| {
        let (frames, tally) = received(packets);
        assert!(frames.iter().all(|frame| frame.is_whole && frame.map == map(frame.number)));
        (frames.iter().map(|frame| frame.number).collect::<Vec<_>>(), tally.empty)
    };
    assert_eq!(numbers(&packets[7..8]), (vec![], 1), "an end alone");
    assert_eq!(numbers(&packets[7..]), (vec![1, 2, 3], 1), "a stream that starts at an end");
    let burst = [&packets[..8], &packets[15..]].concat();
    assert_eq!(numbers(&burst), (vec![0, 2, 3], 1), "all of frame 1 but its end is lost");
    let doubled = [&packets[..8], &packets[7..]].concat();
    assert_eq!(numbers(&doubled), (vec![0, 1, 2, 3], 0), "an end twice");
}

#[test]
fn repeated_and_late_packets_change_nothing_where_their_frame_is_open() {
    let mut swapped = packets(2);
    swapped.swap(2, 3);
    swapped.swap(8, 9);
    let (frames, tally) = received(&swapped);
    assert!(frames.iter().all(|frame| frame.is_whole && frame.map == map(frame.number)), "{frames:?}");
    assert_eq!(tally, Tally { packets: 16, ..Tally::default() });
    let twice: Vec<Vec<u8>> = packets(2).into_iter().flat_map(|packet| [packet.clone(), packet]).collect();
    let (frames, tally) = received(&twice);
    assert_eq!((frames.len(), tally), (2, Tally { packets: 16, repeated: 16, ..Tally::default() }));
    assert!(frames.iter().all(|frame| frame.is_whole && frame.map == map(frame.number)));
}

#[test]
fn a_sender_that_begins_anew_within_a_frame_leaves_two_parts() {
    let first = &packets(1)[..4];
    let (frames, tally) = received(&[first, &packets(1)].concat());
    assert_eq!((frames.len(), tally.restarts, tally.lost), (2, 1, 0));
    assert_eq!((&frames[0].missing_rows[..], frames[1].is_whole), (&[3, 4, 5][..], true));
}

#[test]
fn what_a_packet_announces_is_bounded() {
    let mut bytes = Vec::new();
    let (mut encoder, mut buffer) = (Encoder::new(), [0; max_bytes(0)]);
    for frame in 0..200 {
        bytes.extend_from_slice(encoder.begin(frame, [1280, u16::MAX], &Counters::ZERO, &mut buffer).unwrap());
        bytes.extend_from_slice(encoder.end(frame, &end(65_535), &Counters::ZERO, &mut buffer).unwrap());
    }
    let mut stream = PacketStream::new();
    assert_eq!(stream.push(&bytes).count(), 0);
    assert_eq!((stream.finish(), stream.tally()), (None, Tally { damaged: 400, ..Tally::default() }));
}

/// Loses, damages, doubles, swaps or cuts something.
fn corrupt(packets: &mut Vec<Vec<u8>>, random: &mut impl FnMut(usize) -> usize) {
    let at = random(packets.len());
    let count = 1 + random(20).min(packets.len() - at - 1);
    match random(7) {
        0 => drop(packets.drain(at..at + count)),
        1 => {
            let byte = random(packets[at].len());
            packets[at][byte] ^= 1 << random(8);
        }
        2 => {
            let again = packets[at..at + count].to_vec();
            packets.splice(at..at, again);
        }
        3 => {
            let other = random(packets.len());
            packets.swap(at, other);
        }
        4 => packets[at].truncate(random(40)),
        5 => packets[at] = (0..random(60)).map(|_| random(256) as u8).collect(),
        _ => packets.truncate(at + 1),
    }
}

#[test]
fn no_corruption_makes_a_wrong_row() {
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut whole = 0;
    for case in 0..400 {
        let mut packets = packets(6);
        for _ in 0..=random(4) {
            corrupt(&mut packets, &mut random);
        }
        let (frames, _) = received(&packets);
        for frame in frames {
            let right = map(frame.number);
            whole += u32::from(frame.is_whole);
            assert!(frame.map.height <= 6 && frame.map.width == 40, "case {case}");
            for y in 0..frame.map.height {
                let row = y * 40..(y + 1) * 40;
                let is_right = frame.map.disparity[row.clone()] == right.disparity[row.clone()]
                    && frame.map.confidence[row.clone()] == right.confidence[row.clone()];
                let is_unknown = frame.map.confidence[row].iter().all(|&confidence| confidence == 0);
                let is_missing = frame.missing_rows.contains(&(y as u32));
                assert!(if is_missing { is_unknown } else { is_right }, "case {case}: frame {}, row {y}", frame.number);
            }
        }
    }
    assert!(whole > 1000, "{whole}");
}

/// Packets of frames whose rows go two at a time.
fn pairs(frame: u32) -> Vec<Vec<u8>> {
    let (mut encoder, mut buffer) = (Encoder::new(), [0; max_bytes(SIZE[0])]);
    let map = pair_map(frame);
    let mut packets = vec![encoder.begin(frame, SIZE, &Counters::ZERO, &mut buffer).unwrap().to_vec()];
    for y in (0..6).step_by(2) {
        let rows = [0, 1].map(|nth| {
            let at = (y + nth) * 40..(y + nth + 1) * 40;
            DisparityRow { y: (y + nth) as u32, disparity: &map.disparity[at.clone()], confidence: &map.confidence[at] }
        });
        let (together, packet) = encoder.rows(frame, &rows, &mut buffer).unwrap();
        assert_eq!(together, 2);
        packets.push(packet.to_vec());
    }
    packets.push(encoder.end(frame, &end(6), &Counters::ZERO, &mut buffer).unwrap().to_vec());
    packets
}

fn pair_map(frame: u32) -> DisparityMap {
    let mut map = DisparityMap::with_capacity(40, 6);
    for y in 0..6u32 {
        let value = |x: i16| Disparity::from_bits(x / 4 * 9 + 2 * y as i16 + frame as i16);
        let disparity: Vec<Disparity> = (0..40).map(value).collect();
        map.push_row(&DisparityRow { y, disparity: &disparity, confidence: &[96; 40] });
    }
    map
}

#[test]
fn rows_that_go_two_at_a_time_come_back_and_are_lost_two_at_a_time() {
    let (frames, tally) = received(&pairs(3));
    assert_eq!((frames.len(), frames[0].is_whole, &frames[0].map), (1, true, &pair_map(3)));
    assert_eq!(tally, Tally { packets: 5, ..Tally::default() });
    let mut packets = pairs(3);
    packets.remove(2);
    let (frames, tally) = received(&packets);
    assert_eq!((&frames[0].missing_rows[..], frames[0].is_whole, tally.lost), (&[2, 3][..], false, 1));
}

#[test]
fn a_frame_that_was_cut_is_dropped_whole_and_counted() {
    let mut packets = packets(2);
    let (mut encoder, mut buffer) = (Encoder::new(), [0; max_bytes(SIZE[0])]);
    for _ in 0..7 {
        encoder.begin(0, SIZE, &Counters::ZERO, &mut buffer).unwrap();
    }
    let cut = FrameEnd { rows: 4, unsent_frames: 9, is_cut: true, figures: None };
    packets[7] = encoder.end(0, &cut, &Counters::ZERO, &mut buffer).unwrap().to_vec();
    let (frames, tally) = received(&packets);
    assert_eq!(frames.iter().map(|frame| frame.number).collect::<Vec<_>>(), [1]);
    assert_eq!((tally.cut, tally.empty, tally.damaged), (1, 0, 0));
}

#[test]
fn the_figures_of_a_frame_come_with_its_end_and_packets_of_another_version_are_told() {
    use haarline::frame_figures::Input;
    let (mut encoder, mut buffer) = (Encoder::new(), [0; max_bytes(SIZE[0])]);
    let mut bytes = packets(1)[..7].concat();
    for _ in 0..7 {
        encoder.begin(0, SIZE, &Counters::ZERO, &mut buffer).unwrap();
    }
    let figures = Some(FrameFigures { input: Input::Mismatch, mismatch: Some(301), sure: 77, row_error_q8: Some(-30) });
    let told = FrameEnd { rows: 6, unsent_frames: 2, is_cut: false, figures };
    bytes.extend_from_slice(encoder.end(0, &told, &Counters::ZERO, &mut buffer).unwrap());
    let mut stream = PacketStream::new();
    let frames: Vec<ReceivedFrame> = stream.push(&bytes).collect();
    assert_eq!((frames[0].figures, frames[0].is_whole, stream.tally().unsent_frames), (figures, true, 2));
    // A packet of version 1 with nothing in it but its checksum, that of no bytes.
    let mut stream = PacketStream::new();
    assert_eq!(stream.push(&[1, 1, 1, 1, 1, 0]).count(), 0);
    assert_eq!(stream.tally().other_version, Some((1, 1)));
}
