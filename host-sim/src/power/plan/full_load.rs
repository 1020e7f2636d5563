//! What a chip would do at full load: it works without a pause, at its highest clock.

use clap::ValueEnum;
use serde::Serialize;

use super::currents::{Board, Currents};
use crate::twin::cycles::Core;

/// Likely figures of a chip at full load.
#[derive(Debug, Clone, Serialize)]
pub struct FullLoad {
    /// Name with clock.
    pub chip: String,
    /// Cycles a pixel.
    pub cycles_per_pixel: f64,
    /// Frames a second.
    pub fps: f64,
    /// Power of the core, mW.
    pub core_mw: f64,
    /// Energy of a pixel, nJ.
    pub nj_per_pixel: f64,
    /// Where the current is from.
    pub current_source: String,
}

impl FullLoad {
    /// Of every board whose chip executes the program that was counted on `core`, for that many instructions a pixel, and pixels
    /// a frame.
    ///
    /// # Errors
    /// If a current has no source.
    pub fn of_program(
        currents: &Currents,
        core: Core,
        instructions_per_pixel: f64,
        pixels: f64,
    ) -> anyhow::Result<Vec<Self>> {
        let of = |&board: &Board| {
            let chip = currents.chip(board);
            let point = &chip.points[0];
            let cycles_per_pixel = instructions_per_pixel * chip.core.cycles().likely;
            let fps = point.mhz * 1e6 / (cycles_per_pixel * pixels);
            let core_mw = point.run.ma * chip.volts;
            Ok(Self {
                chip: format!("{}@{}", chip.name, point.mhz),
                cycles_per_pixel,
                fps,
                core_mw,
                nj_per_pixel: core_mw * 1e6 / (fps * pixels),
                current_source: format!("{} mA, {}", point.run.ma, point.run.source()?),
            })
        };
        let executes = |board: &&Board| currents.chip(**board).core.is_armv8() == core.is_armv8();
        Board::value_variants().iter().filter(executes).map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixels_energy_is_its_cycles_times_that_of_a_cycle() {
        let currents = Currents::own().unwrap();
        let loads = [Core::CortexM4, Core::CortexM33]
            .map(|core| FullLoad::of_program(&currents, core, 50.0, 320.0 * 240.0).unwrap());
        let chips = loads.each_ref().map(|loads| loads.iter().map(|load| load.chip.as_str()).collect::<Vec<_>>());
        assert_eq!(chips, [vec!["STM32H743@480", "STM32F407@168"], vec!["STM32U575@160"]]);
        for load in loads.into_iter().flatten() {
            let mhz: f64 = load.chip.split_once('@').unwrap().1.parse().unwrap();
            let cycle_nj = load.core_mw / mhz;
            assert!((load.nj_per_pixel / load.cycles_per_pixel - cycle_nj).abs() < 1e-9, "{load:?}");
            assert!(load.current_source.contains("not verified"), "{load:?}");
        }
    }
}
