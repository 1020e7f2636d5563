use super::*;
use proptest::prelude::*;

const MOST: Counters = Counters {
    frames: u32::MAX,
    rows: u32::MAX,
    dropped_rows: u32::MAX,
    dropped_frames: u32::MAX,
    overruns: u32::MAX,
    short: u32::MAX,
    long: u32::MAX,
    stalled: u32::MAX,
    dma_errors: u32::MAX,
};
const WIDTH: usize = 1280;

struct Row {
    disparity: [Disparity; WIDTH],
    confidence: [u8; WIDTH],
    width: usize,
}

impl Row {
    fn of(pixels: impl IntoIterator<Item = (i16, u8)>) -> Self {
        let mut row = Self { disparity: [Disparity::UNKNOWN; WIDTH], confidence: [0; WIDTH], width: 0 };
        for (bits, confidence) in pixels {
            row.disparity[row.width] = Disparity::from_bits(bits);
            row.confidence[row.width] = confidence;
            row.width += 1;
        }
        row
    }

    fn row(&self, y: u32) -> DisparityRow<'_> {
        DisparityRow { y, disparity: &self.disparity[..self.width], confidence: &self.confidence[..self.width] }
    }

    /// Bytes of its packet, after checking that it comes back.
    fn through(&self, counters: &Counters) -> usize {
        let mut buffer = [0; max_bytes(1280)];
        let bytes = Encoder::new().row(5, self.row(9), counters, &mut buffer).unwrap();
        let count = bytes.len();
        assert_eq!(bytes.iter().position(|&byte| byte == 0), Some(count - 1));
        let packet = Packet::decode(bytes).unwrap();
        assert_eq!((packet.sequence, packet.frame, packet.counters), (0, 5, *counters));
        let mut back = Self::of([(1, 1); WIDTH]);
        packet.read_row(&mut back.disparity[..self.width], &mut back.confidence[..self.width]).unwrap();
        assert_eq!(back.disparity[..self.width], self.disparity[..self.width]);
        assert_eq!(back.confidence[..self.width], self.confidence[..self.width]);
        count
    }
}

#[test]
fn a_row_of_holes_is_a_few_bytes_and_one_of_noise_the_most() {
    assert_eq!(Row::of([(i16::MIN, 0); 320]).through(&Counters::ZERO), 26);
    let noise = (0..1280u16).map(|x| (x.wrapping_mul(40_503).cast_signed(), 1 + x.to_le_bytes()[0] % 255));
    for (width, most) in [(320, 1035), (640, 1998), (1280, 3926)] {
        let row = Row::of(noise.clone().take(width));
        assert!(row.through(&MOST) <= most, "{width}: {}", row.through(&MOST));
        assert!(row.through(&MOST) > 3 * width);
        assert_eq!(max_bytes(u16::try_from(width).unwrap()), most);
    }
}

#[test]
fn packets_are_numbered_and_tell_begin_and_end() {
    let mut encoder = Encoder { sequence: u32::MAX };
    let mut buffer = [0; max_bytes(0)];
    let begin = *Packet::decode(encoder.begin(7, [320, 240], &Counters::ZERO, &mut buffer).unwrap()).as_ref().unwrap();
    assert_eq!((begin.sequence, begin.frame), (u32::MAX, 7));
    assert_eq!(begin.content, Content::Begin { width: 320, height: 240 });
    let end = *Packet::decode(encoder.end(7, 240, &MOST, &mut buffer).unwrap()).as_ref().unwrap();
    assert_eq!((end.sequence, end.counters), (0, MOST));
    assert_eq!(end.content, Content::End { rows: 240 });
    assert_eq!(end.read_row(&mut [], &mut []), Err(PacketError::Width));
}

#[test]
fn a_row_that_is_none_and_a_buffer_too_small_are_refused_and_use_no_number() {
    let mut encoder = Encoder::new();
    let row = DisparityRow { y: 0, disparity: &[Disparity::UNKNOWN; 4], confidence: &[0; 4] };
    let needed = max_bytes(4);
    let mut small = [0; max_bytes(4) - 1];
    let refused = encoder.row(0, row, &Counters::ZERO, &mut small).unwrap_err();
    assert_eq!(refused, PacketError::Buffer { needed, found: needed - 1 });
    let mut buffer = [0; max_bytes(4)];
    let odd = DisparityRow { confidence: &[0; 3], ..row };
    assert_eq!(encoder.row(0, odd, &Counters::ZERO, &mut buffer).unwrap_err(), PacketError::Row);
    let bytes = encoder.row(0, row, &Counters::ZERO, &mut buffer).unwrap();
    let packet = Packet::decode(bytes).unwrap();
    assert_eq!(packet.sequence, 0);
    assert_eq!(packet.read_row(&mut [Disparity::UNKNOWN; 5], &mut [0; 5]), Err(PacketError::Width));
}

#[test]
fn one_wrong_byte_anywhere_is_noticed() {
    let row = Row::of((0..40).map(|x| (x / 4, 9)));
    let mut buffer = [0; max_bytes(40)];
    let bytes = Encoder::new().row(5, row.row(9), &Counters::ZERO, &mut buffer).unwrap();
    for at in 0..bytes.len() - 1 {
        for flip in [1, 0x10, 0x80, 0xFF] {
            let mut wrong = [0; max_bytes(40)];
            let wrong = &mut wrong[..bytes.len()];
            wrong.copy_from_slice(bytes);
            wrong[at] ^= flip;
            assert!(Packet::decode(wrong).is_err(), "byte {at} ^ {flip:#x}");
        }
    }
}

/// Steps and runs of every size, and pixels a method never delivers.
fn pixels() -> impl Strategy<Value = (i16, u8, usize)> {
    let bits = prop_oneof![Just(i16::MIN), -8i16..8, -200i16..200, any::<i16>()];
    let length = prop_oneof![1usize..6, 1usize..40, 1usize..700];
    (bits, prop_oneof![Just(0), any::<u8>()], length)
}

proptest! {
    #[test]
    fn every_whole_row_comes_back_exactly(steps in prop::collection::vec((-40i16..40, any::<u8>(), 1usize..9), 1..60)) {
        let mut bits = 0;
        let pixels = steps.iter().flat_map(|&(step, confidence, length)| {
            bits += step;
            let level = bits;
            (0i16..).zip(core::iter::repeat_n(confidence, length)).map(move |(i, confidence)| (level + i % 3, confidence))
        });
        Row::of(pixels.take(WIDTH)).through(&Counters::ZERO);
    }

    #[test]
    fn every_row_comes_back_exactly(runs in prop::collection::vec(pixels(), 0..40)) {
        let pixels = runs.iter().flat_map(|&(bits, confidence, length)| (0..length).map(move |_| (bits, confidence)));
        Row::of(pixels.take(WIDTH)).through(&Counters::ZERO);
    }

    #[test]
    fn every_row_without_any_order_comes_back_exactly(pixels in prop::collection::vec(any::<(i16, u8)>(), 0..80)) {
        Row::of(pixels).through(&MOST);
    }

    #[test]
    fn no_bytes_make_the_decoder_fail(
        mut bytes in prop::collection::vec(any::<u8>(), 0..200),
        coding in prop_oneof![Just(Coding::Runs), Just(Coding::Plain), Just(Coding::Cells)],
        width in 0usize..300,
    ) {
        let (mut disparity, mut confidence) = ([Disparity::UNKNOWN; 300], [0; 300]);
        let room = (&mut disparity[..width], &mut confidence[..width]);
        // What a sender with another idea of the form might have put under a right checksum.
        let _ = coding::read(coding, &bytes, room.0, room.1);
        let _ = Packet::decode(&mut bytes);
    }
}
