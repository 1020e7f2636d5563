//! `haarline contours`: the contours of an image as a picture.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};

use super::{print, whole_number};
use crate::Frame;
use crate::output;
use crate::output::contour_picture::ContourPicture;

/// Arguments of `haarline contours`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Image: PNG, PGM, PPM, BMP, JPEG or TIFF, of any size
    image: PathBuf,
    /// Picture: contours bright on black, the brighter the stronger
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
    /// Half-support of the Haar wavelet, px: the larger, the less fine detail
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = whole_number)]
    half_support: i64,
    /// Contours along the columns, too: the lying ones
    #[arg(long)]
    columns: bool,
    /// By the decimated transform: fewer contours, at multiples of the half-support
    #[arg(long)]
    decimated: bool,
    /// Marks the points of maximum curvature: contours grey, and white squares where a clear upright one bends
    #[arg(long, conflicts_with = "decimated")]
    curvature: bool,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let Self { image, output, half_support, columns, decimated, curvature } = self;
        let half_support = usize::try_from(half_support)
            .ok()
            .with_context(|| format!("--half-support {half_support}: must be 1 px or more"))?;
        output::check_png_name("-o", &output)?;
        output::check_writable("-o", &output)?;
        ensure!(!output::is_same_file(&output, &image), "-o {}: is the image, give another name", output.display());
        let frame = Frame::read_of_any_size(&image)?;
        let contours = ContourPicture { half_support, columns, decimated };
        let mut picture = contours.draw(&frame)?;
        let share = 100.0 * picture.iter().filter(|&&grey| grey > 0).count() as f64 / picture.len() as f64;
        let mut bends = String::new();
        if curvature {
            let points = contours.bends(&frame);
            mark(&mut picture, frame.width, &points);
            bends = format!(", {} points of maximum curvature", points.len());
        }
        output::write(&output, &output::encode_grey_png(&picture, [frame.width, frame.height])?)?;
        let Frame { width, height, .. } = frame;
        print(&format!("{width}x{height}, half-support {half_support}: {share:.2} % on contours{bends}\n"))
    }
}

/// Dims the picture and marks these pixels by white squares of 3 px.
fn mark(picture: &mut [u8], width: usize, points: &[usize]) {
    for grey in picture.iter_mut() {
        *grey /= 2;
    }
    for &point in points {
        for row in [point.checked_sub(width), Some(point), Some(point + width)].into_iter().flatten() {
            let columns = row.saturating_sub(1)..(row + 2).min(picture.len());
            if let Some(square) = picture.get_mut(columns) {
                square.fill(255);
            }
        }
    }
}
