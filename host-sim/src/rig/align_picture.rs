//! Both views of a frame with rows drawn through them, as they came and rectified.

use anyhow::Result;
use haarline::Rectification;
use image::{ExtendedColorType, Rgb, RgbImage};

use crate::output;
use crate::stereo::pipeline;
use crate::{Frame, StereoPair};

/// Rows between two lines, px of the view.
const EVERY: usize = 16;
/// Views narrower than this are drawn twice as large.
const SMALL: usize = 240;
/// Space between views, px.
const GAP: usize = 6;

/// The picture as PNG: the views as they came above, rectified below.
///
/// # Errors
/// If a figure of the rectification is out of its range.
pub fn encode(pair: &StereoPair, rectification: &Rectification) -> Result<Vec<u8>> {
    let zoom = if pair.width() < SMALL { 2 } else { 1 };
    let (width, height) = (pair.width() * zoom, pair.height() * zoom);
    let mut picture = RgbImage::new((2 * width + GAP) as u32, (2 * height + GAP) as u32);
    let after = pipeline::rectified_views(rectification, pair)?;
    for (top, views) in [(0, pair), (height + GAP, &after)] {
        for (left, view) in [(0, &views.left), (width + GAP, &views.right)] {
            draw(&mut picture, [left, top], view, zoom);
        }
        for y in (EVERY / 2..pair.height()).step_by(EVERY) {
            for x in 0..2 * width + GAP {
                picture.put_pixel(x as u32, (top + y * zoom) as u32, line_colour(y));
            }
        }
    }
    let size = [2 * width + GAP, 2 * height + GAP];
    output::encode_png(&picture, size, ExtendedColorType::Rgb8)
}

fn draw(picture: &mut RgbImage, [left, top]: [usize; 2], view: &Frame, zoom: usize) {
    for y in 0..view.height * zoom {
        for x in 0..view.width * zoom {
            let grey = view.luma[y / zoom * view.width + x / zoom];
            picture.put_pixel((left + x) as u32, (top + y) as u32, Rgb([grey; 3]));
        }
    }
}

/// Two colours in turn, so that a line is not mistaken for its neighbour.
fn line_colour(y: usize) -> Rgb<u8> {
    if (y / EVERY).is_multiple_of(2) { Rgb([255, 190, 40]) } else { Rgb([60, 200, 255]) }
}
