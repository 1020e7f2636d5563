//! The program: one frame through each method.

use haarline::{Config, Full, Lite, ScanlinePair, StereoMethod, blocks_for};
use haarline_tests::{BlockSettings, StereoBm};
use semihosting::{println, process};
use static_cell::StaticCell;

use crate::clock::Clock;
use crate::digest::Digest;
use crate::frame::{Frame, MAX_WIDTH};

const BLOCKS: usize = blocks_for(MAX_WIDTH);
/// Disparities that `lite` and `full` search unless told otherwise.
const DISPARITIES: u16 = 48;
/// Disparities that `block` searches.
const BLOCK_DISPARITIES: [u16; 3] = [16, 48, 64];

type Block = StereoBm<{ MAX_WIDTH as usize }, 64>;

static LITE: StaticCell<Lite<BLOCKS>> = StaticCell::new();
static FULL: StaticCell<Full<BLOCKS>> = StaticCell::new();
static BLOCK: [StaticCell<Block>; BLOCK_DISPARITIES.len()] = [const { StaticCell::new() }; _];

#[cortex_m_rt::entry]
fn main() -> ! {
    match run() {
        Ok(()) => process::exit(0),
        Err(message) => {
            println!("error: {message}");
            process::exit(1)
        }
    }
}

/// Arguments: name of the program, disparities, and for files the left and the right one.
fn run() -> Result<(), &'static str> {
    let args = semihosting::experimental::env::args::<1024>().map_err(|_| "no command line")?;
    let mut args = (&args).into_iter().skip(1).filter_map(Result::ok);
    let disparities = args.next().map_or(Ok(DISPARITIES), str::parse).map_err(|_| "the disparities are no number")?;
    let mut frame = match (args.next(), args.next()) {
        (Some(left), Some(right)) => Frame::open(left, right)?,
        (None, _) => Frame::BuiltIn,
        _ => return Err("the right picture is missing"),
    };

    let (width, height) = frame.size();
    let clock = Clock::new();
    println!("{width} x {height} px; executed instructions (the clock's own {} a span subtracted)", clock.own());
    println!("method  disparities  per px  mean row  worst row  at end   known  checksum");

    let config = |num_disparities| Config { width, min_disparity: 0, num_disparities };
    let invalid = |_| "the disparities or the width are out of range";
    let lite = LITE.init(Lite::new(config(disparities)).map_err(invalid)?);
    measure("lite", lite, &clock, &mut frame)?;
    let full = FULL.init(Full::new(config(disparities)).map_err(invalid)?);
    measure("full", full, &clock, &mut frame)?;
    for (cell, disparities) in BLOCK.iter().zip(BLOCK_DISPARITIES) {
        let block = Block::new(config(disparities), BlockSettings::default());
        let block = cell.init(block.map_err(invalid)?);
        measure("block", block, &clock, &mut frame)?;
    }
    Ok(())
}

/// Runs the frame through the method, and prints its line of the table.
///
/// The clock runs within the method only, not where rows are made or taken.
fn measure(name: &str, method: &mut dyn StereoMethod, clock: &Clock, frame: &mut Frame) -> Result<(), &'static str> {
    let (width, height) = frame.size();
    let mut digest = Digest::new();
    let mut take_row = |row: haarline::DisparityRow<'_>| {
        clock.halt();
        digest.add(&row);
        clock.go();
    };
    let (mut rows, mut worst_row) = (0, 0);
    for y in 0..height {
        let (left, right) = frame.rows(y)?;
        let (left, right) = (&left[..usize::from(width)], &right[..usize::from(width)]);
        clock.go();
        let pushed = method.push(ScanlinePair { left, right }, &mut take_row);
        clock.halt();
        pushed.map_err(|_| "a row is refused")?;
        let row = clock.take();
        worst_row = worst_row.max(row);
        rows += u64::from(row);
    }
    clock.go();
    method.finish(&mut take_row);
    clock.halt();
    let end = clock.take();

    let total = rows + u64::from(end);
    let pixels = u64::from(width) * u64::from(height);
    let tenths = (total * 10 + pixels / 2) / pixels;
    println!(
        "{name:6}  {:11}  {:>4}.{}  {:8}  {worst_row:9}  {end:6}  {:6}  {:08x}",
        method.config().num_disparities,
        tenths / 10,
        tenths % 10,
        rows / u64::from(height),
        digest.known,
        digest.checksum,
    );
    Ok(())
}
