//! The self test: what a method makes of the built-in picture, in one number.

pub mod picture;

use haarline::{Config, DisparityRow, ScanlinePair, Stage, StageClock, StereoMethod, blocks_for};

use picture::{RAW, WIDTH, WIRING};

/// Disparities searched.
pub const DISPARITIES: usize = 32;
/// The search.
pub const CONFIG: Config = Config { width: WIDTH, min_disparity: 0, num_disparities: 32 };
/// Blocks of a row.
pub const BLOCKS: usize = blocks_for(WIDTH);

/// The host's checksums; a test on the host compares them with what it computes.
const EXPECTED: [(&str, u32); 7] = [
    ("full", 0x3F45_52E9),
    ("lite", 0x5FDF_A892),
    ("wavelet-block", 0x71D2_8E9A),
    ("contour", 0x067D_3429),
    ("envelope", 0xBF38_85C1),
    ("block", 0x3F26_BD30),
    ("sgm", 0xD9D7_5F9F),
];

/// The host's checksum of a method.
#[must_use]
pub fn expected(name: &str) -> Option<u32> {
    EXPECTED.iter().find(|(known, _)| *known == name).map(|&(_, sum)| sum)
}

/// The checksum of all disparities and confidences (FNV-1a, 32 bits). `clock` is told where the method has no part,
/// `rest` is called after each row.
pub fn checksum(method: &mut dyn StereoMethod, clock: &impl StageClock, mut rest: impl FnMut()) -> u32 {
    let mut sum = 0x811C_9DC5;
    let mut add = |row: DisparityRow<'_>| {
        let bytes = row.disparity.iter().flat_map(|disparity| disparity.into_bits().to_le_bytes());
        for byte in bytes.chain(row.confidence.iter().copied()) {
            sum = (sum ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
    };
    let (mut left, mut right) = ([0; WIDTH as usize], [0; WIDTH as usize]);
    for raw in &RAW {
        clock.enter(Stage::Unpack);
        // Both have the width that was configured, so nothing is refused; if it were, the checksum would tell.
        let _ = WIRING.unpack(raw, &mut left, &mut right);
        let _ = method.push(ScanlinePair { left: &left, right: &right }, &mut add);
        rest();
    }
    method.finish(&mut add);
    rest();
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::contour_stereo::rows_for;
    use haarline::{ContourStereo, EnvelopeStereo, Full, Lite, Untimed, WaveletBlock};
    use haarline_tests::sgm::words_for;
    use haarline_tests::{BlockSettings, Sgm, StereoBm};

    /// Calls `with` for every method.
    fn each(mut with: impl FnMut(&str, &mut dyn StereoMethod)) {
        let block = StereoBm::<{ WIDTH as usize }, DISPARITIES, 9>::new(CONFIG, BlockSettings::default());
        with("full", &mut Full::<BLOCKS>::new(CONFIG).unwrap());
        with("lite", &mut Lite::<BLOCKS>::new(CONFIG).unwrap());
        with("wavelet-block", &mut WaveletBlock::<BLOCKS>::new(CONFIG).unwrap());
        with("contour", &mut ContourStereo::<BLOCKS, { rows_for(2) }>::new(CONFIG).unwrap());
        with("envelope", &mut EnvelopeStereo::<BLOCKS>::new(CONFIG).unwrap());
        with("block", &mut block.unwrap());
        with("sgm", &mut Sgm::<{ WIDTH as usize }, { words_for(32) }>::new(CONFIG).unwrap());
    }

    #[test]
    fn the_expected_checksums_are_this_hosts() {
        let line = |name: &str, sum: u32| format!("{name} {sum:#010X}");
        let mut sums = Vec::new();
        each(|name, method| sums.push(line(name, checksum(method, &Untimed, || {}))));
        let expected = EXPECTED.map(|(name, sum)| line(name, sum));
        assert_eq!(sums, expected, "the method or the picture changed: put the new ones in");
    }

    #[test]
    fn every_method_finds_something_in_the_picture() {
        each(|name, method| {
            let (mut left, mut right) = ([0; WIDTH as usize], [0; WIDTH as usize]);
            let mut known = 0;
            let mut count = |row: DisparityRow<'_>| known += row.disparity.iter().filter(|d| d.is_known()).count();
            for raw in &RAW {
                WIRING.unpack(raw, &mut left, &mut right).unwrap();
                method.push(ScanlinePair { left: &left, right: &right }, &mut count).unwrap();
            }
            method.finish(&mut count);
            assert!(known > usize::from(WIDTH) * RAW.len() / 20, "{name}: {known} px");
        });
    }
}
