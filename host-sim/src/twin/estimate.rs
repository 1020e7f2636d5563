//! From executed instructions to cycles, frames a second and power: estimates, with what they rest on.
//!
//! # Model
//! Instructions are counted; cycles are not, since the emulator has no pipeline. Of the instructions are
//! taken to be (typical of such loops, not measured): loads 22 %, stores 8 %, branches 15 %, of
//! which 60 % are taken, all others 55 %. On a Cortex-M4 (its Technical Reference Manual, table of
//! instruction timings) a load takes 2 cycles, but 1 after another load: 1.5 on average; a store 1, thanks to
//! the write buffer; a taken branch 1 and 1 to 3 for the refill: 3; all others 1. That is
//! 0.22 * 1.5 + 0.08 + 0.09 * 3 + 0.06 + 0.55 = 1.29 cycles an instruction. The M7 and the M33 are taken to be faster by
//! the ratio of Arm's published CoreMark/MHz: M4 3.42, M7 5.01, M33 4.02. No wait states: code in
//! cache or behind the flash accelerator, data in fast SRAM.
//!
//! # Assumed, and checked by nothing
//! No figure made here was compared with a board. In particular:
//! - the instruction mix and the share of taken branches: typical shares, not counted in this program;
//! - that loads come in pairs, half of them after another load;
//! - that this program gains from an M7 or M33 what CoreMark does: CoreMark is another program, and its
//!   published figures hold for a compiler and memories of their own;
//! - the H743's current: a round figure, not looked up in its data sheet. That of the F407 and the U575 is
//!   their vendor's, for the chip's best conditions;
//! - that power is current times 3.3 V at full load: no camera, no peripherals, no supply's losses.

use serde::Serialize;

/// Cycles an instruction on a Cortex-M4: of an assumed mix of instructions, unchecked.
const CYCLES_M4: f64 = 0.22 * 1.5 + 0.08 + 0.09 * 3.0 + 0.06 + 0.55;
/// CoreMark/MHz as Arm publishes it; that its ratios hold for this program is assumed.
const COREMARK_M4: f64 = 3.42;
const COREMARK_M7: f64 = 5.01;
const COREMARK_M33: f64 = 4.02;
/// Supply, V.
const SUPPLY: f64 = 3.3;

/// A chip, and the figures that estimates for it rest on.
#[derive(Debug, Clone, Copy)]
pub struct Chip {
    /// Name with clock.
    pub name: &'static str,
    /// Clock, MHz.
    mhz: f64,
    /// Cycles an instruction.
    cycles: f64,
    /// Current of the running core at 3.3 V, uA/MHz; the H743's is assumed.
    current: f64,
    /// Where the current is from.
    pub source: &'static str,
}

/// The chips that estimates are made for.
pub const CHIPS: [Chip; 3] = [
    Chip {
        name: "STM32F407@168",
        mhz: 168.0,
        cycles: CYCLES_M4,
        current: 238.0,
        source: "238 uA/MHz at best, from vendor documents",
    },
    Chip {
        name: "STM32H743@480",
        mhz: 480.0,
        cycles: CYCLES_M4 * COREMARK_M4 / COREMARK_M7,
        current: 275.0,
        source: "275 uA/MHz, assumed, not checked against the data sheet",
    },
    Chip {
        name: "STM32U575@160",
        mhz: 160.0,
        cycles: CYCLES_M4 * COREMARK_M4 / COREMARK_M33,
        current: 19.5,
        source: "19.5 uA/MHz with its step-down converter, from vendor documents",
    },
];

/// What a chip would do.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Estimate {
    /// Name with clock.
    pub chip: &'static str,
    /// Cycles a pixel.
    pub cycles_per_pixel: f64,
    /// Frames a second at full load.
    pub fps: f64,
    /// Power of the core at full load, mW.
    pub core_mw: f64,
    /// Energy of a pixel, nJ.
    pub nj_per_pixel: f64,
    /// Where the current is from.
    pub current_source: &'static str,
}

impl Chip {
    /// For that many instructions a pixel, and pixels a frame.
    #[must_use]
    pub fn estimate(&self, instructions_per_pixel: f64, pixels: f64) -> Estimate {
        let cycles_per_pixel = instructions_per_pixel * self.cycles;
        let fps = self.mhz * 1e6 / (cycles_per_pixel * pixels);
        let core_mw = self.current * self.mhz * SUPPLY / 1000.0;
        Estimate {
            chip: self.name,
            cycles_per_pixel,
            fps,
            core_mw,
            nj_per_pixel: core_mw * 1e6 / (fps * pixels),
            current_source: self.source,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixels_energy_is_its_cycles_times_that_of_a_cycle() {
        // 785 pJ a cycle on the F407, 64 pJ on the U575, as the design notes have it.
        for (chip, picojoule) in [(CHIPS[0], 785.4), (CHIPS[2], 64.35)] {
            let estimate = chip.estimate(50.0, 320.0 * 240.0);
            assert!(
                (estimate.nj_per_pixel * 1000.0 / estimate.cycles_per_pixel - picojoule).abs() < 0.1,
                "{estimate:?}"
            );
        }
        let frames = CHIPS[0].estimate(50.0, 320.0 * 240.0).fps;
        assert!((33.0..35.0).contains(&frames), "{frames}");
    }
}
