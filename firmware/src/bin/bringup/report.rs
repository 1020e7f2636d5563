//! The verdicts, one line each.

use core::fmt::Display;

/// Counts what is wrong.
#[derive(Default)]
pub struct Report {
    wrong: u32,
}

impl Report {
    /// All is well with a step.
    pub fn good(&self, step: u8, what: &dyn Display) {
        defmt::info!("step {=u8} ok: {}", step, defmt::Display2Format(&what));
    }

    /// Something is wrong.
    pub fn bad(&mut self, step: u8, what: &dyn Display) {
        self.wrong += 1;
        defmt::error!("step {=u8} WRONG: {}", step, defmt::Display2Format(&what));
    }

    /// All that can be said.
    pub fn end(&self) {
        if self.wrong == 0 {
            defmt::info!("bringup: all is well");
        } else {
            defmt::error!("bringup: {=u32} complaints; mend the first one first", self.wrong);
        }
    }
}
