//! What the run cost, as lines of a name and a number.

use haarline::Stage;
use haarline_firmware::stack;
use semihosting::fs::File;
use semihosting::io::{Result, Write};

use crate::chip::COUNTERS;
use crate::clock::TwinClock;
use crate::file;

/// Writes the report.
pub fn write(clock: &TwinClock, startup_stack: usize) -> Result<()> {
    let stack = stack::high_water();
    let mut file = File::create(file::REPORT)?;
    for stage in Stage::ALL {
        line(&mut file, stage.name(), clock.of(stage))?;
    }
    let counters = COUNTERS.get();
    let lines = [
        ("total", clock.total()),
        ("clock", clock.own()),
        ("worked_rows", clock.rows.count.get()),
        ("row_sum", clock.rows.sum.get()),
        ("worst_row", clock.rows.worst.get()),
        ("frame_ends", clock.rows.ends.get()),
        ("stack", u64::try_from(stack).unwrap_or(0)),
        ("startup_stack", u64::try_from(startup_stack).unwrap_or(0)),
        ("counter_frames", counters.frames.into()),
        ("counter_rows", counters.rows.into()),
        ("counter_dropped_rows", counters.dropped_rows.into()),
        ("counter_dropped_frames", counters.dropped_frames.into()),
        ("counter_overruns", counters.overruns.into()),
        ("counter_short", counters.short.into()),
        ("counter_long", counters.long.into()),
        ("counter_stalled", counters.stalled.into()),
        ("counter_dma_errors", counters.dma_errors.into()),
    ];
    lines.into_iter().try_for_each(|(name, value)| line(&mut file, name, value))
}

fn line(file: &mut File, name: &str, value: u64) -> Result<()> {
    let mut text = heapless::String::<64>::new();
    // Names are short, so it fits.
    let _ = core::fmt::Write::write_fmt(&mut text, format_args!("{name} {value}\n"));
    file.write_all(text.as_bytes())
}
