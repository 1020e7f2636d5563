//! Frames through the core's alignment ([`haarline::align`]), and what a user wants to know of it.

use anyhow::{Result, ensure};
use haarline::align::{Aligner, Estimate, Order, Settings, Verdict};
use haarline::{Config, Ramp, ScanlinePair};

use crate::StereoPair;
use crate::stereo::method::on_large_stack;

/// Rows in the ring, enough for every ramp.
const ROWS: usize = 128;

/// The core's alignment with room for every frame.
type Alignment = Aligner<ROWS, { Config::MAX_WIDTH as usize }>;

/// Aligns the two views of one frame.
///
/// # Errors
/// If the core does not take views of that size.
pub fn align(pair: &StereoPair) -> Result<Estimate> {
    align_all([pair.width(), pair.height()], |see| see(pair))
}

/// Parts of the view across and down of which row offsets are told.
pub const PARTS: [usize; 2] = Alignment::PARTS;

/// A figure by part of the view, row by row.
pub type Parts = [[Option<f64>; PARTS[0]]; PARTS[1]];

/// Aligns the two views of frames of `size` px. Every pass looks at all of them: `frames` is called for each, and hands every
/// frame to what it is given, so that one frame at a time must be held.
///
/// # Errors
/// If the core does not take views of that size, a frame has another one, or `frames` gives up.
pub fn align_all(
    size: [usize; 2],
    frames: impl FnMut(&mut dyn FnMut(&StereoPair) -> Result<()>) -> Result<()>,
) -> Result<Estimate> {
    Ok(align_parts(size, frames)?.0)
}

/// The same, and the row offset by part of the view, px.
///
/// # Errors
/// As [`align_all`].
pub fn align_parts(
    size: [usize; 2],
    mut frames: impl FnMut(&mut dyn FnMut(&StereoPair) -> Result<()>) -> Result<()>,
) -> Result<(Estimate, Parts)> {
    let settings = Settings::new(size.map(|px| px as u16));
    let mut aligner = on_large_stack(|| Alignment::new(settings).map(Box::new))?;
    while aligner.pass() < Alignment::PASSES {
        frames(&mut |pair| {
            ensure!(
                [pair.width(), pair.height()] == size,
                "the views of one frame are {}x{} px, those of another {}x{} px",
                size[0],
                size[1],
                pair.width(),
                pair.height()
            );
            for y in 0..pair.height() {
                aligner.push(ScanlinePair { left: pair.left.row(y), right: pair.right.row(y) })?;
            }
            aligner.end_frame();
            Ok(())
        })?;
        aligner.end_pass();
    }
    let rows = |down: usize, across: usize| aligner.rows_q16([across, down]).map(|rows| f64::from(rows) / 65_536.0);
    let parts = std::array::from_fn(|down| std::array::from_fn(|across| rows(down, across)));
    Ok((*aligner.estimate(), parts))
}

/// Whether the row offset is known, in words.
#[must_use]
pub const fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Observable => "observable",
        Verdict::NotObservable => "not observable",
        Verdict::Contradictory => "contradictory",
        Verdict::OutOfRange => "out of range",
    }
}

/// Which view is the left one, in words.
#[must_use]
pub const fn order_name(order: Order) -> &'static str {
    match order {
        Order::AsGiven => "as given",
        Order::Swapped => "swapped",
        Order::Contradictory => "contradictory",
        Order::NotObservable => "not observable",
    }
}

/// How blocks or frames contradict each other, if they do.
#[must_use]
pub fn contradiction(estimate: &Estimate) -> Option<String> {
    let Estimate { agreement_percent, spread_q16, .. } = *estimate;
    let px = |q16: u32| f64::from(q16) / 65_536.0;
    if estimate.verdict() != Verdict::Contradictory {
        None
    } else if spread_q16 > Estimate::MOST_SPREAD_Q16 {
        Some(format!(
            "frames differ by {:.2} px in their row offset, where {:.3} px are allowed",
            px(spread_q16),
            px(Estimate::MOST_SPREAD_Q16)
        ))
    } else {
        let least = estimate.least_agreement_percent();
        Some(format!("{agreement_percent} % of what the views show agrees on a row offset, where {least} % are needed"))
    }
}

/// How many frames all passes look at together.
#[must_use]
pub const fn steps(frames: usize) -> usize {
    frames * Alignment::PASSES
}

/// A ramp in the units of a rig description.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displacement {
    /// Row offset in the middle of the right view, px.
    pub rows: f64,
    /// Roll of the right camera against the left one, degrees; positive: points to the right lie lower.
    pub roll_deg: f64,
    /// How much higher than the left view the right one is, percent.
    pub scale_percent: f64,
}

impl From<&Ramp> for Displacement {
    fn from(ramp: &Ramp) -> Self {
        let of = |q16: i32| f64::from(q16) / 65_536.0;
        let roll = of(ramp.roll_q16).atan();
        // A rolled view is sheared by rows alone: its height in a column is less by the cosine.
        let scale = (1.0 + of(ramp.scale_q16)) * roll.cos() - 1.0;
        Self { rows: of(ramp.rows_q16), roll_deg: roll.to_degrees(), scale_percent: 100.0 * scale }
    }
}
