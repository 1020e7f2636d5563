//! The axes of the plots.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// An axis: what it measures, from where to where, and where its numbers stand.
#[derive(Debug, Clone)]
pub struct Axis {
    pub(super) label: String,
    pub(super) range: [f64; 2],
    pub(super) ticks: Vec<f64>,
    is_log: bool,
    is_downwards: bool,
}

impl Axis {
    /// A linear axis; `label` with the unit.
    #[must_use]
    pub fn linear(label: &str, range: [f64; 2]) -> Self {
        let range = widened(range);
        Self { label: label.to_owned(), range, ticks: round_numbers(range, 6), is_log: false, is_downwards: false }
    }

    /// A linear axis on which all of `values` have room.
    #[must_use]
    pub fn around(label: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let extent = values.into_iter().filter(|value| value.is_finite());
        let range = extent.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        let range = widened(if range[0] <= range[1] { range } else { [0.0, 1.0] });
        let margin = 0.05 * (range[1] - range[0]);
        Self::linear(label, [range[0] - margin, range[1] + margin])
    }

    /// A logarithmic axis with numbers at the powers of ten; `range` is positive.
    #[must_use]
    pub fn log(label: &str, range: [f64; 2]) -> Self {
        let [low, high] = range.map(f64::log10);
        let ticks = (low.ceil() as i32..=high.floor() as i32).map(|power| 10f64.powi(power)).collect();
        Self { label: label.to_owned(), range, ticks, is_log: true, is_downwards: false }
    }

    /// The same with numbers at `ticks` only.
    #[must_use]
    pub fn with_ticks(self, ticks: impl IntoIterator<Item = f64>) -> Self {
        Self { ticks: ticks.into_iter().collect(), ..self }
    }

    /// The same from its end to its beginning, as rows of a view go.
    #[must_use]
    pub fn downwards(self) -> Self {
        Self { is_downwards: true, ..self }
    }

    /// How far from the axis's beginning a value lies, 0 to 1 within its range.
    fn share(&self, value: f64) -> f64 {
        let place = |value: f64| if self.is_log { value.max(f64::MIN_POSITIVE).log10() } else { value };
        let [low, high] = self.range.map(place);
        let share = (place(value) - low) / (high - low);
        if self.is_downwards { 1.0 - share } else { share }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        // Values beyond the range stay near enough to it for the arithmetic of pixels.
        let share = self.share(*value).clamp(-1.0, 2.0);
        first + (share * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.range[0]..self.range[1]
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        let text = format!("{value:.6}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" { "0".to_owned() } else { text.to_owned() }
    }
}

/// A range with some length, whatever it was.
fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    if low < high { [low, high] } else { [low - 0.5, low + 0.5] }
}

/// About `count` round numbers within `range`.
fn round_numbers([low, high]: [f64; 2], count: u32) -> Vec<f64> {
    let rough = (high - low) / f64::from(count);
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|m| m * power).into_iter().find(|&s| s >= rough).unwrap_or(rough);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last).map(|index| index as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_axes_are_round() {
        assert_eq!(round_numbers([0.0, 255.0], 6), [0.0, 50.0, 100.0, 150.0, 200.0, 250.0]);
        assert_eq!(Axis::log("", [0.5, 2000.0]).ticks, [1.0, 10.0, 100.0, 1000.0]);
        let axis = Axis::linear("", [7.0, 7.0]);
        assert!(axis.range[0] < axis.range[1] && !axis.ticks.is_empty());
        assert_eq!([0.25, -0.0, 1000.0, 20.0].map(|v| axis.format_ext(&v)), ["0.25", "0", "1000", "20"]);
    }

    #[test]
    fn a_logarithmic_axis_gives_every_power_as_much_room() {
        let axis = Axis::log("", [1.0, 1000.0]);
        assert_eq!([1.0, 10.0, 100.0, 1000.0].map(|v| axis.map(&v, (0, 300))), [0, 100, 200, 300]);
        assert_eq!(
            [0.0, 25.0, 100.0].map(|v| Axis::linear("", [0.0, 100.0]).downwards().map(&v, (300, 0))),
            [0, 75, 300]
        );
        assert_eq!(axis.map(&0.0, (0, 300)), -300, "what has no logarithm lies beyond, and is no fault");
    }
}
