//! One sensor's exposure for the other.

use core::marker::PhantomData;

use crate::sensor::{Bus, Sensor, apply};

/// Most registers of an exposure.
const MOST: usize = 5;

/// Copies the exposure from one sensor to the other, a register a call, so that nobody waits long.
#[derive(Debug, Clone)]
pub struct ExposureCopy<S> {
    values: [u16; MOST],
    step: usize,
    model: PhantomData<S>,
}

impl<S> Default for ExposureCopy<S> {
    fn default() -> Self {
        Self { values: [0; MOST], step: 0, model: PhantomData }
    }
}

impl<S: Sensor> ExposureCopy<S> {
    /// Takes the next step; whether it was the last one: the other sensor then exposes alike from its next
    /// frame on. `from` and `to` are the buses, each with the address of its sensor.
    ///
    /// # Errors
    /// If a sensor does not answer; the copy then begins anew.
    pub fn step<B: Bus>(&mut self, from: (&mut B, u8), to: (&mut B, u8)) -> Result<bool, B::Error> {
        const { assert!(S::EXPOSURE.len() <= MOST) };
        let step = core::mem::take(&mut self.step);
        let done = match (self.values.get_mut(step), S::EXPOSURE.get(step)) {
            (Some(value), Some(&(register, _))) => {
                *value = S::read(from.0, from.1, register)?;
                false
            }
            _ => {
                let nth = step - S::EXPOSURE.len();
                match (S::EXPOSURE.get(nth), self.values.get(nth)) {
                    (Some(&(_, register)), Some(&value)) => S::write(to.0, to.1, register, value)?,
                    // What was written holds from the next frame on, all at once.
                    _ => S::latch().map_or(Ok(()), |latch| apply::<S, B>(to.0, to.1, latch))?,
                }
                nth >= S::EXPOSURE.len()
            }
        };
        self.step = if done { 0 } else { step + 1 };
        Ok(done)
    }
}
