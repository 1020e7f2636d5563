//! One camera's views: files, their names and moments.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, bail};

use super::names;

/// Suffixes of the files that are taken for frames.
const SUFFIXES: [&str; 9] = ["bmp", "jpeg", "jpg", "pgm", "png", "pnm", "ppm", "tif", "tiff"];
/// Suffixes of films, which ffmpeg can read.
const FILMS: [&str; 10] = ["avi", "h264", "m4v", "mjpeg", "mjpg", "mkv", "mov", "mp4", "mpg", "webm"];
/// No list of frames is longer.
const MAX_LIST_BYTES: u64 = 1 << 28;

/// Whether files with that suffix, in small letters, are taken for frames.
pub(super) fn is_image_suffix(suffix: &str) -> bool {
    SUFFIXES.contains(&suffix)
}

/// A view that was not read yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct View {
    /// Name of what is made of it.
    pub(super) name: String,
    /// The name without what tells the camera: that of both views of a moment.
    pub(super) key: String,
    /// Number or time.
    pub(super) moment: Option<i128>,
    pub(super) path: PathBuf,
}

impl View {
    pub(super) fn file(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// The views in these files, whose `key` is their name; numbers are found over all of them.
pub(super) fn of_keys(files: Vec<(String, PathBuf)>) -> Vec<View> {
    let keys: Vec<&str> = files.iter().map(|(key, _)| key.as_str()).collect();
    let moments = names::moments(&keys);
    let view = |((key, path), moment): ((String, PathBuf), _)| View { name: stem(&path), key, moment, path };
    files.into_iter().zip(moments).map(view).collect()
}

/// The images of a folder; a list `data.csv` beside it, as EuRoC has it, tells which and when.
pub(super) fn of_folder(folder: &Path) -> Result<Vec<View>> {
    if let Some(views) = of_list(folder) {
        return Ok(views);
    }
    Ok(of_keys(images(folder)?.into_iter().map(|path| (stem(&path), path)).collect()))
}

/// The views that the list of the folder tells, if there is one.
fn of_list(folder: &Path) -> Option<Vec<View>> {
    let list = folder.parent()?.join("data.csv");
    if folder.file_name()? != "data" {
        return None;
    }
    let mut views = Vec::new();
    for line in BufReader::new(File::open(list).ok()?.take(MAX_LIST_BYTES)).lines() {
        let line = line.ok()?;
        let Some((time, file)) = line.split_once(',') else { continue };
        let Ok(time) = time.trim().parse() else { continue };
        let path = folder.join(file.trim());
        let name = stem(&path);
        views.push(View { key: name.clone(), name, moment: Some(time), path });
    }
    (!views.is_empty()).then_some(views)
}

/// The image files of a folder, no two of the same name but for the suffix.
pub(super) fn images(folder: &Path) -> Result<Vec<PathBuf>> {
    let unreadable = |error| anyhow!("{}: cannot be read: {error}", folder.display());
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if is_image(&path) && !path.is_dir() {
            found.push(path);
        }
    }
    found.sort_by(|a, b| names::natural_order(&stem(a), &stem(b)).then_with(|| a.cmp(b)));
    if let Some(pair) = found.windows(2).find(|pair| stem(&pair[0]) == stem(&pair[1])) {
        let (path, other) = (pair[1].display(), pair[0].display());
        bail!("{path}: what is made of it would have the same name as that of {other}; rename one");
    }
    Ok(found)
}

/// The image files that a pattern matches, in natural order. Where names repeat from folder to folder, these
/// are part of them.
pub(super) fn of_pattern(folder: &Path, option: &str, pattern: &str) -> Result<Vec<View>> {
    let below = PathBuf::from(glob::Pattern::escape(&folder.to_string_lossy())).join(pattern);
    let matches = glob::glob(&below.to_string_lossy()).map_err(|error| anyhow!("{option} {pattern}: {error}"))?;
    let mut paths: Vec<PathBuf> = matches.filter_map(Result::ok).filter(|path| is_image(path)).collect();
    if paths.is_empty() {
        bail!("{option} {pattern}: matches no image in {}", folder.display());
    }
    paths.sort_by(|a, b| names::natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    let stems: HashSet<String> = paths.iter().map(|path| stem(path)).collect();
    let is_unique = stems.len() == paths.len();
    let name = |path: &Path| {
        let relative = path.strip_prefix(folder).unwrap_or(path).with_extension("");
        if is_unique { stem(path) } else { relative.to_string_lossy().replace(['/', '\\'], "_") }
    };
    let key = |path: &Path| {
        let name = name(path);
        names::Scheme::ALL[..2].iter().find_map(|scheme| Some(scheme.split(&name)?.1)).unwrap_or(name)
    };
    let mut views = of_keys(paths.into_iter().map(|path| (key(&path), path)).collect());
    views.iter_mut().for_each(|view| view.name = name(&view.path));
    Ok(views)
}

fn is_image(path: &Path) -> bool {
    is_image_suffix(&suffix(path)) && !stem(path).starts_with('.')
}

/// Whether it is a film by its name.
pub(super) fn is_film(path: &Path) -> bool {
    FILMS.contains(&suffix(path).as_str())
}

/// Whether it is an MCAP recording by its name.
pub(super) fn is_mcap(path: &Path) -> bool {
    suffix(path) == "mcap"
}

/// What a name ends in, in lower case.
pub(super) fn suffix(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// The name without folder and suffix.
pub(super) fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Views in files of these names.
#[cfg(test)]
pub(super) fn of_names(names: &[&str]) -> Vec<View> {
    of_keys(names.iter().map(|name| ((*name).to_owned(), PathBuf::from(format!("{name}.png")))).collect())
}
