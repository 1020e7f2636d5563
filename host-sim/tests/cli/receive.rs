//! `haarline receive`: row packets in, maps out as they come.

use std::fs;
use std::io::Write;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use haarline::frame_figures::{FrameFigures, Input};
use haarline::packet::{Encoder, FrameEnd, max_bytes};
use haarline::{Counters, Disparity, DisparityRow};

use crate::files::Map;
use crate::tool::Bench;

const WIDTH: u16 = 32;

/// A sender of frames of a single row, each of its own disparity.
pub struct Sender {
    encoder: Encoder,
    next: u32,
    /// Of every frame, 1/256 px.
    row_error_q8: i16,
}

impl Sender {
    pub fn new() -> Self {
        Self { encoder: Encoder::new(), next: 0, row_error_q8: 30 }
    }

    /// The packets of the next frame: pixels of confidence 200, the first 8 of confidence 7.
    pub fn frame(&mut self) -> Vec<u8> {
        let (frame, mut buffer) = (self.next, [0; max_bytes(WIDTH)]);
        let disparity = [Disparity::from_px((frame % 16) as i16); WIDTH as usize];
        let mut confidence = [200; WIDTH as usize];
        confidence[..8].fill(7);
        let counters = Counters { frames: frame + 1, ..Counters::ZERO };
        let mut bytes = self.encoder.begin(frame, [WIDTH, 1], &counters, &mut buffer).unwrap().to_vec();
        let row = DisparityRow { y: 0, disparity: &disparity, confidence: &confidence };
        bytes.extend_from_slice(self.encoder.row(frame, row, &mut buffer).unwrap());
        let figures =
            FrameFigures { input: Input::Ok, mismatch: Some(123), sure: 750, row_error_q8: Some(self.row_error_q8) };
        let end = FrameEnd { rows: 1, figures: Some(figures), ..FrameEnd::NONE };
        bytes.extend_from_slice(self.encoder.end(frame, &end, &counters, &mut buffer).unwrap());
        self.next += 1;
        bytes
    }
}

/// The tool, reading packets from a pipe.
fn receiver(bench: &Bench) -> Child {
    Command::new(env!("CARGO_BIN_EXE_haarline"))
        .args(["receive", "-", "-o", "maps"])
        .current_dir(bench.path("."))
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

/// Waits until `is_so`, which must come about soon.
#[track_caller]
pub fn wait_until(what: &str, is_so: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed() < Duration::from_secs(300), "{what}");
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_killed_receiver_leaves_every_frame_that_had_come() {
    let (bench, mut sender) = (Bench::new(), Sender::new());
    let mut receiver = receiver(&bench);
    let mut pipe = receiver.stdin.take().unwrap();
    let lines = || fs::read_to_string(bench.path("maps/frames.csv")).unwrap_or_default().lines().count();
    for frame in 0..3 {
        pipe.write_all(&sender.frame()).unwrap();
        pipe.flush().unwrap();
        // While the sender is silent.
        wait_until("the frame's row", || lines() == frame + 2);
        let map = Map::from_pfm(&bench.read(&format!("maps/{frame:06}.pfm")));
        assert_eq!((map.width, map.height, map.px[31]), (32, 1, frame as f32));
    }
    pipe.write_all(&sender.frame()[..20]).unwrap();
    receiver.kill().unwrap();
    receiver.wait().unwrap();
    assert_eq!(lines(), 4);
    assert_eq!(fs::read_dir(bench.path("maps")).unwrap().count(), 4, "three maps and the table");
}

#[test]
fn pixels_of_less_confidence_are_unknown_in_its_maps() {
    let (bench, mut sender) = (Bench::new(), Sender::new());
    bench.write("packets.bin", sender.frame());
    for (least, known) in [(0, 32), (7, 32), (8, 24), (201, 0)] {
        bench.succeeds(&format!("receive packets.bin -o maps --min-confidence {least}"));
        assert_eq!(Map::from_pfm(&bench.read("maps/000000.pfm")).known().len(), known, "{least}");
    }
}

#[test]
fn a_rig_that_has_bent_is_told_once_and_frame_by_frame_in_the_table() {
    let (bench, mut sender) = (Bench::new(), Sender::new());
    let mut bytes = sender.frame();
    sender.row_error_q8 = -160;
    bytes.extend([sender.frame(), sender.frame()].concat());
    bench.write("packets", bytes);
    let outcome = bench.succeeds_on_odd_views("receive packets -o maps");
    assert_eq!(outcome.stderr.matches("the rig has bent").count(), 1, "{outcome:?}");
    assert!(outcome.stderr.contains("frame 1: the rig has bent: the right view lies 0.62 px higher"), "{outcome:?}");
    let table = String::from_utf8(bench.read("maps/frames.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[0].contains("share_sure,row_error_px,") && lines[2].contains(",75.0,-0.625,"), "{table}");
}

/// The most memory that it took so far, KiB.
#[cfg(target_os = "linux")]
pub fn peak_memory(process: &Child) -> u64 {
    let status = fs::read_to_string(format!("/proc/{}/status", process.id())).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    line.split_whitespace().next().unwrap().parse().unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn its_memory_does_not_grow_with_the_length() {
    let frames = if cfg!(debug_assertions) { 4_000 } else { 100_000 };
    let (bench, mut sender) = (Bench::new(), Sender::new());
    let mut receiver = receiver(&bench);
    let mut pipe = receiver.stdin.take().unwrap();
    let mut peaks = Vec::new();
    for half in [frames / 2, frames] {
        while sender.next < half {
            pipe.write_all(&sender.frame()).unwrap();
        }
        let last = bench.path(format!("maps/{:06}.pfm", half - 1));
        wait_until("the last frame's map", || last.exists());
        peaks.push(peak_memory(&receiver));
    }
    drop(pipe);
    assert!(receiver.wait().unwrap().success());
    println!("{frames} frames: at most {peaks:?} KiB");
    assert!(peaks[1] < 60 * 1024, "{peaks:?} KiB");
    assert!(peaks[1] - peaks[0] < 1024, "it grows: {peaks:?} KiB");
}
