//! Row offsets by place: what the blocks of the last pass show in every part of the view.

/// Parts of the view across and down.
pub(super) const PARTS: [usize; 2] = [10, 6];
/// Weight of the blocks that a part needs to say anything: two that stand out entirely, or more that do less.
const LEAST_WEIGHT: u64 = 2 * 4095;

/// Sums over the blocks of each part.
#[derive(Debug, Clone)]
pub(super) struct Places {
    parts: [[Part; PARTS[0]]; PARTS[1]],
}

#[derive(Debug, Clone, Copy, Default)]
struct Part {
    weight: u64,
    /// Weights times offsets, 1/65536 px.
    rows: i64,
}

impl Places {
    pub(super) const fn new() -> Self {
        Self { parts: [[Part { weight: 0, rows: 0 }; PARTS[0]]; PARTS[1]] }
    }

    pub(super) fn clear(&mut self) {
        self.parts = Self::new().parts;
    }

    /// Adds a block at twice that distance from the middle of views of `size` px, with its row offset.
    pub(super) fn add(&mut self, twice: [i32; 2], size: [u16; 2], rows_q16: i32, weight: u32) {
        let part = |j: usize| {
            let at = usize::try_from(twice[j] + i32::from(size[j])).unwrap_or(0);
            at * PARTS[j] / (2 * usize::from(size[j]))
        };
        if let Some(part) = self.parts.get_mut(part(1)).and_then(|row| row.get_mut(part(0))) {
            part.weight += u64::from(weight);
            part.rows += i64::from(weight) * i64::from(rows_q16);
        }
    }

    /// The row offset of a part, 1/65536 px; `None` where too little is seen.
    pub(super) fn rows_q16(&self, [across, down]: [usize; 2]) -> Option<i32> {
        let part = self.parts.get(down)?.get(across).filter(|part| part.weight >= LEAST_WEIGHT)?;
        i32::try_from(part.rows / i64::try_from(part.weight).ok()?).ok()
    }
}
