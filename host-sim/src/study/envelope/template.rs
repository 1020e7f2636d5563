//! Templates around the extrema of a row, and their match in the same row of the other view.

/// The paper's brightness dispersion between corresponding pixels, grey levels.
pub(super) const DISPERSION: i32 = 30;
/// Steps to a neighbour up to this count as flat, grey levels.
pub(super) const FLAT: i32 = 2;
/// The best candidate's difference must be below this many percent of the next best one's.
pub(super) const UNIQUENESS: i32 = 85;

/// The shape of a template of 3 pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Peak,
    Trough,
    Plateau,
    Rise,
    Fall,
}

impl Shape {
    pub(super) const ALL: [Self; 5] = [Self::Peak, Self::Trough, Self::Plateau, Self::Rise, Self::Fall];

    pub(super) fn of([before, here, after]: [u8; 3]) -> Self {
        let step = |from: u8, to: u8| {
            let step = i32::from(to) - i32::from(from);
            if step.abs() <= FLAT { 0 } else { step.signum() }
        };
        match (step(before, here), step(here, after)) {
            (1, -1) => Self::Peak,
            (-1, 1) => Self::Trough,
            (0, 0) => Self::Plateau,
            (first, second) if first + second > 0 => Self::Rise,
            _ => Self::Fall,
        }
    }
}

/// An extremum of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Extremum {
    /// Where it is.
    pub(super) column: usize,
    /// A peak; otherwise a trough.
    pub(super) is_peak: bool,
}

/// The extrema of a row, left to right: peaks and troughs of its 3-pixel templates.
pub(super) fn extrema(row: &[u8]) -> Vec<Extremum> {
    let shapes = row.array_windows::<3>().map(|&template| Shape::of(template)).zip(1..);
    let extremum = |(shape, column)| match shape {
        Shape::Peak => Some(Extremum { column, is_peak: true }),
        Shape::Trough => Some(Extremum { column, is_peak: false }),
        _ => None,
    };
    shapes.filter_map(extremum).collect()
}

/// The template of `width` px around a column, times its width and without its mean.
fn template(row: &[u8], column: usize, width: usize) -> Option<impl Iterator<Item = i32>> {
    let first = column.checked_sub(width / 2)?;
    let pixels = row.get(first..first + width)?;
    let sum: i32 = pixels.iter().map(|&value| i32::from(value)).sum();
    Some(pixels.iter().map(move |&value| i32::from(value) * width as i32 - sum))
}

/// The right view's extremum that matches one of the left view, if there is one and only one.
pub(super) fn matching(
    left: &[u8],
    right: &[u8],
    candidates: &[Extremum],
    of: Extremum,
    range: usize,
    width: usize,
) -> Option<usize> {
    let difference = |candidate: &Extremum| {
        let pixels = template(left, of.column, width)?.zip(template(right, candidate.column, width)?);
        let (sum, most) = pixels.map(|(l, r)| (l - r).abs()).fold((0, 0), |(sum, most), d| (sum + d, most.max(d)));
        (most <= DISPERSION * width as i32).then_some((sum, candidate.column))
    };
    let within = |candidate: &&Extremum| {
        candidate.is_peak == of.is_peak
            && (of.column + 1).saturating_sub(range) <= candidate.column
            && candidate.column <= of.column
    };
    let differences: Vec<(i32, usize)> = candidates.iter().filter(within).filter_map(difference).collect();
    let &(least, column) = differences.iter().min()?;
    let others = differences.iter().filter(|(_, other)| other.abs_diff(column) > 1).map(|(sum, _)| *sum);
    let is_unique = others.min().is_none_or(|next| 100 * least < UNIQUENESS * next);
    is_unique.then_some(column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_what_they_are_called() {
        let cases = [
            ([10, 50, 10], Shape::Peak),
            ([50, 10, 50], Shape::Trough),
            ([10, 12, 11], Shape::Plateau),
            ([10, 20, 30], Shape::Rise),
            ([10, 10, 30], Shape::Rise),
            ([30, 20, 20], Shape::Fall),
            ([255, 128, 0], Shape::Fall),
        ];
        for (template, shape) in cases {
            assert_eq!(Shape::of(template), shape, "{template:?}");
        }
    }

    #[test]
    fn an_extremum_is_found_again_at_its_shift_in_other_light() {
        let left: Vec<u8> = (0..64u32).map(|x| (x * x * 7 % 101) as u8 + 40).collect();
        let right: Vec<u8> = (0..64).map(|x| left[(x + 5) % 64] - 20).collect();
        let candidates = extrema(&right);
        let inner = extrema(&left).into_iter().filter(|e| (20..55).contains(&e.column));
        let found: Vec<(usize, Option<usize>)> =
            inner.map(|e| (e.column, matching(&left, &right, &candidates, e, 16, 5))).collect();
        assert!(found.len() > 5 && found.iter().all(|&(l, r)| r.is_none_or(|r| l - r == 5)), "{found:?}");
        assert!(found.iter().filter(|(_, r)| r.is_some()).count() > found.len() / 2, "{found:?}");
    }

    #[test]
    fn two_equal_candidates_are_no_match() {
        let mut row = [50u8; 40];
        (row[10], row[20], row[30]) = (90, 90, 90);
        let peak = Extremum { column: 30, is_peak: true };
        assert_eq!(matching(&row, &row, &extrema(&row), peak, 32, 3), None);
        assert_eq!(matching(&row, &row, &extrema(&row), peak, 8, 3), Some(30));
    }
}
