//! How recordings store the two views.

use anyhow::{Result, bail};
use clap::ValueEnum;

use crate::input::recording::{Layout, Side};

/// Where the two views are.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct LayoutArgs {
    /// How the views are stored
    #[arg(long, value_enum, default_value_t = LayoutKind::Auto)]
    pub(in crate::command) layout: LayoutKind,
    /// The left views below the recording's folder, as 'cam_a/*.png', or their topic in an MCAP file; with --right
    #[arg(id = "left_views", long = "left", value_name = "GLOB", requires = "right_views", conflicts_with = "layout")]
    left: Option<String>,
    /// The right views
    #[arg(id = "right_views", long = "right", value_name = "GLOB", requires = "left_views", conflicts_with = "layout")]
    right: Option<String>,
}

impl LayoutArgs {
    /// The layout; `first` is the camera of the left or upper half, if something tells it.
    pub(in crate::command) fn get(&self, first: Option<Side>) -> Result<Layout> {
        match (&self.left, &self.right) {
            (Some(left), Some(right)) => Ok(Layout::Patterns { left: left.clone(), right: right.clone() }),
            _ => layout(self.layout, first),
        }
    }
}

/// How the two views are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::command) enum LayoutKind {
    /// Each in a file of its own: folders or names, whichever is found
    Auto,
    /// In two folders: left and right, image_0 and image_1, cam0/data and cam1/data (mav0/...) and the like
    Folders,
    /// In one folder, the camera in each name: left_01 and right_01, l1 and r1, 01_0 and 01_1 and the like
    Names,
    /// Both in each image, side by side; which camera is in the left half must be told
    SideBySide,
    /// Both in each image, one above the other; which camera is in the upper half must be told
    TopBottom,
}

impl LayoutKind {
    /// Whether each image has both views.
    pub(in crate::command) const fn has_both(self) -> bool {
        matches!(self, Self::SideBySide | Self::TopBottom)
    }
}

/// The layout; `first` is the camera of the left or upper half, if something tells it.
fn layout(kind: LayoutKind, first: Option<Side>) -> Result<Layout> {
    match (kind, first) {
        (LayoutKind::Auto, _) => Ok(Layout::Separate),
        (LayoutKind::Folders, _) => Ok(Layout::Folders),
        (LayoutKind::Names, _) => Ok(Layout::Names),
        (LayoutKind::SideBySide, Some(first)) => Ok(Layout::SideBySide { first }),
        (LayoutKind::TopBottom, Some(first)) => Ok(Layout::TopBottom { first }),
        (LayoutKind::SideBySide, None) => {
            bail!("--layout side-by-side needs --first left or --first right, the camera of the left half")
        }
        (LayoutKind::TopBottom, None) => {
            bail!("--layout top-bottom needs --first left or --first right, the camera of the upper half")
        }
    }
}
