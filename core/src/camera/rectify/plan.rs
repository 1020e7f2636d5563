//! Whether two views can be put right with the rows that there is room for.

use super::lens_rows::{Schedule, columns_needed};
use super::ring::Ring;
use super::{Offset, Rectification};
use crate::ConfigError;
use crate::lanes::lens_runs::LEN;

/// How rows wait for what puts two views right.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plan {
    pub(super) size: [u16; 2],
    pub(super) rectification: Rectification,
    /// Rows that an answer waits.
    pub(super) waits: usize,
    /// Rows of each view that the ring holds.
    pub(super) rows: [usize; 2],
}

impl Plan {
    /// For a ring of so many rows of such a width.
    ///
    /// # Errors
    /// As [`Rectifier::new`](super::Rectifier::new).
    pub(super) fn new(
        size: [u16; 2],
        rectification: Rectification,
        [capacity, width]: [usize; 2],
    ) -> Result<Self, ConfigError> {
        let Rectification { ramp, columns, lenses, .. } = rectification;
        if usize::from(size[0]) > width {
            return Err(ConfigError::Capacity { max_width: u16::try_from(width).unwrap_or(u16::MAX) });
        }
        if !ramp.is_valid() {
            return Err(ConfigError::RowOffset { max_rows: Offset::MAX_ROWS.unsigned_abs() });
        }
        if columns.unsigned_abs() > Offset::MAX_COLUMNS.unsigned_abs() {
            return Err(ConfigError::ColumnOffset);
        }
        if lenses.is_some_and(|lenses| lenses.iter().any(|table| table.size() != size)) {
            return Err(ConfigError::LensSize);
        }
        if lenses.is_some() && columns_needed(size[0]) > width {
            return Err(ConfigError::Capacity { max_width: u16::try_from(width / (2 * LEN) * 32).unwrap_or(u16::MAX) });
        }
        let ([left, right], waits) = match &lenses {
            Some(lenses) => {
                let schedule = Schedule::of(lenses);
                (schedule.rows, schedule.waits)
            }
            None => {
                let rows = ramp.rows_of_views(size);
                (rows, rows[0] - 1 - usize::from(ramp.is_between_rows()))
            }
        };
        if left + right > capacity || left.max(right) > Ring::MAX_ROWS {
            let count = |rows: usize| u16::try_from(rows).unwrap_or(u16::MAX);
            return Err(ConfigError::RingRows { needed: count(left + right), rows: count(capacity) });
        }
        Ok(Self { size, rectification, waits, rows: [left, right] })
    }
}
