//! The camera interface: [`Port`] at the registers of DCMI and the board's DMA, and the rows out of its ring.

use core::cell::RefCell;
use core::future::poll_fn;
use core::task::Poll;

use critical_section::{CriticalSection, Mutex};
use embassy_stm32::gpio::{AfType, Flex, Pull};
use embassy_stm32::interrupt::typelevel::{Handler, Interrupt};
use embassy_stm32::{Peri, pac, peripherals, rcc};
use embassy_sync::waitqueue::AtomicWaker;
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

use super::pair::{CLOCK_BYTES, WINDOW};
use super::this::PortInterrupt;
use super::this::clock::CORE;
use super::this::dma_ring::{self, DmaRing};
use crate::app::edge::{RowSource, SourceEvent};
use crate::app::port::{Events, Flags, Port, PortEvent, PortRegisters, Sync};
use crate::app::settings::{HEIGHT, WIDTH};

/// Bytes of a line of both sensors, and words.
const LINE_BYTES: usize = 2 * WINDOW[0] as usize;
const LINE_WORDS: usize = LINE_BYTES / 4;
const LINE_WORDS_U32: u32 = WINDOW[0] as u32 / 2;
const _: () = assert!(LINE_BYTES.is_multiple_of(4) && LINE_WORDS_U32 as usize == LINE_WORDS);
/// Lines in the ring: those whose events wait, three that came late, the one under way, and one being read.
const LINES: usize = 16;
/// Words of the ring.
pub(super) const RING: usize = LINES * LINE_WORDS;
/// Events that wait, of which all but two may be lines.
const QUEUE: usize = 11;

/// Data lines of the port.
pub const DATA: usize = if CLOCK_BYTES == 2 { 14 } else { 8 };
/// `EDM`: 8 or 14 lines.
const EDM: u8 = if CLOCK_BYTES == 2 { 0b11 } else { 0b00 };

/// The picture in the middle of the window.
const FIRST_BYTE: usize = (WINDOW[0] - WIDTH) as usize;
const FIRST_WORD: u32 = (WINDOW[0] - WIDTH) as u32 / 4;
const PICTURE_BYTES: usize = 2 * WIDTH as usize;
const FIRST_LINE: u32 = (WINDOW[1] as u32 - HEIGHT) / 2;

static EVENTS: ConstStaticCell<Queue<PortEvent, { QUEUE + 1 }>> = ConstStaticCell::new(Queue::new());
static SERVED: Mutex<RefCell<Option<Served>>> = Mutex::new(RefCell::new(None));
static WAKER: AtomicWaker = AtomicWaker::new();

/// What the interrupts work on.
struct Served {
    port: Port,
    events: Producer<'static, PortEvent>,
}

impl Events for Producer<'static, PortEvent> {
    fn room(&self) -> usize {
        self.capacity() - self.len()
    }

    fn push(&mut self, event: PortEvent) {
        // There is room: the port asks first.
        let _ = self.enqueue(event);
    }
}

/// The registers.
struct Pac;

impl PortRegisters for Pac {
    fn take_flags(&mut self) -> Flags {
        let raised = pac::DCMI.ris().read();
        pac::DCMI.icr().write_value(pac::dcmi::regs::Icr(raised.0));
        let dma_error = dma_ring::take_error();
        Flags { line: raised.line_ris(), frame: raised.frame_ris(), overrun: raised.ovr_ris(), dma_error }
    }

    fn sync(&self) -> Sync {
        let status = pac::DCMI.sr().read();
        match (status.vsync(), status.hsync()) {
            (true, _) => Sync::BetweenFrames,
            (false, true) => Sync::BetweenLines,
            (false, false) => Sync::InLine,
        }
    }

    fn ring_position(&self) -> u32 {
        dma_ring::position()
    }

    fn wait(&mut self) {
        cortex_m::asm::delay(CORE / 10_000_000);
    }

    fn stop(&mut self) {
        rcc::enable_and_reset::<peripherals::DCMI>();
    }

    fn restart(&mut self) {
        // A reset is what surely empties it.
        self.stop();
        pac::DCMI.ier().write(|w| {
            w.set_line_ie(true);
            w.set_frame_ie(true);
            w.set_ovr_ie(true);
        });
        pac::DCMI.cr().write(|w| {
            // Continuous (`CM` 0), every frame; both sync signals are low where no pixels are.
            w.set_edm(EDM);
            w.set_pckpol(true);
            w.set_enable(true);
        });
        pac::DCMI.cr().modify(|w| w.set_capture(true));
    }
}

/// Serves the interrupts of the port, and those of its DMA that tell of an error.
pub struct PortHandler;

impl Handler<PortInterrupt> for PortHandler {
    #[expect(unsafe_code, reason = "the trait's")]
    unsafe fn on_interrupt() {
        serve();
    }
}

/// Serves the port.
pub(super) fn serve() {
    critical_section::with(|cs| {
        with_port(cs, |served| served.port.serve(&mut Pac, &mut served.events));
    });
    WAKER.wake();
}

fn with_port(cs: CriticalSection<'_>, act: impl FnOnce(&mut Served)) {
    if let Some(served) = SERVED.borrow_ref_mut(cs).as_mut() {
        act(served);
    }
}

/// Words that DMA has stored since the port was started, wrapping around.
pub fn stored() -> u32 {
    let mut stored = 0;
    critical_section::with(|cs| with_port(cs, |served| stored = served.port.stored(&Pac)));
    stored
}

/// A pin, and the number of its function as one of the port's.
pub type Pin = (Flex<'static>, u8);

/// The pins of the port.
pub struct Pins {
    _data: [Flex<'static>; DATA],
    _sync: [Flex<'static>; 3],
}

impl Pins {
    /// Gives the pins to the port, all of them inputs: D0 and those after it, as many as are in use; pixel clock, HSYNC, VSYNC.
    #[must_use]
    pub fn new(data: [Pin; DATA], sync: [Pin; 3]) -> Self {
        let give = |(mut pin, function): Pin| {
            pin.set_as_af_unchecked(function, AfType::input(Pull::None));
            pin
        };
        Self { _data: data.map(give), _sync: sync.map(give) }
    }
}

/// The camera.
pub struct Camera {
    ring: DmaRing,
    events: Consumer<'static, PortEvent>,
    /// Lines of the frame so far.
    line: u32,
    _pins: Pins,
}

impl Camera {
    /// Takes the port, which stores nothing until [`begin`](Self::begin). Can be called once.
    ///
    /// # Panics
    /// If it is called twice.
    pub fn new(_port: Peri<'static, peripherals::DCMI>, ring: DmaRing, pins: Pins) -> Self {
        let (events, taken) = EVENTS.take().split();
        let port = Port::new(LINE_WORDS_U32, u32::try_from(RING).unwrap_or(0));
        critical_section::with(|cs| SERVED.borrow_ref_mut(cs).replace(Served { port, events }));
        Self { ring, events: taken, line: 0, _pins: pins }
    }

    /// Stores from the next frame's start on. What sensors show before they are set up is nobody's.
    pub fn begin(&mut self) {
        self.restart();
        PortInterrupt::unpend();
        #[expect(unsafe_code, reason = "its handler is ready")]
        // SAFETY: no critical section is built on its mask.
        unsafe {
            PortInterrupt::enable();
        }
    }

    /// Where in the ring DMA stores next: it moves as long as bytes come.
    #[must_use]
    pub fn position() -> u32 {
        Pac.ring_position()
    }

    /// Begins anew, DMA too.
    fn restart(&mut self) {
        critical_section::with(|cs| {
            with_port(cs, |_| Pac.stop());
        });
        self.ring.stop();
        while self.events.dequeue().is_some() {}
        self.ring.start();
        self.line = 0;
        critical_section::with(|cs| with_port(cs, |served| served.port.start(&mut Pac)));
    }

    /// The picture's bytes of the line that begins at word `at`; whether they were still there.
    fn copy(&mut self, at: u32, bytes: &mut [u8]) -> bool {
        let Some(bytes) = bytes.get_mut(..PICTURE_BYTES) else { return false };
        if FIRST_BYTE.is_multiple_of(4) && PICTURE_BYTES.is_multiple_of(4) {
            return self.ring.read(at.wrapping_add(FIRST_WORD), bytes.as_chunks_mut().0);
        }
        let mut line = [[0; 4]; LINE_WORDS];
        let is_there = self.ring.read(at, &mut line);
        let picture = line.as_flattened().iter().skip(FIRST_BYTE);
        bytes.iter_mut().zip(picture).for_each(|(to, &from)| *to = from);
        is_there
    }

    fn lapped(&mut self) -> SourceEvent {
        defmt::warn!("camera: the ring was lapped");
        self.restart();
        SourceEvent::Overrun
    }

    /// Counts the line; whether it is one of the picture's, or one too many.
    fn next_is_wanted(&mut self) -> bool {
        let line = self.line;
        self.line += 1;
        line.checked_sub(FIRST_LINE).is_some_and(|row| row < HEIGHT) || line >= u32::from(WINDOW[1])
    }
}

impl RowSource for Camera {
    async fn next(&mut self, bytes: &mut [u8]) -> SourceEvent {
        let event = poll_fn(|cx| {
            WAKER.register(cx.waker());
            self.events.dequeue().map_or(Poll::Pending, Poll::Ready)
        });
        match event.await {
            PortEvent::Start => {
                self.line = 0;
                SourceEvent::Start
            }
            PortEvent::Row { at } => {
                if !self.next_is_wanted() {
                    SourceEvent::Border
                } else if self.copy(at, bytes) {
                    SourceEvent::Row(PICTURE_BYTES)
                } else {
                    self.lapped()
                }
            }
            PortEvent::Lost if self.next_is_wanted() => SourceEvent::Lost,
            PortEvent::Lost => SourceEvent::Border,
            PortEvent::End => SourceEvent::End,
            PortEvent::Overrun => SourceEvent::Overrun,
            PortEvent::DmaError => {
                self.restart();
                SourceEvent::DmaError
            }
        }
    }

    fn is_waiting(&self) -> bool {
        // Capture interrupts the vision task: nobody needs its turn.
        true
    }
}
