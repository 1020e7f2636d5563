//! `haarline record`, and `haarline play --raw` on what it made.

use std::fs;

use image::ImageFormat;

use crate::files::encode;
use crate::scene::{Pair, bench_with_plane, grey_image};
use crate::tool::{Bench, assert_one_error_line};

const KINDS: [&str; 5] = ["pixel", "line", "side-by-side", "nibble", "pairs16"];
const SEARCH: &str = "--method lite --num-disparities 16";

/// A recording of two different frames in folders, 96x24 px a view.
fn bench_with_recording() -> Bench {
    let bench = Bench::new();
    for (name, shift) in [("a", 5), ("b", 9)] {
        let pair = Pair::shifted(96, 24, shift);
        bench.write(&format!("take/left/{name}.png"), encode(&pair.left_image(), ImageFormat::Png));
        bench.write(&format!("take/right/{name}.png"), encode(&pair.right_image(), ImageFormat::Png));
    }
    bench.succeeds(&format!("play take -o source {SEARCH}"));
    bench
}

#[test]
fn a_dump_in_any_wiring_plays_to_the_maps_of_its_source() {
    let bench = bench_with_recording();
    for kind in KINDS {
        for first in ["left", "right"] {
            bench.succeeds(&format!("record --recording take -o take.raw --wiring {kind} --first {first}"));
            assert_eq!(bench.read("take.raw").len(), 2 * 2 * 96 * 24);
            bench.succeeds(&format!("play take.raw --raw 96x24 --wiring {kind} --first {first} -o out {SEARCH}"));
            for (source, played) in [("a", "000000"), ("b", "000001")] {
                let (source, played) = (format!("source/{source}.pfm"), format!("out/{played}.pfm"));
                assert!(bench.read(&source) == bench.read(&played), "{kind}, {first} first: {played}");
            }
        }
    }
}

#[test]
fn fourteen_lines_leave_seven_bits_of_each_pixel() {
    let bench = Bench::new();
    let pair = Pair::shifted(96, 24, 5);
    let seven = |view: &[u8]| view.iter().map(|pixel| pixel & 0xFE).collect();
    let less = Pair { left: seven(&pair.left), right: seven(&pair.right), ..pair };
    for (folder, pair) in [("whole", &pair), ("less", &less)] {
        bench.write(&format!("{folder}/left/a.png"), encode(&pair.left_image(), ImageFormat::Png));
        bench.write(&format!("{folder}/right/a.png"), encode(&pair.right_image(), ImageFormat::Png));
    }
    bench.succeeds(&format!("play less -o source {SEARCH}"));
    for first in ["left", "right"] {
        bench.succeeds(&format!("record --recording whole -o whole.raw --wiring pairs14 --first {first}"));
        bench.succeeds(&format!("play whole.raw --raw 96x24 --wiring pairs14 --first {first} -o out {SEARCH}"));
        assert!(bench.read("source/a.pfm") == bench.read("out/000000.pfm"), "{first} first");
    }
}

#[test]
fn the_wrong_wiring_gives_other_maps() {
    let bench = bench_with_recording();
    bench.succeeds("record --recording take -o take.raw --wiring pixel");
    for wrong in ["--wiring line", "--wiring nibble", "--wiring pixel --first right", "--wiring pixel --skew left"] {
        bench.succeeds_on_odd_views(&format!("play take.raw --raw 96x24 {wrong} -o out {SEARCH}"));
        assert!(bench.read("source/a.pfm") != bench.read("out/000000.pfm"), "{wrong}");
    }
}

#[test]
fn skewed_pixels_come_back_but_for_the_last_one_of_the_late_camera() {
    let bench = bench_with_plane(7);
    bench.succeeds("record left.png right.png -o plain.raw --wiring side-by-side");
    let plain = bench.read("plain.raw");
    for (skew, first) in [("left", "left"), ("left", "right"), ("right", "left"), ("right", "right")] {
        let wiring = format!("--wiring pixel --skew {skew} --first {first}");
        let told = bench.succeeds(&format!("record left.png right.png -o skewed.raw {wiring} --json")).json();
        let width = told["width"].as_u64().unwrap() as usize;
        let size = format!("{width}x{}", told["height"]);
        assert_eq!((&told["frames"], &told["skew"]), (&1.into(), &skew.into()));
        let raw = bench.read("skewed.raw");
        let (rows, views) = (raw.chunks(2 * width), plain.chunks(2 * width));
        for (row, views) in rows.zip(views) {
            let (left, right) = views.split_at(width);
            let of = |camera: &str| if camera == "left" { left } else { right };
            let slots: Vec<u8> = row.iter().skip(usize::from(skew != first)).step_by(2).copied().collect();
            assert_eq!(slots[1..], of(skew)[..width - 1], "{wiring}");
        }
        bench.succeeds(&format!("play skewed.raw --raw {size} {wiring} -o out {SEARCH}"));
        bench.succeeds(&format!("depth left.png right.png -o map.pfm {SEARCH}"));
        let (skewed, whole) = (bench.read("out/000000.pfm"), bench.read("map.pfm"));
        let same = skewed.iter().zip(&whole).filter(|(a, b)| a == b).count();
        assert!(same * 100 > whole.len() * 97, "{wiring}: {same} of {} bytes", whole.len());
    }
}

#[test]
fn frames_with_both_views_and_a_part_of_a_recording_are_recorded() {
    let bench = Bench::new();
    for (name, right, left) in [("0", 10, 20), ("1", 30, 40), ("2", 50, 60)] {
        let luma: Vec<u8> = [[right; 32], [left; 32]].concat();
        bench.write(&format!("take/{name}.png"), encode(&grey_image(64, 1, &luma), ImageFormat::Png));
    }
    let take = "record --recording take --layout side-by-side --first right --frames 1..3 -o take.raw";
    let told = bench.succeeds(&format!("{take} --wiring line")).stdout;
    assert_eq!(bench.read("take.raw"), [[30; 32], [40; 32], [50; 32], [60; 32]].concat());
    assert!(told.contains("2 frames of 32x1 px a view, 128 bytes"), "{told}");
    let play = told.split("haarline ").nth(1).unwrap().replace("DIR", "out");
    bench.succeeds(&play);
    bench.refuses(&format!("{take} --wiring line --layout folders"), &["--layout"]);
}

#[test]
fn a_dump_that_is_no_whole_number_of_frames_plays_the_whole_ones_and_tells() {
    let bench = bench_with_recording();
    bench.succeeds("record --recording take -o take.raw --wiring line");
    let bytes = bench.read("take.raw");
    fs::write(bench.path("cut.raw"), &bytes[..bytes.len() - 1000]).unwrap();
    let outcome = bench.run(&format!("play cut.raw --raw 96x24 --wiring line -o out {SEARCH}"));
    assert_eq!(outcome.status, 1, "{outcome:?}");
    assert!(outcome.stderr.contains("frame 1 skipped: cut.raw: ends after 3608 of the 4608 bytes"), "{outcome:?}");
    assert!(outcome.stderr.contains("1 of 2 frames were damaged"), "{outcome:?}");
    assert!(bench.read("source/a.pfm") == bench.read("out/000000.pfm"));
    fs::write(bench.path("tiny.raw"), &bytes[..100]).unwrap();
    bench.refuses("play tiny.raw --raw 96x24 --wiring line -o other", &["tiny.raw", "100 bytes", "4608"]);
}

#[test]
fn a_damaged_frame_of_a_recording_is_skipped_and_told() {
    let bench = bench_with_recording();
    bench.write("take/left/ab.png", b"no image");
    let outcome = bench.run("record --recording take -o take.raw --wiring pixel");
    assert_eq!(outcome.status, 1, "{outcome:?}");
    assert!(outcome.stderr.starts_with("frame 1 skipped: "), "{outcome:?}");
    assert_one_error_line(&outcome.stderr[outcome.stderr.find("error").unwrap()..], "record");
    assert_eq!(bench.read("take.raw").len(), 2 * 2 * 96 * 24);
}

#[test]
fn options_that_do_not_fit_are_refused() {
    let bench = bench_with_recording();
    let pair = Pair::shifted(96, 24, 5);
    pair.write(&bench);
    bench.succeeds("record left.png right.png -o d.raw --wiring line");
    let cases: [(&str, &[&str]); 15] = [
        ("record left.png right.png -o e.raw", &["--wiring", "nibble"]),
        ("record left.png right.png -o e.raw --wiring frame", &["frame", "side-by-side"]),
        ("record left.png right.png -o e.raw --wiring line --skew left", &["--skew left", "--wiring pixel"]),
        ("record left.png right.png --recording take -o e.raw --wiring line", &["--recording"]),
        ("record left.png right.png -o left.png --wiring line", &["left.png", "one of the files that are read"]),
        ("record left.png right.png -o no/e.raw --wiring line", &["no/e.raw"]),
        ("record left.png none.png -o e.raw --wiring line", &["none.png"]),
        ("record --recording none -o e.raw --wiring line", &["none", "no such folder"]),
        ("record --recording take -o e.raw --wiring line --frames 2..", &["--frames 2..", "2 frames"]),
        ("play d.raw --raw 96x24 -o out", &["--wiring"]),
        ("play d.raw --raw 96by24 --wiring line -o out", &["--raw", "WIDTHxHEIGHT"]),
        ("play d.raw --raw 96x24 --wiring line --layout folders -o out", &["--raw", "--layout"]),
        ("play none.raw --raw 96x24 --wiring line -o out", &["none.raw"]),
        ("play take --raw 96x24 --wiring line -o out", &["take", "folder"]),
        ("play take --wiring line -o out", &["--wiring", "--raw"]),
    ];
    for (line, told) in cases {
        bench.refuses(line, told);
    }
    bench.refuses("play take --skew left -o out", &["--skew"]);
}
