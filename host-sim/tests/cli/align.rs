//! `haarline align`: a rig's offset found, told and written.

use image::ImageFormat;

use crate::files::{encode, png};
use crate::scene::{HEIGHT, Pair, WIDTH};
use crate::tool::Bench;

/// A recording of one frame of which the right view lies `down` rows lower.
fn record(bench: &Bench, down: usize) {
    record_frame(bench, "a", down);
}

fn record_frame(bench: &Bench, name: &str, down: usize) {
    let pair = Pair::shifted(WIDTH, HEIGHT, 6);
    let mut displaced = pair.clone();
    for (index, pixel) in displaced.right.iter_mut().enumerate() {
        let (x, y) = (index % WIDTH, index / WIDTH);
        *pixel = pair.right[y.saturating_sub(down) * WIDTH + x];
    }
    bench.write(&format!("take/left/{name}.png"), encode(&pair.left_image(), ImageFormat::Png));
    bench.write(&format!("take/right/{name}.png"), encode(&displaced.right_image(), ImageFormat::Png));
}

#[test]
fn the_row_offset_is_told_and_written() {
    let bench = Bench::new();
    record(&bench, 3);
    let json = bench.succeeds("align take --json").json();
    let rows = json["row_offset"].as_f64().unwrap();
    assert!((rows - 3.0).abs() < 0.1 && json["verdict"] == "observable", "{json}");
    let told = bench.succeeds("align take -o rig.toml --picture rows.png").stdout;
    assert!(told.contains("rows lower") && told.contains("fill them in"), "{told}");
    let picture = png(&bench.read("rows.png"));
    assert!(picture.width() as usize >= 2 * WIDTH && picture.height() as usize >= 2 * HEIGHT);
    let shown = bench.succeeds("rig show rig.toml --json").json();
    assert!((shown["row_offset"].as_f64().unwrap() - rows).abs() < 0.001, "{shown}");
    assert_eq!((&shown["width"], &shown["height"]), (&WIDTH.into(), &HEIGHT.into()));
}

#[test]
fn a_description_is_changed_only_when_asked_and_kept() {
    let bench = Bench::new();
    record(&bench, 2);
    bench.refuses("align take -o rig.toml --update", &["rig.toml", "leave --update out"]);
    bench.succeeds("align take -o rig.toml");
    bench.refuses("align take -o rig.toml", &["the file is there", "--update"]);
    let first = String::from_utf8(bench.read("rig.toml")).unwrap();
    let text = first
        .replace("focal_px = 200.0", "focal_px = 123.0  # measured")
        .replace("row_offset = ", "row_offset = 5.5 # ");
    bench.write("rig.toml", &text);
    let told = bench.succeeds("align take -o rig.toml --update").stdout;
    assert!(told.contains("was 5.5") && told.contains("rig.toml.bak"), "{told}");
    assert_eq!(String::from_utf8(bench.read("rig.toml.bak")).unwrap(), text);
    let now = String::from_utf8(bench.read("rig.toml")).unwrap();
    assert!(now.contains("focal_px = 123.0  # measured"), "{now}");
    bench.write("rig.toml", "row_offset = 1\n");
    bench.refuses("align take -o rig.toml --update", &["rig.toml", "is missing"]);
    // Of another size, and one that lens tables bring together.
    let other = text.replace(&format!("width = {WIDTH}"), "width = 640");
    bench.write("rig.toml", &other);
    bench.refuses("align take -o rig.toml --update", &["640x", "but the views are"]);
    let mut lenses = text.replace("row_offset = 5.5 # ", "row_offset = 0.0 # ");
    for camera in ["left", "right"] {
        for (key, value) in
            [("camera", "[200.0, 200.0, 80.0, 60.0]"), ("lens", "[0.0, 0.0]"), ("turn", "[0.0, 0.0, 0.0]")]
        {
            lenses = lenses.replace(&format!("# {camera}_{key} ="), &format!("{camera}_{key} = {value}"));
        }
    }
    bench.write("rig.toml", lenses);
    bench.refuses("align take -o rig.toml --update", &["its lens tables tell where rows lie"]);
    assert_eq!(bench.read("rig.toml.bak"), text.as_bytes());
}

#[test]
fn the_description_that_is_changed_tells_the_wiring_and_the_first_camera() {
    let bench = Bench::new();
    record(&bench, 2);
    let size = [("width", WIDTH), ("height", HEIGHT), ("num_disparities", 16)];
    crate::overwrite::write_rig(&bench, &size);
    let text = String::from_utf8(bench.read("rig.toml")).unwrap();
    let wired =
        text.replace("wiring = \"pixel\"", "wiring = \"nibble\"").replace("first = \"left\"", "first = \"right\"");
    assert!(wired.contains("\"nibble\"") && wired.contains("first = \"right\""), "{text}");
    bench.write("rig.toml", &wired);
    bench.succeeds("record --recording take --rig rig.toml -o take.raw");
    bench.succeeds("record --recording take --wiring nibble --first right -o told.raw");
    assert!(bench.read("take.raw") == bench.read("told.raw"));
    let raw = format!("take.raw --raw {WIDTH}x{HEIGHT}");
    bench.refuses(&format!("align {raw}"), &["--wiring"]);
    bench.succeeds(&format!("align {raw} -o rig.toml --update"));
    let rows = bench.succeeds("rig show rig.toml --json").json()["row_offset"].as_f64().unwrap();
    assert!((rows - 2.0).abs() < 0.1, "{rows}");
    let patterns = "align take --left l*/*.png --right r*/*.png --json";
    assert!((bench.succeeds(patterns).json()["row_offset"].as_f64().unwrap() - 2.0).abs() < 0.1);
}

#[test]
fn what_does_not_show_it_is_not_observable() {
    let bench = Bench::new();
    let flat =
        Pair { left: vec![90; WIDTH * HEIGHT], right: vec![90; WIDTH * HEIGHT], ..Pair::shifted(WIDTH, HEIGHT, 0) };
    bench.write("take/left/a.png", encode(&flat.left_image(), ImageFormat::Png));
    bench.write("take/right/a.png", encode(&flat.right_image(), ImageFormat::Png));
    let outcome = bench.run("align take -o rig.toml");
    assert_eq!(outcome.status, 1, "{outcome:?}");
    assert!(outcome.stderr.contains("not observable") && outcome.stderr.lines().count() == 1, "{outcome:?}");
    assert!(!bench.path("rig.toml").exists());
}

#[test]
fn the_first_camera_is_written_and_one_image_twice_is_refused() {
    let bench = Bench::new();
    let pair = Pair::shifted(WIDTH, HEIGHT, 6);
    let both: Vec<u8> = pair
        .right
        .chunks(WIDTH)
        .zip(pair.left.chunks(WIDTH))
        .flat_map(|(right, left)| [right, left].concat())
        .collect();
    let image = image::GrayImage::from_raw(2 * WIDTH as u32, HEIGHT as u32, both).unwrap();
    bench.write("both/a.png", encode(&image.into(), ImageFormat::Png));
    bench.succeeds("align both --layout side-by-side --first right -o rig.toml");
    assert_eq!(bench.succeeds("rig show rig.toml --json").json()["first"], "right");
    let told = bench.run("rig check both --layout side-by-side --rig rig.toml -o page.html").stdout;
    assert!(!told.contains("swapped"), "{told}");

    bench.write("same/left/a.png", encode(&pair.left_image(), ImageFormat::Png));
    bench.write("same/right/a.png", encode(&pair.left_image(), ImageFormat::Png));
    let refused = bench.run("align same -o same.toml");
    assert!(
        refused.status == 1 && refused.stderr.contains("in 1 of 1 frames both views are the same image"),
        "{refused:?}"
    );
    assert!(!bench.path("same.toml").exists());
}

#[test]
fn views_of_different_moments_are_contradictory() {
    let bench = Bench::new();
    for (name, down) in [("a", 2), ("b", 3), ("c", 2)] {
        record_frame(&bench, name, down);
    }
    let refused = bench.run("align take -o rig.toml");
    assert_eq!(refused.status, 1);
    assert!(refused.stdout.contains("row offset contradictory"), "{}", refused.stdout);
    assert!(
        refused.stderr.contains("frames differ by 0.") && refused.stderr.contains("at one moment"),
        "{}",
        refused.stderr
    );
    assert!(!bench.path("rig.toml").exists());
    let json = bench.run("align take --json").json();
    assert!(json["verdict"] == "contradictory" && json["spread"].as_f64().unwrap() > 0.2, "{json}");
}

#[test]
fn wrong_recordings_and_names_are_refused() {
    let bench = Bench::new();
    record(&bench, 0);
    bench.refuses("align none", &["none", "no such folder"]);
    bench.refuses("align take --picture take/left/b.png", &["--picture", "lies in the recording"]);
    bench.refuses("align take --update", &["--output"]);
    bench.refuses("align take --frames 4..", &["1 frames only"]);
    bench.write("take/left/b.png", b"no image");
    bench.write("take/right/b.png", b"no image");
    let outcome = bench.run("align take --json");
    assert_eq!((outcome.status, outcome.json()["damaged"].as_i64()), (0, Some(1)));
    assert_eq!(outcome.stderr.matches("skipped").count(), 1, "{outcome:?}");
}

#[test]
fn where_no_frame_can_be_read_each_is_told_once() {
    let bench = Bench::new();
    for (name, width) in [("a", 65), ("b", 66)] {
        let [left, right] = ["left", "right"].map(|side| format!("take/{side}/{name}.png"));
        Pair::shifted(64, 16, 4).write_as(&bench, &left, "other.png");
        Pair::shifted(width, 16, 4).write_as(&bench, "other.png", &right);
    }
    for (line, frames) in [("align take --frames 1..", &["b"][..]), ("align take", &["a", "b"])] {
        let outcome = bench.run(line);
        assert_eq!((outcome.status, outcome.stderr.lines().count()), (2, frames.len()), "{outcome:?}");
        assert!(outcome.stderr.lines().last().unwrap().starts_with("error: no frame can be read: "), "{outcome:?}");
        for frame in frames {
            assert_eq!(outcome.stderr.matches(&format!("take/left/{frame}.png is 64x16 px")).count(), 1, "{outcome:?}");
        }
    }
}
