//! The disparity PNG of the KITTI benchmark: 16 bits, disparity x 256, 0 = unknown. A known disparity
//! of 0 is written as 1, so that it stays known.

use anyhow::{Result, ensure};
use haarline::Disparity;
use image::ExtendedColorType;

use super::encode_png;
use crate::DisparityMap;
use crate::stereo::disparity_map::px;

/// The file of `map`.
///
/// # Errors
/// If a disparity lies outside of 0 to 256 px, which the format cannot tell.
pub fn encode(map: &DisparityMap) -> Result<Vec<u8>> {
    let samples = samples(map)?;
    let bytes: Vec<u8> = samples.iter().flat_map(|sample| sample.to_ne_bytes()).collect();
    encode_png(&bytes, [map.width, map.height], ExtendedColorType::L16)
}

fn samples(map: &DisparityMap) -> Result<Vec<u16>> {
    let mut samples = Vec::with_capacity(map.disparity.len());
    for (index, disparity) in map.disparity.iter().enumerate() {
        let Some(bits) = disparity.known() else {
            samples.push(0);
            continue;
        };
        let sample = u16::try_from(i32::from(bits) << (8 - Disparity::FRAC_BITS));
        ensure!(
            sample.is_ok(),
            "disparity {} px in column {}, row {} does not fit a 16-bit PNG, which holds 0 to 256 px: \
             write a .pfm, or search from --min-disparity 0",
            px(bits),
            index % map.width,
            index / map.width
        );
        samples.push(sample?.max(1));
    }
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(bits: &[i16]) -> DisparityMap {
        let disparity = bits.iter().map(|&bits| Disparity::from_bits(bits)).collect();
        DisparityMap { width: bits.len(), height: 1, disparity, confidence: vec![1; bits.len()] }
    }

    #[test]
    fn unknown_stays_apart_from_zero() {
        let map = map(&[i16::MIN, 0, 1, 160, 4095]);
        assert_eq!(samples(&map).unwrap(), [0, 1, 16, 2560, 65520]);
        let image = image::load_from_memory(&encode(&map).unwrap()).unwrap();
        assert_eq!(image.into_luma16().into_raw(), [0, 1, 16, 2560, 65520]);
    }

    #[test]
    fn values_out_of_range_are_refused() {
        for bits in [-1, 4096, i16::MAX] {
            let error = encode(&map(&[0, bits])).unwrap_err().to_string();
            assert!(error.contains("column 1, row 0"), "{error}");
        }
    }
}
