//! Which of the newest rows did not come: what a pipeline keeps until they are delivered.

/// Rows that are remembered: more than any latency.
const KEPT: u32 = 64;

/// Which of the last 64 rows of a frame were missing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MissingRows(u64);

impl MissingRows {
    pub(crate) const NONE: Self = Self(0);

    /// Whether row `y` was missing.
    pub(crate) const fn has(self, y: u32) -> bool {
        self.0 >> (y % KEPT) & 1 == 1
    }

    /// Whether row `y` or one of the two before it was: second differences span three rows, and a stand-in has no noise
    /// of its own.
    pub(crate) fn has_any_of_three(self, y: u32) -> bool {
        (0..3).any(|back| self.has(y.wrapping_sub(back)))
    }

    /// Notes whether row `y` is missing.
    pub(crate) const fn set(&mut self, y: u32, missing: bool) {
        let bit = 1 << (y % KEPT);
        self.0 = self.0 & !bit | if missing { bit } else { 0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_remembered_until_its_place_is_needed() {
        let mut missing = MissingRows::NONE;
        missing.set(5, true);
        missing.set(6, false);
        assert!(missing.has(5) && !missing.has(6) && !missing.has(4));
        missing.set(5 + KEPT, false);
        assert!(!missing.has(5 + KEPT));
    }

    #[test]
    fn three_rows_are_whole_or_not() {
        let mut missing = MissingRows::NONE;
        missing.set(5, true);
        assert_eq!([4, 5, 6, 7, 8].map(|y| missing.has_any_of_three(y)), [false, true, true, true, false]);
        assert!(!MissingRows::NONE.has_any_of_three(0), "rows above the image are not missing");
    }
}
