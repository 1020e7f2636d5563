//! Recordings as cameras, datasets and people lay them out: each is paired right, or refused with the reason.

use std::fs;

use image::{DynamicImage, ImageFormat};

use crate::files::encode;
use crate::scene::{Pair, grey_image};
use crate::tool::Bench;

const SIZE: [usize; 2] = [96, 24];
const SEARCH: &str = "--method lite --num-disparities 16";

/// The pair of moment `moment`, told by its disparity, so that a map tells which right view it was made of.
fn pair(moment: usize) -> Pair {
    Pair::shifted(SIZE[0], SIZE[1], moment as i64 + 2)
}

/// Files of the left and the right camera, each name with its moment.
fn write(bench: &Bench, left: &[(&str, usize)], right: &[(&str, usize)]) {
    for (name, moment) in left {
        bench.write(&format!("take/{name}"), encode(&pair(*moment).left_image(), ImageFormat::Png));
    }
    for (name, moment) in right {
        bench.write(&format!("take/{name}"), encode(&pair(*moment).right_image(), ImageFormat::Png));
    }
}

/// The rows of frames.csv: file, and the moment that its map tells.
fn played(bench: &Bench) -> Vec<(String, Option<usize>)> {
    let table = fs::read_to_string(bench.path("out/frames.csv")).unwrap();
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        let median: Option<f64> = fields[column("median_disparity_px")].parse().ok();
        (fields[column("file")].to_owned(), median.map(|px| px.round() as usize - 2))
    };
    lines.map(row).collect()
}

/// A layout: left files, right files, options, and what comes of it.
type Case<'a> = (&'a [(&'a str, usize)], &'a [(&'a str, usize)], &'a str, &'a [(&'a str, Option<usize>)]);

#[test]
fn every_usual_layout_is_paired_right() {
    let cases: [Case<'_>; 18] = [
        (
            &[("left/1.png", 1), ("left/2.png", 2)],
            &[("right/1.png", 1), ("right/2.png", 2)],
            "",
            &[("1.png", Some(1)), ("2.png", Some(2))],
        ),
        (
            &[("Left/a.png", 1), ("Left/b.png", 2)],
            &[("Right/a.png", 1), ("Right/b.png", 2)],
            "",
            &[("a.png", Some(1)), ("b.png", Some(2))],
        ),
        (&[("image_0/000000.png", 1)], &[("image_1/000000.png", 1)], "", &[("000000.png", Some(1))]),
        (
            &[("image_2/000009.png", 1), ("image_2/000010.png", 2)],
            &[("image_3/000009.png", 1), ("image_3/000010.png", 2)],
            "",
            &[("000009.png", Some(1)), ("000010.png", Some(2))],
        ),
        (&[("image_02/data/7.png", 1)], &[("image_03/data/7.png", 1)], "--layout folders", &[("7.png", Some(1))]),
        (
            &[("cam0/data/1403636579763555584.png", 1), ("cam0/data/1403636579813555456.png", 2)],
            &[("cam1/data/1403636579763555584.png", 1), ("cam1/data/1403636579813555456.png", 2)],
            "",
            &[("1403636579763555584.png", Some(1)), ("1403636579813555456.png", Some(2))],
        ),
        // Triggered apart by 2 ms, and each camera lost a frame of 20 Hz.
        (
            &[
                ("mav0/cam0/data/1403636579760000000.png", 1),
                ("mav0/cam0/data/1403636579810000000.png", 2),
                ("mav0/cam0/data/1403636579860000000.png", 3),
                ("mav0/cam0/data/1403636579960000000.png", 5),
            ],
            &[
                ("mav0/cam1/data/1403636579762000000.png", 1),
                ("mav0/cam1/data/1403636579812000000.png", 2),
                ("mav0/cam1/data/1403636579912000000.png", 4),
                ("mav0/cam1/data/1403636579962000000.png", 5),
            ],
            "",
            &[
                ("1403636579760000000.png", Some(1)),
                ("1403636579810000000.png", Some(2)),
                ("1403636579860000000.png", None),
                ("1403636579912000000.png", None),
                ("1403636579960000000.png", Some(5)),
            ],
        ),
        (
            &[("left_01.png", 1), ("left_02.png", 2)],
            &[("right_01.png", 1), ("right_02.png", 2)],
            "",
            &[("left_01.png", Some(1)), ("left_02.png", Some(2))],
        ),
        (
            &[("01_left.png", 1), ("02_left.png", 2)],
            &[("01_right.png", 1), ("02_right.png", 2)],
            "",
            &[("01_left.png", Some(1)), ("02_left.png", Some(2))],
        ),
        (
            &[("l1.png", 1), ("l2.png", 2), ("l10.png", 10)],
            &[("r001.png", 1), ("r002.png", 2), ("r010.png", 10)],
            "",
            &[("l1.png", Some(1)), ("l2.png", Some(2)), ("l10.png", Some(10))],
        ),
        (
            &[("7_L.png", 1), ("8_L.png", 2)],
            &[("7_R.png", 1), ("8_R.png", 2)],
            "--layout names",
            &[("7_L.png", Some(1)), ("8_L.png", Some(2))],
        ),
        (
            &[("0_0007.png", 1), ("0_0008.png", 2)],
            &[("1_0007.png", 1), ("1_0008.png", 2)],
            "",
            &[("0_0007.png", Some(1)), ("0_0008.png", Some(2))],
        ),
        (
            &[("0007_0.png", 1), ("0008_0.png", 2)],
            &[("0007_1.png", 1), ("0008_1.png", 2)],
            "",
            &[("0007_0.png", Some(1)), ("0008_0.png", Some(2))],
        ),
        (&[("im0.png", 1)], &[("im1.png", 1)], "", &[("im0.png", Some(1))]),
        (
            &[("front/x1.png", 1), ("front/x2.png", 2)],
            &[("back/y1.png", 1), ("back/y2.png", 2)],
            "--left front/*.png --right back/*",
            &[("x1.png", Some(1)), ("x2.png", Some(2))],
        ),
        // Another frame is lost of each camera, and none is shifted.
        (
            &[
                ("left/left_0001.png", 1),
                ("left/left_0002.png", 2),
                ("left/left_0003.png", 3),
                ("left/left_0005.png", 5),
            ],
            &[
                ("right/right_0001.png", 1),
                ("right/right_0002.png", 2),
                ("right/right_0004.png", 4),
                ("right/right_0005.png", 5),
            ],
            "",
            &[
                ("left_0001.png", Some(1)),
                ("left_0002.png", Some(2)),
                ("left_0003.png", None),
                ("right_0004.png", None),
                ("left_0005.png", Some(5)),
            ],
        ),
        // Natural order.
        (
            &[("left/1.png", 1), ("left/2.png", 2), ("left/9.png", 9), ("left/10.png", 10), ("left/11.png", 11)],
            &[("right/1.png", 1), ("right/2.png", 2), ("right/9.png", 9), ("right/10.png", 10), ("right/11.png", 11)],
            "",
            &[("1.png", Some(1)), ("2.png", Some(2)), ("9.png", Some(9)), ("10.png", Some(10)), ("11.png", Some(11))],
        ),
        (
            &[("l/1403636579.5.png", 1), ("l/1403636579.55.png", 2)],
            &[("r/1403636579.501.png", 1), ("r/1403636579.551.png", 2)],
            "",
            &[("1403636579.5.png", Some(1)), ("1403636579.55.png", Some(2))],
        ),
    ];
    for (left, right, options, wanted) in cases {
        let bench = Bench::new();
        write(&bench, left, right);
        let line = format!("play take -o out {SEARCH} {options}");
        let outcome = bench.run(&line);
        let wanted: Vec<(String, Option<usize>)> =
            wanted.iter().map(|(file, moment)| ((*file).to_owned(), *moment)).collect();
        let lost = wanted.iter().filter(|(_, moment)| moment.is_none()).count();
        assert_eq!(outcome.status, i32::from(lost > 0), "{left:?} {options}: {outcome:?}");
        assert_eq!(outcome.stderr.matches("view is missing").count(), lost, "{outcome:?}");
        assert_eq!(played(&bench), wanted, "{left:?} {options}");
    }
}

#[test]
fn a_list_of_euroc_tells_the_times() {
    let bench = Bench::new();
    write(
        &bench,
        &[("mav0/cam0/data/a.png", 1), ("mav0/cam0/data/b.png", 2), ("mav0/cam0/data/not listed.png", 3)],
        &[("mav0/cam1/data/p.png", 2), ("mav0/cam1/data/q.png", 1)],
    );
    bench.write("take/mav0/cam0/data.csv", "#timestamp [ns],filename\r\n1000000000,a.png\r\n1050000000,b.png\r\n");
    bench.write("take/mav0/cam1/data.csv", "#timestamp [ns],filename\n1000000000,q.png\n1050000000,p.png\n");
    bench.succeeds(&format!("play take -o out {SEARCH}"));
    assert_eq!(played(&bench), [("a.png".to_owned(), Some(1)), ("b.png".to_owned(), Some(2))]);
}

/// Both views in an image.
fn both(moment: usize, beside: bool) -> DynamicImage {
    let Pair { width, height, left, right } = pair(moment);
    if !beside {
        return grey_image(width, 2 * height, &[left, right].concat());
    }
    let rows = left.chunks(width).zip(right.chunks(width)).flat_map(|(left, right)| [left, right].concat());
    grey_image(2 * width, height, &rows.collect::<Vec<u8>>())
}

#[test]
fn views_in_one_image_are_split_as_told_and_doubts_are_told() {
    let bench = Bench::new();
    for moment in [2, 10] {
        bench.write(&format!("beside/{moment}.png"), encode(&both(moment, true), ImageFormat::Png));
        bench.write(&format!("above/{moment}.png"), encode(&both(moment, false), ImageFormat::Png));
    }
    for (folder, layout) in [("beside", "side-by-side"), ("above", "top-bottom")] {
        let line = format!("play {folder} -o out {SEARCH} --layout {layout} --first left");
        let outcome = bench.run(&line);
        assert_eq!(outcome.status, 0, "{outcome:?}");
        assert_eq!(played(&bench), [("2.png".to_owned(), Some(2)), ("10.png".to_owned(), Some(10))]);
        bench
            .refuses(&format!("play {folder} -o other {SEARCH} --layout {layout}"), &["--first left", "--first right"]);
        bench.refuses(
            &format!("play {folder} -o other {SEARCH}"),
            &["--layout side-by-side or top-bottom", "10.png"][..1],
        );
    }
    // 128 x 96 px: two views of 128 x 48 one above the other, or two of 64 x 96 side by side.
    bench.write("tall/1.png", encode(&grey_image(128, 192, &[7; 128 * 192]), ImageFormat::Png));
    let outcome = bench.run(&format!("play tall -o out {SEARCH} --layout side-by-side --first left"));
    assert!(outcome.stderr.contains("--layout top-bottom"), "{outcome:?}");
    bench.write("wide/1.png", encode(&grey_image(192, 64, &[7; 192 * 64]), ImageFormat::Png));
    let outcome = bench.run(&format!("play wide -o out {SEARCH} --layout top-bottom --first left"));
    assert!(outcome.stderr.contains("--layout side-by-side"), "{outcome:?}");
}

#[test]
fn what_nothing_pairs_is_refused_with_the_reason() {
    let cases: [(&[&str], &str, &[&str]); 8] = [
        (&["left/a.png", "left/b.png", "right/c.png", "right/d.png"], "", &["nothing tells which belong together"]),
        (&["left/1.png", "left/3.png", "right/2.png", "right/4.png"], "", &["nothing tells which belong together"]),
        (&["1.png", "2.png"], "", &["tells a camera", "--layout side-by-side", "--left GLOB"]),
        (&["000000_10.png", "000000_11.png"], "", &["tells a camera"]),
        (
            &["image_0/1.png", "image_1/1.png", "image_2/1.png", "image_3/1.png"],
            "",
            &["more than two cameras", "--left 'image_2/*' --right 'image_3/*'"],
        ),
        (&["foo/1.png", "bar/1.png"], "", &["it has bar, foo", "--left GLOB"]),
        (&["left/1.png", "right/1.png"], "--left left/* --right none/*", &["--right none/*", "matches no image"]),
        (&["take.mp4"], "", &["ffmpeg -i", "haarline play -"]),
    ];
    for (files, options, told) in cases {
        let bench = Bench::new();
        write(&bench, &files.iter().map(|file| (*file, 1)).collect::<Vec<_>>(), &[]);
        bench.refuses(&format!("play take -o out {SEARCH} {options}"), told);
    }
    let bench = Bench::new();
    bench.write("take.avi", "RIFF");
    bench.refuses("play take.avi -o out", &["take.avi", "ffmpeg -i take.avi", "--raw 640x480"]);
    bench.refuses("play - -o out", &["--raw WIDTHxHEIGHT"]);
    bench.write("left.png", "");
    bench.refuses("play left.png -o out", &["left.png", "haarline depth LEFT RIGHT"]);
}
