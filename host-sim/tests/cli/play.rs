//! `haarline play`: a recording in, files out frame by frame.

use std::fs;
use std::process::{Command, Stdio};

use crate::files::{Map, png16, vertices};
use crate::receive::wait_until;
use crate::scene::Pair;
use crate::tool::Bench;

/// A recording of planes: the frame's number tells their disparity.
fn bench_with_recording(shifts: impl IntoIterator<Item = i64>, [width, height]: [usize; 2]) -> Bench {
    let bench = Bench::new();
    for (index, shift) in shifts.into_iter().enumerate() {
        Pair::shifted(width, height, shift).write(&bench);
        for side in ["left", "right"] {
            let bytes = bench.read(&format!("{side}.png"));
            bench.write(&format!("take/{side}/{index:03}.png"), bytes);
        }
    }
    bench
}

#[test]
fn each_frame_has_every_kind_of_file_that_depth_writes_with_the_same_content() {
    let bench = bench_with_recording([3, 5], [96, 40]);
    let options = "--num-disparities 16 --focal-px 100 --baseline-mm 60 --max-depth 1.5 --range 1..9";
    let kinds = "disparity,kitti,npy,depth,ply,confidence,picture,grey";
    bench.succeeds(&format!("play take -o out {options} --write {kinds}"));
    bench.succeeds(&format!(
        "depth left.png right.png {options} -o a.pfm -o a.png -o a.npy -o a.ply --depth-png a_depth.png \
         --confidence a_confidence.png --picture a_picture.png --grey a_grey.png"
    ));
    let endings = [".pfm", ".png", ".npy", "_depth.png", ".ply", "_confidence.png", "_picture.png", "_grey.png"];
    for ending in endings {
        // The second frame is the pair that is left.
        assert!(bench.read(&format!("out/001{ending}")) == bench.read(&format!("a{ending}")), "{ending}");
        assert!(bench.path(format!("out/000{ending}")).exists());
    }
    let known = png16(&bench.read("out/001_depth.png")).into_iter().filter(|&mm| mm > 0).count();
    assert_eq!(vertices(&bench.read("out/001.ply")).len(), known);
    assert_eq!(fs::read_dir(bench.path("out")).unwrap().count(), 2 * endings.len() + 1);

    bench.succeeds(&format!("play take -o filled {options} --fill --write disparity,depth"));
    bench.succeeds(&format!("depth left.png right.png {options} --fill -o f.pfm --depth-png f_depth.png"));
    for ending in [".pfm", "_depth.png"] {
        assert!(bench.read(&format!("filled/001{ending}")) == bench.read(&format!("f{ending}")), "{ending}");
    }
    assert_eq!(Map::from_pfm(&bench.read("filled/001.pfm")).density(), 100.0);

    bench.succeeds("play take -o some --write confidence,confidence");
    assert_eq!(fs::read_dir(bench.path("some")).unwrap().count(), 3);
    bench.refuses("play take -o none --write depth", &["--write depth", "--focal-px", "--rig"]);
    bench.refuses("play take -o none --write cloud", &["--write", "ply"]);
}

#[test]
fn the_colours_are_those_of_the_first_frames_in_all_pictures_and_told() {
    let bench = bench_with_recording([2, 9, 4, 4, 4, 4, 4, 4, 4, 4, 14], [64, 24]);
    let told = bench.succeeds("play take -o out --num-disparities 16").stdout;
    let [min, max] = colours(&bench, "play take -o out --num-disparities 16 --json");
    assert!((0.0..=2.0).contains(&min) && (9.0..13.0).contains(&max), "{min} to {max}: of the first ten frames");
    assert!(
        told.contains(&format!("colours span {min} to {max} px in all pictures, from the first 10 frames")),
        "{told}"
    );
    bench.succeeds(&format!("play take -o told --num-disparities 16 --range {min}..{max}"));
    for frame in 0..11 {
        let name = format!("{frame:03}_picture.png");
        assert!(bench.read(&format!("out/{name}")) == bench.read(&format!("told/{name}")), "frame {frame}");
    }
    // A shorter recording has its own.
    let [_, max] = colours(&bench, "play take -o short --num-disparities 16 --frames 2..4 --json");
    assert!(max < 9.0, "{max}");
    assert_eq!(colours(&bench, "play take -o out --num-disparities 16 --range 1.5..7 --json"), [1.5, 7.0]);
}

fn colours(bench: &Bench, line: &str) -> [f64; 2] {
    let summary = bench.succeeds(line).json();
    [0, 1].map(|end| summary["colours_px"][end].as_f64().unwrap())
}

#[test]
fn a_killed_run_leaves_everything_up_to_its_last_frame() {
    let bench = bench_with_recording((0..60).map(|frame| frame % 12), [640, 96]);
    let mut child = Command::new(env!("CARGO_BIN_EXE_haarline"))
        .args(["play", "take", "-o", "out", "--num-disparities", "64"])
        .current_dir(bench.path("."))
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let table = || fs::read_to_string(bench.path("out/frames.csv")).unwrap_or_default();
    wait_until("the third frame", || table().lines().count() > 3);
    child.kill().unwrap();
    child.wait().unwrap();
    let table = table();
    assert!(table.ends_with('\n'), "only whole rows");
    let frames = table.lines().count() - 1;
    assert!((3..60).contains(&frames), "{frames} frames: it was to be killed on the way");
    for frame in 0..frames {
        for ending in [".pfm", "_picture.png"] {
            assert!(bench.path(format!("out/{frame:03}{ending}")).exists(), "{frame}{ending}");
        }
    }
}
