//! `haarline power measure` on recordings whose energy is known, as the meters' programs write them.

use std::fmt::Write as _;

use serde_json::Value;

use crate::corruption::Random;
use crate::tool::Bench;

const VOLTS: f64 = 3.3;
/// Samples a second.
const RATE: usize = 100_000;
/// Time of the meter in that of the program: its clock is fast.
const DRIFT: f64 = 1.0 + 50e-6;
/// How long the chip sleeps before each method, and how long that works, ms.
const SLEEP: usize = 600;
const WORK: usize = 1500;
/// What a method takes while it computes, mW.
const METHODS: [(&str, f64); 2] = [("full", 310.0), ("lite", 205.0)];
const PHASES: [&str; 4] = ["idle", "capture", "compute", "send"];

/// What the program does in a millisecond, and the mean power without noise, mW.
fn model(millisecond: usize, part: f64) -> (usize, f64) {
    let (run, within) = (millisecond / (SLEEP + WORK), millisecond % (SLEEP + WORK));
    let compute = METHODS[run % METHODS.len()].1;
    match (within < SLEEP, part) {
        (true, _) => (0, 12.0),
        (_, part) if part < 0.1 => (1, 90.0),
        (_, part) if part < 0.8 => (2, compute),
        _ => (3, 140.0),
    }
}

/// The truth of what was recorded: energy, mJ, and time, s, by phase and by method.
#[derive(Default)]
struct Truth {
    phases: [[f64; 2]; 4],
    methods: [[f64; 2]; METHODS.len()],
}

/// Which columns an export has.
#[derive(Clone, Copy, PartialEq)]
enum Digital {
    Both,
    Letters,
    Columns,
    None,
}

/// A PPK2's export of two rounds of two methods: noise, single losses, longer gaps, a clock that is fast.
fn ppk2(digital: Digital, has_time: bool) -> (String, Truth) {
    let mut random = Random::new();
    let (mut csv, mut truth) = (String::new(), Truth::default());
    let mut names: Vec<String> = vec!["Current(uA)".to_owned()];
    if has_time {
        names.insert(0, "Timestamp(ms)".to_owned());
    }
    if matches!(digital, Digital::Both | Digital::Letters) {
        names.push("D0-D7".to_owned());
    }
    if matches!(digital, Digital::Both | Digital::Columns) {
        names.extend((0..8).map(|pin| format!("D{pin}")));
    }
    let _ = writeln!(csv, "{}", names.join(","));
    let milliseconds = 4 * (SLEEP + WORK) + SLEEP;
    let a_millisecond = RATE / 1000;
    let (mut before, mut lost) = (0, 0);
    for index in 0..milliseconds * a_millisecond {
        let (millisecond, part) = (index / a_millisecond, (index % a_millisecond) as f64 / a_millisecond as f64);
        let (phase, milliwatts) = model(millisecond, part);
        // Nothing was recorded for a while, once in a sleep and once at work.
        let is_gap =
            has_time && [200..260, 3000..3090].iter().any(|gap: &std::ops::Range<usize>| gap.contains(&millisecond));
        if is_gap {
            continue;
        }
        let energy = [milliwatts / RATE as f64, 1.0 / RATE as f64];
        let add = |sum: &mut [f64; 2]| [0, 1].into_iter().for_each(|at| sum[at] += energy[at]);
        add(&mut truth.phases[phase]);
        if phase > 0 {
            add(&mut truth.methods[millisecond / (SLEEP + WORK) % METHODS.len()]);
        }
        if has_time && random.below(1000) < 3 {
            lost = 1 + random.below(4);
        }
        if lost > 0 {
            lost -= 1;
            continue;
        }
        let noise = 0.2 * milliwatts * (random.below(2001) as f64 / 1000.0 - 1.0);
        let microamperes = 1000.0 * (milliwatts + noise) / VOLTS;
        if has_time {
            let _ = write!(csv, "{:.4},", 1000.0 * DRIFT * index as f64 / RATE as f64);
        }
        let _ = write!(csv, "{microamperes:.3}");
        let mut levels = [["0", "0"], ["1", "0"], ["1", "1"], ["0", "1"]][phase];
        // Not read yet at first, and then and now a change within a sample.
        if index < 50 {
            levels = ["-", "-"];
        } else if phase != before && random.below(10) == 0 {
            levels = ["X", levels[1]];
        }
        before = phase;
        if matches!(digital, Digital::Both | Digital::Letters) {
            let _ = write!(csv, ",{}{}000000", levels[0], levels[1]);
        }
        if matches!(digital, Digital::Both | Digital::Columns) {
            let _ = write!(csv, ",{},{},0,0,0,0,0,0", levels[0], levels[1]);
        }
        csv.push('\n');
    }
    (csv, truth)
}

#[track_caller]
fn assert_near(found: &Value, wanted: f64, what: &str) {
    let found = found.as_f64().unwrap_or_else(|| panic!("{what}: {found}"));
    assert!((found / wanted - 1.0).abs() < 0.01, "{what}: {found}, truth {wanted}");
}

fn assert_true(summary: &Value, truth: &Truth, has_phases: bool) {
    let sum = |at: usize| truth.phases.iter().map(|phase| phase[at]).sum::<f64>();
    assert_near(&summary["mj"], sum(0), "all");
    assert_near(&summary["mean_mw"], sum(0) / sum(1), "mean power");
    for (at, name) in PHASES.iter().enumerate().filter(|_| has_phases) {
        let phase = &summary["phases"][at];
        assert_eq!(phase["phase"], *name);
        assert_near(&phase["mj"], truth.phases[at][0], name);
        assert_near(&phase["mean_mw"], truth.phases[at][0] / truth.phases[at][1], name);
    }
    // The last round of each method has no gap.
    for (name, [energy, seconds]) in METHODS.iter().map(|method| method.0).zip(truth.methods) {
        let method = summary["methods"].as_array().unwrap().iter().find(|method| method["name"] == name).unwrap();
        assert_eq!(method["segments"], 2, "{summary}");
        assert_near(&method["mean_mw"], energy / seconds, name);
        assert_near(&method["mj_per_segment"], energy / 2.0, name);
    }
}

#[test]
fn energy_by_phase_and_segment_is_that_of_the_truth() {
    let bench = Bench::new();
    for (digital, has_time) in [
        (Digital::Both, true),
        (Digital::Letters, true),
        (Digital::Columns, true),
        (Digital::None, true),
        (Digital::Columns, false),
    ] {
        let (csv, truth) = ppk2(digital, has_time);
        bench.write("current.csv", csv);
        let rate = if has_time { String::new() } else { format!("--rate {RATE}") };
        let line = format!("power measure current.csv --volts {VOLTS} --segments full,lite {rate}");
        let outcome = bench.run(&format!("{line} --json -o page.html"));
        assert_eq!(outcome.status, 0, "{outcome:?}");
        let has_phases = digital != Digital::None;
        let warnings: Vec<&str> = outcome.stderr.lines().collect();
        assert_eq!(
            warnings.iter().filter(|line| line.contains("digital inputs 0 and 1")).count(),
            usize::from(!has_phases)
        );
        assert_eq!(warnings.iter().filter(|line| line.contains("of its time was lost")).count(), usize::from(has_time));
        let summary = outcome.json();
        assert_true(&summary, &truth, has_phases);
        if has_time {
            assert_eq!(summary["gaps"], 2, "{summary}");
            assert!((summary["lost_seconds"].as_f64().unwrap() - 0.15).abs() < 0.002, "{summary}");
        }
        let page = String::from_utf8(bench.read("page.html")).unwrap();
        assert_eq!(page.matches("<svg").count(), 2 + usize::from(has_phases));
        for words in ["<script", "href=", "src=", "https:"] {
            assert!(!page.contains(words), "{words}");
        }
        let told = bench.run(&line).stdout;
        assert!(
            told.contains("PPK2 export") && told.contains("full") && told.contains("compute") == has_phases,
            "{told}"
        );
    }
}

#[test]
fn other_recordings_are_taken_off_and_stages_share_the_running_power() {
    let bench = Bench::new();
    let steady = |milliwatts: f64, digital: &str| {
        let row = |index: usize| format!("{},{},{digital}\n", index as f64 * 0.1, 1000.0 * milliwatts / VOLTS);
        format!("Timestamp(ms),Current(uA),D0-D7\n{}", (0..1000).map(row).collect::<String>())
    };
    bench.write("run.csv", steady(200.0, "11000000"));
    bench.write("idle.csv", steady(20.0, "00000000"));
    bench.write("sensors.csv", steady(50.0, "10000000"));
    bench.write(
        "log.json",
        r#"{"clock_hz": 480e6, "seconds": 2, "frames": 20, "width": 320, "height": 240, "stage_cycles": {"seeds": 96e6, "search": 48e6}}"#,
    );
    let line = "power measure run.csv --volts 3.3 --idle idle.csv --sensors sensors.csv";
    let summary = bench.succeeds(&format!("{line} --log log.json --json")).json();
    for (key, wanted) in [
        ("mean_mw", 200.0),
        ("above_idle_mw", 180.0),
        ("above_sensors_mw", 150.0),
        ("frames_per_second", 10.0),
        ("mj_per_frame", 20.0),
        ("nj_per_pixel", 20.0 / 76_800.0 * 1e6),
        ("running_mw", 200.0),
    ] {
        assert_near(&summary[key], wanted, key);
    }
    let stages = summary["stages"].as_array().unwrap();
    assert_eq!((&stages[0]["stage"], &stages[1]["stage"]), (&"search".into(), &"seeds".into()));
    assert_near(&stages[0]["mj_per_frame"], 200.0 * 48e6 / 480e6 / 20.0, "search");
    assert!(summary["stages_rest_on"].as_str().unwrap().contains("no single stage"));
    let same = bench.succeeds(&format!("{line} --fps 10 --size 320x240 --json")).json();
    assert_eq!(same["nj_per_pixel"], summary["nj_per_pixel"]);
    assert!(bench.succeeds(&format!("{line} --log log.json")).stdout.contains("times the measured running power"));
    bench.write("run.csv", steady(200.0, "00000000"));
    bench.refuses(&format!("{line} --log log.json"), &["--log", "no phase of computing"]);
    bench.write("log.json", "{}");
    bench.refuses(&format!("{line} --log log.json"), &["log.json", "clock_hz"]);
}

#[test]
fn what_a_joulescope_writes_is_read_in_all_its_forms() {
    let bench = Bench::new();
    let row = |index: usize, time: &str| {
        let watts = if index.is_multiple_of(2) { 0.1 } else { 0.3 };
        format!("{time}{},3.300,{watts},{},{}\n", watts / 3.3, index, index)
    };
    let table = |head: &str, time: &dyn Fn(usize) -> String| {
        format!("{head}\n{}", (0..40).map(|index| row(index, &time(index))).collect::<String>())
    };
    let quantities = "current,voltage,power,charge,energy";
    let relative = table(&format!("#time,{quantities}"), &|index| format!("{:.1},", index as f64 / 2.0));
    let date =
        table(&format!("#time,{quantities}"), &|index| format!("2026-11-26T12:00:{:04.1}Z,", index as f64 / 2.0));
    let none = table(&format!("#{quantities}"), &|_| String::new());
    for (content, options) in [(relative, ""), (date, ""), (none, "--rate 2")] {
        bench.write("statistics.csv", content);
        let outcome = bench.run(&format!("power measure statistics.csv {options} --json"));
        assert_eq!(outcome.status, 0, "{outcome:?}");
        let summary = outcome.json();
        assert_eq!(summary["kind"], "Joulescope statistics");
        assert_near(&summary["mj"], 4000.0, options);
        assert_near(&summary["seconds"], 20.0, options);
    }
    let waveform = |step: f64| {
        let row = |index: usize| {
            let level = u8::from(index % 10 < 6);
            format!("{:.5},{},3.3,{level},{level}\n", step * index as f64, 0.01 * f64::from(1 + 4 * level))
        };
        let head = "# time,JS220-000415.current,JS220-000415.voltage,JS220-000415.gpi[0],JS220-000415.gpi[1]\n";
        format!("{head}{}", (0..1000).map(row).collect::<String>())
    };
    bench.write("waveform.csv", waveform(1e-4));
    let summary = bench.succeeds("power measure waveform.csv --json").json();
    assert_eq!(summary["kind"], "Joulescope waveform");
    assert_near(&summary["phases"][2]["mean_mw"], 165.0, "compute");
    assert_near(&summary["phases"][0]["seconds"], 0.04, "idle");
    bench.write("waveform.csv", waveform(0.01));
    bench.refuses("power measure waveform.csv", &["waveform.csv", "10.0 ms apart", "zoom in"]);
}

#[test]
fn what_cannot_be_measured_is_told_in_one_line() {
    let bench = Bench::new();
    let rows: String = (0..100).map(|index| format!("{},100.5,11000000\n", index as f64 * 0.01)).collect();
    let with_head = |head: &str| format!("{head}\n{rows}");
    let good = with_head("Timestamp(ms),Current(uA),D0-D7");
    let changed = |line: usize, to: &str| {
        let lines = good.lines().enumerate().map(|(at, old)| if at == line { to } else { old }.to_owned() + "\n");
        lines.collect::<String>()
    };
    let cases: [(String, &str, &[&str]); 14] = [
        (good.clone(), "", &["--volts"]),
        (good.clone(), "--volts 0", &["--volts 0"]),
        (good.clone(), "--volts 3.3 --rate 100", &["--rate", "leave it out"]),
        (good.clone(), "--volts 3.3 --pins 0,9", &["--pins", "0 to 7"]),
        (good.clone(), "--volts 3.3 --segments full", &["--segments", "none was found"]),
        (good.clone(), "--volts 3.3 -o page.txt", &["-o page.txt", ".html"]),
        (with_head("Timestamp(ms),Current(mA),D0-D7"), "--volts 3.3", &["Current(mA)", "uA"]),
        (with_head("Timestamp(s),Current(uA),D0-D7"), "--volts 3.3", &["Timestamp(s)", "ms"]),
        (with_head("a,b,c"), "--volts 3.3", &["PPK2", "Joulescope", "a,b,c"]),
        (changed(50, "0.49,x,11000000"), "--volts 3.3", &["line 51", "\"x\" is no number"]),
        (changed(50, "0.49,3e9,11000000"), "--volts 3.3", &["line 51", "unit"]),
        (changed(50, "0.1,3,11000000"), "--volts 3.3", &["time goes back"]),
        (changed(50, "0.49"), "--volts 3.3", &["line 51", "columns"]),
        ("Current(uA)\n1\n2\n".to_owned(), "--volts 3.3", &["--rate"]),
    ];
    for (content, options, told) in cases {
        bench.write("current.csv", content);
        bench.refuses(&format!("power measure current.csv {options}"), told);
    }
    if cfg!(target_os = "linux") {
        bench.refuses("power measure /dev/zero --volts 3.3", &["/dev/zero", "a line of more than 65536 bytes"]);
    }
    bench.write("quoted.csv", format!("{good}\"{rows}"));
    bench.refuses("power measure quoted.csv --volts 3.3", &["quoted.csv", "line 102"]);
    bench.write("empty.csv", "");
    bench.refuses("power measure empty.csv --volts 3.3", &["empty.csv", "is empty"]);
    bench.write("head.csv", "Timestamp(ms),Current(uA)\n");
    bench.refuses("power measure head.csv --volts 3.3", &["head.csv", "0 whole rows"]);
    bench.refuses("power measure none.csv --volts 3.3", &["none.csv", "cannot be read"]);
    bench.write("noise.csv", [0x66, 0x81, 0x0e, 0x00, 0x2c, 0xf8]);
    bench.refuses("power measure noise.csv --volts 3.3", &["noise.csv", "is no text"]);
    bench.write("tabs.csv", "a\tb\n1\t2\n");
    bench.refuses("power measure tabs.csv --volts 3.3", &["tabs.csv", "its first line is"]);
    bench.write("page.html", &good);
    bench.refuses("power measure page.html --volts 3.3 -o page.html", &["files that are read"]);
    // Cut off anywhere in its last row, the whole rows count.
    for cut in 1..20 {
        bench.write("cut.csv", &good[..good.len() - cut]);
        let outcome = bench.run("power measure cut.csv --volts 3.3 --json");
        assert_eq!((outcome.status, outcome.json()["samples"].as_u64()), (0, Some(99)), "{cut}: {outcome:?}");
        assert_near(&outcome.json()["mean_mw"], 0.1005 * 3.3, "cut off");
    }
}
