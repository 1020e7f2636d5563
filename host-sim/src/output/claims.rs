//! What a command reads and what it writes: no output may be an input, or another output.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};

use super::{check_writable, folder_of, is_written_in_place, prepare_folder};

/// One file, whatever its names: symbolic and hard links lead to the same.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Identity {
    /// Device and number of a file that is there.
    #[cfg(unix)]
    Node(u64, u64),
    /// Where the file is or would be.
    Place(PathBuf),
}

impl Identity {
    fn of(path: &Path) -> Self {
        #[cfg(unix)]
        if let Ok(metadata) = path.metadata() {
            use std::os::unix::fs::MetadataExt;
            return Self::Node(metadata.dev(), metadata.ino());
        }
        Self::Place(match (path.canonicalize(), folder_of(path).canonicalize(), path.file_name()) {
            (Ok(path), ..) => path,
            (_, Ok(folder), Some(name)) => folder.join(name),
            _ => path.to_owned(),
        })
    }
}

/// Which names a command writes in a folder.
type Names<'a> = Box<dyn Fn(&str) -> bool + 'a>;

/// The files of a command.
#[derive(Default)]
pub struct Claims<'a> {
    inputs: HashSet<Identity>,
    /// Folders with frames; nothing is written among these.
    recorded: HashSet<Identity>,
    outputs: HashMap<Identity, PathBuf>,
    folders: Vec<(Identity, Names<'a>)>,
}

impl<'a> Claims<'a> {
    /// Of a command that reads and writes nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// These files are read. What is not there is told where it is read; a pipe or device is not replaced.
    pub fn read<P: AsRef<Path>>(&mut self, paths: impl IntoIterator<Item = P>) {
        let paths = paths.into_iter().filter(|path| !is_written_in_place(path.as_ref()));
        self.inputs.extend(paths.map(|path| Identity::of(path.as_ref())));
    }

    /// The frames in these files are read, those of the recording `recording`.
    pub fn read_recording<'p>(&mut self, recording: &Path, files: impl IntoIterator<Item = &'p Path>) {
        let mut folders = HashSet::from([recording.to_owned()]);
        for file in files {
            self.read([file]);
            folders.insert(folder_of(file));
        }
        if recording.is_dir() {
            self.recorded.extend(folders.iter().map(|folder| Identity::of(folder)));
        }
    }

    /// The file `path` is written: checks that it can be, and that it is nothing else.
    ///
    /// # Errors
    /// Names the option and the file.
    pub fn write(&mut self, option: &str, path: &Path) -> Result<()> {
        check_writable(option, path)?;
        if is_written_in_place(path) {
            return Ok(());
        }
        let (name, identity) = (path.display(), Identity::of(path));
        ensure!(
            !self.inputs.contains(&identity),
            "{option} {name}: is one of the files that are read, give another name"
        );
        let folder = Identity::of(&folder_of(path));
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        let is_taken = self.folders.iter().any(|(other, names)| *other == folder && names(&file));
        ensure!(!is_taken, "{option} {name}: is a name that -o writes, give another one");
        if self.outputs.insert(identity, path.to_owned()).is_some() {
            bail!("{option} {name}: the name is given twice");
        }
        Ok(())
    }

    /// The image `path` is written: the same, and that it is none of the recording's frames in the next run.
    ///
    /// # Errors
    /// Names the option and the file.
    pub fn write_beside(&mut self, option: &str, path: &Path) -> Result<()> {
        let is_among = self.recorded.contains(&Identity::of(&folder_of(path)));
        ensure!(!is_among, "{option} {}: lies in the recording, give another name", path.display());
        self.write(option, path)
    }

    /// Files whose `names` are true are written in `folder`, which is made if it is not there: checks that
    /// none of them is read or written already.
    ///
    /// # Errors
    /// Names the option and the file.
    pub fn write_in(&mut self, option: &str, folder: &Path, names: impl Fn(&str) -> bool + 'a) -> Result<()> {
        let (told, identity) = (folder.display(), Identity::of(folder));
        ensure!(!self.recorded.contains(&identity), "{option} {told}: is a folder of the recording, give another one");
        // Nothing is there to be replaced if the folder is not.
        for entry in folder.read_dir().into_iter().flatten().filter_map(Result::ok) {
            let is_written = names(&entry.file_name().to_string_lossy());
            ensure!(
                !is_written || !self.inputs.contains(&Identity::of(&entry.path())),
                "{option} {told}: {} is one of the files that are read and would be replaced, give another folder",
                entry.path().display()
            );
        }
        for path in self.outputs.values() {
            let is_within = Identity::of(&folder_of(path)) == identity;
            let file = path.file_name().unwrap_or_default().to_string_lossy();
            ensure!(
                !is_within || !names(&file),
                "{option} {told}: {} would be written twice, give another folder",
                path.display()
            );
        }
        prepare_folder(option, folder)?;
        self.folders.push((Identity::of(folder), Box::new(names)));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn an_input_is_no_output_by_any_of_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("out")).unwrap();
        for name in ["left.png", "out/0.pfm", "other.png"] {
            fs::write(path(name), "bytes").unwrap();
        }
        let mut claims = Claims::new();
        claims.read([path("left.png"), path("missing.png"), path("out/0.pfm")]);
        assert!(claims.write("-o", &path("left.png")).is_err());
        assert!(claims.write("-o", &path("out/../left.png")).is_err());
        assert!(claims.write("-o", &path("missing.png")).is_err());
        fs::hard_link(path("left.png"), path("hard.png")).unwrap();
        #[cfg(unix)]
        {
            assert!(claims.write("-o", &path("hard.png")).is_err());
            std::os::unix::fs::symlink(path("left.png"), path("soft.png")).unwrap();
            assert!(claims.write("-o", &path("soft.png")).is_err());
        }
        claims.write("-o", &path("other.png")).unwrap();
        assert!(claims.write("--grey", &path("other.png")).is_err(), "twice");
        claims.write("-o", &path("new.png")).unwrap();
        assert!(claims.write("--grey", &path("out/../new.png")).is_err(), "twice");

        assert!(claims.write_in("-o", &path("out"), |name| name.ends_with(".pfm")).is_err());
        assert!(claims.write_in("-o", folder.path(), |name| name == "new.png").is_err());
        claims.write_in("-o", &path("out"), |name| name == "frames.csv").unwrap();
        assert!(claims.write("--mavlink", &path("out/frames.csv")).is_err());
        claims.write("--mavlink", &path("out/mavlink")).unwrap();
        claims.read_recording(&path("out"), []);
        assert!(claims.write_in("-o", &path("out/../out"), |_| false).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_device_takes_any_number_of_outputs() {
        let mut claims = Claims::new();
        claims.read(["/dev/null"]);
        claims.write("-o", Path::new("/dev/null")).unwrap();
        claims.write("--grey", Path::new("/dev/null")).unwrap();
    }
}
