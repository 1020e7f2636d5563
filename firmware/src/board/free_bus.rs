//! An I2C bus on which a reset of the chip left a transfer unfinished.

use embassy_stm32::gpio::{Flex, Pull, Speed};

use super::this::clock::CORE;

/// Half a clock of 100 kHz, cycles.
const HALF: u32 = CORE / 200_000;
/// Clocks after which whoever sends a byte has sent it (UM10204, section 3.1.16).
const CLOCKS: u32 = 9;

/// Clocks the bus `number` until its data line is free, nine times at most, and ends the transfer; says so where it was
/// not free, and where it stays so.
pub fn free<'a>(number: u8, mut scl: Flex<'a>, mut sda: Flex<'a>) {
    for pin in [&mut scl, &mut sda] {
        pin.set_high();
        pin.set_as_input_output_pull(Speed::Low, Pull::Up);
    }
    cortex_m::asm::delay(HALF);
    if sda.is_high() {
        return;
    }
    for _ in 0..CLOCKS {
        scl.set_low();
        cortex_m::asm::delay(HALF);
        scl.set_high();
        cortex_m::asm::delay(HALF);
        if sda.is_high() {
            break;
        }
    }
    // The end of a transfer: data rises while the clock is high.
    sda.set_low();
    cortex_m::asm::delay(HALF);
    sda.set_high();
    cortex_m::asm::delay(HALF);
    if sda.is_high() {
        defmt::warn!("I2C bus {=u8} was in the middle of a transfer: freed", number);
    } else {
        defmt::error!("I2C bus {=u8}: its data line stays low: a short, or a sensor without supply", number);
    }
}
