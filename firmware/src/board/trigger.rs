//! The sensors' trigger on PB4 and their standby on PB5, by one timer that counts through the time of a frame.
//!
//! | the timer counts | EXPOSURE | STANDBY |
//! |---|---|---|
//! | from 0 on | low | low: the sensors wake up |
//! | from [`WAKE_US`] on | high: the edge starts a frame | low |
//! | from [`AWAKE_US`] on, if a frame leaves time | high | high: nothing is lost, a frame under way is finished first |
//!
//! With PB5 open, and the sensors' pin low, all is the same but their current.

use embassy_stm32::Peri;
use embassy_stm32::gpio::OutputType;
use embassy_stm32::peripherals::{PB4, PB5, TIM3};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::Channel;
use embassy_stm32::timer::low_level::{CountingMode, OutputCompareMode};
use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm};

use super::pair::{AWAKE_US, WAKE_US};
use crate::app::settings::FRAME_RATE;

/// Time of a frame, us.
const FRAME_US: u32 = 1_000_000 / FRAME_RATE;

/// The two pins.
pub struct Trigger(SimplePwm<'static, TIM3>);

impl Trigger {
    /// Takes the pins: both low.
    #[must_use]
    pub fn new(timer: Peri<'static, TIM3>, exposure: Peri<'static, PB4>, standby: Peri<'static, PB5>) -> Self {
        let exposure = PwmPin::new(exposure, OutputType::PushPull);
        let standby = PwmPin::new(standby, OutputType::PushPull);
        let rate = Hertz(FRAME_RATE);
        let mut pins =
            SimplePwm::new(timer, Some(exposure), Some(standby), None, None, rate, CountingMode::EdgeAlignedUp);
        // The register has 16 bits.
        let most = pins.max_duty_cycle().min(0xFFFF);
        for channel in [Channel::Ch1, Channel::Ch2] {
            let mut channel = pins.channel(channel);
            // High from the compare value on: never yet.
            channel.set_output_compare_mode(OutputCompareMode::PwmMode2);
            channel.set_duty_cycle(most);
            channel.enable();
        }
        Self(pins)
    }

    /// Starts frames, from the timer's next lap on.
    pub fn start(&mut self) {
        let wake = self.counts(WAKE_US);
        self.0.ch1().set_duty_cycle(wake);
    }

    /// Puts the sensors into standby between frames, where there is time for it. They do not answer on their buses then.
    pub fn sleep_between_frames(&mut self) {
        if let Some(awake) = AWAKE_US.map(|us| self.counts(us)) {
            self.0.ch2().set_duty_cycle(awake);
        }
    }

    fn counts(&self, us: u32) -> u32 {
        let counts = u64::from(us) * u64::from(self.0.max_duty_cycle()) / u64::from(FRAME_US);
        u32::try_from(counts).unwrap_or(u32::MAX)
    }
}
