//! From executed instructions to cycles: an estimate, with what it rests on.
//!
//! # Model
//! Instructions are counted; cycles are not, since the emulator has no pipeline. Of the instructions are
//! taken to be (typical of such loops, not measured): loads 22 %, stores 8 %, branches 15 %, of
//! which 60 % are taken, all others 55 %. On a Cortex-M4 (its Technical Reference Manual, table of
//! instruction timings) a load takes 2 cycles, but 1 after another load; a store 1, thanks to
//! the write buffer; a taken branch 1 and 1 to 3 for the refill; all others 1.
//!
//! | | a load | a taken branch | cycles an instruction |
//! |---|---|---|---|
//! | least | 1 | 2 | 1.09 |
//! | likely | 1.5 | 3 | 1.29 |
//! | most | 2 | 4 | 1.49 |
//!
//! The M7 and the M33 are taken to be faster by the ratio of Arm's published CoreMark/MHz (M4 3.42, M7 5.01, M33 4.02); at
//! most they take what is likely on the M4. No wait states: code in cache or behind the flash accelerator, data in fast SRAM.
//!
//! # Assumed, and checked by nothing
//! No figure made here was compared with a board. In particular:
//! - the instruction mix and the share of taken branches: typical shares, not counted in this program;
//! - that this program gains from an M7 or M33 what CoreMark does: CoreMark is another program, and its
//!   published figures hold for a compiler and memories of their own;
//! - that the M7 executes the instructions of the program for the M4. The M33 has a program of its own.

use serde::{Deserialize, Serialize};

/// A processor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Core {
    /// Of the STM32F407.
    CortexM4,
    /// Of the STM32H743.
    CortexM7,
    /// Of the STM32U575.
    CortexM33,
}

/// A figure of which a model knows only about where it is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Range {
    /// The least that it may be.
    pub least: f64,
    /// What it is most likely.
    pub likely: f64,
    /// The most that it may be.
    pub most: f64,
}

impl Range {
    /// The same with another unit, or of two figures that depend on each other.
    #[must_use]
    pub fn map(self, of: impl Fn(f64) -> f64) -> Self {
        let Self { least, likely, most } = self;
        Self { least: of(least), likely: of(likely), most: of(most) }
    }

    /// The product, end by end.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        Self { least: self.least * other.least, likely: self.likely * other.likely, most: self.most * other.most }
    }
}

/// CoreMark/MHz as Arm publishes it; that its ratios hold for this program is assumed.
const COREMARK_M4: f64 = 3.42;
const COREMARK_M7: f64 = 5.01;
const COREMARK_M33: f64 = 4.02;

/// Cycles of an instruction on a Cortex-M4, where a load and a taken branch take so many.
const fn m4(load: f64, taken: f64) -> f64 {
    0.22 * load + 0.08 + 0.09 * taken + 0.06 + 0.55
}

const LEAST: f64 = m4(1.0, 2.0);
const LIKELY: f64 = m4(1.5, 3.0);
const MOST: f64 = m4(2.0, 4.0);

impl Core {
    /// Cycles of an instruction.
    #[must_use]
    pub fn cycles(self) -> Range {
        let faster = |coremark: f64| {
            let gain = COREMARK_M4 / coremark;
            Range { least: gain * LEAST, likely: gain * LIKELY, most: LIKELY }
        };
        match self {
            Self::CortexM4 => Range { least: LEAST, likely: LIKELY, most: MOST },
            Self::CortexM7 => faster(COREMARK_M7),
            Self::CortexM33 => faster(COREMARK_M33),
        }
    }

    /// Whether it is of Armv8-M, for which programs are built anew.
    #[must_use]
    pub fn is_armv8(self) -> bool {
        self == Self::CortexM33
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::CortexM4 => "Cortex-M4",
            Self::CortexM7 => "Cortex-M7",
            Self::CortexM33 => "Cortex-M33",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cores_are_as_the_table_says() {
        let rounded = |core: Core| {
            let Range { least, likely, most } = core.cycles();
            [least, likely, most].map(|cycles| (100.0 * cycles).round() as i32)
        };
        assert_eq!(rounded(Core::CortexM4), [109, 129, 149]);
        assert_eq!(rounded(Core::CortexM7), [74, 88, 129]);
        assert_eq!(rounded(Core::CortexM33), [93, 110, 129]);
    }
}
