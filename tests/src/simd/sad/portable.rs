//! The loops in plain code.

use super::{GROUP, Labels};
use crate::simd::Step;

/// Moves a column's sums of the first labels down by a row, each by what its own response of the right view makes of `left`.
pub fn descend<const LABELS: usize>(sums: &mut Labels<LABELS>, left: Step<u8>, right: Step<&[u8]>) {
    let (sums, odd) = sums.0[..right.entering.len()].as_chunks_mut::<4>();
    let (entering, entering_odd) = right.entering.as_chunks::<4>();
    let (leaving, leaving_odd) = right.leaving.as_chunks::<4>();
    let moved = |sum: u16, entering: u8, leaving: u8| {
        sum + difference(left.entering, entering) - difference(left.leaving, leaving)
    };
    for (sums, (e, l)) in sums.iter_mut().zip(entering.iter().zip(leaving)) {
        let [first, third, second, fourth] = *sums;
        *sums =
            [moved(first, e[0], l[0]), moved(third, e[2], l[2]), moved(second, e[1], l[1]), moved(fourth, e[3], l[3])];
    }
    for (sum, (&entering, &leaving)) in odd.iter_mut().zip(entering_odd.iter().zip(leaving_odd)) {
        *sum = moved(*sum, entering, leaving);
    }
}

/// Slides the sums of `labels` of a window on: what enters is added, what leaves is subtracted. In `leasts` are those of
/// each group: of its even places in the lower half, of its odd ones in the upper.
pub fn slide<const LABELS: usize>(
    window: &mut Labels<LABELS>,
    columns: Step<&Labels<LABELS>>,
    labels: usize,
    leasts: &mut [u32],
) {
    let window = window.0[..labels].chunks_mut(GROUP);
    let columns = columns.entering.0.chunks(GROUP).zip(columns.leaving.0.chunks(GROUP));
    for ((window, (entering, leaving)), least) in window.zip(columns).zip(leasts) {
        for (sum, (&entering, &leaving)) in window.iter_mut().zip(entering.iter().zip(leaving)) {
            *sum = *sum + entering - leaving;
        }
        let every_second =
            |first: usize| window.iter().skip(first).step_by(2).fold(u16::MAX, |least, &sum| least.min(sum));
        *least = word([0, 1].map(every_second));
    }
}

/// The label of a whole group whose sum is `least`, in both halves, from the group's first on; of several the first.
/// One has it.
#[cfg(any(not(dsp), test))]
pub fn first_of_group<const LABELS: usize>(sums: &Labels<LABELS>, group: usize, least: u32) -> usize {
    let sums = &sums.0[GROUP * group..][..GROUP];
    (0..GROUP).find(|&label| u32::from(sums[super::place(label, GROUP)]) == least & 0xffff).unwrap_or(0)
}

/// The least sums of a whole group's even and odd places.
#[cfg(any(not(dsp), test))]
pub fn least_of_group<const LABELS: usize>(sums: &Labels<LABELS>, group: usize) -> u32 {
    let pairs = sums.0[GROUP * group..][..GROUP].as_chunks::<2>().0;
    word(pairs.iter().fold([u16::MAX; 2], |least, pair| [least[0].min(pair[0]), least[1].min(pair[1])]))
}

fn word([low, high]: [u16; 2]) -> u32 {
    u32::from(low) | u32::from(high) << 16
}

fn difference(one: u8, other: u8) -> u16 {
    u16::from(one.abs_diff(other))
}
