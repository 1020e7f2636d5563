//! The packets that the program sent, as maps.

use std::collections::BTreeMap;

use anyhow::{Context, Result, ensure};
use haarline::Disparity;
use haarline::packet::Packet;

use crate::DisparityMap;

/// Puts rows together to maps, by the number of the frame. Rows that never came are unknown.
///
/// # Errors
/// If a packet is damaged, or one of no such frame: a file has no noise.
pub fn decode(bytes: Vec<u8>, [width, height]: [usize; 2]) -> Result<BTreeMap<u32, DisparityMap>> {
    let mut bytes = bytes;
    let mut maps = BTreeMap::new();
    for packet in bytes.split_inclusive_mut(|&byte| byte == 0) {
        let packet = Packet::decode(packet).context("a packet of the emulated program")?;
        let map = maps.entry(packet.frame).or_insert_with(|| DisparityMap {
            width,
            height,
            disparity: vec![Disparity::UNKNOWN; width * height],
            confidence: vec![0; width * height],
        });
        let Some(rows) = packet.content.rows() else { continue };
        for nth in 0..rows.count {
            let y = rows.y as usize + usize::from(nth);
            ensure!(y < height, "the program delivered row {y} of a frame of {height} rows");
            let at = y * width..(y + 1) * width;
            packet.read_row(nth, &mut map.disparity[at.clone()], &mut map.confidence[at])?;
        }
    }
    Ok(maps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::DisparityRow;
    use haarline::packet::{Encoder, max_bytes};

    #[test]
    fn rows_find_their_frame_and_place_and_missing_ones_are_unknown() {
        let (mut encoder, mut buffer) = (Encoder::new(), [0; max_bytes(4)]);
        let mut bytes = Vec::new();
        for (frame, y) in [(0, 0), (0, 1), (1, 1)] {
            let disparity = [Disparity::from_px((10 * frame + y) as i16); 4];
            let row = DisparityRow { y, disparity: &disparity, confidence: &[7; 4] };
            bytes.extend_from_slice(encoder.row(frame, row, &mut buffer).unwrap());
        }
        let maps = decode(bytes.clone(), [4, 2]).unwrap();
        assert_eq!(maps.keys().copied().collect::<Vec<_>>(), [0, 1]);
        assert_eq!([0, 1].map(|y| maps[&0].at(3, y)), [0, 1].map(Disparity::from_px));
        assert_eq!([0, 1].map(|y| maps[&1].at(0, y)), [Disparity::UNKNOWN, Disparity::from_px(11)]);
        assert_eq!(maps[&1].confidence, [0, 0, 0, 0, 7, 7, 7, 7]);
        bytes[3] ^= 1;
        assert!(decode(bytes, [4, 2]).is_err());
    }
}
