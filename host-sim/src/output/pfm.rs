//! PFM, the format of the Middlebury benchmark: disparity in px as 32-bit floating point, little
//! endian, from the bottom row to the top one; unknown is positive infinity.

use crate::DisparityMap;
use crate::stereo::disparity_map::px;

/// The file of `map`.
#[must_use]
pub fn encode(map: &DisparityMap) -> Vec<u8> {
    // A negative scale tells little endian.
    let mut bytes = format!("Pf\n{} {}\n-1.0\n", map.width, map.height).into_bytes();
    for row in map.disparity.chunks_exact(map.width).rev() {
        for disparity in row {
            let value = disparity.known().map_or(f32::INFINITY, |bits| px(bits) as f32);
            bytes.extend_from_slice(&value.to_le_bytes());
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::Disparity;

    #[test]
    fn bottom_row_first_and_unknown_is_infinite() {
        let disparity = [Disparity::from_px(1), Disparity::UNKNOWN, Disparity::from_bits(-8), Disparity::from_px(0)];
        let map = DisparityMap { width: 2, height: 2, disparity: disparity.to_vec(), confidence: vec![0; 4] };
        let bytes = encode(&map);
        let (header, samples) = bytes.split_at(bytes.len() - 16);
        assert_eq!(header, b"Pf\n2 2\n-1.0\n");
        let values: Vec<f32> = samples.as_chunks().0.iter().map(|&sample| f32::from_le_bytes(sample)).collect();
        assert_eq!(values, [-0.5, 0.0, 1.0, f32::INFINITY]);
    }
}
