//! The two forms of the Haar transform on synthetic structures, fine and coarse.

use haarline::haar::{forward, inverse, sliding_response};

/// The half-supports, px: those of the decimated transform's levels 1 to 5.
pub(super) const HALF_SUPPORTS: [usize; 5] = [1, 2, 4, 8, 16];
/// Widths of the synthetic fine structure, px.
pub(super) const BARS: [usize; 4] = [1, 2, 4, 8];
/// Width of the synthetic coarse structure, px.
pub(super) const OBJECT: usize = 40;
/// Grey level of the synthetic background.
const GROUND: u8 = 60;
/// How far the structures stand out from it, grey levels.
pub(super) const HEIGHT: u8 = 100;
/// Columns of a synthetic row, and where a bar or the object begins in its own.
const ROW: usize = 256;
pub(super) const BAR_AT: usize = 64;
const OBJECT_AT: usize = 144;

/// The two forms of the transform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Undecimated,
    Decimated,
}

/// The peaks of a structure over its places in the row, grey levels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peak {
    pub(super) least: f64,
    pub(super) mean: f64,
    pub(super) most: f64,
}

impl Peak {
    fn of(peaks: &[f64]) -> Self {
        Self {
            least: peaks.iter().copied().fold(f64::INFINITY, f64::min),
            mean: peaks.iter().sum::<f64>() / peaks.len() as f64,
            most: peaks.iter().copied().fold(0.0, f64::max),
        }
    }
}

/// What a support leaves of a bar and of the object.
#[derive(Debug, Clone, Copy)]
pub(super) struct Left {
    pub(super) fine: Peak,
    pub(super) coarse: Peak,
}

impl Left {
    /// The mean peak of the bar over that of the object.
    pub(super) fn ratio(&self) -> f64 {
        self.fine.mean / self.coarse.mean
    }
}

/// For each half-support.
pub(super) type Fall = [Left; HALF_SUPPORTS.len()];

impl Form {
    pub(super) const ALL: [Self; 2] = [Self::Undecimated, Self::Decimated];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Undecimated => "undecimated",
            Self::Decimated => "decimated, a1 = 0",
        }
    }

    /// The magnitudes of what the transform leaves of `row`, grey levels.
    fn transform(self, row: &[u8], level: usize) -> Vec<f64> {
        match self {
            Self::Undecimated => magnitudes(row, HALF_SUPPORTS[level]),
            Self::Decimated => contours_of_level(row, level).iter().map(|&v| f64::from(v).abs()).collect(),
        }
    }

    /// How the peak of a bar falls against that of the object.
    pub(super) fn fall(self, bar: usize) -> Fall {
        std::array::from_fn(|level| {
            let s = HALF_SUPPORTS[level];
            let places = if self == Self::Decimated { 2 * s } else { 1 };
            let peaks = |first: usize, width: usize| {
                let peak = |place| {
                    let contours = self.transform(&raised(first + place, width), level);
                    // Far from the row's ends, which some places cut a pair short at.
                    contours[2 * s..ROW - 2 * s].iter().copied().fold(0.0, f64::max)
                };
                Peak::of(&(0..places).map(peak).collect::<Vec<_>>())
            };
            Left { fine: peaks(BAR_AT, bar), coarse: peaks(OBJECT_AT, OBJECT) }
        })
    }
}

/// A row with one structure.
pub(super) fn raised(first: usize, width: usize) -> Vec<u8> {
    let is_raised = |x: &usize| (first..first + width).contains(x);
    (0..ROW).map(|x| if is_raised(&x) { GROUND + HEIGHT } else { GROUND }).collect()
}

/// The sliding response of `row` divided by `s`.
pub(super) fn mean_differences(row: &[u8], s: usize) -> Vec<f64> {
    let mut response = vec![0; row.len()];
    sliding_response(row, s, &mut response);
    response.iter().map(|&value| f64::from(value) / s as f64).collect()
}

pub(super) fn magnitudes(row: &[u8], s: usize) -> Vec<f64> {
    mean_differences(row, s).into_iter().map(f64::abs).collect()
}

/// What the detail of one level alone leaves of a row: eq. 1 with the approximation set to zero, level 0 the
/// finest.
fn contours_of_level(row: &[u8], level: usize) -> Vec<i16> {
    let mut line: Vec<i16> = row.iter().map(|&value| value.into()).collect();
    let mut lengths = Vec::new();
    let mut detail = Vec::new();
    for _ in 0..=level {
        let mut approximation = vec![0; line.len().div_ceil(2)];
        detail = vec![0; line.len() / 2];
        forward(&line, &mut approximation, &mut detail);
        lengths.push(line.len());
        line = approximation;
    }
    let mut back = vec![0; line.len()];
    for length in lengths.into_iter().rev() {
        let mut finer = vec![0; length];
        inverse(&back, &detail, &mut finer);
        // The finer details are left out, too: all zero, and at most as many.
        detail = vec![0; length];
        back = finer;
    }
    back
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_falls_as_its_width_over_the_support() {
        for (bar, fall) in BARS.iter().zip(BARS.map(|bar| Form::Undecimated.fall(bar))) {
            for (s, ratio) in HALF_SUPPORTS.iter().zip(fall) {
                let theory = (*bar).min(*s) as f64 / *s as f64;
                let found = ratio.ratio();
                assert!((found - theory).abs() < 1e-9, "bar {bar}, s {s}: {found}, not {theory}");
            }
        }
    }

    #[test]
    fn the_details_of_all_levels_and_the_last_mean_add_up_to_the_row() {
        // Even differences at every level, so that no rounding hides a mistake.
        let row: Vec<u8> = (0..64u8).map(|x| if (20..36).contains(&x) { 164 } else { 36 }).collect();
        let sum: Vec<i16> = (0..64).map(|x| (0..5).map(|level| contours_of_level(&row, level)[x]).sum()).collect();
        let rest: Vec<i16> = sum.iter().zip(&row).map(|(&sum, &value)| i16::from(value) - sum).collect();
        assert!(rest.chunks(32).all(|block| block.iter().all(|&v| v == block[0])), "{rest:?}");
    }

    #[test]
    fn odd_rows_come_back_in_their_length() {
        let row: Vec<u8> = (0..=72).map(|x| x * 3).collect();
        for level in 0..5 {
            assert_eq!(contours_of_level(&row, level).len(), 73, "level {level}");
        }
        assert!(contours_of_level(&[9; 73], 2).iter().all(|&v| v == 0 || v == 9));
    }
}
