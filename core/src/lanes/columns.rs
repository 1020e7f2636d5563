//! Four columns of a row of tiles, two cells, and what is decided of them.
#![cfg_attr(haarline_sse2, allow(dead_code, reason = "what goes word by word is held against the quads in tests"))]

/// Four columns of a row of tiles: two cells, one above the other.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct Column {
    /// Costs of the upper and the lower cell.
    pub(crate) costs: [u32; 2],
    /// Sums of the paths along the row.
    pub(crate) along: [u32; 2],
    /// Labels of the tile in its left column, of the tile above in its right one until its cells are decided.
    pub(crate) labels: u32,
    /// Of the lower cell above: sums of the path from the top and then what they tell the cell below, sums of all paths so
    /// far, and its costs.
    pub(crate) from_top: u32,
    pub(crate) pending: u32,
    pub(crate) costs_above: u32,
}

impl Column {
    /// Nothing yet.
    pub(crate) const EMPTY: Self =
        Self { costs: [0; 2], along: [0; 2], labels: 0, from_top: 0, pending: 0, costs_above: 0 };
}

/// What a column decides: the upper cell's label, value and merit, and the label that the lower one has so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Decided {
    pub(crate) value: u16,
    pub(crate) label: u8,
    pub(crate) merit: u8,
    pub(crate) lower_label: u8,
}

/// What a step from one label of a tile to the next one costs: the slope's price where that is one more, else 255.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Steps {
    /// From the label of a lane to that of the next one.
    pub(crate) up: u32,
    /// From the label of a lane to that of the one before.
    pub(crate) down: u32,
}

impl Steps {
    /// Less than 255 in the lanes whose neighbours are the labels one less and one more.
    #[inline(always)]
    pub(crate) const fn both(self) -> u32 {
        self.up | self.down
    }
}
