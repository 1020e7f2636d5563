//! What `haarline twin` says where it cannot run. That it runs needs QEMU and a compiler for the chip, which
//! these tests do not.

use std::process::Command;

use image::ImageFormat;

use crate::files::encode;
use crate::scene::{HEIGHT, Pair, WIDTH, bench_with_plane};

#[test]
fn without_qemu_it_says_what_to_install() {
    let bench = bench_with_plane(4);
    let mut twin = Command::new(env!("CARGO_BIN_EXE_haarline"));
    twin.args(["twin", "--num-disparities", "16", "left.png", "right.png", "--elf"]);
    // Any program will do, since none is started.
    twin.arg(std::env::current_exe().unwrap()).current_dir(bench.path("")).env("PATH", "");
    let output = twin.output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("qemu-system-arm is missing") && told.contains("apt install qemu-system-arm"), "{told}");
    assert_eq!(told.lines().count(), 1, "{told}");
}

#[test]
fn what_cannot_run_is_refused_before_anything_is_built() {
    let bench = bench_with_plane(4);
    let wide = |pair: Pair| encode(&pair.left_image(), ImageFormat::Png);
    bench.write("wide.png", wide(Pair::shifted(400, HEIGHT, 0)));
    bench.write("note.txt", "no program");
    bench.refuses("twin left.png right.png", &["source folder", "cargo twin", "--elf", "HAARLINE_TWIN"]);
    bench.refuses("twin left.png right.png --elf note.txt", &["note.txt", "no ELF program"]);
    bench.refuses("twin wide.png wide.png", &["400 px", "320"]);
    bench.refuses("twin left.png right.png --fault flood@0", &["--fault", "overrun"]);
    bench.refuses("twin left.png right.png --fault overrun@1", &["overrun@1", "1 frame"]);
    bench.refuses("twin left.png right.png --wiring frame", &["--wiring", "nibble"]);
    bench.refuses("twin left.png right.png --obstacles o.csv", &["--rig"]);
    bench.succeeds("rig new rig.toml");
    bench.refuses("twin left.png right.png --rig rig.toml", &["320x240", &format!("{WIDTH}x{HEIGHT}")]);
    bench.refuses("twin left.png right.png --random", &["--random"]);
    bench.refuses("twin --random --seed x", &["--seed", "whole number"]);
    bench.refuses("twin --random --noise 3", &["--random", "--noise"]);
    bench.refuses("twin left.png", &["RIGHT"]);
    bench.refuses("twin", &["LEFT"]);
}
