//! The fields of a description: name, meaning, range and unit of each, in one place.

use haarline::Correction;
use toml::{Table, Value};

use crate::RigError;

/// What a field may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Range {
    /// One of these words.
    Words(&'static [&'static str]),
    /// A whole number between two, these included.
    Whole(i64, i64),
    /// A number between two, these included.
    Real(f64, f64),
    /// So many numbers, one of these counts, each between two.
    List(&'static [usize], f64, f64),
    /// Rows of the same number of numbers: 1 to 25 of 2 to 33.
    Table(f64, f64),
}

/// A field of a description.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Field {
    pub(crate) name: &'static str,
    about: &'static str,
    range: Range,
    unit: &'static str,
    /// Its value in the template.
    example: &'static str,
    /// Whether it may be left out; the example's value holds then, or none where the example is empty.
    optional: bool,
}

const fn field(
    name: &'static str,
    about: &'static str,
    range: Range,
    unit: &'static str,
    example: &'static str,
    optional: bool,
) -> Field {
    Field { name, about, range, unit, example, optional }
}

use Range::{List, Real, Table as Rows, Whole, Words};

/// All of them, in the order of the template.
#[rustfmt::skip]
pub(crate) const FIELDS: [Field; 31] = [
    field("wiring", "how the two cameras share the port", Words(&["pixel", "line", "side-by-side", "nibble", "pairs16", "pairs14"]), "", "\"pixel\"", false),
    field("first", "the camera that comes first: in time, in the left half, on the low data lines", Words(&["left", "right"]), "", "\"left\"", true),
    field("skew", "the camera whose pixels come one late; with wiring = \"pixel\" only", Words(&["none", "left", "right"]), "", "\"none\"", true),
    field("width", "columns of one view", Whole(32, 1280), "px", "320", false),
    field("height", "rows of one view", Whole(8, 4096), "px", "240", false),
    field("frame_rate_hz", "frames that a board lets the cameras take", Whole(1, 120), "1/s", "5", true),
    field("exposure_lines", "integration time that a board sets in both cameras; 0: the first one's own control, copied to the second", Whole(0, 65_535), "lines", "0", true),
    field("row_offset", "what the left view shows in a row, the right one shows so many rows lower, in its middle column; haarline align finds it", Real(-16.0, 16.0), "px", "0.0", true),
    field("roll_deg", "roll of the right camera: what it shows to the right lies lower; haarline align finds it", Real(-5.0, 5.0), "degrees", "0.0", true),
    field("scale_percent", "how much higher than the left view the right one is; haarline align finds it", Real(-5.0, 5.0), "percent", "0.0", true),
    field("column_offset", "the right view shows everything so many columns too far right", Whole(-128, 128), "px", "0", true),
    field("focal_px", "focal length of the rectified views", Real(10.0, 10_000.0), "px", "200.0", false),
    field("cx", "column of the left camera's axis in the rectified view; the middle where it is left out", Real(-10_000.0, 10_000.0), "px", "", true),
    field("cy", "row of the left camera's axis in the rectified view; the middle where it is left out", Real(-10_000.0, 10_000.0), "px", "", true),
    field("doffs", "column of the right camera's axis less that of the left one: depth = focal_px x baseline_mm / (disparity + doffs)", Real(-256.0, 256.0), "px", "0.0", true),
    field("baseline_mm", "distance of the two cameras", Real(1.0, 10_000.0), "mm", "60.0", false),
    field("min_disparity", "least disparity that is searched", Whole(-128, 128), "px", "0", true),
    field("num_disparities", "how many disparities are searched from there on; not more than the width", Whole(1, 256), "px", "48", false),
    field("camera_height_mm", "height of the cameras over the ground", Whole(0, 10_000), "mm", "300", false),
    field("pitch_deg", "where the cameras look: 0 is level, upwards is positive", Real(-60.0, 60.0), "degrees", "0.0", false),
    field("lowest_mm", "what is lower over the ground than this is no obstacle", Whole(-10_000, 10_000), "mm", "60", false),
    field("highest_mm", "what is higher over the ground than this is no obstacle", Whole(-10_000, 10_000), "mm", "500", false),
    field("lens", "how the lenses bend: OpenCV's k1, k2, p1, p2, k3 to k6, or fisheye's k1 to k4; haarline rig import writes this and what follows", Words(&["radtan", "equidistant"]), "", "\"radtan\"", true),
    field("left_camera", "the left camera before rectification: focal lengths and axis, fx, fy, cx, cy", List(&[4], -1e5, 1e5), "px", "", true),
    field("left_lens", "its lens", List(&[0, 2, 4, 5, 8], -1e6, 1e6), "", "", true),
    field("left_turn", "its rotation into the rectified view: axis times angle", List(&[3], -2.0, 2.0), "radians", "", true),
    field("right_camera", "the right camera before rectification: focal lengths and axis, fx, fy, cx, cy", List(&[4], -1e5, 1e5), "px", "", true),
    field("right_lens", "its lens", List(&[0, 2, 4, 5, 8], -1e6, 1e6), "", "", true),
    field("right_turn", "its rotation into the rectified view: axis times angle", List(&[3], -2.0, 2.0), "radians", "", true),
    field("disparity_correction", "added to disparities, by column and row: rows of nodes at even distances from border to border", Rows(-64.0, 64.0), "px", "", true),
    field("sector_deg", "angle of each sector of which the nearest obstacle is told", Whole(1, 15), "degrees", "5", true),
];

impl Field {
    /// What it may be, with its unit.
    fn allowed(&self) -> String {
        match self.range {
            Words(words) => format!("one of \"{}\"", words.join("\", \"")),
            Whole(least, most) => format!("a whole number, {least} to {most} {}", self.unit),
            Real(least, most) => format!("{least} to {most} {}", self.unit),
            List(counts, least, most) => {
                let counts: Vec<String> = counts.iter().map(ToString::to_string).collect();
                format!("[{} numbers], each {least} to {most} {}", counts.join(", "), self.unit).trim_end().to_owned()
            }
            Rows(least, most) => {
                format!("[[...], ...], 1 to 25 rows of 2 to 33 numbers each, {least} to {most} {}", self.unit)
            }
        }
    }

    fn holds(&self, value: &Value) -> bool {
        match (self.range, value) {
            (Words(words), Value::String(word)) => words.contains(&word.as_str()),
            (Whole(least, most), Value::Integer(value)) => (least..=most).contains(value),
            (Real(least, most), _) => number(value).is_some_and(|value| (least..=most).contains(&value)),
            (List(counts, least, most), Value::Array(values)) => {
                counts.contains(&values.len()) && are_between(values, least, most)
            }
            (Rows(least, most), Value::Array(rows)) => {
                let columns = rows.first().and_then(Value::as_array).map_or(0, Vec::len);
                let is_row = |row: &Value| {
                    row.as_array().is_some_and(|row| row.len() == columns && are_between(row, least, most))
                };
                let [across, down] = Correction::MAX_NODES;
                (2..=across).contains(&columns) && (1..=down).contains(&rows.len()) && rows.iter().all(is_row)
            }
            _ => false,
        }
    }
}

fn are_between(values: &[Value], least: f64, most: f64) -> bool {
    values.iter().all(|value| number(value).is_some_and(|value| (least..=most).contains(&value)))
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(value) => Some(*value),
        #[expect(clippy::cast_precision_loss, reason = "no field has a range where it matters")]
        Value::Integer(value) => Some(*value as f64),
        _ => None,
    }
}

/// A description with comments, to be filled in. It is valid as it is.
#[must_use]
pub fn template() -> String {
    let mut text =
        "# A pair of cameras and how it stands. `haarline rig show` tells what follows from it.\n".to_owned();
    for field in FIELDS {
        let optional = if field.optional { "; may be left out" } else { "" };
        let (name, about, allowed) = (field.name, field.about, field.allowed());
        let line = if field.example.is_empty() { format!("# {name} =") } else { format!("{name} = {}", field.example) };
        text += &format!("\n# {about}:\n# {allowed}{optional}\n{line}\n");
    }
    text
}

/// The text of a description with some fields set: in their lines where they have some, at the end otherwise; all other
/// lines stay.
#[must_use]
pub fn with_fields(text: &str, fields: &[(&str, String)]) -> String {
    let mut left: Vec<_> = fields.iter().collect();
    let mut lines: Vec<String> = Vec::new();
    for line in text.lines() {
        let key = line.split_once('=').map(|(key, _)| key.trim().trim_start_matches('#').trim());
        let is_set = !line.trim_start().starts_with('#');
        // A field's line, or the empty one of the template in its place.
        let place = left.iter().position(|(name, _)| {
            key == Some(*name) && (is_set || (line.trim_end().ends_with('=') && !has_line(text, name)))
        });
        match place.map(|place| left.remove(place)) {
            Some((name, value)) => {
                let comment = line.split_once('#').filter(|_| is_set).map(|(_, words)| format!("  #{words}"));
                lines.push(format!("{name} = {value}{}", comment.unwrap_or_default()));
            }
            None => lines.push(line.to_owned()),
        }
    }
    lines.extend(left.into_iter().map(|(name, value)| format!("{name} = {value}")));
    lines.join("\n") + "\n"
}

fn has_line(text: &str, name: &str) -> bool {
    text.lines().any(|line| line.split_once('=').is_some_and(|(key, _)| key.trim() == name))
}

/// The fields of a description, each within its range.
#[derive(Debug)]
pub(crate) struct Values(Table);

impl Values {
    pub(crate) fn parse(text: &str) -> Result<Self, RigError> {
        let mut table: Table = text.parse().map_err(|error: toml::de::Error| not_toml(text, &error))?;
        let names: Vec<&str> = FIELDS.iter().map(|field| field.name).collect();
        if let Some(key) = table.keys().find(|key| !names.contains(&key.as_str())) {
            return Err(format!("{key}: no such field; there are {}", names.join(", ")).into());
        }
        for field in &FIELDS {
            let name = field.name;
            if field.optional && !table.contains_key(name) {
                if field.example.is_empty() {
                    continue;
                }
                let example: Table =
                    format!("{name} = {}", field.example).parse().map_err(|_| format!("{name}: no default"))?;
                table.extend(example);
            }
            match table.get(name) {
                None => return Err(format!("{name} is missing: {}; {}", field.about, field.allowed()).into()),
                Some(value) if !field.holds(value) => {
                    let value = value.to_string();
                    return Err(format!("{name} = {value}: must be {}", field.allowed()).into());
                }
                Some(_) => {}
            }
        }
        Ok(Self(table))
    }

    pub(crate) fn word(&self, name: &str) -> &str {
        self.0.get(name).and_then(Value::as_str).unwrap_or_default()
    }

    /// A whole number; of a type that its range fits.
    pub(crate) fn whole<T: TryFrom<i64> + Default>(&self, name: &str) -> T {
        let value = self.0.get(name).and_then(Value::as_integer);
        value.and_then(|value| T::try_from(value).ok()).unwrap_or_default()
    }

    pub(crate) fn real(&self, name: &str) -> f64 {
        self.try_real(name).unwrap_or_default()
    }

    /// Numbers that may be missing.
    pub(crate) fn list(&self, name: &str) -> Option<Vec<f64>> {
        Some(self.0.get(name)?.as_array()?.iter().filter_map(number).collect())
    }

    /// Rows of numbers; none where they are missing.
    pub(crate) fn rows(&self, name: &str) -> Vec<Vec<f64>> {
        let rows = self.0.get(name).and_then(Value::as_array).into_iter().flatten();
        rows.filter_map(Value::as_array).map(|row| row.iter().filter_map(number).collect()).collect()
    }

    /// A number that may be missing.
    pub(crate) fn try_real(&self, name: &str) -> Option<f64> {
        self.0.get(name).and_then(number)
    }
}

/// The parser's words in one line, with the line that is meant.
fn not_toml(text: &str, error: &toml::de::Error) -> RigError {
    let start = error.span().map_or(0, |span| span.start);
    let line = 1 + text.get(..start).unwrap_or(text).matches('\n').count();
    let words: Vec<&str> = error.message().split_whitespace().collect();
    format!("line {line}: {}; must be lines of the kind focal_px = 200.0", words.join(" ")).into()
}
