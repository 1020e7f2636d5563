//! Wrong scenes, options and outputs of `eval`: refused, and no file touched.

use std::fs;

use image::ImageFormat;
use serde_json::json;

use crate::files::encode;
use crate::scene::{HEIGHT, Scene, WIDTH, bench_with_plane, bench_with_scenes, grey_image, grey16_image};
use crate::tool::Bench;

#[test]
fn folders_that_are_no_scenes() {
    let bench = bench_with_plane(4);
    fs::create_dir_all(bench.path("hollow/deep")).unwrap();
    bench.write("notes/list.txt", "none");
    bench.refuses("eval missing", &["missing", "no such folder"]);
    bench.refuses("eval left.png", &["left.png", "is a file"]);
    bench.refuses("eval hollow", &["hollow", "no scene", "truth.png"]);
    bench.refuses("eval notes", &["notes", "no scene"]);
    bench.refuses("eval hollow --json report.json", &["hollow", "no scene"]);
}

#[test]
fn scenes_without_one_of_their_files() {
    for file in ["left.png", "right.png", "truth.png", "nonocc.png", "meta.json"] {
        let bench = bench_with_scenes();
        fs::remove_file(bench.path("scenes/bench").join(file)).unwrap();
        bench.refuses("eval scenes --json report.json", &[&format!("scenes/bench/{file}"), "missing"]);
        bench.refuses("eval scenes/bench", &[&format!("scenes/bench/{file}"), "missing"]);
        bench.succeeds("eval scenes --only alcove --method lite");
        fs::create_dir(bench.path("scenes/bench").join(file)).unwrap();
        bench.refuses("eval scenes", &[&format!("scenes/bench/{file}")]);
    }
}

/// A bench with one scene in `s/alcove`, in which `change` changed a file.
fn bench_with_changed(file: &str, change: impl FnOnce(&Scene, Vec<u8>) -> Vec<u8>) -> Bench {
    let (bench, scene) = (Bench::new(), Scene::new("alcove", "indoor", [WIDTH, HEIGHT], [3, 9]));
    scene.write(&bench, "s");
    let name = format!("s/alcove/{file}");
    let bytes = change(&scene, bench.read(&name));
    bench.write(&name, bytes);
    bench
}

#[test]
fn scenes_with_a_damaged_image() {
    for file in ["left.png", "right.png", "truth.png", "nonocc.png"] {
        let name = format!("s/alcove/{file}");
        for length in [0, 5, 40, 300] {
            let bench = bench_with_changed(file, |_, bytes| bytes[..length.min(bytes.len() - 20)].to_vec());
            bench.refuses("eval s", &[&name]);
        }
        let bench = bench_with_changed(file, |_, _| b"no image".to_vec());
        bench.refuses("eval s", &[&name, "is no PNG"]);
    }
}

#[test]
fn scenes_with_images_of_different_sizes() {
    let sizes = [[WIDTH, HEIGHT - 1], [WIDTH + 4, HEIGHT], [HEIGHT, WIDTH]];
    for [width, height] in sizes {
        let (other, size) = (vec![255; width * height], format!("{width}x{height}"));
        let grey = encode(&grey_image(width, height, &other), ImageFormat::Png);
        let wide: Vec<u16> = other.iter().map(|&value| value.into()).collect();
        let wide = encode(&grey16_image(width, height, &wide), ImageFormat::Png);
        for (file, bytes) in [("left.png", &grey), ("right.png", &grey), ("nonocc.png", &grey), ("truth.png", &wide)] {
            let bench = bench_with_changed(file, |_, _| bytes.clone());
            bench.refuses("eval s --json report.json", &[&format!("s/alcove/{file}"), &size, "96x40", "same size"]);
        }
    }
}

#[test]
fn scenes_with_truth_or_mask_of_the_wrong_depth() {
    let bench = bench_with_changed("truth.png", |scene, _| encode(&scene.pair.left_image(), ImageFormat::Png));
    bench.refuses("eval s", &["s/alcove/truth.png", "16 bits"]);
    let wide = |scene: &Scene, _| encode(&grey16_image(WIDTH, HEIGHT, &scene.truth), ImageFormat::Png);
    bench_with_changed("nonocc.png", wide).refuses("eval s", &["s/alcove/nonocc.png", "8 bits"]);
}

#[test]
fn scenes_with_nothing_to_score() {
    let zeros = |_: &Scene, _| encode(&grey16_image(WIDTH, HEIGHT, &[0; WIDTH * HEIGHT]), ImageFormat::Png);
    bench_with_changed("truth.png", zeros).refuses("eval s", &["s/alcove", "true disparity"]);
    let hidden = |_: &Scene, _| encode(&grey_image(WIDTH, HEIGHT, &[254; WIDTH * HEIGHT]), ImageFormat::Png);
    bench_with_changed("nonocc.png", hidden).refuses("eval s", &["s/alcove", "seen by both"]);
    let all = |_: &Scene, _| json!({ "num_disparities": WIDTH }).to_string().into_bytes();
    bench_with_changed("meta.json", all).refuses("eval s", &["s/alcove", "96"]);
}

#[test]
fn scenes_with_a_broken_meta() {
    let texts = [
        "",
        "no JSON",
        "[]",
        "{}",
        "{\"num_disparities\": 16",
        "{\"num_disparities\": \"16\"}",
        "{\"num_disparities\": 16.5}",
        "{\"num_disparities\": -16}",
        "{\"num_disparities\": 65552}",
        "{\"num_disparities\": null}",
        "{\"num_disparities\": 0}",
        "{\"num_disparities\": 97}",
        "{\"num_disparities\": 257}",
    ];
    for text in texts {
        let bench = bench_with_changed("meta.json", |_, _| text.as_bytes().to_vec());
        bench.refuses("eval s --json report.json", &["s/alcove/meta.json", "num_disparities"]);
    }
    let bench = bench_with_changed("meta.json", |_, _| vec![0xff, 0xfe, 0x00]);
    bench.refuses("eval s", &["s/alcove/meta.json"]);
}

#[test]
fn options_of_eval_out_of_range() {
    let bench = bench_with_scenes();
    let cases = [
        ("--noise -1", "0 to 255"),
        ("--noise NaN", "0 to 255"),
        ("--noise inf", "0 to 255"),
        ("--noise 256", "0 to 255"),
        ("--noise loud", "number"),
        ("--gain -0.5", "0 to 255"),
        ("--gain NaN", "0 to 255"),
        ("--gain inf", "0 to 255"),
        ("--gain x", "number"),
        ("--offset NaN", "-255 to 255"),
        ("--offset=-inf", "-255 to 255"),
        ("--offset 1e9", "-255 to 255"),
        ("--offset x", "number"),
        ("--both-gain -1", "0 to 255"),
        ("--both-gain NaN", "0 to 255"),
        ("--seed -1", "0 or more"),
        ("--seed 1.5", "whole number"),
        ("--seed x", "whole number"),
        ("--only attic", "attic"),
        ("--only alcove,attic", "attic"),
        ("--only alcov", "alcove"),
        ("--only ALCOVE", "alcove"),
        ("--fail-over tot2", "KEY=VALUE"),
        ("--fail-over tot3=1", "tot3"),
        ("--fail-over tot2=", "no number"),
        ("--fail-over tot2=NaN", "no number"),
        ("--fail-over =1", "density"),
        ("--fail-over", "--fail-over"),
    ];
    for (options, told) in cases {
        let option = options.split([' ', '=']).next().unwrap();
        bench.refuses(&format!("eval scenes --json report.json {options}"), &[option, told]);
    }
}

#[test]
fn outputs_of_eval_that_cannot_be_written() {
    let bench = bench_with_scenes();
    fs::create_dir(bench.path("folder.json")).unwrap();
    bench.write("file", "a file");
    let cases = [("--json", "missing/report.json"), ("--json", "folder.json"), ("-o", "file"), ("-o", "file/maps")];
    for (option, name) in cases {
        bench.refuses(&format!("eval scenes {option} {name}"), &[option, name]);
    }
    for name in ["file", "file/room"] {
        bench.refuses(&format!("demo -o {name}"), &["-o", name]);
    }
}

#[test]
fn baselines_that_are_none() {
    let bench = bench_with_scenes();
    bench.write("empty.json", "");
    bench.write("other.json", "{\"mean\": 3}");
    bench.write("list.json", "[1, 2]");
    for name in ["missing.json", "empty.json", "other.json", "list.json", "scenes"] {
        bench.refuses(&format!("eval scenes --baselines {name} --json report.json"), &[name]);
    }
    bench.write("scenes/baselines.json", "broken");
    bench.refuses("eval scenes", &["baselines.json"]);
}
