//! `haarline contours`: the contours of an image as a picture.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};

use super::{print, whole_number};
use crate::Frame;
use crate::contour_picture::ContourPicture;
use crate::output;

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
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let Self { image, output, half_support, columns, decimated } = self;
        let half_support = usize::try_from(half_support)
            .ok()
            .with_context(|| format!("--half-support {half_support}: must be 1 px or more"))?;
        output::check_png_name("-o", &output)?;
        output::check_writable("-o", &output)?;
        ensure!(!output::is_same_file(&output, &image), "-o {}: is the image, give another name", output.display());
        let frame = Frame::read_of_any_size(&image)?;
        let picture = ContourPicture { half_support, columns, decimated }.draw(&frame)?;
        output::write(&output, &output::encode_grey_png(&picture, [frame.width, frame.height])?)?;
        let contours = picture.iter().filter(|&&grey| grey > 0).count();
        let share = 100.0 * contours as f64 / picture.len() as f64;
        print(&format!("{}x{}, half-support {half_support}: {share:.2} % on contours\n", frame.width, frame.height))
    }
}
