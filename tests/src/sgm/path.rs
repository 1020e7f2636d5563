//! Costs along a path, as merits: what is left of the penalty for a jump.

use core::cell::Cell;

use crate::word::{max, saturating_sub, splat};

/// Penalty for a step of one disparity.
pub const P1: u8 = 3;
/// Penalty for any other step.
pub const P2: u8 = 14;

/// One pixel on, along a path.
///
/// A path cost is `L(d) = C(d) + min(L'(d), L'(d - 1) + P1, L'(d + 1) + P1, P2)` with L' that of the pixel before,
/// whose least is 0. Here are merits instead, `G = max G - L`: a merit above `floor = max G' - P2` counts by what it is
/// above, so that a jump's minimum is a subtraction that stops at 0, and `8 - C` is added. The same floor is then the
/// normalisation, too.
///
/// Gives the new floor.
pub(super) fn step(before: &[Cell<u32>], floor: u8, agreement: &[u32], after: &[Cell<u32>]) -> u8 {
    let (stay, change) = (splat(floor), splat(floor + P1));
    let (mut below, mut greatest) = (0, 0);
    for (at, (&agreement, after)) in agreement.iter().zip(after).enumerate() {
        let here = before[at].get();
        let above = before.get(at + 1).map_or(0, Cell::get);
        let beside = max(here << 8 | below >> 24, here >> 8 | above << 24);
        let best = max(saturating_sub(here, stay), saturating_sub(beside, change));
        let merit = best + agreement;
        greatest = max(greatest, merit);
        below = here;
        after.set(merit);
    }
    // Never negative: the best label before keeps P2.
    crate::word::greatest(greatest).saturating_sub(P2)
}
