//! Smoothing along a row, two values a word, among those that are one surface.
#![cfg_attr(haarline_dsp, expect(unsafe_code, reason = "a loop whose figures all stay in registers"))]
#![allow(clippy::cast_possible_truncation, reason = "halves are cut out")]

use crate::lanes::{
    difference_of_halves, halved_difference_halves, halved_sum_halves, held, select_ge_halves, sub_halves,
};

/// Makes of a value one of another surface.
pub(crate) const FAR: u16 = 0x8000;

/// Two values in a word.
#[inline(always)]
pub(crate) const fn word([a, b]: [u16; 2]) -> u32 {
    a as u32 | (b as u32) << 16
}

/// The two values of a word.
#[inline(always)]
pub(crate) const fn halves(word: u32) -> [u16; 2] {
    [word as u16, (word >> 16) as u16]
}

/// Two values smoothed by those before and after on the same surface, which differ by `same` at most, and their slopes. `here`
/// counts by a half.
#[inline(always)]
pub(crate) fn blend_pair(same: u32, here: u32, before: u32, after: u32) -> (u32, u32) {
    let neighbours = Neighbours::of(same, here, before, after);
    let mean = halved_sum_halves(halved_sum_halves(neighbours.before, neighbours.after), here);
    (select_ge_halves(same, neighbours.furthest, mean, here), neighbours.slope(same))
}

/// The same with more of the neighbours: `here` counts by a quarter.
#[inline(always)]
fn blend_pair_widely(same: u32, here: u32, before: u32, after: u32) -> (u32, u32) {
    let neighbours = Neighbours::of(same, here, before, after);
    let sides = halved_sum_halves(neighbours.before, neighbours.after);
    let mean = halved_sum_halves(sides, halved_sum_halves(sides, here));
    (select_ge_halves(same, neighbours.furthest, mean, here), neighbours.slope(same))
}

/// What lies before and after two values; what is on another surface is like the value itself.
struct Neighbours {
    before: u32,
    after: u32,
    /// The greater of both differences.
    furthest: u32,
}

impl Neighbours {
    #[inline(always)]
    fn of(same: u32, here: u32, before: u32, after: u32) -> Self {
        let (from_before, from_after) = (difference_of_halves(before, here), difference_of_halves(after, here));
        Self {
            before: select_ge_halves(same, from_before, before, here),
            after: select_ge_halves(same, from_after, after, here),
            furthest: select_ge_halves(from_before, from_after, from_before, from_after),
        }
    }

    #[inline(always)]
    fn slope(&self, same: u32) -> u32 {
        let (before, after) = (self.before, self.after);
        select_ge_halves(same, self.furthest, halved_difference_halves(after, before), sub_halves(after, before))
    }
}

/// Values and slopes of a row, two a word.
#[derive(Debug, Clone)]
#[repr(C, align(4))]
pub struct Values<const WORDS: usize> {
    pub(crate) value: [u16; WORDS],
    /// From each value to the next.
    pub(crate) slope: [i16; WORDS],
}

impl<const WORDS: usize> Values<WORDS> {
    /// Smooths the first `count` values twice, each with its neighbours, and finds their slopes. What differs by more than
    /// `same`, in both halves, and what is beyond the ends, is another surface.
    pub(crate) fn smooth(&mut self, count: usize, same: u32) {
        let far = u32::from(FAR);
        let pairs = count.div_ceil(2);
        let values = &mut self.value.as_chunks_mut::<2>().0[..pairs];
        if let Some(last) = values.last_mut()
            && !count.is_multiple_of(2)
        {
            last[1] = last[0] ^ FAR;
        }
        let same = held(same);
        // Two pairs side by side as they are, and two that were smoothed once, a pair before these.
        let first = values.first().map_or(0, |&pair| word(pair));
        let second = values.get(1).map_or(first >> 16 ^ far, |&pair| word(pair));
        let mut raw = Side { before: first, here: second };
        let once = once(same, Side { before: (first ^ far) << 16, here: first }, second);
        let mut smooth = Side { before: (once ^ far) << 16, here: once };
        let written = self.smooth_inner(pairs, same, &mut raw, &mut smooth);
        let next = self::once(same, raw, raw.here >> 16 ^ far);
        let last = Side { before: smooth.here, here: next };
        self.write(written, twice(same, smooth, next));
        if pairs > 1 {
            self.write(written + 1, twice(same, last, next >> 16 ^ far));
        }
    }

    #[inline(always)]
    fn write(&mut self, pair: usize, (value, slope): (u32, u32)) {
        let to = self.value.as_chunks_mut::<2>().0.get_mut(pair).zip(self.slope.as_chunks_mut::<2>().0.get_mut(pair));
        if let Some((to_value, to_slope)) = to {
            (*to_value, *to_slope) = (halves(value), halves(slope).map(u16::cast_signed));
        }
    }

    /// All pairs but the last two; how many. Written for Cortex-M in 50 instructions a pair.
    #[cfg(not(haarline_dsp))]
    fn smooth_inner(&mut self, pairs: usize, same: u32, raw: &mut Side, smooth: &mut Side) -> usize {
        #[cfg(haarline_sse2)]
        let first = {
            let (values, slopes) = (self.value.as_chunks_mut().0, self.slope.as_chunks_mut().0);
            super::x86_64::smoothing::smooth_by_fours(&mut values[..pairs], slopes, same, [raw, smooth])
        };
        #[cfg(not(haarline_sse2))]
        let first = 2;
        self.smooth_pairs(first..pairs, same, raw, smooth);
        pairs.saturating_sub(2)
    }

    /// Takes these pairs, and writes those two before.
    #[cfg(not(haarline_dsp))]
    #[inline(always)]
    fn smooth_pairs(&mut self, pairs: core::ops::Range<usize>, same: u32, raw: &mut Side, smooth: &mut Side) {
        for pair in pairs {
            let next = self.value.as_chunks::<2>().0.get(pair).map_or(0, |&pair| word(pair));
            let once = once(same, *raw, next);
            self.write(pair - 2, twice(same, *smooth, once));
            *raw = Side { before: raw.here, here: next };
            *smooth = Side { before: smooth.here, here: once };
        }
    }

    #[cfg(haarline_dsp)]
    #[inline(always)]
    fn smooth_inner(&mut self, pairs: usize, same: u32, raw: &mut Side, smooth: &mut Side) -> usize {
        if pairs <= 2 || pairs > WORDS / 2 {
            return 0;
        }
        // Between two pairs lie the last value of the one and the first of the next one, and from the values before these it is
        // as far as what the difference to the first pair says.
        let between = |side: &Side| side.before >> 16 | side.here << 16;
        let (raw_between, smooth_between) = (between(raw), between(smooth));
        let [raw_far, smooth_far] = [(raw_between, raw.before), (smooth_between, smooth.before)]
            .map(|(between, before)| difference_of_halves(between, before));
        // SAFETY: reads the pairs from the third one on, and writes those two before, and as many slopes, which begin `slopes`
        // bytes after the values; both have so many.
        unsafe {
            let values: *mut u32 = core::ptr::from_mut(self).cast();
            let (raw_here, smooth_here): (u32, u32);
            let (last_between, last_smooth_between): (u32, u32);
            core::arch::asm!(
                "push {{r7}}",
                "push {{{end}}}",
                "2:",
                // What comes in is smoothed once.
                "ldr {n}, [{values}, #8]",
                "lsr {a}, {h}, #16",
                "orr {a}, {a}, {n}, lsl #16",
                "uqsub16 {b}, {a}, {h}",
                "uqsub16 r7, {h}, {a}",
                "orr {b}, {b}, r7",
                "lsr r7, {hf}, #16",
                "orr r7, r7, {b}, lsl #16",
                "mov {hf}, {b}",
                "usub16 {b}, {same}, r7",
                "sel {hb}, {hb}, {h}",
                "usub16 {b}, {same}, {hf}",
                "sel {b}, {a}, {h}",
                "uhadd16 {hb}, {hb}, {b}",
                "uhadd16 {hb}, {hb}, {h}",
                "uqsub16 r7, r7, {hf}",
                "uadd16 r7, r7, {hf}",
                "usub16 r7, {same}, r7",
                "sel {h}, {hb}, {h}",
                "mov {hb}, {a}",
                // What was smoothed once is smoothed again, more widely.
                "lsr {a}, {s}, #16",
                "orr {a}, {a}, {h}, lsl #16",
                "uqsub16 {b}, {a}, {s}",
                "uqsub16 r7, {s}, {a}",
                "orr {b}, {b}, r7",
                "lsr r7, {sf}, #16",
                "orr r7, r7, {b}, lsl #16",
                "mov {sf}, {b}",
                "usub16 {b}, {same}, r7",
                "sel {sb}, {sb}, {s}",
                "usub16 {b}, {same}, {sf}",
                "sel {b}, {a}, {s}",
                "uqsub16 r7, r7, {sf}",
                "uadd16 r7, r7, {sf}",
                "uhsub16 {n}, {b}, {sb}",
                "uhadd16 {end}, {b}, {sb}",
                "usub16 {b}, {b}, {sb}",
                "uhadd16 {sb}, {end}, {s}",
                "uhadd16 {sb}, {end}, {sb}",
                "usub16 r7, {same}, r7",
                "sel {sb}, {sb}, {s}",
                "sel {n}, {n}, {b}",
                "str {sb}, [{values}], #4",
                "str {n}, [{values}, #{slopes} - 4]",
                "mov {s}, {h}",
                "mov {sb}, {a}",
                "ldr {h}, [{values}, #4]",
                "ldr {end}, [sp]",
                "cmp {values}, {end}",
                "bne 2b",
                "pop {{{end}}}",
                "pop {{r7}}",
                values = inout(reg) values => _,
                end = inout(reg) values.add(pairs - 2) => _,
                same = in(reg) same,
                h = inout(reg) raw.here => raw_here,
                hb = inout(reg) raw_between => last_between,
                hf = inout(reg) raw_far => _,
                s = inout(reg) smooth.here => smooth_here,
                sb = inout(reg) smooth_between => last_smooth_between,
                sf = inout(reg) smooth_far => _,
                n = out(reg) _, a = out(reg) _, b = out(reg) _,
                slopes = const { 2 * WORDS },
            );
            // Of the pairs before only the last value counts, which is what lies between first.
            *raw = Side { before: last_between << 16, here: raw_here };
            *smooth = Side { before: last_smooth_between << 16, here: smooth_here };
        }
        pairs - 2
    }
}

/// A pair, and the one before it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side {
    pub(crate) before: u32,
    pub(crate) here: u32,
}

impl Side {
    /// What lies before and after each value.
    #[inline(always)]
    const fn around(self, next: u32) -> [u32; 2] {
        [self.before >> 16 | self.here << 16, self.here >> 16 | next << 16]
    }
}

#[inline(always)]
fn once(same: u32, pair: Side, next: u32) -> u32 {
    let [before, after] = pair.around(next);
    blend_pair(same, pair.here, before, after).0
}

#[inline(always)]
fn twice(same: u32, pair: Side, next: u32) -> (u32, u32) {
    let [before, after] = pair.around(next);
    blend_pair_widely(same, pair.here, before, after)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;
    use crate::lanes::splat_half;

    const SAME: u32 = splat_half(100);

    fn smoothed(values: &[u16]) -> Values<64> {
        let mut row = Values { value: [0; 64], slope: [0; 64] };
        row.value[..values.len()].copy_from_slice(values);
        row.smooth(values.len(), SAME);
        row
    }

    /// One pass, value by value.
    fn pass(values: &[i32], sides: i32) -> Vec<i32> {
        let is_same = |i: usize, j: usize| (values[i] - values[j]).abs() <= 100;
        let inside = |i: usize| i > 0 && i + 1 < values.len() && is_same(i - 1, i) && is_same(i, i + 1);
        let mean = |i: usize| {
            let both = (values[i - 1] + values[i + 1]) >> 1;
            if sides == 4 { (both + values[i]) >> 1 } else { (both + ((both + values[i]) >> 1)) >> 1 }
        };
        (0..values.len()).map(|i| if inside(i) { mean(i) } else { values[i] }).collect()
    }

    #[test]
    fn pairs_are_smoothed_as_values_one_by_one() {
        let mut state = 1_u32;
        for count in 1..=64 {
            let values: Vec<i32> = (0..count)
                .map(|i| {
                    state = state.wrapping_mul(0x9e37_79b1).wrapping_add(0x7f4a_7c15);
                    let jump = if state >> 28 == 0 { 3000 } else { 0 };
                    5000 + 20 * i + jump + (state >> 16).cast_signed() % 80
                })
                .collect();
            let words: Vec<u16> = values.iter().map(|&value| u16::try_from(value).unwrap()).collect();
            let found = smoothed(&words);
            let wanted = pass(&pass(&values, 4), 3);
            let found: Vec<i32> = found.value[..words.len()].iter().map(|&value| value.into()).collect();
            assert_eq!(found, wanted, "{count} values");
        }
    }

    #[test]
    #[cfg(haarline_sse2)]
    fn pairs_side_by_side_are_smoothed_as_one_by_one() {
        let mut seed = 1_u32;
        let mut next = || crate::random::next(&mut seed);
        for pairs in (0..=32).cycle().take(600) {
            // Some of one surface, some extreme.
            let value = [0; 64].map(|_: u16| {
                let number = next();
                if number >> 30 == 0 { number as u16 } else { 0x8000 - 80 + (number >> 8) as u16 % 160 }
            });
            let mut found = Values { value, slope: [7; 64] };
            let mut wanted = found.clone();
            let sides = [0; 2].map(|_: u32| Side { before: next(), here: next() });
            let ([mut raw, mut smooth], [mut raw_wanted, mut smooth_wanted]) = (sides, sides);
            found.smooth_inner(pairs, SAME, &mut raw, &mut smooth);
            wanted.smooth_pairs(2..pairs, SAME, &mut raw_wanted, &mut smooth_wanted);
            assert_eq!((found.value, found.slope), (wanted.value, wanted.slope), "{pairs} pairs");
            for (found, wanted) in [(raw, raw_wanted), (smooth, smooth_wanted)] {
                assert_eq!([found.before, found.here], [wanted.before, wanted.here], "{pairs} pairs");
            }
        }
    }

    #[test]
    fn a_plane_stays_and_so_does_a_jump() {
        let plane: Vec<u16> = (0..40).map(|i| 1000 + 30 * i + if i < 20 { 0 } else { 5000 }).collect();
        let found = smoothed(&plane);
        assert_eq!(found.value[..40], plane);
        assert!(found.slope[..40].iter().all(|&slope| slope == 30), "{:?}", found.slope);
    }
}
