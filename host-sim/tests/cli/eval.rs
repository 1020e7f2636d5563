//! `haarline eval` on good input, next to a scorer of this test's own.

use std::fs;
use std::process::Stdio;

use serde_json::{Value, json};

use crate::files::{Map, encode, png8, png16};
use crate::scene::{Scene, bench_with_scenes, grey_image, three_scenes};
use crate::tool::{Bench, assert_one_error_line};

const FIGURES: [&str; 8] = ["density", "bad1", "bad2", "tot05", "tot1", "tot2", "off10", "epe"];

/// What a map scores, from its files alone: the figures of [`FIGURES`], and the answers as confidence and
/// whether they are bad.
struct Independent {
    figures: [f64; 8],
    /// The same of the answers with a confidence of 16 or more.
    of_default: [f64; 8],
    scored: usize,
    answers: Vec<(u8, bool)>,
}

/// Scored are pixels with known truth that both cameras see, from column `num_disparities` on.
#[track_caller]
fn score(bench: &Bench, scenes: &str, maps: &str, scene: &Scene) -> Independent {
    let folder = format!("{scenes}/{}", scene.name);
    let truth = png16(&bench.read(&format!("{folder}/truth.png")));
    let nonocc = png8(&bench.read(&format!("{folder}/nonocc.png")));
    let meta: Value = serde_json::from_slice(&bench.read(&format!("{folder}/meta.json"))).unwrap();
    let first = meta["num_disparities"].as_u64().unwrap() as usize;
    let map = Map::from_pfm(&bench.read(&format!("{maps}/{}.pfm", scene.name)));
    let confidence = png8(&bench.read(&format!("{maps}/{}_confidence.png", scene.name)));
    let (mut scored, mut answers) = (0, Vec::new());
    for y in 0..map.height {
        for x in first..map.width {
            let index = y * map.width + x;
            if truth[index] == 0 || nonocc[index] != 255 {
                continue;
            }
            scored += 1;
            if map.px[index].is_finite() {
                let true_px = f64::from(truth[index]) / 256.0;
                answers.push((confidence[index], (f64::from(map.px[index]) - true_px).abs(), true_px));
            }
        }
    }
    let figures = |least: u8| {
        let answers = || answers.iter().filter(move |answer| answer.0 >= least);
        let (all, answered) = (f64::from(scored), answers().count() as f64);
        let over = |limit: f64| answers().filter(|&&(_, error, _)| error > limit).count() as f64;
        let over_tenth = answers().filter(|&&(_, error, true_px)| error > true_px / 10.0).count() as f64;
        [
            answered / all * 100.0,
            over(1.0) / answered * 100.0,
            over(2.0) / answered * 100.0,
            (over(0.5) + all - answered) / all * 100.0,
            (over(1.0) + all - answered) / all * 100.0,
            (over(2.0) + all - answered) / all * 100.0,
            (over_tenth + all - answered) / all * 100.0,
            answers().map(|answer| answer.1).sum::<f64>() / answered,
        ]
    };
    let (figures, of_default) = (figures(0), figures(16));
    let answers = answers.into_iter().map(|(confidence, error, _)| (confidence, error > 2.0)).collect();
    Independent { figures, of_default, scored: scored as usize, answers }
}

impl Independent {
    /// Percentage of bad ones among the `count` most confident answers; within equal confidence, the
    /// expected one.
    fn bad_among(&self, count: f64) -> f64 {
        let mut sorted = self.answers.clone();
        sorted.sort_by_key(|answer| std::cmp::Reverse(answer.0));
        let (mut left, mut bad) = (count, 0.0);
        for group in sorted.chunk_by(|one, other| one.0 == other.0) {
            let size = group.len() as f64;
            let taken = left.min(size);
            bad += group.iter().filter(|answer| answer.1).count() as f64 * taken / size;
            left -= taken;
        }
        100.0 * bad / count
    }
}

#[track_caller]
fn figure(json: &Value, key: &str) -> f64 {
    json[key].as_f64().unwrap_or_else(|| panic!("{key}: {json}"))
}

#[track_caller]
fn assert_figures(json: &Value, wanted: [f64; 8], what: &str) {
    for (key, wanted) in FIGURES.into_iter().zip(wanted) {
        let found = figure(json, key);
        assert!((found - wanted).abs() < 0.01, "{what}, {key}: {found}, not {wanted}");
    }
}

#[track_caller]
fn assert_classes(json: &Value, score: &Independent, what: &str) {
    let classes = json.as_array().unwrap();
    assert_eq!(classes.len(), 16, "{what}");
    for (index, class) in classes.iter().enumerate() {
        let inside: Vec<bool> =
            score.answers.iter().filter(|answer| usize::from(answer.0) / 16 == index).map(|answer| answer.1).collect();
        let share = inside.len() as f64 / score.scored as f64 * 100.0;
        assert!((figure(class, "pixels") - share).abs() < 0.01, "{what}, class {index}: {class}, not {share}");
        let wrong = inside.iter().filter(|&&is_wrong| is_wrong).count() as f64 / inside.len() as f64 * 100.0;
        let found = class["wrong"].as_f64();
        assert_eq!(found.is_some(), !inside.is_empty(), "{what}, class {index}");
        assert!(found.is_none_or(|found| (found - wrong).abs() < 0.01), "{what}, class {index}: {class}, not {wrong}");
    }
}

fn mean(of: &[[f64; 8]]) -> [f64; 8] {
    std::array::from_fn(|index| of.iter().map(|figures| figures[index]).sum::<f64>() / of.len() as f64)
}

#[test]
fn all_figures_equal_those_of_an_independent_scorer_on_its_maps() {
    let bench = bench_with_scenes();
    for options in ["--method full", "--method lite", "--method block", "--method lite --noise 12"] {
        let report = bench.succeeds(&format!("eval scenes {options} --json - -o maps")).json();
        let scenes = three_scenes();
        let found = scenes.each_ref().map(|scene| score(&bench, "scenes", "maps", scene));
        let figures = found.each_ref().map(|score| score.figures);
        assert!(figures.iter().flatten().all(|&value| value > 0.1), "every figure tells something: {figures:?}");
        for (scene, score) in scenes.iter().zip(&found) {
            let found = &report["scenes"][scene.name];
            assert_eq!(found["family"], scene.family);
            assert_figures(found, score.figures, &format!("{options}, {}", scene.name));
            assert_figures(&found["default_answers"], score.of_default, &format!("{options}, {}", scene.name));
            assert_classes(&found["confidence_classes"], score, &format!("{options}, {}", scene.name));
        }
        assert_eq!(report["scenes"].as_object().unwrap().len(), 3);
        assert_eq!(report["families"].as_object().unwrap().len(), 2);
        assert_figures(&report["families"]["indoor"], mean(&figures[..2]), options);
        assert_figures(&report["families"]["street"], figures[2], options);
        assert_figures(&report["mean"], mean(&figures), options);
    }
}

#[test]
fn the_tables_show_the_same_figures() {
    let bench = bench_with_scenes();
    let told = bench.succeeds("eval scenes -o maps").stdout;
    let scenes = three_scenes();
    let figures = scenes.each_ref().map(|scene| score(&bench, "scenes", "maps", scene).figures);
    let row = |begin: &str, after: &str| -> Vec<String> {
        let rest = &told[told.find(after).unwrap_or_else(|| panic!("{after}: {told}"))..];
        let line = rest.lines().find(|line| line.starts_with(begin)).unwrap_or_else(|| panic!("{begin}: {told}"));
        line.split_whitespace().map(str::to_owned).collect()
    };
    let shows = |cells: &[String], wanted: [f64; 8]| {
        for (cell, wanted) in cells.iter().zip(wanted) {
            let found: f64 = cell.parse().unwrap_or_else(|_| panic!("{cells:?}"));
            assert!((found - wanted).abs() < 0.0051, "{cells:?}, not {wanted}");
        }
    };
    for (scene, figures) in scenes.iter().zip(figures) {
        let cells = row(scene.name, "density");
        assert_eq!(cells[..2], [scene.name, scene.family]);
        shows(&cells[2..], figures);
    }
    shows(&row("full", "family indoor, 2 scenes")[1..], mean(&figures[..2]));
    shows(&row("full", "family street, 1 scene")[1..], figures[2]);
    shows(&row("full", "mean over 3 scenes")[1..], mean(&figures));
    let of_default = scenes.each_ref().map(|scene| score(&bench, "scenes", "maps", scene).of_default);
    shows(&row("full, default (>= 16)", "mean over 3 scenes")[4..], mean(&of_default));
}

#[test]
fn what_the_usual_score_leaves_out_is_scored_apart() {
    let bench = bench_with_scenes();
    let usual = bench.succeeds("eval scenes --json").json();
    let report = bench.succeeds("eval scenes --occluded --left-band --json - -o maps").json();
    assert!(usual["mean"]["occluded"].is_null() && usual["mean"]["left_band"].is_null());
    assert_eq!(report["mean"]["tot2"], usual["mean"]["tot2"]);
    for scene in three_scenes() {
        let map = Map::from_pfm(&bench.read(&format!("maps/{}.pfm", scene.name)));
        let tot2 = |is_inside: &dyn Fn(usize) -> bool| {
            let pixels: Vec<usize> =
                (0..map.px.len()).filter(|&index| scene.truth[index] != 0 && is_inside(index)).collect();
            let is_wrong = |&&index: &&usize| {
                let error = (f64::from(map.px[index]) - f64::from(scene.truth[index]) / 256.0).abs();
                !map.px[index].is_finite() || error > 2.0
            };
            100.0 * pixels.iter().filter(is_wrong).count() as f64 / pixels.len() as f64
        };
        let occluded = tot2(&|index| scene.nonocc[index] != 255);
        let left_band = tot2(&|index| scene.nonocc[index] == 255 && index % map.width < scene.num_disparities);
        let found = &report["scenes"][scene.name];
        assert!((figure(&found["occluded"], "tot2") - occluded).abs() < 0.01, "{found}, not {occluded}");
        assert!((figure(&found["left_band"], "tot2") - left_band).abs() < 0.01, "{found}, not {left_band}");
    }
    let told = bench.succeeds("eval scenes --occluded --left-band").stdout;
    assert!(told.contains("occluded (hidden") && told.contains("left band (columns"), "{told}");
}

/// A baselines file in which StereoBM has a density of its own on each scene.
fn baselines(densities: &[(&str, f64)]) -> String {
    let row = |density: f64| json!({ "density": density, "bad1": 30.5, "bad2": 21.25, "tot1": 60.0, "tot2": 50.0, "epe": 1.5 });
    let scenes: Value = densities.iter().map(|&(name, density)| (name.to_owned(), row(density))).collect();
    json!({ "methods": { "bm9/noise0": { "scenes": scenes }, "sgbm/noise0": { "scenes": scenes } } }).to_string()
}

#[test]
fn sparsified_figures_equal_independent_ones() {
    let bench = bench_with_scenes();
    let densities = [("alcove", 40.0), ("bench", 25.0), ("crossing", 71.5)];
    bench.write("baselines.json", baselines(&densities));
    for method in ["full", "lite", "block"] {
        let report = bench.succeeds(&format!("eval scenes --method {method} --json - -o maps")).json();
        assert_eq!(report["baselines"]["methods"]["bm9"]["scenes_compared"], 3, "found above the scenes");
        for (scene, (name, density)) in three_scenes().iter().zip(densities) {
            let independent = score(&bench, "scenes", "maps", scene);
            let answered = independent.answers.len() as f64;
            let at_density = independent.bad_among((density / 100.0 * independent.scored as f64).min(answered));
            let steps = 1000;
            let curve = (0..steps).map(|i| independent.bad_among((f64::from(i) + 0.5) / f64::from(steps) * answered));
            let area = curve.sum::<f64>() / f64::from(steps);
            let found = &report["scenes"][name];
            let (bad2, auc) = (figure(found, "bad2_at_bm_density"), figure(found, "auc"));
            assert!((bad2 - at_density).abs() < 0.01, "{method}, {name}: {bad2}, not {at_density}");
            assert!((auc - area).abs() < 0.05, "{method}, {name}: {auc}, not {area}");
        }
    }
}

#[test]
fn opencv_s_figures_are_shown_beside_from_the_file_named() {
    let bench = bench_with_scenes();
    let told = bench.succeeds("eval scenes").stdout;
    assert!(told.contains("none found") && !told.contains("StereoBM 9  "), "{told}");
    bench.write("other/figures.json", baselines(&[("alcove", 40.0), ("bench", 25.0)]));
    let told = bench.succeeds("eval scenes --baselines other/figures.json").stdout;
    for words in ["other/figures.json", "StereoBM 9 (2 scenes)", "StereoSGBM (2 scenes)", "21.25"] {
        assert!(told.contains(words), "{words}: {told}");
    }
    let told = bench.succeeds("eval scenes --baselines other/figures.json --gain 0.8").stdout;
    assert!(told.contains("NOT as degraded here"), "{told}");
}

#[test]
fn its_maps_are_those_of_depth() {
    let bench = bench_with_scenes();
    for method in ["full", "lite", "block"] {
        bench.succeeds(&format!("eval scenes -o maps --method {method}"));
        for Scene { name, num_disparities, .. } in three_scenes() {
            bench.succeeds(&format!(
                "depth scenes/{name}/left.png scenes/{name}/right.png --num-disparities {num_disparities} \
                 --method {method} --min-confidence 0 -o m.pfm --confidence c.png"
            ));
            assert_eq!(bench.read("m.pfm"), bench.read(&format!("maps/{name}.pfm")), "{method}, {name}");
            assert_eq!(bench.read("c.png"), bench.read(&format!("maps/{name}_confidence.png")), "{method}, {name}");
        }
    }
}

#[test]
fn gain_and_offset_change_the_right_view_alone() {
    let bench = bench_with_scenes();
    for (options, gain, offset) in
        [("--gain 0.8", 0.8, 0.0), ("--offset -25", 1.0, -25.0), ("--gain 1.2 --offset 30.5", 1.2, 30.5)]
    {
        let report = bench.succeeds(&format!("eval scenes --only alcove --json - -o maps {options}")).json();
        assert_eq!((figure(&report, "gain"), figure(&report, "offset")), (gain, offset));
        let [scene, ..] = three_scenes();
        let pair = &scene.pair;
        let changed = |&value: &u8| (f64::from(value) * gain + offset).round_ties_even().clamp(0.0, 255.0) as u8;
        let right: Vec<u8> = pair.right.iter().map(changed).collect();
        bench.write("dim.png", encode(&grey_image(pair.width, pair.height, &right), image::ImageFormat::Png));
        bench.succeeds("depth scenes/alcove/left.png dim.png --num-disparities 16 --min-confidence 0 -o m.pfm");
        assert!(bench.read("m.pfm") == bench.read("maps/alcove.pfm"), "{options}");
    }
}

/// Every figure and map of a run.
fn run(bench: &Bench, options: &str) -> (Value, Vec<Vec<u8>>) {
    let _ = fs::remove_dir_all(bench.path("maps"));
    let report = bench.succeeds(&format!("eval scenes --method lite --json - -o maps {options}")).json();
    let files = three_scenes().map(|scene| bench.path(format!("maps/{}.pfm", scene.name)));
    (report, files.iter().filter_map(|file| fs::read(file).ok()).collect())
}

#[test]
fn noise_is_the_same_for_the_same_seed_and_another_for_another() {
    let bench = bench_with_scenes();
    let noisy = run(&bench, "--noise 8 --seed 3");
    assert!(noisy == run(&bench, "--noise 8 --seed 3"));
    assert!(run(&bench, "--noise 8") == run(&bench, "--noise 8 --seed 0"));
    let other = run(&bench, "--noise 8 --seed 4");
    assert!(noisy.1 != other.1 && noisy.0["mean"] != other.0["mean"]);
    let clean = run(&bench, "");
    assert!(clean.1 != noisy.1);
    assert_eq!(clean.1, run(&bench, "--noise 0 --seed 9 --gain 1 --offset 0").1);
    assert!(figure(&noisy.0["mean"], "tot2") > figure(&clean.0["mean"], "tot2"));
}

#[test]
fn only_the_scenes_named_are_scored_and_as_among_all() {
    let bench = bench_with_scenes();
    let (all, maps) = run(&bench, "--noise 8 --seed 3");
    let (some, some_maps) = run(&bench, "--noise 8 --seed 3 --only crossing,alcove");
    let names: Vec<&String> = some["scenes"].as_object().unwrap().keys().collect();
    assert_eq!(names, ["alcove", "crossing"]);
    for name in names {
        assert_eq!(some["scenes"][name], all["scenes"][name]);
    }
    assert_eq!(some_maps, [maps[0].clone(), maps[2].clone()]);
    let (one, _) = run(&bench, "--noise 8 --seed 3 --only bench");
    assert_eq!(one["mean"]["tot2"], all["scenes"]["bench"]["tot2"]);
}

#[test]
fn the_halves_are_apart_and_together_all() {
    let bench = bench_with_scenes();
    let names = |options: &str| -> Vec<String> {
        let report = bench.succeeds(&format!("eval scenes --method lite --json - {options}")).json();
        report["scenes"].as_object().unwrap().keys().cloned().collect()
    };
    assert_eq!(names("--split A"), ["alcove", "crossing"]);
    assert_eq!(names("--split B"), ["bench"]);
    assert_eq!(names("--split B --only bench,crossing"), ["bench"]);
    bench.refuses("eval scenes --split B --only crossing", &["--split B", "none"]);
    bench.refuses("eval scenes --split C", &["--split", "A"]);
}

#[test]
fn a_single_scene_s_folder_is_accepted() {
    let bench = bench_with_scenes();
    let all = bench.succeeds("eval scenes --json -").json();
    for folder in ["scenes/bench", "scenes/bench/", "scenes/alcove/../bench"] {
        let one = bench.succeeds(&format!("eval {folder} --json -")).json();
        assert_eq!(one["scenes"]["bench"], all["scenes"]["bench"], "{folder}");
    }
}

#[test]
fn what_is_no_scene_beside_the_scenes_is_passed_over() {
    let bench = bench_with_scenes();
    let before = bench.succeeds("eval scenes --json -").stdout;
    bench.write("scenes/README.md", "scenes");
    bench.write("scenes/notes/list.txt", "none");
    assert_eq!(bench.succeeds("eval scenes --json -").stdout, before);
}

#[test]
fn json_goes_to_a_file_beside_the_tables_or_alone_to_the_standard_output() {
    let bench = bench_with_scenes();
    let tables = bench.succeeds("eval scenes").stdout;
    assert_eq!(bench.succeeds("eval scenes --json report.json").stdout, tables);
    let alone = bench.succeeds("eval scenes --json -");
    assert_eq!(alone.stdout.as_bytes(), bench.read("report.json"));
    let report = alone.json();
    for key in ["noise", "gain", "offset", "seed"] {
        assert!(report[key].is_number(), "{key}: {report}");
    }
    assert_eq!(report["method"], "full");
    assert!(!bench.path("-").exists());
}

#[test]
fn one_thread_gives_what_many_give() {
    let bench = bench_with_scenes();
    let run = |threads: &str| {
        let _ = fs::remove_dir_all(bench.path("maps"));
        let line = "eval scenes --noise 5 --seed 2 -o maps --json report.json";
        let outcome = bench.run_with(line.split(' '), &[("RAYON_NUM_THREADS", threads)], Stdio::piped());
        assert_eq!((outcome.status, outcome.stderr.as_str()), (0, ""));
        (outcome.stdout, bench.content())
    };
    let alone = run("1");
    assert_eq!(alone.1.keys().filter(|path| path.starts_with(bench.path("maps"))).count(), 1 + 3 * 3);
    assert!(alone == run("4") && alone == run("7"));
}

#[test]
fn a_mean_over_its_limit_ends_with_status_1_after_everything_is_told() {
    let bench = bench_with_scenes();
    let usual = bench.succeeds("eval scenes --json -");
    let tot2 = figure(&usual.json()["mean"], "tot2");
    for limits in [format!("--fail-over tot2={}", tot2 + 0.01), "--fail-over epe=99 --fail-over bad1=100".to_owned()] {
        assert_eq!(bench.succeeds(&format!("eval scenes --json - {limits}")).stdout, usual.stdout, "{limits}");
    }
    let over = format!("--fail-over tot2={}", tot2 - 0.01);
    for limits in [over.clone(), format!("--fail-over epe=99 {over}"), "--fail-over tot2=-1".to_owned()] {
        let outcome = bench.run(&format!("eval scenes --json - {limits}"));
        assert_eq!((outcome.status, &outcome.stdout), (1, &usual.stdout), "{limits}");
        assert_one_error_line(&outcome.stderr, &limits);
        assert!(outcome.stderr.contains("tot2") && !outcome.stderr.contains("epe"), "{}", outcome.stderr);
    }
    let outcome = bench.run("eval scenes --json report.json -o maps --fail-over tot1=0");
    assert_eq!(outcome.status, 1);
    assert_eq!(bench.read("report.json"), usual.stdout.as_bytes());
    assert!(bench.path("maps/bench.pfm").is_file());
}
