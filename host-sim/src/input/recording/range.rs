//! Which frames of a recording.

use std::fmt;
use std::str::FromStr;

/// A choice of frames by index: from the first up to, but not including, the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FrameRange {
    first: usize,
    end: Option<usize>,
}

impl FrameRange {
    /// Every `step`-th of `frames` from the first on that the range has; none where it begins after
    /// the last one.
    ///
    /// # Panics
    /// If `step` is 0.
    #[must_use]
    pub fn choose<T>(&self, frames: Vec<T>, step: usize) -> Vec<T> {
        let end = self.end.unwrap_or(frames.len());
        frames.into_iter().take(end).skip(self.first).step_by(step).collect()
    }
}

impl FromStr for FrameRange {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const FORM: &str = "must be A..B, A.. or ..B, with frames counted from 0";
        let (first, end) = text.split_once("..").ok_or(FORM)?;
        let number = |text: &str| text.parse::<usize>().map_err(|_| FORM);
        let first = if first.is_empty() { 0 } else { number(first)? };
        let end = if end.is_empty() { None } else { Some(number(end)?) };
        if end.is_some_and(|end| end <= first) {
            return Err("holds no frame: the end, which does not belong to it, must be greater than the first");
        }
        Ok(Self { first, end })
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.first, self.end) {
            (first, Some(end)) => write!(f, "{first}..{end}"),
            (first, None) => write!(f, "{first}.."),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(range: &str, step: usize) -> Vec<usize> {
        range.parse::<FrameRange>().unwrap().choose((0..10).collect(), step)
    }

    #[test]
    fn ranges_are_half_open_and_may_lack_an_end() {
        assert_eq!(choice("2..5", 1), [2, 3, 4]);
        assert_eq!(choice("7..", 1), [7, 8, 9]);
        assert_eq!(choice("..2", 1), [0, 1]);
        assert_eq!(choice("..", 4), [0, 4, 8]);
        assert_eq!(choice("1..8", 3), [1, 4, 7]);
        assert_eq!(choice("8..99", 1), [8, 9]);
        assert!(choice("10..", 1).is_empty());
        for text in ["", "3", "5..5", "5..2", "..0", "a..b", "-1..3", "1...3", "1..2..3", "0..99999999999999999999999"]
        {
            assert!(text.parse::<FrameRange>().is_err(), "{text:?}");
        }
    }
}
