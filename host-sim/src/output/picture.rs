//! Disparity maps to look at: in colours with a legend, and in grey.

use anyhow::Result;
use haarline::confidence::SURE;
use haarline::obstacle::MAX_SECTORS;
use image::{ExtendedColorType, Rgb, RgbImage};

use super::colour_range::ColourRange;
use super::obstacle_strip::ObstacleStrip;
use super::{encode_png, legend};
use crate::stereo::disparity_map::px;
use crate::{DisparityMap, Geometry};

/// Maps of fewer columns are enlarged to as many at least.
const MIN_WIDTH: usize = 320;
/// The most that a map is enlarged.
const MAX_SCALE: usize = 8;

/// What unknown pixels look like: a checkerboard of dark greys.
pub(super) fn unknown_colour(x: u32, y: u32) -> Rgb<u8> {
    if (x / 4 + y / 4).is_multiple_of(2) { Rgb([38; 3]) } else { Rgb([58; 3]) }
}

/// The colour of an answer that is not sure: darker, so that what is sure stands out.
fn dim(Rgb(colour): Rgb<u8>) -> Rgb<u8> {
    Rgb(colour.map(|channel| (u16::from(channel) * 2 / 5 + 24) as u8))
}

/// Pixels of a picture, across and down, that show one of a map of `width` columns: small maps are enlarged.
#[must_use]
pub fn scale(width: usize) -> u32 {
    MIN_WIDTH.div_ceil(width.max(1)).clamp(1, MAX_SCALE) as u32
}

/// The map in colours with a legend in px, and in m where the geometry is known, as a PNG; with a strip of
/// obstacles below it, if there is one.
///
/// # Errors
/// If the encoder fails.
pub fn encode(
    map: &DisparityMap,
    range: &ColourRange,
    geometry: Option<&Geometry>,
    strip: Option<&ObstacleStrip<'_, MAX_SECTORS>>,
) -> Result<Vec<u8>> {
    let mut picture = draw(map, range, geometry);
    if let Some(strip) = strip {
        picture = strip.below(&picture, map, range);
    }
    let size = [picture.width() as usize, picture.height() as usize];
    encode_png(picture.as_raw(), size, ExtendedColorType::Rgb8)
}

/// The map, [enlarged](scale) if it is small, at the top left, the legend right of it. What is not sure
/// ([`SURE`]) is dim.
#[must_use]
pub fn draw(map: &DisparityMap, range: &ColourRange, geometry: Option<&Geometry>) -> RgbImage {
    let scale = scale(map.width);
    let mut picture = legend::draw([map.width as u32 * scale, map.height as u32 * scale], range, geometry);
    for (index, disparity) in map.disparity.iter().enumerate() {
        let is_sure = map.confidence[index] >= SURE;
        let shade = |colour| if is_sure { colour } else { dim(colour) };
        let colour = disparity.known().map(|bits| shade(range.colour(px(bits))));
        let (left, top) = ((index % map.width) as u32 * scale, (index / map.width) as u32 * scale);
        for (x, y) in (0..scale * scale).map(|at| (left + at % scale, top + at / scale)) {
            picture.put_pixel(x, y, colour.unwrap_or_else(|| unknown_colour(x, y)));
        }
    }
    picture
}

/// The map in grey as a PNG of 8 bits: the nearer the brighter. The range becomes 1 to 255, linearly; unknown
/// is 0.
///
/// # Errors
/// If the encoder fails.
pub fn encode_grey(map: &DisparityMap, range: &ColourRange) -> Result<Vec<u8>> {
    let grey = |disparity: &haarline::Disparity| disparity.known().map_or(0, |bits| range.grey(px(bits)));
    let luma: Vec<u8> = map.disparity.iter().map(grey).collect();
    super::encode_grey_png(&luma, [map.width, map.height])
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::Disparity;

    #[test]
    fn unknown_maps_still_give_a_picture() {
        let map =
            DisparityMap { width: 40, height: 1, disparity: vec![Disparity::UNKNOWN; 40], confidence: vec![0; 40] };
        let picture = draw(&map, &ColourRange::of(&map), None);
        assert!(picture.width() > 320 && picture.height() > 40);
        assert_eq!(*picture.get_pixel(0, 0), unknown_colour(0, 0));
    }

    #[test]
    fn small_maps_are_enlarged_by_whole_numbers() {
        let cases = [(32, 8), (96, 4), (128, 3), (160, 2), (319, 2), (320, 1), (1280, 1)];
        for (width, wanted) in cases {
            assert_eq!(scale(width), wanted, "{width} px");
        }
        let disparity = (0..96).map(Disparity::from_px).collect();
        let map = DisparityMap { width: 96, height: 1, disparity, confidence: vec![SURE; 96] };
        let range = ColourRange::of(&map);
        let picture = draw(&map, &range, None);
        for (x, y) in [(0, 0), (3, 3), (4, 0), (383, 3)] {
            assert_eq!(*picture.get_pixel(x, y), range.colour(f64::from(x / 4)), "{x}, {y}");
        }
        let doubtful = draw(&DisparityMap { confidence: vec![SURE - 1; 96], ..map }, &range, None);
        let brightness = |picture: &RgbImage| picture.get_pixel(200, 0).0.iter().map(|&c| u32::from(c)).sum::<u32>();
        assert!(brightness(&doubtful) < brightness(&picture));
    }
}
