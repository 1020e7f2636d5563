//! What is added to disparities by column and row: what lenses leave that nobody straightened.

use crate::Disparity;

/// A coarse table of what is added to disparities, bilinear between its nodes.
///
/// The first and the last node of a row lie on the first and the last column of the view, those between at even distances; rows
/// of nodes likewise, and one row alone holds for all. Nodes are in 1/256 px.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Correction {
    nodes: &'static [i16],
    columns: u16,
    size: [u16; 2],
    /// Whether it is the same in all columns.
    is_flat: bool,
}

impl Correction {
    /// Most nodes across and down.
    pub const MAX_NODES: [usize; 2] = [33, 25];
    /// Most that is added or taken away, 1/256 px: 64 px.
    pub const MAX_NODE: u16 = 64 << 8;

    /// `nodes` row by row, `columns` in each; `None` unless there are 2 to 33 columns and 1 to 25 rows, and all are within
    /// ±[`Correction::MAX_NODE`].
    #[must_use]
    pub const fn new(columns: u16, nodes: &'static [i16]) -> Option<Self> {
        let count = columns as usize;
        if count < 2 || count > Self::MAX_NODES[0] || nodes.is_empty() || !nodes.len().is_multiple_of(count) {
            return None;
        }
        if nodes.len() / count > Self::MAX_NODES[1] {
            return None;
        }
        let (mut i, mut is_flat) = (0, true);
        while i < nodes.len() {
            if nodes[i].unsigned_abs() > Self::MAX_NODE {
                return None;
            }
            is_flat = is_flat && nodes[i] == nodes[i - i % count];
            i += 1;
        }
        Some(Self { nodes, columns, size: [0; 2], is_flat })
    }

    /// The same for views of that size, px.
    #[must_use]
    pub const fn of_size(self, size: [u16; 2]) -> Self {
        Self { size, ..self }
    }

    /// Nodes in a row.
    #[must_use]
    pub const fn columns(&self) -> u16 {
        self.columns
    }

    /// The nodes, row by row, 1/256 px.
    #[must_use]
    pub const fn nodes(&self) -> &'static [i16] {
        self.nodes
    }

    /// Adds it to the disparities of row `y`. What is unknown stays so.
    ///
    /// What is the same in all columns is so in four rows, too, those of a tile: rows of a row of cells stay such.
    pub fn apply(&self, y: u32, row: &mut [Disparity]) {
        let columns = usize::from(self.columns);
        let y = if self.is_flat { y / TILE_ROWS * TILE_ROWS + TILE_ROWS / 2 } else { y };
        let rows = self.nodes.len() / columns.max(1);
        // Nodes above and below, and how far from one to the other, 1/256.
        let down =
            y.min(u32::from(self.size[1]).saturating_sub(1)) * u32::try_from(rows.saturating_sub(1)).unwrap_or(0);
        let last = u32::from(self.size[1]).saturating_sub(1).max(1);
        let (above, weight) = ((down / last) as usize, (256 * (down % last) / last).cast_signed());
        let nodes = |j: usize| self.nodes.get(j.min(rows.saturating_sub(1)) * columns..).unwrap_or(&[]);
        let (above, below) = (nodes(above), nodes(above + 1));
        // 1/65536 px.
        let node = |i: usize| {
            let [above, below] = [above, below].map(|row| row.get(i).copied().map_or(0, i32::from));
            above * (256 - weight) + below * weight
        };
        if self.is_flat {
            return add_to_all(row, (node(0) + (1 << 11)) >> 12);
        }
        let (span, segments) = (row.len().saturating_sub(1), columns.saturating_sub(1).max(1));
        for segment in 0..segments {
            let first = (segment * span).div_ceil(segments);
            let end = if segment + 1 == segments { row.len() } else { ((segment + 1) * span).div_ceil(segments) };
            let Some(part) = row.get_mut(first..end) else { continue };
            // Columns times segments from the segment's left node, so that all is whole.
            let scale = i32::try_from(span.max(1)).unwrap_or(i32::MAX);
            let rise = node(segment + 1) - node(segment);
            let step = rise * i32::try_from(segments).unwrap_or(1) / scale;
            let from_node = i32::try_from(first * segments - segment * span).unwrap_or(0);
            // To the nearest 1/16 px.
            let mut add =
                node(segment) + i32::try_from(i64::from(rise) * i64::from(from_node) / i64::from(scale)).unwrap_or(0);
            add += 1 << 11;
            for disparity in part {
                *disparity = sum(*disparity, add >> 12);
                add += step;
            }
        }
    }
}

/// Rows of a tile.
const TILE_ROWS: u32 = 4;

/// A disparity and some sixteenths of a px more.
#[inline(always)]
fn sum(disparity: Disparity, add: i32) -> Disparity {
    disparity.known().map_or(disparity, |bits| {
        let sum = (i32::from(bits) + add).clamp(i32::from(i16::MIN) + 1, i32::from(i16::MAX));
        Disparity::from_bits(i16::try_from(sum).unwrap_or(bits))
    })
}

#[inline(never)]
fn add_to_all(row: &mut [Disparity], add: i32) {
    // 64 px at most.
    let add = i16::try_from(add).unwrap_or(0);
    for disparity in row {
        let bits = disparity.into_bits();
        if bits != Disparity::UNKNOWN.into_bits() {
            *disparity = Disparity::from_bits(bits.saturating_add(add).max(i16::MIN + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is added in a row, 1/16 px.
    fn added(correction: Correction, size: [u16; 2], y: u32) -> [i16; 65] {
        let mut row = [Disparity::from_bits(320); 65];
        row[3] = Disparity::UNKNOWN;
        correction.of_size(size).apply(y, &mut row);
        assert_eq!(row[3], Disparity::UNKNOWN);
        row.map(|disparity| disparity.known().map_or(0, |bits| bits - 320))
    }

    #[test]
    fn nodes_are_hit_and_between_them_it_is_linear() {
        let correction = Correction::new(3, &[256, -512, 1024]).unwrap();
        let row = added(correction, [65, 40], 7);
        assert_eq!([row[0], row[16], row[32], row[48], row[64]], [16, -8, -32, 16, 64]);
        for x in 4..64 {
            assert!((row[x + 1] - row[x]).abs() <= 4, "{x}");
        }
        let down = Correction::new(2, &[0, 0, 512, 512, 0, 1]).unwrap();
        assert_eq!([0, 10, 20, 30, 40].map(|y| added(down, [65, 41], y)[40]), [0, 16, 32, 16, 0]);
    }

    #[test]
    fn every_width_and_number_of_nodes_is_followed() {
        static NODES: [i16; 10] = [0, 100, 300, -200, 500, 900, -900, 20, 0, 40];
        for columns in [2, 5, 10] {
            let correction = Correction::new(columns, &NODES).unwrap();
            let first = &NODES[..usize::from(columns)];
            let row = added(correction, [65, 1], 0);
            for (x, &found) in row.iter().enumerate().filter(|(x, _)| *x != 3) {
                #[expect(clippy::cast_precision_loss, reason = "small")]
                let place = x as f64 * f64::from(columns - 1) / 64.0;
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
                let at = (place as usize).min(first.len() - 2);
                #[expect(clippy::cast_precision_loss, reason = "small")]
                let t = place - at as f64;
                let wanted = (f64::from(first[at]) * (1.0 - t) + f64::from(first[at + 1]) * t) / 16.0;
                assert!((f64::from(found) - wanted).abs() <= 0.6, "{columns}, {x}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn what_is_no_table_is_none() {
        assert!(Correction::new(1, &[0]).is_none() && Correction::new(2, &[0, 0, 0]).is_none());
        assert!(Correction::new(2, &[0, i16::MIN]).is_none() && Correction::new(34, &[0; 34]).is_none());
    }

    #[test]
    fn what_is_the_same_in_all_columns_is_so_in_the_rows_of_a_tile() {
        // From 8 px above to as much less below.
        let correction = Correction::new(2, &[2048, 2048, -2048, -2048]).unwrap();
        for y in 0..64 {
            let [first, .., last] = added(correction, [65, 64], y);
            let exact = 128.0 - 256.0 * (f64::from(y / 4 * 4) + 2.0) / 63.0;
            assert!(first == last && (f64::from(first) - exact).abs() <= 1.1, "{y}: {first}, {exact}");
        }
    }
}
