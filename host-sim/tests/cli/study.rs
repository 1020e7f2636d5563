//! `haarline study`: tables, plots and the page, on rendered scenes and on scenes from files.

use std::collections::BTreeMap;
use std::fs;

use crate::scene::bench_with_scenes;
use crate::tool::Bench;

const STUDIES: [&str; 6] = ["envelope", "detail", "noise", "schwefel", "alignment", "block"];
/// Those that look at frames.
const ON_FRAMES: [&str; 4] = ["envelope", "detail", "alignment", "block"];

/// The files in the folder `name`, by name.
fn files(bench: &Bench, name: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(bench.path(name)).unwrap().map(|entry| entry.unwrap());
    entries.map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())).collect()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// One page with every plot in it, that needs nothing else.
#[track_caller]
fn assert_whole_page(page: &str, files: &BTreeMap<String, Vec<u8>>) {
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    for words in ["<script", "<link", "<img", "src=", "@import", "url(", "https:"] {
        assert!(!page.contains(words), "{words}");
    }
    for (name, bytes) in files.iter().filter(|(name, _)| name.ends_with(".svg")) {
        assert!(page.contains(text(bytes).trim()), "{name} is not in the page");
    }
}

/// Every study's tables and plots, all of them in the page, and a few lines on the terminal.
#[track_caller]
fn assert_all_studies(files: &BTreeMap<String, Vec<u8>>, told: &str) {
    let page = text(&files["index.html"]);
    assert_whole_page(page, files);
    for words in ["haarline study all -o DIR --seed 3 --scenes scenes", "prefers-color-scheme", "<nav"] {
        assert!(page.contains(words), "{words}");
    }
    assert!(told.lines().count() <= 40, "{told}");
    for study in STUDIES {
        assert!(told.lines().any(|line| line.starts_with(study)), "{study}: {told}");
        let count =
            |suffix: &str| files.keys().filter(|name| name.starts_with(study) && name.ends_with(suffix)).count();
        // The plot of `block` is against instructions, which only the emulated chip tells.
        let has_plots = count(".svg") > 0 || study == "block";
        assert!(count(".csv") > 0 && has_plots, "{study}: {:?}", files.keys());
        assert!(page.contains(&format!("id=\"{study}\"")) && page.contains(&format!("href=\"#{study}\"")));
    }
    for (name, bytes) in files.iter().filter(|(name, _)| name.ends_with(".csv")) {
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let columns = reader.headers().unwrap().len();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert!(columns > 1 && !rows.is_empty(), "{name}");
        let last = &rows[rows.len() - 1][columns - 1];
        assert!(page.contains(last), "{name}: {last}");
    }
}

/// The files without what was measured in time: columns and plots that say so, and the page, which shows them.
fn without_times(mut files: BTreeMap<String, Vec<u8>>) -> BTreeMap<String, Vec<u8>> {
    let count = files.len();
    files.retain(|name, _| name != "index.html" && !name.ends_with("_measured.svg"));
    assert_eq!(files.len(), count - 2, "the page and one plot of times");
    for (_, bytes) in files.iter_mut().filter(|(name, _)| name.ends_with(".csv")) {
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let headings = reader.headers().unwrap().clone();
        let records = std::iter::once(headings.clone()).chain(reader.records().map(Result::unwrap));
        let mut writer = csv::Writer::from_writer(Vec::new());
        for record in records {
            let kept = record.iter().zip(&headings).filter(|(_, heading)| !heading.contains("(measured)"));
            writer.write_record(kept.map(|(cell, _)| cell)).unwrap();
        }
        *bytes = writer.into_inner().unwrap();
    }
    files
}

#[test]
fn all_of_them_make_one_page_and_the_seed_decides_every_byte_but_times() {
    let bench = bench_with_scenes();
    let [told, _] =
        ["a", "b"].map(|folder| bench.succeeds(&format!("study all -o out/{folder} --seed 3 --scenes scenes")).stdout);
    let [a, b] = ["out/a", "out/b"].map(|folder| files(&bench, folder));
    assert_all_studies(&a, &told);
    let [a, b] = [a, b].map(without_times);
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (name, bytes) in &a {
        assert!(*bytes == b[name], "{name}: the same seed in another folder");
    }
}

#[test]
fn without_scenes_frames_are_rendered_from_the_seed() {
    let bench = Bench::new();
    for (folder, seed) in [("a", 0), ("b", 0), ("c", 1)] {
        bench.succeeds(&format!("study envelope -o {folder} --seed {seed}"));
    }
    let [a, b, c] = ["a", "b", "c"].map(|folder| files(&bench, folder));
    assert!(text(&a["envelope.html"]).contains("rendered scenes"));
    assert!(a == b, "the same seed in another folder, the page too");
    assert_ne!(a["envelope_matches.csv"], c["envelope_matches.csv"]);
}

#[test]
fn one_study_on_scenes_from_files_has_a_page_of_its_own() {
    let bench = bench_with_scenes();
    let told = bench.succeeds("study envelope -o out --scenes scenes --only bench,crossing").stdout;
    let files = files(&bench, "out");
    assert!(files.keys().all(|name| name.starts_with("envelope")), "{:?}", files.keys());
    let page = text(&files["envelope.html"]);
    assert_whole_page(page, &files);
    assert!(page.contains("--scenes scenes --only bench,crossing") && page.contains("2 scenes of scenes"));
    assert!(told.contains("crossing") && !told.contains("alcove"), "{told}");
    let shapes = text(&files["envelope_shapes.csv"]);
    let first: Vec<&str> = shapes.lines().map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(first[1..], ["bench", "crossing", "all"]);
}

#[test]
fn true_correspondences_of_a_shifted_plane_do_not_differ() {
    let bench = Bench::new();
    let mut scene = crate::scene::three_scenes()[0].clone();
    scene.pair = crate::scene::Pair::shifted(scene.pair.width, scene.pair.height, 4);
    scene.truth.fill(4 * 256);
    scene.nonocc.fill(255);
    scene.write(&bench, "plane");
    bench.succeeds("study envelope -o out --scenes plane");
    let table = bench.read("out/envelope_dispersion.csv");
    let rows: Vec<&str> = text(&table).lines().collect();
    assert_eq!(rows[1], "alcove,3200,0.00,0,0,0,0,100.00");
}

#[test]
fn views_without_texture_are_no_fault() {
    let bench = Bench::new();
    let mut scene = crate::scene::three_scenes()[0].clone();
    scene.pair = crate::scene::Pair::blank(scene.pair.width, scene.pair.height);
    scene.write(&bench, "blank");
    for study in ON_FRAMES {
        let told = bench.succeeds(&format!("study {study} -o out --scenes blank")).stdout;
        assert!(!told.contains("NaN") && !told.contains("inf "), "{told}");
    }
}

#[test]
fn the_narrowest_view_is_no_fault() {
    let bench = Bench::new();
    crate::scene::Scene::new("narrow", "indoor", [32, 5], [2, 4]).write(&bench, "narrow");
    for study in ON_FRAMES {
        bench.succeeds(&format!("study {study} -o out --scenes narrow"));
    }
}

#[test]
fn wrong_input_is_refused_and_nothing_written() {
    let bench = bench_with_scenes();
    bench.write("file", "x");
    bench.refuses("study", &["<NAME>"]);
    bench.refuses("study envelop -o out", &["envelop", "detail", "all"]);
    bench.refuses("study envelope", &["--output"]);
    bench.refuses("study all -o file", &["-o file", "is a file"]);
    bench.refuses("study all -o out --seed x", &["--seed", "whole number"]);
    bench.refuses("study all -o out --scenes none", &["none", "no such folder"]);
    bench.refuses("study all -o out --scenes scenes --only attic", &["attic", "alcove"]);
    bench.refuses("study all -o out --only alcove", &["--scenes"]);
    bench.write("scenes/broken/left.png", "x");
    bench.refuses("study all -o out --scenes scenes", &["broken", "missing"]);
}
