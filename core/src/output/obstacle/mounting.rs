//! How the left camera stands.

/// How the left camera stands over the ground, and what is in the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mounting {
    /// Height of the camera over the ground, mm, within ±[`Mounting::MAX_MM`].
    pub height_mm: i32,
    /// Sine of its pitch, 1/16384; upwards is positive.
    pub sin_pitch_q14: i16,
    /// Cosine of its pitch, 1/16384, greater than 0.
    pub cos_pitch_q14: i16,
    /// Least height over the ground that is in the way, mm, within ±[`Mounting::MAX_MM`].
    pub lowest_mm: i32,
    /// Greatest height over the ground that is in the way, mm, greater than `lowest_mm`, within
    /// ±[`Mounting::MAX_MM`].
    pub highest_mm: i32,
}

impl Mounting {
    /// Greatest magnitude of any height, mm.
    pub const MAX_MM: i32 = 20_000;
    /// One, as a sine or cosine.
    const ONE: i16 = 1 << 14;

    pub(super) fn is_valid(&self) -> bool {
        let Self { height_mm, sin_pitch_q14, cos_pitch_q14, lowest_mm, highest_mm } = *self;
        let fits = |mm: i32| mm.unsigned_abs() <= Self::MAX_MM.unsigned_abs();
        let is_angle =
            sin_pitch_q14.unsigned_abs() <= Self::ONE.unsigned_abs() && (1..=Self::ONE).contains(&cos_pitch_q14);
        is_angle && [height_mm, lowest_mm, highest_mm].into_iter().all(fits) && lowest_mm < highest_mm
    }
}
