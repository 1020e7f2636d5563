//! Sums of the evidence along two rows of cells: what fits, what is there, and what looks like it beside it.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "sums are limited to 255 before, and cells are few"
)]
#![expect(unsafe_code, reason = "words that begin at any byte, after one check a row")]

use crate::lanes::{demand, limited_to_byte, min, sad, sad_add};

/// Sums over the cells of a row, a byte each, at most 255.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct CellSums<const WORDS: usize> {
    /// Absolute differences of the left row against itself, 4 px to the right.
    pub(crate) near: [u8; WORDS],
    /// The same, 8 px to the right.
    pub(crate) far: [u8; WORDS],
    /// The same, at the distance of like contours to the right.
    pub(crate) like: [u8; WORDS],
    /// Magnitudes of the left row's features.
    pub(crate) strength: [u8; WORDS],
}

impl<const WORDS: usize> CellSums<WORDS> {
    /// No sums.
    pub(crate) const EMPTY: Self = Self { near: [0; WORDS], far: [0; WORDS], like: [0; WORDS], strength: [0; WORDS] };
}

/// What the cells of a row are made of.
pub(crate) struct CellWindows<'a, const WORDS: usize> {
    /// Its two feature rows, of either view: a word of margin, the columns, a word of margin.
    pub(crate) left: &'a [[u32; WORDS]; 2],
    pub(crate) right: &'a [[u32; WORDS]; 2],
    /// Label of each cell.
    pub(crate) labels: &'a [u8],
    /// The byte of the right rows that label 0 of the first cell begins at.
    pub(crate) origin: i32,
    /// Distance of like contours, px, at most 255.
    pub(crate) distance: u32,
    /// A feature that is zero, in each lane.
    pub(crate) zero: u32,
}

impl<const WORDS: usize> CellWindows<'_, WORDS> {
    /// Sums up the cells, and in `fit` what they differ by at their labels. What lies beyond the margin to the right cannot be
    /// told from the cell: 255.
    ///
    /// # Panics
    /// If the rows have not two words more than there are cells.
    #[inline(never)]
    pub(crate) fn sum(&self, sums: &mut CellSums<WORDS>, fit: &mut [u8; WORDS]) {
        let cells = self.labels.len();
        demand(cells >= 1 && cells + 2 <= WORDS);
        let likes = self.likes();
        #[cfg(haarline_dsp)]
        let done = {
            let threes = likes.min(cells - 1) / 3;
            // SAFETY: before the last cell both words after a cell's are within the row, and so is the window at the
            // distance within `likes`.
            unsafe { super::self_sums_by_threes(self.left, self.distance as usize, self.zero, sums, threes) };
            3 * threes
        };
        #[cfg(haarline_sse2)]
        let done = {
            let fours = likes.min(cells - 1) / 4;
            // SAFETY: as above.
            unsafe { super::x86_64::evidence::self_sums_by_fours(self, sums, fours) };
            4 * fours
        };
        #[cfg(not(any(haarline_dsp, haarline_sse2)))]
        let done = 0;
        self.sum_selves(done..cells, likes, sums);
        self.sum_fits(fit);
    }

    /// So many cells whose window at the distance lies within the row.
    #[inline(always)]
    fn likes(&self) -> usize {
        let cells = self.labels.len();
        (cells + 1).saturating_sub((self.distance as usize).div_ceil(4)).min(cells)
    }

    /// Sums up what the cells differ by at their labels.
    ///
    /// # Panics
    /// If the rows have not two words more than there are cells.
    pub(crate) fn sum_fits(&self, fit: &mut [u8; WORDS]) {
        let cells = self.labels.len();
        demand(cells >= 1 && cells + 2 <= WORDS);
        #[cfg(haarline_dsp)]
        let done = {
            let pairs = cells / 2;
            // SAFETY: there are `cells` labels and the words of so many cells.
            unsafe { super::fit_sums_by_pairs(self, fit, pairs) };
            2 * pairs
        };
        // SAFETY: there are the words of so many cells, and four bytes from the last one on end the rows.
        #[cfg(haarline_sse2)]
        let done = unsafe { super::x86_64::evidence::fit_sums_by_fours(self, fit) };
        #[cfg(not(any(haarline_dsp, haarline_sse2)))]
        let done = 0;
        self.sum_fit(done..cells, fit);
    }

    /// Whether the right row and its margins have the window of a cell at a label.
    pub(crate) const fn is_inside(&self, cell: usize, label: i32) -> bool {
        let byte = self.origin + 4 * cell as i32 - label;
        0 <= byte && byte <= self.last_byte().cast_signed()
    }

    /// What the left row shows, and what in it looks like the cells.
    fn sum_selves(&self, cells: core::ops::Range<usize>, likes: usize, sums: &mut CellSums<WORDS>) {
        let [a, b] = self.left;
        let words = |word: usize| [a[word], b[word]];
        for c in cells.clone() {
            let (here, next) = (words(c + 1), words(c + 2));
            // Beyond the margin it goes on like it.
            let beyond = if c + 1 < cells.end { words(c + 3) } else { next };
            sums.near[c] = difference(here, next);
            sums.far[c] = difference(here, beyond);
            sums.strength[c] = difference(here, [self.zero; 2]);
            sums.like[c] = if c < likes {
                let byte = 4 * (c + 1) + self.distance as usize;
                // SAFETY: of the `cells + 2` words the window at the distance ends with the last one at most.
                difference(here, unsafe { [word(a, byte), word(b, byte)] })
            } else {
                u8::MAX
            };
        }
    }

    /// What the answers differ by.
    fn sum_fit(&self, cells: core::ops::Range<usize>, fit: &mut [u8; WORDS]) {
        let ([a, b], [c, d]) = (self.left, self.right);
        for i in cells {
            // Cells answer columns of the right row that move on with them.
            let byte = self.origin + 4 * i as i32 - i32::from(self.labels[i]);
            let byte = byte.cast_unsigned().min(self.last_byte()) as usize;
            // SAFETY: four bytes from the last one on end the row.
            let partner = unsafe { [word(c, byte), word(d, byte)] };
            fit[i] = difference([a[i + 1], b[i + 1]], partner);
        }
    }

    /// The byte that the last word begins at, the margin.
    pub(super) const fn last_byte(&self) -> u32 {
        4 * self.labels.len() as u32 + 4
    }
}

/// Sum of absolute differences of two rows of four columns, at most 255.
#[inline(always)]
fn difference(a: [u32; 2], b: [u32; 2]) -> u8 {
    byte_of(sad_add(a[1], b[1], sad(a[0], b[0])))
}

/// A sum, at most 255.
#[inline(always)]
fn byte_of(sum: u32) -> u8 {
    limited_to_byte(sum.cast_signed()) as u8
}

/// The word that begins `byte` bytes into a row.
///
/// # Safety
/// `byte + 4` must not exceed the row's length in bytes.
#[inline(always)]
unsafe fn word(row: &[u32], byte: usize) -> u32 {
    debug_assert!(byte + 4 <= 4 * row.len());
    // SAFETY: within the row, as the caller promises.
    u32::from_le(unsafe { row.as_ptr().cast::<u8>().add(byte).cast::<u32>().read_unaligned() })
}

/// Of each four cells, from `first` on: the least of what they have in a row and of what the cells `steps` before have;
/// outside of the row lies nothing: 255.
#[inline(always)]
pub(crate) fn least_with_before(row: &[u8], first: usize, steps: usize) -> u32 {
    let here = match row.get(first..).and_then(|rest| rest.first_chunk()) {
        Some(&four) => u32::from_le_bytes(four),
        None => bytes_from(row, first, 0),
    };
    let before = match first.checked_sub(steps).and_then(|from| row.get(from..)).and_then(|rest| rest.first_chunk()) {
        Some(&four) => u32::from_le_bytes(four),
        None => bytes_from(row, first, steps),
    };
    min(here, before)
}

/// Four bytes, `steps` before `first` and on, one by one.
#[cold]
fn bytes_from(row: &[u8], first: usize, steps: usize) -> u32 {
    let at = |i: usize| (first + i).checked_sub(steps).and_then(|from| row.get(from)).copied();
    u32::from_le_bytes([0, 1, 2, 3].map(|i| at(i).unwrap_or(u8::MAX)))
}

#[cfg(test)]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "columns of a small image"
)]
mod tests {
    use super::*;

    /// A byte of the row: any number from 0 to 31.
    fn feature(at: usize) -> u8 {
        ((at as u32).wrapping_mul(0x9e37_79b1) >> 27) as u8
    }

    fn row(seed: usize, words: usize) -> [u32; 14] {
        let mut row = [0; 14];
        for (i, word) in row.iter_mut().enumerate().take(words) {
            *word = u32::from_le_bytes([0, 1, 2, 3].map(|lane| feature(1000 * seed + 4 * i + lane)));
        }
        row
    }

    #[test]
    fn sums_are_those_of_their_windows() {
        const CELLS: usize = 11;
        let rows = [0, 1, 2, 3].map(|seed| row(seed, CELLS + 2));
        let labels: [u8; CELLS] = core::array::from_fn(|c| (5 * c % 17) as u8);
        for distance in [6, 8, 21, 46, 255] {
            let (mut sums, mut fit) = (CellSums::EMPTY, [0; 14]);
            let windows = CellWindows {
                left: &[rows[0], rows[1]],
                right: &[rows[2], rows[3]],
                labels: &labels,
                origin: 4,
                distance,
                zero: u32::from_le_bytes([15; 4]),
            };
            windows.sum(&mut sums, &mut fit);
            let CellSums { near, far, like, strength } = sums;
            let byte = |row: usize, at: usize| i32::from(feature(1000 * row + at));
            for c in 0..CELLS {
                let sum = |other: &dyn Fn(usize, usize) -> i32| -> i32 {
                    let all = (0..2).flat_map(|y| (0..4).map(move |x| (y, 4 * (c + 1) + x)));
                    all.map(|(y, x)| (byte(y, x) - other(y, x)).abs()).sum::<i32>().min(255)
                };
                // The word after the last one is the last one again.
                let right_of = |x: usize, by: usize| if x + by < 4 * (CELLS + 2) { x + by } else { x + by - 4 };
                assert_eq!(i32::from(near[c]), sum(&|y, x| byte(y, x + 4)), "near {c}");
                assert_eq!(i32::from(far[c]), sum(&|y, x| byte(y, right_of(x, 8))), "far {c}");
                let is_inside = 4 * (c + 1) + distance as usize + 4 <= 4 * (CELLS + 2);
                let wanted = if is_inside { sum(&|y, x| byte(y, x + distance as usize)) } else { 255 };
                assert_eq!(i32::from(like[c]), wanted, "like {c} at {distance}");
                assert_eq!(i32::from(strength[c]), sum(&|_, _| 15), "strength {c}");
                // A window that would begin before the row or end after it is the last one.
                let at = 4 * (c as i32 + 1) - i32::from(labels[c]);
                if at >= 0 {
                    let right = |y: usize, x: usize| byte(y + 2, (x as i32 - i32::from(labels[c])) as usize);
                    assert_eq!(i32::from(fit[c]), sum(&right), "fit {c}");
                }
            }
        }
    }

    #[test]
    #[cfg(haarline_sse2)]
    fn four_cells_at_once_are_as_one_by_one() {
        let byte = |seed: usize| feature(seed) ^ feature(3 * seed + 1) << 3;
        for cells in 1..=38 {
            let rows: [[[u32; 40]; 2]; 2] = core::array::from_fn(|view| {
                core::array::from_fn(|y| {
                    core::array::from_fn(|i| {
                        u32::from_le_bytes([0, 1, 2, 3].map(|lane| byte(500 * (2 * view + y) + 4 * i + lane)))
                    })
                })
            });
            let labels: [u8; 38] = core::array::from_fn(|c| byte(9000 + c));
            for distance in [0, 6, 9, 46, 255] {
                let labels = &labels[..cells];
                let windows = CellWindows {
                    left: &rows[0],
                    right: &rows[1],
                    labels,
                    origin: 4 + 30,
                    distance,
                    zero: 0x2f2f_2f2f,
                };
                let (mut sums, mut fit) = (CellSums::EMPTY, [0; 40]);
                let (mut wanted, mut wanted_fit) = (sums, fit);
                windows.sum(&mut sums, &mut fit);
                windows.sum_selves(0..cells, windows.likes(), &mut wanted);
                windows.sum_fit(0..cells, &mut wanted_fit);
                assert_eq!((sums, fit), (wanted, wanted_fit), "{cells} cells at {distance}");
            }
        }
    }

    #[test]
    fn the_least_is_that_of_two_places() {
        let row = [9, 2, 7, 4, 5, 6, 1, 8];
        assert_eq!(least_with_before(&row, 0, 0).to_le_bytes(), [9, 2, 7, 4]);
        assert_eq!(least_with_before(&row, 4, 3).to_le_bytes(), [2, 6, 1, 5]);
        assert_eq!(least_with_before(&row, 0, 2).to_le_bytes(), [9, 2, 7, 2]);
        assert_eq!(least_with_before(&row, 4, 12).to_le_bytes(), [5, 6, 1, 8]);
    }
}
