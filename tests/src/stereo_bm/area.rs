//! Which columns are answered, and which columns of the two views are compared for them.

use haarline::Config;

use super::sums::Place;

/// The columns of a search: how a *cost column*, counted from 0, maps to both views.
///
/// Cost column `c` compares column `left_column(c)` of the left view with the `num_disparities`
/// columns of the right view from `right_column(c)` on. Going right in the right view is going down
/// in disparity, so cost 0 of a column belongs to the greatest disparity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SearchArea {
    /// First answered column of the left view; its window begins at cost column 0.
    pub first: usize,
    /// Column after the last answered one.
    pub end: usize,
    /// Cost columns that are needed.
    pub cost_columns: usize,
    /// Column of the left view at cost column 0.
    left_offset: usize,
    /// First column of the right view at cost column 0.
    right_offset: usize,
    /// Greatest first column of the right view.
    right_last: usize,
}

impl SearchArea {
    /// The area that OpenCV answers, or `None` if it is empty: the window must lie inside the left
    /// view, and every disparity of its centre inside the right one.
    pub fn new(config: &Config, radius: usize) -> Option<Self> {
        let width = usize::from(config.width);
        let searched = usize::from(config.num_disparities);
        let max_disparity = i32::from(config.num_disparities) - 1 + i32::from(config.min_disparity);
        let positive_part = |px: i32| usize::try_from(px).unwrap_or(0);
        let left_offset = positive_part(max_disparity);
        let right_offset = positive_part(-max_disparity);

        let centres = (width + 1).checked_sub(right_offset + searched)?;
        let first = left_offset + radius;
        let end = (width - radius).min(left_offset + centres);
        if first >= end {
            return None;
        }
        Some(Self {
            first,
            end,
            cost_columns: end - first + 2 * radius,
            left_offset,
            right_offset,
            right_last: width - searched,
        })
    }

    /// A cost column and what it compares.
    pub fn place(&self, cost_column: usize) -> Place {
        Place { column: cost_column, left: self.left_column(cost_column), right: self.right_column(cost_column) }
    }

    /// Column of the left view. Inside it, since windows are.
    pub fn left_column(&self, cost_column: usize) -> usize {
        self.left_offset + cost_column
    }

    /// First column of the right view, the greatest disparity's. Where a negative `min_disparity`
    /// asks beyond the right edge, the last whole range stands in.
    pub fn right_column(&self, cost_column: usize) -> usize {
        (self.right_offset + cost_column).min(self.right_last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(width: u16, min_disparity: i16, num_disparities: u16, radius: usize) -> Option<SearchArea> {
        SearchArea::new(&Config { width, min_disparity, num_disparities }, radius)
    }

    #[test]
    fn every_compared_column_exists() {
        for width in [32_u16, 33, 64, 100] {
            for min_disparity in -128..=128 {
                for num_disparities in 1..=width {
                    let Some(area) = area(width, min_disparity, num_disparities, 4) else { continue };
                    let last = area.cost_columns - 1;
                    let case = (width, min_disparity, num_disparities);
                    assert!(area.end <= usize::from(width), "{case:?}");
                    assert!(area.left_column(last) < usize::from(width), "{case:?}");
                    assert!(area.right_column(last) + usize::from(num_disparities) <= usize::from(width), "{case:?}");
                }
            }
        }
    }

    #[test]
    fn the_default_search_leaves_range_and_window_out() {
        let area = area(320, 0, 64, 4).unwrap();
        assert_eq!((area.first, area.end), (63 + 4, 320 - 4));
    }

    #[test]
    fn no_column_is_left_when_the_range_fills_the_row() {
        assert_eq!(area(64, 0, 64, 4), None);
        assert_eq!(area(32, 128, 16, 4), None);
        assert_eq!(area(32, -128, 16, 4), None);
    }
}
