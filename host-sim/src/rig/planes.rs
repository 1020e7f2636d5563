//! A table of where a plane stood, frame by frame.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use csv::StringRecord;

/// Where a plane stood in a frame, square before the left camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneLine {
    /// Its depth, m.
    pub depth_m: f64,
    /// First and last column of the left view in which it stood, if that is told; beyond the view, too.
    pub columns: Option<[f64; 2]>,
    /// First and last row.
    pub rows: Option<[f64; 2]>,
}

/// Reads a table with a heading: `depth_m` and, where they are told, `frame` (from 0; without it a line is a frame),
/// `first_column`, `last_column`, `first_row`, `last_row`. Other columns do not count; a frame without depth has no plane.
///
/// # Errors
/// Names the file, the line and what is wrong.
pub fn read(path: &Path) -> Result<BTreeMap<usize, PlaneLine>> {
    let name = path.display();
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path);
    let reader = reader.as_mut().map_err(|error| anyhow::anyhow!("{name}: cannot be read: {error}"))?;
    let heading = reader.headers().with_context(|| name.to_string())?.clone();
    let place = |column: &str| heading.iter().position(|found| found == column);
    ensure!(
        place("depth_m").is_some(),
        "{name}: has no column depth_m; there may be frame, depth_m, first_column, last_column, first_row, last_row"
    );
    let mut lines = BTreeMap::new();
    for (nth, record) in reader.records().enumerate() {
        let record = record.with_context(|| name.to_string())?;
        let at = |what: &str| format!("{name}: line {}: {what}", nth + 2);
        let number = |column: &str| field(&record, place(column)).with_context(|| at(column));
        let Some(depth_m) = number("depth_m")? else { continue };
        ensure!((0.05..=1000.0).contains(&depth_m), at(&format!("depth_m {depth_m}: must be 0.05 to 1000 m")));
        let range = |first: &str, last: &str| -> Result<Option<[f64; 2]>> {
            let range = number(first)?.zip(number(last)?).map(|(first, last)| [first, last]);
            ensure!(
                range.is_none_or(|[first, last]| first <= last),
                at(&format!("{first} must not be more than {last}"))
            );
            Ok(range)
        };
        let frame = match number("frame")? {
            Some(frame) => {
                ensure!(frame >= 0.0 && frame.fract() == 0.0, at("frame: must be a whole number from 0"));
                frame as usize
            }
            None => nth,
        };
        let line = PlaneLine {
            depth_m,
            columns: range("first_column", "last_column")?,
            rows: range("first_row", "last_row")?,
        };
        ensure!(lines.insert(frame, line).is_none(), at(&format!("frame {frame} is there twice")));
    }
    ensure!(!lines.is_empty(), "{name}: tells no depth");
    Ok(lines)
}

/// A number, if the column is there and not empty.
fn field(record: &StringRecord, column: Option<usize>) -> Result<Option<f64>> {
    let Some(text) = column.and_then(|column| record.get(column)).filter(|text| !text.is_empty()) else {
        return Ok(None);
    };
    let number: f64 = text.parse().with_context(|| format!("{text:?}: must be a number"))?;
    ensure!(number.is_finite(), "{text:?}: must be a number");
    Ok(Some(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<BTreeMap<usize, PlaneLine>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("planes.csv");
        std::fs::write(&path, text).unwrap();
        read(&path)
    }

    #[test]
    fn a_line_is_a_frame_unless_it_tells_another() {
        let lines = read_text("depth_m,first_column,last_column\n3.0,-4,20.5\n,,\n1.5,,\n").unwrap();
        assert_eq!(lines.keys().copied().collect::<Vec<_>>(), [0, 2]);
        assert_eq!(lines[&0], PlaneLine { depth_m: 3.0, columns: Some([-4.0, 20.5]), rows: None });
        assert_eq!(lines[&2].columns, None);
        let lines = read_text("frame,what,depth_m\n7,wall,2\n").unwrap();
        assert_eq!(lines[&7].depth_m, 2.0);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (text, wanted) in [
            ("range\n3\n", "has no column depth_m"),
            ("depth_m\n", "tells no depth"),
            ("depth_m\n2\nfar\n", "line 3: depth_m: \"far\": must be a number"),
            ("depth_m\nNaN\n", "line 2: depth_m: \"NaN\": must be a number"),
            ("depth_m\n-1\n", "line 2: depth_m -1: must be 0.05 to 1000 m"),
            ("depth_m,frame\n2,0\n2,0\n", "line 3: frame 0 is there twice"),
            ("depth_m,first_row,last_row\n2,5,4\n", "line 2: first_row must not be more than last_row"),
        ] {
            let told = format!("{:#}", read_text(text).unwrap_err());
            assert!(told.contains(wanted), "{told}");
        }
    }
}
