//! The unmodified program of the board on an emulated STM32H743, with two MT9V034 or HM01B0 cameras that play a
//! raw dump of `haarline record`.
//!
//! The log that it leaves goes on over resets, each with a line that says when and by whom; so do the bytes
//! of the serial ports.
//!
//! What it is not: caches, wait states and bus contention are not emulated, every instruction takes a
//! cycle of 480 MHz, DMA is late by a fixed time. Time is virtual, so a run is the same run every time.

mod board;
mod camera;
mod dcmi;
mod log;
mod phases;
mod profile;
mod rtt;
mod run;
mod sensor;
mod strike;
mod symbols;
mod watchdog;
mod wire;
mod wires;

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use rigless::chip::uart::TcpPeer;

use board::Rig;
use camera::{Camera, Fault};
use sensor::Model;
use wires::Mistake;

/// Runs a program for the STM32H743 with two cameras.
#[derive(Parser)]
struct Args {
    /// The program, an ELF file
    elf: PathBuf,
    /// Raw dump that the cameras play, frame after frame and from its beginning again; without one
    /// nothing is seen. Of every wiring with two bytes on one line for a pixel of both views
    #[arg(long, value_name = "FILE", requires = "size")]
    raw: Option<PathBuf>,
    /// Size of one view in the dump, px; the sensors show it in the middle of theirs
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    size: Option<[usize; 2]>,
    /// Frames to play. They go on while the program stands still: with a watchdog of 2 s and 5 frames a second
    /// nobody sees the next ten
    #[arg(long, default_value_t = 2, value_name = "N")]
    frames: u32,
    /// The sensors, mt9v034 (seven lines of each) or hm01b0
    #[arg(long, default_value = "mt9v034", value_name = "MODEL")]
    sensor: Model,
    /// One mistake in the wires: stuck-low:LINE, stuck-high:LINE, swapped:LINE:LINE, shorted:LINE:LINE,
    /// no-pixel-clock, no-lines, no-frames, no-master-clock, no-trigger, mute:SENSOR, another:SENSOR,
    /// crossed-buses, out-of-phase:CLOCKS, no-crystal
    #[arg(long, value_name = "MISTAKE")]
    wires: Option<Mistake>,
    /// How long words are on their way from the camera interface to the memory, ns
    #[arg(long, default_value_t = 2000, value_name = "NS")]
    dma_late: u64,
    /// One fault: of the camera short, long, overrun, stall, garbage@FRAME, silent (no sensor answers for
    /// 300 ms), or nak (none for 300 ms after its reset); of the program, which works on no row from that frame on until the part is reset, hang or
    /// crash@FRAME
    #[arg(long, value_name = "KIND[@FRAME]")]
    fault: Option<Fault>,
    /// Where the bytes of the first serial port go: row packets
    #[arg(long, value_name = "FILE")]
    rows: Option<PathBuf>,
    /// Where the bytes of the second serial port go: MAVLink
    #[arg(long, value_name = "FILE")]
    mavlink: Option<PathBuf>,
    /// Lets `haarline silicon` talk over the debugger's serial port, at this port of 127.0.0.1; 0 is any, and is printed
    #[arg(long, value_name = "PORT")]
    host: Option<u16>,
    /// Where the log goes, as text
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Where the levels of the two phase pins go: each edge with its time (CSV)
    #[arg(long, value_name = "FILE")]
    phases: Option<PathBuf>,
    /// Where a profile of the program's time goes: how often each address was the next one to execute, one look each
    /// 1.009 us (CSV)
    #[arg(long, value_name = "FILE")]
    profile: Option<PathBuf>,
    /// Prints so many words of a variable when the run is over, as a probe reads them: NAME:WORDS
    #[arg(long, value_name = "NAME:WORDS", value_parser = variable)]
    read: Option<(String, usize)>,
    /// Clock that the program sets the core to, MHz
    #[arg(long, default_value_t = 480, value_name = "MHZ")]
    mhz: u64,
    /// End after so much virtual time, ms
    #[arg(long, default_value_t = 10_000, value_name = "MS")]
    limit: u64,
    /// End so long after the last frame, ms of virtual time
    #[arg(long, default_value_t = 150, value_name = "MS")]
    tail: u64,
}

fn size(text: &str) -> Result<[usize; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides.filter(|s| s.iter().all(|&side| side > 0)).ok_or_else(|| "must be as 320x240".to_owned())
}

fn variable(text: &str) -> Result<(String, usize), String> {
    let parts = text.split_once(':').and_then(|(name, words)| Some((name.to_owned(), words.parse().ok()?)));
    parts.ok_or_else(|| "must be as NAME:8".to_owned())
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<()> {
    let dump = match &args.raw {
        Some(path) => fs::read(path).with_context(|| path.display().to_string())?,
        None => Vec::new(),
    };
    let camera = Camera::new(dump, args.size.unwrap_or([0, 0]), args.frames, args.fault)?;
    let host = args.host.map(TcpPeer::listen).transpose().context("--host")?;
    if let Some(host) = &host {
        println!("listening at 127.0.0.1:{}", host.port()?);
    }
    let make = |camera| {
        let mut rig = Rig::new(camera, args.sensor, args.wires, args.dma_late, args.mhz * 1_000_000)?;
        if let Some(host) = host {
            rig.attach_host(host);
        }
        Ok(rig)
    };
    let profile = args.profile.is_some();
    let outcome = run::run(&args.elf, camera, make, args.limit, args.tail, args.read.as_ref(), profile)?;
    for (path, bytes) in [
        (&args.rows, &outcome.rows),
        (&args.mavlink, &outcome.mavlink),
        (&args.log, &outcome.log.into_bytes()),
        (&args.phases, &outcome.phases.into_bytes()),
        (&args.profile, &outcome.profile.into_bytes()),
    ] {
        if let Some(path) = path {
            fs::write(path, bytes).with_context(|| path.display().to_string())?;
        }
    }
    print!("{}", outcome.text);
    ensure!(!outcome.is_fatal, "the program went where nothing is");
    Ok(())
}
