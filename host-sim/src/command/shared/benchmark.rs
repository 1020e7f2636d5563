//! Which benchmark scenes, and OpenCV's figures on them.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};

use crate::output::claims::Claims;
use crate::score::baselines::Baselines;
use crate::score::scene::{self, find_scenes, read_meta};
use crate::score::split::{Half, halves};

/// Which benchmark scenes, and OpenCV's figures on them.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct Benchmark {
    /// Folder of scene folders, each with left.png, right.png, truth.png, nonocc.png and meta.json; or
    /// one scene folder
    #[arg(value_name = "SCENES_DIR")]
    pub(in crate::command) scenes: PathBuf,
    /// Only these scenes
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    only: Vec<String>,
    /// Only one half of the scenes: in each family they go by name to A, B, B, A, A, B, B, A, ...
    #[arg(long, value_enum, value_name = "A|B")]
    split: Option<Half>,
    /// OpenCV's figures [default: baselines.json in the scenes' folder or in one of the two above it]
    #[arg(long, value_name = "FILE")]
    baselines: Option<PathBuf>,
}

impl Benchmark {
    /// The folders that `--only` names, or all, of the half that `--split` names, or of both.
    pub(in crate::command) fn folders(&self) -> Result<Vec<PathBuf>> {
        let folders = scene_folders(&self.scenes, &self.only)?;
        let Some(half) = self.split else { return Ok(folders) };
        // Halved are all scenes, whichever of them are wanted.
        let all = find_scenes(&self.scenes)?;
        let name = |folder: &Path| folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let family = |folder: &Path| read_meta(&folder.join("meta.json")).map(|meta| meta.family);
        let scenes = all.iter().map(|folder| Ok((name(folder), family(folder)?))).collect::<Result<Vec<_>>>()?;
        let inside: Vec<&PathBuf> =
            all.iter().zip(halves(&scenes)).filter(|(_, other)| *other == half).map(|(folder, _)| folder).collect();
        let folders: Vec<PathBuf> = folders.into_iter().filter(|folder| inside.contains(&folder)).collect();
        ensure!(!folders.is_empty(), "--split {half}: none of the scenes is in that half");
        Ok(folders)
    }

    /// OpenCV's figures, if a file is named or found.
    pub(in crate::command) fn read_baselines(&self) -> Result<Option<Baselines>> {
        self.baselines_file().map(|path| Baselines::read(&path)).transpose()
    }

    fn baselines_file(&self) -> Option<PathBuf> {
        self.baselines.clone().or_else(|| Baselines::find(&self.scenes))
    }

    /// The scenes in `folders` and OpenCV's figures as files that are read.
    pub(in crate::command) fn claims(&self, folders: &[PathBuf]) -> Claims<'static> {
        let mut claims = Claims::new();
        claims.read(self.baselines_file());
        read_scenes(&mut claims, folders);
        claims
    }
}

/// The scenes' files are read.
pub(in crate::command) fn read_scenes(claims: &mut Claims<'_>, folders: &[PathBuf]) {
    claims.read(folders.iter().flat_map(|folder| scene::FILES.map(|file| folder.join(file))));
}

/// The folders of the scenes in `scenes` that `only` names, or of all.
pub(in crate::command) fn scene_folders(scenes: &Path, only: &[String]) -> Result<Vec<PathBuf>> {
    let folders = find_scenes(scenes)?;
    let name = |folder: &Path| folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    for wanted in only {
        ensure!(
            folders.iter().any(|folder| name(folder) == *wanted),
            "--only: there is no scene {wanted:?} in {}, which has {}",
            scenes.display(),
            list(folders.iter().map(|folder| name(folder)))
        );
    }
    let is_wanted = |folder: &PathBuf| only.is_empty() || only.contains(&name(folder));
    Ok(folders.into_iter().filter(is_wanted).collect())
}

/// The first names, and how many more there are.
fn list(names: impl ExactSizeIterator<Item = String>) -> String {
    const SHOWN: usize = 8;
    let more = names.len().saturating_sub(SHOWN);
    let shown = names.take(SHOWN).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{shown} and {more} more") } else { shown }
}
