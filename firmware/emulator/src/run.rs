//! One run, and what it leaves.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use rigless::device::ResetCause;
use rigless::emulator::{self, AccessKind, Driver, Host, Settled, Start, Stop};
use rigless::image::Image;
use rigless::session::{Reset, Session};
use rigless::soc::Width;
use rigless::time::VirtualNanos;

use crate::board::Rig;
use crate::camera::Camera;
use crate::profile::Profile;
use crate::rtt::Rtt;
use crate::strike::Strike;
use crate::{log, symbols};

/// How often the log is read and the trigger looked at, ns.
const LOOK: u64 = 1_000_000;

/// What a run leaves.
pub struct Outcome {
    pub rows: Vec<u8>,
    pub mavlink: Vec<u8>,
    /// The log, decoded.
    pub log: String,
    pub text: String,
    /// The edges of the phase pins.
    pub phases: String,
    /// Where the core was, if that was asked for.
    pub profile: String,
    /// The program went where nothing is.
    pub is_fatal: bool,
}

struct Watcher {
    /// None of a program without a log.
    rtt: Option<Rtt>,
    /// A variable that is read in the end: where, and its words.
    variable: Option<(u64, Vec<u64>)>,
    strike: Option<Strike>,
    /// When it struck.
    struck: Option<VirtualNanos>,
    /// Resets so far.
    resets: usize,
    profile: Option<Profile>,
    limit: u64,
    tail: u64,
    /// Instructions in the end.
    instructions: u64,
    /// Why the run cannot go on.
    failed: Option<anyhow::Error>,
}

impl Watcher {
    /// The part was reset, and no instruction ran since.
    fn restart(&mut self, host: &mut dyn Host) {
        // Memory that nobody can read is a program without a log yet.
        let _ = self.rtt.as_mut().map(|rtt| rtt.restart(host));
        if let Some(Err(error)) = self.strike.as_mut().map(|strike| strike.heal(host)) {
            self.failed = Some(error.into());
        }
    }

    /// Reads the variable, so that the last look is the one that is told.
    fn read(&mut self, host: &mut dyn Host) {
        let Some((address, words)) = &mut self.variable else { return };
        for (at, word) in (*address..).step_by(4).zip(words) {
            // Memory that nobody can read holds nothing.
            *word = host.read(at, Width::W32).unwrap_or(0);
        }
    }

    fn strike(&mut self, begun: u32, now: VirtualNanos, host: &mut dyn Host) {
        match self.strike.as_mut().map(|strike| strike.look(begun, host)) {
            Some(Ok(true)) => self.struck = Some(now),
            Some(Err(error)) => self.failed = Some(error),
            _ => {}
        }
    }
}

impl Driver<Rig> for Watcher {
    fn on_settled(&mut self, session: &mut Session<Rig>, host: &mut dyn Host, settled: Settled) {
        while self.resets < session.resets().len() {
            self.resets += 1;
            self.restart(host);
        }
        match settled {
            Settled::Access { access, .. } if access.kind == AccessKind::Write => {
                let board = session.board_mut();
                board.phases.written(access.address, access.value, access.virtual_time.0);
                board.written(access.address, access.virtual_time);
            }
            Settled::Stop(stop) => self.strike(session.board().chip.dcmi.begun(), stop.at, host),
            _ => {}
        }
    }

    fn on_stop(&mut self, session: &mut Session<Rig>, stop: Stop, host: &mut dyn Host) -> Option<VirtualNanos> {
        self.instructions = stop.instruction_count;
        let now = stop.at;
        if let Some(profile) = &mut self.profile
            && let Some(next) = profile.look(now.0, host)
        {
            return Some(VirtualNanos(next));
        }
        // Memory that nobody can read is a program without a log yet.
        let _ = self.rtt.as_mut().map(|rtt| rtt.drain(host));
        self.read(host);
        let board = session.board_mut();
        board.look(now);
        let dcmi = &board.chip.dcmi;
        let shown = dcmi.ended.filter(|_| dcmi.is_over()).map(|ended| ended.0 + self.tail * LOOK);
        let end = [shown, Some(self.limit * LOOK)].into_iter().flatten().min().filter(|_| self.failed.is_none());
        let next = (now.0 / LOOK + 1) * LOOK;
        let next = self.profile.as_mut().map_or(next, |profile| profile.until(next, now.0));
        (end > Some(now.0)).then_some(VirtualNanos(next))
    }
}

/// Runs the program until the cameras have shown everything, or for `limit` ms.
pub fn run(
    elf: &Path,
    camera: Camera,
    make: impl FnOnce(Camera) -> Result<Rig, rigless::soc::Error>,
    limit: u64,
    tail: u64,
    read: Option<&(String, usize)>,
    profile: bool,
) -> Result<Outcome> {
    let name = || elf.display().to_string();
    let program = fs::read(elf).with_context(name)?;
    let block = symbols::variable(&program, symbols::CONTROL_BLOCK).with_context(name)?;
    let variable = match read {
        Some((variable, words)) => {
            let address = symbols::variable(&program, variable)?;
            Some((address.with_context(|| format!("{}: has no variable {variable}", name()))?, vec![0; *words]))
        }
        None => None,
    };
    let images = [Image::read(elf, None).with_context(name)?];
    let strike = Strike::new(camera.fault, &program).with_context(name)?;
    let session = Session::new(Box::new(make(camera)?), 0, VirtualNanos(LOOK))?;
    let rtt = block.map(Rtt::new);
    let profile = profile.then(Profile::default);
    let watcher =
        Watcher { rtt, variable, strike, struck: None, resets: 0, profile, limit, tail, instructions: 0, failed: None };
    let finished = emulator::run(session, &Start::new(&images), watcher)?;
    let (session, watcher) = (finished.session, finished.driver);
    if let Some(error) = watcher.failed {
        return Err(error);
    }
    let board = session.board();
    let heard = |wire: &crate::wire::Heard| wire.lock().expect("nobody panics").bytes.clone();
    let (rows, mavlink) = (heard(&board.rows), heard(&board.mavlink));
    let resets: Vec<String> = session.resets().iter().map(told).collect();
    let runs = watcher.rtt.map(|rtt| rtt.runs).unwrap_or_default();
    let log = if runs.is_empty() { String::new() } else { log::text(&program, &runs, &resets).with_context(name)? };

    let mut text = String::new();
    let dcmi = &board.chip.dcmi;
    let at = finished.stop.map_or(0, |stop| stop.at.0);
    let _ = writeln!(
        text,
        "virtual time {} ms, {} instructions at {} MHz",
        at / LOOK,
        watcher.instructions,
        board.clock / 1_000_000
    );
    let _ = writeln!(text, "frames shown {}, words stored {}, FIFO overruns {}", dcmi.frame, dcmi.words, dcmi.overruns);
    let ended = board.rows.lock().expect("nobody panics").ended.clone();
    if let Some(latency) = latency(&dcmi.shown, &ended) {
        let _ = writeln!(text, "from the end of the integration to the last row's packet at most {}", ms(latency));
    }
    let ms_of = |times: &[u64]| times.iter().map(|&at| ms(VirtualNanos(at))).collect::<Vec<_>>().join(", ");
    if !board.phases.is_empty() {
        let _ = writeln!(text, "frames' first lines at {}", ms_of(&dcmi.shown));
    }
    if let Some(standby) = dcmi.standby() {
        let _ = writeln!(text, "sensors in standby for {} of each frame", ms(VirtualNanos(standby)));
    }
    if let Some((_, words)) = &watcher.variable {
        let words: Vec<String> = words.iter().map(|word| format!("{word:08x}")).collect();
        let _ = writeln!(text, "read: {}", words.join(" "));
    }
    let bits = dcmi.bits().map(|bits| bits.map_or("unknown".to_owned(), |bits| bits.to_string()));
    let _ = writeln!(text, "bits of the sensors: {}", bits.join(" and "));
    let logged: usize = runs.iter().map(Vec::len).sum();
    let _ = writeln!(text, "bytes: rows {}, MAVLink {}, log {logged}", rows.len(), mavlink.len());
    match watcher.struck {
        Some(at) => _ = writeln!(text, "the program was struck at {}", ms(at)),
        None if watcher.strike.is_some() => text.push_str("the frame in which the program is struck never came\n"),
        None => {}
    }
    for reset in resets {
        let _ = writeln!(text, "{reset}");
    }
    for told in session.told().filter(|told| !board.is_excused(told)) {
        let _ = writeln!(text, "told: {told:?}");
    }
    for (address, fault) in session.refused() {
        let _ = writeln!(text, "refused: {address:#x} {fault:?}");
    }
    let unmapped = session.unmapped();
    for access in &unmapped {
        let _ = writeln!(text, "unmapped: {access:?}");
    }
    let profile = watcher.profile.map(|profile| profile.csv()).unwrap_or_default();
    Ok(Outcome { rows, mavlink, log, text, phases: board.phases.csv(), profile, is_fatal: !unmapped.is_empty() })
}

/// The longest time from the first line of a frame to the last byte before the next one's first.
fn latency(shown: &[u64], ended: &[u64]) -> Option<VirtualNanos> {
    let frames = shown.windows(2).filter_map(|frame| {
        let last = ended.iter().copied().filter(|at| (frame[0]..frame[1]).contains(at)).max()?;
        Some(last - frame[0])
    });
    frames.max().map(VirtualNanos)
}

fn ms(at: VirtualNanos) -> String {
    format!("{}.{:03} ms", at.0 / LOOK, at.0 % LOOK / 1000)
}

fn told(reset: &Reset) -> String {
    let cause = match reset.cause {
        ResetCause::Core => "the program itself".to_owned(),
        ResetCause::Model("IWDG") => "the watchdog".to_owned(),
        other => format!("{other:?}"),
    };
    format!("reset at {} by {cause}", ms(reset.at))
}
