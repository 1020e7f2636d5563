//! NPY, numpy's format: disparity in px as 32-bit floating point, row by row from the top; unknown is NaN.

use crate::DisparityMap;
use crate::stereo::disparity_map::px;

/// Magic number and version 1.0.
const MAGIC: &[u8; 8] = b"\x93NUMPY\x01\x00";
/// The samples begin at a multiple of it.
const ALIGNMENT: usize = 64;

/// The file of `map`.
#[must_use]
pub fn encode(map: &DisparityMap) -> Vec<u8> {
    let shape = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}), }}", map.height, map.width);
    // Magic, two bytes of length, the shape, spaces and a line's end.
    let begin = (MAGIC.len() + 2 + shape.len() + 1).next_multiple_of(ALIGNMENT);
    let header = format!("{shape:<width$}\n", width = begin - MAGIC.len() - 3);
    let mut bytes = MAGIC.to_vec();
    bytes.extend_from_slice(&(header.len() as u16).to_le_bytes());
    bytes.extend_from_slice(header.as_bytes());
    for disparity in &map.disparity {
        let value = disparity.known().map_or(f32::NAN, |bits| px(bits) as f32);
        bytes.extend_from_slice(&value.to_le_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::Disparity;

    #[test]
    fn top_row_first_and_unknown_is_no_number() {
        let disparity = [Disparity::from_px(1), Disparity::UNKNOWN, Disparity::from_bits(-8), Disparity::from_px(0)];
        for height in [1, 2, 4] {
            let map = DisparityMap { width: 4 / height, height, disparity: disparity.to_vec(), confidence: vec![0; 4] };
            let bytes = encode(&map);
            let (header, samples) = bytes.split_at(bytes.len() - 16);
            assert_eq!((header.len() % ALIGNMENT, header[header.len() - 1]), (0, b'\n'));
            assert_eq!(usize::from(header[8]) + 10, header.len(), "the length it tells");
            let values: Vec<f32> = samples.as_chunks().0.iter().map(|&sample| f32::from_le_bytes(sample)).collect();
            assert!(values[1].is_nan());
            assert_eq!([values[0], values[2], values[3]], [1.0, -0.5, 0.0]);
        }
    }
}
