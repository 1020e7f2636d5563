//! `haarline depth` on good input.

use std::process::Stdio;

use image::{DynamicImage, GrayAlphaImage, ImageFormat, RgbImage, RgbaImage};
use serde_json::Value;

use crate::files::{Map, encode, png, png8, png16, vertices};
use crate::scene::{HEIGHT, Pair, Scene, WIDTH, bench_with_plane, grey16_image};
use crate::tool::Bench;

const METHODS: [&str; 3] = ["full", "lite", "block"];

/// A bench with a plane and a box before it, so that disparities, unknown pixels and confidences are many.
fn bench_with_box() -> Bench {
    let bench = Bench::new();
    Scene::new("alcove", "", [WIDTH, HEIGHT], [3, 9]).pair.write(&bench);
    bench
}

#[track_caller]
fn pfm(bench: &Bench, name: &str) -> Map {
    Map::from_pfm(&bench.read(name))
}

/// Share of `map`'s pixels right of column `first` that are within a quarter px of `wanted`, percent.
fn share_at(map: &Map, first: usize, wanted: f32) -> f64 {
    let inner = (0..map.px.len()).filter(|index| index % map.width >= first);
    let right = inner.clone().filter(|&index| (map.px[index] - wanted).abs() <= 0.25);
    100.0 * right.count() as f64 / inner.count() as f64
}

#[test]
fn a_shifted_pair_gives_the_shift_with_every_method() {
    for shift in [0, 1, 6, 13] {
        let bench = bench_with_plane(shift);
        for method in METHODS {
            let line = format!("depth left.png right.png --num-disparities 16 --method {method} -o map.pfm");
            // Without a shift both views are the same image.
            let told = if shift == 0 { bench.succeeds_on_odd_views(&line) } else { bench.succeeds(&line) };
            assert_eq!(told.stderr.contains("same image"), shift == 0);
            let map = pfm(&bench, "map.pfm");
            assert_eq!((map.width, map.height), (WIDTH, HEIGHT));
            let share = share_at(&map, 16, shift as f32);
            assert!(share > if method == "block" { 55.0 } else { 90.0 }, "{method}, {shift} px: {share} %");
            let inner = (0..map.px.len()).filter(|index| index % WIDTH >= 16 && map.px[*index].is_finite());
            let wrong = inner.filter(|&index| (map.px[index] - shift as f32).abs() > 1.0).count();
            assert!(wrong * 20 < map.px.len(), "{method}, {shift} px: {wrong} wrong");
        }
    }
}

#[test]
fn a_search_from_below_zero_finds_negative_disparities() {
    for (shift, method) in [(-5, "full"), (-5, "lite"), (-5, "block"), (4, "full")] {
        let bench = bench_with_plane(shift);
        let line = format!("depth left.png right.png --min-disparity -8 --num-disparities 16 --method {method}");
        let summary = bench.succeeds(&format!("{line} -o map.pfm --json")).json();
        assert_eq!((&summary["min_disparity"], &summary["num_disparities"]), (&(-8).into(), &16.into()));
        let map = pfm(&bench, "map.pfm");
        let inner = (0..map.px.len()).filter(|index| (16..WIDTH - 16).contains(&(index % WIDTH)));
        let right = inner.clone().filter(|&index| (map.px[index] - shift as f32).abs() <= 0.25).count();
        assert!(right * 10 > inner.count() * 6, "{method}, {shift} px: {right}");
    }
}

#[test]
fn the_search_is_a_quarter_of_the_width_up_to_a_multiple_of_16_at_most_256() {
    let cases = [(32, 16), (64, 16), (65, 32), (100, 32), (128, 32), (1025, 256), (1280, 256)];
    for (width, wanted) in cases {
        let bench = Bench::new();
        Pair::shifted(width, 2, 3).write(&bench);
        let summary = bench.succeeds("depth left.png right.png --json").json();
        assert_eq!(summary["num_disparities"], wanted, "{width} px");
        assert_eq!(summary["min_disparity"], 0);
    }
}

#[test]
fn no_size_within_the_limits_is_cropped() {
    for (width, height) in [(32, 1), (33, 7), (61, 5), (1280, 3)] {
        let bench = Bench::new();
        Pair::shifted(width, height, 2).write(&bench);
        for method in METHODS {
            bench.succeeds(&format!("depth left.png right.png --method {method} -o map.pfm --num-disparities 32"));
            let map = pfm(&bench, "map.pfm");
            assert_eq!((map.width, map.height), (width, height), "{method}");
        }
    }
}

#[test]
fn the_extremes_of_the_search_are_accepted() {
    let bench = Bench::new();
    Pair::shifted(260, 3, 2).write(&bench);
    for (num, min) in [(1, -128), (1, 128), (256, -128), (256, 128), (256, 0)] {
        bench.succeeds(&format!("depth left.png right.png --num-disparities {num} --min-disparity {min}"));
    }
}

#[test]
fn several_outputs_tell_the_same_map() {
    let bench = bench_with_box();
    bench.succeeds(
        "depth left.png right.png -o a.pfm -o b.PNG --output c.ply -o d.pfm --focal-px 200 --baseline-mm 60 \
         --picture p.png --grey g.png --confidence c.png --min-confidence 16",
    );
    let map = pfm(&bench, "a.pfm");
    assert_eq!(bench.read("a.pfm"), bench.read("d.pfm"));
    assert!((50.0..99.9).contains(&map.density()), "{} %: some known, some not", map.density());
    let kitti = png16(&bench.read("b.PNG"));
    let wanted: Vec<u16> =
        map.px.iter().map(|px| if px.is_finite() { ((px * 256.0) as u16).max(1) } else { 0 }).collect();
    assert_eq!(kitti, wanted);
    let points = vertices(&bench.read("c.ply"));
    assert_eq!(points.len(), map.px.iter().filter(|px| px.is_finite() && **px > 0.0).count());
}

#[test]
fn a_known_disparity_of_zero_is_1_in_a_png_and_no_point() {
    let bench = bench_with_plane(0);
    bench.succeeds_on_odd_views("depth left.png right.png -o m.pfm -o m.png -o m.ply --focal-px 200 --baseline-mm 60");
    let (map, kitti) = (pfm(&bench, "m.pfm"), png16(&bench.read("m.png")));
    let zeros: Vec<usize> = (0..map.px.len()).filter(|&index| map.px[index] == 0.0).collect();
    assert!(zeros.len() > map.px.len() / 4, "{} pixels at 0 px", zeros.len());
    assert!(zeros.iter().all(|&index| kitti[index] == 1));
    let positive = map.known().iter().filter(|px| **px > 0.0).count();
    assert_eq!(vertices(&bench.read("m.ply")).len(), positive);
}

#[test]
fn points_lie_on_their_rays_in_metres_with_the_left_view_s_colours() {
    let bench = bench_with_box();
    let (focal, baseline) = (150.5, 62.25);
    bench.succeeds(&format!("depth left.png right.png -o m.pfm -o m.ply --focal-px {focal} --baseline-mm {baseline}"));
    let left = png8(&bench.read("left.png"));
    let map = pfm(&bench, "m.pfm");
    let seen = (0..map.px.len()).filter(|&index| map.px[index].is_finite() && map.px[index] > 0.0);
    let points = vertices(&bench.read("m.ply"));
    for (index, (point, colour)) in seen.zip(points) {
        let z = focal * baseline / 1000.0 / f64::from(map.px[index]);
        let x = ((index % WIDTH) as f64 - (WIDTH as f64 - 1.0) / 2.0) * z / focal;
        let y = ((index / WIDTH) as f64 - (HEIGHT as f64 - 1.0) / 2.0) * z / focal;
        for (found, wanted) in point.into_iter().zip([x, y, z]) {
            assert!((f64::from(found) - wanted).abs() < 1e-4 * z, "pixel {index}: {point:?}, not {:?}", [x, y, z]);
        }
        assert_eq!(colour, [left[index]; 3], "pixel {index}");
    }
}

#[test]
fn the_picture_shows_the_map_with_unknown_in_grey_and_a_legend_beside_it() {
    let bench = bench_with_box();
    bench.succeeds("depth left.png right.png -o m.pfm --picture p.png");
    let picture = png(&bench.read("p.png")).into_rgb8();
    // Small maps are enlarged to 320 columns at least.
    let scale = 320_usize.div_ceil(WIDTH);
    assert!(picture.width() as usize > WIDTH * scale && picture.height() as usize >= HEIGHT * scale);
    let map = pfm(&bench, "m.pfm");
    for (index, px) in map.px.iter().enumerate() {
        let [r, g, b] = picture.get_pixel((index % WIDTH * scale) as u32, (index / WIDTH * scale) as u32).0;
        assert_eq!(r == g && g == b, !px.is_finite(), "pixel {index}, {px} px: {:?}", [r, g, b]);
    }
    let beside = picture.enumerate_pixels().filter(|(x, ..)| *x as usize >= WIDTH * scale);
    let colours: std::collections::BTreeSet<[u8; 3]> = beside.map(|(.., pixel)| pixel.0).collect();
    assert!(colours.len() > 10, "{} colours in the legend", colours.len());
}

#[test]
fn the_rig_adds_metres_to_the_legend() {
    let bench = bench_with_box();
    bench.succeeds("depth left.png right.png --picture px.png");
    bench.succeeds("depth left.png right.png --picture m.png --focal-px 200 --baseline-mm 60");
    assert_ne!(bench.read("px.png"), bench.read("m.png"));
}

#[test]
fn in_grey_nearer_is_brighter_and_unknown_is_black() {
    let bench = bench_with_box();
    bench.succeeds("depth left.png right.png --min-disparity -2 --num-disparities 20 -o m.pfm --grey g.png");
    let (map, grey) = (pfm(&bench, "m.pfm"), png8(&bench.read("g.png")));
    let mut both: Vec<(f32, u8)> = map.px.iter().copied().zip(grey).collect();
    both.sort_by(|one, other| one.0.total_cmp(&other.0));
    let (known, unknown) = both.split_at(map.known().len());
    assert!(unknown.iter().all(|pixel| pixel.1 == 0) && known.iter().all(|pixel| pixel.1 > 0));
    assert!(known.is_sorted_by_key(|pixel| pixel.1), "brightness follows disparity");
    let (far, near) = (known[known.len() / 10].1, known[known.len() - 1].1);
    assert!(near > far + 40, "{far} to {near}");
}

#[test]
fn a_range_that_is_told_holds_for_the_pictures() {
    let bench = bench_with_box();
    bench.succeeds("depth left.png right.png -o m.pfm --grey g.png --picture p.png --range -2..30");
    let (map, grey) = (pfm(&bench, "m.pfm"), png8(&bench.read("g.png")));
    for (px, grey) in map.px.iter().zip(grey) {
        let wanted = if px.is_finite() { 1.0 + 254.0 * (px + 2.0) / 32.0 } else { 0.0 };
        assert!((f32::from(grey) - wanted).abs() <= 0.5, "{px} px: {grey}, not {wanted}");
    }
    bench.succeeds("depth left.png right.png --picture q.png");
    assert_ne!(bench.read("p.png"), bench.read("q.png"));
    bench.refuses("depth left.png right.png --picture p.png --range 3..3", &["--range", "A..B"]);
}

#[test]
fn depth_in_mm_is_focal_length_times_baseline_by_disparity() {
    let bench = bench_with_box();
    let line = "depth left.png right.png -o m.pfm -o m.npy --depth-png";
    bench.succeeds(&format!("{line} d.png --focal-px 200 --baseline-mm 60"));
    let (map, depth) = (pfm(&bench, "m.pfm"), png16(&bench.read("d.png")));
    for (px, mm) in map.px.iter().zip(&depth) {
        let wanted = if px.is_finite() && *px > 0.0 { 200.0 * 60.0 / px } else { 0.0 };
        assert!((f32::from(*mm) - wanted).abs() <= 1.0, "{px} px: {mm} mm, not {wanted}");
    }
    let npy = bench.read("m.npy");
    let samples = npy[npy.len() - 4 * map.px.len()..].as_chunks().0.iter().map(|&sample| f32::from_le_bytes(sample));
    for (npy, pfm) in samples.zip(&map.px) {
        assert!(if pfm.is_finite() { npy == *pfm } else { npy.is_nan() }, "{npy}, {pfm}");
    }
    let near = "n.png -o n.ply --focal-px 200 --baseline-mm 60 --max-depth 2.5";
    bench.succeeds(&format!("{line} {near}"));
    let wanted: Vec<u16> = depth.iter().map(|&mm| if mm <= 2500 { mm } else { 0 }).collect();
    assert!(wanted != depth && wanted.iter().any(|&mm| mm > 0));
    assert_eq!(png16(&bench.read("n.png")), wanted);
    assert!(vertices(&bench.read("n.ply")).iter().all(|(point, _)| point[2] <= 2.5));

    bench.refuses(&format!("{line} e.png"), &["--depth-png", "--focal-px", "--rig"]);
    bench.refuses("depth left.png right.png -o n.pfm --max-depth 3", &["--max-depth", "--focal-px"]);
    bench
        .refuses(&format!("{line} e.png --focal-px 200 --baseline-mm 60 --max-depth -1"), &["--max-depth", "positive"]);
}

#[test]
fn confidence_is_0_exactly_where_nothing_is_known_or_less_sure_than_asked() {
    let bench = bench_with_box();
    for method in METHODS {
        let line = format!("depth left.png right.png --method {method}");
        bench.succeeds(&format!("{line} --min-confidence 0 -o all.pfm --confidence all.png"));
        let (all, confidence) = (pfm(&bench, "all.pfm"), png8(&bench.read("all.png")));
        let known_without = all.px.iter().zip(&confidence).filter(|(px, c)| px.is_finite() && **c == 0).count();
        assert_eq!(known_without, 0, "{method}: known without confidence");
        assert!(all.px.iter().zip(&confidence).all(|(px, c)| px.is_finite() || *c == 0), "{method}");
        let mut last = f64::INFINITY;
        for least in [0, 1, 60, 120, 180, 240, 255] {
            let line = format!("{line} --min-confidence {least} -o some.pfm --confidence some.png --json");
            let density = bench.succeeds(&line).json()["density"].as_f64().unwrap();
            assert!(density <= last, "{method}, {least}: {density} % after {last} %");
            last = density;
            let kept = |index: usize| confidence[index] >= least;
            let (some, left) = (pfm(&bench, "some.pfm"), png8(&bench.read("some.png")));
            for index in 0..all.px.len() {
                let wanted = if kept(index) { (all.px[index], confidence[index]) } else { (f32::INFINITY, 0) };
                assert_eq!((some.px[index], left[index]), wanted, "{method}, {least}, pixel {index}");
            }
            assert!((density - some.density()).abs() < 1e-9, "{method}, {least}");
        }
    }
}

#[test]
fn fill_leaves_no_hole_and_what_was_known_as_it_was() {
    let bench = bench_with_box();
    let line = "depth left.png right.png --method wavelet-block";
    bench.succeeds(&format!("{line} -o holes.pfm"));
    bench.succeeds(&format!("{line} --fill -o filled.pfm --confidence confidence.png"));
    let (holes, filled) = (pfm(&bench, "holes.pfm"), pfm(&bench, "filled.pfm"));
    let confidence = png8(&bench.read("confidence.png"));
    assert!(holes.density() < 100.0 && filled.density() == 100.0, "{} and {}", holes.density(), filled.density());
    for (index, (was, is)) in holes.px.iter().zip(&filled.px).enumerate() {
        if was.is_finite() {
            assert_eq!(was, is, "pixel {index}");
        } else {
            assert!((1..16).contains(&confidence[index]), "pixel {index}");
        }
    }
}

#[test]
fn the_json_summary_is_one_line_that_agrees_with_the_map() {
    let bench = bench_with_box();
    let outcome = bench.succeeds("depth left.png right.png --json -o m.pfm");
    assert!(outcome.stdout.ends_with('\n') && outcome.stdout.lines().count() == 1, "{}", outcome.stdout);
    let (summary, map) = (outcome.json(), pfm(&bench, "m.pfm"));
    assert_eq!((&summary["width"], &summary["height"]), (&WIDTH.into(), &HEIGHT.into()));
    assert_eq!((&summary["method"], &summary["num_disparities"]), (&"full".into(), &32.into()));
    let number = |key: &str| summary[key].as_f64().unwrap_or_else(|| panic!("{key}: {summary}"));
    let mut known: Vec<f64> = map.known().into_iter().map(f64::from).collect();
    known.sort_by(f64::total_cmp);
    assert!((number("density") - map.density()).abs() < 1e-9);
    assert_eq!(number("min_disparity_px"), known[0]);
    assert_eq!(number("max_disparity_px"), known[known.len() - 1]);
    assert_eq!(number("median_disparity_px"), known[(known.len() - 1) / 2]);
    assert!((0.0..60_000.0).contains(&number("milliseconds")));
    assert!(summary.get("focal_px").is_none(), "no rig given: {summary}");
}

#[test]
fn with_a_rig_the_json_summary_tells_depth() {
    let bench = bench_with_plane(6);
    let line = "depth left.png right.png --focal-px 180 --baseline-mm 60 --min-confidence 64 --json";
    let summary = bench.succeeds(line).json();
    assert_eq!((summary["focal_px"].as_f64(), summary["baseline_mm"].as_f64()), (Some(180.0), Some(60.0)));
    let depth = |key: &str| summary[key].as_f64().unwrap_or_else(|| panic!("{key}: {summary}"));
    for (key, px) in [("nearest_depth_mm", "max"), ("median_depth_mm", "median"), ("farthest_depth_mm", "min")] {
        let disparity = summary[format!("{px}_disparity_px")].as_f64().unwrap();
        assert!((depth(key) - 180.0 * 60.0 / disparity).abs() <= 1.0, "{key}: {summary}");
    }
    assert!((depth("median_depth_mm") - 1800.0).abs() < 80.0, "{summary}");
}

#[test]
fn the_summary_is_one_line_with_size_density_range_and_time() {
    let bench = bench_with_plane(6);
    let told = bench.succeeds("depth left.png right.png --method lite").stdout;
    assert!(told.ends_with('\n') && told.lines().count() == 1, "{told}");
    for words in ["96x40", "lite", "% known", "disparity ", " px", " ms"] {
        assert!(told.contains(words), "{words}: {told}");
    }
    let told = bench.succeeds("depth left.png right.png --focal-px 180 --baseline-mm 60").stdout;
    assert!(told.lines().count() == 1 && told.contains("depth ") && told.contains(" m"), "{told}");
}

#[test]
fn where_nothing_is_known_the_figures_are_null_and_all_files_are_written() {
    let bench = Bench::new();
    Pair::blank(WIDTH, HEIGHT).write(&bench);
    let files = "-o m.pfm -o m.png -o m.ply --picture p.png --grey g.png --confidence c.png";
    let line = format!("depth left.png right.png --method wavelet-block --focal-px 200 --baseline-mm 60 {files}");
    let outcome = bench.succeeds_on_odd_views(&format!("{line} --json"));
    assert!(outcome.stderr.contains("nothing to see"), "{}", outcome.stderr);
    let summary = outcome.json();
    assert_eq!((&summary["input_ok"], &summary["input"]), (&false.into(), &"nothing-seen".into()), "{summary}");
    let map = pfm(&bench, "m.pfm");
    assert_eq!((summary["density"].as_f64(), map.known().len()), (Some(0.0), 0), "{summary}");
    for key in ["min_disparity_px", "median_disparity_px", "max_disparity_px", "nearest_depth_mm"] {
        assert_eq!(summary[key], Value::Null, "{key}: {summary}");
    }
    assert!(png16(&bench.read("m.png")).iter().chain(&[0]).all(|&sample| sample == 0));
    assert!(png8(&bench.read("g.png")).into_iter().chain(png8(&bench.read("c.png"))).all(|sample| sample == 0));
    assert_eq!(vertices(&bench.read("m.ply")), []);
    assert!(png(&bench.read("p.png")).width() as usize > WIDTH);
    assert!(bench.succeeds_on_odd_views(&line).stdout.contains("no disparity known"));
}

#[test]
fn two_runs_give_identical_bytes() {
    let names = ["m.pfm", "m.png", "m.ply", "p.png", "g.png", "c.png"];
    for method in METHODS {
        let bench = bench_with_box();
        let run = || {
            bench.succeeds(&format!(
                "depth left.png right.png --method {method} --focal-px 200 --baseline-mm 60 -o m.pfm -o m.png \
                 -o m.ply --picture p.png --grey g.png --confidence c.png"
            ));
            names.map(|name| bench.read(name))
        };
        assert!(run() == run(), "{method}");
    }
}

#[test]
fn nothing_but_the_named_files_is_written() {
    let bench = bench_with_plane(4);
    bench.succeeds("depth left.png right.png -o m.pfm");
    let names: Vec<String> =
        bench.content().keys().map(|path| path.file_name().unwrap().to_string_lossy().into_owned()).collect();
    assert_eq!(names, ["left.png", "m.pfm", "right.png"]);
}

#[test]
fn an_older_output_is_replaced() {
    let bench = bench_with_plane(4);
    bench.write("m.pfm", [7; 100_000]);
    bench.succeeds("depth left.png right.png -o m.pfm");
    assert_eq!(pfm(&bench, "m.pfm").width, WIDTH);
}

/// The map of views in files of other kinds, next to that of PNG files with the same grey levels.
#[track_caller]
fn assert_same_map(bench: &Bench, views: [(&str, Vec<u8>); 2]) {
    let [(left, left_bytes), (right, right_bytes)] = views;
    bench.write(left, left_bytes);
    bench.write(right, right_bytes);
    bench.succeeds("depth left.png right.png -o wanted.pfm");
    bench.succeeds(&format!("depth {left} {right} -o found.pfm"));
    assert!(bench.read("wanted.pfm") == bench.read("found.pfm"), "{left}, {right}: another map");
    assert!(pfm(bench, "found.pfm").density() > 50.0);
}

#[test]
fn every_lossless_kind_of_file_is_read_to_the_same_map() {
    let bench = bench_with_plane(5);
    let pair = Pair::shifted(WIDTH, HEIGHT, 5);
    let kinds = [(ImageFormat::Png, "png"), (ImageFormat::Pnm, "pgm"), (ImageFormat::Bmp, "bmp")];
    for (format, suffix) in kinds.into_iter().chain([(ImageFormat::Tiff, "tif"), (ImageFormat::Tiff, "tiff")]) {
        let views = [("l", pair.left_image()), ("r", pair.right_image())];
        let [left, right] = views.map(|(name, image)| (format!("{name}.{suffix}"), encode(&image, format)));
        assert_same_map(&bench, [(&left.0, left.1), (&right.0, right.1)]);
    }
}

#[test]
fn views_may_be_files_of_different_kinds_and_any_name() {
    let bench = bench_with_plane(5);
    let pair = Pair::shifted(WIDTH, HEIGHT, 5);
    let views = [encode(&pair.left_image(), ImageFormat::Bmp), encode(&pair.right_image(), ImageFormat::Tiff)];
    let [left, right] = views;
    assert_same_map(&bench, [("left.dat", left), ("right", right)]);
}

#[test]
fn a_pgm_of_text_is_read() {
    let bench = bench_with_plane(5);
    let pair = Pair::shifted(WIDTH, HEIGHT, 5);
    let text = |luma: &[u8]| {
        let rows: Vec<String> =
            luma.chunks(16).map(|row| row.iter().map(|value| format!("{value} ")).collect()).collect();
        format!("P2\n# text\n{WIDTH} {HEIGHT}\n255\n{}\n", rows.join("\n")).into_bytes()
    };
    assert_same_map(&bench, [("l.pgm", text(&pair.left)), ("r.pgm", text(&pair.right))]);
}

#[test]
fn of_16_bit_samples_the_high_byte_counts() {
    let bench = bench_with_plane(5);
    let pair = Pair::shifted(WIDTH, HEIGHT, 5);
    let wide = |luma: &[u8]| -> Vec<u16> {
        let low = |index: usize| (index * 89 % 256) as u16;
        luma.iter().enumerate().map(|(index, &value)| u16::from(value) << 8 | low(index)).collect()
    };
    for (format, suffix) in [(ImageFormat::Png, "png"), (ImageFormat::Tiff, "tif")] {
        let file = |luma: &[u8]| encode(&grey16_image(WIDTH, HEIGHT, &wide(luma)), format);
        let (left, right) = (format!("l16.{suffix}"), format!("r16.{suffix}"));
        assert_same_map(&bench, [(&left, file(&pair.left)), (&right, file(&pair.right))]);
    }
    let pgm = |luma: &[u8]| {
        let samples = wide(luma).into_iter().flat_map(u16::to_be_bytes);
        format!("P5\n{WIDTH} {HEIGHT}\n65535\n").into_bytes().into_iter().chain(samples).collect()
    };
    assert_same_map(&bench, [("l16.pgm", pgm(&pair.left)), ("r16.pgm", pgm(&pair.right))]);
    let colours = |luma: &[u8]| {
        let samples = wide(luma).into_iter().flat_map(|value| [value; 3]).collect();
        let image = image::ImageBuffer::from_raw(WIDTH as u32, HEIGHT as u32, samples);
        encode(&DynamicImage::ImageRgb16(image.unwrap()), ImageFormat::Png)
    };
    assert_same_map(&bench, [("l48.png", colours(&pair.left)), ("r48.png", colours(&pair.right))]);
}

#[test]
fn a_jpeg_gives_nearly_the_same_map() {
    let bench = bench_with_plane(5);
    let pair = Pair::shifted(WIDTH, HEIGHT, 5);
    bench.write("l.jpg", encode(&pair.left_image(), ImageFormat::Jpeg));
    bench.write("r.jpeg", encode(&pair.right_image(), ImageFormat::Jpeg));
    bench.succeeds("depth l.jpg r.jpeg --num-disparities 16 -o m.pfm");
    let share = share_at(&pfm(&bench, "m.pfm"), 16, 5.0);
    assert!(share > 85.0, "{share} %");
}

/// Colours that differ from grey, and their luma by the weights 0.299, 0.587 and 0.114.
fn coloured(luma: &[u8]) -> (RgbImage, Vec<u8>) {
    let colour = |&value: &u8| [value, value / 2 + 40, 255 - value];
    let samples: Vec<[u8; 3]> = luma.iter().map(colour).collect();
    let weigh = |&[r, g, b]: &[u8; 3]| (0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)).round();
    let image = RgbImage::from_raw(WIDTH as u32, HEIGHT as u32, samples.concat()).unwrap();
    (image, samples.iter().map(|colour| weigh(colour) as u8).collect())
}

#[test]
fn colour_becomes_luma_in_every_kind_of_file_and_colours_the_points() {
    let grey = Pair::shifted(WIDTH, HEIGHT, 5);
    let ((left, left_luma), (right, right_luma)) = (coloured(&grey.left), coloured(&grey.right));
    let bench = Bench::new();
    Pair { left: left_luma, right: right_luma, ..grey }.write(&bench);
    let kinds = [(ImageFormat::Png, "png"), (ImageFormat::Pnm, "ppm"), (ImageFormat::Bmp, "bmp")];
    for (format, suffix) in kinds.into_iter().chain([(ImageFormat::Tiff, "tif")]) {
        let file = |image: &RgbImage| encode(&image.clone().into(), format);
        let (left_name, right_name) = (format!("l.{suffix}"), format!("r.{suffix}"));
        assert_same_map(&bench, [(&left_name, file(&left)), (&right_name, file(&right))]);
    }
    bench.succeeds("depth l.png r.png -o m.pfm -o m.ply --focal-px 200 --baseline-mm 60");
    let map = pfm(&bench, "m.pfm");
    let seen = (0..map.px.len()).filter(|&index| map.px[index].is_finite() && map.px[index] > 0.0);
    let colours: Vec<[u8; 3]> =
        seen.map(|index| left.get_pixel((index % WIDTH) as u32, (index / WIDTH) as u32).0).collect();
    let found: Vec<[u8; 3]> = vertices(&bench.read("m.ply")).into_iter().map(|(_, colour)| colour).collect();
    assert_eq!(found, colours);
}

#[test]
fn transparency_is_ignored() {
    let bench = bench_with_plane(5);
    let pair = Pair::shifted(WIDTH, HEIGHT, 5);
    let size = (WIDTH as u32, HEIGHT as u32);
    let alpha = |index: usize| (index * 31 % 256) as u8;
    let samples = pair.left.iter().enumerate().flat_map(|(index, &value)| [value, alpha(index)]).collect();
    let left = GrayAlphaImage::from_raw(size.0, size.1, samples).unwrap();
    let samples = pair.right.iter().enumerate().flat_map(|(index, &v)| [v, v, v, alpha(index)]).collect();
    let right = RgbaImage::from_raw(size.0, size.1, samples).unwrap();
    let views = [encode(&left.into(), ImageFormat::Png), encode(&right.into(), ImageFormat::Png)];
    let [left, right] = views;
    assert_same_map(&bench, [("la.png", left), ("ra.png", right)]);
}

#[test]
fn names_with_spaces_and_other_scripts_are_read_and_written() {
    let bench = bench_with_plane(5);
    let names = ["linke Ansicht.png", "右.png", "Tiefe über alles.pfm"];
    for (from, to) in ["left.png", "right.png"].into_iter().zip(names) {
        bench.write(to, bench.read(from));
    }
    let outcome = bench.run_with(["depth", names[0], names[1], "-o", names[2]], &[], Stdio::piped());
    assert_eq!((outcome.status, outcome.stderr.as_str()), (0, ""));
    assert_eq!(pfm(&bench, names[2]).width, WIDTH);
}

#[test]
fn help_and_version_go_to_the_standard_output() {
    let bench = Bench::new();
    for (line, told) in [
        ("--help", "Usage: haarline"),
        ("--version", "haarline 0."),
        ("depth --help", "--num-disparities"),
        ("eval --help", "--fail-over"),
        ("demo --help", "--seed"),
    ] {
        let outcome = bench.succeeds(line);
        assert!(outcome.stdout.contains(told), "{line}: {}", outcome.stdout);
    }
}
