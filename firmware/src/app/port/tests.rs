//! The port against a camera that misbehaves in every way, served early and late.
#![expect(clippy::cast_possible_truncation, reason = "a few rows of a few bytes")]

use core::sync::atomic::{AtomicU32, Ordering};

use proptest::prelude::*;

use super::*;
use crate::app::address_ring::AddressRing;

const ROW: usize = 8;
/// Room for the rows that may wait in the queue, three that came late and the one under way; and a word that is spared.
const RING: usize = 9 * ROW + 1;
/// Where the ring lies, as DMA has it.
const BASE: u32 = 0x2004_0000;
const QUEUE: usize = 7;
const LINES: usize = 5;

/// How DMA tells where in the ring it stores next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Told {
    /// By a counter of the words that are left, which begins anew with the last one.
    ByCounter,
    /// By its destination address, which stays behind the last word for a while.
    ByAddress,
}

const KINDS: [Told; 2] = [Told::ByCounter, Told::ByAddress];

/// A camera, a port of bytes and a DMA ring. A byte of the picture tells its frame's and line's number.
struct Model {
    told: Told,
    memory: &'static [AtomicU32; RING],
    /// Whether the address is behind the last word: DMA has not begun anew.
    is_behind: bool,
    flags: Flags,
    sync: Option<Sync>,
    armed: bool,
    capturing: bool,
    dma_stands: bool,
    /// Bytes that fill no word yet.
    partial: Vec<u8>,
    /// Words that are on their way, and looks until they arrive.
    on_their_way: Vec<[u8; 4]>,
    late: u32,
    /// All words ever stored since the port's start.
    stored: Vec<[u8; 4]>,
    events: Vec<PortEvent>,
    restarts: usize,
}

impl Events for Vec<PortEvent> {
    fn room(&self) -> usize {
        QUEUE - self.len().min(QUEUE)
    }
    fn push(&mut self, event: PortEvent) {
        assert!(self.len() < QUEUE);
        Self::push(self, event);
    }
}

impl PortRegisters for Model {
    fn take_flags(&mut self) -> Flags {
        std::mem::take(&mut self.flags)
    }
    fn sync(&self) -> Sync {
        self.sync.unwrap_or(Sync::BetweenFrames)
    }
    fn ring_position(&self) -> u32 {
        let place = self.stored.len() % RING;
        match self.told {
            Told::ByCounter => {
                let left = RING - place;
                (RING - left) as u32
            }
            Told::ByAddress => {
                let words = if self.is_behind { RING } else { place };
                AddressRing::new(self.memory, BASE).position(BASE + 4 * words as u32)
            }
        }
    }
    fn wait(&mut self) {
        self.is_behind = false;
        self.late = self.late.saturating_sub(1);
        if self.late == 0 {
            std::mem::take(&mut self.on_their_way).into_iter().for_each(|word| self.store(word));
        }
    }
    fn stop(&mut self) {
        (self.armed, self.capturing) = (false, false);
    }
    fn restart(&mut self) {
        self.partial.clear();
        (self.armed, self.capturing) = (true, false);
        self.restarts += 1;
    }
}

impl Model {
    fn new(told: Told) -> Self {
        let memory = Box::leak(Box::new([const { AtomicU32::new(0) }; RING]));
        Self {
            told,
            memory,
            is_behind: false,
            flags: Flags::default(),
            sync: None,
            armed: false,
            capturing: false,
            dma_stands: false,
            partial: Vec::new(),
            on_their_way: Vec::new(),
            late: 0,
            stored: Vec::new(),
            events: Vec::new(),
            restarts: 0,
        }
    }
    fn store(&mut self, word: [u8; 4]) {
        self.memory[self.stored.len() % RING].store(u32::from_le_bytes(word), Ordering::Relaxed);
        self.stored.push(word);
        self.is_behind = self.stored.len().is_multiple_of(RING);
    }
    fn start_frame(&mut self) {
        self.capturing = self.armed;
        self.sync = Some(Sync::BetweenLines);
    }
    fn send(&mut self, bytes: usize, mark: u8) {
        self.sync = Some(Sync::InLine);
        if self.capturing && !self.dma_stands {
            for _ in 0..bytes {
                self.partial.push(mark);
                if let Ok(word) = <[u8; 4]>::try_from(self.partial.as_slice()) {
                    self.store(word);
                    self.partial.clear();
                }
            }
        }
    }
    /// The last words of a line that was sent are still on their way, for so many looks.
    fn delay(&mut self, words: usize, looks: u32) {
        self.on_their_way = self.stored.split_off(self.stored.len() - words);
        self.is_behind = false;
        self.late = looks;
    }
    fn end_line(&mut self) {
        self.sync = Some(Sync::BetweenLines);
        self.flags.line = true;
    }
    fn end_frame(&mut self) {
        self.sync = Some(Sync::BetweenFrames);
        self.flags.frame |= self.capturing;
        self.capturing = false;
    }
    fn serve(&mut self, port: &mut Port) {
        let mut events = std::mem::take(&mut self.events);
        port.serve(self, &mut events);
        self.events = events;
    }
    fn row(&self, at: u32) -> &[[u8; 4]] {
        // It must still be in the ring.
        let at = usize::try_from(at).unwrap();
        assert!(self.stored.len() - at <= RING, "overwritten before it was read");
        &self.stored[at..at + ROW]
    }
}

/// What goes wrong with a line.
#[derive(Debug, Clone, Copy)]
enum Wrong {
    Nothing,
    Short(usize),
    Overrun,
    DmaError,
    EndsFrame,
    Repeats,
}

#[derive(Debug, Clone, Copy)]
struct Line {
    wrong: Wrong,
    /// Whether the interrupt is served at the line's end, within the next line, or by neither.
    served: Served,
    /// Whether the events are taken after it.
    taken: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Served {
    AtOnce,
    Late,
    Not,
}

fn line() -> impl Strategy<Value = Line> {
    let wrong = prop_oneof![
        12 => Just(Wrong::Nothing),
        2 => (1..=4 * ROW - 4).prop_map(Wrong::Short),
        1 => Just(Wrong::Overrun),
        1 => Just(Wrong::DmaError),
        1 => Just(Wrong::EndsFrame),
        1 => Just(Wrong::Repeats),
    ];
    let served = prop_oneof![8 => Just(Served::AtOnce), 2 => Just(Served::Late), 1 => Just(Served::Not)];
    (wrong, served, prop::bool::weighted(0.8)).prop_map(|(wrong, served, taken)| {
        // Late for a wrong line is a fault too many: nobody can tell its words from the next one's.
        let served = if matches!(wrong, Wrong::Short(_)) { Served::AtOnce } else { served };
        Line { wrong, served, taken }
    })
}

/// Whoever takes the events, and restarts what must be restarted.
struct Taker {
    in_frame: bool,
    /// Rows of the frame so far.
    rows: u8,
    /// Marks of the frames that came whole.
    whole: Vec<u8>,
    good: bool,
    /// The ring as it is read.
    ring: AddressRing<'static>,
}

impl Taker {
    fn take(&mut self, model: &mut Model, port: &mut Port) {
        for event in std::mem::take(&mut model.events) {
            match event {
                PortEvent::Start => {
                    assert!(!self.in_frame);
                    (self.in_frame, self.rows, self.good) = (true, 0, true);
                }
                PortEvent::Row { at } => {
                    assert!(self.in_frame);
                    let row = model.row(at);
                    let mut read = [[0; 4]; ROW];
                    assert!(self.ring.read(at, &mut read, || port.stored(model)), "overwritten before it was read");
                    assert_eq!(read, row[..], "another row than was stored");
                    let mark = row[0][0];
                    assert!(row.iter().all(|word| *word == [mark; 4]), "a row of two lines");
                    assert!(!self.good || mark % 16 == self.rows, "row {} in place of {}", mark % 16, self.rows);
                    self.rows += 1;
                }
                PortEvent::Lost => {
                    assert!(self.in_frame);
                    self.rows += 1;
                    self.good = false;
                }
                PortEvent::End => {
                    assert!(self.in_frame);
                    self.in_frame = false;
                    if self.good {
                        self.whole.push(self.rows);
                    }
                }
                PortEvent::Overrun => self.in_frame = false,
                PortEvent::DmaError => {
                    self.in_frame = false;
                    model.events.clear();
                    self.ring.restart();
                    model.is_behind = false;
                    (model.dma_stands, model.stored, model.partial) = (false, Vec::new(), Vec::new());
                    port.start(model);
                }
            }
        }
    }
}

fn play(lines: &[Line], frame: u8, model: &mut Model, port: &mut Port, taker: &mut Taker) {
    model.start_frame();
    for (number, line) in (0_u8..).zip(lines) {
        let bytes = 4 * ROW - if let Wrong::Short(by) = line.wrong { by } else { 0 };
        let mark = frame % 16 * 16 + number;
        model.send(bytes / 2, mark);
        if model.flags.line && line.served == Served::Late {
            model.serve(port);
        }
        match line.wrong {
            Wrong::Overrun => {
                model.flags.overrun = true;
                model.capturing = false;
                model.serve(port);
            }
            Wrong::DmaError => {
                (model.flags.dma_error, model.dma_stands) = (true, true);
                model.serve(port);
            }
            Wrong::EndsFrame => break,
            _ => {}
        }
        model.send(bytes - bytes / 2, mark);
        model.end_line();
        if line.served == Served::AtOnce {
            model.serve(port);
        }
        if line.taken {
            taker.take(model, port);
        }
        if matches!(line.wrong, Wrong::Repeats) {
            // A glitch of the line signal: no pixel came.
            model.end_line();
            model.serve(port);
        }
    }
    model.end_frame();
    model.serve(port);
}

fn started(told: Told) -> (Model, Port, Taker) {
    let mut model = Model::new(told);
    let mut port = Port::new(u32::try_from(ROW).unwrap(), u32::try_from(RING).unwrap());
    port.start(&mut model);
    let ring = AddressRing::new(model.memory, BASE);
    (model, port, Taker { in_frame: false, rows: 0, whole: Vec::new(), good: true, ring })
}

const GOOD: Line = Line { wrong: Wrong::Nothing, served: Served::AtOnce, taken: true };

fn with(at: usize, wrong: Wrong) -> Vec<Line> {
    let mut lines = vec![GOOD; LINES];
    lines[at].wrong = wrong;
    lines
}

#[test]
fn every_trouble_is_told_and_over_with_its_frame() {
    let all = [Wrong::Short(1), Wrong::Short(4), Wrong::Overrun, Wrong::DmaError, Wrong::EndsFrame, Wrong::Repeats];
    for (wrong, told) in all.into_iter().flat_map(|wrong| KINDS.map(|told| (wrong, told))) {
        let (mut model, mut port, mut taker) = started(told);
        play(&[GOOD; LINES], 0, &mut model, &mut port, &mut taker);
        play(&with(2, wrong), 1, &mut model, &mut port, &mut taker);
        taker.take(&mut model, &mut port);
        play(&[GOOD; LINES], 2, &mut model, &mut port, &mut taker);
        taker.take(&mut model, &mut port);
        let whole = taker.whole;
        match wrong {
            Wrong::Repeats => assert_eq!(whole, [5, 5, 5], "{wrong:?}"),
            Wrong::EndsFrame => {
                assert_eq!(whole.len() + whole.iter().filter(|&&n| n == 5).count(), 4, "{wrong:?}: {whole:?}")
            }
            _ => assert_eq!(whole, [5, 5], "{wrong:?}"),
        }
    }
}

#[test]
fn a_wrong_line_loses_the_rest_of_its_frame_only() {
    let (mut model, mut port, mut taker) = started(Told::ByAddress);
    model.start_frame();
    for bytes in [32, 31, 32, 32] {
        model.send(bytes, 0);
        model.end_line();
        model.serve(&mut port);
    }
    use PortEvent::{Lost, Row, Start};
    assert_eq!(model.events, [Start, Row { at: 0 }, Lost, Lost, Lost]);
    taker.take(&mut model, &mut port);
    let restarts = model.restarts;
    model.end_frame();
    model.serve(&mut port);
    assert_eq!((model.events.as_slice(), model.restarts), ([PortEvent::End].as_slice(), restarts + 1));
}

#[test]
fn lines_of_a_frame_that_is_not_captured_are_nothing() {
    let (mut model, mut port, _) = started(Told::ByAddress);
    for _ in 0..3 {
        model.send(32, 0);
        model.end_line();
        model.serve(&mut port);
    }
    assert_eq!(model.events, []);
}

proptest! {
    #[test]
    fn rows_are_whole_and_in_their_places_and_the_next_good_frame_is_good(
        frames in prop::collection::vec(prop::collection::vec(line(), 0..9), 0..6),
        told in prop::sample::select(&KINDS),
    ) {
        let (mut model, mut port, mut taker) = started(told);
        for (number, lines) in (0_u8..).zip(&frames) {
            play(lines, number, &mut model, &mut port, &mut taker);
        }
        // Whoever takes the rows comes back before the next frame.
        taker.take(&mut model, &mut port);
        let before = taker.whole.len();
        play(&[GOOD; LINES], 15, &mut model, &mut port, &mut taker);
        taker.take(&mut model, &mut port);
        prop_assert!(!taker.in_frame);
        prop_assert_eq!(&taker.whole[before..], &[5]);
    }
}

#[test]
fn words_that_are_late_at_the_end_of_a_line_lose_nothing() {
    for (words, looks, told) in
        KINDS.into_iter().flat_map(|told| [(1, 1, told), (3, 20, told), (ROW - 1, LOOKS - 1, told)])
    {
        let (mut model, mut port, _) = started(told);
        for _ in 0..3 {
            let mut events = Vec::new();
            model.start_frame();
            for line in 0..LINES {
                model.send(4 * ROW, line as u8);
                model.delay(words, looks);
                model.end_line();
                model.serve(&mut port);
                events.append(&mut model.events);
            }
            model.end_frame();
            model.serve(&mut port);
            events.append(&mut model.events);
            let rows = events.iter().filter(|event| matches!(event, PortEvent::Row { .. })).count();
            assert_eq!(
                (rows, events.len()),
                (LINES, LINES + 2),
                "{words} words late by {looks} looks, {told:?}: {events:?}"
            );
        }
    }
}

#[test]
fn words_that_never_come_lose_the_rest_of_the_frame_only() {
    let (mut model, mut port, _) = started(Told::ByCounter);
    model.start_frame();
    model.send(4 * ROW - 4, 0);
    model.end_line();
    model.serve(&mut port);
    model.send(4 * ROW, 1);
    model.end_line();
    model.serve(&mut port);
    model.end_frame();
    model.serve(&mut port);
    assert!(matches!(model.events[..], [PortEvent::Start, PortEvent::Lost, PortEvent::Lost, PortEvent::End]));
}
