//! Frames: one view, and the rectified pair of them, from image files.

use std::path::Path;
use std::str::FromStr;

use anyhow::{Context, Result, bail, ensure};
use haarline::Config;
use image::{DynamicImage, RgbImage};

use crate::input::caveat::{self, Caveat};
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
    /// Of 16-bit samples the high byte counts, of those with fewer bits the highest eight of these. Colour
    /// becomes luma as in OpenCV's `cvtColor` (Rec. 601, integer weights), transparency is ignored.
    ///
    /// # Errors
    /// If the file cannot be read, is no such image or has a width outside of 32 to 1280 px.
    pub fn read(path: &Path) -> Result<Self> {
        let image = image_file::read(path)?;
        let bits = bits_told([&image; 1], path);
        Self::of_image(image, bits, Shrink::NONE, path)
    }

    /// Reads a grey picture of any size, for those who do not match it.
    ///
    /// # Errors
    /// If the file cannot be read or is no such image.
    pub fn read_of_any_size(path: &Path) -> Result<Self> {
        let image = image_file::read(path)?;
        let bits = bits_told([&image; 1], path);
        Self::of_any_size(image, bits, path)
    }

    fn of_any_size(image: DynamicImage, bits: u32, path: &Path) -> Result<Self> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let (luma, colour) = luma_and_colour(image, bits).with_context(|| path.display().to_string())?;
        Ok(Self { width, height, luma, colour })
    }

    /// The view in an image that comes from the file `path`.
    fn of_image(image: DynamicImage, bits: u32, shrink: Shrink, path: &Path) -> Result<Self> {
        let (width, height) = (shrink.of(image.width()), shrink.of(image.height()));
        let (min, max) = (u32::from(Config::MIN_WIDTH), u32::from(Config::MAX_WIDTH));
        let name = path.display();
        let least = (2..=Shrink::MAX).find(|k| image.width() / k <= max).filter(|_| width > max);
        let advice = match least {
            Some(k) => format!("--shrink {k} makes one px of {k} x {k} of both views"),
            None => "scale or crop both views".to_owned(),
        };
        ensure!(
            (min..=max).contains(&width),
            "{name}: the view is {width} px wide, where {min} to {max} px are supported: {advice}"
        );
        ensure!(height > 0, "{name}: the view has fewer rows than --shrink {}", shrink.0);
        Ok(shrink.apply(Self::of_any_size(image, bits, path)?))
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
        Self::read_shrunk(left, right, Shrink::NONE)
    }

    /// Reads both views and shrinks them.
    ///
    /// # Errors
    /// If one cannot be read or their sizes differ.
    pub fn read_shrunk(left: &Path, right: &Path, shrink: Shrink) -> Result<Self> {
        Self::of_images([image_file::read(left)?, image_file::read(right)?], [left, right], shrink)
    }

    /// The views in the images left and right, which come from these files.
    ///
    /// # Errors
    /// If one cannot be a view or their sizes differ.
    pub fn of_images([left, right]: [DynamicImage; 2], [from, from_right]: [&Path; 2], shrink: Shrink) -> Result<Self> {
        let [l, r] = [&left, &right].map(|view| (view.width(), view.height()));
        let turned = if l == (r.1, r.0) { "; is one of them turned by its EXIF orientation?" } else { "" };
        ensure!(
            l == r,
            "{} is {}x{} px, but {} is {}x{} px: both views must have the same size{turned}",
            from.display(),
            l.0,
            l.1,
            from_right.display(),
            r.0,
            r.1
        );
        let bits = bits_told([&left, &right], from);
        Ok(Self {
            left: Frame::of_image(left, bits, shrink, from)?,
            right: Frame::of_image(right, bits, shrink, from_right)?,
        })
    }

    /// The same, shrunk.
    #[must_use]
    pub fn shrunk(self, shrink: Shrink) -> Self {
        Self { left: shrink.apply(self.left), right: shrink.apply(self.right) }
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

/// How many columns, and rows, become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shrink(u32);

impl Shrink {
    /// Views as they are.
    pub const NONE: Self = Self(1);
    const MAX: u32 = 8;

    /// The divisor.
    #[must_use]
    pub fn factor(self) -> u32 {
        self.0
    }

    /// So many pixels of a side are left. Those that fill no pixel fall away.
    #[must_use]
    pub fn of(self, side: u32) -> u32 {
        side / self.0
    }

    /// The frame, each pixel the mean of `factor` x `factor`, rounded to nearest.
    #[must_use]
    pub fn apply(self, frame: Frame) -> Frame {
        let k = self.0 as usize;
        if k == 1 {
            return frame;
        }
        let (width, height) = (frame.width / k, frame.height / k);
        let mean = |sample: &dyn Fn(usize, usize) -> u8, x: usize, y: usize| {
            let samples = (0..k * k).map(|i| u32::from(sample(x * k + i % k, y * k + i / k)));
            ((samples.sum::<u32>() + self.0 * self.0 / 2) / (self.0 * self.0)) as u8
        };
        let luma = |x, y| frame.luma[y * frame.width + x];
        let pixels = (0..width * height).map(|index| (index % width, index / width));
        let colour = frame.colour.as_ref().map(|colour| {
            RgbImage::from_fn(width as u32, height as u32, |x, y| {
                let channel = |c: usize| mean(&|x, y| colour.get_pixel(x as u32, y as u32)[c], x as usize, y as usize);
                image::Rgb([channel(0), channel(1), channel(2)])
            })
        });
        Frame { width, height, luma: pixels.map(|(x, y)| mean(&luma, x, y)).collect(), colour }
    }
}

impl FromStr for Shrink {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let factor = text.parse().ok().filter(|factor| (1..=Self::MAX).contains(factor));
        factor.map(Self).ok_or_else(|| format!("must be a whole number, 1 to {}", Self::MAX))
    }
}

/// Depths that cameras with more than 8 bits have; their drivers often leave the high bits of 16 empty.
const DEPTHS: [u32; 4] = [8, 10, 12, 14];

/// Bits that the 16-bit samples of the views need, all of them together: scaled apart, they would differ in
/// brightness. Where they are fewer than 16, that is told.
fn bits_told<const N: usize>(views: [&DynamicImage; N], path: &Path) -> u32 {
    let most = views.into_iter().filter_map(most_of_16_bits).max();
    let depth = most.filter(|&most| most > 0).and_then(|most| DEPTHS.into_iter().find(|bits| most >> bits == 0));
    if let Some(bits) = depth {
        caveat::tell(Caveat::FewBits(bits), &path.display());
    }
    depth.unwrap_or(16)
}

/// The greatest sample of an image with samples of 16 bits.
fn most_of_16_bits(image: &DynamicImage) -> Option<u16> {
    match image {
        DynamicImage::ImageLuma16(grey) => grey.iter().max().copied(),
        DynamicImage::ImageLumaA16(grey) => grey.pixels().map(|pixel| pixel.0[0]).max(),
        DynamicImage::ImageRgb16(rgb) => rgb.iter().max().copied(),
        DynamicImage::ImageRgba16(rgb) => rgb.pixels().flat_map(|pixel| pixel.0.into_iter().take(3)).max(),
        _ => None,
    }
}

/// The luma plane, and the colours if it is a colour image; `bits` are those that samples of 16 bits have.
fn luma_and_colour(image: DynamicImage, bits: u32) -> Result<(Vec<u8>, Option<RgbImage>)> {
    let high_byte = |sample: u16| (sample >> (bits - 8)) as u8;
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

    fn grey16(samples: &[u16]) -> DynamicImage {
        let image = image::ImageBuffer::from_raw(samples.len() as u32, 1, samples.to_vec());
        DynamicImage::ImageLuma16(image.unwrap())
    }

    #[test]
    fn sixteen_bit_samples_give_their_high_byte() {
        assert_eq!(luma_and_colour(grey16(&[0x12ff, 0xff00]), 16).unwrap(), (vec![0x12, 0xff], None));
        let rgb = image::ImageBuffer::from_raw(1, 1, vec![0x64ff_u16, 0x6400, 0x6480]).unwrap();
        let (luma, colour) = luma_and_colour(DynamicImage::ImageRgb16(rgb), 16).unwrap();
        assert_eq!((luma, colour.unwrap().into_raw()), (vec![0x64], vec![0x64; 3]));
    }

    #[test]
    fn fewer_bits_are_found_over_both_views_together() {
        let bits = |left: &[u16], right: &[u16]| bits_told([&grey16(left), &grey16(right)], Path::new("test"));
        let cases: [(u16, u32); 8] =
            [(255, 8), (256, 10), (1023, 10), (1024, 12), (4095, 12), (4096, 14), (16383, 14), (16384, 16)];
        for (most, wanted) in cases {
            assert_eq!((bits(&[0], &[most]), bits(&[most], &[1])), (wanted, wanted), "{most}");
        }
        assert_eq!(bits(&[0], &[0]), 16);
        assert_eq!(luma_and_colour(grey16(&[1023, 512, 3]), 10).unwrap().0, [255, 128, 0]);
        let grey: DynamicImage = image::GrayImage::new(3, 1).into();
        assert_eq!(bits_told([&grey, &grey], Path::new("test")), 16);
    }

    #[test]
    fn shrinking_takes_means_and_drops_what_fills_no_pixel() {
        let frame = Frame::from_luma(5, 3, vec![0, 1, 10, 20, 99, 2, 3, 30, 41, 99, 99, 99, 99, 99, 99]);
        let small = "2".parse::<Shrink>().unwrap().apply(frame.clone());
        assert_eq!((small.width, small.height, &small.luma[..]), (2, 1, &[2, 25][..]));
        assert_eq!(Shrink::NONE.apply(frame.clone()), frame);
        for text in ["0", "9", "-1", "2.5", "x", ""] {
            assert!(text.parse::<Shrink>().is_err(), "{text}");
        }
    }
}
