//! `haarline bench`: what it times. How long that takes is the machine's.

use std::process::Command;

use crate::scene::bench_with_plane;

#[test]
fn each_method_is_timed() {
    let bench = bench_with_plane(4);
    let told =
        bench.succeeds("bench left.png right.png --num-disparities 16 --methods lite,sgm --rounds 2 --json").json();
    assert_eq!((&told["num_disparities"], &told["rounds"]), (&16.into(), &2.into()));
    for (nth, name) in ["lite", "sgm"].into_iter().enumerate() {
        let method = &told["methods"][nth];
        assert_eq!(method["method"], name);
        assert!(
            0.0 < method["least_ms"].as_f64().unwrap() && method["least_ms"].as_f64() <= method["median_ms"].as_f64()
        );
    }
    assert!(told["opencv"].is_null() && told["ratios"].as_array().unwrap().is_empty());
    bench.refuses("bench left.png right.png --rounds 0", &["--rounds"]);
    bench.refuses("bench left.png right.png --methods best", &["--methods", "lite"]);
}

#[test]
fn without_opencv_it_says_how_to_install_it() {
    let bench = bench_with_plane(4);
    let mut tool = Command::new(env!("CARGO_BIN_EXE_haarline"));
    tool.args(["bench", "--num-disparities", "16", "--against-opencv", "left.png", "right.png"]);
    let output = tool.current_dir(bench.path("")).env("PATH", "").output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("python3 -m pip install opencv-python-headless"), "{told}");
    assert_eq!(told.lines().count(), 1, "{told}");
}
