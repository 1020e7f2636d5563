//! The census transform: which neighbours are darker than a pixel.

/// Rows above and below that a census looks at.
pub(super) const REACH: usize = 2;
/// Rows that it takes.
pub(super) const ROWS: usize = 2 * REACH + 1;

/// Signs of the eight pixels of a diamond around each pixel of the middle row: a bit is set where the
/// neighbour is darker. At the ends of the row its first and last pixel stand for those beyond.
pub(super) fn census(rows: [&[u8]; ROWS], out: &mut [u8]) {
    let width = out.len();
    let last = width - 1;
    for x in 0..width {
        let at = |row: usize, right: usize, left: usize| rows[row][(x + right).saturating_sub(left).min(last)];
        let centre = rows[REACH][x];
        let neighbours =
            [at(0, 0, 0), at(1, 0, 1), at(1, 1, 0), at(2, 0, 2), at(2, 2, 0), at(3, 0, 1), at(3, 1, 0), at(4, 0, 0)];
        out[x] = neighbours.iter().fold(0, |bits, &other| bits << 1 | u8::from(other < centre));
    }
}
