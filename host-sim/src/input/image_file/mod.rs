//! Image files of any supported kind, with every way of being broken told in one line.

use std::cell::Cell;
use std::fs::File;
use std::io::{Cursor, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use anyhow::{Result, anyhow, ensure};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::caveat::{self, Caveat};

mod jpeg;
mod orientation;

/// No image file may be larger: a device has no end.
const MAX_FILE_BYTES: u64 = 1 << 28;
/// Bytes that tell which kind of file it is.
const HEAD_BYTES: usize = 16;
/// No image decoded here may take more than this; a header can claim anything.
const MAX_DECODED_BYTES: u64 = 1 << 29;

thread_local! {
    static DECODING: Cell<bool> = const { Cell::new(false) };
}

/// Whether this thread is within a decoder, where a panic is caught and means a damaged image.
#[must_use]
pub fn is_decoding() -> bool {
    DECODING.get()
}

/// Reads and decodes an image file, upright as its EXIF orientation tells; its content decides which kind
/// it is.
///
/// # Errors
/// Names the file and what is wrong with it.
pub fn read(path: &Path) -> Result<DynamicImage> {
    let name = path.display();
    ensure!(!path.is_dir(), "{name}: is a folder, where an image file is expected");
    let bytes = read_bytes(path).map_err(|error| anyhow!("{name}: {error:#}"))?;
    let (image, caveat) = decode(&bytes).map_err(|error| anyhow!("{name}: {error:#}"))?;
    if let Some(caveat) = caveat {
        caveat::tell(caveat, &name);
    }
    Ok(image)
}

/// Decodes the content of an image file.
///
/// # Errors
/// Tells what is wrong with it.
#[cfg(feature = "mcap")]
pub fn of_bytes(bytes: &[u8]) -> Result<DynamicImage> {
    ensure!(is_image(bytes), "is no PNG, PGM, PPM, BMP, JPEG or TIFF image");
    let (image, caveat) = decode(bytes)?;
    if let Some(caveat) = caveat {
        caveat::tell(caveat, &"the recording");
    }
    Ok(image)
}

/// The content of a file that begins as an image does.
fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut fetch = |limit: u64| {
        let mut file = File::open(path)?;
        Read::by_ref(&mut file).take(HEAD_BYTES as u64).read_to_end(&mut bytes)?;
        if is_image(&bytes) {
            file.take(limit).read_to_end(&mut bytes)?;
        }
        std::io::Result::Ok(())
    };
    fetch(MAX_FILE_BYTES).map_err(|error| anyhow!("cannot be read: {error}"))?;
    ensure!(!bytes.is_empty(), "the file is empty, where an image is expected");
    ensure!(is_image(&bytes), "is no PNG, PGM, PPM, BMP, JPEG or TIFF image");
    ensure!((bytes.len() as u64) < MAX_FILE_BYTES, "has more than {} MB, too much for an image", MAX_FILE_BYTES >> 20);
    Ok(bytes)
}

fn is_image(head: &[u8]) -> bool {
    image::guess_format(head).is_ok_and(|format| format.reading_enabled())
}

/// The image, and what is to be said about it. What panics in a decoder is damaged, too.
fn decode(bytes: &[u8]) -> Result<(DynamicImage, Option<Caveat>)> {
    guarded(|| decode_unguarded(bytes)).unwrap_or_else(|error| Err(damaged(error)))
}

/// Runs a decoder, whose panic means that its input is damaged.
///
/// # Errors
/// If it panics.
pub fn guarded<T>(decode: impl FnOnce() -> T) -> Result<T> {
    DECODING.set(true);
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    DECODING.set(false);
    decoded.map_err(|_| anyhow!("the decoder gave up"))
}

fn decode_unguarded(bytes: &[u8]) -> Result<(DynamicImage, Option<Caveat>)> {
    let format = image::guess_format(bytes).ok();
    let mut caveat = None;
    match format {
        Some(ImageFormat::Png) => {
            ensure!(!is_empty_png(bytes), "the image has no pixels, where at least one row is needed")
        }
        Some(ImageFormat::Jpeg) if !jpeg::has_end(bytes) => {
            ensure!(jpeg::is_complete(bytes, decode_pixels), "the image is truncated: the end of the file is missing");
            caveat = Some(Caveat::NoEnd);
        }
        _ => {}
    }
    let mut image = decode_pixels(bytes)?;
    orientation::apply(&mut image, bytes);
    Ok((image, caveat))
}

fn decode_pixels(bytes: &[u8]) -> Result<DynamicImage> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    let mut decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    ensure!(width > 0 && height > 0, "the image is {width}x{height} px, where at least one row is needed");
    let is_too_large = decoder.total_bytes() > MAX_DECODED_BYTES;
    ensure!(!is_too_large, "the image claims to be {width}x{height} px, more than this tool reads");
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    decoder.set_limits(limits).map_err(damaged)?;
    DynamicImage::from_decoder(decoder).map_err(damaged)
}

fn damaged(why: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("the image is damaged, truncated or of an unsupported kind, save it anew: {why}")
}

/// Whether the header of a PNG, which has a fixed place, tells a width or height of 0. The decoder
/// refuses that without saying so.
fn is_empty_png(bytes: &[u8]) -> bool {
    let size = |at: usize| bytes.get(at..at + 4);
    size(16) == Some(&[0; 4]) || size(20) == Some(&[0; 4])
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::GrayImage;

    const KINDS: [ImageFormat; 5] =
        [ImageFormat::Png, ImageFormat::Pnm, ImageFormat::Bmp, ImageFormat::Jpeg, ImageFormat::Tiff];

    fn encoded(format: ImageFormat) -> Vec<u8> {
        let image = GrayImage::from_fn(40, 30, |x, y| image::Luma([(x * 7 + y * 13) as u8]));
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn every_supported_kind_is_read_and_none_when_cut_short() {
        for format in KINDS {
            let bytes = encoded(format);
            let (image, caveat) = decode(&bytes).unwrap();
            assert_eq!((image.width(), image.height(), caveat), (40, 30, None), "{format:?}");
            for length in [1, 10, bytes.len() / 2, bytes.len() * 9 / 10] {
                assert!(decode(&bytes[..length]).is_err(), "{format:?} cut to {length} bytes");
            }
        }
    }

    #[test]
    fn a_jpeg_that_lacks_nothing_but_its_end_is_read_and_told() {
        let bytes = encoded(ImageFormat::Jpeg);
        let whole = decode(&bytes).unwrap().0;
        assert_eq!(decode(&bytes[..bytes.len() - 2]).unwrap(), (whole.clone(), Some(Caveat::NoEnd)));
        assert_eq!(decode(&bytes[..bytes.len() - 1]).unwrap(), (whole, Some(Caveat::NoEnd)));
        for missing in 3..60 {
            assert!(decode(&bytes[..bytes.len() - missing]).is_err(), "{missing} bytes are missing");
        }
    }

    #[test]
    fn text_and_impossible_sizes_are_refused() {
        for text in ["hello\n", "P5 0 4 255\n", "P5 64 0 255\n", "P5 64 4000000000 255\n", "P5 64 4 255\nshort"] {
            assert!(decode(text.as_bytes()).is_err(), "{text:?}");
        }
    }

    #[test]
    fn no_corruption_of_any_kind_ends_the_reader() {
        let mut state = 7_u64;
        let mut random = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % below
        };
        for format in KINDS {
            let whole = encoded(format);
            for _ in 0..200 {
                let mut bytes = whole.clone();
                // Half of them in the header, where it matters most.
                let reach = if random(2) == 0 { bytes.len().min(700) } else { bytes.len() };
                for _ in 0..=random(3) {
                    bytes[random(reach)] = random(256) as u8;
                }
                if let Err(error) = decode(&bytes) {
                    assert!(!error.to_string().is_empty());
                }
                assert!(!is_decoding());
            }
        }
    }
}
