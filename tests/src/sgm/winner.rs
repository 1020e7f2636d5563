//! The choice among the labels of a pixel.

use haarline::Disparity;

use crate::simd::at_least;

/// One step of a disparity's bits is a pixel over this.
const STEPS: u32 = 1 << Disparity::FRAC_BITS;
const HALF: isize = 1 << (Disparity::FRAC_BITS - 1);

/// The first label whose sum is `best`, in all bytes, which one of the first `labels` has; and by how much the
/// parabola through its neighbours' sums is highest before it, 1/16 px, rounded, halves up.
#[inline(always)]
pub(super) fn winner(sums: &[u32], best: u32, labels: usize) -> (usize, isize) {
    let mut label = 0;
    for &sums in sums {
        let hits = at_least(sums, best);
        if hits != 0 {
            label += hits.trailing_zeros() as usize / 8;
            break;
        }
        label += 4;
    }
    if label == 0 || label + 1 >= labels {
        return (label, 0);
    }
    let sum = |label: usize| sums.get(label / 4).map_or(0, |sums| sums >> (8 * (label % 4)) & 0xff);
    let (before, after) = (best % 256 - sum(label - 1), best % 256 - sum(label + 1));
    (label, refined(before, after))
}

/// How far from the greatest sum the parabola is highest, by how much less the neighbours' sums are.
#[inline(always)]
fn refined(before: u32, after: u32) -> isize {
    let curvature = before + after;
    if curvature == 0 {
        return 0;
    }
    // `16 (after - before) / (2 curvature) + 1 / 2`, over its least, which is -8.
    let over = (STEPS * after + curvature / 2) / curvature;
    (over as usize).cast_signed() - HALF
}
