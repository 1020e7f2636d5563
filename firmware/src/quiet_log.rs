//! A log that nobody keeps: while a current is measured no probe is there to fetch one.
#![expect(unsafe_code, reason = "the trait's")]

/// Takes the log.
#[defmt::global_logger]
struct Nowhere;

// SAFETY: it keeps nothing, so that nothing can be mixed up.
unsafe impl defmt::Logger for Nowhere {
    fn acquire() {}

    unsafe fn flush() {}

    unsafe fn release() {}

    unsafe fn write(_: &[u8]) {}
}
