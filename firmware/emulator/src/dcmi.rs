//! The camera interface of the STM32H743 (RM0433, chapter "DCMI"): 8 bits, hardware synchronisation,
//! continuous mode.
//!
//! Where the manual leaves a choice, the model takes the unkind one: bytes that fill no word stay until
//! the interface is switched off, so that what follows is shifted by them; lines raise their flag also
//! while no frame is captured; after an overrun nothing is stored until it is switched off and on.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::soc::stm32h743::generated::dcmi::{Register, cr, ris, sr};
use rigless::time::{EventId, VirtualNanos};

use crate::camera::{Camera, FaultKind, SENSOR_LINES, SENSOR_WIDTH};
use crate::sensor::Registers;

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
    /// Before that part of that line.
    Part(usize, usize),
    /// After the last line.
    End,
}

/// The interface, and the two cameras on its pins.
#[derive(Debug)]
pub struct Dcmi {
    camera: Camera,
    sensors: [Arc<Mutex<Registers>>; 2],
    event: Option<(EventId, VirtualNanos)>,
    at: At,
    /// Frames that have ended.
    pub frame: u32,
    /// When the last one ended.
    pub ended: Option<VirtualNanos>,
    /// Next pulse of the trigger, and its period.
    trigger: Option<(u64, u64)>,
    line: Vec<u8>,
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
    pub fn new(camera: Camera, sensors: [Arc<Mutex<Registers>>; 2]) -> Self {
        Self {
            camera,
            sensors,
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

    /// The trigger pin pulses with this period, or not at all.
    pub fn trigger(&mut self, period: Option<VirtualNanos>, context: &mut DeviceContext<'_>) {
        match (period, self.trigger) {
            (Some(period), None) => {
                self.trigger = Some((context.now().0 + period.0, period.0));
                // A frame that outlived a reset ends first.
                if self.at == At::Blank {
                    self.next_trigger(context);
                }
            }
            (None, _) => self.trigger = None,
            _ => {}
        }
    }

    /// Frames that have begun, whether they have ended or not.
    pub fn begun(&self) -> u32 {
        self.frame + u32::from(self.at != At::Blank)
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
    }

    /// Lines of a good frame, time of a line, and time of its pixels.
    fn timing(&self) -> (usize, u64, u64) {
        let sensor = self.sensors[0].lock().expect("nobody panics");
        let nanos = |clocks: u64| clocks * 1_000_000_000 / sensor.pixel_rate();
        let lines = SENSOR_LINES[usize::from(!sensor.has_window())];
        (lines, nanos(sensor.line_length().max(SENSOR_WIDTH as u64 + 8)), nanos(SENSOR_WIDTH as u64))
    }

    fn step(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let now = context.now().0;
        let (lines, line_time, pixel_time) = self.timing();
        let is_armed = self.sensors.iter().all(|sensor| sensor.lock().expect("nobody panics").is_armed());
        let wait = match self.at {
            At::Blank => {
                if !is_armed || self.frame >= self.camera.frames {
                    self.next_trigger(context);
                    return;
                }
                self.start(registers);
                line_time
            }
            // A sensor that is reset shows nothing more.
            At::Part(..) if !is_armed => {
                self.at = At::End;
                0
            }
            At::Part(line, 0) if line >= self.camera.lines(self.frame, lines) => {
                self.at = At::End;
                0
            }
            At::Part(line, part) => self.part(line, part, lines, pixel_time, line_time, registers),
            At::End => {
                self.end(registers);
                self.update(registers, context);
                self.ended = Some(VirtualNanos(now));
                self.next_trigger(context);
                return;
            }
        };
        self.update(registers, context);
        self.wait_until(now + wait, context);
    }

    fn wait_until(&mut self, nanos: u64, context: &mut DeviceContext<'_>) {
        let at = VirtualNanos(nanos);
        self.event = Some((context.schedule(at), at));
    }

    /// Waits for the next pulse of the trigger.
    fn next_trigger(&mut self, context: &mut DeviceContext<'_>) {
        let Some((next, period)) = &mut self.trigger else { return };
        while *next <= context.now().0 {
            *next += *period;
        }
        let next = *next;
        self.wait_until(next, context);
    }

    fn start(&mut self, registers: &mut RegisterFile) {
        let control = registers.get(Register::Cr);
        self.capturing = cr::ENABLE.is_set(control) && cr::CAPTURE.is_set(control);
        self.at = At::Part(0, 0);
        registers.set(Register::Sr, sr::HSYNC.mask());
    }

    fn end(&mut self, registers: &mut RegisterFile) {
        if self.capturing {
            raise(registers, ris::FRAME_RIS.mask());
        }
        if cr::ENABLE.is_set(registers.get(Register::Cr)) {
            raise(registers, ris::VSYNC_RIS.mask());
        }
        registers.set(Register::Sr, sr::HSYNC.mask() | sr::VSYNC.mask());
        self.capturing = false;
        self.frame += 1;
        self.at = At::Blank;
    }

    /// A quarter of a line, and how long until the next one.
    fn part(
        &mut self,
        line: usize,
        part: usize,
        lines: usize,
        pixel_time: u64,
        line_time: u64,
        registers: &mut RegisterFile,
    ) -> u64 {
        let trouble = self.camera.trouble(self.frame).filter(|_| line == lines / 2);
        if part == 0 {
            self.line = self.camera.line(self.frame, line, lines);
            registers.set(Register::Sr, 0);
        }
        if part == 1 && trouble == Some(FaultKind::Stall) && !self.has_stalled {
            self.has_stalled = true;
            return STALL;
        }
        if part == PARTS {
            self.at = At::Part(line + 1, 0);
            registers.set(Register::Sr, sr::HSYNC.mask());
            if cr::ENABLE.is_set(registers.get(Register::Cr)) {
                raise(registers, ris::LINE_RIS.mask());
            }
            return line_time - pixel_time;
        }
        let (from, to) = (self.line.len() * part / PARTS, self.line.len() * (part + 1) / PARTS);
        if self.capturing {
            if part == 2 && trouble == Some(FaultKind::Overrun) {
                self.overrun(registers);
            }
            self.store(from, to, registers);
        }
        self.at = At::Part(line, part + 1);
        pixel_time / PARTS as u64
    }

    fn overrun(&mut self, registers: &mut RegisterFile) {
        raise(registers, ris::OVR_RIS.mask());
        self.switch_off();
    }

    fn store(&mut self, from: usize, to: usize, registers: &mut RegisterFile) {
        if !self.capturing {
            return;
        }
        // What nobody fetched since the last part: DMA does so at once if it runs.
        if self.fifo.len() > FIFO {
            self.overruns += 1;
            self.overrun(registers);
            return;
        }
        for &byte in &self.line[from..to] {
            self.partial.push(byte);
            if let Ok(word) = <[u8; 4]>::try_from(self.partial.as_slice()) {
                self.fifo.push_back(u32::from_le_bytes(word));
                self.partial.clear();
                self.words += 1;
            }
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
        }
    }

    fn reset_line(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        // The clock controller resets the interface, and what it waited for is gone; the cameras go on.
        registers.reset();
        self.switch_off();
        if let Some((_, at)) = self.event {
            self.wait_until(at.0, context);
        }
        self.update(registers, context);
    }
}
