//! What is kept of an answer, to compare it with the host's.

use haarline::DisparityRow;

/// Known pixels, and the FNV-1a checksum of all rows: of each the disparities' bits, low byte first,
/// then the confidences.
pub struct Digest {
    /// Pixels with an answer.
    pub known: u32,
    /// FNV-1a, 32 bits.
    pub checksum: u32,
}

impl Digest {
    /// Of no row.
    pub const fn new() -> Self {
        Self { known: 0, checksum: 0x811C_9DC5 }
    }

    /// Adds the next row.
    pub fn add(&mut self, row: &DisparityRow<'_>) {
        for disparity in row.disparity {
            self.known += u32::from(disparity.is_known());
            disparity.into_bits().to_le_bytes().into_iter().for_each(|byte| self.add_byte(byte));
        }
        row.confidence.iter().for_each(|&byte| self.add_byte(byte));
    }

    fn add_byte(&mut self, byte: u8) {
        self.checksum = (self.checksum ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    }
}
