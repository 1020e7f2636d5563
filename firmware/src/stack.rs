//! How deep the stack went: it is painted, and later looked at.

const PAINT: u32 = 0xA5A5_5A5A;
/// Bytes at its end that nobody may touch, where a board has a guard: a power of two, at an address that it divides.
pub const GUARD: usize = 256;
/// Left alone below the frame that paints, bytes.
const SPARE: usize = 64;

#[expect(unsafe_code, reason = "symbols of the linker script")]
unsafe extern "C" {
    static mut _stack_end: u32;
    static mut _stack_start: u32;
}

/// The guard's address.
#[must_use]
pub fn guard() -> usize {
    (&raw mut _stack_end).addr().next_multiple_of(GUARD)
}

/// Lowest and highest address of the stack, the guard left out.
fn bounds() -> (*mut u32, *mut u32) {
    let end = &raw mut _stack_end;
    (end.wrapping_byte_add(guard() + GUARD - end.addr()), &raw mut _stack_start)
}

/// Bytes that there are for it.
#[must_use]
pub fn size() -> usize {
    let (end, start) = bounds();
    start.addr() - end.addr()
}

/// Paints what is not in use.
#[inline(never)]
#[expect(unsafe_code, reason = "writes memory that nobody uses")]
pub fn paint() {
    let here = 0_u32;
    let (mut word, _) = bounds();
    let end = (&raw const here).addr() - SPARE;
    while word.addr() < end {
        // SAFETY: between the end of the static memory and the frame of this function is nothing.
        unsafe {
            word.write_volatile(PAINT);
            word = word.add(1);
        }
    }
}

/// Most bytes in use since it was painted.
#[expect(unsafe_code, reason = "reads memory that nobody owns")]
pub fn high_water() -> usize {
    let (mut word, top) = bounds();
    // SAFETY: inside the stack's memory, of which every word can be read.
    while word < top && unsafe { word.read_volatile() } == PAINT {
        // SAFETY: still inside.
        word = unsafe { word.add(1) };
    }
    top.addr() - word.addr()
}
