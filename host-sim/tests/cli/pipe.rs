//! `haarline play -`: frames without end through a pipe.

use std::fs;
use std::io::Write;
use std::process::{Child, Command, Stdio};

use crate::receive::wait_until;
use crate::scene::Pair;
use crate::tool::Bench;

const OPTIONS: &str =
    "--raw 96x24 --wiring side-by-side --method lite --num-disparities 16 --write disparity --range 0..16";

fn player(bench: &Bench, more: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_haarline"))
        .args(format!("play - -o out {OPTIONS} {more}").split_whitespace())
        .current_dir(bench.path("."))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// A frame of both views side by side.
fn frame(index: usize) -> Vec<u8> {
    let pair = Pair::shifted(96, 24, (index % 9) as i64 + 2);
    pair.left.chunks(96).zip(pair.right.chunks(96)).flat_map(|(left, right)| [left, right].concat()).collect()
}

#[test]
fn a_stream_gives_the_maps_of_the_same_frames_in_a_file() {
    let bench = Bench::new();
    let bytes: Vec<u8> = (0..40).flat_map(frame).collect();
    bench.write("take.raw", &bytes);
    bench.succeeds(&format!("play take.raw -o file {OPTIONS}"));
    let mut player = player(&bench, "");
    player.stdin.take().unwrap().write_all(&bytes).unwrap();
    let outcome = player.wait_with_output().unwrap();
    assert!(outcome.status.success(), "{outcome:?}");
    for index in 0..40 {
        let name = |folder: &str| format!("{folder}/{index:06}.pfm");
        assert!(bench.read(&name("file")) == bench.read(&name("out")), "{index}");
    }
}

#[test]
fn each_frame_is_written_while_the_stream_goes_on() {
    let bench = Bench::new();
    let mut player = player(&bench, "");
    let mut pipe = player.stdin.take().unwrap();
    for index in 0..3 {
        pipe.write_all(&frame(index)).unwrap();
        pipe.flush().unwrap();
        let table = || fs::read_to_string(bench.path("out/frames.csv")).unwrap_or_default().lines().count();
        wait_until("the frame's row", || table() == index + 2);
    }
    player.kill().unwrap();
    player.wait().unwrap();
    assert!(bench.path("out/000002.pfm").exists());
}

#[test]
fn a_stream_that_ends_within_a_frame_or_before_one_is_told() {
    for (bytes, status, told) in [
        ([frame(0), frame(1)[..100].to_vec()].concat(), 1, "ends after 100 of the 4608 bytes"),
        (Vec::new(), 2, "ended before there was one frame"),
    ] {
        let bench = Bench::new();
        let mut player = player(&bench, "");
        player.stdin.take().unwrap().write_all(&bytes).unwrap();
        let outcome = player.wait_with_output().unwrap();
        let words = String::from_utf8(outcome.stderr).unwrap();
        assert_eq!(outcome.status.code(), Some(status), "{words}");
        assert!(words.contains(told), "{words}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn its_memory_does_not_grow_with_the_length() {
    let frames = if cfg!(debug_assertions) { 600 } else { 10_000 };
    let bench = Bench::new();
    let mut player = player(&bench, "");
    let mut pipe = player.stdin.take().unwrap();
    let some: Vec<Vec<u8>> = (0..9).map(frame).collect();
    let mut peaks = Vec::new();
    for half in [0..frames / 2, frames / 2..frames] {
        let last = bench.path(format!("out/{:06}.pfm", half.end - 1));
        half.for_each(|index| pipe.write_all(&some[index % 9]).unwrap());
        wait_until("the last frame's map", || last.exists());
        peaks.push(crate::receive::peak_memory(&player));
    }
    drop(pipe);
    assert!(player.wait().unwrap().success());
    println!("{frames} frames: at most {peaks:?} KiB");
    assert!(peaks[1] < 60 * 1024 && peaks[1] - peaks[0] < 2048, "{peaks:?} KiB");
}
