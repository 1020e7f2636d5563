//! The median of 3 x 3 disparities.

/// The median around each pixel of the middle row. The row's ends stand for what is beyond them.
pub(super) fn median(rows: [&[i16]; 3], out: &mut [i16]) {
    let last = out.len() - 1;
    for (x, out) in out.iter_mut().enumerate() {
        let columns = [x.saturating_sub(1), x, (x + 1).min(last)];
        let mut nine = [0; 9];
        for (three, row) in nine.chunks_mut(3).zip(rows) {
            three.copy_from_slice(&columns.map(|x| row[x]));
        }
        nine.sort_unstable();
        *out = nine[4];
    }
}
