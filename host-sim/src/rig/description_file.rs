//! Changes to a rig description in a file, whose other lines and comments stay.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use haarline_rig::{Description, template, with_fields};

use crate::input::whole_file;
use crate::output;
use crate::output::claims::Claims;

/// A description that is to be written: a new one from the template, or one that is there with some fields changed.
#[derive(Debug)]
pub struct DescriptionFile {
    path: PathBuf,
    /// The text that is there, or the template.
    before: String,
    exists: bool,
}

/// A field and its value in TOML.
pub type Field = (&'static str, String);

impl DescriptionFile {
    /// The file at `path`, which may be there only if it is to be updated. `option` names it in refusals.
    ///
    /// # Errors
    /// If it is there and is not to be updated, is no description, or cannot be written.
    pub fn open(option: &str, path: &Path, is_update: bool) -> Result<Self> {
        let name = path.display();
        output::check_writable(option, path)?;
        let exists = path.exists();
        ensure!(
            !exists || is_update,
            "{option} {name}: the file is there; --update changes it and keeps it as {name}.bak"
        );
        ensure!(exists || !is_update, "--update: there is no {name} to be changed; leave --update out to make it");
        let before = if exists { whole_file::text(path)? } else { template() };
        Description::parse(&before).with_context(|| name.to_string())?;
        Ok(Self { path: path.to_owned(), before, exists })
    }

    /// Claims the name under which the previous one is kept.
    ///
    /// # Errors
    /// If it is read or written already.
    pub fn claim_backup(&self, option: &str, claims: &mut Claims<'_>) -> Result<()> {
        if self.exists { claims.write(option, &self.backup()) } else { Ok(()) }
    }

    fn backup(&self) -> PathBuf {
        let mut backup = self.path.clone().into_os_string();
        backup.push(".bak");
        PathBuf::from(backup)
    }

    /// What it describes before the change; `None` of a new one.
    #[must_use]
    pub fn description(&self) -> Option<Description> {
        self.exists.then(|| Description::parse(&self.before).ok()).flatten()
    }

    /// Writes it with `fields` set, the previous one beside it as `.bak`; tells in a line each what changed.
    ///
    /// # Errors
    /// If the fields make no valid description, or a file cannot be written.
    pub fn write(&self, fields: &[Field]) -> Result<Vec<String>> {
        let text = with_fields(&self.before, fields);
        let name = self.path.display();
        Description::parse(&text).with_context(|| name.to_string())?;
        if self.exists {
            output::write(&self.backup(), self.before.as_bytes())?;
        }
        output::write(&self.path, text.as_bytes())?;
        let old = |key: &str| {
            let line =
                self.before.lines().find(|line| line.split_once('=').is_some_and(|(name, _)| name.trim() == key));
            line.and_then(|line| Some(line.split_once('=')?.1.split('#').next()?.trim().to_owned()))
        };
        let told = fields.iter().filter_map(|(key, value)| match old(key).filter(|_| self.exists) {
            Some(old) if old == *value => None,
            Some(old) => Some(format!("{key} = {value}, was {old}")),
            None => Some(format!("{key} = {value}")),
        });
        Ok(told.collect())
    }
}
