//! Recordings: what a pair of cameras saw, frame by frame, in a folder.
//!
//! Either the views lie in two folders, `left` and `right`, or each file holds both side by side; or all
//! frames are in one file, a raw dump.
//! Frames are counted from 0 in the order of their names; files that are no images by their suffix do
//! not count.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Result, anyhow, bail, ensure};
use clap::ValueEnum;

use crate::input::raw_dump::RawFormat;
use crate::{Frame, StereoPair, input::image_file};

/// Suffixes of the files that are taken for frames.
const SUFFIXES: [&str; 9] = ["bmp", "jpeg", "jpg", "pgm", "png", "pnm", "ppm", "tif", "tiff"];

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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// In the folders `left` and `right`.
    Folders,
    /// Both in each file, that of one camera in the left half.
    SideBySide {
        /// The camera in the left half.
        first: Side,
    },
}

/// One frame of a recording, not read yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedFrame {
    /// Its place in the recording, from 0.
    pub index: usize,
    /// Its name without folder and suffix; no other frame has the same.
    pub name: String,
    /// Name of the file, that of the left view if there are two.
    pub file: String,
    source: Source,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Source {
    /// A file of each view.
    Pair(PathBuf, PathBuf),
    /// One view, where the other is missing.
    Lone(PathBuf, Side),
    /// Both views in one file.
    SideBySide(PathBuf, Side),
    /// A frame of a raw dump, by its index.
    Raw(PathBuf, RawFormat, usize),
}

/// Images of a folder by their names without suffix.
type Images = BTreeMap<String, PathBuf>;

/// The frames of the recording in `folder`, in the order of their names.
///
/// Of two folders, files of the same name belong together, and a file that is alone is a frame that
/// cannot be read. If no name is in both, the files belong together in their order.
///
/// # Errors
/// If the folder cannot be read or has no frames, if two frames have one name, or if nothing tells
/// which views belong together.
pub fn find_frames(folder: &Path, layout: Layout) -> Result<Vec<RecordedFrame>> {
    let name = folder.display();
    ensure!(folder.exists(), "{name}: no such folder, where one with a recording is expected");
    ensure!(folder.is_dir(), "{name}: is a file, where a folder with a recording is expected");
    let sources = match layout {
        Layout::SideBySide { first } => {
            let images = find_images(folder)?;
            ensure!(
                !images.is_empty(),
                "{name}: no image in it, where frames with both views side by side are expected"
            );
            images.into_iter().map(|(name, path)| (name, Source::SideBySide(path, first))).collect()
        }
        Layout::Folders => {
            let [left, right] = ["left", "right"].map(|side| folder.join(side));
            ensure!(
                left.is_dir() && right.is_dir(),
                "{name}: has no folders left and right; frames with both views in one file need --layout side-by-side"
            );
            let (left, right) = (find_images(&left)?, find_images(&right)?);
            ensure!(!left.is_empty() || !right.is_empty(), "{name}: no image in its folders left and right");
            pair_views(left, right).map_err(|error| anyhow!("{name}: {error}"))?
        }
    };
    let frame = |(index, (name, source)): (usize, (String, Source))| RecordedFrame {
        index,
        name,
        file: source.file_name(),
        source,
    };
    Ok(sources.into_iter().enumerate().map(frame).collect())
}

/// The frames of the raw dump in `path`, named by their index. Where the file is no whole number of
/// frames, the last one is a frame that cannot be read.
///
/// # Errors
/// If the file cannot be read or has not even one frame.
pub fn find_raw_frames(path: &Path, format: RawFormat) -> Result<Vec<RecordedFrame>> {
    let frame = |index| {
        let source = Source::Raw(path.to_owned(), format, index);
        RecordedFrame { index, name: format!("{index:06}"), file: source.file_name(), source }
    };
    Ok((0..format.count_frames(path)?).map(frame).collect())
}

fn find_images(folder: &Path) -> Result<Images> {
    let unreadable = |error| anyhow!("{}: cannot be read: {error}", folder.display());
    let mut images = Images::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let suffix = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() || name.starts_with('.') || !SUFFIXES.contains(&suffix.as_str()) {
            continue;
        }
        if let Some(other) = images.insert(name, path.clone()) {
            let (path, other) = (path.display(), other.display());
            bail!("{path}: what is made of it would have the same name as that of {other}; rename one");
        }
    }
    Ok(images)
}

fn pair_views(left: Images, mut right: Images) -> Result<Vec<(String, Source)>> {
    if !left.keys().any(|name| right.contains_key(name)) && !left.is_empty() && !right.is_empty() {
        ensure!(
            left.len() == right.len(),
            "left has {} images and right {}, and no name is in both: nothing tells which belong together",
            left.len(),
            right.len()
        );
        let pairs = left.into_iter().zip(right.into_values());
        return Ok(pairs.map(|((name, left), right)| (name, Source::Pair(left, right))).collect());
    }
    let mut sources = BTreeMap::new();
    for (name, left) in left {
        let source = match right.remove(&name) {
            Some(right) => Source::Pair(left, right),
            None => Source::Lone(left, Side::Left),
        };
        sources.insert(name, source);
    }
    sources.extend(right.into_iter().map(|(name, right)| (name, Source::Lone(right, Side::Right))));
    Ok(sources.into_iter().collect())
}

impl Source {
    fn file_name(&self) -> String {
        let (Self::Pair(path, _) | Self::Lone(path, _) | Self::SideBySide(path, _) | Self::Raw(path, ..)) = self;
        path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

impl RecordedFrame {
    /// Reads both views.
    ///
    /// # Errors
    /// If one is missing or cannot be read, or if they differ in size.
    pub fn read(&self) -> Result<StereoPair> {
        match &self.source {
            Source::Pair(left, right) => StereoPair::read(left, right),
            Source::Lone(path, Side::Left) => bail!("{}: the right view is missing", path.display()),
            Source::Lone(path, Side::Right) => bail!("{}: the left view is missing", path.display()),
            Source::SideBySide(path, first) => read_side_by_side(path, *first),
            Source::Raw(path, format, index) => format.read(path, *index),
        }
    }
}

fn read_side_by_side(path: &Path, first: Side) -> Result<StereoPair> {
    let image = image_file::read(path)?;
    let (width, height) = (image.width(), image.height());
    ensure!(width.is_multiple_of(2), "{}: is {width} px wide, which is no two views side by side", path.display());
    let half = |at: u32| Frame::of_image(image.crop_imm(at * width / 2, 0, width / 2, height), path);
    let (one, other) = (half(0)?, half(1)?);
    Ok(match first {
        Side::Left => StereoPair { left: one, right: other },
        Side::Right => StereoPair { left: other, right: one },
    })
}

/// A choice of frames by index: from the first up to, but not including, the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FrameRange {
    first: usize,
    end: Option<usize>,
}

impl FrameRange {
    /// Every `step`-th of `frames` from the first on that the range has; none where it begins after
    /// the last one.
    ///
    /// # Panics
    /// If `step` is 0.
    #[must_use]
    pub fn choose<T>(&self, frames: Vec<T>, step: usize) -> Vec<T> {
        let end = self.end.unwrap_or(frames.len());
        frames.into_iter().take(end).skip(self.first).step_by(step).collect()
    }
}

impl FromStr for FrameRange {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const FORM: &str = "must be A..B, A.. or ..B, with frames counted from 0";
        let (first, end) = text.split_once("..").ok_or(FORM)?;
        let number = |text: &str| text.parse::<usize>().map_err(|_| FORM);
        let first = if first.is_empty() { 0 } else { number(first)? };
        let end = if end.is_empty() { None } else { Some(number(end)?) };
        if end.is_some_and(|end| end <= first) {
            return Err("holds no frame: the end, which does not belong to it, must be greater than the first");
        }
        Ok(Self { first, end })
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.first, self.end) {
            (first, Some(end)) => write!(f, "{first}..{end}"),
            (first, None) => write!(f, "{first}.."),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::encode_grey_png;

    fn choice(range: &str, step: usize) -> Vec<usize> {
        range.parse::<FrameRange>().unwrap().choose((0..10).collect(), step)
    }

    #[test]
    fn ranges_are_half_open_and_may_lack_an_end() {
        assert_eq!(choice("2..5", 1), [2, 3, 4]);
        assert_eq!(choice("7..", 1), [7, 8, 9]);
        assert_eq!(choice("..2", 1), [0, 1]);
        assert_eq!(choice("..", 4), [0, 4, 8]);
        assert_eq!(choice("1..8", 3), [1, 4, 7]);
        assert_eq!(choice("8..99", 1), [8, 9]);
        assert!(choice("10..", 1).is_empty());
        for text in ["", "3", "5..5", "5..2", "..0", "a..b", "-1..3", "1...3", "1..2..3", "0..99999999999999999999999"]
        {
            assert!(text.parse::<FrameRange>().is_err(), "{text:?}");
        }
    }

    fn images(folder: &str, names: &[&str]) -> Images {
        names.iter().map(|&name| (name.to_owned(), Path::new(folder).join(name))).collect()
    }

    fn paired(left: &[&str], right: &[&str]) -> Result<Vec<String>> {
        let sources = pair_views(images("l", left), images("r", right))?;
        let text = |(name, source): (String, Source)| match source {
            Source::Pair(left, right) => format!("{name}: {} {}", left.display(), right.display()),
            Source::Lone(path, side) => format!("{name}: {} {side} only", path.display()),
            Source::SideBySide(..) | Source::Raw(..) => unreachable!(),
        };
        Ok(sources.into_iter().map(text).collect())
    }

    #[test]
    fn views_pair_by_name_and_a_lone_one_stays_a_frame() {
        assert_eq!(
            paired(&["a", "b", "d"], &["b", "c", "d"]).unwrap(),
            ["a: l/a left only", "b: l/b r/b", "c: r/c right only", "d: l/d r/d"]
        );
        assert_eq!(paired(&["a"], &[]).unwrap(), ["a: l/a left only"]);
    }

    #[test]
    fn views_without_a_common_name_pair_in_order() {
        assert_eq!(paired(&["l1", "l2"], &["r1", "r2"]).unwrap(), ["l1: l/l1 r/r1", "l2: l/l2 r/r2"]);
        assert!(paired(&["l1", "l2"], &["r1"]).is_err());
    }

    #[test]
    fn only_images_are_frames_and_their_names_are_unique() {
        let folder = tempfile::tempdir().unwrap();
        let touch = |name: &str| fs::write(folder.path().join(name), "").unwrap();
        for name in ["2.BMP", "10.bmp", "frames.csv", ".3.bmp", "bmp", "1.png"] {
            touch(name);
        }
        let find = || find_frames(folder.path(), Layout::SideBySide { first: Side::Right });
        let files: Vec<(usize, String)> = find().unwrap().into_iter().map(|frame| (frame.index, frame.file)).collect();
        assert_eq!(files, [(0, "1.png".to_owned()), (1, "10.bmp".to_owned()), (2, "2.BMP".to_owned())]);
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
