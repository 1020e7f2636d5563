//! Depth as a PNG of 16 bits in mm, as RealSense's tools, the TUM benchmark (which scales by 5) and ROS have it:
//! 0 = unknown. What is farther than 65.535 m or infinitely far does not fit and is 0, too.

use anyhow::Result;
use image::ExtendedColorType;

use super::encode_png;
use crate::{DisparityMap, Geometry};

/// The file of `map`. What is farther than `max_depth_m` is left out.
///
/// # Errors
/// If the encoder fails.
pub fn encode(map: &DisparityMap, geometry: &Geometry, max_depth_m: Option<f64>) -> Result<Vec<u8>> {
    let most = max_depth_m.map_or(f64::from(u16::MAX), |metres| metres * 1000.0);
    let sample = |&disparity: &haarline::Disparity| {
        let mm = geometry.depth_mm(disparity).and_then(|mm| u16::try_from(mm).ok());
        // Nearer than half a mm is no depth.
        mm.filter(|&mm| f64::from(mm) <= most).unwrap_or(0)
    };
    let bytes: Vec<u8> = map.disparity.iter().flat_map(|disparity| sample(disparity).to_ne_bytes()).collect();
    encode_png(&bytes, [map.width, map.height], ExtendedColorType::L16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::Disparity;

    #[test]
    fn depth_is_in_mm_and_0_where_it_cannot_be_told() {
        let bits = [i16::MIN, 8 * 16, 16, 0, -16, 1, 2];
        let disparity = bits.map(Disparity::from_bits).to_vec();
        let map = DisparityMap { width: 7, height: 1, disparity, confidence: vec![1; 7] };
        let geometry = Geometry::new(100.0, 60.0).unwrap();
        let read = |max_depth_m| {
            let image = image::load_from_memory(&encode(&map, &geometry, max_depth_m).unwrap()).unwrap();
            image.into_luma16().into_raw()
        };
        assert_eq!(read(None), [0, 750, 6000, 0, 0, 0, 48_000]);
        assert_eq!(read(Some(6.0)), [0, 750, 6000, 0, 0, 0, 0]);
        assert_eq!(read(Some(5.9)), [0, 750, 0, 0, 0, 0, 0]);
    }
}
