//! All that is put right of a rig's views.

use super::lens_rows::Schedule;
use super::{LensTable, Ramp};
use crate::Correction;

/// What is put right of two cameras' views, before matching and after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rectification {
    /// Where the right view has the left one's rows. Without effect where there are lens tables.
    pub ramp: Ramp,
    /// Whole columns by which the right view shows everything too far right. Without effect where there are lens tables.
    pub columns: i16,
    /// Where the left and the right camera saw what the rectified views show.
    pub lenses: Option<[LensTable; 2]>,
    /// What is added to disparities.
    pub correction: Option<Correction>,
}

impl Rectification {
    /// Whether the views are left as they are.
    #[must_use]
    pub const fn is_straight(&self) -> bool {
        self.lenses.is_none() && self.ramp.is_straight() && self.columns == 0
    }

    /// Rows of both views of `size` px together that must wait for each other: the capacity of a
    /// [`Rectifier`](super::Rectifier); 0 where the views are left as they are.
    #[must_use]
    pub fn rows_needed(&self, size: [u16; 2]) -> usize {
        match &self.lenses {
            Some(lenses) => Schedule::of(lenses).rows.iter().sum(),
            None if self.is_straight() => 0,
            None => self.ramp.rows_needed(size),
        }
    }
}

impl From<Ramp> for Rectification {
    fn from(ramp: Ramp) -> Self {
        Self { ramp, ..Self::default() }
    }
}
