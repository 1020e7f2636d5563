//! What the DSP instructions do, without them.

/// The greater byte of each pair.
#[inline(always)]
pub fn max(a: u32, b: u32) -> u32 {
    each(a, b, u8::max)
}

/// Differences of bytes, 0 where they would be negative.
#[inline(always)]
pub fn saturating_sub(a: u32, b: u32) -> u32 {
    each(a, b, u8::saturating_sub)
}

/// All bits of each byte that is not less than that of `b`.
#[inline(always)]
pub fn at_least(a: u32, b: u32) -> u32 {
    each(a, b, |a, b| if a >= b { u8::MAX } else { 0 })
}

/// Shifts bits, of which each byte has seven at most, up by one, and puts in whether the byte of `a` is less than
/// that of `b`.
#[inline(always)]
pub fn shift_in_less(bits: u32, a: u32, b: u32) -> u32 {
    bits << 1 | each(a, b, |a, b| u8::from(a < b))
}

/// Signs of the eight pixels around each: `rows` are those two above to two below, which begin two pixels further left than
/// `out`, whose length is a multiple of 4.
pub fn census_words(rows: [&[u8]; 5], out: &mut [u8]) {
    for (x, out) in out.as_chunks_mut::<4>().0.iter_mut().enumerate() {
        let word = |row: usize, column: usize| {
            u32::from_le_bytes(rows[row][4 * x + column..].first_chunk().map_or([0; 4], |word| *word))
        };
        let neighbours = [(0, 2), (1, 1), (1, 3), (2, 0), (2, 4), (3, 1), (3, 3), (4, 2)];
        let signs =
            neighbours.into_iter().fold(0, |bits, (row, column)| shift_in_less(bits, word(row, column), word(2, 2)));
        *out = signs.to_le_bytes();
    }
}

/// The greater one of each pair of signed halves.
#[inline(always)]
pub fn max_halves(a: u32, b: u32) -> u32 {
    both(a, b, i16::max)
}

/// The lesser one of each pair of signed halves.
#[inline(always)]
pub fn min_halves(a: u32, b: u32) -> u32 {
    both(a, b, i16::min)
}

/// The lesser one of each pair of unsigned halves.
#[inline(always)]
pub fn min_unsigned_halves(a: u32, b: u32) -> u32 {
    both(a, b, |a, b| a.cast_unsigned().min(b.cast_unsigned()).cast_signed())
}

/// All bits of each unsigned half that is not greater than that of `b`.
#[inline(always)]
pub fn at_most_halves(a: u32, b: u32) -> u32 {
    both(a, b, |a, b| if a.cast_unsigned() <= b.cast_unsigned() { -1 } else { 0 })
}

/// Horizontal Sobel responses, with `cap` added and clipped to `0..=2 * cap`, of the columns from the second on: `rows` are
/// that above, the row itself and that below, `out` has a length that is a multiple of 4.
pub fn sobel_words(rows: [&[u8]; 3], cap: u8, out: &mut [u8]) {
    let [above, row, below] = rows.map(|row| row.windows(3));
    let derivative = |triple: &[u8]| i32::from(triple[2]) - i32::from(triple[0]);
    for (((out, above), row), below) in out.iter_mut().zip(above).zip(row).zip(below) {
        let sum = derivative(above) + 2 * derivative(row) + derivative(below);
        let capped = sum.clamp(-i32::from(cap), i32::from(cap)) + i32::from(cap);
        *out = capped.to_le_bytes()[0];
    }
}

#[inline(always)]
fn each(a: u32, b: u32, op: impl Fn(u8, u8) -> u8) -> u32 {
    let (a, b) = (a.to_le_bytes(), b.to_le_bytes());
    u32::from_le_bytes([op(a[0], b[0]), op(a[1], b[1]), op(a[2], b[2]), op(a[3], b[3])])
}

#[inline(always)]
fn both(a: u32, b: u32, op: impl Fn(i16, i16) -> i16) -> u32 {
    let half = |word: u32, at: usize| {
        let bytes = word.to_le_bytes();
        i16::from_le_bytes([bytes[2 * at], bytes[2 * at + 1]])
    };
    let [low, high] = [0, 1].map(|at| u32::from(op(half(a, at), half(b, at)).cast_unsigned()));
    low | high << 16
}
