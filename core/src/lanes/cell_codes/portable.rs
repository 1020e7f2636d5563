//! Cells by portable code, one code after the other.

use super::{Bits, Code, ConfidenceCodes, Confidences, Disparities, DisparityCodes, Entry, TABLE, words_of};
use crate::Disparity;
use crate::lanes::{splat, splat_half, sub_halves};

/// Writes the confidences of cells up to one that has no code: how many cells. Both rows must have the same.
pub(crate) fn put_confidences(
    [upper, lower]: [&[[u8; 4]]; 2],
    codes: &ConfidenceCodes,
    state: &mut Confidences,
    bits: &mut Bits<'_>,
) -> usize {
    let most = bits.room();
    let mut done = 0;
    for (&upper, &lower) in upper.iter().zip(lower).take(most) {
        let word = u32::from_le_bytes(upper);
        let change = i32::from(upper[0]) - i32::from(state.before);
        let index = usize::try_from((change >> 3) + 16).unwrap_or(0).min(31);
        let entry = codes.0[usize::from(state.is_steady)][index];
        let is_told = upper == lower && word == splat(word & 0xff) && change & 7 == 0;
        if !is_told || put(bits, [entry]).is_none() {
            break;
        }
        *state = Confidences { before: upper[3], is_steady: entry.next() == TABLE };
        done += 1;
    }
    done
}

/// Writes the disparities of cells, two columns in a word, up to one that has no code: how many cells.
pub(crate) fn put_disparities(
    [upper, lower]: [&[[Disparity; 4]]; 2],
    codes: &DisparityCodes,
    state: &mut Disparities,
    bits: &mut Bits<'_>,
) -> usize {
    let most = bits.room() / 2;
    let mut done = 0;
    for (upper, lower) in upper.iter().zip(lower).take(most) {
        let ([left, right], lower) = (words_of(*upper), words_of(*lower));
        let down = [sub_halves(lower[0], left), sub_halves(lower[1], right)];
        if down[0] != down[1] || down[0] != down[0].rotate_left(16) {
            break;
        }
        let [first, last] = [(left << 16).cast_signed() >> 16, right.cast_signed() >> 16];
        let shape = codes.shape[saturated(last - first, 32)];
        if sub_halves(left & 0xffff_0000 | right & 0xffff, splat_half(left & 0xffff)) != shape.inner {
            break;
        }
        let step = first - state.before;
        let value = codes.value[saturated(step, 32)];
        let down = codes.down[state.down][saturated(down[0].cast_signed() >> 16, 16)];
        let least = -1 << (DisparityCodes::BITS - 1);
        if value.is_none() && !shape.code.is_none() && !down.is_none() && (least + 1..-least).contains(&step) {
            let step = Code::new(step.cast_unsigned() & ((1 << DisparityCodes::BITS) - 1), DisparityCodes::BITS);
            let all = [shape.code.code(), codes.escape, step, down.code()];
            if all.into_iter().try_for_each(|code| bits.put(code)).is_none() {
                break;
            }
        } else if put(bits, [shape.code, value, down]).is_none() {
            break;
        }
        *state = Disparities { before: last, down: (down.next() - DisparityCodes::DOWN) / TABLE };
        done += 1;
    }
    done
}

/// Where a number stands in a table from `-half` to `half - 1`; those beyond stand at its ends.
fn saturated(number: i32, half: i32) -> usize {
    usize::try_from(number.clamp(-half, half - 1) + half).unwrap_or(0)
}

/// All of these codes, or none.
fn put<const N: usize>(bits: &mut Bits<'_>, entries: [Entry; N]) -> Option<()> {
    if entries.iter().any(|entry| entry.is_none()) {
        return None;
    }
    entries.iter().try_for_each(|entry| bits.put(entry.code()))
}
