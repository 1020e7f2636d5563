//! A rendering in the layout of a benchmark scene, as `haarline eval` reads it.

use anyhow::Result;
use image::ExtendedColorType;

use super::Scene;
use crate::StereoPair;
use crate::output::{encode_grey_png, encode_png};
use crate::score::scene::{Meta, Truth};

/// A file's name, what it shows, and its content.
pub type NamedFile = (&'static str, &'static str, Vec<u8>);

/// The five files of a scene; `truth` says what is scored.
///
/// # Errors
/// Never for views and truth of one size.
pub fn files(scene: &Scene, pair: &StereoPair, truth: &Truth, meta: &Meta) -> Result<[NamedFile; 5]> {
    let size = [scene.width, scene.height];
    let disparity: Vec<u8> = truth.disparity_q8.iter().flat_map(|sample| sample.to_ne_bytes()).collect();
    let mask: Vec<u8> = truth.seen_by_both.iter().map(|&seen| if seen { 255 } else { 0 }).collect();
    let meta = serde_json::to_string_pretty(meta)? + "\n";
    Ok([
        ("left.png", "left view", encode_grey_png(&pair.left.luma, size)?),
        ("right.png", "right view", encode_grey_png(&pair.right.luma, size)?),
        ("truth.png", "true disparity x 256", encode_png(&disparity, size, ExtendedColorType::L16)?),
        ("nonocc.png", "white where it is scored", encode_grey_png(&mask, size)?),
        ("meta.json", "search range, focal length, baseline", meta.into_bytes()),
    ])
}
