//! `haarline power plan`: what it tells, and what it refuses.

use crate::tool::{Bench, Outcome};

/// Plans: it succeeds, and warns in one line of what nobody looked up.
#[track_caller]
fn planned(bench: &Bench, line: &str) -> Outcome {
    let outcome = bench.run(line);
    assert_eq!(outcome.status, 0, "haarline {line}: {}", outcome.stderr);
    assert!(outcome.stderr.lines().count() <= 1 && outcome.stderr.contains("not verified"), "{}", outcome.stderr);
    outcome
}

#[test]
fn a_plan_that_fits_tells_its_budget_and_marks_what_nobody_looked_up() {
    let bench = Bench::new();
    let run = planned(
        &bench,
        "power plan --board h743 --size 320x240 --fps 25 --method lite --battery 1000mAh --volts 3.7 --json",
    );
    let plan = run.json();
    let budget = &plan["budget"];
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let total =
        number(&budget["core_mw"]["likely"]) + number(&budget["sensors_mw"]) + number(&budget["supply_mw"]["likely"]);
    assert!((total - number(&budget["total_mw"]["likely"])).abs() < 1e-6, "{plan}");
    assert!((number(&budget["hours"]["likely"]) - 3700.0 / total).abs() < 1e-6, "{plan}");
    assert_eq!(plan["model"], "model, not measured");
    let marked =
        plan["sources"].as_array().unwrap().iter().filter(|source| source.as_str().unwrap().contains("not verified"));
    assert_eq!(plan["not_verified"], marked.count());
    let told = planned(&bench, "power plan --board h743 --fps 25 --method lite");
    assert!(told.stdout.contains("model, not measured") && told.stdout.contains("not verified: "), "{}", told.stdout);
    assert!(told.stderr.contains("not verified") && told.stderr.lines().count() == 1, "{}", told.stderr);
}

#[test]
fn a_plan_that_does_not_fit_says_by_how_much_and_what_would() {
    let bench = Bench::new();
    let told = planned(&bench, "power plan --board u575 --method full --fps 30").stdout;
    assert!(told.contains("does not fit: needs ") && told.contains("would fit: --fps "), "{told}");
    // What it says does fit.
    let line = told.lines().find(|line| line.starts_with("would fit")).unwrap();
    for way in line.trim_start_matches("would fit: ").split("; or ").filter(|way| !way.starts_with("--board")) {
        let fps = if way.contains("--fps") { "" } else { "--fps 30" };
        let told = planned(&bench, &format!("power plan --board u575 --method full {fps} {way}")).stdout;
        assert!(told.contains("chosen"), "{way}: {told}");
    }
}

#[test]
fn all_methods_and_boards_are_compared_in_one_table_and_a_page() {
    let bench = Bench::new();
    let told = planned(&bench, "power plan --all --fps 5 --num-disparities 48 -o plan.html").stdout;
    for method in ["full", "lite", "wavelet-block", "contour", "envelope", "block", "sgm"] {
        for board in ["h743", "u575", "f407"] {
            let is_there = told.lines().any(|line| line.split_whitespace().take(2).eq([board, method]));
            assert!(is_there, "{board} {method}: {told}");
        }
    }
    let page = String::from_utf8(bench.read("plan.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("model, not measured") && page.contains("not verified"));
    let table = bench.succeeds("power plan --table-1 --num-disparities 48").stdout;
    assert!(table.starts_with("**model, not measured.**") && table.contains("| sgm |"), "{table}");
}

#[test]
fn own_currents_and_counts_take_the_place_of_the_projects() {
    let bench = Bench::new();
    let own = include_str!("../../src/power/plan/currents.toml");
    let run = r#"run = { ma = 71, not_verified = "from memory of DS12110, run mode from ITCM" }"#;
    assert!(own.contains(run));
    let meter = r#"run = { ma = 142, document = "our meter", revision = "1", table = "run 7" }"#;
    bench.write("own.toml", own.replace(run, meter));
    let plan = |options: &str| {
        planned(&bench, &format!("power plan --board h743 --method lite --fps 20 --json {options}")).json()
    };
    let core = |options: &str| plan(options)["points"][1]["core_mw"]["likely"].as_f64().unwrap();
    assert!(core("--currents own.toml") > 1.5 * core(""));
    bench.write("bare.toml", own.replace(run, "run = { ma = 71 }"));
    bench.refuses("power plan --board h743 --currents bare.toml", &["bare.toml", "h743", "VOS1", "not_verified"]);
    bench.write("old.toml", own.replace("mhz = 400", "mhz = 500"));
    bench.refuses("power plan --board h743 --currents old.toml", &["old.toml", "fastest must come first"]);
    let counts = include_str!("../../src/power/plan/counts.csv");
    bench.write("counts.csv", counts);
    assert_eq!(core("--counts counts.csv"), core(""));
    bench.write("few.csv", counts.lines().take(4).collect::<Vec<_>>().join("\n"));
    bench.refuses("power plan --board h743 --counts few.csv", &["few"]);
}

#[test]
fn what_was_not_counted_is_refused_in_one_line() {
    let bench = Bench::new();
    let cases: [(&str, &[&str]); 10] = [
        ("", &["--board"]),
        ("--board l4", &["--board"]),
        ("--board h743 --size 640x480", &["--size", "64 to 320"]),
        ("--board h743 --num-disparities 16", &["--num-disparities 16", "48 to 160"]),
        ("--board h743 --method block --num-disparities 72", &["multiples of 16"]),
        ("--board h743 --method ncc", &["--method ncc", "host only"]),
        ("--board h743 --fps 0", &["--fps 0"]),
        ("--board h743 --battery 1Ah --volts 3.7", &["--battery", "1000mAh"]),
        ("--board h743 --battery 1000mAh", &["--volts"]),
        ("--board h743 -o plan.html", &["--all"]),
    ];
    for (options, wanted) in cases {
        bench.refuses(&format!("power plan {options}"), wanted);
    }
}
