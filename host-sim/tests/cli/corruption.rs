//! Random corruptions of everything that is read: no wrong row, no fault, a documented status and one line each.

use std::fs;

use image::{DynamicImage, ImageFormat};

use crate::files::{Map, encode};
use crate::receive::Sender;
use crate::scene::Pair;
use crate::tool::{Bench, Outcome};

const CASES: usize = 200;

/// Repeatable random numbers.
pub struct Random(u64);

impl Random {
    pub fn new() -> Self {
        Self(7)
    }

    pub fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }

    /// One to three changed bytes, every other time in the first ones, where a header is.
    pub fn corrupt(&mut self, whole: &[u8]) -> Vec<u8> {
        let mut bytes = whole.to_vec();
        let reach = if self.below(2) == 0 { bytes.len().min(100) } else { bytes.len() };
        for _ in 0..=self.below(3) {
            bytes[self.below(reach)] ^= 1 + self.below(255) as u8;
        }
        bytes
    }
}

/// Neither a fault nor a signal, and nothing but lines of the known kinds.
#[track_caller]
pub fn assert_documented(outcome: &Outcome, statuses: &[i32], what: &str) {
    assert!(statuses.contains(&outcome.status), "{what}: {outcome:?}");
    for line in outcome.stderr.lines() {
        let is_known = ["error: ", "warning: ", "frame "].iter().any(|begin| line.starts_with(begin));
        assert!(is_known && !line.contains("fault") && !line.contains("panicked"), "{what}: {line}");
    }
    let errors = outcome.stderr.lines().filter(|line| line.starts_with("error: ")).count();
    assert_eq!(errors, usize::from(outcome.status != 0), "{what}: {}", outcome.stderr);
}

/// A kind of image: suffix, whether a checksum guards all of its pixels, file of a view.
type Kind = (&'static str, bool, fn(&DynamicImage) -> Vec<u8>);

const KINDS: [Kind; 8] = [
    ("png", true, |view| encode(view, ImageFormat::Png)),
    ("rgb.png", true, |view| encode(&view.to_rgb8().into(), ImageFormat::Png)),
    ("pgm", false, |view| encode(view, ImageFormat::Pnm)),
    ("ppm", false, |view| encode(&view.to_rgb8().into(), ImageFormat::Pnm)),
    ("bmp", false, |view| encode(view, ImageFormat::Bmp)),
    ("jpg", false, |view| encode(view, ImageFormat::Jpeg)),
    ("rgb.jpg", false, |view| encode(&view.to_rgb8().into(), ImageFormat::Jpeg)),
    ("tif", false, |view| encode(view, ImageFormat::Tiff)),
];

#[test]
fn images_of_every_kind_are_read_or_skipped_and_their_neighbours_are_right() {
    let pair = Pair::shifted(64, 16, 4);
    for (suffix, is_guarded, encoder) in KINDS {
        let (bench, mut random) = (Bench::new(), Random::new());
        let whole = encoder(&pair.right_image());
        // Each fifth frame is whole.
        for frame in 0..CASES * 5 / 4 {
            let bytes = if frame % 5 == 0 { whole.clone() } else { random.corrupt(&whole) };
            bench.write(&format!("take/left/{frame:03}.png"), encode(&pair.left_image(), ImageFormat::Png));
            bench.write(&format!("take/right/{frame:03}.{suffix}"), bytes);
        }
        let outcome = bench.run("play take -o out --method lite --num-disparities 16 --write disparity");
        assert_documented(&outcome, &[1], suffix);
        let map = |frame: usize| fs::read(bench.path(format!("out/{frame:03}.pfm"))).ok();
        let (right, mut skipped) = (map(0).unwrap(), 0);
        for frame in 0..CASES * 5 / 4 {
            let told = outcome.stderr.matches(&format!("frame {frame} skipped: ")).count();
            let found = map(frame);
            assert_eq!(told, usize::from(found.is_none()), "{suffix}, frame {frame}: one line each");
            skipped += told;
            let must_be_right = frame % 5 == 0 || is_guarded && found.is_some();
            assert!(!must_be_right || found.as_ref() == Some(&right), "{suffix}, frame {frame}");
        }
        assert!(outcome.stderr.contains(&format!("{skipped} of 250 frames were damaged")), "{}", outcome.stderr);
        assert!((20..=CASES).contains(&skipped), "{suffix}: {skipped} skipped");
    }
}

#[test]
fn packets_give_right_rows_or_unknown_ones() {
    let (bench, mut random) = (Bench::new(), Random::new());
    let mut sender = Sender::new();
    let whole: Vec<u8> = (0..20).flat_map(|_| sender.frame()).collect();
    let mut right = 0;
    for case in 0..CASES {
        let mut bytes = random.corrupt(&whole);
        // Lost and doubled stretches, too.
        let (at, length) = (random.below(whole.len()), random.below(150));
        let end = (at + length).min(whole.len());
        match case % 3 {
            0 => drop(bytes.drain(at..end)),
            1 => drop(bytes.splice(at..at, whole[at..end].iter().copied())),
            _ => {}
        }
        bench.write("packets.bin", bytes);
        let outcome = bench.run("receive packets.bin -o maps --min-confidence 0");
        assert_documented(&outcome, &[0, 1], &format!("case {case}"));
        for frame in 0..20 {
            let Ok(bytes) = fs::read(bench.path(format!("maps/{frame:06}.pfm"))) else { continue };
            let map = Map::from_pfm(&bytes);
            assert_eq!([map.width, map.height], [32, 1], "case {case}, frame {frame}");
            let is_right = map.px.iter().all(|&px| px == (frame % 16) as f32);
            assert!(is_right || map.known().is_empty(), "case {case}, frame {frame}: {:?}", map.px);
            right += usize::from(is_right);
        }
        fs::remove_dir_all(bench.path("maps")).unwrap();
    }
    assert!(right > CASES * 16, "{right} of {} frames are whole", CASES * 20);
}
