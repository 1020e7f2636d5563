//! `haarline rig`, and what `--rig` does.

use image::ImageFormat;

use crate::files::{Map, encode, png};
use crate::scene::{HEIGHT, Pair, WIDTH, bench_with_plane};
use crate::tool::Bench;

/// Makes `rig.toml` for pairs of the usual size, 100 px and 60 mm, with some lines changed.
fn write_rig(bench: &Bench, changes: &[(&str, &str)]) {
    bench.succeeds("rig new made.toml");
    let size = [("width", WIDTH.to_string()), ("height", HEIGHT.to_string())];
    let usual = [("focal_px", "100.0"), ("num_disparities", "16"), ("lowest_mm", "-500"), ("sector_deg", "10")];
    let value = |key: &str| {
        let own = size.iter().map(|(name, value)| (*name, value.as_str()));
        let mut all = changes.iter().copied().chain(usual).chain(own);
        all.find(|(name, _)| *name == key).map(|(_, value)| value.to_owned())
    };
    let line = |line: &str| match line.split_once(" = ") {
        Some((key, old)) if !line.starts_with('#') => format!("{key} = {}\n", value(key).unwrap_or(old.to_owned())),
        _ => format!("{line}\n"),
    };
    let template = String::from_utf8(bench.read("made.toml")).unwrap();
    std::fs::remove_file(bench.path("made.toml")).unwrap();
    bench.write("rig.toml", template.lines().map(line).collect::<String>());
}

fn lines(bench: &Bench, name: &str) -> Vec<String> {
    String::from_utf8(bench.read(name)).unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn a_new_description_can_be_shown_and_is_not_replaced() {
    let bench = Bench::new();
    let told = bench.succeeds("rig new rig.toml").stdout;
    assert!(told.contains("haarline rig show rig.toml"), "{told}");
    let told = bench.succeeds("rig show rig.toml").stdout;
    for words in ["200 px", "60 mm", "77.3 x 61.9 degrees", "nearest depth", "0.255 m", "at 5 m"] {
        assert!(told.contains(words), "no {words} in {told}");
    }
    let json = bench.succeeds("rig show rig.toml --json").json();
    assert_eq!((&json["one_px_m"], &json["sectors"], &json["wiring"]), (&12.0.into(), &17.into(), &"pixel".into()));
    bench.refuses("rig new rig.toml", &["rig.toml", "not replaced"]);
    bench.refuses("rig new none/rig.toml", &["none"]);
}

#[test]
fn a_wrong_description_is_refused_with_the_field() {
    let bench = bench_with_plane(6);
    write_rig(&bench, &[("focal_px", "-3")]);
    let told = ["rig.toml", "focal_px = -3", "10 to 10000 px"];
    bench.refuses("rig show rig.toml", &told);
    bench.refuses("depth left.png right.png --rig rig.toml", &told);
    bench.write("rig.toml", "width = 96\nzoom = 3\n");
    bench.refuses("rig show rig.toml", &["zoom", "no such field", "wiring, first, skew"]);
    bench.refuses("rig show none.toml", &["none.toml", "cannot be read"]);
}

#[test]
fn depth_takes_the_rigs_values_unless_options_tell_others() {
    let bench = bench_with_plane(6);
    write_rig(&bench, &[]);
    let plain =
        bench.succeeds("depth left.png right.png -o a.pfm --num-disparities 16 --focal-px 100 --baseline-mm 60");
    let rig = bench.succeeds("depth left.png right.png -o b.pfm --rig rig.toml --json").json();
    assert!(bench.read("a.pfm") == bench.read("b.pfm") && plain.stdout.contains("depth"));
    assert_eq!(
        (&rig["num_disparities"], &rig["focal_px"], &rig["median_depth_mm"]),
        (&16.into(), &100.0.into(), &1000.into())
    );
    let told =
        bench.succeeds("depth left.png right.png --rig rig.toml --num-disparities 8 --focal-px 200 --json").json();
    assert_eq!(
        (&told["num_disparities"], &told["focal_px"], &told["baseline_mm"]),
        (&8.into(), &200.0.into(), &60.0.into())
    );
    bench.refuses("depth left.png right.png --rig rig.toml --num-disparities 400", &["--num-disparities"]);
    bench.refuses("depth left.png right.png --rig rig.toml --baseline-mm 0", &["--baseline-mm"]);
    bench.refuses("depth left.png right.png --obstacles o.csv", &["--rig"]);
    write_rig(&bench, &[("height", "48")]);
    bench.refuses("depth left.png right.png --rig rig.toml", &["96x48 px", "96x40 px"]);
}

#[test]
fn obstacles_are_written_and_drawn() {
    let bench = bench_with_plane(6);
    write_rig(&bench, &[]);
    bench.succeeds("depth left.png right.png --rig rig.toml --obstacles o.csv --picture with.png --method lite");
    bench.succeeds("depth left.png right.png --num-disparities 16 --picture without.png --method lite");
    let lines = lines(&bench, "o.csv");
    assert_eq!(lines[0], "frame,-30,-20,-10,0,10,20,30");
    // A plane at 1 m; its left border is hidden from the right camera.
    let cm: Vec<&str> = lines[1].split(',').collect();
    for (field, wanted) in cm[2..6].iter().zip([106, 101, 100, 101]) {
        let found: i32 = field.parse().unwrap();
        assert!((found - wanted).abs() <= 6, "{}", lines[1]);
    }
    let heights = ["with.png", "without.png"].map(|name| png(&bench.read(name)).height());
    assert!(heights[0] >= u32::try_from(HEIGHT).unwrap() + 26 && heights[1] >= 40, "{heights:?}");
    assert!(bench.read("with.png") != bench.read("without.png"));
}

/// A recording whose second frame is no image; the right view lies `down` rows lower and `right` columns
/// further right than it should.
fn record(bench: &Bench, down: usize, right: usize) {
    let pair = Pair::shifted(WIDTH, HEIGHT, 6);
    let mut displaced = pair.clone();
    for (index, pixel) in displaced.right.iter_mut().enumerate() {
        let (x, y) = (index % WIDTH, index / WIDTH);
        *pixel = pair.right[y.saturating_sub(down) * WIDTH + x.saturating_sub(right)];
    }
    bench.write("take/left/a.png", encode(&pair.left_image(), ImageFormat::Png));
    bench.write("take/right/a.png", encode(&displaced.right_image(), ImageFormat::Png));
    pair.write(bench);
}

#[test]
fn play_takes_the_cameras_displacement_away() {
    let bench = Bench::new();
    record(&bench, 3, 2);
    write_rig(&bench, &[("row_offset", "3"), ("column_offset", "2")]);
    bench.succeeds("depth left.png right.png -o straight.pfm --num-disparities 16");
    bench.succeeds("play take -o out --rig rig.toml");
    let told = bench.succeeds_on_odd_views("play take -o blind --num-disparities 16").stderr;
    assert!(told.contains("do not match"), "{told}");
    let map = |name: &str| Map::from_pfm(&bench.read(name)).px;
    let (straight, paired) = (map("straight.pfm"), map("out/a.pfm"));
    // Rows and columns far enough from what the displacement cost at the bottom and at the right.
    let inside = (0..HEIGHT - 16).flat_map(|y| (8..WIDTH - 16).map(move |x| y * WIDTH + x));
    let right = |map: &[f32]| inside.clone().filter(|&i| (map[i] - 6.0).abs() <= 0.5).count();
    let all = inside.clone().count();
    assert!(right(&straight) * 100 > all * 95, "{} of {all}", right(&straight));
    assert!(right(&paired) * 100 > all * 95, "{} of {all}", right(&paired));
    assert!(right(&map("blind/a.pfm")) * 100 < all * 20);
    assert!(paired[(HEIGHT - 3) * WIDTH..].iter().all(|px| px.is_infinite()), "rows without a partner are unknown");
}

#[test]
fn play_writes_obstacles_a_line_a_frame_and_mavlink() {
    let bench = Bench::new();
    record(&bench, 0, 0);
    bench.write("take/left/b.png", b"no image");
    bench.write("take/right/b.png", b"no image");
    write_rig(&bench, &[]);
    let outcome = bench.run("play take -o out --rig rig.toml --mavlink m.bin");
    assert_eq!(outcome.status, 1, "{outcome:?}");
    assert!(outcome.stdout.contains("obstacles.csv"), "{outcome:?}");
    let lines = lines(&bench, "out/obstacles.csv");
    assert_eq!((lines.len(), lines[2].as_str()), (3, "1,,,,,,,"));
    assert!(lines[1].starts_with("0,") && lines[1] != "0,,,,,,,");
    // A heartbeat, and the distances of the one frame: 12 bytes around 9 and 167.
    let bytes = bench.read("m.bin");
    assert_eq!((bytes.len(), bytes[0], bytes[21]), (21 + 179, 0xFD, 0xFD));
    bench.refuses("play take -o other --mavlink m.bin", &["--rig"]);
    bench.refuses("play take -o other --rig rig.toml --mavlink no/m.bin", &["no/m.bin"]);
}

#[test]
fn a_raw_dump_has_the_rigs_wiring_unless_options_tell_another() {
    let bench = Bench::new();
    record(&bench, 0, 0);
    write_rig(&bench, &[("wiring", "\"line\""), ("first", "\"right\"")]);
    bench.succeeds("record --recording take -o line.raw --wiring line --first right");
    bench.succeeds("record --recording take -o pixel.raw --wiring pixel --first right");
    bench.succeeds("play take -o source --rig rig.toml");
    bench.succeeds("play line.raw --raw 96x40 -o line --rig rig.toml");
    bench.succeeds("play pixel.raw --raw 96x40 --wiring pixel -o pixel --rig rig.toml");
    for played in ["line", "pixel"] {
        assert!(bench.read("source/a.pfm") == bench.read(&format!("{played}/000000.pfm")), "{played}");
    }
    bench.refuses("play line.raw --raw 96x20 -o other --rig rig.toml", &["96x40 px", "96x20 px"]);
    bench.refuses("play line.raw --raw 96x40 --skew left -o other --rig rig.toml", &["--skew left"]);
}
