//! Finished disparity maps, whoever made them: `<scene>.pfm` (px, from the bottom row, unknown is not finite) or
//! `<scene>.png` (16 bits, disparity x 256, 0 = unknown), and `<scene>_confidence.png` (8 bits) where there is one.
//!
//! Disparities are rounded to 1/16 px, as all methods here and OpenCV's answer. Without a confidence every answer is
//! sure.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail, ensure};
use haarline::Disparity;
use image::DynamicImage;

use crate::DisparityMap;
use crate::input::image_file;
use crate::score::scene::Scene;

/// Greatest magnitude of a disparity in a file, px.
const MOST_PX: f32 = 2000.0;

/// Reads the map of `scene` in `folder`.
///
/// # Errors
/// If there is none, or it is damaged or of another size than the scene's views.
pub fn read(folder: &Path, scene: &Scene) -> Result<DisparityMap> {
    let file = |suffix: &str| folder.join(format!("{}{suffix}", scene.name));
    let (pfm, png) = (file(".pfm"), file(".png"));
    let (path, map) = match (pfm.is_file(), png.is_file()) {
        (true, false) => (&pfm, read_pfm(&pfm)),
        (false, true) => (&png, read_kitti_png(&png)),
        (true, true) => bail!("{} and {}: one map of a scene is expected, not two", pfm.display(), png.display()),
        (false, false) => bail!("{}: no map of the scene, neither as .pfm nor as .png", pfm.display()),
    };
    let name = path.display();
    let (size, disparity) = map.with_context(|| name.to_string())?;
    let [width, height] = [scene.pair.width(), scene.pair.height()];
    ensure!(size == [width, height], "{name}: is {}x{} px, but the views are {width}x{height} px", size[0], size[1]);
    let mut confidence: Vec<u8> = disparity.iter().map(|d| if d.is_known() { u8::MAX } else { 0 }).collect();
    let path = file("_confidence.png");
    if path.is_file() {
        let name = path.display();
        let DynamicImage::ImageLuma8(told) = image_file::read(&path)? else {
            bail!("{name}: must be a grey image of 8 bits: 255 = most confident");
        };
        let found = [told.width() as usize, told.height() as usize];
        ensure!(found == size, "{name}: is {}x{} px, but the map is {width}x{height} px", found[0], found[1]);
        confidence.iter_mut().zip(told.into_raw()).for_each(|(confidence, told)| *confidence = told.min(*confidence));
    }
    Ok(DisparityMap { width, height, disparity, confidence })
}

/// A map's size and its disparities, from the top row.
type Raw = ([usize; 2], Vec<Disparity>);

fn read_pfm(path: &Path) -> Result<Raw> {
    decode_pfm(&fs::read(path).map_err(|error| anyhow!("cannot be read: {error}"))?)
}

/// Three words of a header, each ending in one white space, then the samples.
fn decode_pfm(bytes: &[u8]) -> Result<Raw> {
    let mut words = bytes.splitn(5, u8::is_ascii_whitespace);
    let mut word = || words.next().and_then(|word| std::str::from_utf8(word).ok());
    let kind = word().unwrap_or_default();
    ensure!(kind != "PF", "has three channels, where one is expected");
    ensure!(kind == "Pf", "is no PFM file, which begins with Pf");
    let mut number = || word().and_then(|word| word.parse::<f64>().ok()).context("the header is damaged");
    let (width, height, scale) = (number()?, number()?, number()?);
    let is_size = |size: f64| size >= 1.0 && size.fract() == 0.0 && size < 1e5;
    ensure!(is_size(width) && is_size(height) && scale != 0.0, "the header is damaged");
    let (width, height) = (width as usize, height as usize);
    let (samples, rest) = words.next().unwrap_or(&[]).as_chunks::<4>();
    ensure!(
        samples.len() == width * height && rest.is_empty(),
        "has {} bytes of samples, where {width}x{height} px need {}",
        4 * samples.len() + rest.len(),
        4 * width * height
    );
    let sample = |bytes| if scale < 0.0 { f32::from_le_bytes(bytes) } else { f32::from_be_bytes(bytes) };
    let mut disparity = Vec::with_capacity(width * height);
    for row in samples.chunks(width).rev() {
        for &bytes in row {
            disparity.push(to_disparity(sample(bytes))?);
        }
    }
    Ok(([width, height], disparity))
}

fn to_disparity(px: f32) -> Result<Disparity> {
    if !px.is_finite() {
        return Ok(Disparity::UNKNOWN);
    }
    ensure!(px.abs() <= MOST_PX, "holds a disparity of {px} px; unknown is told by infinity, not by a great number");
    Ok(Disparity::from_bits((px * f32::from(1_u8 << Disparity::FRAC_BITS)).round() as i16))
}

fn read_kitti_png(path: &Path) -> Result<Raw> {
    let DynamicImage::ImageLuma16(image) = image_file::read(path)? else {
        bail!("must be a grey image of 16 bits: disparity x 256, 0 = unknown");
    };
    let size = [image.width() as usize, image.height() as usize];
    let disparity = |q8: u16| match q8 {
        0 => Disparity::UNKNOWN,
        q8 => Disparity::from_bits(((u32::from(q8) + 8) >> 4) as i16),
    };
    Ok((size, image.into_raw().into_iter().map(disparity).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::pfm;

    #[test]
    fn what_is_written_is_read_again() {
        let bits = [16, -8, i16::MIN, 1000, 0, 7];
        let disparity = bits.map(Disparity::from_bits).to_vec();
        let map = DisparityMap { width: 3, height: 2, disparity: disparity.clone(), confidence: vec![9; 6] };
        assert_eq!(decode_pfm(&pfm::encode(&map)).unwrap(), ([3, 2], disparity));
    }

    #[test]
    fn big_endian_samples_are_rounded_and_what_is_not_finite_is_unknown() {
        let mut bytes = b"Pf 2 2 1.0\n".to_vec();
        for px in [3.03_f32, f32::NAN, -1.0, f32::NEG_INFINITY] {
            bytes.extend(px.to_be_bytes());
        }
        let bits: Vec<i16> = decode_pfm(&bytes).unwrap().1.iter().map(|d| d.known().unwrap_or(-999)).collect();
        assert_eq!(bits, [-16, -999, 48, -999]);
    }

    #[test]
    fn damaged_files_are_refused() {
        let cases: [(&[u8], &str); 6] = [
            (b"", "no PFM"),
            (b"PF\n1 1\n-1\n0123456789ab", "three channels"),
            (b"Pf\n1 x\n-1\n0123", "header"),
            (b"Pf\n1 0\n-1\n", "header"),
            (b"Pf\n1 1\n-1\n012", "3 bytes"),
            (b"Pf\n1 1\n-1\n\xff\xff\x7f\x7f", "infinity"),
        ];
        for (bytes, told) in cases {
            let error = decode_pfm(bytes).unwrap_err().to_string();
            assert!(error.contains(told), "{error}");
        }
    }
}
