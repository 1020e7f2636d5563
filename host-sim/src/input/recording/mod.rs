//! Recordings: what a pair of cameras saw, frame by frame, in a folder.
//!
//! Either each view has a file of its own, in two folders or with a name that tells the camera; or each file
//! holds both views; or all frames are in one file, a raw dump or an MCAP recording.
//! Frames are counted from 0 in natural order; files that are no images by their suffix do not count.

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, bail, ensure};
use clap::ValueEnum;

use super::caveat::{self, Caveat};
use super::frame::Shrink;
use super::image_file;
use super::raw_dump::RawFormat;
use crate::StereoPair;

mod cameras;
#[cfg(feature = "mcap")]
mod mcap;
mod names;
mod pairing;
mod range;
mod views;

pub use range::FrameRange;

/// One of the two cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Side {
    /// The left camera
    Left,
    /// The right camera
    Right,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Left => "left",
            Self::Right => "right",
        })
    }
}

/// How a recording's folder holds the two views.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Layout {
    /// In files of their own, in two folders or with names that tell the camera, whichever is found.
    Separate,
    /// In two folders: `left` and `right`, `image_0` and `image_1`, `cam0/data` and `cam1/data`, and others.
    Folders,
    /// In one folder, with names that tell the camera: `left_01` and `right_01`, and others.
    Names,
    /// In files that these two patterns match, below the folder.
    Patterns {
        /// The left camera's.
        left: String,
        /// The right camera's.
        right: String,
    },
    /// Both in each file, that of one camera in the left half.
    SideBySide {
        /// The camera in the left half.
        first: Side,
    },
    /// Both in each file, that of one camera in the upper half.
    TopBottom {
        /// The camera in the upper half.
        first: Side,
    },
}

/// One frame of a recording, not read yet.
#[derive(Debug, Clone)]
pub struct RecordedFrame {
    /// Its place in the recording, from 0.
    pub index: usize,
    /// Its name without folder and suffix; no other frame has the same.
    pub name: String,
    /// Name of the file, that of the left view if there are two.
    pub file: String,
    source: Source,
    shrink: Shrink,
}

#[derive(Debug, Clone)]
enum Source {
    /// A file of each view.
    Pair(PathBuf, PathBuf),
    /// One view, where the other is missing.
    Lone(PathBuf, Side),
    /// Both views in one file, beside or above each other; the camera of the first half.
    Both(PathBuf, Split, Side),
    /// A frame of a raw dump, by its index.
    Raw(PathBuf, RawFormat, usize),
    /// A moment of an MCAP file, by its index.
    #[cfg(feature = "mcap")]
    Mcap(std::sync::Arc<mcap::McapRecording>, usize),
}

/// How two views share an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Split {
    SideBySide,
    TopBottom,
}

/// The frames of the recording in `folder`, in natural order: by their numbers or times, else by their names.
///
/// Of separate views those of the same name, number or nearest time belong together; one that is alone is
/// a frame that cannot be read.
///
/// # Errors
/// If the folder cannot be read or has no frames, if two frames have one name, or if nothing tells
/// which views belong together.
pub fn find_frames(folder: &Path, layout: Layout) -> Result<Vec<RecordedFrame>> {
    let name = folder.display();
    ensure!(folder.exists(), "{name}: no such folder, where one with a recording is expected");
    if folder.is_file() && views::is_film(folder) {
        bail!("{name}: {}", film_advice(folder));
    }
    if folder.is_file() && views::is_mcap(folder) {
        #[cfg(feature = "mcap")]
        return mcap::find_frames(folder, &layout);
        #[cfg(not(feature = "mcap"))]
        bail!("{name}: this build reads no MCAP: cargo install --path host-sim --locked --features mcap");
    }
    ensure!(folder.is_dir(), "{name}: is a file, where a folder with a recording is expected; {}", file_advice(folder));
    let cameras = match layout {
        Layout::SideBySide { first } => return find_split(folder, Split::SideBySide, first),
        Layout::TopBottom { first } => return find_split(folder, Split::TopBottom, first),
        Layout::Separate => cameras::find(folder)?,
        Layout::Folders => cameras::in_folders(folder)?,
        Layout::Names => cameras::in_names(folder)?,
        Layout::Patterns { left, right } => {
            [views::of_pattern(folder, "--left", &left)?, views::of_pattern(folder, "--right", &right)?]
        }
    };
    let [left, right] = cameras;
    ensure!(!left.is_empty() || !right.is_empty(), "{name}: no image in its folders of the left and right views");
    let moments = pairing::pair(left, right).map_err(|error| anyhow!("{name}: {error}"))?;
    let frames = moments.into_iter().enumerate().filter_map(|(index, moment)| {
        let (name, source) = match (moment.left, moment.right) {
            (Some(left), Some(right)) => (left.name, Source::Pair(left.path, right.path)),
            (Some(left), None) => (left.name, Source::Lone(left.path, Side::Left)),
            (None, Some(right)) => (right.name, Source::Lone(right.path, Side::Right)),
            (None, None) => return None,
        };
        Some(RecordedFrame::new(index, name, source))
    });
    Ok(frames.collect())
}

fn find_split(folder: &Path, split: Split, first: Side) -> Result<Vec<RecordedFrame>> {
    let images = views::images(folder)?;
    ensure!(!images.is_empty(), "{}: no image in it, where frames with both views are expected", folder.display());
    let frame = |(index, path): (usize, PathBuf)| {
        RecordedFrame::new(index, views::stem(&path), Source::Both(path, split, first))
    };
    Ok(images.into_iter().enumerate().map(frame).collect())
}

/// How a file that is no folder of images is read.
fn file_advice(file: &Path) -> &'static str {
    match views::suffix(file).as_str() {
        "db3" => "ros2 bag convert makes an MCAP file of it, which is read",
        "bag" => "mcap convert makes an MCAP file of it, which is read",
        image if views::is_image_suffix(image) => "a single pair is for haarline depth LEFT RIGHT",
        _ => "a raw dump needs --raw WIDTHxHEIGHT",
    }
}

/// How a film is read.
fn film_advice(film: &Path) -> String {
    format!(
        "is a film; ffmpeg reads it: ffmpeg -i {} -f rawvideo -pix_fmt gray - | haarline play - --raw 640x480 --wiring \
         side-by-side -o out (--raw is the size of one view, here of a film of 1280x480)",
        film.display()
    )
}

/// The frames of the raw dump in `path`, named by their index. Where the file is no whole number of
/// frames, the last one is a frame that cannot be read.
///
/// # Errors
/// If the file cannot be read or has not even one frame.
pub fn find_raw_frames(path: &Path, format: RawFormat) -> Result<Vec<RecordedFrame>> {
    let frame = |index| RecordedFrame::new(index, format!("{index:06}"), Source::Raw(path.to_owned(), format, index));
    Ok((0..format.count_frames(path)?).map(frame).collect())
}

impl Source {
    /// The file, that of the left view if there are two.
    fn path(&self) -> &Path {
        match self {
            Self::Pair(path, _) | Self::Lone(path, _) | Self::Both(path, ..) | Self::Raw(path, ..) => path,
            #[cfg(feature = "mcap")]
            Self::Mcap(recording, _) => recording.path(),
        }
    }

    fn file_name(&self) -> String {
        self.path().file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

impl RecordedFrame {
    fn new(index: usize, name: String, source: Source) -> Self {
        Self { index, name, file: source.file_name(), source, shrink: Shrink::NONE }
    }

    /// The same, with views that are to be shrunk.
    #[must_use]
    pub fn with_shrink(self, shrink: Shrink) -> Self {
        Self { shrink, ..self }
    }

    /// The files that it is read from.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let other = if let Source::Pair(_, right) = &self.source { Some(right.as_path()) } else { None };
        std::iter::once(self.source.path()).chain(other)
    }

    /// Reads both views.
    ///
    /// # Errors
    /// If one is missing or cannot be read, or if they differ in size.
    pub fn read(&self) -> Result<StereoPair> {
        match &self.source {
            Source::Pair(left, right) => StereoPair::read_shrunk(left, right, self.shrink),
            Source::Lone(path, Side::Left) => bail!("{}: the right view is missing", path.display()),
            Source::Lone(path, Side::Right) => bail!("{}: the left view is missing", path.display()),
            Source::Both(path, split, first) => read_both(path, *split, *first, self.shrink),
            Source::Raw(path, format, index) => format.read(path, *index).map(|pair| pair.shrunk(self.shrink)),
            #[cfg(feature = "mcap")]
            Source::Mcap(recording, moment) => recording.read(*moment, self.shrink),
        }
    }
}

fn read_both(path: &Path, split: Split, first: Side, shrink: Shrink) -> Result<StereoPair> {
    let image = image_file::read(path)?;
    let (width, height) = (image.width(), image.height());
    let name = path.display();
    let [one, other] = match split {
        Split::SideBySide => {
            ensure!(width.is_multiple_of(2), "{name}: is {width} px wide, which is no two views side by side");
            [0, 1].map(|at| image.crop_imm(at * width / 2, 0, width / 2, height))
        }
        Split::TopBottom => {
            ensure!(height.is_multiple_of(2), "{name}: is {height} px high, which is no two views one above the other");
            [0, 1].map(|at| image.crop_imm(0, at * height / 2, width, height / 2))
        }
    };
    let pair = StereoPair::of_images(if first == Side::Left { [one, other] } else { [other, one] }, [path; 2], shrink)?;
    if let Some(caveat) = doubt(split, [width, height]) {
        caveat::tell(caveat, &name);
    }
    Ok(pair)
}

/// What is to be said where views of the usual shape would come of the other way to split an image.
fn doubt(split: Split, [width, height]: [u32; 2]) -> Option<Caveat> {
    let usual = 0.75..=2.4;
    let beside = f64::from(width) / 2.0 / f64::from(height);
    let above = f64::from(width) / (f64::from(height) / 2.0);
    match split {
        Split::SideBySide if !usual.contains(&beside) && usual.contains(&above) => Some(Caveat::RatherTopBottom),
        Split::TopBottom if !usual.contains(&above) && usual.contains(&beside) => Some(Caveat::RatherSideBySide),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::encode_grey_png;
    use std::fs;

    #[test]
    fn only_images_are_frames_and_their_names_are_unique() {
        let folder = tempfile::tempdir().unwrap();
        let touch = |name: &str| fs::write(folder.path().join(name), "").unwrap();
        for name in ["2.BMP", "10.bmp", "frames.csv", ".3.bmp", "bmp", "1.png"] {
            touch(name);
        }
        let find = || find_frames(folder.path(), Layout::SideBySide { first: Side::Right });
        let files: Vec<(usize, String)> = find().unwrap().into_iter().map(|frame| (frame.index, frame.file)).collect();
        assert_eq!(files, [(0, "1.png".to_owned()), (1, "2.BMP".to_owned()), (2, "10.bmp".to_owned())]);
        touch("2.png");
        assert!(find().is_err());
        assert!(find_frames(folder.path(), Layout::Folders).is_err());
    }

    #[test]
    fn the_first_view_of_a_file_is_the_one_named() {
        let folder = tempfile::tempdir().unwrap();
        let luma: Vec<u8> = [[10; 32], [20; 32]].concat().repeat(2);
        fs::write(folder.path().join("0.png"), encode_grey_png(&luma, [64, 2]).unwrap()).unwrap();
        fs::write(folder.path().join("1.png"), encode_grey_png(&[0; 65], [65, 1]).unwrap()).unwrap();
        for (first, left, right) in [(Side::Left, 10, 20), (Side::Right, 20, 10)] {
            let frames = find_frames(folder.path(), Layout::SideBySide { first }).unwrap();
            let pair = frames[0].read().unwrap();
            assert_eq!((pair.width(), pair.height()), (32, 2));
            assert!(pair.left.luma.iter().all(|&v| v == left) && pair.right.luma.iter().all(|&v| v == right));
            assert!(frames[1].read().is_err(), "an odd width has no halves");
        }
    }
}
