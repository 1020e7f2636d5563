//! How cells come to their labels, and what is kept for that.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "a handful of rows"
)]

use crate::answer::cell_row::CellRow;
use crate::front_end::camera_view::FeatureRows;
use crate::matching::agreement::Penalties;
use crate::matching::path::Paths;
use crate::matching::tile::{CellCost, OwnCost, SharedCost};

/// How the cells of a method by tiles come to their labels, and what is kept for that.
pub trait Matching: Sealed {
    /// Whether neighbouring cells agree on their labels; else each decides alone.
    const AGREEMENT: bool;
    /// Rows of cells of a row of tiles, 1 or 2: cells are as high as a tile, or half as high.
    const ROWS: u32;
    /// Whether an extremum search decides whole blocks, and their cells follow.
    const SEARCH: bool = false;
    /// What a label costs a cell.
    type Cost: CellCost;
    /// The paths of the agreement.
    type Paths<const WORDS: usize>: MaybePaths<WORDS> + Clone + core::fmt::Debug;
    /// Features of a view: those of the row of tiles that comes in, of the one that is matched and of the one that is answered.
    type Features<const WORDS: usize>: FeatureRows<WORDS> + Clone + core::fmt::Debug;
    /// Cell rows: three for an answer and those under way.
    type Cells<const WORDS: usize>: CellRows<WORDS> + Clone + core::fmt::Debug;
    /// What a label costs a cell, and what it pays for its neighbours' not having it.
    #[doc(hidden)]
    fn costs(is_noisy: bool) -> (Self::Cost, Penalties);
}

/// Neighbouring cells agree.
#[derive(Debug, Clone, Copy)]
pub enum Agreeing {}

/// Each cell decides alone.
#[derive(Debug, Clone, Copy)]
pub enum Lonely {}

/// An extremum search decides each block.
#[derive(Debug, Clone, Copy)]
pub enum Searching {}

impl Matching for Searching {
    const AGREEMENT: bool = false;
    const ROWS: u32 = 1;
    const SEARCH: bool = true;
    type Cost = SharedCost;
    type Paths<const WORDS: usize> = ();
    type Features<const WORDS: usize> = <Lonely as Matching>::Features<WORDS>;
    type Cells<const WORDS: usize> = <Lonely as Matching>::Cells<WORDS>;

    fn costs(is_noisy: bool) -> (SharedCost, Penalties) {
        Lonely::costs(is_noisy)
    }
}

impl Matching for Agreeing {
    const AGREEMENT: bool = true;
    const ROWS: u32 = 2;
    type Cost = OwnCost;
    type Paths<const WORDS: usize> = Paths<WORDS>;
    type Features<const WORDS: usize> = [[[u32; WORDS]; 4]; 3];
    type Cells<const WORDS: usize> = [CellRow<WORDS>; 5];

    fn costs(is_noisy: bool) -> (OwnCost, Penalties) {
        if is_noisy {
            (OwnCost { shift: 2 }, Penalties::new(5, 34))
        } else {
            (OwnCost { shift: 1 }, Penalties::new(4, 24))
        }
    }
}

impl Matching for Lonely {
    const AGREEMENT: bool = false;
    const ROWS: u32 = 1;
    type Cost = SharedCost;
    type Paths<const WORDS: usize> = ();
    // A row of tiles is answered before its lower half is overwritten.
    type Features<const WORDS: usize> = [[[u32; WORDS]; 4]; 2];
    type Cells<const WORDS: usize> = [CellRow<WORDS>; 3];

    fn costs(is_noisy: bool) -> (SharedCost, Penalties) {
        if is_noisy {
            (SharedCost { cell: 21, tile: 7 }, Penalties::new(2, 16))
        } else {
            (SharedCost { cell: 11, tile: 3 }, Penalties::new(1, 3))
        }
    }
}

/// Closes [`Matching`] to others.
pub trait Sealed {}
impl Sealed for Agreeing {}
impl Sealed for Lonely {}
impl Sealed for Searching {}

/// Paths, where there is an agreement.
pub trait MaybePaths<const WORDS: usize> {
    /// Before any row.
    const EMPTY: Self;
    /// The paths.
    fn paths(&mut self) -> Option<&mut Paths<WORDS>>;
}

impl<const WORDS: usize> MaybePaths<WORDS> for () {
    const EMPTY: Self = ();
    fn paths(&mut self) -> Option<&mut Paths<WORDS>> {
        None
    }
}

impl<const WORDS: usize> MaybePaths<WORDS> for Paths<WORDS> {
    const EMPTY: Self = Self::new();
    fn paths(&mut self) -> Option<&mut Paths<WORDS>> {
        Some(self)
    }
}

/// The newest cell rows.
pub trait CellRows<const WORDS: usize> {
    /// Before any.
    const EMPTY: Self;
    /// How many there are.
    const LEN: u32;
    /// All of them; row `y` is at `y % LEN`.
    fn rows(&mut self) -> &mut [CellRow<WORDS>];
    /// The row `y`.
    fn row(&self, y: u32) -> &CellRow<WORDS>;
}

impl<const WORDS: usize, const LEN: usize> CellRows<WORDS> for [CellRow<WORDS>; LEN] {
    const EMPTY: Self = [const { CellRow::EMPTY }; LEN];
    const LEN: u32 = LEN as u32;
    fn rows(&mut self) -> &mut [CellRow<WORDS>] {
        self
    }
    fn row(&self, y: u32) -> &CellRow<WORDS> {
        &self[y as usize % LEN]
    }
}
