//! `haarline demo`: no file needed, a scene with known truth and what the core makes of it.

use serde_json::Value;

use crate::files::{Map, png, png8, vertices};
use crate::tool::Bench;

const FIGURES: [&str; 6] = ["density", "bad1", "bad2", "tot1", "tot2", "epe"];

#[track_caller]
fn number(json: &Value, key: &str) -> f64 {
    json[key].as_f64().unwrap_or_else(|| panic!("{key}: {json}"))
}

#[test]
fn it_writes_the_files_it_names_where_it_is_told() {
    let bench = Bench::new();
    let figures = bench.succeeds("demo -o pictures/room --json").json();
    assert_eq!(figures["folder"], "pictures/room");
    let named: Vec<&str> = figures["files"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let mut found: Vec<String> = std::fs::read_dir(bench.path("pictures/room"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    found.sort();
    let mut wanted = named.clone();
    wanted.sort_unstable();
    assert_eq!(found, wanted);
    let (width, height) = (number(&figures, "width") as u32, number(&figures, "height") as u32);
    for name in named {
        let bytes = bench.read(&format!("pictures/room/{name}"));
        match name.rsplit_once('.').unwrap().1 {
            "png" => {
                let image = png(&bytes);
                assert!(image.width() >= width && image.height() >= height, "{name}");
            }
            "pfm" => assert_eq!(Map::from_pfm(&bytes).width, width as usize),
            "ply" => assert!(!vertices(&bytes).is_empty()),
            "json" => assert!(serde_json::from_slice::<Value>(&bytes).unwrap().is_object()),
            _ => panic!("{name}: of what kind?"),
        }
    }
}

#[test]
fn without_options_it_prints_accuracy_and_the_wall_and_names_its_files() {
    let bench = Bench::new();
    let told = bench.succeeds("demo").stdout;
    for words in ["off by more than 2 px", "blank wall", "% wrong", " ms", "haarline eval out/demo", "haarline depth"] {
        assert!(told.contains(words), "{words}: {told}");
    }
    for name in ["disparity_picture.png", "truth_picture.png", "disparity.pfm", "cloud.ply", "left.png"] {
        assert!(told.contains(&format!("out/demo/{name}")), "{name}: {told}");
        assert!(bench.path("out/demo").join(name).is_file(), "{name}");
    }
}

#[test]
fn the_commands_it_proposes_work_and_are_of_the_same_scene() {
    for scene in ["", " --scene rover --seed 3 -o out/rover"] {
        let bench = Bench::new();
        let told = bench.succeeds(&format!("demo{scene}")).stdout;
        let proposed: Vec<&str> = told.lines().filter_map(|line| line.strip_prefix("  haarline ")).collect();
        assert_eq!(proposed.len(), 3, "{told}");
        assert!(proposed.iter().any(|line| scene.is_empty() || line.contains("--scene rover --seed 3")), "{told}");
        for line in proposed {
            bench.succeeds(line);
        }
    }
}

#[test]
fn the_rover_s_rig_is_written_and_its_post_is_found_by_it() {
    let bench = Bench::new();
    bench.succeeds("demo --scene rover -o rover");
    let told = bench.succeeds("depth rover/left.png rover/right.png --rig rover/rig.toml --json").json();
    assert!((1400..=1600).contains(&told["nearest_obstacle_mm"].as_u64().unwrap()), "{told}");
    assert_eq!(told["nearest_obstacle_deg"], 0, "{told}");
    let told = bench.succeeds("depth rover/left.png rover/right.png --rig rover/rig.toml").stdout;
    assert!(told.contains(", nearest obstacle 1.4") && told.contains(" m at 0 degrees"), "{told}");
}

#[test]
fn few_answers_on_the_blank_wall_are_sure_and_wrong() {
    let bench = Bench::new();
    for seed in [0, 1] {
        let figures = bench.succeeds(&format!("demo -o room --json --method wavelet-block --seed {seed}")).json();
        assert!(number(&figures, "wall_pixels") > 10_000.0, "{figures}");
        let wrong = number(&figures, "wall_wrong_percent");
        assert!(number(&figures, "wall_answered_percent") >= wrong);
        let sure = number(&figures, "wall_sure_wrong_percent");
        assert!(sure <= wrong && (0.0..=1.5).contains(&sure), "seed {seed}: {sure} %");
    }
}

#[test]
fn eval_on_its_folder_agrees() {
    let bench = Bench::new();
    for method in ["full", "lite", "block"] {
        let figures = bench.succeeds(&format!("demo -o room --json --method {method}")).json();
        let report = bench.succeeds(&format!("eval room --method {method} --json - -o maps")).json();
        let scene = &report["scenes"]["room"];
        assert_eq!(scene["family"], "synthetic");
        for key in FIGURES {
            let (demo, eval) = (number(&figures, key), number(scene, key));
            assert!((demo - eval).abs() < 1e-9, "{method}, {key}: {demo} and {eval}");
        }
        // What is shown is what eval scores, without the guesses.
        let least = if method == "block" { 0 } else { 16 };
        let (shown, all) =
            (Map::from_pfm(&bench.read("room/disparity.pfm")), Map::from_pfm(&bench.read("maps/room.pfm")));
        let [sure, confidence] =
            ["room/confidence.png", "maps/room_confidence.png"].map(|file| png8(&bench.read(file)));
        for index in 0..all.px.len() {
            let kept = confidence[index] >= least;
            let wanted = if kept { (all.px[index], confidence[index]) } else { (f32::INFINITY, 0) };
            assert_eq!((shown.px[index], sure[index]), wanted, "{method}, pixel {index}");
        }
    }
}

#[test]
fn the_seed_decides_and_noise_makes_it_worse() {
    let bench = Bench::new();
    let run = |options: &str| {
        let figures = bench.succeeds(&format!("demo -o room --method lite --json {options}")).json();
        (bench.read("room/left.png"), bench.read("room/disparity.pfm"), number(&figures, "tot2"))
    };
    let first = run("--seed 5");
    assert!(first == run("--seed 5"));
    assert_ne!(first.0, run("--seed 6").0);
    let noisy = run("--seed 5 --noise 25");
    assert!(noisy.2 > first.2 + 1.0, "tot2 {} and {} with noise", first.2, noisy.2);
    assert_eq!(bench.read("room/truth.png"), {
        run("--seed 5");
        bench.read("room/truth.png")
    });
}
