//! What the rings between the tasks hold.

use core::cell::Cell;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::zerocopy_channel::{Receiver, Sender};
use haarline::framing::Place;
use haarline::packet::{FrameEnd, MAX_CELL_ROWS};
use haarline::{Counters, Disparity};

/// Most columns of a view.
pub const MAX_WIDTH: usize = 320;
/// Most bytes of a raw row, both views of it.
pub const MAX_RAW: usize = 2 * MAX_WIDTH;
/// Raw rows between capture and vision, unless the board says otherwise: so many, and memory does not grow with the height.
pub const RAW_ROWS: usize = 32;
/// Rows of a slot of disparity rows: as many as the largest row of cells has.
pub const SLOT_ROWS: usize = MAX_CELL_ROWS as usize;
/// Slots of disparity rows between vision and results: more than come at once at the end of a frame, the 40 included that may wait
/// to be rectified.
pub const RESULT_SLOTS: usize = 16;

/// The sending end of a ring.
pub type To<T> = Sender<'static, CriticalSectionRawMutex, T>;
/// The receiving end of a ring.
pub type From<T> = Receiver<'static, CriticalSectionRawMutex, T>;

/// What capture tells vision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RawKind {
    /// The raw bytes of a row.
    Row,
    /// A row that is missing.
    Missing,
    /// The frame has ended.
    Close,
    /// There will be no more.
    Over,
}

/// A raw row, or what stands in its place.
#[repr(C, align(8))]
pub struct RawRow {
    /// The camera's bytes. They come first, at a word: so they are written and read by words.
    pub bytes: [u8; MAX_RAW],
    /// Which it is.
    pub kind: RawKind,
    /// Where it belongs.
    pub place: Place,
    /// When its frame began, us after the start.
    pub begun_us: u64,
    /// Bytes of it that count.
    pub len: usize,
}

impl RawRow {
    /// Nothing yet: all bits zero, so that a ring of it takes no flash.
    pub const EMPTY: Self =
        Self { kind: RawKind::Row, place: Place { frame: 0, row: 0 }, begun_us: 0, len: 0, bytes: [0; MAX_RAW] };
}

/// What vision tells results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResultKind {
    /// Disparity rows.
    Rows,
    /// The frame has ended.
    End,
    /// There will be no more.
    Over,
}

/// Some disparity rows on their way out, one below the other, or what stands in their place.
#[repr(C, align(4))]
pub struct ResultRows {
    /// Disparity of each pixel. These two come first, at words: so they are copied by words.
    pub disparity: [[Disparity; MAX_WIDTH]; SLOT_ROWS],
    /// Confidence of each pixel.
    pub confidence: [[u8; MAX_WIDTH]; SLOT_ROWS],
    /// Which it is.
    pub kind: ResultKind,
    /// Where the first row belongs.
    pub place: Place,
    /// Rows that count, at most [`SLOT_ROWS`].
    pub count: usize,
    /// How many of them go into a packet together.
    pub together: usize,
    /// Columns that count.
    pub width: usize,
    /// What had happened when it was made.
    pub counters: Counters,
    /// Of an end: what became of the frame.
    pub end: FrameEnd,
}

impl ResultRows {
    /// Nothing yet: all bits zero, so that a ring of it takes no flash.
    pub const EMPTY: Self = Self {
        kind: ResultKind::Rows,
        place: Place { frame: 0, row: 0 },
        count: 0,
        together: 0,
        width: 0,
        disparity: [[Disparity::from_bits(0); MAX_WIDTH]; SLOT_ROWS],
        confidence: [[0; MAX_WIDTH]; SLOT_ROWS],
        counters: Counters::ZERO,
        end: FrameEnd::NONE,
    };
}

/// What all tasks see: the counters, and what became of the last frame.
pub struct SharedCounters(
    Mutex<CriticalSectionRawMutex, Cell<Counters>>,
    Mutex<CriticalSectionRawMutex, Cell<FrameEnd>>,
);

impl SharedCounters {
    /// All at zero.
    #[must_use]
    pub const fn new() -> Self {
        Self(Mutex::new(Cell::new(Counters::ZERO)), Mutex::new(Cell::new(FrameEnd::NONE)))
    }

    /// What they say now.
    #[must_use]
    pub fn get(&self) -> Counters {
        self.0.lock(Cell::get)
    }

    /// What became of the last frame.
    #[must_use]
    pub fn last_frame(&self) -> FrameEnd {
        self.1.lock(Cell::get)
    }

    /// A frame ended.
    pub fn end_frame(&self, end: FrameEnd) {
        self.1.lock(|cell| cell.set(end));
    }

    /// What happened to the camera's frames; delivered rows are counted here.
    pub fn update(&self, camera: &Counters) {
        self.0.lock(|cell| cell.set(Counters { rows: cell.get().rows, ..*camera }));
    }

    /// The method delivered a row.
    pub fn count_row(&self) {
        self.0.lock(|cell| {
            let counters = cell.get();
            cell.set(Counters { rows: counters.rows.saturating_add(1), ..counters });
        });
    }
}

impl Default for SharedCounters {
    fn default() -> Self {
        Self::new()
    }
}
