//! `haarline rig check`: a rig held against its description by what it sees.

use image::ImageFormat;

use crate::files::encode;
use crate::overwrite::write_rig;
use crate::scene::{HEIGHT, Pair, WIDTH};
use crate::tool::Bench;

/// A recording of two frames of a plane of 6 px whose right view lies `down` rows lower, and a description without offsets.
fn record(bench: &Bench, down: usize) {
    let pair = Pair::shifted(WIDTH, HEIGHT, 6);
    let mut displaced = pair.clone();
    for (index, pixel) in displaced.right.iter_mut().enumerate() {
        *pixel = pair.right[(index / WIDTH).saturating_sub(down) * WIDTH + index % WIDTH];
    }
    for name in ["a", "b"] {
        bench.write(&format!("take/left/{name}.png"), encode(&pair.left_image(), ImageFormat::Png));
        bench.write(&format!("take/right/{name}.png"), encode(&displaced.right_image(), ImageFormat::Png));
    }
    write_rig(bench, &[("width", WIDTH), ("height", HEIGHT), ("num_disparities", 16), ("focal_px", 100)]);
}

#[test]
fn a_rig_as_described_has_a_page_without_a_finding() {
    let bench = Bench::new();
    record(&bench, 0);
    let told = bench.succeeds("rig check take --rig rig.toml -o check.html").stdout;
    assert!(told.contains("nothing to turn, swap or calibrate") && told.contains("check.html"), "{told}");
    let page = String::from_utf8(bench.read("check.html")).unwrap();
    for words in ["Nothing to turn", "data:image/png;base64,", "<svg", "Row error", "Left-right agreement", "infinity"]
    {
        assert!(page.contains(words), "{words}");
    }
    for words in ["<script", "https:", "url("] {
        assert!(!page.contains(words), "{words}");
    }
    let json = bench.succeeds("rig check take --rig rig.toml -o check.html --json").json();
    assert!(json["row_error"].as_f64().unwrap().abs() < 0.1 && json["advice"].as_array().unwrap().is_empty(), "{json}");
    assert!((json["far_px"].as_f64().unwrap() - 6.0).abs() < 0.3, "{json}");
    assert!(
        json["agreement_percent"].as_f64().unwrap() > 90.0 && json["sure_percent"].as_f64().unwrap() > 50.0,
        "{json}"
    );
}

#[test]
fn rows_that_are_off_and_what_is_farther_than_infinity_are_told() {
    let bench = Bench::new();
    record(&bench, 2);
    let outcome = bench.run("rig check take --rig rig.toml -o check.html");
    assert_eq!(outcome.status, 1, "{outcome:?}");
    for words in ["- rows are up to 2.", "haarline align", "tilt the right camera down"] {
        assert!(outcome.stdout.contains(words), "{words}: {outcome:?}");
    }
    assert_eq!(outcome.stdout.matches("\n- ").count(), 1, "what only follows is not told: {outcome:?}");
    let bench = Bench::new();
    record(&bench, 0);
    let text = String::from_utf8(bench.read("rig.toml")).unwrap();
    let offset =
        text.lines().find(|line| line.starts_with("column_offset = ")).expect("the template has it").to_owned();
    bench.write("rig.toml", text.replace(&offset, "column_offset = -9"));
    let outcome = bench.run("rig check take --rig rig.toml -o check.html");
    let words = "farther than infinity: add 4 or more";
    assert!(outcome.status == 1 && outcome.stdout.contains(words), "{outcome:?}");
}

#[test]
fn what_cannot_be_checked_is_refused_in_one_line() {
    let bench = Bench::new();
    record(&bench, 0);
    bench.refuses("rig check take --rig rig.toml -o check.txt", &["check.txt", "must end in .html"]);
    bench.refuses("rig check take --rig none.toml -o check.html", &["none.toml"]);
    bench.refuses("rig check none --rig rig.toml -o check.html", &["none", "no such folder"]);
    let bench = Bench::new();
    record(&bench, 0);
    let text = String::from_utf8(bench.read("rig.toml")).unwrap();
    bench.write("rig.toml", text.replace(&format!("width = {WIDTH}"), &format!("width = {}", WIDTH + 4)));
    bench.refuses("rig check take --rig rig.toml -o check.html", &["but the views are"]);
    bench.write("rig.toml", text);
    let blank = Pair::blank(WIDTH, HEIGHT);
    for side in ["left", "right"] {
        bench.write(&format!("blank/{side}/a.png"), encode(&blank.left_image(), ImageFormat::Png));
    }
    let outcome = bench.run("rig check blank --rig rig.toml -o check.html");
    assert!(outcome.status == 1 && outcome.stdout.contains("- 1 of 1 frames: nothing-seen"), "{outcome:?}");
}
