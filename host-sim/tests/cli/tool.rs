//! The tool in a folder of its own.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// How the tool ended and what it said.
#[derive(Debug)]
pub struct Outcome {
    /// Exit status.
    pub status: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Outcome {
    /// The standard output as JSON.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {}", self.stdout))
    }
}

/// A temporary folder in which the tool is called: names in a command line are relative to it.
pub struct Bench {
    folder: TempDir,
}

impl Bench {
    /// An empty one.
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// Where `name` is.
    pub fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The content of the file `name`.
    #[track_caller]
    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Makes the file `name`, with its folder.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    /// All files and folders in it, with the files' contents.
    pub fn content(&self) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
        let (mut found, mut folders) = (BTreeMap::new(), vec![self.folder.path().to_owned()]);
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path.clone());
                }
                let bytes = fs::read(&path).ok();
                found.insert(path, bytes);
            }
        }
        found
    }

    /// Calls the tool; `line` is split at spaces.
    pub fn run(&self, line: &str) -> Outcome {
        self.run_with(line.split_whitespace(), &[], Stdio::piped())
    }

    /// Calls the tool with arguments, environment variables and a standard output as given.
    pub fn run_with(
        &self,
        arguments: impl IntoIterator<Item = impl AsRef<OsStr>>,
        variables: &[(&str, &str)],
        stdout: Stdio,
    ) -> Outcome {
        let arguments: Vec<OsString> = arguments.into_iter().map(|argument| argument.as_ref().to_owned()).collect();
        let output = Command::new(env!("CARGO_BIN_EXE_haarline"))
            .args(arguments)
            .envs(variables.iter().copied())
            .current_dir(self.folder.path())
            .stdin(Stdio::null())
            .stdout(stdout)
            .stderr(Stdio::piped())
            .spawn()
            .and_then(std::process::Child::wait_with_output)
            .unwrap();
        Outcome {
            status: output.status.code().unwrap_or_else(|| panic!("ended by a signal: {output:?}")),
            stdout: String::from_utf8(output.stdout).expect("stdout is text"),
            stderr: String::from_utf8(output.stderr).expect("stderr is text"),
        }
    }

    /// Calls the tool, which must succeed and say nothing on the standard error.
    #[track_caller]
    pub fn succeeds(&self, line: &str) -> Outcome {
        let outcome = self.run(line);
        assert_eq!((outcome.status, outcome.stderr.as_str()), (0, ""), "haarline {line}");
        outcome
    }

    /// Calls the tool on views that are no pair or show nothing: it must succeed, and may warn of them in one line.
    #[track_caller]
    pub fn succeeds_on_odd_views(&self, line: &str) -> Outcome {
        let outcome = self.run(line);
        assert_eq!(outcome.status, 0, "haarline {line}: {}", outcome.stderr);
        let is_warning = |line: &str| line.starts_with("warning: ");
        assert!(outcome.stderr.lines().count() <= 1 && outcome.stderr.lines().all(is_warning), "{}", outcome.stderr);
        outcome
    }

    /// Calls the tool, which must refuse with one line that has all of `told` in it, and must leave the
    /// folder as it was.
    #[track_caller]
    pub fn refuses(&self, line: &str, told: &[&str]) {
        let before = self.content();
        let outcome = self.run(line);
        assert_refused(&outcome, line, told);
        assert_same_content(&before, &self.content(), line);
    }
}

/// An exit status of 2, and one error line that has all of `told` in it.
#[track_caller]
pub fn assert_refused(outcome: &Outcome, line: &str, told: &[&str]) {
    assert_eq!(outcome.status, 2, "haarline {line}: {outcome:?}");
    assert_eq!(outcome.stdout, "", "haarline {line}");
    assert_one_error_line(&outcome.stderr, line);
    for words in told {
        assert!(outcome.stderr.contains(words), "haarline {line}: no {words:?} in {:?}", outcome.stderr);
    }
}

/// One line that begins as an error's does, without the words of a panic.
#[track_caller]
pub fn assert_one_error_line(stderr: &str, line: &str) {
    let is_one_line = stderr.ends_with('\n') && stderr.lines().count() == 1;
    assert!(is_one_line && stderr.starts_with("error: "), "haarline {line}: {stderr:?}");
    assert!(!stderr.starts_with("error: error"), "haarline {line}: {stderr:?}");
    for words in ["panicked", "internal fault", "RUST_BACKTRACE", "unwrap()", "Usage:"] {
        assert!(!stderr.contains(words), "haarline {line}: {stderr:?}");
    }
}

#[track_caller]
fn assert_same_content(
    before: &BTreeMap<PathBuf, Option<Vec<u8>>>,
    after: &BTreeMap<PathBuf, Option<Vec<u8>>>,
    line: &str,
) {
    let names = |content: &BTreeMap<PathBuf, _>| content.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(before), names(after), "haarline {line}: files were left or are gone");
    for (path, bytes) in before {
        assert!(after[path] == *bytes, "haarline {line}: {} changed", path.display());
    }
}
