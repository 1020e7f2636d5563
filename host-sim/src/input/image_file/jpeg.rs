//! Whether a JPEG is all there. The decoder fills what is missing with grey.

use anyhow::Result;
use image::DynamicImage;

/// The marker that ends an image.
const END: [u8; 2] = [0xff, 0xd9];

/// Whether it goes on to its end marker.
pub(super) fn has_end(bytes: &[u8]) -> bool {
    /// Markers without a length: TEM, the restarts and the start of the image.
    fn stands_alone(marker: u8) -> bool {
        matches!(marker, 0x01 | 0xd0..=0xd8)
    }
    let mut at = 0;
    // Each turn begins at a segment, or within image data, where 0xff 0x00 is no marker.
    while let Some(&[lead, marker]) = bytes.get(at..at + 2) {
        if lead != END[0] || marker == 0x00 || marker == 0xff {
            at += 1;
        } else if marker == END[1] {
            return true;
        } else if stands_alone(marker) {
            at += 2;
        } else {
            let Some(&[high, low]) = bytes.get(at + 2..at + 4) else { return false };
            at += 2 + usize::from(u16::from_be_bytes([high, low]));
        }
    }
    false
}

/// Whether one that lacks its end marker, as some cameras write it, lacks nothing else: whatever follows
/// then changes no pixel.
pub(super) fn is_complete(bytes: &[u8], decode: impl Fn(&[u8]) -> Result<DynamicImage>) -> bool {
    let bytes = bytes.strip_suffix(&END[..1]).unwrap_or(bytes);
    let with = |filler: &[u8]| decode(&[bytes, &filler.repeat(64), &END].concat()).ok();
    let plain = with(&[]);
    plain.is_some() && with(&[0x00]) == plain && with(&[0x96, 0x5a, 0x33]) == plain
}
