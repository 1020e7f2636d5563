//! Disparity maps to look at: in colours with a legend, and in grey.

use anyhow::Result;
use haarline::{Config, Disparity};
use image::{ExtendedColorType, Rgb, RgbImage};

use super::obstacle_strip::ObstacleStrip;
use super::{encode_png, legend};
use crate::stereo::disparity_map::px;
use crate::{DisparityMap, Geometry};

/// The disparities that the colours span, px; what lies outside has the colour of the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourRange {
    /// Disparity of the first colour.
    pub min_px: f64,
    /// Disparity of the last colour, greater than `min_px`.
    pub max_px: f64,
}

impl ColourRange {
    /// Spans what is known in `map` but for the outermost half percent, out to whole px.
    #[must_use]
    pub fn of(map: &DisparityMap) -> Self {
        let mut known: Vec<i16> = map.known().collect();
        known.sort_unstable();
        let Some(last) = known.len().checked_sub(1) else { return Self { min_px: 0.0, max_px: 1.0 } };
        let tail = known.len() / 200;
        let (min_px, max_px) = (px(known[tail]).floor(), px(known[last - tail]).ceil());
        Self { min_px, max_px: max_px.max(min_px + 1.0) }
    }

    /// Spans what is searched, whatever is found.
    #[must_use]
    pub fn of_search(config: &Config) -> Self {
        let min_px = f64::from(config.min_disparity);
        Self { min_px, max_px: min_px + f64::from(config.num_disparities.saturating_sub(1).max(1)) }
    }

    /// The colour of a disparity: from blue for far to red for near. No grey is among them.
    pub(super) fn colour(&self, disparity_px: f64) -> Rgb<u8> {
        let place = (disparity_px - self.min_px) / (self.max_px - self.min_px);
        // Without the map's dark ends, which look too much like unknown pixels.
        Rgb(colorous::TURBO.eval_continuous(0.08 + 0.88 * place.clamp(0.0, 1.0)).into_array())
    }
}

/// What unknown pixels look like: a checkerboard of dark greys.
pub(super) fn unknown_colour(x: u32, y: u32) -> Rgb<u8> {
    if (x / 4 + y / 4).is_multiple_of(2) { Rgb([38; 3]) } else { Rgb([58; 3]) }
}

/// The map in colours with a legend in px, and in m where the geometry is known, as a PNG.
///
/// # Errors
/// If the encoder fails.
pub fn encode(map: &DisparityMap, range: &ColourRange, geometry: Option<&Geometry>) -> Result<Vec<u8>> {
    let picture = draw(map, range, geometry);
    let size = [picture.width() as usize, picture.height() as usize];
    encode_png(picture.as_raw(), size, ExtendedColorType::Rgb8)
}

/// The map in colours with a legend, and a strip of obstacles below it, as a PNG.
///
/// # Errors
/// If the encoder fails.
pub fn encode_with_obstacles<const SECTORS: usize>(
    map: &DisparityMap,
    range: &ColourRange,
    strip: &ObstacleStrip<'_, SECTORS>,
) -> Result<Vec<u8>> {
    let picture = draw(map, range, Some(strip.geometry));
    let picture = strip.below(&picture, [map.width as u32, map.height as u32], range);
    let size = [picture.width() as usize, picture.height() as usize];
    encode_png(picture.as_raw(), size, ExtendedColorType::Rgb8)
}

/// The map in its own pixels at the top left, the legend right of it.
#[must_use]
pub fn draw(map: &DisparityMap, range: &ColourRange, geometry: Option<&Geometry>) -> RgbImage {
    let mut picture = legend::draw([map.width as u32, map.height as u32], range, geometry);
    for (index, disparity) in map.disparity.iter().enumerate() {
        let (x, y) = ((index % map.width) as u32, (index / map.width) as u32);
        let colour = disparity.known().map_or_else(|| unknown_colour(x, y), |bits| range.colour(px(bits)));
        picture.put_pixel(x, y, colour);
    }
    picture
}

/// The map in grey as a PNG of 8 bits: the nearer the brighter. The range that was searched becomes 1 to 255,
/// linearly; unknown is 0.
///
/// # Errors
/// If the encoder fails.
pub fn encode_grey(map: &DisparityMap, config: &Config) -> Result<Vec<u8>> {
    let luma: Vec<u8> = map.disparity.iter().map(|&disparity| grey(disparity, config)).collect();
    super::encode_grey_png(&luma, [map.width, map.height])
}

fn grey(disparity: Disparity, config: &Config) -> u8 {
    let Some(bits) = disparity.known() else { return 0 };
    let steps = f64::from(config.num_disparities.saturating_sub(1).max(1));
    let place = (px(bits) - f64::from(config.min_disparity)) / steps;
    (1.0 + 254.0 * place.clamp(0.0, 1.0)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_spans_the_search_and_unknown_is_black() {
        let config = Config { width: 64, min_disparity: -2, num_disparities: 5 };
        let cases = [(-3, 1), (-2, 1), (0, 128), (2, 255), (9, 255)];
        for (disparity, wanted) in cases {
            assert_eq!(grey(Disparity::from_px(disparity), &config), wanted, "{disparity} px");
        }
        assert_eq!(grey(Disparity::UNKNOWN, &config), 0);
        assert_eq!(grey(Disparity::from_px(0), &Config { min_disparity: 0, num_disparities: 1, ..config }), 1);
    }

    #[test]
    fn colours_are_never_grey() {
        let range = ColourRange { min_px: 0.0, max_px: 100.0 };
        for step in 0..=100 {
            let Rgb(colour) = range.colour(f64::from(step));
            let spread = colour.iter().max().unwrap() - colour.iter().min().unwrap();
            assert!(spread > 60, "{step}: {colour:?}");
        }
    }

    #[test]
    fn unknown_maps_still_give_a_picture() {
        let map =
            DisparityMap { width: 40, height: 1, disparity: vec![Disparity::UNKNOWN; 40], confidence: vec![0; 40] };
        let picture = draw(&map, &ColourRange::of(&map), None);
        assert!(picture.width() > 40 && picture.height() > 40);
        assert_eq!(*picture.get_pixel(0, 0), unknown_colour(0, 0));
    }
}
