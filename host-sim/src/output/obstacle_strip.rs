//! A strip below a picture: the nearest obstacle of each sector, in the picture's colours.

use embedded_graphics::Drawable;
use embedded_graphics::mono_font::{MonoTextStyle, ascii::FONT_4X6};
use embedded_graphics::prelude::Point;
use embedded_graphics::text::{Alignment, Baseline, Text, TextStyleBuilder};
use haarline::Setup;
use image::{GenericImage as _, RgbImage};

use super::colour_range::ColourRange;
use super::legend::{BACKGROUND, Canvas, INK};
use super::picture::{scale, unknown_colour};
use crate::{DisparityMap, Geometry};

/// Height of a sector's field, px.
const FIELD: u32 = 16;
/// Height of the line of numbers below, px.
const NUMBERS: u32 = 10;
/// Space above the strip, px.
const GAP: u32 = 4;
/// Width of a digit, px.
const DIGIT: i64 = 4;

/// What is drawn below a map.
#[derive(Debug)]
pub struct ObstacleStrip<'a, const SECTORS: usize> {
    /// The rig.
    pub setup: &'a Setup<SECTORS>,
    /// Its focal length and baseline.
    pub geometry: &'a Geometry,
    /// Distance in each sector, mm.
    pub nearest_mm: &'a [Option<u32>],
}

impl<const SECTORS: usize> ObstacleStrip<'_, SECTORS> {
    /// `picture` of `map` with the strip below the map: each sector where the map's middle row sees it, coloured
    /// as a surface at that distance, with the distance in cm.
    #[must_use]
    pub fn below(&self, picture: &RgbImage, map: &DisparityMap, range: &ColourRange) -> RgbImage {
        let scale = scale(map.width);
        let top = map.height as u32 * scale + GAP;
        let height = picture.height().max(top + FIELD + NUMBERS);
        let mut canvas = Canvas(RgbImage::from_pixel(picture.width(), height, BACKGROUND));
        if canvas.0.copy_from(picture, 0, 0).is_err() {
            return canvas.0;
        }
        let borders = self.borders(map.width as u32);
        for (columns, &mm) in borders.windows(2).zip(self.nearest_mm) {
            let columns = [columns[0], columns[1]].map(|column| column * i64::from(scale));
            self.field(&mut canvas, columns, top, mm, range);
        }
        canvas.write("obstacles, cm", map.width as u32 * scale + GAP, top + FIELD / 2);
        canvas.0
    }

    /// Columns in which the sectors begin, and where the last one ends.
    fn borders(&self, width: u32) -> Vec<i64> {
        let sectors = &self.setup.sectors;
        let tangents = sectors.left_q16.iter().take(sectors.count).chain([&sectors.right_q16]);
        let ahead = self.geometry.focal_px * f64::from(self.setup.mounting.cos_pitch_q14) / 16_384.0;
        let middle = (f64::from(width) - 1.0) / 2.0;
        let column = |&tangent: &i32| (middle + ahead * f64::from(tangent) / 65_536.0).ceil() as i64;
        tangents.map(|tangent| column(tangent).clamp(0, width.into())).collect()
    }

    fn field(&self, canvas: &mut Canvas, [from, to]: [i64; 2], top: u32, mm: Option<u32>, range: &ColourRange) {
        let colour =
            mm.map(|mm| range.colour(self.geometry.focal_px * self.geometry.baseline_mm / f64::from(mm.max(1))));
        // A dark line between two sectors.
        for x in from + 1..to {
            for y in top..top + FIELD {
                let x = x as u32;
                canvas.0.put_pixel(x, y, colour.unwrap_or_else(|| unknown_colour(x, y)));
            }
        }
        let Some(cm) = mm.map(|mm| (mm / 10).to_string()) else { return };
        if DIGIT * cm.len() as i64 <= to - from {
            let style = TextStyleBuilder::new().alignment(Alignment::Center).baseline(Baseline::Top).build();
            let position = Point::new(i32::midpoint(from as i32, to as i32), (top + FIELD + 2) as i32);
            let Ok(_) = Text::with_text_style(&cm, position, MonoTextStyle::new(&FONT_4X6, INK), style).draw(canvas);
        }
    }
}
