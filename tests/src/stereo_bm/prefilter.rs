//! The x-derivative prefilter: what is left of a row when brightness and gain offsets are taken away.

use crate::simd::sobel_words;

/// Computes the capped horizontal Sobel response of a row, shifted to be positive.
///
/// `response[x] = cap + clamp(dx(above) + 2 dx(row) + dx(below), -cap, cap)` with
/// `dx(line) = line[x + 1] - line[x - 1]`, so `0..=2 * cap`. The first and the last column have no
/// derivative and hold `cap`, the response of a flat area.
///
/// - `rows`: the row above, the row itself and the row below, grey levels, all as long as `response`.
/// - `cap`: grey levels, `1..=63`.
pub fn sobel_x(rows: [&[u8]; 3], cap: u8, response: &mut [u8]) {
    let Some(last) = response.len().checked_sub(1) else { return };
    response[0] = cap;
    response[last] = cap;
    // Three derivatives, their sum, clipped and with its offset.
    let inner = &mut response[1..last];
    let (whole, rest) = (inner.len() / 4 * 4, inner.len() % 4);
    if whole > 0 {
        sobel_words(rows, cap, &mut inner[..whole]);
    }
    match inner.len().checked_sub(4) {
        // The last word overlaps the one before.
        Some(start) if rest > 0 => sobel_words(rows.map(|row| &row[start..]), cap, &mut inner[start..]),
        Some(_) => {}
        None => {
            for (x, out) in inner.iter_mut().enumerate() {
                *out = one(rows.map(|row| [row[x], row[x + 2]]), cap);
            }
        }
    }
}

/// A single response, by the neighbours to the left and to the right.
fn one(beside: [[u8; 2]; 3], cap: u8) -> u8 {
    let [above, row, below] = beside.map(|[left, right]| i32::from(right) - i32::from(left));
    let cap = i32::from(cap);
    ((above + 2 * row + below).clamp(-cap, cap) + cap).to_le_bytes()[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn words_have_the_response_of_each_pixel(
            pixels in prop::array::uniform3(prop::array::uniform32(prop_oneof![any::<u8>(), Just(0), Just(255)])),
            (width, cap) in (3..=32_usize, 1..=63_u8),
        ) {
            let mut response = [0; 32];
            sobel_x(pixels.each_ref().map(|row| &row[..width]), cap, &mut response[..width]);
            for x in 1..width - 1 {
                prop_assert_eq!(response[x], one(pixels.map(|row| [row[x - 1], row[x + 1]]), cap), "column {}", x);
            }
        }
    }

    #[test]
    fn flat_rows_respond_with_the_cap() {
        let mut response = [0; 5];
        sobel_x([&[7; 5]; 3], 31, &mut response);
        assert_eq!(response, [31; 5]);
    }

    #[test]
    fn a_step_of_height_h_responds_with_four_h() {
        let row: &[u8] = &[10, 10, 15, 15, 15];
        let mut response = [0; 5];
        sobel_x([row; 3], 31, &mut response);
        assert_eq!(response, [31, 31 + 4 * 5, 31 + 4 * 5, 31, 31]);
    }

    #[test]
    fn extremes_are_capped_on_both_sides() {
        let row: &[u8] = &[0, 0, 255, 255, 0, 0];
        let mut response = [0; 6];
        sobel_x([row; 3], 63, &mut response);
        assert_eq!(response, [63, 126, 126, 0, 0, 63]);
    }

    #[test]
    fn the_middle_row_counts_twice() {
        let mut response = [0; 3];
        sobel_x([&[0, 0, 1], &[0, 0, 10], &[0, 0, 3]], 63, &mut response);
        assert_eq!(response, [63, 63 + 24, 63]);
    }
}
