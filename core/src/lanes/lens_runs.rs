//! Rectification's innermost loops: pixels between two rows and between columns, four at once by one place; and rows copied.
//!
//! Written in full for Cortex-M: 31 instructions for four pixels, 36 where rows change. Held against portable code on every target
//! that has both.
#![allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "a run is a few pixels")]

/// Pixels that share a place.
pub(crate) const RUN: usize = 4;
/// Pixels that are made at once.
pub(crate) const SEGMENT: usize = 8 * RUN;

/// Where the runs of a segment lie, 1/65536 px, and how that changes from row to row.
///
/// Place of the first run's first column; from a run to the next one; by how much that grows from a pair of runs to the next
/// one; growth of the first two from row to row.
pub(crate) type Across = [i32; 5];

/// Where the runs of a segment lie down, 1/65536 px, and how that changes from row to row.
///
/// Place of the first run; from a run to the next one; by how much that grows; growth of the three from row to row.
pub(crate) type Down = [i32; 6];

/// Whether a segment's runs read columns 0 to `last` only.
#[cfg(any(not(haarline_dsp), test))]
#[inline(always)]
const fn is_within([at, step, bend, ..]: Across, last: u16) -> bool {
    // No place, no step is negative then, none that comes later, and nothing overflows.
    let end = step.wrapping_add(bend.wrapping_mul(4));
    let is_small = (bend.wrapping_add(1 << 20)).cast_unsigned() >> 21 == 0;
    if (at | step | end).cast_unsigned() >> 27 != 0 || !is_small {
        return false;
    }
    // After k pairs the second run lies at `at + (2 k + 1) step + k^2 bend`.
    let eighth = at + 7 * step + 9 * bend;
    (eighth >> 16) + 4 <= last as i32
}

/// Weights of the lower row, 1/16, for each run of a segment, 4 bits each, the first one lowest.
pub(crate) type Weights = u32;

/// The weight of a place down.
#[cfg(any(not(haarline_dsp), test))]
#[inline(always)]
const fn weight(place: i32) -> u32 {
    place.cast_unsigned() >> 12 & 15
}

/// Places of the eight runs.
#[inline(always)]
pub(crate) const fn places([first, mut step, bend, ..]: Down) -> [i32; 8] {
    let mut places = [first; 8];
    let mut k = 1;
    while k < 8 {
        places[k] = places[k - 1].wrapping_add(step);
        step = step.wrapping_add(bend);
        k += 1;
    }
    places
}

/// Goes on to the row below. Of the row before: the first run's place, the weights, and 0 where all runs lie between the
/// same rows.
#[inline(always)]
pub(crate) fn advance(down: &mut Down) -> (i32, Weights, u32) {
    #[cfg(haarline_dsp)]
    let told = advance_dsp(down);
    #[cfg(not(haarline_dsp))]
    let told = advance_portable(down);
    told
}

#[cfg(any(not(haarline_dsp), test))]
fn advance_portable(down: &mut Down) -> (i32, Weights, u32) {
    let places = places(*down);
    for k in 0..3 {
        down[k] = down[k].wrapping_add(down[k + 3]);
    }
    let weights = places.iter().rev().fold(0, |weights, &place| weights << 4 | weight(place));
    let differ = places.iter().fold(0, |differ, &place| differ | (place ^ places[0]).cast_unsigned());
    (places[0], weights, differ >> 16)
}

/// The next run's place, its weight `$shift` bits up, and whether it lies between other rows.
#[cfg(haarline_dsp)]
macro_rules! next_place {
    ($shift:literal) => {
        concat!(
            "add r4, r4, r2\n add r2, r2, r3\n ubfx r5, r4, #12, #4\n orr r0, r0, r5, lsl #",
            $shift,
            "\n eor r5, r4, r1\n orr r12, r12, r5\n"
        )
    };
}

/// The same in 51 instructions.
#[cfg(haarline_dsp)]
#[expect(unsafe_code, reason = "instructions that the language has no other name for")]
#[inline(always)]
fn advance_dsp(down: &mut Down) -> (i32, Weights, u32) {
    let (first, weights, differ);
    // SAFETY: reads the six numbers and writes the first three of them.
    unsafe {
        core::arch::asm!(
            "ldm r0, {{r1, r2, r3, r4, r5, r12}}",
            "add r4, r4, r1",
            "add r5, r5, r2",
            "add r12, r12, r3",
            "stm r0, {{r4, r5, r12}}",
            "ubfx r0, r1, #12, #4",
            "mov r4, r1",
            "mov r12, #0",
            next_place!("4"),
            next_place!("8"),
            next_place!("12"),
            next_place!("16"),
            next_place!("20"),
            next_place!("24"),
            next_place!("28"),
            "lsr r12, r12, #16",
            inout("r0") down.as_mut_ptr() => weights,
            out("r1") first,
            out("r2") _,
            out("r3") _,
            out("r4") _,
            out("r5") _,
            out("r12") differ,
            options(nostack, preserves_flags),
        );
    }
    (first, weights, differ)
}

/// Makes a segment, of the two rows `first` and, from the run `switch` on, of `then`, and goes on to the row below; whether
/// all of it lies within these rows up to their column `last`. If not, nothing is made. Without a switch, 0 or 8 and more,
/// all is made of `first`.
#[inline(always)]
pub(crate) fn mix_segment<const WIDTH: usize>(
    first: [&[u8; WIDTH]; 2],
    (switch, then): (u32, [&[u8; WIDTH]; 2]),
    across: &mut Across,
    last: u16,
    weights: Weights,
    out: &mut [u8; SEGMENT],
) -> bool {
    if usize::from(last) >= WIDTH {
        return false;
    }
    #[cfg(haarline_dsp)]
    let is_made = dsp(first, (switch, then), across, last, weights, out);
    #[cfg(not(haarline_dsp))]
    let is_made = portable(first, (switch, then), across, last, weights, out);
    is_made
}

#[cfg(any(not(haarline_dsp), test))]
fn portable<const WIDTH: usize>(
    first: [&[u8; WIDTH]; 2],
    (switch, then): (u32, [&[u8; WIDTH]; 2]),
    across: &mut Across,
    last: u16,
    weights: Weights,
    out: &mut [u8; SEGMENT],
) -> bool {
    let [mut at, mut step, bend, grow, lengthen] = *across;
    let is_inside = is_within(*across, last);
    (across[0], across[1]) = (at.wrapping_add(grow), step.wrapping_add(lengthen));
    if !is_inside {
        return false;
    }
    for (nth, run) in (0..).zip(out.as_chunks_mut::<RUN>().0) {
        let rows = if switch > 0 && nth >= switch { then } else { first };
        *run = mix_run(rows[0], rows[1], at, weights >> (4 * nth) & 15).unwrap_or_default();
        at += step;
        step += if nth % 2 == 1 { bend } else { 0 };
    }
    true
}

/// A run at a place, with the weight of the lower row; `None` where it lies beyond the rows.
#[inline(always)]
pub(crate) fn mix_run(above: &[u8], below: &[u8], at: i32, down: u32) -> Option<[u8; RUN]> {
    let x = usize::try_from(at >> 16).ok()?;
    Some(mix(five(above, x)?, five(below, x)?, [at.cast_unsigned() >> 12 & 15, down]))
}

/// Columns `x` to `x + 3` and the same one further right.
#[inline(always)]
fn five(row: &[u8], x: usize) -> Option<[u32; 2]> {
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

/// A run with its weight from bit `$bit` on.
#[cfg(haarline_dsp)]
macro_rules! weighted {
    ($bit:literal) => {
        concat!("ubfx r9, r8, #", $bit, ", #4\n rsb r10, r9, #16\n", run!())
    };
}

/// The step to what follows a pair of runs.
#[cfg(haarline_dsp)]
macro_rules! bend {
    () => {
        "ldr r0, [sp]\n add r2, r2, r0\n"
    };
}

/// The other rows, from the second run of a pair on, and from the next pair on, if it is their turn.
#[cfg(haarline_dsp)]
macro_rules! switch {
    () => {
        "ldr r0, [sp, #12]\n subs r0, r0, #1\n str r0, [sp, #12]\n it eq\n ldrdeq r3, r4, [sp, #4]\n"
    };
}

#[cfg(haarline_dsp)]
#[expect(unsafe_code, reason = "instructions that the language has no other name for")]
#[inline(always)]
fn dsp<const WIDTH: usize>(
    first: [&[u8; WIDTH]; 2],
    (switch, then): (u32, [&[u8; WIDTH]; 2]),
    across: &mut Across,
    last: u16,
    weights: Weights,
    out: &mut [u8; SEGMENT],
) -> bool {
    let is_made: u32;
    // SAFETY: the first part is `is_within`, without which nothing is read of the rows, of which `last` is a column; so all
    // runs lie within them, five bytes from a run's place on. Eight runs are written. r6 and r7, which no operand may be, are
    // put back, and so is the stack.
    unsafe {
        core::arch::asm!(
            "push {{r6, r7}}",
            "ldm r0, {{r1, r2, r6, r7, r12}}",
            "add r7, r7, r1",
            "add r12, r12, r2",
            "strd r7, r12, [r0]",
            "mov r0, #0",
            "add r7, r2, r6, lsl #2",
            "orr r7, r7, r1",
            "orr r7, r7, r2",
            "add r12, r6, #0x100000",
            "lsr r12, r12, #21",
            "orrs r7, r12, r7, lsr #27",
            "bne.w 9f",
            "rsb r7, r2, r2, lsl #3",
            "add r7, r7, r1",
            "add r12, r6, r6, lsl #3",
            "add r7, r7, r12",
            "cmp r11, r7, asr #16",
            "blt.w 9f",
            "push {{r6, r9, r10, lr}}",
            // Bytes 1 and 3 of what is selected are those of the first operand.
            "mov r6, #0xff00ff00",
            "mov r7, #0x00ff00ff",
            "usub8 r6, r6, r7",
            "cmp lr, #0",
            "bne.w 2f",
            concat!(weighted!("0"), weighted!("4"), bend!(), weighted!("8"), weighted!("12"), bend!()),
            concat!(weighted!("16"), weighted!("20"), bend!(), weighted!("24"), weighted!("28")),
            "b.w 5f",
            // Where other rows follow.
            "2:",
            concat!(weighted!("0"), switch!(), weighted!("4"), switch!(), bend!()),
            concat!(weighted!("8"), switch!(), weighted!("12"), switch!(), bend!()),
            concat!(weighted!("16"), switch!(), weighted!("20"), switch!(), bend!()),
            concat!(weighted!("24"), switch!(), weighted!("28")),
            "5:",
            "add sp, sp, #16",
            "mov r0, #1",
            "9:",
            "pop {{r6, r7}}",
            inout("r0") across.as_mut_ptr() => is_made,
            out("r1") _,
            out("r2") _,
            inout("r3") first[0].as_ptr() => _,
            inout("r4") first[1].as_ptr() => _,
            inout("r5") out.as_mut_ptr() => _,
            inout("r8") weights => _,
            inout("r9") then[0].as_ptr() => _,
            inout("r10") then[1].as_ptr() => _,
            // Greatest column of the last run.
            inout("r11") i32::from(last) - RUN as i32 => _,
            out("r12") _,
            inout("lr") switch => _,
        );
    }
    is_made != 0
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
        let start = [2 << 16 | 5 << 12, 4 << 16 | 3 << 11, -900, 70, -5];
        let mut across = start;
        let mut down = [10 << 12, 1 << 12, 0, 9, 0, 0];
        let places = places(down);
        let (first, weights, differ) = advance(&mut down);
        assert!(first == 10 << 12 && differ != 0 && down[0] == (10 << 12) + 9);
        let mut out = [0; SEGMENT];
        assert!(mix_segment([&rows[0], &rows[1]], (6, [&rows[1], &rows[2]]), &mut across, 39, weights, &mut out));
        assert_eq!(across, [start[0] + 70, start[1] - 5, -900, 70, -5]);
        let (mut at, mut step) = (f64::from(start[0]), f64::from(start[1]));
        for (nth, (run, place)) in out.chunks(RUN).zip(places).enumerate() {
            for (i, &found) in (0..).zip(run) {
                let across = (at / 4096.0).floor() / 16.0;
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the row")]
                let x = across as usize + i;
                let row = |row: &[u8]| f64::from(row[x]) + (f64::from(row[x + 1]) - f64::from(row[x])) * across.fract();
                let [above, below] = [place >> 16, (place >> 16) + 1].map(|y| row(&rows[usize::try_from(y).unwrap()]));
                let wanted = above + (below - above) * f64::from(place & 0xffff) / 65_536.0;
                assert!((f64::from(found) - wanted).abs() <= 0.5 + 1e-9, "{place}, {i}: {found} {wanted}");
            }
            at += step;
            step += if nth % 2 == 1 { f64::from(start[2]) } else { 0.0 };
        }
    }

    #[test]
    fn what_reaches_beyond_the_rows_is_not_inside() {
        let is_inside = |at, step, bend| {
            let across = [at, step, bend, 0, 0];
            let rows = [&[7; 40]; 2];
            let made = mix_segment(rows, (0, rows), &mut across.clone(), 39, 0, &mut [0; SEGMENT]);
            assert_eq!(made, is_within(across, 39));
            made
        };
        assert!(is_inside(0, 4 << 16, 0) && is_inside(7 << 16, 4 << 16, 0) && is_inside(3 << 16, 4 << 16, -99));
        assert!(!is_inside(-1, 4 << 16, 0) && !is_inside(8 << 16, 4 << 16, 0) && !is_inside(0, 4 << 16, 1 << 16));
        assert!(
            !is_inside(0, i32::MAX, 0) && !is_inside(i32::MAX, 4 << 16, 0) && !is_inside(0, 4 << 16, -(1 << 16) - 1)
        );
        assert!(!is_inside(0, 4 << 16, 1 << 30) && !is_inside(0, 4 << 16, i32::MIN));
        let (mut across, rows) = ([0, 4 << 16, 0, 0, 0], [&[0; 40]; 2]);
        assert!(!mix_segment(rows, (0, rows), &mut across, 40, 0, &mut [0; SEGMENT]));
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
            let across = [300_000 + seed * 7919, 262_144 + seed * 13, (seed % 7 - 3) * 300, seed * 3, -seed];
            let number = |by: i32| seed.wrapping_mul(by * 7919);
            let down = [number(1), number(3) >> 8, number(5) >> 9, number(7), seed, -seed];
            let (mut to, mut too) = (down, down);
            assert_eq!((advance_dsp(&mut to), to), (advance_portable(&mut too), too));
            let weights = seed.cast_unsigned().wrapping_mul(0x9e37_79b1);
            for switch in 0..8 {
                let (mut a, mut b) = ([0; SEGMENT], [0; SEGMENT]);
                let (mut to, mut too) = (across, across);
                assert_eq!(
                    dsp(first, then, &mut to, 79, downs, &mut a),
                    portable(first, then, &mut too, 79, downs, &mut b)
                );
                assert_eq!((a, to), (b, too));
            }
        }
    }
}
