//! The passes over frames, from a wide search at half the size to a fit at the full one.

use super::agreement::Agreement;
use super::blocks::{BlockRow, Comparison, LeftRing, MAX_REACH, RightRing, SIDE};
use super::cells::Cells;
use super::estimate::Estimate;
use super::gradient::{BESIDE, Gradients};
use super::line::Line;
use super::order::Disparities;
use super::places::{PARTS, Places};
use crate::front_end::noise::RawNoise;
use crate::{Config, ConfigError, Ramp, Rectification, RectifiedRow, Rectifier, RowError, ScanlinePair};

/// What a pass looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Pass {
    /// Whether at half the size.
    is_half: bool,
    /// Row offsets on each side.
    reach: usize,
    /// What the pass adds up.
    kind: Kind,
    /// Offset at which a block counts half, 1/256 px.
    scale_q8: i64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Costs by place, and the extremum search over them.
    Cells,
    /// The blocks' offsets, and the disparities that there are.
    Disparities,
    /// The blocks' offsets.
    Line,
}

/// The passes. Each looks about what the one before found.
const PASSES: [Pass; 6] = [
    Pass { is_half: true, reach: MAX_REACH, kind: Kind::Cells, scale_q8: 512 },
    Pass { is_half: true, reach: 3, kind: Kind::Disparities, scale_q8: 768 },
    Pass { is_half: false, reach: 3, kind: Kind::Line, scale_q8: 256 },
    Pass { is_half: false, reach: 1, kind: Kind::Line, scale_q8: 128 },
    Pass { is_half: false, reach: 1, kind: Kind::Line, scale_q8: 96 },
    Pass { is_half: false, reach: 3, kind: Kind::Line, scale_q8: 96 },
];

/// Noise is measured on every so manyth row, and on every so manyth column of it.
const NOISE_ROWS: u32 = 4;
const NOISE_COLUMNS: usize = 7;

/// What an alignment compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Columns and rows of a view, px.
    pub size: [u16; 2],
    /// Greatest magnitude of a disparity, px: three eighths of the width by default.
    pub max_disparity: u16,
}

impl Settings {
    /// For views of that size.
    #[must_use]
    pub const fn new(size: [u16; 2]) -> Self {
        Self { size, max_disparity: size[0] / 8 * 3 }
    }
}

/// Aligns the two views of a rig.
///
/// Six passes, each over one frame or more: for every frame push its rows and [`end_frame`](Self::end_frame), after
/// the frames of a pass [`end_pass`](Self::end_pass). Passes may see the same frames or later ones. After the last
/// one the [`Estimate`] holds.
///
/// `ROWS` is the capacity of the ring in which the right view's rows are brought together with the left one's, 64 for
/// every ramp; `WIDTH` the greatest width. It holds about `WIDTH * (ROWS + 110)` bytes.
#[derive(Debug, Clone)]
pub struct Aligner<const ROWS: usize, const WIDTH: usize> {
    rectifier: Rectifier<ROWS, WIDTH>,
    /// Of the rows as they came.
    noise: RawNoise,
    bench: Bench<WIDTH>,
}

/// Everything behind the rectifier.
#[derive(Debug, Clone)]
struct Bench<const WIDTH: usize> {
    settings: Settings,
    pass: usize,
    estimate: Estimate,
    comparison: Comparison,
    /// The even rows of a pair of rows that become one of half the size, left and right.
    even: [[u8; WIDTH]; 2],
    has_even: bool,
    gradients: [Gradients<WIDTH>; 2],
    left: LeftRing<WIDTH>,
    right: RightRing<WIDTH>,
    blocks: BlockRow<WIDTH>,
    /// Rows of the pass's size that came in this frame, and the last of them that was lost.
    came: u32,
    lost: Option<u32>,
    /// Rows of gradients that are there, and rows of blocks compared.
    ready: u32,
    compared: u32,
    cells: Cells,
    line: Line,
    disparities: Disparities,
    places: Places,
    agreement: Agreement,
    /// Costs of every row offset, all blocks together.
    totals: [u64; 2 * MAX_REACH + 1],
    frames: u32,
}

impl<const ROWS: usize, const WIDTH: usize> Aligner<ROWS, WIDTH> {
    /// Frames are looked at so many times.
    pub const PASSES: usize = PASSES.len();

    /// An alignment of views as `settings` say.
    ///
    /// # Errors
    /// If the width is over the capacity or out of its range.
    pub fn new(settings: Settings) -> Result<Self, ConfigError> {
        if !(Config::MIN_WIDTH..=Config::MAX_WIDTH).contains(&settings.size[0]) {
            return Err(ConfigError::Width);
        }
        let rectifier = Rectifier::new(settings.size, Rectification::default())?;
        let mut aligner = Self { rectifier, noise: RawNoise::new(), bench: Bench::new(settings) };
        aligner.bench.start_pass();
        Ok(aligner)
    }

    /// Which pass is under way, from 0; [`Self::PASSES`] once all are done.
    #[must_use]
    pub const fn pass(&self) -> usize {
        self.bench.pass
    }

    /// Takes the next rows of a frame.
    ///
    /// # Errors
    /// If they have another width than configured.
    pub fn push(&mut self, pair: ScanlinePair<'_>) -> Result<(), RowError> {
        let Self { rectifier, noise, bench } = self;
        if rectifier.came().is_multiple_of(NOISE_ROWS)
            && let Some(rows) = rectifier.newest_three()
        {
            noise.sample(rows, rectifier.came() as usize % NOISE_COLUMNS, NOISE_COLUMNS, 1);
        }
        rectifier.push(pair, &mut |row| bench.take(&row))
    }

    /// The next rows of the frame were lost.
    pub fn miss(&mut self) {
        let bench = &mut self.bench;
        self.rectifier.miss(&mut |row| bench.take(&row));
    }

    /// Ends a frame.
    pub fn end_frame(&mut self) {
        let bench = &mut self.bench;
        self.rectifier.finish(&mut |row| bench.take(&row));
        bench.end_frame();
    }

    /// Ends a pass: what its frames showed is where the next one looks.
    pub fn end_pass(&mut self) {
        self.bench.end_pass();
        let [left, right] = self.noise.deviations_q4();
        self.bench.estimate.noise_q4 = (left * left + right * right).isqrt();
        let ramp = self.bench.estimate.ramp;
        match Rectifier::new(self.bench.settings.size, ramp.into()) {
            Ok(rectifier) => self.rectifier = rectifier,
            // Such an estimate is out of range, whatever the passes to come find.
            Err(_) => self.bench.pass = PASSES.len(),
        }
    }

    /// What was found so far; holds after the last pass.
    #[must_use]
    pub const fn estimate(&self) -> &Estimate {
        &self.bench.estimate
    }

    /// Parts of the view across and down of which [`rows_q16`](Self::rows_q16) tells.
    pub const PARTS: [usize; 2] = PARTS;

    /// How far the right view lies lower in a part of it, from the left and from the top, 1/65536 px: what blocks there
    /// say, without the ramp through all of them. `None` where too little was seen; holds after the last pass.
    #[must_use]
    pub fn rows_q16(&self, part: [usize; 2]) -> Option<i32> {
        self.bench.places.rows_q16(part)
    }
}

impl<const WIDTH: usize> Bench<WIDTH> {
    fn new(settings: Settings) -> Self {
        Self {
            settings,
            pass: 0,
            estimate: Estimate {
                ramp: Ramp::default(),
                errors_q16: [u32::MAX; 3],
                contrast_percent: 0,
                agreement_percent: 0,
                spread_q16: 0,
                noise_q4: 0,
                blocks: 0,
                frames: 0,
                evaluations: 0,
                width: settings.size[0],
                disparities: [0; 2],
                median_disparity: 0,
                ground_percent: 0,
            },
            comparison: Comparison { size: [0; 2], reach: 0, disparities: [0; 2] },
            even: [[0; WIDTH]; 2],
            has_even: false,
            gradients: [Gradients::new(), Gradients::new()],
            left: LeftRing::new(),
            right: RightRing::new(),
            blocks: BlockRow::new(),
            came: 0,
            lost: None,
            ready: 0,
            compared: 0,
            cells: Cells::new(),
            line: Line::default(),
            disparities: Disparities::new(),
            places: Places::new(),
            agreement: Agreement::default(),
            totals: [0; 2 * MAX_REACH + 1],
            frames: 0,
        }
    }

    fn kind(&self) -> Option<&'static Pass> {
        PASSES.get(self.pass)
    }

    fn start_pass(&mut self) {
        let Some(&Pass { is_half, reach, kind, .. }) = self.kind() else { return };
        let size = self.settings.size.map(|px| usize::from(px) / if is_half { 2 } else { 1 });
        let most = i32::from(self.settings.max_disparity);
        let disparities = match kind {
            Kind::Cells | Kind::Disparities => [-most / 2, most / 2],
            Kind::Line => self.estimate.disparities.map(i32::from),
        };
        self.comparison = Comparison { size, reach, disparities };
        self.left.start(size[0], SIDE + 2 * reach);
        self.right.start(size[0], SIDE + reach);
        self.cells.clear();
        self.line = Line::default();
        self.disparities.clear();
        self.places.clear();
        self.agreement = Agreement::default();
        self.totals.fill(0);
        self.frames = 0;
        self.start_frame();
    }

    fn start_frame(&mut self) {
        (self.came, self.lost, self.ready, self.compared, self.has_even) = (0, None, 0, 0, false);
        self.gradients.iter_mut().for_each(|view| view.start(self.comparison.size[0]));
    }

    /// Takes a row of the full size.
    fn take(&mut self, row: &RectifiedRow<'_>) {
        let Some(pass) = self.kind() else { return };
        if !pass.is_half {
            self.advance(row.pair);
        } else if row.y.is_multiple_of(2) {
            self.has_even = row.pair.is_some();
            let Some(pair) = row.pair else { return };
            for (even, view) in self.even.iter_mut().zip([pair.left, pair.right]) {
                even.iter_mut().zip(view).for_each(|(even, &pixel)| *even = pixel);
            }
        } else {
            let mut even = self.even;
            let pair = row.pair.filter(|_| self.has_even).map(|pair| {
                let [left, right] = &mut even;
                ScanlinePair { left: halve(left, pair.left), right: halve(right, pair.right) }
            });
            self.advance(pair);
        }
    }

    /// Takes a row of the pass's size.
    fn advance(&mut self, pair: Option<ScanlinePair<'_>>) {
        if self.came as usize >= self.comparison.size[1] {
            return;
        }
        if pair.is_none() {
            self.lost = Some(self.came);
        }
        let [left, right] = &mut self.gradients;
        left.push(pair.map(|pair| pair.left));
        right.push(pair.map(|pair| pair.right));
        self.came += 1;
        if self.came > BESIDE {
            self.make_gradients();
        }
    }

    /// The next row of gradients, and the blocks that it completes.
    fn make_gradients(&mut self) {
        let [across, down] = self.left.row_mut(self.ready);
        self.gradients[0].row(self.ready, across, down);
        let [across, down] = self.right.row_mut(self.ready);
        self.gradients[1].row(self.ready, across, down);
        self.ready += 1;
        let rows = self.comparison.size[1];
        let top = self.compared as usize * SIDE;
        let last = (top + SIDE + self.comparison.reach).min(rows);
        if top + SIDE <= rows && self.ready as usize >= last {
            self.compare(u32::try_from(top).unwrap_or(0));
            self.compared += 1;
        }
    }

    fn end_frame(&mut self) {
        while self.ready < self.came {
            self.make_gradients();
        }
        // The last rows of blocks may become complete with the same row.
        while (self.compared as usize + 1) * SIDE <= self.came as usize {
            self.compare(u32::try_from(self.compared as usize * SIDE).unwrap_or(0));
            self.compared += 1;
        }
        self.frames += 1;
        self.agreement.end_frame();
        self.start_frame();
    }

    /// Compares the row of blocks from `top` on, unless a row that they need was lost.
    fn compare(&mut self, top: u32) {
        let Some(&pass) = self.kind() else { return };
        let needed = top.saturating_sub(BESIDE + u32::try_from(pass.reach).unwrap_or(0));
        if self.lost.is_some_and(|lost| lost >= needed) {
            return;
        }
        self.blocks.compare(&self.comparison, &self.left, &self.right, top);
        for block in 0..self.comparison.size[0] / SIDE {
            let twice = self.place(&pass, block, top);
            if !self.is_in_view(&pass, twice) {
                continue;
            }
            let Some(profile) = self.blocks.profile(block) else { continue };
            self.totals.iter_mut().zip(profile).for_each(|(total, &sum)| *total += u64::from(sum));
            if pass.kind == Kind::Cells {
                self.cells.add(twice, self.settings.size, profile);
                continue;
            }
            let Some((offset, minimum)) = refine(profile) else {
                self.agreement.add_beyond(end_weight(profile));
                continue;
            };
            let in_px = if pass.is_half { 2 * minimum.q8 } else { minimum.q8 };
            let scale = pass.scale_q8 * pass.scale_q8;
            let near = scale * i64::from(minimum.weight) / (scale + i64::from(in_px) * i64::from(in_px));
            let weight = u32::try_from(near).unwrap_or(0);
            self.agreement.add(self.settings.size[0], in_px, minimum.weight, weight);
            self.line.add(twice, in_px, weight);
            // A block tells of the left view's rows.
            let rows_q16 = self.estimate.ramp.displacement_q16(twice) - 256 * in_px;
            self.places.add(twice, self.settings.size, (rows_q16, in_px), weight);
            if pass.kind == Kind::Disparities {
                let roll = self.estimate.ramp.roll_q16;
                self.disparities.add(self.blocks.disparity(block, offset), twice[1], roll, weight);
            }
        }
    }

    /// Twice the distance of a block's middle from that of the view, px at the full size.
    fn place(&self, pass: &Pass, block: usize, top: u32) -> [i32; 2] {
        let twice = |at: usize, size: u16| {
            // Its middle is 3.5 px from its first pixel, whose own middle is 0.5 px further in at half the size.
            let at = i32::try_from(at).unwrap_or(0);
            let middle = if pass.is_half { 4 * at + 15 } else { 2 * at + 7 };
            middle + 1 - i32::from(size)
        };
        [twice(block * SIDE, self.settings.size[0]), twice(top as usize, self.settings.size[1])]
    }

    /// Whether the right view has all rows of a block.
    fn is_in_view(&self, pass: &Pass, twice: [i32; 2]) -> bool {
        let ramp = &self.estimate.ramp;
        let half = if pass.is_half { 8 } else { 4 };
        let beside = (ramp.roll_q16.abs() + ramp.scale_q16.abs() + (1 << 16)) * half;
        let rows = i32::from(self.settings.size[1]);
        let at = ((twice[1] + rows - 1) << 15) + ramp.displacement_q16(twice);
        at - beside >= -(1 << 16) && at + beside <= rows << 16
    }

    fn end_pass(&mut self) {
        let Some(&pass) = self.kind() else { return };
        match pass.kind {
            Kind::Cells => {
                if let Some(coarse) = self.cells.search() {
                    // Profiles tell of the left view's rows, half as many.
                    self.estimate.ramp.rows_q16 -= 2 * coarse.rows_q16;
                    self.estimate.ramp.roll_q16 -= coarse.roll_q16;
                    self.estimate.evaluations = coarse.evaluations;
                }
            }
            Kind::Disparities | Kind::Line => {
                if let Some(plane) = self.line.solve(self.settings.size) {
                    // What blocks of one part have in common is the lens's: in the end the parts count.
                    let is_last = self.pass + 1 == PASSES.len();
                    let by_parts = if is_last { self.places.solve(self.settings.size) } else { None };
                    let [rows, roll, scale] = by_parts.unwrap_or(plane).q16;
                    let ramp = &mut self.estimate.ramp;
                    ramp.rows_q16 -= rows;
                    ramp.roll_q16 -= roll;
                    ramp.scale_q16 -= scale;
                    self.estimate.errors_q16 = plane.errors_q16;
                }
                self.estimate.blocks = self.line.blocks;
            }
        }
        if pass.kind == Kind::Disparities {
            self.note_disparities();
        }
        self.estimate.frames = self.frames;
        self.estimate.agreement_percent = self.agreement.percent();
        self.estimate.spread_q16 = self.agreement.spread_q16();
        self.estimate.contrast_percent = contrast_percent(self.totals.get(..2 * pass.reach + 1).unwrap_or(&[]));
        self.pass += 1;
        self.start_pass();
    }

    fn note_disparities(&mut self) {
        let margin = 4;
        let most = i32::from(self.settings.max_disparity);
        let [least, greatest] = self.disparities.between(10).unwrap_or([0; 2]);
        let narrow = |px: i32| i16::try_from(px.clamp(-most, most)).unwrap_or(0);
        self.estimate.disparities = [narrow(2 * least - margin), narrow(2 * greatest + margin)];
        let [_, median] = self.disparities.between(499).unwrap_or([0; 2]);
        self.estimate.median_disparity = narrow(2 * median);
        self.estimate.ground_percent = self.disparities.ground_percent();
    }
}

/// A row of half the size, of an even one, in whose place it comes, and the next.
fn halve<'a>(even: &'a mut [u8], odd: &[u8]) -> &'a [u8] {
    let half = odd.len() / 2;
    for x in 0..half {
        let at = |row: &[u8]| u16::from(row[2 * x]) + u16::from(row[2 * x + 1]);
        let sum = at(even) + at(odd) + 2;
        even[x] = (sum >> 2).to_le_bytes()[0];
    }
    &even[..half]
}

/// Precision of a block's offset at which it counts half of what it could.
const SATURATION: i32 = 256;

/// A block's offset.
struct Minimum {
    /// 1/256 row of the pass.
    q8: i32,
    /// What it counts, up to 4095.
    weight: u32,
}

/// The row offset that costs least, with its fraction by a parabola, and its place in the profile; `None` at the end of
/// the profile and where nothing stands out.
fn refine(profile: &[u16]) -> Option<(usize, Minimum)> {
    let (offset, &least) = profile.iter().enumerate().min_by_key(|(_, sum)| **sum)?;
    let before = i32::from(*profile.get(offset.checked_sub(1)?)?);
    let (least, after) = (i32::from(least), i32::from(*profile.get(offset + 1)?));
    let curvature = before + after - 2 * least;
    if curvature <= 0 {
        return None;
    }
    let whole = i32::try_from(offset).ok()? - i32::try_from(profile.len() / 2).ok()?;
    let q8 = 256 * whole + (before - after) * 128 / curvature;
    Some((offset, Minimum { q8, weight: weight(curvature, least) }))
}

/// What a minimum of that cost counts, up to 4095.
fn weight(curvature: i32, least: i32) -> u32 {
    // Noise makes a variance that goes with the square of the curvature; where it is small, what lenses and the parabola
    // leave is more, which is alike for all.
    let precision = curvature * curvature / (256 + 4 * least);
    (4095 * precision / (precision + SATURATION)).unsigned_abs()
}

/// What a block would count whose least cost is the first or last of its profile, if the cost rose alike beyond; 0 elsewhere.
fn end_weight(profile: &[u16]) -> u32 {
    let of = |least: u16, beside: u16| weight(2 * (i32::from(beside) - i32::from(least)), least.into());
    match *profile {
        [first, second, ..] if profile.iter().all(|&sum| sum >= first) => of(first, second),
        [.., before, last] if profile.iter().all(|&sum| sum >= last) => of(last, before),
        _ => 0,
    }
}

/// By how much the least cost two or more offsets beside the least one exceeds it, percent.
fn contrast_percent(totals: &[u64]) -> u32 {
    let Some((at, &least)) = totals.iter().enumerate().min_by_key(|(_, total)| **total) else { return 0 };
    let beside = totals.iter().enumerate().filter(|(offset, _)| offset.abs_diff(at) >= 2).map(|(_, &total)| total);
    let excess = beside.min().map_or(0, |beside| (beside - least) * 100 / least.max(1));
    u32::try_from(excess).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests;
