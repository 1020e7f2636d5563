//! The camera interface of the STM32H743 (RM0433, chapter "DCMI"): 8 to 14 bits, hardware synchronisation,
//! continuous mode; and the two sensors on its pins.
//!
//! Where the manual leaves a choice, the model takes the unkind one: bytes that fill no word stay until
//! the interface is switched off, so that what follows is shifted by them; lines raise their flag also
//! while no frame is captured; after an overrun nothing is stored until it is switched off and on. The words of a line
//! are on their way for some microseconds when its end is told.

use std::collections::VecDeque;

use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::soc::stm32h743::generated::dcmi::{Register, cr, ris, sr};
use rigless::time::{EventId, VirtualNanos};

use crate::camera::{Camera, FaultKind};
use crate::sensor::{Mode, Model, Shared, Timing};
use crate::wires::Mistake;

/// The request to the DMA multiplexer, and the interrupt.
const REQUEST: usize = 0;
const INTERRUPT: usize = 0;
/// Words between port and DMA: RM0433 gives four.
const FIFO: usize = 4;
/// Parts in which the bytes of a line come.
const PARTS: usize = 4;
/// How long the pixel clock stands still, ns.
const STALL: u64 = 100_000_000;

/// Where the picture is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum At {
    /// Between frames.
    Blank,
    /// The pixels of a frame to come gather light.
    Integration,
    /// Before that part of that line.
    Part(usize, usize),
    /// After the last line.
    End,
}

/// What a timer does with the sensors' pins, again and again, ns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trigger {
    /// From one edge of the trigger to the next.
    pub period: u64,
    /// From the edge to the beginning of the standby and to its end.
    pub standby: Option<[u64; 2]>,
}

/// The interface, and the two cameras on its pins.
#[derive(Debug)]
pub struct Dcmi {
    camera: Camera,
    sensors: [Shared; 2],
    mistake: Option<Mistake>,
    event: Option<(EventId, VirtualNanos)>,
    at: At,
    /// Frames that have ended.
    pub frame: u32,
    /// When the last one ended.
    pub ended: Option<VirtualNanos>,
    /// The next pulse of the trigger, and how it goes on.
    trigger: Option<(u64, Trigger)>,
    /// The samples of the line under way, a bit a data line.
    line: Vec<u16>,
    /// The frame under way.
    timing: Timing,
    /// When it started, and when its integration ended, where there is a trigger.
    began: u64,
    /// When the last frames' first lines came, in their order.
    pub shown: Vec<u64>,
    /// How long words are on their way to the memory, ns; those that are, and when they arrive.
    late: u64,
    on_their_way: VecDeque<(u64, u32)>,
    arrival: Option<EventId>,
    /// Whether the frame under way is stored.
    capturing: bool,
    /// Bytes that fill no word yet.
    partial: Vec<u8>,
    fifo: VecDeque<u32>,
    has_stalled: bool,
    /// Words stored, and times that the FIFO ran over without a fault asking for it.
    pub words: u64,
    pub overruns: u64,
}

impl Dcmi {
    pub fn new(camera: Camera, sensors: [Shared; 2], mistake: Option<Mistake>, late: u64) -> Self {
        Self {
            camera,
            sensors,
            mistake,
            timing: Timing::OFF,
            began: 0,
            shown: Vec::new(),
            late,
            on_their_way: VecDeque::new(),
            arrival: None,
            event: None,
            at: At::Blank,
            frame: 0,
            ended: None,
            trigger: None,
            line: Vec::new(),
            capturing: false,
            partial: Vec::new(),
            fifo: VecDeque::new(),
            has_stalled: false,
            words: 0,
            overruns: 0,
        }
    }

    /// The trigger pin pulses so, or not at all. Sensors that need none may have been started.
    pub fn trigger(&mut self, trigger: Option<Trigger>, context: &mut DeviceContext<'_>) {
        let trigger = trigger.filter(|_| self.mistake != Some(Mistake::NoTrigger));
        match (trigger, &mut self.trigger) {
            (Some(trigger), None) => {
                self.trigger = Some((context.now().0 + trigger.period, trigger));
                // A frame that outlived a reset ends first.
                if self.at == At::Blank {
                    self.next_frame(context);
                }
            }
            (Some(trigger), Some((_, before))) => *before = trigger,
            (None, _) => self.trigger = None,
        }
        let is_streaming = || matches!(self.sensor_timing().mode, Mode::Streaming(_));
        if self.at == At::Blank && self.event.is_none() && is_streaming() {
            self.wait_until(context.now().0 + 1, context);
        }
    }

    /// The frames of both, which are alike unless somebody made a mistake.
    fn sensor_timing(&self) -> Timing {
        let [one, other] = self.sensors.each_ref().map(|sensor| sensor.lock().expect("nobody panics").timing());
        if one.mode == Mode::Off || other.mode == Mode::Off { Timing::OFF } else { one }
    }

    /// Whether the frame under way is one of the dump's.
    fn is_shown(&self) -> bool {
        let is_mt9v034 = self.sensors[0].lock().expect("nobody panics").model == Model::Mt9v034;
        !is_mt9v034 || self.timing.mode == Mode::Triggered
    }

    /// Frames that have begun, whether they have ended or not.
    pub fn begun(&self) -> u32 {
        self.frame + u32::from(self.at != At::Blank && self.is_shown())
    }

    /// On how many lines each sensor gives a pixel.
    pub fn bits(&self) -> [Option<u8>; 2] {
        self.sensors.each_ref().map(|sensor| sensor.lock().expect("nobody panics").bits())
    }

    /// Whether all frames were shown.
    pub fn is_over(&self) -> bool {
        self.frame >= self.camera.frames && self.at == At::Blank
    }

    /// The part restarted. Whatever was scheduled is gone, and the trigger stands still; a frame under way
    /// goes on, and nobody stores it.
    pub fn restarted(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        self.switch_off();
        self.trigger = None;
        self.arrival = None;
        let event = self.event.take().filter(|_| self.at != At::Blank);
        if let Some((_, at)) = event {
            self.wait_until(at.0, context);
        } else {
            registers.set(Register::Sr, sr::HSYNC.mask() | sr::VSYNC.mask());
        }
    }

    fn switch_off(&mut self) {
        self.capturing = false;
        self.partial.clear();
        self.fifo.clear();
        self.on_their_way.clear();
    }

    fn step(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let now = context.now().0;
        let is_on = self.sensor_timing().mode != Mode::Off;
        let wait = match self.at {
            At::Blank => {
                if !is_on || self.frame >= self.camera.frames {
                    self.next_frame(context);
                    return;
                }
                // A sensor that runs freely, as before its set-up, waits for no trigger.
                let is_triggered = !matches!(self.sensor_timing().mode, Mode::Streaming(_));
                if is_triggered && !self.wake(now) {
                    self.next_frame(context);
                    return;
                }
                for sensor in &self.sensors {
                    sensor.lock().expect("nobody panics").begin_frame();
                }
                self.timing = self.sensor_timing();
                self.began = now;
                self.at = At::Integration;
                self.timing.integration
            }
            At::Integration => {
                if self.is_shown() {
                    self.shown.push(now);
                }
                self.start(registers);
                self.timing.line
            }
            // A sensor that is reset shows nothing more.
            At::Part(..) if !is_on => {
                self.at = At::End;
                0
            }
            At::Part(line, 0) if line >= self.camera.lines(self.frame, self.timing.lines) => {
                self.at = At::End;
                0
            }
            At::Part(line, part) => self.part(line, part, registers, now),
            At::End => {
                self.end(registers);
                self.update(registers, context);
                self.ended = Some(VirtualNanos(now));
                self.next_frame(context);
                return;
            }
        };
        self.update(registers, context);
        self.expect_arrival(context);
        self.wait_until(now + wait, context);
    }

    fn wait_until(&mut self, nanos: u64, context: &mut DeviceContext<'_>) {
        let at = VirtualNanos(nanos);
        self.event = Some((context.schedule(at), at));
    }

    /// The trigger's edge came: whether the sensors were awake in time; and when they will sleep.
    fn wake(&self, now: u64) -> bool {
        let Some((_, Trigger { period, standby })) = self.trigger else { return true };
        self.sensors.iter().all(|sensor| {
            let mut sensor = sensor.lock().expect("nobody panics");
            sensor.standby = standby.map(|ends| ends.map(|end| now + end));
            standby.is_none_or(|[_, end]| sensor.wakes_within(period - end))
        })
    }

    /// How long the sensors are in standby for each frame, ns.
    pub fn standby(&self) -> Option<u64> {
        let [begin, end] = self.trigger?.1.standby?;
        Some(end - begin)
    }

    /// Waits for the next pulse of the trigger, or for the time of the next frame.
    fn next_frame(&mut self, context: &mut DeviceContext<'_>) {
        let now = context.now().0;
        match self.sensor_timing().mode {
            Mode::Streaming(period) if self.frame < self.camera.frames => {
                let next = self.began + period * now.saturating_sub(self.began).div_ceil(period).max(1);
                self.wait_until(next, context);
            }
            _ => {
                let Some((next, trigger)) = &mut self.trigger else { return };
                while *next <= now {
                    *next += trigger.period;
                }
                let next = *next;
                self.wait_until(next, context);
            }
        }
    }

    fn start(&mut self, registers: &mut RegisterFile) {
        let control = registers.get(Register::Cr);
        self.capturing = cr::ENABLE.is_set(control) && cr::CAPTURE.is_set(control);
        self.at = At::Part(0, 0);
        self.set_sync(registers, sr::HSYNC.mask());
    }

    /// The sync signals as the port sees them: high where there are no pixels.
    fn set_sync(&self, registers: &mut RegisterFile, signals: u64) {
        let signals = match self.mistake {
            Some(Mistake::NoPixelClock) => return,
            Some(Mistake::NoLines) => signals & !sr::HSYNC.mask(),
            Some(Mistake::NoFrames) => signals & !sr::VSYNC.mask(),
            _ => signals,
        };
        registers.set(Register::Sr, signals);
    }

    /// Raises a flag, unless its signal does not come.
    fn raise(&self, registers: &mut RegisterFile, flag: u64) {
        let missing = match self.mistake {
            Some(Mistake::NoPixelClock) => u64::MAX,
            Some(Mistake::NoLines) => ris::LINE_RIS.mask(),
            Some(Mistake::NoFrames) => ris::FRAME_RIS.mask() | ris::VSYNC_RIS.mask(),
            _ => 0,
        };
        raise(registers, flag & !missing);
    }

    fn end(&mut self, registers: &mut RegisterFile) {
        if self.capturing {
            self.raise(registers, ris::FRAME_RIS.mask());
        }
        if cr::ENABLE.is_set(registers.get(Register::Cr)) {
            self.raise(registers, ris::VSYNC_RIS.mask());
        }
        self.set_sync(registers, sr::HSYNC.mask() | sr::VSYNC.mask());
        // Without a frame signal the port goes on with what it began.
        self.capturing &= self.mistake == Some(Mistake::NoFrames);
        // What an MT9V034 shows by itself, before it is set up, is none of the dump's frames.
        self.frame += u32::from(self.is_shown());
        self.at = At::Blank;
    }

    /// A quarter of a line, and how long until the next one.
    fn part(&mut self, line: usize, part: usize, registers: &mut RegisterFile, now: u64) -> u64 {
        let Timing { lines, pixels, line: line_time, pixel: pixel_time, .. } = self.timing;
        let trouble = self.camera.trouble(self.frame).filter(|_| line == lines / 2);
        if part == 0 {
            let bytes = self.camera.line(self.frame, line, lines, pixels);
            self.line = self.samples(&bytes, registers);
            self.set_sync(registers, 0);
        }
        if part == 1 && trouble == Some(FaultKind::Stall) && !self.has_stalled {
            self.has_stalled = true;
            return STALL;
        }
        if part == PARTS {
            self.at = At::Part(line + 1, 0);
            self.set_sync(registers, sr::HSYNC.mask());
            if cr::ENABLE.is_set(registers.get(Register::Cr)) {
                self.raise(registers, ris::LINE_RIS.mask());
            }
            return line_time - pixel_time;
        }
        let (from, to) = (self.line.len() * part / PARTS, self.line.len() * (part + 1) / PARTS);
        if self.capturing && self.mistake != Some(Mistake::NoPixelClock) {
            if part == 2 && trouble == Some(FaultKind::Overrun) {
                self.overrun(registers);
            }
            self.store(from, to, registers, now);
        }
        self.at = At::Part(line, part + 1);
        pixel_time / PARTS as u64
    }

    /// What the data lines carry of a line's bytes, a sample a pixel clock, as the port takes them.
    fn samples(&self, bytes: &[u8], registers: &RegisterFile) -> Vec<u16> {
        let patterns = self.sensors.each_ref().map(|sensor| sensor.lock().expect("nobody panics").timing().pattern);
        let is_wide = self.sensors[0].lock().expect("nobody panics").model == Model::Mt9v034;
        let mut samples: Vec<u16> = if is_wide {
            let pairs = bytes.as_chunks::<2>().0.iter();
            pairs
                .map(|&pair| {
                    let seen = u16::from_le_bytes(pair) & 0x3FFF;
                    let of = |pattern: Option<u16>, seen: u16| pattern.map_or(seen, |pattern| pattern >> 3 & 0x7F);
                    of(patterns[0], seen & 0x7F) | of(patterns[1], seen >> 7) << 7
                })
                .collect()
        } else {
            bytes.iter().map(|&byte| patterns[0].unwrap_or(u16::from(byte))).collect()
        };
        // An odd byte left over is half a sample.
        if is_wide && !bytes.len().is_multiple_of(2) {
            samples.pop();
        }
        let second = if is_wide { 0x3F80 } else { 0xF0 };
        if self.timing.is_free {
            // Each by its own oscillator: nobody knows by how much.
            Mistake::OutOfPhase(5).bend(&mut samples, second);
        }
        // Pixels taken at the wrong edge are those of nobody.
        if self.timing.is_falling == cr::PCKPOL.is_set(registers.get(Register::Cr)) {
            for at in 1..samples.len() {
                samples[at - 1] = samples[at - 1] & 0x1555 | samples[at] & !0x1555;
            }
        }
        if let Some(mistake) = self.mistake {
            mistake.bend(&mut samples, second);
        }
        samples
    }

    fn overrun(&mut self, registers: &mut RegisterFile) {
        raise(registers, ris::OVR_RIS.mask());
        self.switch_off();
    }

    fn store(&mut self, from: usize, to: usize, registers: &mut RegisterFile, now: u64) {
        if !self.capturing {
            return;
        }
        // What nobody fetched since the last part: DMA does so at once if it runs.
        if self.fifo.len() > FIFO {
            self.overruns += 1;
            self.overrun(registers);
            return;
        }
        // With more than eight lines a sample takes two bytes.
        let edm = cr::EDM.get(registers.get(Register::Cr));
        for &sample in &self.line[from..to] {
            let [low, high] = (sample & ((1 << (8 + 2 * edm)) - 1)).to_le_bytes();
            self.partial.push(low);
            if edm > 0 {
                self.partial.push(high);
            }
            if let Ok(word) = <[u8; 4]>::try_from(self.partial.as_slice()) {
                self.on_their_way.push_back((now + self.late, u32::from_le_bytes(word)));
                self.partial.clear();
                self.words += 1;
            }
        }
        self.arrive(now);
    }

    /// Words that have arrived.
    fn arrive(&mut self, now: u64) {
        while let Some((_, word)) = self.on_their_way.pop_front_if(|(at, _)| *at <= now) {
            self.fifo.push_back(word);
        }
    }

    /// Waits for the next word that is on its way.
    fn expect_arrival(&mut self, context: &mut DeviceContext<'_>) {
        if let (None, Some(&(at, _))) = (self.arrival, self.on_their_way.front()) {
            self.arrival = Some(context.schedule(VirtualNanos(at)));
        }
    }

    /// Drives what the flags and the FIFO ask for.
    fn update(&self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let flags = registers.get(Register::Ris) & registers.get(Register::Ier);
        registers.set(Register::Mis, flags);
        context.interrupt(INTERRUPT, Level::from(flags != 0));
        context.request(REQUEST, Level::from(!self.fifo.is_empty()));
    }
}

fn raise(registers: &mut RegisterFile, flag: u64) {
    registers.set(Register::Ris, registers.get(Register::Ris) | flag);
}

impl Device for Dcmi {
    type Register = Register;

    fn read(
        &mut self,
        register: Register,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        if register != Register::Dr {
            return None;
        }
        let word = self.fifo.pop_front().unwrap_or(0);
        self.update(registers, context);
        Some(u64::from(word))
    }

    fn write(&mut self, register: Register, value: u64, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        match register {
            Register::Icr => {
                registers.set(Register::Ris, registers.get(Register::Ris) & !value);
                registers.set(Register::Icr, 0);
            }
            Register::Cr if !cr::ENABLE.is_set(value) || !cr::CAPTURE.is_set(value) => self.switch_off(),
            _ => {}
        }
        self.update(registers, context);
    }

    fn on_event(&mut self, event: EventId, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        if self.event.is_some_and(|(awaited, _)| awaited == event) {
            self.event = None;
            self.step(registers, context);
        } else if self.arrival == Some(event) {
            self.arrival = None;
            self.arrive(context.now().0);
            self.expect_arrival(context);
            self.update(registers, context);
        }
    }

    fn reset_line(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        // The clock controller resets the interface, and what it waited for is gone; the cameras go on.
        registers.reset();
        self.switch_off();
        self.arrival = None;
        if let Some((_, at)) = self.event {
            self.wait_until(at.0, context);
        }
        self.update(registers, context);
    }
}
