//! What an alignment found, and what it is worth.

use crate::Ramp;

/// What an alignment found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Estimate {
    /// Row offset, roll and scale of the right view.
    pub ramp: Ramp,
    /// Standard errors of the three, 1/65536: of the fit alone, without what all blocks have in common.
    pub errors_q16: [u32; 3],
    /// By how much two rows off cost more than the offset found, percent.
    pub contrast_percent: u32,
    /// Share of the blocks, by what they stand out, that lie within a row of the fit (a 320th of the width of wide views), percent.
    pub agreement_percent: u32,
    /// Standard deviation of the frames' own row offsets, 1/65536 px; 0 of one frame.
    pub spread_q16: u32,
    /// Standard deviation of the noise of both views together, 1/16 grey level.
    pub noise_q4: u32,
    /// Blocks that the last pass fitted.
    pub blocks: u32,
    /// Frames of the last pass.
    pub frames: u32,
    /// Evaluations of the extremum search in the first pass.
    pub evaluations: u32,
    /// Columns of a view.
    pub width: u16,
    /// Least and greatest disparity that the views show, px, as far as blocks at half the size tell.
    pub disparities: [i16; 2],
    /// Their median, px.
    pub median_disparity: i16,
    /// Correlation of disparity and row, percent.
    pub ground_percent: i8,
}

/// Whether the views show how they are aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The row offset is known.
    Observable,
    /// Too little texture, or surfaces that look alike in several rows.
    NotObservable,
    /// Blocks or frames say different things: views of different moments.
    Contradictory,
    /// The offset lies beyond what is searched.
    OutOfRange,
}

/// Which view is the left one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// They are as they were given.
    AsGiven,
    /// They are swapped.
    Swapped,
    /// One cue says this, the other that.
    Contradictory,
    /// The views do not tell.
    NotObservable,
}

impl Estimate {
    /// Percent of contrast below which nothing is answered.
    pub const LEAST_CONTRAST_PERCENT: u32 = 11;
    /// Standard error of the row offset that one frame may have, 1/65536 px: 0.055 px.
    pub const MOST_FRAME_ERROR_Q16: u32 = 3604;
    /// Most spread of the frames' row offsets, 1/65536 px: 0.0625 px. Of recordings with views of one moment it stays under 0.035.
    pub const MOST_SPREAD_Q16: u32 = 1 << 12;
    /// Evidence that the order of the views needs, percent of what [`Estimate::sign_evidence`] and
    /// [`Estimate::ground_evidence`] count as 1.
    const LEAST_EVIDENCE: i32 = 140;
    /// Roll up to which the ground is heard, 1/65536: 1.5 degrees.
    const MOST_GROUND_ROLL_Q16: i32 = 1716;
    /// What a cue has to say to be heard at all.
    const SPEAKS: i32 = 50;

    /// What the standard error of the row offset would be of one such frame, 1/65536 px.
    #[must_use]
    pub const fn frame_error_q16(&self) -> u32 {
        self.errors_q16[0].saturating_mul((16 * self.frames).isqrt()) / 4
    }

    /// Percent of agreement below which the views show different things; noise makes blocks disagree, too.
    ///
    /// Of the 870 pairs of the views of 30 frames of a hand-held scene that are not of one moment 1 in 100 is answered wrongly,
    /// without this test 1 in 9.
    #[must_use]
    pub const fn least_agreement_percent(&self) -> u32 {
        let least = 77_u32.saturating_sub(2 * self.noise_q4 / 16);
        if least > 60 { least } else { 60 }
    }

    /// Whether the row offset is known: two rows off must cost more, the blocks must agree, and so must the frames.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if self.contrast_percent < Self::LEAST_CONTRAST_PERCENT || self.blocks == 0 {
            Verdict::NotObservable
        } else if self.spread_q16 > Self::MOST_SPREAD_Q16 {
            Verdict::Contradictory
        } else if self.frame_error_q16() > Self::MOST_FRAME_ERROR_Q16 {
            Verdict::NotObservable
        } else if !self.ramp.is_valid() {
            Verdict::OutOfRange
        } else if self.agreement_percent < self.least_agreement_percent() {
            Verdict::Contradictory
        } else {
            Verdict::Observable
        }
    }

    /// What the median disparity says for the views as they were given, percent: 100 at 8 px or, of wide views, a fortieth
    /// of the width. Column offsets of 5 px occur; counts up to 300.
    #[must_use]
    pub fn sign_evidence(&self) -> i32 {
        let one = i32::from(self.width / 40).max(8);
        (i32::from(self.median_disparity) * 100 / one).clamp(-300, 300)
    }

    /// What the ground says, which is nearer below, percent: 100 at a correlation of 0.3; nothing in views that are rolled by more than
    /// 1.5 degrees, whose disparities change from row to row by themselves.
    #[must_use]
    pub fn ground_evidence(&self) -> i32 {
        if self.ramp.roll_q16.abs() > Self::MOST_GROUND_ROLL_Q16 {
            return 0;
        }
        i32::from(self.ground_percent) * 100 / 30
    }

    /// Which view is the left one, by both cues together; what is not aligned has no disparities that tell.
    #[must_use]
    pub fn order(&self) -> Order {
        if matches!(self.verdict(), Verdict::NotObservable | Verdict::Contradictory) {
            return Order::NotObservable;
        }
        let (sign, ground) = (self.sign_evidence(), self.ground_evidence());
        match sign + ground {
            Self::LEAST_EVIDENCE.. => Order::AsGiven,
            sum if sum <= -Self::LEAST_EVIDENCE => Order::Swapped,
            _ if sign.abs().min(ground.abs()) >= Self::SPEAKS && sign.signum() != ground.signum() => {
                Order::Contradictory
            }
            _ => Order::NotObservable,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(median_disparity: i16, ground_percent: i8) -> Estimate {
        Estimate {
            ramp: Ramp::default(),
            errors_q16: [655; 3],
            contrast_percent: 50,
            agreement_percent: 90,
            spread_q16: 0,
            noise_q4: 32,
            blocks: 100,
            frames: 1,
            evaluations: 80,
            width: 128,
            disparities: [0; 2],
            median_disparity,
            ground_percent,
        }
    }

    #[test]
    fn the_order_needs_a_cue_that_is_strong_or_two_that_agree() {
        let order = |median, ground| estimate(median, ground).order();
        assert_eq!([order(4, 30), order(18, -20), order(0, 50)], [Order::AsGiven; 3]);
        assert_eq!([order(-4, -30), order(-18, 20), order(0, -50)], [Order::Swapped; 3]);
        // A column offset of 5 px looks like swapped views.
        assert_eq!([order(-5, 45), order(5, -45)], [Order::Contradictory; 2]);
        assert_eq!([order(-5, 0), order(2, 10), order(0, 0)], [Order::NotObservable; 3]);
        // What rolled views show of the ground does not count, what is not aligned not at all.
        let rolled = Estimate { ramp: Ramp { roll_q16: -3000, ..Ramp::default() }, ..estimate(-4, -50) };
        let unaligned = Estimate { agreement_percent: 50, ..estimate(18, 50) };
        assert_eq!([rolled.order(), unaligned.order()], [Order::NotObservable; 2]);
    }

    #[test]
    fn blocks_that_differ_and_offsets_that_cost_alike_are_no_answer() {
        assert_eq!(estimate(0, 0).verdict(), Verdict::Observable);
        let verdict = |change: fn(&mut Estimate)| {
            let mut changed = estimate(0, 0);
            change(&mut changed);
            changed.verdict()
        };
        assert_eq!(verdict(|e| e.contrast_percent = 10), Verdict::NotObservable);
        assert_eq!(verdict(|e| e.errors_q16[0] = 4000), Verdict::NotObservable);
        assert_eq!(verdict(|e| (e.errors_q16[0], e.frames) = (1000, 20)), Verdict::NotObservable);
        assert_eq!(verdict(|e| e.blocks = 0), Verdict::NotObservable);
        assert_eq!(verdict(|e| e.agreement_percent = 72), Verdict::Contradictory);
        assert_eq!(verdict(|e| (e.agreement_percent, e.noise_q4) = (72, 64)), Verdict::Observable);
        assert_eq!(verdict(|e| (e.agreement_percent, e.noise_q4) = (59, 999)), Verdict::Contradictory);
        assert_eq!(verdict(|e| e.spread_q16 = 4200), Verdict::Contradictory);
        assert_eq!(verdict(|e| e.ramp.rows_q16 = 17 << 16), Verdict::OutOfRange);
        assert_eq!(estimate(0, 0).frame_error_q16(), 655);
    }
}
