//! The Haar wavelet in integers: the only source of filters.
//!
//! Everything is built from two operations on neighbours, the pair sum `a + b` and the pair
//! difference `b - a`. Cascades of them give all that the front end needs: `[1 2 1]` is a pair sum
//! of pair sums, `[1 2 2 2 1]` two more of them, `[-1 0 1]` a pair sum of pair differences,
//! `[1 -2 1]` a pair difference of pair differences, and a box of any width is a running sum.
//! No multiplication anywhere.
//!
//! # Source
//! A. Haar, Zur Theorie der orthogonalen Funktionensysteme, Math. Ann. 69 (1910); the lifting form
//! with rounding is the S transform of A. Said and W. Pearlman (1993).

/// Computes the undecimated Haar response of a line, `W_s(x)` of the paper's scale `s`: the sum of
/// the `half_support` values from each column rightwards minus the sum of as many before it.
///
/// A dark-to-bright step is a positive extremum at its first bright column, and a step of height
/// `h` peaks at `half_support * h`.
///
/// - `line`: any number of values.
/// - `half_support`: values on each side of an edge.
/// - `response`: as many as `line`; columns whose support leaves the line hold 0.
///
/// Four additions a column by running sums, whatever the half-support.
///
/// # Examples
/// ```
/// use haarline::haar::sliding_response;
/// let mut response = [0; 6];
/// sliding_response(&[0u8, 0, 0, 9, 9, 9], 2, &mut response);
/// assert_eq!(response, [0, 0, 9, 18, 9, 0]);
/// ```
pub fn sliding_response<T: Copy + Into<i32>>(line: &[T], half_support: usize, response: &mut [i32]) {
    response.fill(0);
    for (out, value) in response.iter_mut().skip(half_support).zip(SlidingResponse::new(line, half_support)) {
        *out = value;
    }
}

/// The undecimated Haar response as an iterator, for those who keep no row of it.
///
/// The first item belongs to column `half_support`, the last to column `n - half_support`; a support
/// of 0 or longer than the line gives none.
#[derive(Debug, Clone)]
pub struct SlidingResponse<'a, T> {
    line: &'a [T],
    half_support: usize,
    /// The column that comes next.
    column: usize,
    /// Sums of the values before the column and from it on.
    before: i32,
    after: i32,
}

impl<'a, T: Copy + Into<i32>> SlidingResponse<'a, T> {
    /// The responses of `line`, whose sums over `half_support` values must fit an `i32`.
    #[must_use]
    pub fn new(line: &'a [T], half_support: usize) -> Self {
        let sum = |values: Option<&[T]>| values.unwrap_or(&[]).iter().map(|&v| v.into()).sum();
        let support = half_support.saturating_mul(2);
        let fits = half_support > 0 && support <= line.len();
        Self {
            line,
            half_support,
            column: if fits { half_support } else { line.len() + 1 },
            before: sum(line.get(..half_support)),
            after: sum(line.get(half_support..support)),
        }
    }
}

impl<T: Copy + Into<i32>> Iterator for SlidingResponse<'_, T> {
    type Item = i32;

    fn next(&mut self) -> Option<i32> {
        let (x, s) = (self.column, self.half_support);
        if x + s > self.line.len() {
            return None;
        }
        let response = self.after - self.before;
        if let (Some(&leaving), Some(&crossing), Some(&entering)) =
            (self.line.get(x - s), self.line.get(x), self.line.get(x + s))
        {
            self.before += crossing.into() - leaving.into();
            self.after += entering.into() - crossing.into();
        }
        self.column += 1;
        Some(response)
    }
}

/// One level of the decimated transform by lifting: `detail = b - a`, `approximation = a +
/// floor(detail / 2)` of each pair `a, b`. An odd last value becomes an approximation without detail.
///
/// - `line`: `n` values whose differences fit an `i16`, such as pixels.
/// - `approximation`: `n.div_ceil(2)` values, the rounded means of the pairs.
/// - `detail`: `n / 2` values.
///
/// Lengths that differ are cut to the shortest. [`inverse`] gives the line back, exactly.
pub fn forward(line: &[i16], approximation: &mut [i16], detail: &mut [i16]) {
    let (pairs, odd) = line.as_chunks::<2>();
    for ((&[a, b], mean), difference) in pairs.iter().zip(approximation.iter_mut()).zip(detail) {
        *difference = b - a;
        *mean = a + (*difference >> 1);
    }
    if let (Some(&last), Some(mean)) = (odd.first(), approximation.get_mut(pairs.len())) {
        *mean = last;
    }
}

/// The exact inverse of [`forward`].
///
/// With the approximation set to zero it leaves the contours of the line: the paper's eq. 1.
pub fn inverse(approximation: &[i16], detail: &[i16], line: &mut [i16]) {
    let (pairs, odd) = line.as_chunks_mut::<2>();
    let count = pairs.len();
    for (([a, b], &mean), &difference) in pairs.iter_mut().zip(approximation).zip(detail) {
        *a = mean - (difference >> 1);
        *b = *a + difference;
    }
    if let (Some(last), Some(&mean)) = (odd.first_mut(), approximation.get(count)) {
        *last = mean;
    }
}

/// Pair difference of neighbours, `b - a`.
#[inline]
pub(crate) const fn pair_difference(a: i32, b: i32) -> i32 {
    b - a
}

/// `[1 -2 1]`: the pair difference of the two pair differences.
#[inline]
pub(crate) fn difference_121(a: i32, b: i32, c: i32) -> i32 {
    pair_difference(pair_difference(a, b), pair_difference(b, c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    extern crate std;
    use std::vec;
    use std::vec::Vec;

    #[test]
    fn a_step_peaks_at_half_support_times_its_height() {
        for half_support in 1..=16 {
            for height in [1i32, 7, 255] {
                let line: Vec<i32> = (0..64).map(|x| if x < 30 { 0 } else { height }).collect();
                let mut response = vec![0; 64];
                sliding_response(&line, half_support, &mut response);
                let peak = response.iter().copied().max();
                assert_eq!(peak, Some(i32::try_from(half_support).unwrap() * height), "s {half_support} h {height}");
                assert_eq!(response[30], peak.unwrap());
            }
        }
    }

    proptest! {
        #[test]
        fn the_sliding_response_is_the_difference_of_two_plain_sums(
            line in prop::collection::vec(any::<u8>(), 0..80), half_support in 1usize..=20,
        ) {
            let mut response = vec![1; line.len()];
            sliding_response(&line, half_support, &mut response);
            for (x, &found) in response.iter().enumerate() {
                let plain = if x >= half_support && x + half_support <= line.len() {
                    let sum = |r: &[u8]| r.iter().map(|&v| i64::from(v)).sum::<i64>();
                    sum(&line[x..x + half_support]) - sum(&line[x - half_support..x])
                } else {
                    0
                };
                prop_assert_eq!(i64::from(found), plain, "column {}", x);
            }
        }

        #[test]
        fn the_inverse_gives_the_line_back(line in prop::collection::vec(-16384i16..=16383, 0..70)) {
            let mut approximation = vec![0; line.len().div_ceil(2)];
            let mut detail = vec![0; line.len() / 2];
            forward(&line, &mut approximation, &mut detail);
            let mut back = vec![0; line.len()];
            inverse(&approximation, &detail, &mut back);
            prop_assert_eq!(back, line);
        }
    }

    #[test]
    fn a_constant_line_has_no_detail() {
        let (mut approximation, mut detail) = ([0; 3], [9; 2]);
        forward(&[5, 5, 5, 5, 5], &mut approximation, &mut detail);
        assert_eq!((approximation, detail), ([5; 3], [0; 2]));
    }

    #[test]
    fn cascades_are_the_filters_they_are_named_after() {
        assert_eq!(difference_121(1, 10, 100), 81);
    }
}
