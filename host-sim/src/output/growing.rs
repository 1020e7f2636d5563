//! Files that grow while a command runs: what was added is in them, whatever becomes of the run.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Result;
use serde::Serialize;

use super::cannot_write;

/// A file to which whole rows or messages are added, each by one write to the system.
#[derive(Debug)]
pub struct GrowingFile {
    path: PathBuf,
    file: File,
}

impl GrowingFile {
    /// Begins the file `path` anew.
    ///
    /// # Errors
    /// Names the file.
    pub fn create(path: &Path) -> Result<Self> {
        let file = File::create(path).map_err(|error| cannot_write(path, error))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Adds `bytes` at its end.
    ///
    /// # Errors
    /// Names the file.
    pub fn add(&mut self, bytes: &[u8]) -> Result<()> {
        self.file.write_all(bytes).map_err(|error| cannot_write(&self.path, error))
    }
}

/// A table (CSV) that grows by rows; the fields of the first one head it.
#[derive(Debug)]
pub struct GrowingTable {
    file: GrowingFile,
    is_headed: bool,
}

impl GrowingTable {
    /// Begins the table `path` anew.
    ///
    /// # Errors
    /// Names the file.
    pub fn create(path: &Path) -> Result<Self> {
        Ok(Self { file: GrowingFile::create(path)?, is_headed: false })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Names the file.
    pub fn add(&mut self, row: &impl Serialize) -> Result<()> {
        let has_headers = !std::mem::replace(&mut self.is_headed, true);
        let mut writer = csv::WriterBuilder::new().has_headers(has_headers).from_writer(Vec::new());
        writer.serialize(row)?;
        self.file.add(&writer.into_inner()?)
    }

    /// Adds a row of `fields`, which no heads are made of.
    ///
    /// # Errors
    /// Names the file.
    pub fn add_record(&mut self, fields: &[String]) -> Result<()> {
        self.is_headed = true;
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(fields)?;
        self.file.add(&writer.into_inner()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[derive(Serialize)]
    struct Row {
        name: &'static str,
        value: Option<u32>,
    }

    #[test]
    fn each_row_is_there_as_soon_as_it_is_added() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        fs::write(&path, "an older table").unwrap();
        let mut table = GrowingTable::create(&path).unwrap();
        let wanted = ["name,value\na,1\n", "name,value\na,1\n\"b, c\",\n"];
        for (row, wanted) in [("a", Some(1)), ("b, c", None)].into_iter().zip(wanted) {
            table.add(&Row { name: row.0, value: row.1 }).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), wanted);
        }
        assert!(GrowingFile::create(folder.path()).unwrap_err().to_string().contains("cannot be written"));
    }
}
