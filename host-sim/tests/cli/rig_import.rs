//! `haarline rig import`: calibrations of other tools in, rig descriptions out.

use serde_json::Value;

use crate::scene::Pair;
use crate::tool::Bench;

/// 640 x 480 px, f 500 px, the right camera 60 mm to the right, turned by 0.01 about its axis (0.573 degrees) and its
/// image displaced by 4 rows and -6 columns.
const OPENCV: &str = "%YAML:1.0\n---\nK1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 500., 0., 320., 0., 500., 240., 0., 0., 1. ]\n\
D1: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ 0., 0., 0., 0., 0. ]\n\
K2: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 500., 0., 314., 0., 500., 244., 0., 0., 1. ]\n\
D2: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ 0., 0., 0., 0., 0. ]\n\
R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 0.99995, -0.0099998, 0., 0.0099998, 0.99995, 0., 0., 0., 1. ]\n\
T: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ -59.997, -0.599988, 0. ]\n";

fn ros(tx: f64) -> String {
    format!(
        "image_width: 640\nimage_height: 480\ncamera_name: cam\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0]\n\
         distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.0, 0.0, 0.0, 0.0, 0.0]\n\
         rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n\
         projection_matrix:\n  rows: 3\n  cols: 4\n  data: [480.0, 0.0, 321.0, {tx}, 0.0, 480.0, 239.0, 0.0, 0.0, 0.0, 1.0, 0.0]\n"
    )
}

const KALIBR: &str = "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n  distortion_model: MODEL\n  intrinsics: [250.0, 250.0, 160.0, 120.0]\n  resolution: [320, 240]\n\
cam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.11]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n  \
distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n  distortion_model: MODEL\n  intrinsics: [250.0, 250.0, 160.0, 121.5]\n  resolution: [320, 240]\n";

const MIDDLEBURY: &str = "cam0=[1000.0 0 300.5; 0 1000.0 200.5; 0 0 1]\ncam1=[1000.0 0 331.5; 0 1000.0 200.5; 0 0 1]\ndoffs=31\nbaseline=193\nwidth=640\nheight=480\nndisp=70\n";

fn sensor(x: f64) -> String {
    format!(
        "%YAML:1.0\n# General sensor definitions.\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, {x}, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]\n\
         resolution: [640, 480]\ncamera_model: pinhole\nintrinsics: [400.0, 400.0, 320.0, 240.0] #fu, fv, cu, cv\ndistortion_model: radial-tangential\n\
         distortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n"
    )
}

/// Imports and shows the description.
#[track_caller]
fn imported(bench: &Bench, arguments: &str) -> Value {
    bench.succeeds(&format!("rig import {arguments} -o rig.toml"));
    let shown = bench.succeeds("rig show rig.toml --json").json();
    std::fs::remove_file(bench.path("rig.toml")).unwrap();
    shown
}

#[track_caller]
fn assert_near(shown: &Value, wanted: &[(&str, f64)], most: f64) {
    for (name, value) in wanted {
        let found = shown[name].as_f64().unwrap();
        assert!((found - value).abs() <= most, "{name}: {found}, not {value}, in {shown}");
    }
}

#[test]
fn an_opencv_calibration_turns_both_views_in_all_three_forms() {
    let bench = Bench::new();
    bench.write("c.yml", OPENCV);
    let json = r#"{"K1": [[500,0,320],[0,500,240],[0,0,1]], "D1": [[0,0,0,0,0]], "K2": [[500,0,314],[0,500,244],[0,0,1]], "D2": [],
        "R": [[0.99995,-0.0099998,0],[0.0099998,0.99995,0],[0,0,1]], "T": [[-59.997],[-0.599988],[0]], "size": [640, 480]}"#;
    bench.write("c.json", json);
    let matrix = |name: &str, data: &str| {
        format!("<{name} type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt><data>{data}</data></{name}>")
    };
    let xml = ["cameraMatrix1", "cameraMatrix2", "R", "T"].into_iter().zip([
        "500. 0. 320. 0. 500. 240. 0. 0. 1.",
        "500. 0. 314. 0. 500. 244. 0. 0. 1.",
        "0.99995 -0.0099998 0. 0.0099998 0.99995 0. 0. 0. 1.",
        "-59.997 -0.599988 0.",
    ]);
    let xml: String = xml.map(|(name, data)| matrix(name, data)).collect();
    bench.write("c.xml", format!("<?xml version=\"1.0\"?>\n<opencv_storage>{xml}</opencv_storage>"));
    for arguments in ["c.yml --size 640x480", "c.json", "c.xml --size 640x480"] {
        let shown = imported(&bench, arguments);
        // A turn of this size leaves more than a tenth of a pixel to offsets and roll: both views are turned by tables.
        assert_near(
            &shown,
            &[("roll_deg", 0.0), ("row_offset", 0.0), ("scale_percent", 0.0), ("baseline_mm", 60.0)],
            0.01,
        );
        assert_near(&shown, &[("focal_px", 500.0), ("cx", 320.0), ("cy", 240.0)], 10.0);
        assert_eq!(shown["column_offset"], 0, "{shown}");
    }
    bench.succeeds("rig import c.json -o rig.toml");
    let written = String::from_utf8(bench.read("rig.toml")).unwrap();
    for key in ["left_camera", "left_turn", "right_camera", "right_turn"] {
        assert!(written.lines().any(|line| line.starts_with(&format!("{key} = "))), "{key}: {written}");
    }
    std::fs::remove_file(bench.path("rig.toml")).unwrap();
    bench.refuses("rig import c.yml -o rig.toml", &["c.yml", "OpenCV", "--size"]);
    let half = imported(&bench, "c.json --shrink 2");
    assert_near(&half, &[("focal_px", 250.0), ("cx", 159.75)], 5.0);
    assert_eq!(half["width"], 320, "{half}");
}

#[test]
fn ros_kalibr_and_euroc_are_read() {
    let bench = Bench::new();
    bench.write("left.yaml", ros(0.0));
    bench.write("right.yaml", ros(-57.6));
    let shown = imported(&bench, "left.yaml right.yaml --rectified");
    assert_near(&shown, &[("focal_px", 480.0), ("baseline_mm", 120.0), ("cx", 321.0), ("cy", 239.0)], 0.01);
    let shown = imported(&bench, "left.yaml right.yaml");
    assert_near(&shown, &[("focal_px", 500.0), ("baseline_mm", 120.0), ("row_offset", 0.0)], 0.01);
    bench.refuses("rig import right.yaml left.yaml -o rig.toml", &["exchanged"]);
    bench.refuses("rig import left.yaml -o rig.toml", &["ROS camera_info", "give both"]);

    bench.write("chain.yaml", KALIBR.replace("MODEL", "radtan"));
    let shown = imported(&bench, "chain.yaml");
    assert_near(&shown, &[("focal_px", 250.0), ("baseline_mm", 110.0), ("row_offset", 1.5)], 0.02);
    // A fisheye is taken away by tables, at a focal length that they choose.
    bench.write("chain.yaml", KALIBR.replace("MODEL", "equidistant"));
    let shown = imported(&bench, "chain.yaml");
    assert_near(&shown, &[("baseline_mm", 110.0), ("row_offset", 0.0)], 0.02);
    assert_near(&shown, &[("focal_px", 250.0)], 30.0);
    bench.write("chain.yaml", KALIBR.replace("MODEL", "fov"));
    bench.refuses("rig import chain.yaml -o rig.toml", &["fov", "is not read", "equidistant"]);

    bench.write("cam0.yaml", sensor(0.0));
    bench.write("cam1.yaml", sensor(0.11));
    let shown = imported(&bench, "cam0.yaml cam1.yaml --shrink 2");
    assert_near(&shown, &[("focal_px", 200.0), ("baseline_mm", 110.0), ("width", 320.0), ("height", 240.0)], 0.01);
    bench.refuses(
        "rig import cam1.yaml cam0.yaml -o rig.toml",
        &["EuRoC", "exchanged"].map(|w| if w == "EuRoC" { "cam1.yaml" } else { w }),
    );
}

#[test]
fn middlebury_and_kitti_bring_their_axes() {
    let bench = Bench::new();
    bench.write("calib.txt", MIDDLEBURY);
    let shown = imported(&bench, "calib.txt");
    assert_near(
        &shown,
        &[("focal_px", 1000.0), ("baseline_mm", 193.0), ("cx", 300.5), ("cy", 200.5), ("doffs", 31.0)],
        0.001,
    );
    let projection = |x: f64| format!("7.215e+02 0 6.095e+02 {x} 0 7.215e+02 1.728e+02 0 0 0 1 0");
    bench.write("k.txt", format!("P0: {}\nP1: {}\nTr: 1 0 0\n", projection(0.0), projection(-387.6)));
    let shown = imported(&bench, "k.txt --size 1242x375");
    assert_near(&shown, &[("focal_px", 721.5), ("baseline_mm", 537.2), ("cx", 609.5), ("doffs", 0.0)], 0.1);
    bench.write("k.txt", format!("P0: {}\nP1: {}\n", projection(-387.6), projection(0.0)));
    bench.refuses("rig import k.txt -o rig.toml --size 1242x375", &["k.txt", "exchanged"]);
}

#[test]
fn depth_and_cloud_take_axes_and_doffs() {
    let bench = crate::scene::bench_with_plane(6);
    let (width, height) = (crate::scene::WIDTH, crate::scene::HEIGHT);
    let text = MIDDLEBURY.replace("width=640\nheight=480", &format!("width={width}\nheight={height}"));
    bench.write(
        "calib.txt",
        text.replace("1000.0", "100.0")
            .replace("baseline=193", "baseline=60")
            .replace("300.5", "30")
            .replace("331.5", "34")
            .replace("doffs=31", "doffs=4")
            .replace("200.5", "20"),
    );
    bench.succeeds("rig import calib.txt -o rig.toml");
    let told =
        bench.succeeds("depth left.png right.png --rig rig.toml --num-disparities 16 -o cloud.ply --json").json();
    // 100 px x 60 mm / (6 + 4) px.
    assert_eq!(told["median_depth_mm"], 600, "{told}");
    let bytes = bench.read("cloud.ply");
    let body = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    let point = &bytes[body..body + 12];
    let metre = |at: usize| f32::from_le_bytes(point[at..at + 4].try_into().unwrap());
    let (x, y, z) = (metre(0), metre(4), metre(8));
    // The first points are those of the first row: 20 px over the axis. The right view does not see them: a guess.
    assert!((y / z + 0.2).abs() < 1e-3 && (0.5..0.8).contains(&z), "{x} {y} {z}");
}

#[test]
fn what_is_missing_wrong_or_of_another_kind_is_named() {
    let bench = Bench::new();
    let refuses = |text: &str, words: &[&str]| {
        bench.write("c.yml", text);
        bench.refuses("rig import c.yml --size 640x480 -o rig.toml", &[&["c.yml"], words].concat());
    };
    refuses(&OPENCV.replace("K2:", "Q2:"), &["K2 is missing"]);
    refuses(&OPENCV.replace("D2:", "E2:"), &["D2 is missing", "of one camera only"]);
    refuses(&OPENCV.replace("D1:", "E1:"), &["D1 is missing", "of one camera only"]);
    refuses(&OPENCV.replace("T:", "Z:"), &["without R and T"]);
    refuses(&OPENCV.replace("500., 0., 314.", ".nan, 0., 314."), &["no number"]);
    refuses(&OPENCV.replace("[ -59.997, -0.599988, 0. ]", "[ 60., 0., 0. ]"), &["exchanged"]);
    refuses(&OPENCV.replace("[ -59.997, -0.599988, 0. ]", "[ -3.3, 0., 0. ]"), &["--unit-mm"]);
    refuses(&OPENCV.replace("314., 0., 500., 244.", "1400., 0., 500., 900."), &["other pictures"]);
    let omni = KALIBR.replace("camera_model: pinhole", "camera_model: omni").replace("MODEL", "radtan");
    refuses(&omni, &["omni is not read", "pinhole"]);
    refuses("a: 1\nb: 2\n", &["no calibration that is known", "Kalibr"]);
    bench.write("c.yml", "just text");
    bench.refuses("rig import c.yml -o rig.toml", &["c.yml"]);
    bench.refuses("rig import none.yml -o rig.toml", &["none.yml", "cannot be read"]);
    bench.write("left.yaml", ros(0.0));
    bench.refuses("rig show left.yaml", &["ROS camera_info", "rig import"]);
    bench.write("rig.toml", OPENCV);
    bench.refuses("rig show rig.toml", &["OpenCV", "rig import"]);
    bench.refuses("rig import left.yaml left.yaml -o left.yaml", &["one of the files that are read"]);
}

/// Refuses the files of `arguments`, and tells all of `words`.
#[track_caller]
fn refuses(bench: &Bench, arguments: &str, words: &[&str]) {
    bench.refuses(&format!("rig import {arguments} -o rig.toml"), words);
}

#[test]
fn two_files_of_which_one_would_be_ignored_are_refused() {
    let bench = Bench::new();
    bench.write("c.yml", OPENCV);
    bench.write("d.yml", OPENCV.replace("500., 0., 320.", "501., 0., 320."));
    bench.write("ros.yaml", ros(0.0));
    bench.write("chain.yaml", KALIBR.replace("MODEL", "radtan"));
    bench.write("chain2.yaml", KALIBR.replace("MODEL", "equidistant"));
    bench.write("sensor.yaml", sensor(0.0));
    bench.write("calib.txt", MIDDLEBURY);
    bench.write("other.yml", "name: some rig\nserial: 12\n");
    let kinds = [
        ("c.yml", "an OpenCV stereo calibration"),
        ("ros.yaml", "a ROS camera_info file"),
        ("chain.yaml", "a Kalibr camchain"),
        ("sensor.yaml", "an EuRoC sensor.yaml"),
        ("calib.txt", "a Middlebury calib.txt"),
    ];
    for (one, first) in kinds {
        for (other, second) in kinds {
            if one != other {
                let told = format!("{one} is {first}, but {other} is {second}");
                refuses(&bench, &format!("{one} {other} --size 640x480"), &[&told]);
            }
        }
        refuses(
            &bench,
            &format!("{one} other.yml --size 640x480"),
            &["error: other.yml: is no calibration that is known"],
        );
    }
    refuses(&bench, "c.yml d.yml --size 640x480", &["c.yml, d.yml", "each file tells another K1"]);
    refuses(&bench, "chain.yaml chain2.yaml", &["a Kalibr camchain, which tells of both cameras: give one"]);
}

#[test]
fn one_camera_given_twice_is_not_called_exchanged() {
    let bench = Bench::new();
    for (left, right) in [(ros(0.0), ros(-57.6)), (sensor(0.0), sensor(0.11))] {
        bench.write("left.yaml", &left);
        bench.write("right.yaml", right);
        bench.write("copy.yaml", &left);
        bench.write("renamed.yaml", left.replace("name: cam", "name: other") + "comment: a copy\n");
        refuses(&bench, "left.yaml left.yaml", &["left.yaml and left.yaml are the same file"]);
        refuses(&bench, "left.yaml ./left.yaml", &["the same file"]);
        refuses(&bench, "left.yaml copy.yaml", &["left.yaml and copy.yaml have the same content"]);
        refuses(&bench, "left.yaml renamed.yaml", &["one camera"]);
        refuses(&bench, "right.yaml left.yaml", &["exchanged"]);
    }
}

#[test]
fn coefficients_are_as_many_as_the_lens_model_has() {
    let bench = Bench::new();
    let zeros = |count: usize| vec!["0.0"; count].join(", ");
    let told = |key: &str, count: usize, model: &str, needed: &str| {
        format!("{key}: has {count} coefficients, where {model} needs {needed}")
    };
    bench.write("right.yaml", sensor(0.11));
    for count in [2, 3, 5] {
        bench.write(
            "left.yaml",
            sensor(0.0).replace("coefficients: [0.0, 0.0, 0.0, 0.0]", &format!("coefficients: [{}]", zeros(count))),
        );
        let told = told("distortion_coefficients", count, "radial-tangential", "4");
        refuses(&bench, "left.yaml right.yaml", &[&format!("error: left.yaml: {told}")]);
    }
    bench.write("left.yaml", ros(0.0));
    for (model, count, needed) in
        [("plumb_bob", 3, "5"), ("plumb_bob", 8, "5"), ("rational_polynomial", 5, "8"), ("equidistant", 5, "4")]
    {
        let of_five = format!("cols: 5\n  data: [{}]", zeros(5));
        let text =
            ros(-57.6).replace("plumb_bob", model).replace(&of_five, &format!("cols: 5\n  data: [{}]", zeros(count)));
        bench.write("right.yaml", text);
        let told = told("distortion_coefficients", count, model, needed);
        refuses(&bench, "left.yaml right.yaml", &[&format!("error: right.yaml: {told}")]);
    }
    for (model, count) in [("radtan", 5), ("radtan", 2), ("equidistant", 2)] {
        let text =
            KALIBR.replace("MODEL", model).replacen(&format!("[{}]", zeros(4)), &format!("[{}]", zeros(count)), 1);
        bench.write("chain.yaml", text);
        let told = told("cam0: distortion_coeffs", count, model, "4");
        refuses(&bench, "chain.yaml", &[&format!("error: chain.yaml: {told}")]);
    }
    for (count, is_read) in [
        (1, false),
        (2, false),
        (3, false),
        (4, true),
        (5, true),
        (6, false),
        (8, true),
        (12, true),
        (13, false),
        (14, true),
    ] {
        bench
            .write("c.yml", OPENCV.replacen("data: [ 0., 0., 0., 0., 0. ]", &format!("data: [ {} ]", zeros(count)), 1));
        if is_read {
            imported(&bench, "c.yml --size 640x480");
        } else {
            let told = told("D1", count, "OpenCV's model", "4, 5, 8, 12 or 14");
            refuses(&bench, "c.yml --size 640x480", &[&format!("c.yml: {told}")]);
        }
    }
}

#[test]
fn a_missing_key_and_a_value_of_another_kind_are_told_apart() {
    let bench = Bench::new();
    let without = |text: &str, from: &str, to: &str| {
        let (begin, end) = (text.find(from).unwrap(), text.find(to).unwrap());
        format!("{}{}", &text[..begin], &text[end..])
    };
    bench.write("left.yaml", ros(0.0));
    bench.write("right.yaml", without(&ros(-57.6), "distortion_coefficients", "rectification_matrix"));
    refuses(&bench, "left.yaml right.yaml", &["error: right.yaml: distortion_coefficients is missing"]);
    bench.write("right.yaml", without(&ros(-57.6), "projection_matrix", "  rows: 3\n  cols: 4"));
    refuses(&bench, "left.yaml right.yaml", &["right.yaml: "]);
    bench.write("left.yaml", sensor(0.0) + "\nnone: 1\n");
    bench.write("right.yaml", without(&(sensor(0.11) + "none: 1\n"), "distortion_coefficients", "none"));
    refuses(&bench, "left.yaml right.yaml", &["error: right.yaml: distortion_coefficients is missing"]);
    bench.write("right.yaml", sensor(0.11).replace("T_BS", "T_SB"));
    refuses(&bench, "left.yaml right.yaml", &["error: right.yaml: T_BS is missing"]);

    let wrong = |text: &str, words: &[&str]| {
        bench.write("c.yml", text);
        refuses(&bench, "c.yml --size 640x480", &[&["c.yml"], words].concat());
    };
    wrong(&OPENCV.replace("K1: !!", "K1: \"abc\"\nX1: !!"), &["K1: \"abc\" is no matrix of numbers"]);
    wrong(&OPENCV.replace("K1: !!", "M1:\nX1: !!"), &["M1: is no matrix of numbers"]);
    wrong(
        &OPENCV.replace("[ 500., 0., 314.", "[ 500., abc, 314."),
        &["K2: \"abc\" is text, where a number is expected"],
    );
    wrong(&OPENCV.replace("500., 0., 314.", ".Nan, 0., 314."), &["K2: .Nan is no number"]);
    wrong(
        &OPENCV.replace(
            "[ 500., 0., 320., 0., 500., 240., 0., 0., 1. ]",
            "[ 500., 0., 0., 0., 500., 0., 320., 240., 1. ]",
        ),
        &["K1: is transposed"],
    );
    wrong(&OPENCV.replace("[ -59.997, -0.599988, 0. ]", "[ 0., 0., 0. ]"), &["same place", "zero"]);
    wrong(&OPENCV.replace("[ -59.997, -0.599988, 0. ]", "[ 0., -60., 0. ]"), &["do not stand side by side"]);
    wrong(
        &OPENCV.replace("[ -59.997, -0.599988, 0. ]", "[ 59.997, 0., 0. ]"),
        &["camera 1 stands on the right of camera 2"],
    );
    for (turn, degrees) in
        [("0., -1., 0., 1., 0., 0., 0., 0., 1.", "90"), ("-1., 0., 0., 0., -1., 0., 0., 0., 1.", "180")]
    {
        let text = OPENCV.replace("0.99995, -0.0099998, 0., 0.0099998, 0.99995, 0., 0., 0., 1.", turn);
        wrong(&text, &[&format!("turned by {degrees} degrees to each other"), "stored turned"]);
    }
}

#[test]
fn lists_of_images_single_cameras_and_rigs_are_called_what_they_are() {
    let bench = Bench::new();
    bench.write("list.xml", "<?xml version=\"1.0\"?>\n<opencv_storage>\n<imagelist>\n\"left01.jpg\"\n\"right01.jpg\"\n</imagelist>\n</opencv_storage>\n");
    bench.write("list.yml", "%YAML:1.0\n---\nimages:\n   - left01.jpg\n   - right01.jpg\n");
    bench.write("c.yml", OPENCV);
    for list in ["list.xml", "list.yml"] {
        let words =
            [&format!("error: {list}: is an OpenCV image list"), "calibrate with its images first", "M1 D1 M2 D2 R T"];
        refuses(&bench, list, &words);
        refuses(&bench, &format!("c.yml {list}"), &words);
        bench.refuses(
            &format!("rig show {list}"),
            &["this is an OpenCV image list, where a rig description is expected"],
        );
    }
    bench.write("one.yml", "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 500., 0., 320., 0., 500., 240., 0., 0., 1. ]\n");
    refuses(&bench, "one.yml", &["one.yml: is an OpenCV calibration of one camera", "stereo calibration"]);
    bench.succeeds("rig import c.yml --size 640x480 -o done.toml");
    refuses(&bench, "done.toml", &["done.toml: is a rig description already", "--rig"]);
}

#[test]
fn what_editors_and_transfers_do_to_a_file_is_read_or_told() {
    let bench = Bench::new();
    let json = r#"{"K1": [[500,0,320],[0,500,240],[0,0,1]], "D1": [0,0,0,0,0], "K2": [[500,0,320],[0,500,240],[0,0,1]], "D2": [0,0,0,0,0],
        "R": [[1,0,0],[0,1,0],[0,0,1]], "T": [-60,0,0], "size": [640, 480]}"#;
    let xml = "<?xml version=\"1.0\"?>\n<opencv_storage><K1><rows>3</rows><cols>3</cols><data>500 0 320 0 500 240 0 0 1</data></K1>\
               <K2><rows>3</rows><cols>3</cols><data>500 0 320 0 500 240 0 0 1</data></K2><R><rows>3</rows><cols>3</cols>\
               <data>1 0 0 0 1 0 0 0 1</data></R><T><rows>3</rows><cols>1</cols><data>-60 0 0</data></T></opencv_storage>\n";
    bench.write("c.json", format!("\u{feff}{json}").replace('\n', "\r\n"));
    bench.write("c.yml", format!("\u{feff}{OPENCV}").replace('\n', "\r\n"));
    bench.write("c.xml", format!("\u{feff}{xml}").replace('\n', "\r\n"));
    for file in ["c.json", "c.yml", "c.xml"] {
        assert_eq!(imported(&bench, &format!("{file} --size 640x480"))["width"], 640, "{file}");
    }
    assert!(
        bench.succeeds("rig import c.xml --size 640x480 -o rig.toml").stdout.contains("without distortion (no D1, D2)")
    );
    std::fs::remove_file(bench.path("rig.toml")).unwrap();
    let wrong = |text: &[u8], words: &[&str]| {
        bench.write("c.txt", text);
        refuses(&bench, "c.txt --size 640x480", &[&["c.txt"], words].concat());
    };
    wrong(b"", &["is empty"]);
    wrong(&json.as_bytes()[..90], &["JSON that is cut off"]);
    wrong(&xml.as_bytes()[..250], &["XML that is cut off"]);
    wrong(&OPENCV.as_bytes()[..OPENCV.find("240.").unwrap()], &["YAML that is cut off"]);
    wrong(json.replace("500,0,320", "NaN,0,320").as_bytes(), &["NaN at line 1 column 10 is no number"]);
    wrong(OPENCV.replace("K2:", "K1:").as_bytes(), &["K1 is there twice"]);
    wrong(OPENCV.replace("   rows", "\trows").as_bytes(), &["tab", "at line 4 column"]);
    let wide: Vec<u8> = format!("\u{feff}{json}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    wrong(&wide, &["UTF-16", "save it as UTF-8"]);
    wrong(xml.replace("<data>500 0 320", "<data>500 0,0 320").as_bytes(), &["K1: \"0,0\" is text"]);
}

#[test]
fn units_that_cannot_be_are_told_with_what_follows() {
    let bench = Bench::new();
    bench.write("left.yaml", sensor(0.0));
    bench.write("right.yaml", sensor(110.0));
    refuses(&bench, "left.yaml right.yaml", &["110000 mm apart", "a unit is taken for 1000 mm", "--unit-mm"]);
    assert_near(&imported(&bench, "left.yaml right.yaml --unit-mm 1"), &[("baseline_mm", 110.0)], 0.01);
    bench.write("right.yaml", sensor(0.11));
    refuses(&bench, "left.yaml right.yaml --unit-mm 1", &["0.11 mm apart", "taken for 1 mm"]);
    bench.write("c.yml", OPENCV.replace("[ -59.997, -0.599988, 0. ]", "[ -0.00006, 0., 0. ]"));
    refuses(&bench, "c.yml --size 640x480", &["the distance of the cameras is 6.0e-5", "--unit-mm"]);
}

#[test]
fn lenses_of_two_models_are_told_with_the_files() {
    let bench = Bench::new();
    let bent = |x: f64| sensor(x).replace("coefficients: [0.0,", "coefficients: [-0.2,");
    bench.write("left.yaml", bent(0.0));
    bench.write("right.yaml", bent(0.11).replace("radial-tangential", "equidistant"));
    let told = "left camera's lens is radial-tangential, the right one's equidistant";
    refuses(&bench, "left.yaml right.yaml", &["left.yaml, right.yaml: EuRoC", told]);
}

#[test]
fn import_shrinks_to_the_size_that_depth_has_and_tells_what_is_cut() {
    let bench = Bench::new();
    Pair::shifted(160, 40, 6).write(&bench);
    let text = |x: f64| {
        let text = sensor(x).replace("resolution: [640, 480]", "resolution: [160, 40]");
        text.replace("400.0, 400.0, 320.0, 240.0", "120.0, 120.0, 79.5, 19.5")
    };
    bench.write("left.yaml", text(0.0));
    bench.write("right.yaml", text(0.11));
    let outcome = bench.succeeds("rig import left.yaml right.yaml --shrink 3 -o third.toml");
    assert!(outcome.stdout.contains("of 160x40 px, 1 columns on the right and 1 rows at the bottom"), "{outcome:?}");
    assert!(!bench.succeeds("rig import left.yaml right.yaml --shrink 2 -o half.toml").stdout.contains("fall away"));
    bench.succeeds("rig import left.yaml right.yaml -o full.toml");
    let small = bench.succeeds("depth left.png right.png --rig full.toml --shrink 3 --json").json();
    let third = bench.succeeds("rig show third.toml --json").json();
    assert_eq!([&third["width"], &third["height"]], [&small["width"], &small["height"]]);
    assert_eq!([&third["width"], &third["height"]], [53, 13]);
    // (79.5 + 0.5) / 3 - 0.5 and (19.5 + 0.5) / 3 - 0.5: the cut takes nothing from before the axis.
    assert_near(&third, &[("cx", 26.167), ("cy", 6.167), ("focal_px", 40.0)], 0.001);

    // The rig of the frames as recorded, or of the smaller ones.
    let both = ["full", "half"]
        .map(|rig| bench.succeeds(&format!("depth left.png right.png --rig {rig}.toml --shrink 2 --json")).json());
    assert_eq!(
        both.each_ref().map(|told| (told["width"].as_i64(), told["focal_px"].as_f64())),
        [(Some(80), Some(60.0)); 2]
    );
    // A reduction too few, one too many.
    let depth = |rest: &str, words: &[&str]| bench.refuses(&format!("depth left.png right.png {rest} -o m.pfm"), words);
    depth("--rig third.toml --shrink 1", &["53x13 px, but the views are 160x40 px", "3 times larger"]);
    depth("--rig half.toml", &["80x20 px, but the views are 160x40 px", "2 times larger"]);
    let pair = Pair::shifted(80, 20, 3);
    pair.write(&bench);
    depth("--rig full.toml", &["160x40 px, but the views are 80x20 px", "rig import --shrink 2 makes a rig for them"]);
    Pair::shifted(40, 160, 3).write(&bench);
    depth("--rig full.toml", &["turned by 90 degrees"]);
    pair.write_as(&bench, "take/left/0.png", "take/right/0.png");
    pair.write_as(&bench, "take/left/1.png", "take/right/1.png");
    bench.refuses("play take --rig full.toml -o out", &["2 times smaller"]);
    bench.refuses("rig rectify take --rig full.toml -o out", &["2 times smaller"]);
}
