//! The x-derivative prefilter: what is left of a row when brightness and gain offsets are taken away.

use haarline::count;

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
    count::subtractions(3 * last.saturating_sub(1));
    count::additions(3 * last.saturating_sub(1));
    count::comparisons(2 * last.saturating_sub(1));
    // Every pair of windows is one column of the response: `[x - 1, x, x + 1]` of each row.
    let [above, row, below] = rows.map(|line| line.windows(3));
    let inner = response.iter_mut().skip(1);
    for (((out, above), row), below) in inner.zip(above).zip(row).zip(below) {
        let sum = derivative(above) + 2 * derivative(row) + derivative(below);
        let capped = sum.clamp(-i32::from(cap), i32::from(cap)) + i32::from(cap);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..=126")]
        let capped = capped as u8;
        *out = capped;
    }
}

/// Right neighbour minus left neighbour of the middle of three pixels.
fn derivative(triple: &[u8]) -> i32 {
    i32::from(triple[2]) - i32::from(triple[0])
}

#[cfg(test)]
mod tests {
    use super::*;

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
