//! `haarline contours`, and the sparse methods.

use crate::files::{Map, encode, png8};
use crate::scene::{Pair, bench_with_plane};
use crate::tool::Bench;
use image::ImageFormat;

#[test]
fn the_picture_is_as_large_as_the_image_and_has_fewer_contours_the_larger_the_support() {
    let bench = bench_with_plane(4);
    let mut last = f64::INFINITY;
    for half_support in [1, 4, 16] {
        bench.succeeds(&format!("contours left.png -o k.png --half-support {half_support}"));
        let picture = png8(&bench.read("k.png"));
        assert_eq!(picture.len(), 96 * 40);
        let share = picture.iter().filter(|&&grey| grey > 0).count() as f64 / picture.len() as f64;
        assert!(share > 0.0 && share < last, "half-support {half_support}: {share}");
        last = share;
    }
}

#[test]
fn columns_add_contours_and_the_decimated_transform_leaves_some_out() {
    let bench = bench_with_plane(4);
    let contours = |options: &str| {
        bench.succeeds(&format!("contours left.png -o k.png --half-support 2 {options}"));
        png8(&bench.read("k.png")).iter().filter(|&&grey| grey > 0).count()
    };
    let (rows, both, decimated) = (contours(""), contours("--columns"), contours("--decimated"));
    assert!(decimated < rows && rows < both, "{decimated}, {rows}, {both}");
    assert!(decimated > 0);
}

#[test]
fn an_image_of_any_size_has_contours() {
    let bench = Bench::new();
    for [width, height] in [[2, 1], [5, 3], [1500, 2]] {
        bench.write("image.png", encode(&Pair::shifted(width, height, 0).left_image(), ImageFormat::Png));
        let outcome = bench.succeeds("contours image.png -o k.png --half-support 1");
        assert!(outcome.stdout.contains(&format!("{width}x{height}")), "{}", outcome.stdout);
        assert_eq!(png8(&bench.read("k.png")).len(), width * height);
    }
}

#[test]
fn what_has_no_contours_is_refused() {
    let bench = bench_with_plane(4);
    bench.write("text.png", "this is no image");
    let cases = [
        ("contours left.png -o k.png --half-support 0", "1 px or more"),
        ("contours left.png -o k.png --half-support -1", "1 px or more"),
        ("contours left.png -o k.png --half-support x", "whole number"),
        ("contours left.png -o k.png --half-support 49", "96 px wide"),
        ("contours left.png -o k.png --half-support 21 --columns", "40 px high"),
        ("contours left.png -o k.png --half-support 3 --decimated", "1, 2, 4, 8"),
        ("contours left.png -o k.png", "--half-support"),
        ("contours left.png -o k.jpg --half-support 2", ".png"),
        ("contours left.png -o none/k.png --half-support 2", "no folder"),
        ("contours left.png -o left.png --half-support 2", "another name"),
        ("contours text.png -o k.png --half-support 2", "is no PNG"),
        ("contours missing.png -o k.png --half-support 2", "cannot be read"),
    ];
    for (line, told) in cases {
        bench.refuses(line, &[told]);
    }
}

#[test]
fn sparse_methods_give_the_shift_where_they_answer() {
    let bench = bench_with_plane(6);
    for method in ["contour", "contour --half-support 1", "contour --scales 1,2,4", "envelope"] {
        bench.succeeds(&format!("depth left.png right.png --num-disparities 16 --method {method} -o map.pfm"));
        let map = Map::from_pfm(&bench.read("map.pfm"));
        let known = map.known();
        let right = known.iter().filter(|px| (**px - 6.0).abs() <= 0.5).count();
        assert!(map.density() > 3.0, "{method}: {} %", map.density());
        assert!(100 * right >= 97 * known.len(), "{method}: {right} of {}", known.len());
    }
}

#[test]
fn scales_change_the_map_and_are_for_contour_only() {
    let bench = bench_with_plane(6);
    let map = |options: &str| {
        bench.succeeds(&format!("depth left.png right.png --method contour {options} -o map.pfm"));
        bench.read("map.pfm")
    };
    assert_eq!(map("--half-support 4"), map("--scales 4"));
    assert_ne!(map("--half-support 4"), map("--scales 4,1"));
    let cases = [
        ("--method contour --half-support 0", "--half-support 0: must be 1 to 16"),
        ("--method contour --half-support 17", "--half-support 17: must be 1 to 16"),
        ("--method contour --scales 2,-1", "--scales -1: must be 1 to 16"),
        ("--method contour --scales 2,", "whole number"),
        ("--method contour --scales 2 --half-support 2", "--half-support"),
        ("--method lite --half-support 2", "is for --method contour, not for lite"),
        ("--scales 2", "is for --method contour, not for full"),
    ];
    for (options, told) in cases {
        bench.refuses(&format!("depth left.png right.png {options} -o refused.pfm"), &[told]);
    }
    bench.refuses("play . -o maps --method envelope --half-support 2", &["not for envelope"]);
    bench.refuses("eval . --method block --scales 2", &["not for block"]);
}
