//! What the program `firmware` counted, in words that a probe fetches when the run is over (`probe-rs read b32`).

use crate::message::STAGES;

/// The first word: "MEAS".
pub const MAGIC: u32 = 0x4D45_4153;
/// The version of the layout.
const VERSION: u32 = 1;
/// Words of it.
pub const WORDS: usize = 10 + 2 * STAGES;

/// What was counted since the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Measured {
    /// Clock of the core, Hz.
    pub clock_hz: u32,
    /// How long, ms.
    pub uptime_ms: u32,
    /// Of it asleep, ms.
    pub slept_ms: u32,
    /// Frames that began.
    pub frames: u32,
    /// Rows that the method delivered.
    pub rows: u32,
    /// Columns and rows of a view.
    pub size: [u16; 2],
    /// Cycles of each stage, in the core's order.
    pub stages: [u64; STAGES],
}

/// Why words are none of these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unreadable {
    /// They are too few.
    Short,
    /// They begin otherwise.
    Other,
    /// They are those of another version.
    Version(u32),
    /// The program was writing them.
    Torn,
}

impl Measured {
    /// The words. `turn` is another number each time: it stands at both ends.
    #[must_use]
    pub fn words(&self, turn: u32) -> [u32; WORDS] {
        let [width, height] = self.size.map(u32::from);
        let head = [MAGIC, VERSION, turn, self.clock_hz, self.uptime_ms, self.slept_ms, self.frames, self.rows];
        let stages = self.stages.iter().flat_map(|&cycles| halves(cycles));
        let rest = core::iter::once(width << 16 | height).chain(stages).chain([turn]);
        let mut words = [0; WORDS];
        words.iter_mut().zip(head.into_iter().chain(rest)).for_each(|(to, from)| *to = from);
        words
    }

    /// What words of the memory say.
    ///
    /// # Errors
    /// If they do not, and why.
    pub fn of(words: &[u32]) -> Result<Self, Unreadable> {
        let words: &[u32; WORDS] = words.first_chunk().ok_or(Unreadable::Short)?;
        let [magic, version, turn, clock_hz, uptime_ms, slept_ms, frames, rows, size, rest @ ..] = *words;
        if magic != MAGIC {
            return Err(Unreadable::Other);
        }
        if version != VERSION {
            return Err(Unreadable::Version(version));
        }
        if rest.last() != Some(&turn) {
            return Err(Unreadable::Torn);
        }
        let mut stages = [0; STAGES];
        for (cycles, [low, high]) in stages.iter_mut().zip(rest.as_chunks().0) {
            *cycles = u64::from(*low) | u64::from(*high) << 32;
        }
        let size = [size >> 16, size & 0xFFFF].map(|side| u16::try_from(side).unwrap_or(0));
        Ok(Self { clock_hz, uptime_ms, slept_ms, frames, rows, size, stages })
    }
}

/// The low half and the high one.
fn halves(value: u64) -> [u32; 2] {
    [value & 0xFFFF_FFFF, value >> 32].map(|half| u32::try_from(half).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let measured = Measured {
            clock_hz: 480_000_000,
            uptime_ms: 61_000,
            slept_ms: 20_000,
            frames: 1525,
            rows: 366_000,
            size: [320, 240],
            stages: core::array::from_fn(|stage| (stage as u64 + 1) << 30),
        };
        let words = measured.words(7);
        assert_eq!(Measured::of(&words), Ok(measured));
        let torn = [&words[..WORDS - 1], &[8]].concat();
        assert_eq!(Measured::of(&torn), Err(Unreadable::Torn));
        assert_eq!(Measured::of(&words[1..]), Err(Unreadable::Short));
        assert_eq!(Measured::of(&[0; WORDS]), Err(Unreadable::Other));
        let newer = [&words[..1], &[2], &words[2..]].concat();
        assert_eq!(Measured::of(&newer), Err(Unreadable::Version(2)));
    }
}
