//! Both gradients of a view, smoothed, as its rows stream in.

/// Greatest magnitude of a gradient; stored with this added, so that the difference of two is at most twice that
/// and four of them fit a byte.
pub(super) const LIMIT: u8 = 31;
/// Rows on each side that a gradient takes.
pub(super) const BESIDE: u32 = 4;
const ROWS: usize = 9;
/// Smoothing: three times `[1 2 1]`, a standard deviation of 1.22 px.
const SMOOTH: [i32; 7] = [1, 6, 15, 20, 15, 6, 1];
/// The same, one row later minus one row earlier.
const SLOPE: [i32; ROWS] = [-1, -6, -14, -14, 0, 14, 14, 6, 1];
/// Bits by which the sums are shifted down: 16 from the row, 64 from the column; one step is half a grey level.
const SHIFT: u32 = 9;

/// The rows of one view that gradients are made of.
#[derive(Debug, Clone)]
pub(super) struct Gradients<const WIDTH: usize> {
    width: usize,
    /// Rows smoothed along themselves, 1/16 grey level.
    rows: [[u16; WIDTH]; ROWS],
    came: u32,
}

impl<const WIDTH: usize> Gradients<WIDTH> {
    pub(super) const fn new() -> Self {
        Self { width: 0, rows: [[0; WIDTH]; ROWS], came: 0 }
    }

    pub(super) fn start(&mut self, width: usize) {
        (self.width, self.came) = (width.min(WIDTH), 0);
    }

    /// Takes the next row, or nothing where it was lost.
    pub(super) fn push(&mut self, row: Option<&[u8]>) {
        let slot = self.came as usize % ROWS;
        if let Some(place) = self.rows.get_mut(slot).and_then(|place| place.get_mut(..self.width)) {
            place.fill(0);
            for (place, &pixel) in place.iter_mut().zip(row.unwrap_or(&[])) {
                *place = pixel.into();
            }
            for _ in 0..3 {
                binomial(place);
            }
            // At most 255 * 64 before, 255 * 16 after.
            place.iter_mut().for_each(|sum| *sum = (*sum + 2) >> 2);
        }
        self.came += 1;
    }

    /// The gradients of row `y` along the row and along the columns, of the rows that came; beyond the border its
    /// first and last row repeat.
    pub(super) fn row(&self, y: u32, across: &mut [u8], down: &mut [u8]) {
        let last = i64::from(self.came) - 1;
        let source = |tap: usize| {
            let y = (i64::from(y) + i64::try_from(tap).unwrap_or(0) - i64::from(BESIDE)).clamp(0, last.max(0));
            &self.rows[usize::try_from(y).unwrap_or(0) % ROWS]
        };
        let rows: [&[u16; WIDTH]; ROWS] = core::array::from_fn(source);
        let smooth = |x: usize| SMOOTH.iter().zip(&rows[1..8]).map(|(&tap, row)| tap * i32::from(row[x])).sum::<i32>();
        let slope = |x: usize| SLOPE.iter().zip(&rows).map(|(&tap, row)| tap * i32::from(row[x])).sum::<i32>();
        let mut behind = smooth(0);
        let mut here = behind;
        for (x, (across, down)) in across.iter_mut().zip(down.iter_mut()).take(self.width).enumerate() {
            let ahead = smooth((x + 1).min(self.width - 1));
            *across = clipped(ahead - behind);
            *down = clipped(slope(x));
            (behind, here) = (here, ahead);
        }
    }
}

/// `[1 2 1]` along a row, its border pixels repeated.
fn binomial(row: &mut [u16]) {
    let Some(&first) = row.first() else { return };
    let mut behind = first;
    for x in 0..row.len() {
        let here = row[x];
        let ahead = row.get(x + 1).copied().unwrap_or(here);
        row[x] = behind + 2 * here + ahead;
        behind = here;
    }
}

fn clipped(gradient: i32) -> u8 {
    let limit = i32::from(LIMIT);
    let rounded = (gradient + (1 << (SHIFT - 1))) >> SHIFT;
    (rounded.clamp(-limit, limit) + limit).to_le_bytes()[0]
}

/// The last rows of gradients of a view, two planes each.
#[derive(Debug, Clone)]
pub(super) struct GradientRing<const WIDTH: usize, const ROWS: usize> {
    width: usize,
    depth: usize,
    bytes: [[u8; WIDTH]; ROWS],
}

impl<const WIDTH: usize, const ROWS: usize> GradientRing<WIDTH, ROWS> {
    pub(super) const fn new() -> Self {
        Self { width: 0, depth: 1, bytes: [[0; WIDTH]; ROWS] }
    }

    /// Makes room for `depth` rows; all of them must fit.
    pub(super) fn start(&mut self, width: usize, depth: usize) {
        debug_assert!(2 * width * depth <= WIDTH * ROWS, "room for {depth} rows of {width} px");
        (self.width, self.depth) = (width, depth);
    }

    /// Both planes of row `y`.
    pub(super) fn row(&self, y: u32) -> [&[u8]; 2] {
        let at = (y as usize % self.depth) * 2 * self.width;
        let planes = self.bytes.as_flattened().get(at..at + 2 * self.width).unwrap_or(&[]);
        let (across, down) = planes.split_at(planes.len() / 2);
        [across, down]
    }

    pub(super) fn row_mut(&mut self, y: u32) -> [&mut [u8]; 2] {
        let at = (y as usize % self.depth) * 2 * self.width;
        let planes = self.bytes.as_flattened_mut().get_mut(at..at + 2 * self.width).unwrap_or(&mut []);
        let (across, down) = planes.split_at_mut(planes.len() / 2);
        [across, down]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_has_its_gradient_in_half_grey_levels_for_two_pixels() {
        let mut gradients = Gradients::<40>::new();
        gradients.start(40);
        for y in 0..20_u8 {
            let row: [u8; 40] = core::array::from_fn(|x| 20 + 3 * y + u8::try_from(x).unwrap());
            gradients.push(Some(&row));
        }
        let (mut across, mut down) = ([0; 40], [0; 40]);
        // What is asked for must still be there: nine rows about row 15.
        gradients.row(15, &mut across, &mut down);
        assert_eq!((across[20], down[20]), (31 + 4, 31 + 12));
        assert!(across[4..36].iter().all(|&g| g == 35) && down[4..36].iter().all(|&g| g == 43));
    }

    #[test]
    fn the_slopes_taps_are_the_difference_of_the_smoothings() {
        let tap = |i: usize| i32::from(i < 7) * SMOOTH.get(i).copied().unwrap_or(0);
        for (i, slope) in SLOPE.iter().enumerate() {
            let (later, earlier) = (i.checked_sub(2).map_or(0, tap), tap(i));
            assert_eq!(*slope, later - earlier);
        }
    }
}
