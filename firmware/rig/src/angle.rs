//! Sines, cosines and tangents in fixed point, by [`micromath`]: float operations that every machine rounds
//! alike, so that host and chip agree.
//!
//! micromath's sine and cosine are wrong by up to 0.0011. Up to 85 degrees a bearing's tangent is then that
//! of an angle at most 0.07 degrees off, and 1 / cosine is off by at most 0.2 percent up to 60 degrees and 1.1 percent up to
//! 85 (a test holds these).

use micromath::F32Ext;

/// Greatest bearing, degrees.
const MAX_BEARING_DEG: f32 = 85.0;

// Called by the trait's name: where there is `std`, a plain `x.sin()` would be the platform's own.

/// Sine and cosine of a pitch, 1/16384.
pub(crate) fn sin_cos_q14(degrees: f32) -> [i16; 2] {
    let radians = degrees.abs().to_radians();
    let sin = F32Ext::sin(radians).clamp(-1.0, 1.0);
    let cos = F32Ext::cos(radians).clamp(-1.0, 1.0);
    [if degrees < 0.0 { -sin } else { sin }, cos].map(q14)
}

/// Tangent of a bearing, 1/65536.
pub(crate) fn tangent_q16(degrees: f32) -> i32 {
    let radians = bearing(degrees);
    let tangent = nearest(F32Ext::sin(radians) / F32Ext::cos(radians) * 65_536.0);
    if degrees < 0.0 { -tangent } else { tangent }
}

/// 1 / cosine of a bearing, 1/16384; 1 or more.
pub(crate) fn secant_q14(degrees: f32) -> u32 {
    let secant = nearest(16_384.0 / F32Ext::cos(bearing(degrees)));
    secant.unsigned_abs().max(1 << 14)
}

fn bearing(degrees: f32) -> f32 {
    degrees.abs().min(MAX_BEARING_DEG).to_radians()
}

#[expect(clippy::cast_possible_truncation, reason = "at most 12 x 65536")]
fn nearest(value: f32) -> i32 {
    (value + 0.5) as i32
}

#[expect(clippy::cast_possible_truncation, reason = "a sine or cosine")]
fn q14(value: f32) -> i16 {
    F32Ext::round(value * 16_384.0) as i16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tenths of degrees up to that many degrees.
    fn angles(most: u16) -> impl Iterator<Item = f32> {
        (0..=10 * most).map(|tenth| f32::from(tenth) / 10.0)
    }

    #[test]
    fn tangents_are_those_of_an_angle_nearby() {
        for degrees in angles(85) {
            let tangent = f64::from(tangent_q16(degrees)) / 65_536.0;
            assert!((tangent.atan().to_degrees() - f64::from(degrees)).abs() < 0.07, "{degrees}: {tangent}");
            assert_eq!(tangent_q16(-degrees), -tangent_q16(degrees));
        }
    }

    #[test]
    fn secants_are_nearly_one_by_the_cosine() {
        for degrees in angles(85) {
            let wrong = f64::from(secant_q14(degrees)) / 16_384.0 * f64::from(degrees).to_radians().cos() - 1.0;
            assert!(wrong.abs() < if degrees <= 60.0 { 0.002 } else { 0.011 }, "{degrees}: {wrong}");
            assert_eq!(secant_q14(-degrees), secant_q14(degrees));
        }
    }

    #[test]
    fn pitches_have_nearly_their_sine_and_cosine() {
        for degrees in angles(60) {
            let [sin, cos] = sin_cos_q14(degrees).map(|q14| f64::from(q14) / 16_384.0);
            let (right_sin, right_cos) = f64::from(degrees).to_radians().sin_cos();
            assert!((sin - right_sin).abs() < 0.0012 && (cos - right_cos).abs() < 0.0012, "{degrees}: {sin} {cos}");
            assert_eq!(sin_cos_q14(-degrees), [-sin_cos_q14(degrees)[0], sin_cos_q14(degrees)[1]]);
        }
    }

    #[test]
    fn straight_ahead_is_exact() {
        assert_eq!((tangent_q16(0.0), secant_q14(0.0), sin_cos_q14(0.0)), (0, 1 << 14, [0, 1 << 14]));
    }
}
