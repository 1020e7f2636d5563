//! The legend of a picture: a bar of the colours with numbers beside it.

use embedded_graphics::mono_font::{MonoTextStyle, ascii::FONT_6X10};
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::prelude::{Dimensions, DrawTarget, OriginDimensions, Point, Size};
use embedded_graphics::text::{Alignment, Baseline, Text, TextStyleBuilder};
use embedded_graphics::{Drawable, Pixel};
use image::{Rgb, RgbImage};

use super::colour_range::ColourRange;
use super::picture::unknown_colour;
use crate::Geometry;

pub(super) const BACKGROUND: Rgb<u8> = Rgb([18, 18, 22]);
pub(super) const INK: Rgb888 = Rgb888::new(225, 225, 225);
/// Space around the bar, px.
const MARGIN: u32 = 10;
const BAR_WIDTH: u32 = 14;
const CHARACTER: u32 = 6;
/// The lowest picture in which the legend still has room, px.
const MIN_HEIGHT: u32 = 72;
/// Height of the line that explains unknown pixels, px.
const UNKNOWN_LINE: u32 = 22;

/// A picture for a map of that size, with the legend drawn and the map's place still empty.
pub(super) fn draw([map_width, map_height]: [u32; 2], range: &ColourRange, geometry: Option<&Geometry>) -> RgbImage {
    let ticks = ticks(range, map_height.max(MIN_HEIGHT));
    let labels: Vec<String> = ticks.iter().map(|&tick| label(tick, geometry)).collect();
    let characters = labels.iter().map(String::len).chain(["unknown".len()]).max().unwrap_or(0) as u32;
    let width = MARGIN + BAR_WIDTH + MARGIN + characters * CHARACTER + MARGIN;
    let height = map_height.max(MIN_HEIGHT);
    let mut canvas = Canvas(RgbImage::from_pixel(map_width + width, height, BACKGROUND));
    let bar = Bar { left: map_width + MARGIN, top: MARGIN, height: height - 2 * MARGIN - UNKNOWN_LINE };
    bar.draw(&mut canvas, range);
    for (&tick, label) in ticks.iter().zip(&labels) {
        let y = bar.row_of(tick, range);
        canvas.tick(bar.left + BAR_WIDTH, y);
        canvas.write(label, bar.left + BAR_WIDTH + MARGIN, y);
    }
    canvas.unknown(bar.left, height - MARGIN - 5);
    canvas.0
}

/// The bar of colours, the nearest at the top.
struct Bar {
    left: u32,
    top: u32,
    height: u32,
}

impl Bar {
    fn draw(&self, canvas: &mut Canvas, range: &ColourRange) {
        for row in 0..self.height {
            let place = 1.0 - f64::from(row) / f64::from(self.height - 1);
            let colour = range.colour(range.min_px + place * (range.max_px - range.min_px));
            for column in 0..BAR_WIDTH {
                canvas.0.put_pixel(self.left + column, self.top + row, colour);
            }
        }
    }

    fn row_of(&self, disparity_px: f64, range: &ColourRange) -> u32 {
        let place = (range.max_px - disparity_px) / (range.max_px - range.min_px);
        self.top + (place * f64::from(self.height - 1)).round() as u32
    }
}

/// Round numbers of px within the range, so many that their labels do not touch.
fn ticks(range: &ColourRange, height: u32) -> Vec<f64> {
    let room = f64::from((height - 2 * MARGIN - UNKNOWN_LINE) / 16).max(1.0);
    let span = range.max_px - range.min_px;
    let steps = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];
    let step = steps.into_iter().find(|step| span / step <= room).unwrap_or(1000.0);
    let first = (range.min_px / step).ceil() as i32;
    let last = (range.max_px / step).floor() as i32;
    (first..=last).map(|tick| f64::from(tick) * step).collect()
}

fn label(disparity_px: f64, geometry: Option<&Geometry>) -> String {
    let px = format!("{disparity_px:3.0} px");
    match geometry.map(|geometry| geometry.depth_m(disparity_px)) {
        None => px,
        Some(None) if disparity_px == 0.0 => format!("{px}    inf"),
        Some(None) => px,
        Some(Some(metres)) if metres < 10.0 => format!("{px} {metres:4.2} m"),
        Some(Some(metres)) if metres < 100.0 => format!("{px} {metres:4.1} m"),
        Some(Some(metres)) => format!("{px} {metres:4.0} m"),
    }
}

/// Lets the text of embedded-graphics draw on an image.
pub(super) struct Canvas(pub(super) RgbImage);

impl Canvas {
    pub(super) fn write(&mut self, text: &str, left: u32, middle: u32) {
        let style = TextStyleBuilder::new().alignment(Alignment::Left).baseline(Baseline::Middle).build();
        let position = Point::new(left as i32, middle as i32);
        let Ok(_) = Text::with_text_style(text, position, MonoTextStyle::new(&FONT_6X10, INK), style).draw(self);
    }

    fn tick(&mut self, left: u32, y: u32) {
        for x in left..left + MARGIN / 2 {
            self.0.put_pixel(x, y, Rgb([INK.r(), INK.g(), INK.b()]));
        }
    }

    fn unknown(&mut self, left: u32, middle: u32) {
        for y in middle - 5..middle + 5 {
            for x in left..left + BAR_WIDTH {
                self.0.put_pixel(x, y, unknown_colour(x, y));
            }
        }
        self.write("unknown", left + BAR_WIDTH + MARGIN, middle);
    }
}

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        Size::new(self.0.width(), self.0.height())
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = std::convert::Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Self::Error> {
        let area = self.bounding_box();
        for Pixel(point, colour) in pixels {
            if area.contains(point) {
                self.0.put_pixel(point.x as u32, point.y as u32, Rgb([colour.r(), colour.g(), colour.b()]));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_range() {
        assert_eq!(
            ticks(&ColourRange { min_px: 3.0, max_px: 44.0 }, 240),
            [5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0]
        );
        assert_eq!(ticks(&ColourRange { min_px: -2.0, max_px: 1.0 }, 240), [-2.0, -1.0, 0.0, 1.0]);
        assert!(ticks(&ColourRange { min_px: -128.0, max_px: 383.0 }, MIN_HEIGHT).len() <= 3);
    }

    #[test]
    fn labels_tell_metres_where_they_are_known() {
        let geometry = Geometry::new(200.0, 60.0).unwrap();
        assert_eq!(label(8.0, None), "  8 px");
        assert_eq!(label(8.0, Some(&geometry)), "  8 px 1.50 m");
        assert_eq!(label(1.0, Some(&geometry)), "  1 px 12.0 m");
        assert_eq!(label(0.0, Some(&geometry)), "  0 px    inf");
        assert_eq!(label(-4.0, Some(&geometry)), " -4 px");
    }
}
