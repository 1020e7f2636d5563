//! The messages `sensor_msgs/Image` and `sensor_msgs/CompressedImage`, as ROS 2 (CDR) and ROS 1 write them.

use anyhow::{Context, Result, bail, ensure};
use image::{DynamicImage, ImageBuffer};

use crate::input::image_file;

/// Bytes before the content of a CDR message; alignment counts from after them.
const CDR_HEAD: usize = 4;

/// How a message with an image is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ImageKind {
    /// As a PNG or JPEG file, else as pixels.
    is_compressed: bool,
    /// By CDR, else as ROS 1.
    is_cdr: bool,
}

impl ImageKind {
    /// That of a type's messages, if they are images.
    pub(super) fn of(schema: &str, encoding: &str) -> Option<Self> {
        let is_compressed = match schema {
            "sensor_msgs/msg/Image" | "sensor_msgs/Image" => false,
            "sensor_msgs/msg/CompressedImage" | "sensor_msgs/CompressedImage" => true,
            _ => return None,
        };
        match encoding {
            "cdr" => Some(Self { is_compressed, is_cdr: true }),
            "ros1" => Some(Self { is_compressed, is_cdr: false }),
            _ => None,
        }
    }

    /// Nanoseconds in the message's header.
    pub(super) fn stamp(self, message: &[u8]) -> Result<i128> {
        self.fields(message)?.header()
    }

    /// The image of a message.
    pub(super) fn decode(self, message: &[u8]) -> Result<DynamicImage> {
        let mut fields = self.fields(message)?;
        fields.header()?;
        if self.is_compressed {
            fields.text()?;
            return image_file::of_bytes(fields.bytes()?);
        }
        let (height, width) = (fields.number()?, fields.number()?);
        let encoding = fields.text()?;
        let is_big_endian = fields.take(1)? != [0];
        let step = fields.number()? as usize;
        let pixels = Pixels { width, height, step, is_big_endian, data: fields.bytes()? };
        pixels.image(encoding)
    }

    fn fields(self, message: &[u8]) -> Result<Fields<'_>> {
        if !self.is_cdr {
            return Ok(Fields { content: message, at: 0, is_cdr: false, is_big_endian: false });
        }
        ensure!(message.len() > CDR_HEAD, "the message is cut off");
        ensure!(message[0] == 0 && message[1] < 2, "the message is no plain CDR");
        Ok(Fields { content: &message[CDR_HEAD..], at: 0, is_cdr: true, is_big_endian: message[1] == 0 })
    }
}

/// The fields of a message, one after the other.
struct Fields<'a> {
    content: &'a [u8],
    at: usize,
    is_cdr: bool,
    is_big_endian: bool,
}

impl<'a> Fields<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.content.len());
        let end = end.context("the message is cut off")?;
        let taken = &self.content[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn number(&mut self) -> Result<u32> {
        if self.is_cdr {
            self.at = self.at.next_multiple_of(4);
        }
        let bytes = self.take(4)?.try_into()?;
        Ok(if self.is_big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    fn bytes(&mut self) -> Result<&'a [u8]> {
        let count = self.number()?;
        self.take(count as usize)
    }

    fn text(&mut self) -> Result<&'a str> {
        let text = std::str::from_utf8(self.bytes()?).context("the message is damaged")?;
        Ok(text.trim_end_matches('\0'))
    }

    /// The header: its time in nanoseconds.
    fn header(&mut self) -> Result<i128> {
        if !self.is_cdr {
            self.number()?;
        }
        let (seconds, nanoseconds) = (self.number()?, self.number()?);
        self.text()?;
        Ok(i128::from(seconds) * 1_000_000_000 + i128::from(nanoseconds))
    }
}

/// Pixels as a message has them.
struct Pixels<'a> {
    width: u32,
    height: u32,
    /// Bytes from row to row.
    step: usize,
    is_big_endian: bool,
    data: &'a [u8],
}

impl Pixels<'_> {
    fn image(&self, encoding: &str) -> Result<DynamicImage> {
        let (width, height) = (self.width, self.height);
        let built = match encoding {
            "mono8" | "8UC1" => ImageBuffer::from_raw(width, height, self.rows(1)?).map(DynamicImage::ImageLuma8),
            "mono16" | "16UC1" => {
                let sample = if self.is_big_endian {
                    |s: &[u8; 2]| u16::from_be_bytes(*s)
                } else {
                    |s: &[u8; 2]| u16::from_le_bytes(*s)
                };
                let samples = self.rows(2)?.as_chunks().0.iter().map(sample).collect();
                ImageBuffer::from_raw(width, height, samples).map(DynamicImage::ImageLuma16)
            }
            "rgb8" => self.colour(3, [0, 1, 2])?,
            "bgr8" | "8UC3" => self.colour(3, [2, 1, 0])?,
            "rgba8" => self.colour(4, [0, 1, 2])?,
            "bgra8" | "8UC4" => self.colour(4, [2, 1, 0])?,
            bayer if bayer.starts_with("bayer") => {
                bail!("images of encoding {bayer} are raw mosaics, record those that image_proc makes of them")
            }
            other => bail!("images of encoding {other:?} are not read; mono8, mono16, rgb8, bgr8, rgba8 and bgra8 are"),
        };
        built.context("the image's size and its content differ")
    }

    /// The pixels without what pads the rows.
    fn rows(&self, pixel_bytes: usize) -> Result<Vec<u8>> {
        let row = self.width as usize * pixel_bytes;
        ensure!(row > 0 && self.height > 0, "the image has no pixels, where at least one row is needed");
        ensure!(self.step >= row, "rows of {} bytes are too short for {} px", self.step, self.width);
        let needed = self.step.checked_mul(self.height as usize - 1).and_then(|bytes| bytes.checked_add(row));
        ensure!(
            needed.is_some_and(|needed| needed <= self.data.len()),
            "the image claims to be {}x{} px, but has {} bytes",
            self.width,
            self.height,
            self.data.len()
        );
        Ok(self.data.chunks(self.step).take(self.height as usize).flat_map(|chunk| &chunk[..row]).copied().collect())
    }

    fn colour(&self, pixel_bytes: usize, order: [usize; 3]) -> Result<Option<DynamicImage>> {
        let rows = self.rows(pixel_bytes)?;
        let rgb = rows.chunks_exact(pixel_bytes).flat_map(|pixel| order.map(|channel| pixel[channel])).collect();
        Ok(ImageBuffer::from_raw(self.width, self.height, rgb).map(DynamicImage::ImageRgb8))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(data: &[u8], step: usize, is_big_endian: bool) -> Pixels<'_> {
        Pixels { width: 2, height: 2, step, is_big_endian, data }
    }

    #[test]
    fn pixels_are_read_without_their_padding_in_the_order_told() {
        let grey = pixels(&[1, 2, 99, 3, 4], 3, false).image("mono8").unwrap();
        assert_eq!(grey.into_luma8().into_raw(), [1, 2, 3, 4]);
        for (is_big_endian, wanted) in [(true, 0x0102), (false, 0x0201)] {
            let wide = pixels(&[1, 2, 0, 0, 0, 0, 0, 0], 4, is_big_endian).image("16UC1").unwrap();
            assert_eq!(wide.into_luma16().into_raw()[0], wanted);
        }
        let data: Vec<u8> = (0..16).collect();
        let first = |encoding: &str, step| pixels(&data, step, false).image(encoding).unwrap().into_rgb8()[(1, 0)].0;
        assert_eq!([first("rgb8", 6), first("bgr8", 6)], [[3, 4, 5], [5, 4, 3]]);
        assert_eq!([first("rgba8", 8), first("bgra8", 8)], [[4, 5, 6], [6, 5, 4]]);
    }

    #[test]
    fn what_is_too_short_or_not_known_is_refused() {
        let cases = [("mono8", 2, 3), ("mono8", 1, 8), ("mono8", usize::MAX, 8), ("bgr8", 6, 11)];
        for (encoding, step, bytes) in cases {
            assert!(pixels(&vec![0; bytes], step, false).image(encoding).is_err(), "{encoding}, {step}, {bytes}");
        }
        for encoding in ["bayer_rggb8", "yuv422", ""] {
            assert!(pixels(&[0; 64], 32, false).image(encoding).is_err(), "{encoding}");
        }
        let kind = ImageKind::of("sensor_msgs/msg/Image", "cdr").unwrap();
        let mut message = vec![0, 1, 0, 0];
        for _ in 0..40 {
            assert!(kind.decode(&message).is_err());
            message.push(255);
        }
        assert_eq!(ImageKind::of("sensor_msgs/msg/Image", "json"), None);
        assert_eq!(ImageKind::of("sensor_msgs/msg/Imu", "cdr"), None);
    }
}
