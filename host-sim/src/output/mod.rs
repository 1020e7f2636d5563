//! Files that come out: written beside the target and renamed, so that nothing half-written ever has
//! the final name.

pub mod claims;
pub mod colour_range;
pub mod contour_picture;
pub mod depth_png;
pub mod growing;
pub mod kitti_png;
mod legend;
pub mod map_file;
pub mod npy;
pub mod obstacle_strip;
pub mod pfm;
pub mod picture;
pub mod ply;

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, bail, ensure};
use image::{ExtendedColorType, ImageEncoder};
use tempfile::NamedTempFile;

/// Refuses a picture's name that does not end in `.png`.
///
/// # Errors
/// Names the option and the file.
pub fn check_png_name(option: &str, path: &Path) -> Result<()> {
    ensure!(suffix(path) == "png", "{option} {}: the name must end in .png", path.display());
    Ok(())
}

fn suffix(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Checks that a file can be written as `path`, before anything is computed for it.
///
/// # Errors
/// Names the option and the file.
pub fn check_writable(option: &str, path: &Path) -> Result<()> {
    let name = path.display();
    ensure!(!path.is_dir(), "{option} {name}: is a folder, where the name of a file is expected");
    if is_written_in_place(path) {
        return Ok(());
    }
    if let Ok(metadata) = path.metadata() {
        ensure!(!metadata.permissions().readonly(), "{option} {name}: the file is there and read-only");
    }
    let folder = folder_of(path);
    ensure!(folder.is_dir(), "{option} {name}: there is no folder {}", folder.display());
    match tempfile::tempfile_in(&folder) {
        Ok(_) => Ok(()),
        Err(error) => bail!("{option} {name}: cannot write in folder {}: {error}", folder.display()),
    }
}

/// Makes sure that `folder` is there and can be written in.
///
/// # Errors
/// Names the option and the folder.
pub fn prepare_folder(option: &str, folder: &Path) -> Result<()> {
    let name = folder.display();
    ensure!(!folder.is_file(), "{option} {name}: is a file, where a folder is expected");
    fs::create_dir_all(folder).map_err(|error| anyhow!("{option} {name}: cannot create the folder: {error}"))?;
    match tempfile::tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(error) => bail!("{option} {name}: cannot write in this folder: {error}"),
    }
}

/// Writes `bytes` as `path`: completely or not at all.
///
/// # Errors
/// Names the file.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    write_with(path, |file| file.write_all(bytes).map_err(|error| cannot_write(path, error)))
}

/// Writes what `fill` delivers as `path`, completely or not at all: for files too large to be held.
///
/// # Errors
/// Names the file where it cannot be written; else what `fill` says.
pub fn write_with(path: &Path, fill: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
    let failed = |error| cannot_write(path, error);
    let fill = |file: &mut dyn Write| {
        fill(file).map_err(|error| match error.downcast::<std::io::Error>() {
            Ok(error) => failed(error),
            Err(error) => error,
        })
    };
    if is_written_in_place(path) {
        let mut file = BufWriter::new(File::options().write(true).open(path).map_err(failed)?);
        fill(&mut file)?;
        return file.flush().map_err(failed);
    }
    // Into a file beside the target first, which then takes the target's name. A symbolic link stays one.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let mut file = BufWriter::new(file_beside(&target).map_err(failed)?);
    fill(&mut file)?;
    let file = file.into_inner().map_err(|error| failed(error.into_error()))?;
    file.persist(target).map_err(|error| failed(error.error))?;
    Ok(())
}

fn cannot_write(path: &Path, error: std::io::Error) -> anyhow::Error {
    anyhow!("{}: cannot be written: {error}", path.display())
}

fn file_beside(target: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        // Like any new file: what the user's umask leaves. Temporary ones are private otherwise.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder_of(target))
}

/// Pipes and devices are written to, not replaced.
fn is_written_in_place(path: &Path) -> bool {
    path.metadata().is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// A PNG of `samples`, row by row from the top, those of 16 bits in the machine's byte order.
///
/// # Errors
/// If they are not as many as the size asks for.
pub fn encode_png(samples: &[u8], [width, height]: [usize; 2], kind: ExtendedColorType) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes).write_image(samples, width as u32, height as u32, kind)?;
    Ok(bytes)
}

/// A grey PNG of 8 bits.
///
/// # Errors
/// If the pixels are not as many as the size asks for.
pub fn encode_grey_png(luma: &[u8], size: [usize; 2]) -> Result<Vec<u8>> {
    encode_png(luma, size, ExtendedColorType::L8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.pfm");
        for bytes in [&b"first"[..], b"second"] {
            check_writable("-o", &path).unwrap();
            write(&path, bytes).unwrap();
            assert_eq!(fs::read(&path).unwrap(), bytes);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(check_writable("-o", folder.path()).is_err());
        assert!(check_writable("-o", &folder.path().join("none/map.pfm")).is_err());
    }
}
