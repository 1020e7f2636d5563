//! Views made worse on purpose, gifts for any method, and finished maps: `haarline eval` and `depth`.

use image::ImageFormat;
use serde_json::Value;

use crate::files::{Map, encode, png8};
use crate::scene::{bench_with_scenes, grey_image, grey16_image, three_scenes};
use crate::tool::Bench;

/// The views of a scene as the method got them.
fn views(bench: &Bench, options: &str, scene: &str) -> [Vec<u8>; 2] {
    bench.succeeds(&format!("eval scenes --method lite --only {scene} --write-views views --json r.json {options}"));
    ["left", "right"].map(|view| png8(&bench.read(&format!("views/{scene}/{view}.png"))))
}

fn report(bench: &Bench, options: &str) -> Value {
    bench.succeeds(&format!("eval scenes --json - {options}")).json()
}

#[test]
fn each_degradation_does_what_it_says() {
    let bench = bench_with_scenes();
    let [scene, ..] = three_scenes();
    let (width, height) = (scene.pair.width, scene.pair.height);
    let clean = [scene.pair.left.clone(), scene.pair.right.clone()];
    assert_eq!(views(&bench, "", "alcove"), clean);
    assert_eq!(views(&bench, "--row-offset 0 --roll 0 --row-scale 1 --bits 8 --seed 4", "alcove"), clean);

    let [left, right] = views(&bench, "--swap", "alcove");
    assert_eq!([right, left], clean);

    let [left, right] = views(&bench, "--row-offset 3", "alcove");
    assert_eq!(left, clean[0]);
    assert_eq!(right[3 * width..], clean[1][..(height - 3) * width]);
    assert_eq!(right[width..2 * width], clean[1][..width], "the border goes on");

    for options in ["--roll 2", "--row-scale 1.05", "--row-offset 0.5"] {
        let [left, right] = views(&bench, options, "alcove");
        assert_eq!(left, clean[0], "{options}");
        let middle = height / 2 * width + width / 2;
        let distance = |a: &[u8], b: &[u8]| a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum::<u32>();
        assert!(distance(&right, &clean[1]) > 4 * (width * height) as u32, "{options}");
        if !options.contains("offset") {
            let around = middle - 1..middle + 2;
            assert!(distance(&right[around.clone()], &clean[1][around]) < 150, "{options}: the centre stays");
        }
    }

    let [left, right] = views(&bench, "--bits 4", "alcove");
    for (few, all) in [(&left, &clean[0]), (&right, &clean[1])] {
        assert!(few.iter().zip(all).all(|(few, all)| *few == all / 16 * 17));
    }

    let random = views(&bench, "--random --seed 1", "alcove");
    assert_eq!(random, views(&bench, "--random --seed 1", "alcove"));
    let other = views(&bench, "--random --seed 2", "alcove");
    assert!(random[0] != random[1] && random[0] != other[0] && random[0] != clean[0]);

    let [left, right] = views(&bench, "--right-from crossing", "alcove");
    assert_eq!(left, clean[0]);
    let crossing = &three_scenes()[2].pair;
    assert!((0..height).all(|y| right[y * width..][..width] == crossing.right[y * crossing.width..][..width]));
    let by_path = views(&bench, "--right-from scenes/crossing", "alcove");
    assert_eq!(by_path[1], right);
}

#[test]
fn depth_sees_what_eval_sees() {
    let bench = bench_with_scenes();
    let all = [
        "--noise 7 --seed 3",
        "--gain 0.8 --offset 9 --both-gain 0.7",
        "--shot-noise 0.5 --pattern-noise 2",
        "--row-offset 1.5 --roll 0.5 --row-scale 1.01",
        "--swap --bits 5",
        "--random --seed 9",
        "--right-from scenes/crossing",
    ];
    for options in all {
        bench.succeeds(&format!("eval scenes --only alcove -o maps {options}"));
        bench.succeeds_on_odd_views(&format!(
            "depth scenes/alcove/left.png scenes/alcove/right.png --num-disparities 16 --min-confidence 0 -o m.pfm {options}"
        ));
        assert!(bench.read("m.pfm") == bench.read("maps/alcove.pfm"), "{options}");
    }
}

#[test]
fn what_was_done_is_told() {
    let bench = bench_with_scenes();
    let cases = [
        ("--row-offset -1.5", "right view rows lower by -1.5"),
        ("--roll 1", "right view turned by degrees 1"),
        ("--row-scale 0.99", "right view stretched down by 0.99"),
        ("--swap", "views swapped"),
        ("--right-from bench", "right views of bench"),
        ("--bits 6", "6 bits"),
        ("--random --seed 5", "random views (seed 5)"),
        ("--smooth", "smoothed"),
        ("--fill", "holes filled"),
    ];
    for (options, words) in cases {
        let told = bench.succeeds(&format!("eval scenes --method lite {options}")).stdout;
        let first = told.lines().next().unwrap();
        assert!(first.contains(words), "{options}: {first}");
    }
    let report = report(&bench, "--row-offset 2 --bits 7 --fill --right-from bench");
    assert_eq!((&report["row_offset"], &report["bits"], &report["fill"]), (&2.0.into(), &7.into(), &true.into()));
    assert_eq!((&report["right_from"], &report["smooth"]), (&"bench".into(), &false.into()));
}

#[test]
fn impossible_degradations_are_refused() {
    let bench = bench_with_scenes();
    let cases = [
        ("--row-offset 65", "-64 to 64"),
        ("--row-offset NaN", "-64 to 64"),
        ("--roll 46", "-45 to 45"),
        ("--roll x", "number"),
        ("--row-scale 0", "0.5 to 2"),
        ("--row-scale inf", "0.5 to 2"),
        ("--bits 0", "1 to 8"),
        ("--bits 9", "1 to 8"),
        ("--bits 3.5", "whole number"),
        ("--right-from attic", "no such scene"),
        ("--right-from scenes", "scenes/right.png"),
    ];
    for (options, told) in cases {
        bench
            .refuses(&format!("eval scenes --json r.json {options}"), &[options.split(' ').next().unwrap(), told][1..]);
        bench.refuses(&format!("depth scenes/bench/left.png scenes/bench/right.png {options}"), &[told]);
    }
    bench.refuses("eval scenes --random --right-from bench", &["--right-from", "--random"]);
    bench.refuses("eval scenes --write-views scenes", &["--write-views", "would be replaced"]);
    bench.refuses("eval scenes/bench --write-views scenes", &["--write-views", "would be replaced"]);
}

#[test]
fn filled_maps_answer_everything_as_a_guess() {
    let bench = bench_with_scenes();
    for method in ["contour", "block"] {
        let plain = report(&bench, &format!("--method {method}"));
        let filled = report(&bench, &format!("--method {method} --fill -o maps"));
        assert!(plain["mean"]["density"].as_f64().unwrap() < 99.0, "{method} leaves holes: {plain}");
        assert!(filled["mean"]["density"].as_f64() > plain["mean"]["density"].as_f64(), "{filled}");
        assert_eq!(filled["mean"]["default_answers"], plain["mean"]["default_answers"]);
        bench.succeeds(&format!(
            "depth scenes/bench/left.png scenes/bench/right.png --num-disparities 16 --method {method} --fill -o m.pfm"
        ));
        assert!(bench.read("m.pfm") == bench.read("maps/bench.pfm"));
    }
}

#[test]
fn noisy_views_are_smoothed() {
    let bench = bench_with_scenes();
    let roughness = |options: &str| {
        let [left, right] = views(&bench, options, "alcove");
        let of = |view: &[u8]| view.windows(2).map(|pair| u32::from(pair[0].abs_diff(pair[1]))).sum::<u32>();
        [of(&left), of(&right)]
    };
    let (noisy, smoothed) = (roughness("--noise 25"), roughness("--noise 25 --smooth"));
    assert!(smoothed[0] < noisy[0] / 2 && smoothed[1] < noisy[1] / 2, "{smoothed:?} of {noisy:?}");
    assert_ne!(report(&bench, "--method block --smooth")["mean"], report(&bench, "--method block")["mean"]);
}

#[test]
fn finished_maps_score_as_the_method_that_made_them() {
    let bench = bench_with_scenes();
    let made = report(&bench, "-o maps --occluded");
    let read = report(&bench, "--maps maps --occluded");
    assert_eq!(read["method"], "maps in maps");
    for key in ["mean", "families"] {
        assert_eq!(read[key], made[key], "{key}");
    }
    // How well the views match the method works out itself, from its features; of a map the host does, from grey levels.
    let scored = |report: &Value| {
        let mut scenes = report["scenes"].clone();
        for (_, scene) in scenes.as_object_mut().unwrap() {
            for figure in ["input", "input_ok", "mismatch_percent", "share_sure"] {
                scene.as_object_mut().unwrap().remove(figure);
            }
        }
        scenes
    };
    assert_eq!(scored(&read), scored(&made));
    let filled = report(&bench, "--maps maps --fill");
    assert_eq!(filled["mean"], report(&bench, "--fill")["mean"]);

    // The same as KITTI's files; without confidences all of them are sure.
    for scene in three_scenes() {
        let map = Map::from_pfm(&bench.read(&format!("maps/{}.pfm", scene.name)));
        let q8 = map.px.iter().map(|px| if px.is_finite() { (px * 256.0).max(1.0) as u16 } else { 0 });
        let image = grey16_image(map.width, map.height, &q8.collect::<Vec<_>>());
        bench.write(&format!("kitti/{}.png", scene.name), encode(&image, ImageFormat::Png));
    }
    let kitti = report(&bench, "--maps kitti");
    for key in ["density", "tot05", "tot2", "off10", "epe"] {
        assert_eq!(kitti["mean"][key], made["mean"][key], "{key}");
        assert_eq!(kitti["mean"]["default_answers"][key], made["mean"][key], "{key}");
    }
}

#[test]
fn maps_that_are_none_are_refused() {
    let bench = bench_with_scenes();
    bench.succeeds("eval scenes -o maps");
    bench.refuses("eval scenes --maps nowhere", &["nowhere/alcove.pfm", "no map"]);
    bench.refuses("eval scenes --maps maps -o maps", &["-o maps"]);
    for options in ["--method lite", "--smooth", "--write-views v", "--right-from bench"] {
        bench.refuses(&format!("eval scenes --maps maps {options}"), &["--maps"]);
    }
    let map = bench.read("maps/alcove.pfm");
    bench.write("maps/alcove.pfm", &map[..map.len() - 1]);
    bench.refuses("eval scenes --maps maps", &["maps/alcove.pfm", "bytes of samples"]);
    bench.write("maps/alcove.pfm", bench.read("maps/bench.pfm"));
    bench.refuses("eval scenes --maps maps", &["maps/alcove.pfm", "80x33", "96x40"]);
    bench.write("maps/alcove.pfm", "hello");
    bench.refuses("eval scenes --maps maps", &["maps/alcove.pfm", "no PFM"]);
    bench.write("maps/alcove.pfm", map);
    bench.write("maps/alcove.png", encode(&grey_image(96, 40, &[0; 96 * 40]), ImageFormat::Png));
    bench.refuses("eval scenes --maps maps", &["alcove.png", "not two"]);
    std::fs::remove_file(bench.path("maps/alcove.pfm")).unwrap();
    bench.refuses("eval scenes --maps maps", &["alcove.png", "16 bits"]);
}
