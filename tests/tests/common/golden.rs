//! Golden maps: the exact answers to small scenes, regenerated on purpose.

use std::fmt::Write;
use std::path::PathBuf;
use std::{env, fs};

use super::map::Map;

/// Environment variable that has the golden files written instead of compared.
const REGENERATE: &str = "HAARLINE_REGENERATE";

/// Compares a map with the golden file of that name.
pub fn compare(name: &str, map: &Map) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden").join(format!("{name}.txt"));
    let text = to_text(map);
    if env::var_os(REGENERATE).is_some() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        return;
    }
    let hint =
        format!("if that is on purpose: {REGENERATE}=1 cargo test -p haarline-tests golden, and review the diff");
    let golden = fs::read_to_string(&path).unwrap_or_else(|error| panic!("golden/{name}.txt: {error}; {hint}"));
    let rows = text.lines().zip(golden.lines()).skip(1).enumerate();
    let different: Vec<usize> = rows.filter(|(_, (found, golden))| found != golden).map(|(y, _)| y).collect();
    assert!(
        different.is_empty(),
        "{} rows differ from golden/{name}.txt, from {} on; {hint}",
        different.len(),
        different[0]
    );
    assert_eq!(text.lines().count(), golden.lines().count(), "rows of golden/{name}.txt; {hint}");
}

/// One line for each row: disparity in 1/16 px with four hex digits, `----` where it is unknown, and
/// confidence with two.
fn to_text(map: &Map) -> String {
    let mut text =
        format!("{} x {}: disparity in 1/16 px (4 hex digits), confidence (2), row by row\n", map.width, map.rows);
    for y in 0..map.rows {
        let (disparity, confidence) = map.row(y);
        for (disparity, confidence) in disparity.iter().zip(confidence) {
            match disparity {
                Some(bits) => write!(text, "{bits:04x}{confidence:02x}").unwrap(),
                None => write!(text, "----{confidence:02x}").unwrap(),
            }
        }
        text.push('\n');
    }
    text
}
