//! Sums of the evidence, four cells at once.
#![allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "cells are few")]
#![expect(unsafe_code, reason = "sixteen bytes at byte offsets, without a check for each")]

use super::quad::Quad;
use crate::lanes::evidence_rows::{CellSums, CellWindows};

/// What four cells show in two rows: cell by cell the upper row, then the lower one.
#[derive(Clone, Copy)]
struct Cells([Quad; 2]);

impl Cells {
    /// The cells from a byte of the rows on.
    ///
    /// # Safety
    /// Both must have sixteen bytes from there on.
    #[inline(always)]
    unsafe fn load<const WORDS: usize>(rows: &[[u32; WORDS]; 2], byte: usize) -> Self {
        // SAFETY: as the caller promises.
        let [upper, lower] = rows.each_ref().map(|row| unsafe { Quad::load(row, byte) });
        Self([upper.in_turn(lower), upper.upper_in_turn(lower)])
    }

    /// Sums of absolute differences, a byte a cell, at most 255.
    #[inline(always)]
    fn sad(self, Self([first, second]): Self) -> [u8; 4] {
        self.0[0].sad(first).sums_as_bytes(self.0[1].sad(second)).to_le_bytes()
    }
}

/// Sums up as many fours of cells but for their answers.
///
/// # Safety
/// The windows at the distance, and one cell after the fours, must lie within the rows.
#[inline(always)]
pub(crate) unsafe fn self_sums_by_fours<const WORDS: usize>(
    windows: &CellWindows<'_, WORDS>,
    sums: &mut CellSums<WORDS>,
    fours: usize,
) {
    let zero = Cells([Quad::splat(windows.zero); 2]);
    let distance = windows.distance as usize;
    let CellSums { near, far, like, strength } = sums;
    let sums = [near, far, like, strength].map(|row| row.as_chunks_mut::<4>().0.iter_mut());
    let [near, far, like, strength] = sums;
    for (four, (((near, far), like), strength)) in near.zip(far).zip(like).zip(strength).enumerate().take(fours) {
        let byte = 16 * four + 4;
        // SAFETY: as the caller promises.
        let at = |offset: usize| unsafe { Cells::load(windows.left, byte + offset) };
        let here = at(0);
        (*near, *far, *like) = (here.sad(at(4)), here.sad(at(8)), here.sad(at(distance)));
        *strength = here.sad(zero);
    }
}

/// Sums up what as many fours of cells differ by at their labels.
///
/// # Safety
/// The rows must have the words of so many cells, and the bytes up to the word at the last one that a window may begin at.
#[inline(always)]
pub(crate) unsafe fn fit_sums_by_fours<const WORDS: usize>(
    windows: &CellWindows<'_, WORDS>,
    fit: &mut [u8; WORDS],
) -> usize {
    let last = windows.last_byte();
    let mut done = 0;
    for (labels, fit) in windows.labels.as_chunks::<4>().0.iter().zip(fit.as_chunks_mut::<4>().0) {
        // Cells answer columns of the right row that move on with them.
        let origin = windows.origin + 4 * done as i32;
        let partner = |cell: usize| {
            let byte = origin + 4 * cell as i32 - i32::from(labels[cell]);
            let byte = byte.cast_unsigned().min(last) as usize;
            // SAFETY: as the caller promises.
            let [upper, lower] = windows.right.each_ref().map(|row| unsafe { Quad::load_word(row, byte) });
            upper.in_turn(lower)
        };
        // SAFETY: as the caller promises.
        let here = unsafe { Cells::load(windows.left, 4 * done + 4) };
        *fit = here.sad(Cells([partner(0).lower(partner(1)), partner(2).lower(partner(3))]));
        done += 4;
    }
    done
}
