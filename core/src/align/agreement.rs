//! Whether blocks, and frames, agree about the row offset: of views of different moments they do not.

/// Columns of a view at which blocks may lie a row from the ramp: what lenses bend goes with the size.
const COLUMNS: i32 = 320;

/// Sums over the blocks of a pass.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Agreement {
    /// Weights of the blocks near the ramp, and of all.
    near: u64,
    all: u64,
    frame: Sums,
    /// The same over frames.
    frames: Sums,
}

/// Weights, these times offsets (1/256 px), and times their squares.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    weight: u64,
    q8: i64,
    squares: i64,
}

impl Sums {
    fn add(&mut self, q8: i64, weight: u64) {
        let signed = weight.cast_signed();
        self.weight += weight;
        self.q8 += signed * q8;
        self.squares += signed * q8 * q8;
    }

    /// Mean and mean square, 1/256 px.
    fn means(&self) -> Option<[i64; 2]> {
        let weight = self.weight.cast_signed();
        (weight > 0).then(|| [self.q8 / weight, self.squares / weight])
    }
}

impl Agreement {
    /// Adds a block of a view of that width whose offset is `q8` / 256 px off the ramp: it `stands_out` so much, and counts
    /// `weight` by where it lies.
    pub(super) fn add(&mut self, width: u16, q8: i32, stands_out: u32, weight: u32) {
        let reach = (256 * i32::from(width) / COLUMNS).max(256);
        self.near += u64::from(if q8.abs() < reach { stands_out } else { 0 });
        self.all += u64::from(stands_out);
        self.frame.add(q8.into(), weight.into());
    }

    /// Adds a block whose offset lies beyond what was compared.
    pub(super) fn add_beyond(&mut self, stands_out: u32) {
        self.all += u64::from(stands_out);
    }

    pub(super) fn end_frame(&mut self) {
        if let Some([mean, _]) = core::mem::take(&mut self.frame).means() {
            self.frames.add(mean, 1);
        }
    }

    /// Percent of the blocks, by what they stand out, that lie near the ramp.
    pub(super) fn percent(&self) -> u32 {
        u32::try_from(100 * self.near / self.all.max(1)).unwrap_or(0)
    }

    /// Standard deviation of the frames' own row offsets, 1/65536 px; 0 of one frame.
    pub(super) fn spread_q16(&self) -> u32 {
        let [mean, square] = self.frames.means().unwrap_or([0; 2]);
        u32::try_from(((square - mean * mean).max(0) << 16).isqrt()).unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_agree_within_a_row_or_more_of_wide_views() {
        let percent = |width: u16| {
            let mut agreement = Agreement::default();
            for q8 in [0, 200, -255, 300] {
                agreement.add(width, q8, 1000, 1);
            }
            agreement.add_beyond(1000);
            agreement.percent()
        };
        assert_eq!([percent(128), percent(320), percent(640)], [60, 60, 80]);
        assert_eq!(Agreement::default().percent(), 0);
    }

    #[test]
    fn frames_that_jump_spread() {
        let spread = |offsets: [i32; 4]| {
            let mut agreement = Agreement::default();
            for q8 in offsets {
                for beside in [-60, 60] {
                    agreement.add(320, q8 + beside, 1000, 500);
                }
                agreement.end_frame();
            }
            agreement.spread_q16()
        };
        assert_eq!(spread([7; 4]), 0);
        // 64 / 256 px.
        assert_eq!(spread([-64, 64, 64, -64]), 1 << 14);
    }
}
