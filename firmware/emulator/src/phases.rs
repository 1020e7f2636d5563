//! The two phase pins as a logic analyser sees them.

use std::fmt::Write;

/// `GPIOE_BSRR`, and the pins PE9 and PE11.
const BSRR: u64 = 0x5802_1018;
const PINS: [u32; 2] = [9, 11];

/// Levels of the low and the high pin, and since when, ns.
#[derive(Debug, Default)]
pub struct Phases {
    levels: [bool; 2],
    edges: Vec<(u64, [bool; 2])>,
}

impl Phases {
    /// The program has written `value` to `address` at that time, ns.
    pub fn written(&mut self, address: u64, value: u64, now: u64) {
        if address != BSRR {
            return;
        }
        // Who sets and resets a pin sets it.
        let level = |nth: usize| match (value >> PINS[nth] & 1, value >> (PINS[nth] + 16) & 1) {
            (1, _) => true,
            (0, 1) => false,
            _ => self.levels[nth],
        };
        let levels = [level(0), level(1)];
        if levels != self.levels {
            self.levels = levels;
            self.edges.push((now, levels));
        }
    }

    /// Whether the pins never moved.
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// A line for each edge.
    pub fn csv(&self) -> String {
        let mut text = String::from("ns,low,high\n");
        for &(at, [low, high]) in &self.edges {
            let _ = writeln!(text, "{at},{},{}", u8::from(low), u8::from(high));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_kept_and_other_pins_are_not() {
        let mut phases = Phases::default();
        for (address, value, at) in [
            (BSRR, 1 << 9, 10),
            (BSRR, 1 << 9 | 1 << 27, 20),
            (BSRR, 1 << 11 | 1 << 9, 30),
            (BSRR, 1 << 3, 40),
            (BSRR + 4, 0, 50),
            (BSRR, 1 << 25 | 1 << 27, 60),
        ] {
            phases.written(address, value, at);
        }
        assert_eq!(phases.csv(), "ns,low,high\n10,1,0\n30,1,1\n60,0,0\n");
    }
}
