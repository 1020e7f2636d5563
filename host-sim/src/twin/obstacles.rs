//! The obstacles that the program found.

use std::collections::BTreeMap;

use anyhow::{Context, Result};

/// Reads lines of a frame's number and each sector's distance, mm or `-`.
///
/// # Errors
/// If it is none such.
pub fn decode(text: &str) -> Result<BTreeMap<u32, Vec<Option<u32>>>> {
    let line = |line: &str| {
        let mut words = line.split(' ');
        let frame = words.next()?.parse().ok()?;
        let distance = |word: &str| if word == "-" { Some(None) } else { word.parse().ok().map(Some) };
        Some((frame, words.map(distance).collect::<Option<_>>()?))
    };
    let wrong = || format!("the program's obstacles are not understood: {text:?}");
    text.lines().map(line).collect::<Option<_>>().with_context(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_a_frame() {
        let found = decode("0 - 1500 -\n3 7\n").unwrap();
        assert_eq!(found, BTreeMap::from([(0, vec![None, Some(1500), None]), (3, vec![Some(7)])]));
        for text in ["x 1", "1 -2", "1  2"] {
            assert!(decode(text).is_err(), "{text}");
        }
    }
}
