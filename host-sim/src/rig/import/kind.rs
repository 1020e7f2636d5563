//! What a file is: which tool wrote it, and for what.

use serde_json::Value;

use super::document::Document;
use super::formats::opencv;

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Both rectified cameras.
    Middlebury,
    /// Projections of rectified cameras.
    Kitti,
    /// A chain of cameras.
    Kalibr,
    /// One camera of a pair.
    Ros,
    /// One camera on a body.
    Euroc,
    /// Matrices of a pair, or some of them.
    OpenCv,
    /// One camera alone.
    OpenCvCamera,
    /// Names of pictures.
    ImageList,
}

impl Kind {
    /// What `document` is, if that is known.
    #[must_use]
    pub fn of(document: &Document) -> Option<Self> {
        let tree = match document {
            Document::Lines(lines) if lines.contains_key("cam0") => return Some(Self::Middlebury),
            Document::Lines(_) => return Some(Self::Kitti),
            Document::Tree(tree) => tree,
        };
        let has = |name: &str| tree.contains_key(name);
        if has("cam0") || has("T_cn_cnm1") {
            Some(Self::Kalibr)
        } else if has("projection_matrix") || has("camera_matrix") && has("distortion_model") {
            Some(Self::Ros)
        } else if has("T_BS") || has("sensor_type") {
            Some(Self::Euroc)
        } else if opencv::is_stereo(document) {
            Some(Self::OpenCv)
        } else if has("camera_matrix") || has("Camera_Matrix") || has("cameraMatrix") {
            Some(Self::OpenCvCamera)
        } else {
            tree.iter().any(|(key, value)| names_images(key, value)).then_some(Self::ImageList)
        }
    }

    /// Whether cameras of a rig are told.
    #[must_use]
    pub const fn is_of_rig(self) -> bool {
        !matches!(self, Self::OpenCvCamera | Self::ImageList)
    }

    /// For the user.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Middlebury => "a Middlebury calib.txt",
            Self::Kitti => "a KITTI calibration",
            Self::Kalibr => "a Kalibr camchain",
            Self::Ros => "a ROS camera_info file",
            Self::Euroc => "an EuRoC sensor.yaml",
            Self::OpenCv => "an OpenCV stereo calibration",
            Self::OpenCvCamera => "an OpenCV calibration of one camera",
            Self::ImageList => "an OpenCV image list",
        }
    }
}

/// Whether a value is OpenCV's list of the images to calibrate with.
fn names_images(key: &str, value: &Value) -> bool {
    let is_image = |word: &str| {
        let word = word.trim_matches(['"', '\'']).to_lowercase();
        [".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm"].iter().any(|ending| word.ends_with(ending))
    };
    match value {
        Value::String(text) => ["imagelist", "images"].contains(&key) && text.split_whitespace().any(is_image),
        Value::Array(items) => items.iter().any(|item| item.as_str().is_some_and(is_image)),
        _ => false,
    }
}
