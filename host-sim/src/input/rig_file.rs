//! Rig descriptions in files.

use std::path::Path;

use anyhow::{Result, anyhow, ensure};
use haarline_rig::Description;

/// Reads the description in `path`.
///
/// # Errors
/// Names the file and what is wrong in it.
pub fn read(path: &Path) -> Result<Description> {
    let name = path.display();
    ensure!(!path.is_dir(), "{name}: is a folder, where a rig description is expected");
    let text = std::fs::read_to_string(path).map_err(|error| anyhow!("{name}: cannot be read: {error}"))?;
    Description::parse(&text).map_err(|error| anyhow!("{name}: {error}"))
}

/// Refuses views of another size than the rig's.
///
/// # Errors
/// Names both sizes.
pub fn check_size(description: &Description, [width, height]: [usize; 2]) -> Result<()> {
    let rig = [description.width, description.height].map(usize::from);
    ensure!(
        rig == [width, height],
        "--rig: its width and height are {}x{} px, but the views are {width}x{height} px",
        rig[0],
        rig[1]
    );
    Ok(())
}
