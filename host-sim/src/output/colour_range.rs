//! Which disparities the colours of a picture span.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use image::Rgb;

use crate::DisparityMap;
use crate::stereo::disparity_map::px;

/// The disparities that the colours span, px; what lies outside has the colour of the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourRange {
    /// Disparity of the first colour.
    pub min_px: f64,
    /// Disparity of the last colour, greater than `min_px`.
    pub max_px: f64,
}

impl ColourRange {
    /// Spans what is known in `map` but for the outermost half percent, out to whole px.
    #[must_use]
    pub fn of(map: &DisparityMap) -> Self {
        let mut found = Spectrum::default();
        found.add(map);
        found.range()
    }

    /// The colour of a disparity: from blue for far to red for near. No grey is among them.
    pub(super) fn colour(&self, disparity_px: f64) -> Rgb<u8> {
        // Without the map's dark ends, which look too much like unknown pixels.
        Rgb(colorous::TURBO.eval_continuous(0.08 + 0.88 * self.place(disparity_px)).into_array())
    }

    /// The grey of a disparity: 1 for far to 255 for near.
    pub(super) fn grey(&self, disparity_px: f64) -> u8 {
        (1.0 + 254.0 * self.place(disparity_px)).round() as u8
    }

    /// Where in the range a disparity lies, 0 to 1.
    fn place(&self, disparity_px: f64) -> f64 {
        ((disparity_px - self.min_px) / (self.max_px - self.min_px)).clamp(0.0, 1.0)
    }
}

impl FromStr for ColourRange {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const FORM: &str = "must be A..B, two disparities in px, the first one less, as in 2..40";
        let (min, max) = text.split_once("..").ok_or(FORM)?;
        let number = |text: &str| text.parse::<f64>().ok().filter(|px| px.abs() <= 1000.0).ok_or(FORM);
        let range = Self { min_px: number(min)?, max_px: number(max)? };
        if range.max_px > range.min_px { Ok(range) } else { Err(FORM) }
    }
}

impl fmt::Display for ColourRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}..{}", self.min_px, self.max_px)
    }
}

/// How often each disparity came in some maps.
#[derive(Debug, Clone, Default)]
pub struct Spectrum {
    counts: BTreeMap<i16, u64>,
}

impl Spectrum {
    /// Counts the known disparities of a map.
    pub fn add(&mut self, map: &DisparityMap) {
        for bits in map.known() {
            *self.counts.entry(bits).or_default() += 1;
        }
    }

    /// Spans what came but for the outermost half percent, out to whole px.
    #[must_use]
    pub fn range(&self) -> ColourRange {
        let total: u64 = self.counts.values().sum();
        let tail = total / 200;
        let (Some(first), Some(last)) = (beyond(self.counts.iter(), tail), beyond(self.counts.iter().rev(), tail))
        else {
            return ColourRange { min_px: 0.0, max_px: 1.0 };
        };
        let (min_px, max_px) = (px(first).floor(), px(last).ceil());
        ColourRange { min_px, max_px: max_px.max(min_px + 1.0) }
    }
}

/// The first of `counts` with which more than `tail` came.
fn beyond<'a>(counts: impl Iterator<Item = (&'a i16, &'a u64)>, tail: u64) -> Option<i16> {
    let mut sum = 0;
    counts.into_iter().find_map(|(&bits, count)| {
        sum += count;
        (sum > tail).then_some(bits)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::Disparity;

    fn map(px: &[i16]) -> DisparityMap {
        let disparity = px.iter().map(|&px| Disparity::from_px(px)).collect();
        DisparityMap { width: px.len(), height: 1, disparity, confidence: vec![1; px.len()] }
    }

    #[test]
    fn the_outermost_half_percent_does_not_count() {
        let values = |outliers: usize| [vec![5; 500], vec![9; 500 - outliers], vec![40; outliers]].concat();
        assert_eq!(ColourRange::of(&map(&values(5))), ColourRange { min_px: 5.0, max_px: 9.0 });
        assert_eq!(ColourRange::of(&map(&values(6))), ColourRange { min_px: 5.0, max_px: 40.0 });
        assert_eq!(ColourRange::of(&map(&[7; 9])), ColourRange { min_px: 7.0, max_px: 8.0 });
        assert_eq!(ColourRange::of(&map(&[])), ColourRange { min_px: 0.0, max_px: 1.0 });
    }

    #[test]
    fn grey_spans_the_range() {
        let range = ColourRange { min_px: -2.0, max_px: 2.0 };
        let cases = [(-3.0, 1), (-2.0, 1), (0.0, 128), (2.0, 255), (9.0, 255)];
        for (disparity, wanted) in cases {
            assert_eq!(range.grey(disparity), wanted, "{disparity} px");
        }
    }

    #[test]
    fn colours_are_never_grey() {
        let range = ColourRange { min_px: 0.0, max_px: 100.0 };
        for step in 0..=100 {
            let Rgb(colour) = range.colour(f64::from(step));
            let spread = colour.iter().max().unwrap() - colour.iter().min().unwrap();
            assert!(spread > 60, "{step}: {colour:?}");
        }
    }

    #[test]
    fn a_range_is_two_numbers_the_first_one_less() {
        assert_eq!("-4..40.5".parse(), Ok(ColourRange { min_px: -4.0, max_px: 40.5 }));
        for text in ["", "3", "3..", "..3", "3..3", "4..3", "a..b", "nan..3", "0..inf", "-1e9..3"] {
            assert!(text.parse::<ColourRange>().is_err(), "{text}");
        }
    }
}
