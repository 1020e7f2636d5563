//! Image files of any supported kind, with every way of being broken told in one line.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use anyhow::{Result, anyhow, ensure};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};

/// No image decoded here may take more than this; a header can claim anything.
const MAX_DECODED_BYTES: u64 = 1 << 29;

/// Reads and decodes an image file; its content decides which kind it is.
///
/// # Errors
/// Names the file and what is wrong with it.
pub fn read(path: &Path) -> Result<DynamicImage> {
    let name = path.display();
    ensure!(!path.is_dir(), "{name}: is a folder, where an image file is expected");
    let bytes = fs::read(path).map_err(|error| anyhow!("{name}: cannot be read: {error}"))?;
    ensure!(!bytes.is_empty(), "{name}: the file is empty, where an image is expected");
    decode(&bytes).map_err(|error| anyhow!("{name}: {error:#}"))
}

fn decode(bytes: &[u8]) -> Result<DynamicImage> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    match reader.format() {
        None => return Err(anyhow!("is no PNG, PGM, PPM, BMP, JPEG or TIFF image")),
        Some(ImageFormat::Png) => {
            ensure!(!is_empty_png(bytes), "the image has no pixels, where at least one row is needed")
        }
        Some(ImageFormat::Jpeg) => {
            ensure!(has_jpeg_end(bytes), "the image is truncated: the end of the file is missing")
        }
        Some(_) => {}
    }
    let decoder = reader.into_decoder().map_err(|error| damaged(&error))?;
    let (width, height) = decoder.dimensions();
    ensure!(width > 0 && height > 0, "the image is {width}x{height} px, where at least one row is needed");
    let is_too_large = decoder.total_bytes() > MAX_DECODED_BYTES;
    ensure!(!is_too_large, "the image claims to be {width}x{height} px, more than this tool reads");
    DynamicImage::from_decoder(decoder).map_err(|error| damaged(&error))
}

fn damaged(error: &image::ImageError) -> anyhow::Error {
    anyhow!("the image is damaged, truncated or of an unsupported kind, save it anew: {error}")
}

/// Whether the header of a PNG, which has a fixed place, tells a width or height of 0. The decoder
/// refuses that without saying so.
fn is_empty_png(bytes: &[u8]) -> bool {
    let size = |at: usize| bytes.get(at..at + 4);
    size(16) == Some(&[0; 4]) || size(20) == Some(&[0; 4])
}

/// Whether a JPEG goes on to its end marker. The decoder fills what is missing with grey.
fn has_jpeg_end(bytes: &[u8]) -> bool {
    /// Markers without a length: TEM, the restarts and the start of the image.
    fn stands_alone(marker: u8) -> bool {
        matches!(marker, 0x01 | 0xd0..=0xd8)
    }
    const END: u8 = 0xd9;
    let mut at = 0;
    // Each turn begins at a segment, or within image data, where 0xff 0x00 is no marker.
    while let Some(&[lead, marker]) = bytes.get(at..at + 2) {
        if lead != 0xff || marker == 0x00 || marker == 0xff {
            at += 1;
        } else if marker == END {
            return true;
        } else if stands_alone(marker) {
            at += 2;
        } else {
            let Some(&[high, low]) = bytes.get(at + 2..at + 4) else { return false };
            at += 2 + usize::from(u16::from_be_bytes([high, low]));
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::GrayImage;

    fn encoded(format: ImageFormat) -> Vec<u8> {
        let image = GrayImage::from_fn(40, 30, |x, y| image::Luma([(x * 7 + y * 13) as u8]));
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn every_supported_kind_is_read_and_none_when_cut_short() {
        let kinds = [ImageFormat::Png, ImageFormat::Pnm, ImageFormat::Bmp, ImageFormat::Jpeg, ImageFormat::Tiff];
        for format in kinds {
            let bytes = encoded(format);
            let image = decode(&bytes).unwrap();
            assert_eq!((image.width(), image.height()), (40, 30), "{format:?}");
            for length in [1, 10, bytes.len() / 2, bytes.len() * 9 / 10] {
                assert!(decode(&bytes[..length]).is_err(), "{format:?} cut to {length} bytes");
            }
        }
    }

    #[test]
    fn text_and_impossible_sizes_are_refused() {
        for text in ["hello\n", "P5 0 4 255\n", "P5 64 0 255\n", "P5 64 4000000000 255\n", "P5 64 4 255\nshort"] {
            assert!(decode(text.as_bytes()).is_err(), "{text:?}");
        }
    }
}
