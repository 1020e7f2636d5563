//! Where the core spends its time, by looks at its program counter.

use std::collections::BTreeMap;
use std::fmt::Write;

use rigless::emulator::Host;

/// Between two looks, ns: no divisor of anything periodic.
const STEP: u64 = 1009;

/// How often each address was the next to execute.
#[derive(Debug, Default)]
pub struct Profile {
    looks: BTreeMap<u32, u64>,
    /// When others look, ns: nothing but this happens before.
    others: u64,
}

impl Profile {
    /// Looks; when to look next, if that is before others do.
    pub fn look(&mut self, now: u64, host: &mut dyn Host) -> Option<u64> {
        if let Some(address) = host.save_state().ok().as_deref().and_then(program_counter) {
            *self.looks.entry(address).or_default() += 1;
        }
        (now < self.others).then(|| self.others.min(now + STEP))
    }

    /// Others look next at `others`; when to look next.
    pub fn until(&mut self, others: u64, now: u64) -> u64 {
        self.others = others;
        others.min(now + STEP)
    }

    /// A line for each address.
    pub fn csv(&self) -> String {
        let mut text = String::from("address,looks\n");
        for (address, looks) in &self.looks {
            let _ = writeln!(text, "{address:#010x},{looks}");
        }
        text
    }
}

/// R15 of a saved state, which begins with the length of the core's and that with R0 to R15, all of them varints.
fn program_counter(state: &[u8]) -> Option<u32> {
    let mut bytes = state.iter();
    let mut varint = || {
        let mut value = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = *bytes.next()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    };
    for _ in 0..16 {
        varint()?;
    }
    u32::try_from(varint()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_counter_is_the_last_of_sixteen() {
        let mut state = vec![0x85, 0x02];
        state.extend([0xff, 0xff, 0xff, 0xff, 0x0f]);
        state.extend(1..15);
        assert_eq!(program_counter(&state), None);
        state.extend([0x80, 0x80, 0x80, 0x40, 9]);
        assert_eq!(program_counter(&state), Some(0x0800_0000));
    }
}
