//! Kernels against their definitions, byte by byte or by portable operations, on every target.

use super::*;
use crate::lanes::portable;
#[cfg(haarline_sse2)]
use crate::lanes::x86_64::rows::haar_peaks_of_pairs;

pub(in crate::lanes) const WORDS: usize = 23;
pub(in crate::lanes) type Row = [u32; WORDS];

/// Rows of noise, of extremes, and of both.
pub(in crate::lanes) fn rows() -> impl Iterator<Item = [Row; 5]> {
    let mut seed = 1u32;
    (0..60).map(move |kind| {
        [0; 5].map(|_: u32| {
            [0; WORDS].map(|_: u32| {
                let word = crate::random::next(&mut seed);
                match kind % 3 {
                    0 => word ^ word >> 13,
                    1 => (word >> 7 & 0x0101_0101) * 0xff,
                    _ => ((word >> 9 & 0x0101_0101) * 0xff) ^ (word & 0x8181_8181),
                }
            })
        })
    })
}

pub(in crate::lanes) fn byte(row: &Row, at: usize) -> u8 {
    (row[at / 4] >> (8 * (at % 4))) as u8
}

/// The word that begins at a byte.
fn word(row: &Row, at: usize) -> u32 {
    u32::from_le_bytes([0, 1, 2, 3].map(|i| byte(row, at + i)))
}

/// As the kernels' definitions, by portable operations.
fn limited(gradient: u32, wide: u32, narrow: u32) -> u32 {
    let limit = |limit: u32| {
        let lower = portable::sub(gradient ^ FLIP, splat(128 - limit));
        portable::add(lower, splat(255 - 2 * limit))
    };
    if narrow == 0 { limit(wide) } else { portable::wrapping_add(limit(wide), limit(narrow)) }
}

#[test]
fn gradients_are_those_of_words() {
    for ([a, b, ..], (wide, narrow)) in rows().zip([(15, 4), (31, 0), (100, 27)].into_iter().cycle()) {
        // Of all lengths, so that words are left over.
        for len in 2..=WORDS {
            let (mut across, mut down) = ([7; WORDS], [7; WORDS]);
            gradient_across([&a[..len], &b[..len]], Clips::new(wide, narrow), &mut across[..len]);
            gradient_down([&a[..len], &b[..len]], Clips::new(wide, narrow), &mut down[..len]);
            for i in 1..len - 1 {
                let difference = |row: &Row| portable::signed_sub(word(row, 4 * i + 1), word(row, 4 * i - 1));
                let expected = portable::signed_add(difference(&a), difference(&b));
                assert_eq!(across[i], limited(expected, wide, narrow));
                let difference = |at: usize| portable::signed_sub(word(&b, at), word(&a, at));
                let expected = portable::signed_add(difference(4 * i), difference(4 * i + 1));
                assert_eq!(down[i], limited(expected, wide, narrow));
            }
            assert_eq!([across[0], across[len - 1], down[0], down[len - 1]], [7; 4]);
        }
    }
}

fn mean_121(a: u32, b: u32, c: u32) -> u32 {
    portable::signed_halved_sum(portable::signed_halved_sum(a, c), b)
}

fn mean_12221([a, b, c, d, e]: [u32; 5]) -> u32 {
    portable::signed_halved_sum(mean_121(a, c, e), portable::signed_halved_sum(b, d))
}

#[test]
fn means_are_those_of_words() {
    for (rows, len) in rows().zip((2..=WORDS).cycle()) {
        for mean in [Mean::Three, Mean::Five, Mean::Nine] {
            let (mut down, mut across) = ([7; WORDS], [7; WORDS]);
            super::mean_down(rows.each_ref().map(|row| &row[..len]), mean, &mut down[..len]);
            super::mean_across(&rows[0][..len], mean, &mut across[..len]);
            for i in 0..len {
                let column = rows.map(|row| row[i]);
                let [_, b, c, d, _] = column;
                assert_eq!(down[i], if mean == Mean::Three { mean_121(b, c, d) } else { mean_12221(column) });
            }
            for i in 1..len - 1 {
                let at = |byte: usize| word(&rows[0], byte);
                let five = |byte: usize| mean_12221([byte - 2, byte - 1, byte, byte + 1, byte + 2].map(at));
                let expected = match mean {
                    Mean::Three => mean_121(at(4 * i - 1), at(4 * i), at(4 * i + 1)),
                    Mean::Five => five(4 * i),
                    Mean::Nine => portable::signed_halved_sum(five(4 * i - 2), five(4 * i + 2)),
                };
                assert_eq!(across[i], expected);
            }
        }
    }
}

fn responses(rows: [&Row; 2], words: usize, falling: bool) -> [u32; WORDS] {
    // Beyond the margin it goes on like it.
    let at = |row: &Row, byte_at: usize| byte(row, byte_at.min(4 * words - 1));
    let mean = |byte_at: usize| {
        let [a, b] = rows.map(|row| u32::from(at(row, byte_at)));
        portable::signed_halved_sum(a, b)
    };
    let pair = |byte_at: usize| (portable::signed_halved_sum(mean(byte_at), mean(byte_at + 1)) ^ FLIP) & 0xff;
    core::array::from_fn(|i| {
        let lanes = [0, 1, 2, 3].map(|x| {
            let (before, after) = (pair(4 * i + 2 + x), pair(4 * i + 4 + x));
            let response = if falling { before.saturating_sub(after) } else { after.saturating_sub(before) };
            response as u8
        });
        u32::from_le_bytes(lanes)
    })
}

#[test]
fn haar_responses_are_those_of_bytes() {
    for mut rows in rows() {
        for words in 4..=WORDS {
            // The margin is one byte four times.
            for row in &mut rows {
                row[words - 1] = splat(u32::from(byte(row, 4 * words - 5)));
            }
            let [a, b, ..] = rows.each_ref();
            for falling in [false, true] {
                let (expected, mut tile) = (responses([a, b], words, falling), 0);
                haar_responses([a, b], words, falling, 0, |pair| {
                    assert_eq!(pair, [expected[2 * tile], expected[2 * tile + 1]], "{words} words, tile {tile}");
                    tile += 1;
                });
                assert_eq!(tile, (words - 2).div_ceil(2));
            }
        }
    }
}

/// Peaks of the responses of words.
#[cfg(haarline_sse2)]
fn check_peaks(rows: [&Row; 2], words: usize, falling: bool) {
    let mut peaks = [(0, 0); WORDS];
    let mut len = 0;
    let done = haar_peaks_of_pairs(rows, words, falling, |column, strength| {
        peaks[len] = (column, strength);
        len += 1;
    });
    assert_eq!(done, len);
    let (mut tile, mut column) = (0, 0);
    haar_responses(rows, words, falling, 0, |[a, b]| {
        let lanes = u64::from(a) | u64::from(b) << 32;
        let (mut at, mut most) = (0, 0);
        for (i, &lane) in (0..).zip(&lanes.to_le_bytes()) {
            if u32::from(lane) > most {
                (at, most) = (i, u32::from(lane));
            }
        }
        if tile < done {
            assert_eq!(peaks[tile], (column + at, most), "{words} words, tile {tile}");
        }
        (tile, column) = (tile + 1, column + 8);
    });
    // What goes on in the middle of a row is as in one go.
    let mut rest = 0;
    haar_responses(rows, words, falling, done, |_| rest += 1);
    assert_eq!(done + rest, tile);
}

#[test]
#[cfg(haarline_sse2)]
fn haar_peaks_are_those_of_words() {
    for rows in rows() {
        let [a, b, ..] = rows.each_ref();
        for words in 4..=WORDS {
            check_peaks([a, b], words, false);
            check_peaks([a, b], words, true);
        }
    }
}

#[test]
fn pixels_become_signed_and_are_doubled() {
    let pixels: [u8; 173] = core::array::from_fn(|i| (i as u8).wrapping_mul(73) ^ (i as u8) >> 3);
    for (len, doublings) in (0..=pixels.len()).flat_map(|len| (0..4).map(move |doublings| (len, doublings))) {
        // At every alignment.
        for pixels in (0..4).filter_map(|first| pixels.get(first..len)) {
            let mut row = [7; 173 / 4 + 2];
            fill(&mut row, pixels, doublings);
            for (i, &pixel) in pixels.iter().enumerate() {
                let doubled = u32::from(pixel) << doublings;
                let expected = u8::try_from(doubled).unwrap_or(u8::MAX) ^ 0x80;
                assert_eq!(row[0], 7);
                assert_eq!((row[1 + i / 4] >> (8 * (i % 4))) as u8, expected, "{i} of {len}, {doublings}");
            }
        }
    }
}
