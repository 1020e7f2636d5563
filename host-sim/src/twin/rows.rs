//! The rows that the program delivered, as maps.

use std::collections::BTreeMap;

use anyhow::{Result, ensure};
use haarline::Disparity;

use crate::DisparityMap;

/// Puts rows together to maps, by the number of the frame. Rows that never came are unknown.
///
/// # Errors
/// If the bytes are no rows of such frames.
pub fn decode(bytes: &[u8], width: usize, height: usize) -> Result<BTreeMap<u32, DisparityMap>> {
    let len = 8 + 3 * width;
    ensure!(bytes.len().is_multiple_of(len), "the program's rows are cut off");
    let mut maps = BTreeMap::new();
    for row in bytes.chunks_exact(len) {
        let (head, row) = row.split_at(8);
        let number = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| head[at + i]));
        let (frame, y) = (number(0), number(4) as usize);
        ensure!(y < height, "the program delivered row {y} of a frame of {height} rows");
        let map = maps.entry(frame).or_insert_with(|| DisparityMap {
            width,
            height,
            disparity: vec![Disparity::UNKNOWN; width * height],
            confidence: vec![0; width * height],
        });
        let (disparity, confidence) = row.split_at(2 * width);
        let at = y * width..(y + 1) * width;
        for (to, &bits) in map.disparity[at.clone()].iter_mut().zip(disparity.as_chunks().0) {
            *to = Disparity::from_bits(i16::from_le_bytes(bits));
        }
        map.confidence[at].copy_from_slice(confidence);
    }
    Ok(maps)
}
