//! What a request asks for.

use cortex_m::peripheral::DWT;
use haarline::{DisparityRow, ScanlinePair, Stage, StageClock, StereoMethod};
use haarline_firmware::app::edge::{Work as Worked, WorkClock};
use haarline_firmware::app::statistics::StageTotals;
use haarline_firmware::board::CHIP;
use haarline_firmware::board::cycles::CycleClock;
use haarline_firmware::board::this::{clock, start};
use haarline_firmware::stack;
use haarline_link::MOST;
use haarline_link::message::{Answer, Figures, KEPT, Method, Request, STAGES, VERSION, WIDTH, read, write};

const _: () = assert!(STAGES == Stage::COUNT);

/// A row that waits to be taken.
pub struct Row {
    y: u32,
    len: usize,
    disparity: [u8; 2 * WIDTH],
    confidence: [u8; WIDTH],
}

impl Row {
    /// Nothing yet.
    pub const EMPTY: Self = Self { y: 0, len: 0, disparity: [0; 2 * WIDTH], confidence: [0; WIDTH] };

    fn keep(&mut self, row: &DisparityRow<'_>) {
        (self.y, self.len) = (row.y, row.disparity.len().min(WIDTH));
        for (to, from) in self.disparity.as_chunks_mut::<2>().0.iter_mut().zip(row.disparity) {
            *to = from.into_bits().to_le_bytes();
        }
        self.confidence.iter_mut().zip(row.confidence).for_each(|(to, from)| *to = *from);
    }
}

/// A frame that is to begin.
#[derive(Clone, Copy)]
pub struct Begin {
    /// The method.
    pub method: Method,
    /// Columns of a view.
    pub width: u16,
    /// Least disparity.
    pub min_disparity: i16,
}

/// What is done to a frame.
pub struct Work {
    rows: &'static mut [Row; KEPT],
    clock: &'static CycleClock,
    width: usize,
    delivered: u32,
    worst: u32,
    before: [u64; STAGES],
    state: usize,
    /// The frame that was asked for.
    pub next: Option<Begin>,
}

impl Work {
    pub fn new(rows: &'static mut [Row; KEPT], clock: &'static CycleClock) -> Self {
        Self { rows, clock, width: 0, delivered: 0, worst: 0, before: [0; STAGES], state: 0, next: None }
    }

    /// A frame of a method with that much state begins.
    pub fn begin(&mut self, width: usize, state: usize) {
        (self.width, self.state, self.delivered, self.worst) = (width, state, 0, 0);
        self.before = Stage::ALL.map(|stage| self.clock.of(stage));
        stack::paint();
    }

    /// Does what is asked for; the answer's length.
    pub fn execute(&mut self, request: &[u8], method: Option<&mut dyn StereoMethod>, answer: &mut [u8; MOST]) -> usize {
        let answered = match (read::<Request<'_>>(request), method) {
            (None, _) => Answer::Refused("a request that this version does not know"),
            (Some(Request::Hello), _) => {
                let revision = start::revision();
                Answer::Hello {
                    version: VERSION,
                    chip: CHIP,
                    revision: revision.name(),
                    mhz: u16::try_from(clock::core_hz(revision) / 1_000_000).unwrap_or(0),
                    compiler: env!("HAARLINE_COMPILER"),
                }
            }
            (Some(Request::Begin { method, width, min_disparity }), _) => {
                if usize::from(width) > WIDTH {
                    Answer::Refused("views have 320 px at most")
                } else {
                    self.next = Some(Begin { method, width, min_disparity });
                    Answer::Done(0)
                }
            }
            (Some(_), None) => Answer::Refused("no frame was begun, or its method refuses it"),
            (Some(Request::Push(pixels)), Some(method)) => self.push(pixels, method),
            (Some(Request::Finish), Some(method)) => self.finish(method),
            (Some(Request::Take(nth)), Some(_)) => self.row(nth),
            (Some(Request::Figures), Some(_)) => Answer::Figures(self.figures()),
        };
        write(&answered, answer).unwrap_or(0)
    }

    fn push(&mut self, pixels: &[u8], method: &mut dyn StereoMethod) -> Answer<'static> {
        let (left, right) = pixels.split_at(pixels.len() / 2);
        if left.len() != self.width || right.len() != self.width {
            return Answer::Refused("a row of another width");
        }
        let begun = DWT::cycle_count();
        let pair = ScanlinePair { left, right };
        let Self { rows, delivered, clock, .. } = self;
        let pushed = method.push(pair, &mut |row| deliver(rows, delivered, clock, &row));
        self.clock.rest(Worked::Row);
        self.worst = self.worst.max(DWT::cycle_count().wrapping_sub(begun));
        if pushed.is_err() { Answer::Refused("the method refuses the row") } else { Answer::Done(self.delivered) }
    }

    fn finish(&mut self, method: &mut dyn StereoMethod) -> Answer<'static> {
        let Self { rows, delivered, clock, .. } = self;
        method.finish(&mut |row| deliver(rows, delivered, clock, &row));
        self.clock.rest(Worked::FrameEnd);
        Answer::Done(self.delivered)
    }

    fn row(&self, nth: u32) -> Answer<'_> {
        let age = self.delivered.checked_sub(nth).and_then(|age| usize::try_from(age).ok());
        match (age, self.rows.get(place(nth))) {
            (Some(1..=KEPT), Some(Row { y, len, disparity, confidence })) => Answer::Row {
                y: *y,
                disparity: disparity.get(..2 * len).unwrap_or(&[]),
                confidence: confidence.get(..*len).unwrap_or(&[]),
            },
            _ => Answer::Refused("there is no such row any more, or not yet"),
        }
    }

    fn figures(&self) -> Figures {
        let mut stages = Stage::ALL.map(|stage| self.clock.of(stage));
        stages.iter_mut().zip(self.before).for_each(|(now, before)| *now -= before);
        let [state, stack] = [self.state, stack::high_water()].map(|bytes| u32::try_from(bytes).unwrap_or(u32::MAX));
        Figures { stages, worst: self.worst, state, stack }
    }
}

fn place(nth: u32) -> usize {
    usize::try_from(nth).unwrap_or(0) % KEPT
}

/// Keeps a row, which is no stage's work but the sink's.
fn deliver(rows: &mut [Row; KEPT], delivered: &mut u32, clock: &CycleClock, row: &DisparityRow<'_>) {
    clock.enter(Stage::Output);
    if let Some(kept) = rows.get_mut(place(*delivered)) {
        kept.keep(row);
    }
    *delivered += 1;
}
