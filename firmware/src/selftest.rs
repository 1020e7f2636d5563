//! The self test: what a method makes of the built-in picture, in one number.

use haarline::{Config, DisparityRow, ScanlinePair, StereoMethod, blocks_for};

use crate::picture::{self, HEIGHT, WIDTH};

/// Disparities searched.
pub const DISPARITIES: usize = 32;
/// The search.
pub const CONFIG: Config = Config { width: WIDTH, min_disparity: 0, num_disparities: 32 };
/// Blocks of a row.
pub const BLOCKS: usize = blocks_for(WIDTH);

/// The host's checksums; a test on the host compares them with what it computes.
const EXPECTED: [(&str, u32); 3] = [("full", 0xC2FC_7785), ("lite", 0x6462_BBB5), ("block", 0x6714_32B0)];

/// The host's checksum of a method.
#[must_use]
pub fn expected(name: &str) -> Option<u32> {
    EXPECTED.iter().find(|(known, _)| *known == name).map(|&(_, sum)| sum)
}

/// The checksum of all disparities and confidences (FNV-1a, 32 bits). `rest` is called after each row.
pub fn checksum(method: &mut dyn StereoMethod, mut rest: impl FnMut()) -> u32 {
    let mut sum = 0x811C_9DC5;
    let mut add = |row: DisparityRow<'_>| {
        let bytes = row.disparity.iter().flat_map(|disparity| disparity.into_bits().to_le_bytes());
        for byte in bytes.chain(row.confidence.iter().copied()) {
            sum = (sum ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
    };
    for y in 0..HEIGHT {
        let (left, right) = picture::rows(y);
        // Rows of `WIDTH` pixels are what was configured, so none is refused.
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
    use haarline::{Full, Lite};
    use haarline_tests::{BlockSettings, StereoBm};

    #[test]
    fn the_expected_checksums_are_this_hosts() {
        let mut full = Full::<BLOCKS>::new(CONFIG).unwrap();
        let mut lite = Lite::<BLOCKS>::new(CONFIG).unwrap();
        let mut block = StereoBm::<{ WIDTH as usize }, DISPARITIES, 9>::new(CONFIG, BlockSettings::default()).unwrap();
        let sums = [
            ("full", checksum(&mut full, || {})),
            ("lite", checksum(&mut lite, || {})),
            ("block", checksum(&mut block, || {})),
        ];
        assert_eq!(sums, EXPECTED, "the method or the picture changed: put the new ones in");
    }
}
