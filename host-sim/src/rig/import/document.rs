//! Calibration files as one kind of tree, whatever they are written in.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Error, Result, anyhow, bail, ensure};
use haarline_rig::Description;
use serde_json::{Map, Value};
use yaml_rust2::{ScanError, Yaml, YamlLoader};

/// A file's content.
#[derive(Debug, Clone, PartialEq)]
pub enum Document {
    /// YAML, XML or JSON.
    Tree(Map<String, Value>),
    /// Lines `key: value` or `key=value`.
    Lines(BTreeMap<String, String>),
}

/// Reads a file.
///
/// # Errors
/// If it cannot be read or is in none of these forms.
pub fn read(path: &Path) -> Result<Document> {
    let name = path.display();
    ensure!(!path.is_dir(), "{name}: is a folder, where a calibration file is expected");
    let text = crate::input::whole_file::text(path)?;
    parse(&text).map_err(|error| match Description::parse(&text) {
        Ok(_) => anyhow!("{name}: is a rig description already: give it to --rig"),
        Err(_) => error.context(name.to_string()),
    })
}

/// The content of a text.
///
/// # Errors
/// If it has none of the forms.
pub fn parse(text: &str) -> Result<Document> {
    // Editors put the mark of UTF-8 before it.
    let text = text.trim_start_matches('\u{feff}');
    let begin = text.trim_start();
    ensure!(!begin.is_empty(), "is empty");
    if begin.starts_with('{') {
        return tree_of(serde_json::from_str(text).map_err(|error| no_json(text, &error))?);
    }
    if begin.starts_with('<') {
        return parse_xml(text);
    }
    if let Some(lines) = calibration_lines(text) {
        return Ok(Document::Lines(lines));
    }
    // OpenCV's header is that of no YAML version.
    let without_header: String = text.lines().filter(|line| !line.starts_with('%')).flat_map(|l| [l, "\n"]).collect();
    let documents = YamlLoader::load_from_str(&without_header).map_err(|error| no_yaml(text, &error))?;
    tree_of(documents.first().map_or(Value::Null, of_yaml))
}

fn tree_of(value: Value) -> Result<Document> {
    match value {
        Value::Object(tree) => Ok(Document::Tree(tree)),
        _ => bail!("is no calibration file: it has no names of values"),
    }
}

/// What is wrong with a JSON text: Python's NaN is none, and what ends within is cut off.
fn no_json(text: &str, error: &serde_json::Error) -> Error {
    let (line, column) = (error.line(), error.column());
    if error.is_eof() {
        return anyhow!("is JSON that is cut off: it ends within something at line {line} column {column}");
    }
    let rest = text.lines().nth(line.saturating_sub(1)).and_then(|line| line.get(column.saturating_sub(1)..));
    match ["NaN", "Infinity"].into_iter().find(|&word| rest.is_some_and(|rest| rest.starts_with(word))) {
        Some(word) => anyhow!("{word} at line {line} column {column} is no number: the calibration has failed there"),
        None => anyhow!("is no JSON: {error}"),
    }
}

/// What is wrong with a YAML text, by the line of the file.
fn no_yaml(text: &str, error: &ScanError) -> Error {
    // OpenCV's header is not counted.
    let header = text.lines().take_while(|line| line.starts_with('%')).count();
    let line = error.marker().line() + header;
    let key = error.info().strip_prefix("String(\"").and_then(|info| info.split_once("\"): duplicated key"));
    match key {
        Some((key, _)) => anyhow!("{key} is there twice, at line {line} again: is this two files in one?"),
        None if line > text.lines().count() => anyhow!("is YAML that is cut off: {} at its end", error.info()),
        None => anyhow!("is no YAML: {} at line {line} column {}", error.info(), error.marker().col() + 1),
    }
}

fn of_yaml(yaml: &Yaml) -> Value {
    match yaml {
        Yaml::Real(_) => yaml.as_f64().map_or(Value::Null, number),
        Yaml::Integer(value) => (*value).into(),
        Yaml::String(text) => text.clone().into(),
        Yaml::Boolean(value) => (*value).into(),
        Yaml::Array(items) => items.iter().map(of_yaml).collect(),
        Yaml::Hash(map) => {
            let entry = |(key, value): (&Yaml, &Yaml)| Some((key.as_str()?.to_owned(), of_yaml(value)));
            Value::Object(map.iter().filter_map(entry).collect())
        }
        Yaml::Alias(_) | Yaml::Null | Yaml::BadValue => Value::Null,
    }
}

/// A number; what is none, such as a NaN, stays as its name, so that it is found where it is used.
fn number(value: f64) -> Value {
    serde_json::Number::from_f64(value).map_or_else(|| value.to_string().into(), Value::Number)
}

/// OpenCV's XML: matrices with `rows`, `cols` and `data`, other elements by their text.
fn parse_xml(text: &str) -> Result<Document> {
    let is_cut_off = text.contains("<opencv_storage") && !text.contains("</opencv_storage");
    ensure!(!is_cut_off, "is XML that is cut off: it does not end with </opencv_storage>");
    let document = roxmltree::Document::parse(text).map_err(|error| anyhow!("is no XML: {error}"))?;
    let root = document.root_element();
    ensure!(root.has_tag_name("opencv_storage"), "is XML, but not OpenCV's: its root is <{}>", root.tag_name().name());
    tree_of(of_element(root))
}

fn of_element(element: roxmltree::Node<'_, '_>) -> Value {
    let children: Vec<_> = element.children().filter(roxmltree::Node::is_element).collect();
    if !children.is_empty() {
        let entries = children.into_iter().map(|child| (child.tag_name().name().to_owned(), of_element(child)));
        return Value::Object(entries.collect());
    }
    let words: Vec<&str> = element.text().unwrap_or_default().split_whitespace().collect();
    let parsed: Vec<Option<f64>> = words.iter().map(|word| word.parse().ok()).collect();
    let values = words.iter().zip(&parsed).map(|(&word, parsed)| parsed.map_or_else(|| word.into(), number));
    match values.len() {
        1.. if parsed.iter().all(Option::is_none) => words.join(" ").into(),
        0 => Value::String(String::new()),
        1 => values.collect::<Vec<_>>().remove(0),
        // A word among numbers is found where they are used.
        _ => values.collect(),
    }
}

/// The lines of Middlebury's and KITTI's files; `None` of other texts.
fn calibration_lines(text: &str) -> Option<BTreeMap<String, String>> {
    let mut lines = BTreeMap::new();
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        let (key, value) = line.split_once('=').or_else(|| line.split_once(':'))?;
        let key = key.trim();
        if key.is_empty() || !key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
            return None;
        }
        lines.insert(key.to_owned(), value.trim().to_owned());
    }
    let is_known = |key: &str| key == "cam0" || key.starts_with("P_rect_") || ["P0", "P1", "P2", "P3"].contains(&key);
    lines.iter().any(|(key, value)| is_known(key) && value.split_whitespace().count() >= 9).then_some(lines)
}

/// All numbers of a value: a list, a list of lists, or a matrix with `data`.
///
/// # Errors
/// If something in it is no finite number.
pub fn numbers(name: &str, value: &Value) -> Result<Vec<f64>> {
    match value {
        Value::Number(number) => Ok(vec![number.as_f64().context("a number")?]),
        Value::Array(items) => {
            let lists = items.iter().map(|item| numbers(name, item)).collect::<Result<Vec<_>>>()?;
            Ok(lists.concat())
        }
        Value::Object(matrix) => numbers(name, matrix.get("data").with_context(|| format!("{name}: has no data"))?),
        Value::String(word) if is_not_finite(word) => bail!("{name}: {word} is no number"),
        Value::String(word) => bail!("{name}: {word:?} is text, where a number is expected"),
        Value::Null => bail!("{name}: has nothing where a number is expected"),
        Value::Bool(_) => bail!("{name}: is no number"),
    }
}

/// Whether a word is what calculations that fail leave, as YAML, OpenCV or Python writes it.
fn is_not_finite(word: &str) -> bool {
    let word = word.trim_start_matches(['-', '+', '.']).to_lowercase();
    ["nan", "inf", "infinity"].contains(&word.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree(text: &str) -> Map<String, Value> {
        match parse(text).unwrap() {
            Document::Tree(tree) => tree,
            Document::Lines(lines) => panic!("{lines:?}"),
        }
    }

    #[test]
    fn the_same_matrix_is_read_from_yaml_xml_and_json() {
        let yaml = "%YAML:1.0\n---\nM: !!opencv-matrix\n   rows: 1\n   cols: 3\n   dt: d\n   data: [ 1., 2.5e+00,\n       -3 ]\n";
        let xml = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<M type_id=\"opencv-matrix\">\n  <rows>1</rows>\n  <cols>3</cols>\n  \
                   <dt>d</dt>\n  <data>\n    1. 2.5 -3.</data></M>\n</opencv_storage>\n";
        let json = "{\"M\": [[1.0], [2.5], [-3]]}";
        for text in [yaml, xml, json] {
            assert_eq!(numbers("M", &tree(text)["M"]).unwrap(), [1.0, 2.5, -3.0], "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_told_by_name() {
        let told = numbers("K", &tree("K: [1.0, .nan]\n")["K"]).unwrap_err().to_string();
        assert_eq!(told, "K: NaN is no number");
        for text in ["- 1\n- 2\n", "just words\n", "<a/>", "{\"a\": ", "[1, 2]"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn lines_of_middlebury_and_kitti_are_told_from_yaml() {
        let lines = |text: &str| matches!(parse(text), Ok(Document::Lines(_)));
        assert!(lines("cam0=[1 0 2; 0 1 3; 0 0 1]\ndoffs=3\n") && lines("P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: 1 2\n"));
        assert!(!lines("image_width: 3\nimage_height: 4\n"));
    }
}
