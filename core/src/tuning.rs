//! Experiment knobs (removed before landing).
use core::sync::atomic::{AtomicI32, Ordering::Relaxed};
/// Knobs.
pub static T: [AtomicI32; 64] = [const { AtomicI32::new(i32::MIN) }; 64];
/// Value of a knob or its default.
#[inline]
pub fn t(i: usize, default: i32) -> i32 {
    let v = T[i].load(Relaxed);
    if v == i32::MIN { default } else { v }
}
