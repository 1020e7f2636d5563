//! Where the two cameras' views are: folders and names as recordings have them.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};

use super::Side;
use super::names::Scheme;
use super::views::{self, View};

/// The views of both cameras.
pub(super) type Cameras = [Vec<View>; 2];

/// Folders of two cameras, as datasets and programs name them, in lower case.
const FOLDERS: [[&str; 2]; 12] = [
    ["left", "right"],
    ["l", "r"],
    ["image_left", "image_right"],
    ["left_images", "right_images"],
    ["cam_left", "cam_right"],
    ["camera_left", "camera_right"],
    ["cam0", "cam1"],
    ["cam_0", "cam_1"],
    ["image_0", "image_1"],
    ["image_2", "image_3"],
    ["image_00", "image_01"],
    ["image_02", "image_03"],
];

/// Finds out how the views lie in `folder`: in two folders, or in one with names that tell the camera.
pub(super) fn find(folder: &Path) -> Result<Cameras> {
    if let Some(pair) = find_folders(folder)? {
        return of_folders(pair);
    }
    match of_names(folder)? {
        Some(cameras) => Ok(cameras),
        None => bail!("{}: {}", folder.display(), nothing_found(folder)?),
    }
}

/// The views in two folders of `folder`.
pub(super) fn in_folders(folder: &Path) -> Result<Cameras> {
    match find_folders(folder)? {
        Some(pair) => of_folders(pair),
        None => bail!(
            "{}: has no folders left and right, image_0 and image_1, cam0/data and cam1/data or the like; --left GLOB \
             and --right GLOB tell other ones",
            folder.display()
        ),
    }
}

/// The views in `folder` itself, whose names tell the camera.
pub(super) fn in_names(folder: &Path) -> Result<Cameras> {
    match of_names(folder)? {
        Some(cameras) => Ok(cameras),
        None => bail!(
            "{}: not every name tells its camera, as left_01.png and right_01.png, l01 and r01, 01_0 and 01_1 do; \
             --left GLOB and --right GLOB tell other ones",
            folder.display()
        ),
    }
}

fn of_folders([left, right]: [PathBuf; 2]) -> Result<Cameras> {
    Ok([views::of_folder(&left)?, views::of_folder(&right)?])
}

/// The two folders, if there is one such pair.
fn find_folders(folder: &Path) -> Result<Option<[PathBuf; 2]>> {
    let mut pairs = Vec::new();
    for above in [folder.to_owned(), folder.join("mav0")] {
        let entries = subfolders(&above);
        let named = |wanted: &str| entries.iter().find(|path| file_name(path).eq_ignore_ascii_case(wanted));
        for [left, right] in FOLDERS {
            if let (Some(left), Some(right)) = (named(left), named(right)) {
                pairs.push([with_data(left), with_data(right)]);
            }
        }
    }
    if pairs.len() > 1 {
        // Empty folders are no cameras where others have images.
        pairs.retain(|pair| pair.iter().any(|folder| views::images(folder).is_ok_and(|images| !images.is_empty())));
    }
    let pattern = |path: &Path| {
        let relative = path.strip_prefix(folder).unwrap_or(path).display();
        format!("'{relative}/*'")
    };
    let told: Vec<String> =
        pairs.iter().map(|[left, right]| format!("--left {} --right {}", pattern(left), pattern(right))).collect();
    ensure!(
        pairs.len() < 2,
        "{}: has folders of more than two cameras, tell which: {}",
        folder.display(),
        told.join(", or ")
    );
    Ok(pairs.pop())
}

/// The folder `data` in it, if there is one, as in EuRoC and KITTI recordings.
fn with_data(folder: &Path) -> PathBuf {
    let data = folder.join("data");
    if data.is_dir() { data } else { folder.to_owned() }
}

fn subfolders(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    folders
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The views in `folder`, if every name tells its camera in the same way.
fn of_names(folder: &Path) -> Result<Option<Cameras>> {
    let images = views::images(folder)?;
    for scheme in Scheme::ALL {
        let mut cameras = [Vec::new(), Vec::new()];
        for path in &images {
            if let Some((side, key)) = scheme.split(&views::stem(path)) {
                cameras[usize::from(side == Side::Right)].push((key, path.clone()));
            }
        }
        let told: usize = cameras.iter().map(Vec::len).sum();
        // Letters and digits may mean something else in a name; the words do not.
        let is_enough = told == images.len() || scheme == Scheme::Words;
        if is_enough && cameras.iter().all(|camera| !camera.is_empty()) {
            return Ok(Some(cameras.map(views::of_keys)));
        }
    }
    Ok(None)
}

/// What is there instead of two cameras' views.
fn nothing_found(folder: &Path) -> Result<String> {
    let images = views::images(folder)?;
    if let Some(image) = images.first() {
        return Ok(format!(
            "no name of its images ({} of them, as {}) tells a camera; if each holds both views, add --layout side-by-side \
             or top-bottom, and --first; --left GLOB and --right GLOB tell any other names",
            images.len(),
            file_name(image)
        ));
    }
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    if let Some(film) = entries.map(|entry| entry.path()).find(|path| views::is_film(path)) {
        return Ok(super::film_advice(&film));
    }
    let names: Vec<String> = subfolders(folder).iter().take(8).map(|path| file_name(path)).collect();
    let has = if names.is_empty() { String::new() } else { format!(" (it has {})", names.join(", ")) };
    Ok(format!(
        "has no folders left and right, image_0 and image_1, cam0 and cam1 or the like{has}, and no images; --left GLOB and \
         --right GLOB tell other ones"
    ))
}
