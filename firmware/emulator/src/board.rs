//! The board: the part, its crystal, two sensors and two listeners.

use std::num::{NonZeroU32, NonZeroU64};
use std::sync::{Arc, Mutex};

use rigless::chip::uart::TcpPeer;
use rigless::cpu::armv7m::windows;
use rigless::device::{Device, ErasedDevice, ResetCause, Told};
use rigless::edge::Pulse;
use rigless::machine::armv7m::{
    BranchPrediction, Caches, Config, Core, Fpu, ImplementationRegister, MpuRegions, Variant,
};
use rigless::machine::{Board, Target};
use rigless::mcu::{Mcu, Operate};
use rigless::snapshot::Store;
use rigless::soc::stm32h743::Stm32h743;
use rigless::soc::stm32h743::generated::tim2::{Register, cr1, sr};
use rigless::soc::stm32h743::peripherals::rcc::Apb;
use rigless::soc::stm32h743::peripherals::usart;
use rigless::soc::{Bus, Error, Layout, Width};
use rigless::time::VirtualNanos;

use crate::camera::{Camera, FaultKind};
use crate::dcmi::{Dcmi, Trigger};
use crate::phases::Phases;
use crate::sensor::{Model, OnBus, Sensor, Shared};
use crate::watchdog::Watchdog;
use crate::wire::{Heard, Wire};
use crate::wires::Mistake;

/// Of the Nucleo: 8 MHz from its debugger, and 3.3 V.
const HSE: u64 = 8_000_000;
const SUPPLY: u32 = 3300;
/// The chip's own oscillator, Hz.
const HSI: u64 = 64_000_000;
/// The ports of the row packets and of MAVLink.
const ROWS: &str = "USART1";
const MAVLINK: &str = "UART7";
/// The port that leads through the Nucleo's debugger.
const DEBUGGER: &str = "USART3";
/// I2C1 has the first MT9V034, I2C2 the second one; two HM01B0 are both on I2C1.
const BUSES: [usize; 2] = [0, 1];
/// Registers of the clock controller: `CFGR`, `PLLCKSELR`, `PLL1DIVR`; and `GPIOA_MODER`, in which bits 16 and 17 are the
/// clock's pin PA8.
const CFGR: u64 = 0x5802_4410;
const RCC_CR: u64 = 0x5802_4400;
const HSEON: u64 = 1 << 16;
const PLLCKSELR: u64 = 0x5802_4428;
const PLL1DIVR: u64 = 0x5802_4430;
const MODER: u64 = 0x5802_0000;
/// The dividers of the buses, `D1CFGR` to `D3CFGR`.
const BUS_DIVIDERS: std::ops::RangeInclusive<u64> = 0x5802_4418..=0x5802_4420;
/// `SYSCFG_PWRCR`, whose `ODEN` makes scale 0 of scale 1, and `PWR_D3CR` with the scale.
const SYSCFG_PWRCR: u64 = 0x5800_042C;
const PWR_D3CR: u64 = 0x5802_4818;
/// What scale 0 allows core, AHB and APB, Hz (DS12110, table 112).
const SCALE_0: [u64; 3] = [480_000_000, 240_000_000, 120_000_000];
/// How long the sensors keep silent if that is the fault, ns.
const SILENT: u64 = 300_000_000;
/// TIM2 to TIM5, one after the other.
const TIMERS: u64 = 0x4000_0000;
const TIMERS_LEN: usize = 4;
const TIMER_SIZE: u64 = 0x400;
/// TIM3 pulses the sensors' trigger pins and their standby pins, by the order of the part's timers.
const TRIGGER_TIMER: usize = 1;

/// The part, with a camera interface and a watchdog of ours.
#[derive(Debug)]
pub struct Chip {
    pub part: Stm32h743,
    pub dcmi: Dcmi,
    watchdog: Watchdog,
    dcmi_slot: usize,
    watchdog_slot: usize,
}

impl Mcu for Chip {
    fn bus(&self) -> &Bus {
        self.part.bus()
    }

    fn bus_mut(&mut self) -> &mut Bus {
        self.part.bus_mut()
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        self.part.reset(at, cause);
        Device::reset(&mut self.watchdog);
        let (registers, mut context) = self.part.bus_mut().drive(at, self.dcmi_slot);
        self.dcmi.restarted(registers, &mut context);
    }

    fn poll(&mut self, now: VirtualNanos) {
        self.part.poll(now);
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        let ours: &mut dyn ErasedDevice = match slot {
            _ if slot == self.dcmi_slot => &mut self.dcmi,
            _ if slot == self.watchdog_slot => &mut self.watchdog,
            _ => return self.part.split(slot),
        };
        (self.part.bus_mut(), Some(ours))
    }
}

/// The board.
#[derive(Debug)]
pub struct Rig {
    pub chip: Chip,
    sensors: [Shared; 2],
    mistake: Option<Mistake>,
    pub rows: Heard,
    pub mavlink: Heard,
    pub phases: Phases,
    /// Core clock, and instructions a second, Hz: one a cycle.
    pub clock: u64,
    /// When clocks were set that scale 0 allows, while it was on.
    overdriven: Vec<VirtualNanos>,
}

impl Rig {
    /// Lets a host talk over the debugger's serial port.
    pub fn attach_host(&mut self, host: TcpPeer) {
        let nth = usart::INSTANCES.iter().position(|&instance| instance == DEBUGGER).expect("the part has it");
        self.chip.part.usart[nth].attach(host);
    }

    /// Two sensors of a model, a mistake in their wires, how late DMA is, ns, and the core's clock, Hz.
    pub fn new(camera: Camera, model: Model, mistake: Option<Mistake>, late: u64, clock: u64) -> Result<Self, Error> {
        let mut part = Stm32h743::new()?;
        part.rcc.attach_crystals(if mistake == Some(Mistake::NoCrystal) { 0 } else { HSE }, 0);
        part.set_supply(SUPPLY);
        part.set_analog_supply(SUPPLY);
        let (rows, mavlink) = (Heard::default(), Heard::default());
        for (name, heard) in [(ROWS, &rows), (MAVLINK, &mavlink)] {
            let nth = usart::INSTANCES.iter().position(|&instance| instance == name).expect("the part has it");
            part.usart[nth].attach(Wire(Arc::clone(heard)));
        }
        let fault = camera.fault.map(|fault| fault.kind);
        let sensors: [Shared; 2] = std::array::from_fn(|nth| {
            let mut sensor = Sensor::new(model);
            sensor.silent_until = if fault == Some(FaultKind::Silent) { SILENT } else { 0 };
            if fault == Some(FaultKind::Nak) {
                sensor.after_reset = SILENT;
            }
            match mistake {
                Some(Mistake::Mute(muted)) if muted == nth + 1 => sensor.silent_until = u64::MAX / 2,
                Some(Mistake::Another(other)) if other == nth + 1 => sensor.is_another = true,
                _ => {}
            }
            Arc::new(Mutex::new(sensor))
        });
        // Of two HM01B0 on one bus both take what is written, so one set of registers is that of both.
        let sensors = if model == Model::Hm01b0 { [(); 2].map(|()| Arc::clone(&sensors[0])) } else { sensors };
        let [one, other] = if mistake == Some(Mistake::CrossedBuses) { [1, 0] } else { [0, 1] };
        let on_buses = if model == Model::Hm01b0 { &[0_usize][..] } else { &[one, other] };
        for (bus, &nth) in BUSES.into_iter().zip(on_buses) {
            part.i2c[bus].attach(OnBus::new(Arc::clone(&sensors[nth])));
        }
        let [dcmi_slot, watchdog_slot] = [part.bus().slot("DCMI")?, part.bus().slot("IWDG")?];
        let dcmi = Dcmi::new(camera, sensors.each_ref().map(Arc::clone), mistake, late);
        let chip = Chip { part, dcmi, watchdog: Watchdog::default(), dcmi_slot, watchdog_slot };
        let phases = Phases::default();
        Ok(Self { chip, sensors, mistake, rows, mavlink, phases, clock, overdriven: Vec::new() })
    }

    /// The clock that comes out of the chip for the sensors, Hz.
    fn master_clock(&mut self, now: VirtualNanos) -> Option<u64> {
        let mut read = |address| self.chip.read(now, address, Width::W32).unwrap_or(0);
        if read(MODER) >> 16 & 3 != 2 {
            return None;
        }
        let (cfgr, selection, divisors) = (read(CFGR), read(PLLCKSELR), read(PLL1DIVR));
        let crystal = if self.mistake == Some(Mistake::NoCrystal) { 0 } else { HSE };
        let hz = match cfgr >> 22 & 7 {
            0 => HSI,
            2 => crystal,
            3 => {
                let input = [HSI, 4_000_000, crystal, 0][(selection & 3) as usize];
                let reference = input / (selection >> 4 & 0x3F).max(1);
                reference * ((divisors & 0x1FF) + 1) / ((divisors >> 16 & 0x7F) + 1)
            }
            _ => 0,
        };
        let divisor = cfgr >> 18 & 0xF;
        (divisor > 0 && hz > 0).then(|| hz / divisor)
    }

    fn look_at_clock(&mut self, now: VirtualNanos) {
        let clock = self.master_clock(now).filter(|_| self.mistake != Some(Mistake::NoMasterClock));
        for sensor in &self.sensors {
            sensor.lock().expect("nobody panics").clock = clock;
        }
    }

    /// Looks at the pins that lead to the sensors: master clock and trigger.
    pub fn look(&mut self, now: VirtualNanos) {
        self.look_at_clock(now);
        let (timer, registers) = self.chip.part.timer(TRIGGER_TIMER);
        // Both are high to the end of the timer's lap; what is never high is no pulse.
        let pulse = |number| {
            let channel = rigless::soc::stm32h743::peripherals::tim::Channel::new(number).expect("a timer has it");
            timer.pulse(channel, registers).filter(|Pulse { width, .. }| width.0 > 0)
        };
        let trigger = pulse(1).map(|Pulse { width, period }| {
            let standby = pulse(2).map(|standby| [width.0.saturating_sub(standby.width.0), width.0]);
            Trigger { period: period.0, standby }
        });
        let Chip { part, dcmi, dcmi_slot, .. } = &mut self.chip;
        let (_, mut context) = part.bus_mut().drive(now, *dcmi_slot);
        dcmi.trigger(trigger, &mut context);
    }

    /// The program has written there. A timer that stands still matches nothing: rigless raises the compare
    /// flags of all channels whose value its counter is set to, by a write or an update, and the HAL's clock
    /// would begin half a lap ahead of its timer and miss alarms. The sensors' clock may have changed.
    pub fn written(&mut self, address: u64, now: VirtualNanos) {
        if matches!(address, CFGR | MODER) {
            self.look_at_clock(now);
        }
        if (address == CFGR || BUS_DIVIDERS.contains(&address)) && self.is_overdriven(now) {
            self.overdriven.push(now);
        }
        // An oscillator without its crystal never gets ready; the model's would, so it is not started.
        if address == RCC_CR && self.mistake == Some(Mistake::NoCrystal) {
            let control = self.chip.read(now, RCC_CR, Width::W32).unwrap_or(0);
            if control & HSEON != 0 {
                // What cannot be written shows as a crystal after all.
                let _ = self.chip.write(now, RCC_CR, Width::W32, control & !HSEON);
            }
        }
        let Some(offset) = address.checked_sub(TIMERS) else { return };
        let (nth, offset) = ((offset / TIMER_SIZE) as usize, offset % TIMER_SIZE);
        let sets_count = [Register::Egr, Register::Cnt].iter().any(|set| u64::from(set.spec().offset) == offset);
        if nth >= TIMERS_LEN || !sets_count {
            return;
        }
        let (_, registers) = self.chip.part.timer(nth);
        if !cr1::CEN.is_set(registers.get(Register::Cr1)) {
            let flags = [sr::CC1IF, sr::CC2IF, sr::CC3IF, sr::CC4IF].iter().fold(0, |flags, flag| flags | flag.mask());
            registers.set(Register::Sr, registers.get(Register::Sr) & !flags);
        }
    }

    /// Whether the voltage is that of scale 0, and no clock faster than it allows.
    fn is_overdriven(&mut self, now: VirtualNanos) -> bool {
        let mut read = |address| self.chip.read(now, address, Width::W32).unwrap_or(0);
        let is_on = read(SYSCFG_PWRCR) & 1 != 0 && read(PWR_D3CR) >> 14 & 3 == 3;
        let (rcc, registers) = self.chip.part.clocks();
        let [core, ahb, apb] = SCALE_0;
        let mut buses = [Apb::One, Apb::Two, Apb::Three, Apb::Four].into_iter();
        is_on
            && rcc.cpu_clock(registers) <= core
            && rcc.hclk(registers) <= ahb
            && buses.all(|bus| rcc.pclk(registers, bus) <= apb)
    }

    /// Whether the part's model complains of a clock that is as it may be: it holds clocks against scale 1, as its clock
    /// controller is not shown `ODEN`.
    pub fn is_excused(&self, told: &Told) -> bool {
        told.instance == "RCC"
            && told.reason.ends_with("for the voltage scale in use")
            && self.overdriven.contains(&told.at)
    }

    fn config(&self) -> Config {
        let clock = NonZeroU64::new(self.clock).expect("it runs");
        let core = Core {
            variant: Variant::M7,
            clock_hz: clock,
            interrupt_lines: NonZeroU32::new(u32::from(Operate::cpu(&self.chip).interrupt_lines)).expect("it has some"),
            priority_bits: 4,
            refclk_divider: NonZeroU32::new(8).expect("it divides"),
            instructions_per_second: clock,
            boot: "flash",
        };
        let mut config = Config::new(core, &windows(self.chip.bus()));
        config.fpu = Fpu::FpV5Dp;
        config.mpu_regions = MpuRegions::Sixteen;
        // PM0253: a Cortex-M7 r1p1 with 16 KB of each cache, and the control registers of its memories.
        config.cpuid = 0x411F_C271;
        config.caches = Some(Caches { clidr: 0x0900_0003, ctr: 0x8303_C003, ccsidr: &[0xF00F_E019, 0xF01F_E009] });
        config.branch_prediction = BranchPrediction::Always;
        let register = |offset, reset, writable| ImplementationRegister { offset, reset, writable };
        config.implementation_registers = vec![
            register(0xF90, 0b0111 << 3, 0b111),
            register(0xF94, 0b1000 << 3, 0b111),
            register(0xF98, 0, 1),
            register(0xF9C, 0, 0b111),
            register(0xFA0, 1 << 11, 0x7FF),
            register(0xFA8, 0, 0),
        ];
        config.vector_table = Some(0x0800_0000);
        config
    }
}

// A run is never kept.
impl Store for Rig {}

impl Board for Rig {
    fn name(&self) -> &'static str {
        "haarline-board-h743"
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec!["stm32h743"]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then_some(&mut self.chip)
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let core = self.config().spec();
        vec![Target::new("stm32h743", &mut self.chip, core)]
    }
}

#[cfg(test)]
mod tests {
    use rigless::emulator::{self, Memory};

    use super::*;

    const TIM4: u64 = 0x4000_0800;
    const IWDG: u64 = 0x5800_4800;
    /// `RCC_APB1LENR`, in which bit 2 gives TIM4 its clock, and `RCC_RSR` with the watchdog's flag.
    const CLOCKS: u64 = 0x5802_44E8;
    const RSR: u64 = 0x5802_44D0;
    const IWDG1RSTF: u64 = 1 << 26;
    const MS: u64 = 1_000_000;

    /// None: nothing here asks for it.
    struct NoMemory;

    impl Memory for NoMemory {
        fn read(&mut self, address: u64, width: Width) -> Result<u64, emulator::Error> {
            Err(emulator::Error::Memory { address, width })
        }

        fn write(&mut self, address: u64, width: Width, _value: u64) -> Result<(), emulator::Error> {
            Err(emulator::Error::Memory { address, width })
        }
    }

    fn rig() -> Rig {
        Rig::new(Camera::new(Vec::new(), [0, 0], 0, None).unwrap(), Model::Mt9v034, None, 0, 480_000_000).unwrap()
    }

    fn write(rig: &mut Rig, at: u64, address: u64, value: u64) {
        run_until(rig, at);
        rig.chip.write(VirtualNanos(at), address, Width::W32, value).unwrap();
        rig.written(address, VirtualNanos(at));
        rig.chip.settle(&mut NoMemory).unwrap();
    }

    fn read(rig: &mut Rig, address: u64) -> u64 {
        rig.chip.read(VirtualNanos(0), address, Width::W32).unwrap()
    }

    /// When the part is reset up to `at`, and why.
    fn run_until(rig: &mut Rig, at: u64) -> Option<(u64, ResetCause)> {
        while let Some(next) = rig.chip.next_event().filter(|next| next.0 <= at) {
            rig.chip.advance_to(next);
            rig.chip.settle(&mut NoMemory).unwrap();
            if let Some(cause) = rig.chip.take_reset_request() {
                rig.chip.reset(next, cause);
                return Some((next.0, cause));
            }
        }
        None
    }

    #[test]
    fn a_timer_that_stands_still_matches_nothing() {
        let mut rig = rig();
        let at = |register: Register| TIM4 + u64::from(register.spec().offset);
        write(&mut rig, 0, CLOCKS, 1 << 2);
        write(&mut rig, 0, at(Register::Cnt), 0);
        write(&mut rig, 0, at(Register::Egr), 1);
        assert_eq!(read(&mut rig, at(Register::Sr)), 1, "the update alone");
        write(&mut rig, 0, at(Register::Cr1), 1);
        write(&mut rig, 0, at(Register::Cnt), 0);
        assert_eq!(read(&mut rig, at(Register::Sr)) & 0x1E, 0x1E, "all values are 0");
    }

    const KR: u64 = IWDG;
    const PR: u64 = IWDG + 4;
    const RLR: u64 = IWDG + 8;
    const WINR: u64 = IWDG + 16;

    /// A started one, for 2 s as the HAL sets it.
    fn watched() -> Rig {
        let mut rig = rig();
        for (address, value) in [(PR, 7), (KR, 0x5555), (PR, 2), (RLR, 3999), (KR, 0xCCCC), (RLR, 1)] {
            write(&mut rig, 0, address, value);
        }
        assert_eq!((read(&mut rig, PR), read(&mut rig, RLR), read(&mut rig, WINR)), (2, 3999, 0xFFF));
        rig
    }

    #[test]
    fn a_watchdog_that_nobody_feeds_resets_the_part() {
        let mut rig = watched();
        write(&mut rig, 10 * MS, KR, 0xAAAA);
        for tenth in 1..30 {
            write(&mut rig, tenth * 100 * MS, KR, 0xAAAA);
        }
        assert_eq!(run_until(&mut rig, 4_899 * MS), None);
        let (at, cause) = run_until(&mut rig, 5_000 * MS).expect("it ends");
        assert_eq!((at, cause), (4_900 * MS, ResetCause::Model("IWDG")));
        assert_ne!(read(&mut rig, RSR) & IWDG1RSTF, 0);
        assert_eq!(run_until(&mut rig, 9_000 * MS), None, "it has to be started again");
    }

    #[test]
    fn an_unfed_watchdog_ends_from_its_first_value() {
        let mut rig = watched();
        let (at, _) = run_until(&mut rig, 3_000 * MS).expect("it ends");
        // 4096 steps, after the LSI's start.
        assert!((2_048 * MS..2_049 * MS).contains(&at), "{at}");
    }

    #[test]
    fn a_watchdog_fed_before_its_window_resets_the_part() {
        let mut rig = watched();
        write(&mut rig, MS, KR, 0x5555);
        write(&mut rig, MS, WINR, 2000);
        write(&mut rig, 1_100 * MS, KR, 0xAAAA);
        assert_eq!(rig.chip.take_reset_request(), None);
        write(&mut rig, 2_000 * MS, KR, 0xAAAA);
        assert_eq!(rig.chip.take_reset_request(), Some(ResetCause::Model("IWDG")));
    }
}
