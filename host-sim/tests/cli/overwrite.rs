//! No output replaces an input or another output, whatever names lead to it.

use std::fs;

use image::ImageFormat;

use crate::files::encode;
use crate::scene::{Pair, bench_with_scenes};
use crate::tool::Bench;

/// Views, a recording, a dump, packets, a rig and scenes.
fn bench() -> Bench {
    let bench = bench_with_scenes();
    let pair = Pair::shifted(96, 24, 5);
    pair.write(&bench);
    for name in ["a", "b"] {
        bench.write(&format!("take/left/{name}.png"), encode(&pair.left_image(), ImageFormat::Png));
        bench.write(&format!("take/right/{name}.png"), encode(&pair.right_image(), ImageFormat::Png));
    }
    bench.succeeds("record left.png right.png -o take.raw --wiring line");
    write_rig(&bench, &[("width", 96), ("height", 24), ("num_disparities", 16), ("focal_px", 100)]);
    bench.write("maps/frames.csv", "packets");
    bench.write("maps/000000.pfm", fs::read(bench.path("take.raw")).unwrap());
    bench.write("maps/a_picture.png", bench.read("left.png"));
    bench
}

/// The file `rig.toml` with these values and else those of a new one.
pub fn write_rig(bench: &Bench, values: &[(&str, usize)]) {
    bench.succeeds("rig new rig.toml");
    let text = String::from_utf8(bench.read("rig.toml")).unwrap();
    let line = |line: &str| {
        let told = values.iter().find(|(key, _)| line.split([' ', '=']).next() == Some(key));
        let point = if line.starts_with("focal_px") { ".0" } else { "" };
        told.map_or_else(|| format!("{line}\n"), |(key, value)| format!("{key} = {value}{point}\n"))
    };
    bench.write("rig.toml", text.lines().map(line).collect::<String>());
}

/// Refused with one of these reasons, and nothing changed.
#[track_caller]
fn refused_for(bench: &Bench, line: &str, reasons: &[&str]) {
    bench.refuses(line, &[]);
    let told = bench.run(line).stderr;
    assert!(reasons.iter().any(|reason| told.contains(reason)), "{line}: {told}");
}

#[test]
fn no_command_replaces_what_it_reads() {
    let bench = bench();
    let search = "--num-disparities 16";
    let cases = [
        format!("depth left.png right.png {search} -o right.png"),
        format!("depth left.png right.png {search} --picture ./left.png"),
        "depth left.png right.png --rig rig.toml --obstacles rig.toml".to_owned(),
        "play take --rig rig.toml -o out --mavlink take/left/a.png".to_owned(),
        "play take --rig rig.toml -o out --mavlink take/right/b.png --frames 0..1".to_owned(),
        "play take --rig rig.toml -o out --mavlink rig.toml".to_owned(),
        format!("play take {search} -o take"),
        format!("play take {search} -o take/left"),
        format!("play take {search} -o take/right/../right"),
        format!("play maps/000000.pfm --raw 96x24 --wiring line {search} -o maps"),
        "record left.png right.png -o left.png --wiring line".to_owned(),
        "record --recording take -o take/left/b.png --wiring line --frames 0..1".to_owned(),
        "receive maps/frames.csv -o maps".to_owned(),
        "receive maps/000000.pfm -o maps".to_owned(),
        "contours left.png -o left.png --half-support 2".to_owned(),
        "eval scenes --method lite --json scenes/alcove/meta.json".to_owned(),
        "ablate scenes --only bench --csv scenes/bench/truth.png".to_owned(),
        "twin left.png right.png -o left.png".to_owned(),
        "twin left.png right.png --rig rig.toml --obstacles rig.toml".to_owned(),
        "twin --recording take -o take/left/a.png".to_owned(),
        "rig new rig.toml".to_owned(),
        "rig import left.png -o ./left.png --update".to_owned(),
        // Where the previous description would be kept.
        "rig import rig.toml.bak -o rig.toml --update".to_owned(),
        "align take --picture take/left/new.png".to_owned(),
        "align take --left left/* --right right/* --picture take/right/a.png".to_owned(),
        "record left.png right.png --rig rig.toml -o rig.toml".to_owned(),
    ];
    bench.write("rig.toml.bak", "a calibration");
    for line in &cases {
        let reasons = ["files that are read", "folder of the recording", "is not replaced", "lies in the recording"];
        refused_for(&bench, line, &reasons);
    }
}

#[test]
fn links_to_an_input_are_the_input() {
    let bench = bench();
    fs::hard_link(bench.path("left.png"), bench.path("hard.png")).unwrap();
    bench.refuses("depth left.png right.png --num-disparities 16 -o hard.png", &["hard.png", "files that are read"]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        symlink("left.png", bench.path("soft.png")).unwrap();
        symlink("take", bench.path("again")).unwrap();
        fs::create_dir(bench.path("out")).unwrap();
        symlink("../take.raw", bench.path("out/000000.pfm")).unwrap();
        let told = ["files that are read"];
        bench.refuses("depth left.png right.png --num-disparities 16 --grey soft.png", &told);
        bench.refuses("record left.png right.png --wiring line -o soft.png", &told);
        bench.refuses("play take --num-disparities 16 -o again/left", &["folder of the recording"]);
        bench.refuses("play take.raw --raw 96x24 --wiring line --num-disparities 16 -o out", &told);
    }
}

#[test]
fn no_output_replaces_another_one() {
    let bench = bench();
    bench.write("out/older", "");
    let cases = [
        "depth left.png right.png --num-disparities 16 -o m.png --grey ./m.png",
        "depth left.png right.png --rig rig.toml -o m.png --obstacles m.png",
        "play take --rig rig.toml -o out --mavlink out/frames.csv",
        "play take --rig rig.toml -o out --mavlink out/a.pfm",
        "eval scenes --method lite --json out/alcove.pfm -o out",
        "ablate scenes --only alcove --csv t --json t",
        "twin left.png right.png --rig rig.toml -o m --obstacles m",
        "align take -o p.png --picture ./p.png",
    ];
    for line in cases {
        refused_for(&bench, line, &["is given twice", "a name that -o writes", "would be written twice"]);
    }
}
