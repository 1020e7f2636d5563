//! Files that are read whole: descriptions, tables, programs. What has no end, as a device, is refused in time.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use anyhow::{Result, anyhow, ensure};

/// No text that is read here is longer.
const MAX_TEXT_BYTES: u64 = 64 << 20;

/// The content of a file of at most `most` bytes.
///
/// # Errors
/// If it cannot be read or is longer. The file is named.
pub fn bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    let (name, mut bytes) = (path.display(), Vec::new());
    let read = File::open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes));
    read.map_err(|error| anyhow!("{name}: cannot be read: {error}"))?;
    ensure!(bytes.len() as u64 <= most, "{name}: has more than {} MB, too much for such a file", most >> 20);
    Ok(bytes)
}

/// The content of a text.
///
/// # Errors
/// If it cannot be read, is too long or no text. The file is named.
pub fn text(path: &Path) -> Result<String> {
    String::from_utf8(bytes(path, MAX_TEXT_BYTES)?).map_err(|error| {
        let name = path.display();
        match error.as_bytes() {
            [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => {
                anyhow!("{name}: is no text in UTF-8, but in UTF-16: save it as UTF-8")
            }
            _ => anyhow!("{name}: is no text, but bytes of some other kind"),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_is_too_long_or_no_text_is_refused_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("some.toml");
        fs::write(&path, [b'a'; 16]).unwrap();
        assert_eq!(bytes(&path, 16).unwrap().len(), 16);
        assert!(bytes(&path, 15).unwrap_err().to_string().contains("some.toml: has more"));
        assert_eq!(text(&path).unwrap(), "aaaaaaaaaaaaaaaa");
        for (bytes, told) in [(&[0xff, 0xfe, b'a', 0][..], "in UTF-8, but in UTF-16"), (&[0xff, 0xd8], "bytes")] {
            fs::write(&path, bytes).unwrap();
            let refused = text(&path).unwrap_err().to_string();
            assert!(refused.contains("some.toml: is no text") && refused.contains(told), "{refused}");
        }
        assert!(text(&folder.path().join("none")).unwrap_err().to_string().contains("cannot be read"));
        #[cfg(unix)]
        assert!(text(Path::new("/dev/zero")).unwrap_err().to_string().contains("64 MB"));
    }
}
