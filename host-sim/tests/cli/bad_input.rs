//! Wrong input: one line on the standard error that names what is wrong, exit status 2, and no file touched.

use std::fs;
use std::process::Stdio;

use image::ImageFormat;
use serde_json::json;

use crate::files::{encode, resized_png};
use crate::scene::{HEIGHT, Pair, Scene, WIDTH, bench_with_plane, bench_with_scenes, grey_image, grey16_image};
use crate::tool::{Bench, assert_one_error_line, assert_refused};

/// `depth left.png right.png OPTIONS -o map.pfm` is refused.
#[track_caller]
fn depth_refuses(bench: &Bench, options: &str, told: &[&str]) {
    bench.refuses(&format!("depth left.png right.png {options} -o map.pfm"), told);
}

/// The file `name` in place of either view is refused, by its name.
#[track_caller]
fn view_refused(bench: &Bench, name: &str, told: &str) {
    bench.refuses(&format!("depth {name} right.png -o map.pfm --picture p.png"), &[name, told]);
    bench.refuses(&format!("depth left.png {name} -o map.pfm --picture p.png"), &[name, told]);
}

fn usual() -> Bench {
    bench_with_plane(4)
}

fn png(pair: &Pair) -> Vec<u8> {
    encode(&pair.left_image(), ImageFormat::Png)
}

#[test]
fn views_of_different_sizes() {
    let bench = usual();
    bench.write("wider.png", png(&Pair::shifted(WIDTH + 1, HEIGHT, 0)));
    bench.write("higher.png", png(&Pair::shifted(WIDTH, HEIGHT + 1, 0)));
    for (name, size) in [("wider.png", "97x40"), ("higher.png", "96x41")] {
        view_refused(&bench, name, size);
        view_refused(&bench, name, "96x40");
        view_refused(&bench, name, "same size");
    }
}

#[test]
fn widths_out_of_range() {
    let bench = usual();
    for width in [1, 31, 1281, 2000] {
        let name = format!("w{width}.png");
        bench.write(&name, png(&Pair::shifted(width, 2, 0)));
        bench.refuses(&format!("depth {name} {name} -o map.pfm"), &[&name, &format!("{width} px"), "32 to 1280"]);
    }
}

#[test]
fn sizes_of_zero() {
    let bench = usual();
    let left = bench.read("left.png");
    bench.write("h0.png", resized_png(left.clone(), 96, 0));
    bench.write("w0.png", resized_png(left, 0, 40));
    bench.write("h0.pgm", "P5\n96 0\n255\n");
    bench.write("w0.pgm", "P5\n0 40\n255\n");
    let mut bmp = encode(&Pair::shifted(WIDTH, HEIGHT, 0).left_image(), ImageFormat::Bmp);
    bmp[22..26].fill(0);
    bench.write("h0.bmp", bmp);
    for name in ["h0.png", "w0.png", "h0.pgm", "w0.pgm", "h0.bmp"] {
        view_refused(&bench, name, name);
    }
}

#[test]
fn sizes_beyond_all_memory() {
    let bench = usual();
    bench.write("huge.png", resized_png(bench.read("left.png"), 1 << 30, 1 << 30));
    bench.write("high.png", resized_png(bench.read("left.png"), 96, 0x7fff_ffff));
    bench.write("huge.pgm", "P5\n4000000000 4000000000\n255\n");
    bench.write("high.pgm", "P5\n96 4000000000\n255\nabc");
    for name in ["huge.png", "high.png", "huge.pgm", "high.pgm"] {
        view_refused(&bench, name, name);
    }
}

#[test]
fn searches_out_of_range() {
    let bench = usual();
    let cases = [
        ("--num-disparities 0", "1 to 256"),
        ("--num-disparities -1", "1 to 256"),
        ("--num-disparities 97", "96 px"),
        ("--num-disparities 257", "1 to 256"),
        ("--num-disparities 65552", "1 to 256"),
        ("--num-disparities 99999999999999999999", "whole number"),
        ("--num-disparities ten", "whole number"),
        ("--num-disparities 1.5", "whole number"),
        ("--num-disparities=", "--num-disparities"),
        ("--min-disparity -129", "-128 to 128"),
        ("--min-disparity 129", "-128 to 128"),
        ("--min-disparity 65536", "-128 to 128"),
        ("--min-disparity x", "whole number"),
        ("--min-confidence -1", "0 to 255"),
        ("--min-confidence 256", "0 to 255"),
        ("--min-confidence high", "whole number"),
    ];
    for (options, told) in cases {
        depth_refuses(&bench, options, &[options.split([' ', '=']).next().unwrap(), told]);
    }
}

#[test]
fn focal_length_and_baseline_apart_or_not_positive() {
    let bench = usual();
    depth_refuses(&bench, "--focal-px 200", &["--focal-px", "--baseline-mm"]);
    depth_refuses(&bench, "--baseline-mm 60", &["--baseline-mm", "--focal-px"]);
    // Metres where millimetres are asked for, or a lens's millimetres where pixels are, would be wrong in silence.
    depth_refuses(&bench, "--focal-px 200 --baseline-mm 0.06", &["--baseline-mm 0.06", "1 to 10000 mm"]);
    depth_refuses(&bench, "--focal-px 2.8 --baseline-mm 60", &["--focal-px 2.8", "10 to 10000 px"]);
    for value in ["0", "-1", "-0.0", "NaN", "inf", "-inf", "1e-12", "1e300"] {
        depth_refuses(&bench, &format!("--focal-px={value} --baseline-mm 60"), &["--focal-px", "must be"]);
        depth_refuses(&bench, &format!("--focal-px 200 --baseline-mm={value}"), &["--baseline-mm", "must be"]);
    }
    for value in ["far", "2,5", "60mm"] {
        depth_refuses(&bench, &format!("--focal-px {value} --baseline-mm 60"), &["--focal-px", value, "number"]);
        depth_refuses(&bench, &format!("--focal-px 200 --baseline-mm {value}"), &["--baseline-mm", value, "number"]);
    }
}

#[test]
fn a_view_that_is_no_image() {
    let bench = usual();
    bench.write("empty.png", "");
    bench.write("text.png", "this is no image\n");
    bench.write("text.txt", "P is for picture\n");
    bench.write("binary.bmp", [0; 5000]);
    bench.write("image.gif", "GIF89a\u{60}\0\u{28}\0\0\0\0;");
    fs::create_dir(bench.path("folder.png")).unwrap();
    let cases = [
        ("empty.png", "empty"),
        ("text.png", "is no PNG"),
        ("text.txt", "is no PNG"),
        ("binary.bmp", "is no PNG"),
        ("image.gif", "image.gif: "),
        ("folder.png", "is a folder"),
        ("missing.png", "cannot be read"),
        ("missing/left.png", "cannot be read"),
        ("left.png/left.png", "cannot be read"),
    ];
    for (name, told) in cases {
        view_refused(&bench, name, told);
    }
}

#[test]
fn a_truncated_view_of_every_kind() {
    let bench = usual();
    let pair = Pair::shifted(WIDTH, HEIGHT, 4);
    let (grey, colour) = (pair.left_image(), pair.left_image().into_rgb8().into());
    let kinds = [
        (&grey, ImageFormat::Png, "png"),
        (&grey, ImageFormat::Pnm, "pgm"),
        (&colour, ImageFormat::Pnm, "ppm"),
        (&grey, ImageFormat::Bmp, "bmp"),
        (&grey, ImageFormat::Jpeg, "jpg"),
        (&colour, ImageFormat::Jpeg, "jpeg"),
        (&grey, ImageFormat::Tiff, "tif"),
    ];
    for (image, format, suffix) in kinds {
        let bytes = encode(image, format);
        let name = format!("cut.{suffix}");
        for length in [1, 4, 9, 30, bytes.len() / 3, bytes.len() * 9 / 10, bytes.len() - 20] {
            bench.write(&name, &bytes[..length]);
            let line = format!("depth left.png {name} -o map.pfm");
            let outcome = bench.run(&line);
            assert_refused(&outcome, &format!("{line}, cut to {length} of {}", bytes.len()), &[&name]);
            assert!(!bench.path("map.pfm").exists());
        }
    }
}

#[test]
fn a_png_with_a_flipped_bit() {
    let bench = usual();
    let bytes = bench.read("left.png");
    for at in [1, 13, 18, 24, 30, bytes.len() / 2, bytes.len() * 3 / 4] {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        bench.write("damaged.png", damaged);
        view_refused(&bench, "damaged.png", "damaged.png: ");
    }
}

#[test]
fn outputs_of_unknown_kind() {
    let bench = usual();
    for name in ["map", "map.txt", "map.jpg", "map.", ".pfm", "map.pfm.gz", "pfm"] {
        bench.refuses(&format!("depth left.png right.png -o {name}"), &["-o", name, ".pfm, .png, .npy or .ply"]);
    }
    for option in ["--picture", "--grey", "--confidence"] {
        for name in ["map", "map.jpg", "map.pfm"] {
            depth_refuses(&bench, &format!("{option} {name}"), &[option, name, ".png"]);
        }
    }
}

#[test]
fn outputs_that_cannot_be_written() {
    let bench = usual();
    fs::create_dir(bench.path("folder.pfm")).unwrap();
    fs::create_dir(bench.path("folder.png")).unwrap();
    for name in ["missing/map.pfm", "missing/deep/map.png", "left.png/map.pfm", "folder.pfm", "folder.png"] {
        bench.refuses(&format!("depth left.png right.png -o good.pfm -o {name}"), &["-o", name]);
    }
    for option in ["--picture", "--grey", "--confidence"] {
        for name in ["missing/p.png", "folder.png", "left.png/p.png"] {
            depth_refuses(&bench, &format!("{option} {name}"), &[option, name]);
        }
    }
}

#[test]
fn outputs_over_the_views_or_each_other() {
    let bench = usual();
    fs::create_dir(bench.path("sub")).unwrap();
    for name in ["left.png", "right.png", "./left.png", "sub/../right.png"] {
        depth_refuses(&bench, &format!("-o {name}"), &["-o", name, "one of the files that are read"]);
        depth_refuses(&bench, &format!("--picture {name}"), &["--picture", name, "one of the files that are read"]);
    }
    depth_refuses(&bench, "-o ./map.pfm", &["map.pfm", "twice"]);
    depth_refuses(&bench, "-o m.png --grey m.png", &["--grey", "m.png", "twice"]);
}

#[test]
fn disparities_that_a_png_cannot_hold() {
    let bench = bench_with_plane(-4);
    bench.write("kitti.png", "an older file");
    let line = "depth left.png right.png --min-disparity -8 --num-disparities 16 -o map.pfm -o kitti.png --grey g.png";
    bench.refuses(line, &["kitti.png", "0 to 256 px", ".pfm"]);
}

#[test]
fn a_point_cloud_without_a_rig() {
    let bench = usual();
    depth_refuses(&bench, "-o cloud.ply", &["cloud.ply", "--focal-px", "--baseline-mm"]);
}

#[test]
fn an_older_output_survives_a_refusal() {
    let bench = usual();
    for name in ["map.pfm", "m.png", "p.png"] {
        bench.write(name, "an older file");
    }
    bench.write("cut.png", &bench.read("left.png")[..1000]);
    bench.refuses("depth left.png cut.png -o map.pfm -o m.png --picture p.png", &["cut.png"]);
    depth_refuses(&bench, "-o m.png --picture p.png --num-disparities 0", &["--num-disparities"]);
}

#[test]
fn texts_without_an_end_or_that_are_none() {
    let bench = bench_with_scenes();
    Pair::shifted(WIDTH, HEIGHT, 4).write(&bench);
    let mut cases = vec![("left.png", "is no text")];
    if cfg!(target_os = "linux") {
        cases.push(("/dev/zero", "more than 64 MB"));
    }
    for (file, told) in cases {
        for line in [
            format!("rig show {file}"),
            format!("rig import {file} -o rig.toml"),
            format!("depth left.png right.png --rig {file} -o map.pfm"),
            format!("record left.png right.png --rig {file} -o out.raw"),
            format!("eval scenes --baselines {file}"),
        ] {
            bench.refuses(&line, &[file, told]);
        }
    }
}

#[test]
fn command_lines_not_understood() {
    let bench = usual();
    let cases = [
        ("", "command is missing"),
        ("dept left.png right.png", "dept"),
        ("depth", "<LEFT>"),
        ("depth left.png", "<RIGHT>"),
        ("depth left.png right.png third.png", "third.png"),
        ("depth left.png right.png --metod lite", "--metod"),
        ("depth left.png right.png --method best", "best"),
        ("depth left.png right.png --method", "--method"),
        ("depth left.png right.png -o", "--output"),
        ("depth left.png right.png -x", "-x"),
        ("depth left.png right.png --num-disparities 8 --num-disparities 9", "--num-disparities"),
        ("depth left.png right.png --json yes", "yes"),
        ("eval", "<SCENES_DIR>"),
        ("eval scenes --method sgbm", "sgbm"),
        ("eval scenes more", "more"),
        ("eval scenes --frob", "--frob"),
        ("demo --method sgbm", "sgbm"),
        ("demo room", "room"),
        ("demo --frob", "--frob"),
        ("--frob", "--frob"),
    ];
    for (line, told) in cases {
        bench.refuses(line, &[told]);
    }
    for known in ["depth", "eval", "demo"] {
        bench.refuses("", &[known]);
    }
    for known in ["full", "lite", "block"] {
        bench.refuses("depth left.png right.png --method best", &["--method", known]);
    }
}

#[test]
fn folders_that_are_no_scenes() {
    let bench = usual();
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

#[test]
fn options_of_demo_out_of_range() {
    let bench = Bench::new();
    for (options, told) in [
        ("--noise -1", "0 to 255"),
        ("--noise NaN", "0 to 255"),
        ("--noise inf", "0 to 255"),
        ("--noise x", "number"),
        ("--seed -1", "0 or more"),
        ("--seed x", "whole number"),
    ] {
        bench.refuses(&format!("demo -o room {options}"), &[options.split(' ').next().unwrap(), told]);
    }
}

#[test]
fn a_name_with_a_line_break_still_gives_one_line() {
    let bench = usual();
    for arguments in [["depth", "no\nsuch.png", "right.png"], ["depth", "left.png", "right.png\nthird.png"]] {
        let outcome = bench.run_with(arguments, &[], Stdio::piped());
        assert_refused(&outcome, &arguments.join(" "), &["cannot be read"]);
    }
    let outcome = bench.run_with(["depth", "left.png", "right.png", "--method", "no\nsuch"], &[], Stdio::piped());
    assert_refused(&outcome, "--method with a line break", &["--method"]);
}

#[cfg(unix)]
#[test]
fn a_name_that_is_no_text() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let bench = usual();
    let name = OsStr::from_bytes(b"l\xffft.png");
    let outcome = bench.run_with([OsStr::new("depth"), name, OsStr::new("right.png")], &[], Stdio::piped());
    assert_refused(&outcome, "a name that is no text", &["ft.png"]);
    let outcome = bench.run_with([OsStr::new("demo"), OsStr::new("--seed"), name], &[], Stdio::piped());
    assert_refused(&outcome, "a seed that is no text", &[]);
}

#[cfg(unix)]
#[test]
fn files_and_folders_without_permission() {
    use std::os::unix::fs::PermissionsExt;
    let bench = usual();
    let set_mode = |name: &str, mode| {
        fs::set_permissions(bench.path(name), fs::Permissions::from_mode(mode)).unwrap();
    };
    bench.write("secret.png", bench.read("left.png"));
    set_mode("secret.png", 0o000);
    if fs::read(bench.path("secret.png")).is_ok() {
        eprintln!("skipped: this user may read and write everything");
        return;
    }
    view_refused(&bench, "secret.png", "cannot be read");
    bench.write("locked/map.pfm", "an older file");
    set_mode("locked", 0o555);
    bench.refuses("depth left.png right.png -o locked/new.pfm", &["-o", "locked/new.pfm"]);
    bench.refuses("eval locked", &["locked"]);
    bench.refuses("demo -o locked/room", &["-o", "locked/room"]);
    set_mode("locked", 0o755);
}

#[cfg(unix)]
#[test]
fn a_read_only_output() {
    let bench = usual();
    bench.write("map.png", "an older file");
    let mut permissions = fs::metadata(bench.path("map.png")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(bench.path("map.png"), permissions).unwrap();
    depth_refuses(&bench, "-o map.png", &["-o", "map.png", "read-only"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_standard_output_that_takes_nothing() {
    let bench = bench_with_scenes();
    bench.write("left.png", bench.read("scenes/alcove/left.png"));
    bench.write("right.png", bench.read("scenes/alcove/right.png"));
    for line in ["depth left.png right.png", "depth left.png right.png --json", "eval scenes", "--help"] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let outcome = bench.run_with(line.split(' '), &[], Stdio::from(full));
        assert_eq!(outcome.status, 2, "{line}: {outcome:?}");
        assert_one_error_line(&outcome.stderr, line);
        assert!(outcome.stderr.contains("standard output"), "{line}: {}", outcome.stderr);
    }
}

#[test]
fn a_file_that_is_no_recording_is_told_with_what_would_be_read() {
    let bench = bench_with_plane(4);
    for (name, advice) in [("take.db3", "ros2 bag convert"), ("take.bag", "mcap convert"), ("take.bin", "--raw")] {
        bench.write(name, "bytes");
        bench.refuses(&format!("play {name} -o out"), &[name, "is a file", advice]);
    }
    bench.write("take.mcap", "bytes of no recording");
    let told = if cfg!(feature = "mcap") { "does not begin" } else { "--features mcap" };
    bench.refuses("play take.mcap -o out", &["take.mcap", told]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_device_is_named() {
    let bench = bench_with_plane(4);
    bench.refuses("record left.png right.png --wiring line -o /dev/full", &["/dev/full", "cannot be written"]);
}
