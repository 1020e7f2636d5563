//! Frames: one view, and the rectified pair of them, from image files.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use haarline::Config;
use image::{DynamicImage, RgbImage};

use crate::input::image_file;

/// One view: 8-bit luma, and its colours where the file had any.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` pixels from the top left.
    pub luma: Vec<u8>,
    /// The colours, if the file was a colour image.
    pub colour: Option<RgbImage>,
}

impl Frame {
    /// A grey frame of `luma`.
    ///
    /// # Panics
    /// If `luma` does not hold `width * height` pixels.
    #[must_use]
    pub fn from_luma(width: usize, height: usize, luma: Vec<u8>) -> Self {
        assert_eq!(luma.len(), width * height, "pixels of a {width}x{height} frame");
        Self { width, height, luma, colour: None }
    }

    /// Reads a view and checks that the core can take its size.
    ///
    /// Of 16-bit samples the high byte counts. Colour becomes luma as in OpenCV's `cvtColor`
    /// (Rec. 601, integer weights), transparency is ignored.
    ///
    /// # Errors
    /// If the file cannot be read, is no such image or has a width outside of 32 to 1280 px.
    pub fn read(path: &Path) -> Result<Self> {
        Self::of_image(image_file::read(path)?, path)
    }

    /// Reads a grey picture of any size, for those who do not match it.
    ///
    /// # Errors
    /// If the file cannot be read or is no such image.
    pub fn read_of_any_size(path: &Path) -> Result<Self> {
        let image = image_file::read(path)?;
        let (width, height) = (image.width() as usize, image.height() as usize);
        let (luma, colour) = luma_and_colour(image).with_context(|| path.display().to_string())?;
        Ok(Self { width, height, luma, colour })
    }

    /// The view in an image that comes from the file `path`, as [`Frame::read`].
    ///
    /// # Errors
    /// If it is no such image or has a width outside of 32 to 1280 px.
    pub fn of_image(image: DynamicImage, path: &Path) -> Result<Self> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let (min, max) = (usize::from(Config::MIN_WIDTH), usize::from(Config::MAX_WIDTH));
        ensure!(
            (min..=max).contains(&width),
            "{}: the view is {width} px wide, where {min} to {max} px are supported: scale or crop both views",
            path.display()
        );
        let (luma, colour) = luma_and_colour(image).with_context(|| path.display().to_string())?;
        Ok(Self { width, height, luma, colour })
    }

    /// Row `y`.
    ///
    /// # Panics
    /// If there is no such row.
    #[must_use]
    pub fn row(&self, y: usize) -> &[u8] {
        &self.luma[y * self.width..][..self.width]
    }
}

/// Both rectified views of one moment, of the same size.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StereoPair {
    /// The left view.
    pub left: Frame,
    /// The right view.
    pub right: Frame,
}

impl StereoPair {
    /// Reads both views.
    ///
    /// # Errors
    /// If one cannot be read or their sizes differ.
    pub fn read(left: &Path, right: &Path) -> Result<Self> {
        let pair = Self { left: Frame::read(left)?, right: Frame::read(right)? };
        let (l, r) = (&pair.left, &pair.right);
        ensure!(
            (l.width, l.height) == (r.width, r.height),
            "{} is {}x{} px, but {} is {}x{} px: both views must have the same size",
            left.display(),
            l.width,
            l.height,
            right.display(),
            r.width,
            r.height
        );
        Ok(pair)
    }

    /// Pixels in a row of either view.
    #[must_use]
    pub fn width(&self) -> usize {
        self.left.width
    }

    /// Rows of either view.
    #[must_use]
    pub fn height(&self) -> usize {
        self.left.height
    }
}

/// The luma plane, and the colours if it is a colour image.
fn luma_and_colour(image: DynamicImage) -> Result<(Vec<u8>, Option<RgbImage>)> {
    let rgb = match image {
        DynamicImage::ImageLuma8(grey) => return Ok((grey.into_raw(), None)),
        DynamicImage::ImageLumaA8(grey) => return Ok((grey.pixels().map(|p| p.0[0]).collect(), None)),
        DynamicImage::ImageLuma16(grey) => return Ok((grey.pixels().map(|p| high_byte(p.0[0])).collect(), None)),
        DynamicImage::ImageLumaA16(grey) => return Ok((grey.pixels().map(|p| high_byte(p.0[0])).collect(), None)),
        DynamicImage::ImageRgb8(rgb) => rgb,
        DynamicImage::ImageRgba8(_) => image.into_rgb8(),
        DynamicImage::ImageRgb16(_) | DynamicImage::ImageRgba16(_) => {
            let wide = image.into_rgb16();
            let (width, height) = wide.dimensions();
            let bytes = wide.into_raw().into_iter().map(high_byte).collect();
            RgbImage::from_raw(width, height, bytes).context("the image's size and its content differ")?
        }
        other => bail!("{:?} samples are not supported, 8 and 16 bits are", other.color()),
    };
    Ok((rgb.pixels().map(|p| rec601_luma(p.0)).collect(), Some(rgb)))
}

fn high_byte(sample: u16) -> u8 {
    sample.to_be_bytes()[0]
}

/// Luma of a colour by the weights 0.299, 0.587, 0.114, in the integers of OpenCV's `cvtColor`:
/// equal to the last bit, and grey stays what it was since they add up to 2^15.
#[must_use]
pub fn rec601_luma([red, green, blue]: [u8; 3]) -> u8 {
    let sum = 9798 * u32::from(red) + 19235 * u32::from(green) + 3735 * u32::from(blue);
    ((sum + (1 << 14)) >> 15) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luma_has_opencvs_weights() {
        for grey in 0..=255 {
            assert_eq!(rec601_luma([grey; 3]), grey);
        }
        // cv2.cvtColor of the pure colours and of one mixture.
        let cases = [([255, 0, 0], 76), ([0, 255, 0], 150), ([0, 0, 255], 29), ([12, 200, 77], 130)];
        for (colour, luma) in cases {
            assert_eq!(rec601_luma(colour), luma, "{colour:?}");
        }
    }

    #[test]
    fn sixteen_bit_samples_give_their_high_byte() {
        let grey = image::ImageBuffer::from_raw(2, 1, vec![0x12ff_u16, 0xff00]).unwrap();
        assert_eq!(luma_and_colour(DynamicImage::ImageLuma16(grey)).unwrap(), (vec![0x12, 0xff], None));
        let rgb = image::ImageBuffer::from_raw(1, 1, vec![0x64ff_u16, 0x6400, 0x6480]).unwrap();
        let (luma, colour) = luma_and_colour(DynamicImage::ImageRgb16(rgb)).unwrap();
        assert_eq!((luma, colour.unwrap().into_raw()), (vec![0x64], vec![0x64; 3]));
    }
}
