//! How long triggered sensors are awake in a frame: the firmware puts a pair of MT9V034 into standby between frames where their
//! integration is fixed (`exposure_lines` of the rig). Its own figures are in `firmware/src/board/pair_mt9v034.rs`.

/// The sensors' clock, Hz: 13.11 to 13.5 MHz, by board and operating point.
const CLOCK: f64 = 13.3e6;
/// Longest horizontal blanking, clocks (MT9V034/D Rev. 7, register 0x05).
const MOST_BLANKING: f64 = 1023.0;
/// Lines that the sensor has between integration and picture, and after it.
const SPARE_LINES: f64 = 12.0;
/// From the end of the standby to the trigger, s.
const WAKE: f64 = 100e-6;
/// A shorter standby is left out, s.
const LEAST: f64 = 1e-3;

/// Part of the time that they are awake: views of that size, an integration of so many lines, so many frames a second.
#[must_use]
pub fn awake(width: u16, height: u16, exposure_lines: u16, fps: f64) -> f64 {
    let lines = f64::from(height) + f64::from(exposure_lines) + SPARE_LINES;
    // As long as frame rate and register allow.
    let line = (CLOCK / (fps * lines)).min(2.0 * f64::from(width) + MOST_BLANKING) / CLOCK;
    let (awake, frame) = (WAKE + lines * line, 1.0 / fps);
    if awake + LEAST <= frame { awake / frame } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_frame_rate_leaves_time_for_standby() {
        // 312 lines of 1663 clocks are 39.0 ms.
        assert!((awake(320, 240, 60, 5.0) - 0.1956).abs() < 1e-3, "{}", awake(320, 240, 60, 5.0));
        assert_eq!(awake(320, 240, 60, 25.0), 1.0);
        assert_eq!(awake(320, 240, 60, 60.0), 1.0);
        assert!(awake(320, 240, 60, 10.0) > awake(160, 120, 60, 10.0));
    }
}
