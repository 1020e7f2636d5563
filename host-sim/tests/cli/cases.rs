//! `haarline scene` and what `haarline eval` tells of the evidence on such scenes.

use crate::files::Map;
use crate::tool::Bench;

#[test]
fn scenes_come_from_the_seed_and_eval_reads_them() {
    let bench = Bench::new();
    let told = bench.succeeds("scene planes -o planes --only plane_00,plane_07").stdout;
    assert!(told.contains("2 scenes") && told.contains("haarline eval planes"), "{told}");
    let left = bench.read("planes/plane_07/left.png");
    let report = bench.succeeds("eval planes --method lite --json -").json();
    assert_eq!(report["scenes"].as_object().unwrap().len(), 2);
    // A plane is answered nearly everywhere, to a fraction of a pixel.
    let mean = &report["mean"];
    assert!(mean["density"].as_f64().unwrap() > 95.0 && mean["epe"].as_f64().unwrap() < 0.25, "{mean}");
    bench.succeeds("scene planes -o planes --only plane_07");
    assert_eq!(bench.read("planes/plane_07/left.png"), left);
    bench.succeeds("scene planes -o planes --only plane_07 --seed 1");
    assert_ne!(bench.read("planes/plane_07/left.png"), left);
}

#[test]
fn a_scene_that_is_not_there_is_named_and_nothing_is_written() {
    let bench = Bench::new();
    bench.refuses("scene fences -o here --only fence_p99", &["fence_p99", "fence_p08"]);
    assert!(!bench.path("here").exists());
}

#[test]
fn sure_answers_are_counted_as_on_the_maps_that_eval_writes() {
    let bench = Bench::new();
    bench.succeeds("scene slats -o slats --only slats_00");
    let report = bench.succeeds("eval slats --method lite --json - -o maps --sure-from 100").json();
    let map = Map::from_pfm(&bench.read("maps/slats_00.pfm"));
    let confidence = crate::files::png8(&bench.read("maps/slats_00_confidence.png"));
    let truth = crate::files::png16(&bench.read("slats/slats_00/truth.png"));
    let seen = crate::files::png8(&bench.read("slats/slats_00/nonocc.png"));
    let (mut scored, mut sure, mut wrong, mut near) = (0, 0, 0, 0);
    for index in (0..truth.len()).filter(|&i| i % map.width >= 48 && seen[i] == 255 && truth[i] > 0) {
        scored += 1;
        let error = f64::from(map.px[index]) - f64::from(truth[index]) / 256.0;
        if confidence[index] >= 100 {
            sure += 1;
            wrong += i32::from(error.abs() > 2.0);
            near += i32::from(error > 2.0);
        }
    }
    let scene = &report["scenes"]["slats_00"];
    for (key, count, of) in [
        ("sure_density", sure, scored),
        ("sure_bad2", wrong, sure),
        ("sure_wrong", wrong, scored),
        ("sure_near", near, scored),
    ] {
        let wanted = 100.0 * f64::from(count) / f64::from(of);
        assert!((scene[key].as_f64().unwrap() - wanted).abs() < 1e-9, "{key}: {scene}, wanted {wanted}");
        assert_eq!(report["sure"]["mean"][key], scene[key]);
        assert_eq!(report["sure"]["worst"][key], scene[key]);
    }
    let told = bench.succeeds("eval slats --method lite --sure").stdout;
    for words in ["sure answers", "worst of slats", "hidden s&w"] {
        assert!(told.contains(words), "{words}: {told}");
    }
}

#[test]
fn a_post_on_the_ground_is_found_and_one_that_is_painted_over_is_missed() {
    let bench = Bench::new();
    bench.succeeds("scene obstacles -o scenes --only post_1000mm");
    let obstacles = |options: &str| bench.succeeds(&format!("eval scenes --obstacles --json - {options}")).json();
    let report = obstacles("");
    let nearest = &report["obstacles"]["nearest"];
    assert_eq!((&nearest["obstacles"], &nearest["found"]), (&1.into(), &1.into()), "{report}");
    assert_eq!(report["obstacles"]["phantom_frames"], 0);
    assert_eq!(report["obstacles"]["by_range"]["from 0.7 m"]["found"], 1, "{report}");
    // Nothing is as sure as that.
    let nearest = obstacles("--sure-from 255 --noise 20")["obstacles"]["nearest"].clone();
    assert_eq!((&nearest["missed"], &nearest["found"]), (&1.into(), &0.into()), "{nearest}");
    let told = bench.succeeds("eval scenes --obstacles").stdout;
    assert!(told.contains("nearest of a frame") && told.contains("phantoms"), "{told}");
}

/// The views of a rendered plane, in place of a pair of one's own.
fn plane(bench: &Bench) {
    bench.succeeds("scene planes -o planes --only plane_00");
}

#[test]
fn views_that_do_not_match_are_warned_of_once_and_right_ones_are_not() {
    let bench = Bench::new();
    plane(&bench);
    let (left, right) = ("planes/plane_00/left.png", "planes/plane_00/right.png");
    let summary = bench.succeeds(&format!("depth {left} {right} --json")).json();
    assert_eq!((&summary["input_ok"], &summary["input"]), (&true.into(), &"ok".into()), "{summary}");
    assert!(summary["mismatch_percent"].as_f64().unwrap() < 27.0 && summary["share_sure"].as_f64().unwrap() > 10.0);
    for (views, input, words) in [
        (format!("{right} {left}"), "mismatch", "swapped"),
        (format!("{left} {right} --row-offset 6"), "mismatch", "rectified"),
        (format!("{left} {left}"), "same-view", "same image"),
        (format!("{left} {right} --both-gain 0 --noise 2"), "nothing-seen", "lens cap"),
        (format!("{left} {right} --random"), "nothing-seen", "lens cap"),
    ] {
        let outcome = bench.run(&format!("depth {views} --json"));
        let summary = outcome.json();
        assert_eq!((&summary["input_ok"], &summary["input"]), (&false.into(), &input.into()), "{views}: {summary}");
        assert_eq!((outcome.status, outcome.stderr.lines().count()), (0, 1), "{views}: {}", outcome.stderr);
        assert!(outcome.stderr.starts_with("warning: ") && outcome.stderr.contains(words), "{}", outcome.stderr);
    }
}

#[test]
fn a_recording_of_swapped_views_has_one_warning_and_no_obstacles() {
    let bench = Bench::new();
    bench.succeeds("scene obstacles -o scenes --only post_1000mm,box_1500mm");
    for (scene, name) in [("post_1000mm", "0.png"), ("box_1500mm", "1.png")] {
        for (view, side) in [("left", "right"), ("right", "left")] {
            bench.write(&format!("swapped/{side}/{name}"), bench.read(&format!("scenes/{scene}/{view}.png")));
            bench.write(&format!("take/{view}/{name}"), bench.read(&format!("scenes/{scene}/{view}.png")));
        }
    }
    let rig = "--rig scenes/post_1000mm/rig.toml";
    let summary = bench.succeeds(&format!("play take -o out {rig} --json")).json();
    assert_eq!((&summary["input_ok"], &summary["frames_with_obstacles"]), (&true.into(), &2.into()), "{summary}");
    let outcome = bench.run(&format!("play swapped -o wrong {rig} --json --mavlink wrong.mav --free-beyond 4"));
    assert_eq!((outcome.status, outcome.stderr.lines().count()), (0, 1), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("2 of 2 frames") && outcome.stderr.contains("swapped"), "{}", outcome.stderr);
    let summary = outcome.json();
    assert_eq!((&summary["wrong_input"]["mismatch"], &summary["frames_with_obstacles"]), (&2.into(), &0.into()));
    let table = String::from_utf8(bench.read("wrong/frames.csv")).unwrap();
    assert!(table.lines().nth(1).is_some_and(|line| line.contains(",mismatch,")), "{table}");
}

#[test]
fn the_yard_is_scored_part_by_part() {
    let bench = Bench::new();
    let told = bench.succeeds("demo --scene yard -o yard").stdout;
    let parts = ["fence", "blank wall", "dark corner", "hidden strips", "sure and wrong %"];
    parts.into_iter().for_each(|part| assert!(told.contains(part), "{part}: {told}"));
    let figures = bench.succeeds("demo --scene yard -o yard --json --noise 0").json();
    let regions = figures["regions"].as_array().unwrap();
    assert_eq!(regions.len(), 7);
    for region in regions {
        let share = |key: &str| region[key].as_f64().unwrap();
        assert!(share("sure_wrong_percent") <= share("wrong_percent") && share("pixels") > 100.0, "{region}");
        assert!(share("wrong_percent") <= share("answered_percent"), "{region}");
    }
}
