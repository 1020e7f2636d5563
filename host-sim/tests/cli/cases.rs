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
