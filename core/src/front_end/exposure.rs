//! How dark the frame is, judged from the rows that came so far: what gain the front end gives it.

/// One pixel in so many may saturate.
const BRIGHT_SHARE: u32 = 50;

/// Counts of bright pixels in both views.
#[derive(Debug, Clone, Default)]
pub(crate) struct Exposure {
    total: u32,
    over_quarter: u32,
    over_half: u32,
    over_sixteenth: u32,
}

/// Gain of the front end as a power of two: grey levels are shifted left by 0, 1 or 2.
///
/// In low light the sensor uses a quarter or half of its range. All thresholds are made for the whole
/// range, and smoothing leaves fractions of a grey level that a gain keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Gain(u32);

impl Exposure {
    pub(crate) const fn new() -> Self {
        Self { total: 0, over_quarter: 0, over_half: 0, over_sixteenth: 0 }
    }

    /// Takes every `stride`-th pixel from `first` on into account.
    pub(crate) fn sample(&mut self, pixels: &[u8], first: usize, stride: usize) {
        for &pixel in pixels.iter().skip(first).step_by(stride) {
            self.total += 1;
            self.over_quarter += u32::from(pixel >= 64);
            self.over_half += u32::from(pixel >= 128);
            self.over_sixteenth += u32::from(pixel >= 16);
        }
        self.bound();
    }

    /// Halves the counts long before 32 bits are full, whatever the frame's height.
    fn bound(&mut self) {
        if self.total >= 1 << 24 {
            for count in [&mut self.total, &mut self.over_quarter, &mut self.over_half, &mut self.over_sixteenth] {
                *count /= 2;
            }
        }
    }

    /// Whether hardly a pixel reaches a sixteenth of the range: a lens cap, a night.
    pub(crate) const fn is_dark(&self) -> bool {
        self.over_sixteenth * BRIGHT_SHARE < self.total
    }

    /// The greatest gain that saturates no more than 2 percent of the pixels.
    pub(crate) const fn gain(&self) -> Gain {
        if self.over_quarter * BRIGHT_SHARE < self.total {
            Gain(2)
        } else if self.over_half * BRIGHT_SHARE < self.total {
            Gain(1)
        } else {
            Gain(0)
        }
    }
}

impl Gain {
    /// How many times grey levels are doubled.
    pub(crate) const fn doublings(self) -> u32 {
        self.0
    }

    /// A measure of grey levels as it is after the gain.
    pub(crate) const fn apply(self, grey_levels: u32) -> u32 {
        grey_levels << self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain_of(pixels: &[u8]) -> Gain {
        let mut exposure = Exposure::new();
        exposure.sample(pixels, 0, 4);
        exposure.gain()
    }

    #[test]
    fn a_dark_frame_gets_what_it_has_room_for() {
        assert_eq!(gain_of(&[63; 400]), Gain(2));
        assert_eq!(gain_of(&[64; 400]), Gain(1));
        assert_eq!(gain_of(&[128; 400]), Gain(0));
        assert_eq!(Exposure::new().gain(), Gain(0));
    }
}
