//! `haarline rig correct` and `haarline rig rectify`.

use image::ImageFormat;

use crate::files::{encode, png};
use crate::overwrite::write_rig;
use crate::scene::{HEIGHT, Pair, WIDTH};
use crate::tool::Bench;

/// A recording of three frames of a plane of 6 px, and a rig of 100 px and 60 mm: 6 px are 1 m.
fn record(bench: &Bench) {
    let pair = Pair::shifted(WIDTH, HEIGHT, 6);
    for name in ["a", "b", "c"] {
        bench.write(&format!("take/left/{name}.png"), encode(&pair.left_image(), ImageFormat::Png));
        bench.write(&format!("take/right/{name}.png"), encode(&pair.right_image(), ImageFormat::Png));
    }
    write_rig(bench, &[("width", WIDTH), ("height", HEIGHT), ("num_disparities", 16), ("focal_px", 100)]);
}

#[test]
fn what_a_plane_shows_is_told_and_written_when_asked() {
    let bench = Bench::new();
    record(&bench);
    let before = bench.read("rig.toml");
    let told = bench.succeeds("rig correct take --rig rig.toml --depth-m 0.96").stdout;
    assert!(told.contains("disparity_correction = [[") && told.contains("nothing was written"), "{told}");
    assert_eq!(bench.read("rig.toml"), before);

    let planes = "frame,depth_m,first_column,last_column\n0,0.96,,\n2,0.96,-9,200\n";
    bench.write("planes.csv", planes);
    let json = bench.succeeds("rig correct take --rig rig.toml --planes planes.csv --update --json").json();
    assert_eq!(json["frames"], 2);
    // Beside the borders it rests on few answers.
    for node in &json["disparity_correction"][0].as_array().unwrap()[2..7] {
        assert!((node.as_f64().unwrap() - 0.25).abs() < 0.08, "{json}");
    }
    assert_eq!(bench.read("rig.toml.bak"), before);
    // What is corrected already is measured without that.
    let again = bench.succeeds("rig correct take --rig rig.toml --depth-m 0.96 --json").json();
    assert!((again["error_px"][0].as_f64().unwrap() - 0.25).abs() < 0.08, "{again}");
}

#[test]
fn what_makes_no_correction_is_refused() {
    let bench = Bench::new();
    record(&bench);
    bench.refuses("rig correct take --rig rig.toml", &["--depth-m"]);
    bench.refuses("rig correct take --rig rig.toml --depth-m nan", &["--depth-m", "0.05 to 1000 m"]);
    bench.refuses("rig correct take --rig none.toml --depth-m 1", &["none.toml", "rig description"]);
    bench.refuses("rig correct none --rig rig.toml --depth-m 1", &["none", "no such folder"]);
    bench.write("planes.csv", "depth\n1\n");
    bench.refuses("rig correct take --rig rig.toml --planes planes.csv", &["planes.csv", "no column depth_m"]);
    bench.refuses("rig correct take take --rig rig.toml --planes planes.csv", &["1 tables of 2 recordings"]);
    let blank = Pair::blank(WIDTH, HEIGHT);
    for side in ["left", "right"] {
        bench.write(&format!("blank/{side}/a.png"), encode(&blank.left_image(), ImageFormat::Png));
    }
    let outcome = bench.run("rig correct blank --rig rig.toml --depth-m 1 --update");
    assert!(outcome.status == 1 && outcome.stderr.contains("not observable"), "{outcome:?}");
    assert!(!bench.path("rig.toml.bak").exists());
}

#[test]
fn rectified_views_are_written_beside_the_recording_only() {
    let bench = Bench::new();
    record(&bench);
    write_rig_with_offset(&bench, "2.0");
    let told = bench.succeeds("rig rectify take --rig rig.toml -o straight").stdout;
    assert!(told.contains("3 pairs in straight"), "{told}");
    let (raw, made) =
        (png(&bench.read("take/right/a.png")).to_luma8(), png(&bench.read("straight/right/a.png")).to_luma8());
    assert!((0..WIDTH as u32).all(|x| (0..HEIGHT as u32 - 2).all(|y| made.get_pixel(x, y) == raw.get_pixel(x, y + 2))));
    assert!((0..WIDTH as u32).all(|x| made.get_pixel(x, HEIGHT as u32 - 1).0 == [0]));
    bench.refuses("rig rectify take --rig rig.toml -o take", &["-o take"]);
}

fn write_rig_with_offset(bench: &Bench, rows: &str) {
    let text = String::from_utf8(bench.read("rig.toml")).unwrap();
    bench.write("rig.toml", text.replace("row_offset = 0.0", &format!("row_offset = {rows}")));
}
