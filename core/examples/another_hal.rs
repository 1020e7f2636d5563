//! The core behind any HAL: from the bytes of camera lines to obstacles. `Eyes` is what to copy into a firmware; it
//! needs neither heap nor `std`. `main` only plays a camera, and what may happen to it:
//!
//! `cargo run -p haarline --example another_hal`

use haarline::framing::{CameraEvent, Framing, Step};
use haarline::obstacle::{Mounting, Obstacles, Sectors, Settings};
use haarline::wiring::{First, Kind};
use haarline::{
    Config, Counters, DisparityRow, Full, Offset, Paired, Rig, ScanlinePair, StereoMethod, Wiring, blocks_for,
};

const WIDTH: u16 = 160;
const HEIGHT: u16 = 120;
const BLOCKS: usize = blocks_for(WIDTH);
const CONFIG: Config = Config { width: WIDTH, min_disparity: 0, num_disparities: 16 };
/// Two sensors by turns on one bus. Of `Kind::LineInterleaved` hand a row over when it has both its lines.
const WIRING: Wiring = Wiring::new(Kind::PixelInterleaved, First::Left);
/// Bytes for the DMA to fetch per row.
const RAW: usize = WIRING.row_bytes(WIDTH);
/// No two cameras are mounted to the pixel.
const OFFSET: Offset = Offset { rows: 2, columns: 0 };
/// Three of 20 degrees: tangents of their borders, 1 / cosine of their middles. The package `haarline-rig` computes
/// them, and all else up here, from a description of the rig.
const SECTORS: Sectors<3> =
    Sectors { count: 3, left_q16: [-37837, -11556, 11556], right_q16: 37837, secant_q14: [17436, 16384, 17436] };
const LEVEL: Mounting =
    Mounting { height_mm: 300, sin_pitch_q14: 0, cos_pitch_q14: 1 << 14, lowest_mm: 50, highest_mm: 600 };

/// A method behind cameras of that offset.
type Method<M> = Paired<M, { OFFSET.waiting_rows() }, { WIDTH as usize }>;

/// What was in the way in a frame.
struct Sighting {
    frame: u32,
    /// Rows that came: what lies below them nobody saw.
    rows: u32,
    /// From the left; `None` is unknown, which is not free.
    nearest_mm: [Option<u32>; SECTORS.count],
}

/// Takes what the HAL tells. On a chip it belongs into a static: with `Full` it has 13 KB at this width.
struct Eyes<M> {
    framing: Framing,
    method: Method<M>,
    taker: Taker,
    /// The frame of which rows are in the method.
    open: Option<u32>,
}

/// Takes disparity rows: here goes whoever else wants them, a serial port or a display.
struct Taker {
    obstacles: Obstacles<{ SECTORS.count }, BLOCKS>,
    rows: u32,
    rows_of_frame: u32,
}

impl Taker {
    fn row(&mut self, row: &DisparityRow<'_>) {
        self.rows = self.rows.saturating_add(1);
        self.rows_of_frame = row.y + 1;
        self.obstacles.push(row);
    }
}

impl<M: StereoMethod> Eyes<M> {
    fn new(method: Method<M>, obstacles: Obstacles<{ SECTORS.count }, BLOCKS>) -> Self {
        let taker = Taker { obstacles, rows: 0, rows_of_frame: 0 };
        Self { framing: Framing::new(HEIGHT.into()), method, taker, open: None }
    }

    /// The bytes of a row have come.
    fn row(&mut self, raw: &[u8]) -> Option<Sighting> {
        // Which pixels a row of another length lacks nobody knows: it counts as lost.
        self.take(CameraEvent::Row { is_whole: raw.len() == RAW }, raw)
    }

    /// Anything else: a frame's start or end, a lost row, an overrun, a failure of DMA. A HAL without a signal for the
    /// end of a frame need not tell it, and one that sees no row for too long tells `Silence`.
    fn event(&mut self, event: CameraEvent) -> Option<Sighting> {
        self.take(event, &[])
    }

    fn take(&mut self, event: CameraEvent, raw: &[u8]) -> Option<Sighting> {
        // The work is done at once, so there is always room. A method takes much longer for one row in four than a row
        // lasts: with a live camera a ring of raw rows belongs between. `step` then stands before the ring, and is told
        // whether it has a free slot.
        let place = match self.framing.step(event, true) {
            Step::Skip => return None,
            Step::Close { .. } => return self.end(),
            Step::Take(place) | Step::Miss(place) => place,
        };
        // Where the end of a frame was not told, the next one's first row tells it.
        let seen = if self.open.is_some_and(|open| open != place.frame) { self.end() } else { None };
        self.open = Some(place.frame);
        let Self { method, taker, .. } = self;
        let mut sink = |row: DisparityRow<'_>| taker.row(&row);
        let (mut left, mut right) = ([0; WIDTH as usize], [0; WIDTH as usize]);
        // A missed row has not the bytes to be unpacked; the method is told, so that those below keep their places.
        match WIRING.pair(raw, &mut left, &mut right) {
            Ok(pair) if method.push(pair, &mut sink).is_ok() => {}
            _ => method.miss(&mut sink),
        }
        seen
    }

    fn end(&mut self) -> Option<Sighting> {
        let frame = self.open.take()?;
        let Self { method, taker, .. } = self;
        // The method still has the last rows: they waited for those below them.
        method.finish(&mut |row| taker.row(&row));
        let mut nearest_mm = [None; SECTORS.count];
        for (to, mm) in nearest_mm.iter_mut().zip(taker.obstacles.nearest_mm()) {
            *to = mm;
        }
        Some(Sighting { frame, rows: taker.rows_of_frame, nearest_mm })
    }

    fn counters(&self) -> Counters {
        Counters { rows: self.taker.rows, ..*self.framing.counters() }
    }
}

/// A camera's row: a wall at 1.5 m (4 px), before it low down a box at 0.6 m. The right view lies two rows lower.
fn camera(y: u32) -> [u8; RAW] {
    let texture = |x: u32, y: u32| {
        let place = (x / 2).wrapping_mul(0x9E37_79B1) ^ (y / 2).wrapping_mul(0x85EB_CA77);
        ((place ^ place >> 15).wrapping_mul(0x2C1B_3C6D) >> 24).to_le_bytes()[0]
    };
    let is_box = |x: u32, y: u32| (64..96).contains(&x) && (72..112).contains(&y);
    let (mut left, mut right) = ([0; WIDTH as usize], [0; WIDTH as usize]);
    for (x, (left, right)) in (0..).zip(left.iter_mut().zip(&mut right)) {
        let above = y.saturating_sub(2);
        *left = texture(if is_box(x, y) { x + 1000 } else { x }, y);
        *right = texture(if is_box(x + 10, above) { x + 10 + 1000 } else { x + 4 }, above);
    }
    let mut raw = [0; RAW];
    let _ = WIRING.pack(ScanlinePair { left: &left, right: &right }, &mut raw); // all of the lengths that it needs
    raw
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rig = Rig::new(100 << 8, 60_000).ok_or("100 px of focal length and 60 mm are positive")?;
    let obstacles = Obstacles::new([WIDTH, HEIGHT], rig, LEVEL, SECTORS, Settings::DEFAULT)?;
    let mut eyes = Eyes::new(Paired::new(Full::<BLOCKS>::new(CONFIG)?, OFFSET)?, obstacles);
    let told = |mm: Option<u32>| mm.map_or("unknown".to_owned(), |mm| format!("{mm} mm"));
    for (lost, height) in [(None, 120), (Some(90), 120), (None, 70), (None, 120)] {
        eyes.event(CameraEvent::Start);
        for y in 0..height {
            let _ = if lost == Some(y) { eyes.event(CameraEvent::Lost) } else { eyes.row(&camera(y)) };
        }
        if let Some(Sighting { frame, rows, nearest_mm }) = eyes.event(CameraEvent::End) {
            println!("frame {frame}, {rows:3} rows: {}", nearest_mm.map(told).join(", "));
        }
    }
    let Counters { frames, rows, dropped_rows, short, .. } = eyes.counters();
    println!("{frames} frames, {short} of them short; {rows} rows, {dropped_rows} of them lost");
    Ok(())
}
