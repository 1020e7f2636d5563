//! Wrong input: one line on the standard error that names what is wrong, exit status 2, and no file touched.

use std::fs;
use std::process::Stdio;

use crate::bad_views::{depth_refuses, view_refused};
use crate::scene::{HEIGHT, Pair, WIDTH, bench_with_plane, bench_with_scenes};
use crate::tool::{Bench, assert_one_error_line, assert_refused};

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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
