//! A rendered ground plane aligned.

extern crate std;

use super::*;
use crate::align::{Order, Verdict};
use std::vec::Vec;

const SIZE: [u16; 2] = [128, 96];

/// A texture that is smooth between pixels: a few waves in every direction.
fn texture(x: f64, y: f64) -> f64 {
    let waves = [(0.31, 0.17, 0.4), (-0.23, 0.41, 1.9), (0.11, -0.53, 2.2), (0.67, 0.29, 0.1), (0.05, 0.83, 1.1)];
    let wave = |(a, b, c): (f64, f64, f64)| (a * x + b * y + c).sin() + (2.3 * b * x - 1.7 * a * y).cos();
    128.0 + 11.0 * waves.into_iter().map(wave).sum::<f64>()
}

/// A ground plane: near below, disparities from 2 to 14 px; the right view displaced by the ramp.
fn views(ramp: Ramp) -> [Vec<u8>; 2] {
    let disparity = |y: f64| 2.0 + y / 8.0;
    let row = |x: u16, y: u16| (f64::from(x), f64::from(y));
    let mut views = [Vec::new(), Vec::new()];
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let (fx, fy) = row(x, y);
            let twice = [2 * i32::from(x) + 1 - 128, 2 * i32::from(y) + 1 - 96];
            // The left row that the right view shows here, to first order.
            let up = f64::from(ramp.displacement_q16(twice)) / 65_536.0;
            let there = fy - up * (1.0 - f64::from(ramp.scale_q16) / 65_536.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 18 to 238")]
            let pixel = |value: f64| value.round() as u8;
            views[0].push(pixel(texture(fx, fy)));
            views[1].push(pixel(texture(fx + disparity(there), there)));
        }
    }
    views
}

fn align(views: &[Vec<u8>; 2], lost: &[usize]) -> Estimate {
    *aligned(&[views], lost).estimate()
}

fn aligned(frames: &[&[Vec<u8>; 2]], lost: &[usize]) -> Aligner<64, 128> {
    let mut aligner = Aligner::<64, 128>::new(Settings::new(SIZE)).unwrap();
    while aligner.pass() < Aligner::<64, 128>::PASSES {
        for [left, right] in frames {
            for (y, (left, right)) in left.chunks(128).zip(right.chunks(128)).enumerate() {
                if lost.contains(&y) {
                    aligner.miss();
                } else {
                    aligner.push(ScanlinePair { left, right }).unwrap();
                }
            }
            aligner.end_frame();
        }
        aligner.end_pass();
    }
    aligner
}

#[test]
fn offset_roll_and_scale_are_found_with_and_without_all_rows() {
    let ramp = Ramp { rows_q16: 3 * 65_536 + 20_000, roll_q16: 1300, scale_q16: -800 };
    for (lost, most) in [(&[][..], 0.06), (&[40, 41][..], 0.08)] {
        let found = align(&views(ramp), lost);
        let error = |one: i32, other: i32| f64::from(one - other) / 65_536.0;
        assert!(error(found.ramp.rows_q16, ramp.rows_q16).abs() < most, "{found:?}");
        assert!(error(found.ramp.roll_q16, ramp.roll_q16).abs() < 0.002, "{found:?}");
        assert!(error(found.ramp.scale_q16, ramp.scale_q16).abs() < 0.004, "{found:?}");
        assert_eq!((found.verdict(), found.order()), (Verdict::Observable, Order::AsGiven), "{found:?}");
        assert!(found.evaluations <= 100);
    }
}

#[test]
fn every_part_tells_the_offset_that_is_there() {
    // A roll of 1.1 degrees: two and a half rows from one side to the other.
    let ramp = Ramp { rows_q16: 65_536, roll_q16: 1300, scale_q16: 0 };
    let found = aligned(&[&views(ramp)], &[]);
    let parts = Aligner::<64, 128>::PARTS;
    let mut told = 0;
    for across in 0..parts[0] {
        for down in 0..parts[1] {
            let Some(rows) = found.rows_q16([across, down]) else { continue };
            let twice = [(across, parts[0], 128), (down, parts[1], 96)];
            let twice = twice.map(|(part, parts, size)| {
                i32::try_from((2 * part + 1) * size / parts).unwrap() - i32::try_from(size).unwrap()
            });
            let error = f64::from(rows - ramp.displacement_q16(twice)) / 65_536.0;
            assert!(error.abs() < 0.15, "{across} {down}: {error}");
            told += 1;
        }
    }
    // Of a part of 13 x 16 px three blocks at most tell.
    assert!(told > 20, "{told}");
    assert_eq!(found.rows_q16(parts), None);
}

#[test]
fn what_moved_between_the_views_is_a_contradiction() {
    let [left, mut right] = views(Ramp::default());
    let [_, moved] = views(Ramp { rows_q16: 3 * 65_536, ..Ramp::default() });
    // What stands in the middle moved by three rows before the right camera looked.
    for (right, moved) in right.chunks_mut(128).zip(moved.chunks(128)) {
        right[40..88].copy_from_slice(&moved[40..88]);
    }
    let found = align(&[left, right], &[]);
    assert_eq!(found.verdict(), Verdict::Contradictory, "{found:?}");
}

#[test]
fn frames_that_jump_are_a_contradiction() {
    let of = |rows_q16: i32| views(Ramp { rows_q16, ..Ramp::default() });
    let verdict = |others: [i32; 2]| {
        let [one, two] = others.map(of);
        let found = *aligned(&[&of(0), &one, &two], &[]).estimate();
        (found.verdict(), found.spread_q16)
    };
    let (still, spread) = verdict([0; 2]);
    assert_eq!((still, spread), (Verdict::Observable, 0));
    let (jumping, spread) = verdict([30_000, -30_000]);
    assert_eq!(jumping, Verdict::Contradictory, "{spread}");
}

#[test]
fn swapped_views_are_told() {
    let [left, right] = views(Ramp::default());
    assert_eq!(align(&[right, left], &[]).order(), Order::Swapped);
}

#[test]
fn a_blank_wall_and_noise_are_not_observable() {
    let wall = [[90; 128 * 96].to_vec(), [90; 128 * 96].to_vec()];
    assert_eq!(align(&wall, &[]).verdict(), Verdict::NotObservable);
    let mut state = 1_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        100 + (state >> 24 & 15).to_le_bytes()[0]
    };
    let noise = [(); 2].map(|()| (0..128 * 96).map(|_| noise()).collect());
    assert_eq!(align(&noise, &[]).verdict(), Verdict::NotObservable);
}

#[test]
fn widths_out_of_range_are_refused() {
    let new = |width| Aligner::<64, 128>::new(Settings::new([width, 96])).map(|_| ());
    assert_eq!([new(31), new(129)], [Err(ConfigError::Width), Err(ConfigError::Capacity { max_width: 128 })]);
}
