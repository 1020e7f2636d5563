//! Wrong views, searches and outputs of `depth`: refused, and no file touched.

use std::fs;

use image::ImageFormat;

use crate::files::{encode, resized_png};
use crate::scene::{HEIGHT, Pair, WIDTH, bench_with_plane};
use crate::tool::{Bench, assert_refused};

/// `depth left.png right.png OPTIONS -o map.pfm` is refused.
#[track_caller]
pub fn depth_refuses(bench: &Bench, options: &str, told: &[&str]) {
    bench.refuses(&format!("depth left.png right.png {options} -o map.pfm"), told);
}

/// The file `name` in place of either view is refused, by its name.
#[track_caller]
pub fn view_refused(bench: &Bench, name: &str, told: &str) {
    bench.refuses(&format!("depth {name} right.png -o map.pfm --picture p.png"), &[name, told]);
    bench.refuses(&format!("depth left.png {name} -o map.pfm --picture p.png"), &[name, told]);
}

fn png(pair: &Pair) -> Vec<u8> {
    encode(&pair.left_image(), ImageFormat::Png)
}

#[test]
fn views_of_different_sizes() {
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
    for width in [1, 31, 1281, 2000] {
        let name = format!("w{width}.png");
        bench.write(&name, png(&Pair::shifted(width, 2, 0)));
        bench.refuses(&format!("depth {name} {name} -o map.pfm"), &[&name, &format!("{width} px"), "32 to 1280"]);
    }
}

#[test]
fn sizes_of_zero() {
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
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
    let bench = bench_with_plane(4);
    depth_refuses(&bench, "-o cloud.ply", &["cloud.ply", "--focal-px", "--baseline-mm"]);
}

#[test]
fn an_older_output_survives_a_refusal() {
    let bench = bench_with_plane(4);
    for name in ["map.pfm", "m.png", "p.png"] {
        bench.write(name, "an older file");
    }
    bench.write("cut.png", &bench.read("left.png")[..1000]);
    bench.refuses("depth left.png cut.png -o map.pfm -o m.png --picture p.png", &["cut.png"]);
    depth_refuses(&bench, "-o m.png --picture p.png --num-disparities 0", &["--num-disparities"]);
}
