//! Rectification's innermost loops: pixels between two rows and between columns, four by one place across, eight by one weight
//! down; and rows copied.
//!
//! Written in full for Cortex-M: 66 instructions for eight pixels. Held against portable code on every target that has both.

/// Pixels that share a place across.
pub(crate) const RUN: usize = 4;
/// Pixels that share a weight down.
pub(crate) const PAIR: usize = 2 * RUN;
/// Pixels that are made at once.
pub(crate) const SEGMENT: usize = 4 * PAIR;

/// Where the runs of a piece of a row lie, 1/65536 px.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Across {
    /// Place of the next run's first column.
    pub(crate) at: i32,
    /// From a run to the next one.
    pub(crate) step: i32,
    /// By how much the step grows from a pair of runs to the next one.
    pub(crate) bend: i32,
}

impl Across {
    /// Whether a segment's runs read columns 0 to `last` only.
    #[inline(always)]
    pub(crate) const fn is_within(&self, last: u16) -> bool {
        // No place, no step is negative then, none that comes later, and nothing overflows.
        let end = self.step.wrapping_add(self.bend.wrapping_mul(4));
        let is_small = (self.bend.wrapping_add(1 << 20)).cast_unsigned() >> 21 == 0;
        if (self.at | self.step | end).cast_unsigned() >> 27 != 0 || !is_small {
            return false;
        }
        // After k pairs a run lies at `at + 2 k step + k (k - 1) bend`: behind the eighth run.
        let beyond = self.at + self.step * 8 + self.bend * 12;
        // The eighth one is as long as the last step, which is at most the first step and four bends.
        let eighth = beyond - (self.step + self.bend * 3);
        (eighth.cast_unsigned() >> 16) + RUN as u32 <= last as u32
    }
}

/// Weights of the lower row, 1/16, for each pair of runs of a segment, and whether other rows follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Downs(u32);

impl Downs {
    /// Bits of a pair.
    const BITS: u32 = 5;

    /// Of four places down, 1/65536 px.
    #[inline(always)]
    pub(crate) const fn new([first, second, third, fourth]: [i32; 4]) -> Self {
        const fn weight(place: i32) -> u32 {
            place.cast_unsigned() >> 12 & 15
        }
        Self(weight(first) | weight(second) << 5 | weight(third) << 10 | weight(fourth) << 15)
    }

    /// Pairs from that one on, 1 to 3, lie between other rows.
    #[inline(always)]
    pub(crate) const fn switch_before(self, pair: u32) -> Self {
        Self(self.0 | 1 << (Self::BITS * pair - 1))
    }
}

/// Makes a segment, of the two rows `first` and, where [`Downs`] switches, of `then`; whether all of it lies within these rows
/// up to their column `last`. If not, nothing is made.
#[inline(always)]
pub(crate) fn mix_segment<const WIDTH: usize>(
    first: [&[u8; WIDTH]; 2],
    then: [&[u8; WIDTH]; 2],
    across: Across,
    last: u16,
    downs: Downs,
    out: &mut [u8; SEGMENT],
) -> bool {
    if usize::from(last) >= WIDTH || !across.is_within(last) {
        return false;
    }
    #[cfg(haarline_dsp)]
    dsp(first, then, across, downs, out);
    #[cfg(not(haarline_dsp))]
    portable(first, then, across, downs, out);
    true
}

#[cfg(any(not(haarline_dsp), test))]
fn portable<const WIDTH: usize>(
    first: [&[u8; WIDTH]; 2],
    then: [&[u8; WIDTH]; 2],
    mut across: Across,
    Downs(mut downs): Downs,
    out: &mut [u8; SEGMENT],
) {
    let mut rows = first;
    for pair in out.as_chunks_mut::<PAIR>().0 {
        for run in pair.as_chunks_mut::<RUN>().0 {
            let x = usize::try_from(across.at >> 16).unwrap_or(0);
            let weights = [(across.at >> 12 & 15).cast_unsigned(), downs & 15];
            if let (Some(above), Some(below)) = (five(rows[0], x), five(rows[1], x)) {
                *run = mix(above, below, weights);
            }
            across.at += across.step;
        }
        across.step += across.bend;
        if downs & 16 != 0 {
            rows = then;
        }
        downs >>= Downs::BITS;
    }
}

/// Columns `x` to `x + 3` and the same one further right.
#[inline(always)]
pub(crate) fn five(row: &[u8], x: usize) -> Option<[u32; 2]> {
    let [a, b, c, d, e] = *row.get(x..)?.first_chunk::<{ RUN + 1 }>()?;
    Some([u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([b, c, d, e])])
}

/// Four pixels between two rows and between columns, two in the lanes of a word at once.
#[inline(always)]
pub(crate) const fn mix(above: [u32; 2], below: [u32; 2], [across, down]: [u32; 2]) -> [u8; RUN] {
    const LANES: u32 = 0x00FF_00FF;
    const HALF: u32 = 0x0080_0080;
    let up = 16 - down;
    // Columns 0 and 2, 1 and 3, 2 and 4; at most 255 * 16 in a lane.
    let first = (above[0] & LANES) * up + (below[0] & LANES) * down;
    let second = (above[0] >> 8 & LANES) * up + (below[0] >> 8 & LANES) * down;
    let third = (above[1] >> 8 & LANES) * up + (below[1] >> 8 & LANES) * down;
    // At most 255 * 256 + 128, below 2^16.
    let back = 16 - across;
    let even = first * back + second * across + HALF;
    let odd = second * back + third * across + HALF;
    (even >> 8 & LANES | odd & !LANES).to_le_bytes()
}

/// A run's instructions: 30.
#[cfg(haarline_dsp)]
macro_rules! run {
    () => {
        "add r11, r3, r1, asr #16
         ldr r12, [r11]
         ldr lr, [r11, #1]
         add r11, r4, r1, asr #16
         ldr r6, [r11]
         ldr r11, [r11, #1]
         uxtb16 r0, r12
         uxtb16 r12, r12, ror #8
         uxtb16 lr, lr, ror #8
         mul r0, r0, r10
         mul r12, r12, r10
         mul lr, lr, r10
         uxtb16 r7, r6
         mla r0, r7, r9, r0
         uxtb16 r6, r6, ror #8
         mla r12, r6, r9, r12
         uxtb16 r11, r11, ror #8
         mla lr, r11, r9, lr
         ubfx r11, r1, #12, #4
         rsb r6, r11, #16
         mov r7, #0x00800080
         mla r0, r0, r6, r7
         mla r0, r12, r11, r0
         mla r12, r12, r6, r7
         mla r12, lr, r11, r12
         rev16 r0, r0
         sel r0, r12, r0
         str r0, [r5], #4
         add r1, r1, r2
        "
    };
}

#[cfg(haarline_dsp)]
#[expect(unsafe_code, reason = "instructions that the language has no other name for")]
#[inline(always)]
fn dsp<const WIDTH: usize>(
    first: [&[u8; WIDTH]; 2],
    then: [&[u8; WIDTH]; 2],
    across: Across,
    downs: Downs,
    out: &mut [u8; SEGMENT],
) {
    // A one above the last weight ends the loop.
    let weights = downs.0 | 1 << (4 * Downs::BITS);
    // SAFETY: `mix_segment` has held all runs within the rows, five bytes from a run's place on, and the loop writes four pairs,
    // as many as `weights` has. r6 and r7, which no operand may be, are put back, and so is the stack.
    unsafe {
        core::arch::asm!(
            "push {{r0, r6, r7, r9, r10}}",
            // Bytes 1 and 3 of what is selected are those of the first operand.
            "mov r6, #0xff00ff00",
            "mov r7, #0x00ff00ff",
            "usub8 r6, r6, r7",
            "2:",
            "and r9, r8, #15",
            "rsb r10, r9, #16",
            run!(),
            run!(),
            "ldr r0, [sp]",
            "add r2, r2, r0",
            "lsrs r8, r8, #5",
            "bcs 4f",
            "3:",
            "cmp r8, #1",
            "bne 2b",
            "b 5f",
            // Other rows from here on.
            "4:",
            "ldrd r3, r4, [sp, #12]",
            "b 3b",
            "5:",
            "pop {{r0, r6, r7, r9, r10}}",
            inout("r0") across.bend => _,
            inout("r1") across.at => _,
            inout("r2") across.step => _,
            inout("r3") first[0].as_ptr() => _,
            inout("r4") first[1].as_ptr() => _,
            inout("r5") out.as_mut_ptr() => _,
            inout("r8") weights => _,
            inout("r9") then[0].as_ptr() => _,
            inout("r10") then[1].as_ptr() => _,
            out("r11") _,
            out("r12") _,
            out("lr") _,
        );
    }
}

/// Copies a row; as many columns as both have.
#[inline(always)]
pub(crate) fn copy(row: &[u8], to: &mut [u8]) {
    #[cfg(haarline_dsp)]
    let (row, to) = copy_words(row, to);
    to.iter_mut().zip(row).for_each(|(to, &pixel)| *to = pixel);
}

/// Copies 16 columns at a time, from and to whatever places; what is left of both. `memcpy` goes byte by byte where one of both
/// lies on no word's border.
#[cfg(haarline_dsp)]
#[expect(unsafe_code, reason = "instructions that the language has no other name for")]
#[inline(always)]
fn copy_words<'a, 'b>(row: &'a [u8], to: &'b mut [u8]) -> (&'a [u8], &'b mut [u8]) {
    let whole = row.len().min(to.len()) / 16 * 16;
    let ((words, row), (room, to)) = (row.split_at(whole), to.split_at_mut(whole));
    if whole > 0 {
        // SAFETY: as many bytes, a multiple of 16 and not none, are read and written as both slices have.
        unsafe {
            core::arch::asm!(
                "2:",
                "ldr {a}, [{from}], #4",
                "ldr {b}, [{from}], #4",
                "ldr {c}, [{from}], #4",
                "ldr {d}, [{from}], #4",
                "str {a}, [{to}], #4",
                "str {b}, [{to}], #4",
                "str {c}, [{to}], #4",
                "str {d}, [{to}], #4",
                "cmp {from}, {end}",
                "bne 2b",
                from = inout(reg) words.as_ptr() => _,
                to = inout(reg) room.as_mut_ptr() => _,
                end = in(reg) words.as_ptr_range().end,
                a = out(reg) _,
                b = out(reg) _,
                c = out(reg) _,
                d = out(reg) _,
                options(nostack),
            );
        }
    }
    (row, to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_mixed_bilinearly() {
        let rows: [[u8; 40]; 3] =
            core::array::from_fn(|y| core::array::from_fn(|x| (x * x * 37 + y * x * 91).to_le_bytes()[0]));
        let start = Across { at: 2 << 16 | 5 << 12, step: 4 << 16 | 3 << 11, bend: -900 };
        let places = [10 << 12, 15 << 12, 17 << 12, 24 << 12];
        let mut out = [0; SEGMENT];
        let downs = Downs::new(places).switch_before(2);
        assert!(mix_segment([&rows[0], &rows[1]], [&rows[1], &rows[2]], start, 39, downs, &mut out));
        let (mut at, mut step) = (f64::from(start.at), f64::from(start.step));
        for (pair, place) in out.chunks(PAIR).zip(places) {
            for run in pair.chunks(RUN) {
                for (i, &found) in (0..).zip(run) {
                    let across = (at / 4096.0).floor() / 16.0;
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the row")]
                    let x = across as usize + i;
                    let row =
                        |row: &[u8]| f64::from(row[x]) + (f64::from(row[x + 1]) - f64::from(row[x])) * across.fract();
                    let [above, below] =
                        [place >> 16, (place >> 16) + 1].map(|y| row(&rows[usize::try_from(y).unwrap()]));
                    let wanted = above + (below - above) * f64::from(place & 0xffff) / 65_536.0;
                    assert!((f64::from(found) - wanted).abs() <= 0.5 + 1e-9, "{place}, {i}: {found} {wanted}");
                }
                at += step;
            }
            step += f64::from(start.bend);
        }
    }

    #[test]
    fn what_reaches_beyond_the_rows_is_not_inside() {
        let is_inside = |at, step, bend| Across { at, step, bend }.is_within(39);
        assert!(is_inside(0, 4 << 16, 0) && is_inside(7 << 16, 4 << 16, 0) && is_inside(3 << 16, 4 << 16, -99));
        assert!(!is_inside(-1, 4 << 16, 0) && !is_inside(8 << 16, 4 << 16, 0) && !is_inside(0, 4 << 16, 1 << 16));
        assert!(
            !is_inside(0, i32::MAX, 0) && !is_inside(i32::MAX, 4 << 16, 0) && !is_inside(0, 4 << 16, -(1 << 16) - 1)
        );
        assert!(!is_inside(0, 4 << 16, 1 << 30) && !is_inside(0, 4 << 16, i32::MIN));
        let across = Across { at: 0, step: 4 << 16, bend: 0 };
        assert!(!mix_segment([&[0; 40]; 2], [&[0; 40]; 2], across, 40, Downs::new([0; 4]), &mut [0; SEGMENT]));
    }

    #[test]
    fn rows_are_copied_as_far_as_both_go() {
        let row: [u8; 70] = core::array::from_fn(|x| x.to_le_bytes()[0]);
        for (first, len) in [(0, 70), (1, 64), (3, 15), (2, 33), (0, 0)] {
            let mut to = [0xff; 70];
            copy(&row[first..first + len], &mut to[1..66]);
            let end = 1 + len.min(65);
            assert_eq!(to[1..end], row[first..][..len.min(65)]);
            assert!(to[0] == 0xff && to[end..].iter().all(|&byte| byte == 0xff));
        }
    }

    #[test]
    #[cfg(haarline_dsp)]
    fn instructions_equal_portable_code() {
        let rows: [[u8; 80]; 3] =
            core::array::from_fn(|y| core::array::from_fn(|x| (x * x * 37 + y * x * 91).to_le_bytes()[0]));
        let (first, then) = ([&rows[0], &rows[1]], [&rows[1], &rows[2]]);
        for seed in 0..200i32 {
            let across = Across { at: 300_000 + seed * 7919, step: 262_144 + seed * 13, bend: (seed % 7 - 3) * 300 };
            let places = [1, 3, 5, 7].map(|by| seed.wrapping_mul(by * 7919));
            for downs in [Downs::new(places), Downs::new(places).switch_before(1 + seed.unsigned_abs() % 3)] {
                let (mut a, mut b) = ([0; SEGMENT], [0; SEGMENT]);
                dsp(first, then, across, downs, &mut a);
                portable(first, then, across, downs, &mut b);
                assert_eq!(a, b);
            }
        }
    }
}
