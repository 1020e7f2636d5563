//! Once a second the log tells what came, what was lost and why, and what it cost.

use embassy_time::{Duration, Instant, Ticker};
use haarline::Stage;
use haarline::frame_figures::FrameFigures;

use crate::app::ring::SharedCounters;
use crate::stack;

/// A clock that adds up what the stages cost.
pub trait StageTotals {
    /// Cycles of a stage so far.
    fn of(&self, stage: Stage) -> u64;
    /// Rows and ends of frames worked on so far.
    fn rows(&self) -> u32;
}

/// Tells for ever. A stage's cycles hold those of the interrupts that came meanwhile; `slept_us` is how long nobody had
/// anything to do so far.
pub async fn statistics(clock: &impl StageTotals, counters: &SharedCounters, slept_us: fn() -> u64) -> ! {
    let mut ticker = Ticker::every(Duration::from_secs(1));
    let mut before = [0; Stage::COUNT];
    let (mut told, mut slept) = (Instant::now(), 0);
    loop {
        ticker.next().await;
        frames(counters);
        let now = Stage::ALL.map(|stage| clock.of(stage));
        let [unpack, rectify, features, contours, seeds, blocks, agreement, consistency, output, _]: [u64;
            Stage::COUNT] = core::array::from_fn(|nth| now[nth] - before[nth]);
        before = now;
        defmt::info!(
            "cycles: unpack {=u64}, rectify {=u64}, features {=u64}, contours {=u64}, seeds {=u64}, blocks {=u64}, agreement {=u64}, consistency {=u64}, output {=u64}",
            unpack,
            rectify,
            features,
            contours,
            seeds,
            blocks,
            agreement,
            consistency,
            output
        );
        let (slept_before, told_before) = (slept, told);
        (slept, told) = (slept_us(), Instant::now());
        let share = 100 * (slept - slept_before) / (told - told_before).as_micros().max(1);
        defmt::info!("asleep {=u64} percent, stack at most {=usize} B", share, stack::high_water());
    }
}

fn frames(counters: &SharedCounters) {
    let last = counters.last_frame();
    let counters = counters.get();
    defmt::info!(
        "frames {=u32}, rows {=u32}; lost rows {=u32}, late frames {=u32}, overruns {=u32}, DMA errors {=u32}, short {=u32}, long {=u32}, silences {=u32}",
        counters.frames,
        counters.rows,
        counters.dropped_rows,
        counters.dropped_frames,
        counters.overruns,
        counters.dma_errors,
        counters.short,
        counters.long,
        counters.stalled
    );
    if let Some(FrameFigures { input, mismatch, sure, row_error_q8 }) = last.figures {
        defmt::info!(
            "input {=str}, mismatch {=u16} per mille, sure {=u16} per mille; frames not sent {=u32}",
            input.name(),
            mismatch.unwrap_or(0),
            sure,
            last.unsent_frames
        );
        match row_error_q8 {
            Some(error) => defmt::info!("row error {=i16}/256 px", error),
            None => defmt::info!("row error not known: too little was sure of late"),
        }
    }
}
