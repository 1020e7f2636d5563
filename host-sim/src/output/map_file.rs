//! The files that tell a map, one kind beside the other.

use std::path::Path;

use anyhow::{Result, bail};
use clap::ValueEnum;
use haarline::obstacle::MAX_SECTORS;

use super::colour_range::ColourRange;
use super::obstacle_strip::ObstacleStrip;
use super::{depth_png, encode_grey_png, kitti_png, npy, pfm, picture, ply};
use crate::{DisparityMap, Frame, Geometry};

/// The kinds of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MapKind {
    /// NAME.pfm: disparity in px, floating point, unknown = +inf (Middlebury's format)
    Disparity,
    /// NAME.png: disparity x 256 in 16 bits, unknown = 0 (KITTI's format)
    Kitti,
    /// NAME.npy: disparity in px, float32, unknown = NaN (numpy's format)
    Npy,
    /// NAME_depth.png: depth in mm in 16 bits, unknown = 0; needs focal length and baseline
    Depth,
    /// NAME.ply: coloured points in m; needs focal length and baseline
    Ply,
    /// NAME_confidence.png: 0 to 255, 0 = unknown
    Confidence,
    /// NAME_picture.png: colours with a legend
    Picture,
    /// NAME_grey.png: nearer = brighter, unknown = 0
    Grey,
}

/// A map and what its files need besides.
#[derive(Debug, Clone, Copy)]
pub struct MapView<'a> {
    /// The map.
    pub map: &'a DisparityMap,
    /// The left view, whose colours the points have.
    pub left: &'a Frame,
    /// Focal length and baseline.
    pub geometry: Option<&'a Geometry>,
    /// What is farther is in no file that tells depth, m.
    pub max_depth_m: Option<f64>,
    /// What the colours and the greys of the pictures span.
    pub range: &'a ColourRange,
    /// The obstacles in it, for the picture.
    pub obstacles: Option<&'a ObstacleStrip<'a, MAX_SECTORS>>,
}

impl MapKind {
    /// The kind of disparity file that the suffix of `path` asks for, in upper or lower case.
    ///
    /// # Errors
    /// If it is none of them.
    pub fn of(path: &Path) -> Result<Self> {
        match super::suffix(path).as_str() {
            "pfm" => Ok(Self::Disparity),
            "png" => Ok(Self::Kitti),
            "npy" => Ok(Self::Npy),
            "ply" => Ok(Self::Ply),
            _ => bail!("-o {}: unknown kind of file; the name must end in .pfm, .png, .npy or .ply", path.display()),
        }
    }

    /// What follows the frame's name in the file's name.
    #[must_use]
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Disparity => ".pfm",
            Self::Kitti => ".png",
            Self::Npy => ".npy",
            Self::Depth => "_depth.png",
            Self::Ply => ".ply",
            Self::Confidence => "_confidence.png",
            Self::Picture => "_picture.png",
            Self::Grey => "_grey.png",
        }
    }

    /// Whether it tells metres.
    #[must_use]
    pub const fn needs_geometry(self) -> bool {
        matches!(self, Self::Depth | Self::Ply)
    }

    /// Whether its content depends on the range of colours.
    #[must_use]
    pub const fn has_range(self) -> bool {
        matches!(self, Self::Picture | Self::Grey)
    }

    /// The file's content.
    ///
    /// # Errors
    /// If the map cannot be told in that kind of file.
    pub fn encode(self, view: &MapView<'_>) -> Result<Vec<u8>> {
        let MapView { map, left, geometry, max_depth_m, range, obstacles } = *view;
        match (self, geometry) {
            (Self::Disparity, _) => Ok(pfm::encode(map)),
            (Self::Kitti, _) => kitti_png::encode(map),
            (Self::Npy, _) => Ok(npy::encode(map)),
            (Self::Depth, Some(geometry)) => depth_png::encode(map, geometry, max_depth_m),
            (Self::Ply, Some(geometry)) => Ok(ply::encode(map, left, geometry, max_depth_m)),
            (Self::Depth | Self::Ply, None) => bail!("metres need --focal-px and --baseline-mm, or --rig"),
            (Self::Confidence, _) => encode_grey_png(&map.confidence, [map.width, map.height]),
            (Self::Picture, _) => picture::encode(map, range, geometry, obstacles),
            (Self::Grey, _) => picture::encode_grey(map, range),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_suffix_tells_the_kind() {
        assert_eq!(MapKind::of(Path::new("a/b.pfm")).unwrap(), MapKind::Disparity);
        assert_eq!(MapKind::of(Path::new("b.PNG")).unwrap(), MapKind::Kitti);
        assert_eq!(MapKind::of(Path::new("b.npy")).unwrap(), MapKind::Npy);
        assert_eq!(MapKind::of(Path::new("b.c.ply")).unwrap(), MapKind::Ply);
        for name in ["b", "b.jpg", ".png", "png", ""] {
            assert!(MapKind::of(Path::new(name)).is_err(), "{name}");
        }
    }
}
