//! A fault of the program itself: where its rows are worked on, flash is struck when a frame begins, and
//! heals when the part is reset.

use anyhow::{Context, Result, ensure};
use rigless::emulator::{Error, Memory};
use rigless::soc::Width;

use crate::camera::{Fault, FaultKind};
use crate::symbols;

/// `b .`: stands still for ever.
const STAND_STILL: u64 = 0xE7FE;
/// `udf #0`: a fault.
const UNDEFINED: u64 = 0xDE00;
/// Parts of the name of the function that takes a row, in every way of mangling.
const FUNCTION: [&str; 2] = ["StereoMethod", "4push"];

/// One strike.
#[derive(Debug)]
pub struct Strike {
    frame: u32,
    instruction: u64,
    /// Where, and what stood there before.
    places: Vec<(u64, Option<u64>)>,
    is_done: bool,
}

impl Strike {
    /// What `fault` does to the program in the ELF file, if it is one of the program's.
    ///
    /// # Errors
    /// If there is no such function in the program.
    pub fn new(fault: Option<Fault>, elf: &[u8]) -> Result<Option<Self>> {
        let Some(Fault { kind, frame }) = fault else { return Ok(None) };
        let instruction = match kind {
            FaultKind::Hang => STAND_STILL,
            FaultKind::Crash => UNDEFINED,
            _ => return Ok(None),
        };
        let places: Vec<_> = symbols::functions(elf, &FUNCTION)?.into_iter().map(|place| (place, None)).collect();
        ensure!(!places.is_empty(), "the program has no function StereoMethod::push to be struck, it was inlined");
        Ok(Some(Self { frame, instruction, places, is_done: false }))
    }

    /// Strikes once, as soon as its frame is one of the `begun`; whether it did.
    ///
    /// # Errors
    /// If the function does not lie in flash.
    pub fn look(&mut self, begun: u32, memory: &mut dyn Memory) -> Result<bool> {
        if self.is_done || begun <= self.frame {
            return Ok(false);
        }
        self.is_done = true;
        for (place, before) in &mut self.places {
            let struck = memory.read(*place, Width::W16).and_then(|code| {
                *before = Some(code);
                memory.program(*place, Width::W16, self.instruction)
            });
            struck.with_context(|| format!("the function at {place:#x} cannot be struck"))?;
        }
        Ok(true)
    }

    /// The part was reset: what was struck is as before.
    ///
    /// # Errors
    /// If the function does not lie in flash.
    pub fn heal(&mut self, memory: &mut dyn Memory) -> Result<(), Error> {
        for (place, before) in &mut self.places {
            if let Some(code) = before.take() {
                memory.program(*place, Width::W16, code)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    struct Flash(BTreeMap<u64, u64>);

    impl Memory for Flash {
        fn read(&mut self, address: u64, width: Width) -> Result<u64, Error> {
            self.0.get(&address).copied().ok_or(Error::Memory { address, width })
        }

        fn write(&mut self, address: u64, width: Width, _value: u64) -> Result<(), Error> {
            Err(Error::Memory { address, width })
        }

        fn program(&mut self, address: u64, _width: Width, value: u64) -> Result<(), Error> {
            self.0.insert(address, value);
            Ok(())
        }
    }

    #[test]
    fn a_strike_comes_once_and_heals() {
        let mut flash = Flash([(0x800_0100, 0xB580)].into());
        let places = vec![(0x800_0100, None)];
        let mut strike = Strike { frame: 1, instruction: STAND_STILL, places, is_done: false };
        assert!(!strike.look(1, &mut flash).unwrap());
        assert_eq!(flash.0[&0x800_0100], 0xB580);
        assert!(strike.look(2, &mut flash).unwrap());
        assert_eq!(flash.0[&0x800_0100], STAND_STILL);
        strike.heal(&mut flash).unwrap();
        assert_eq!(flash.0[&0x800_0100], 0xB580);
        assert!(!strike.look(3, &mut flash).unwrap());
        assert_eq!(flash.0[&0x800_0100], 0xB580);
    }

    #[test]
    fn faults_of_the_camera_strike_nothing() {
        assert!(Strike::new(Some("stall@1".parse().unwrap()), b"").unwrap().is_none());
        assert!(Strike::new(None, b"").unwrap().is_none());
    }
}
