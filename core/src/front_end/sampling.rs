//! Which pixels are looked at for noise and exposure.

/// Of a row: more in a frame's first rows, so that the level is right soon.
pub(crate) struct Sampling {
    pub(crate) first: usize,
    pub(crate) stride: usize,
    pub(crate) weight: u16,
}

impl Sampling {
    pub(crate) fn of(row: u32) -> Option<Self> {
        let first = (row as usize * 5) % 32;
        match row {
            0..16 => Some(Self { first: first % 8, stride: 8, weight: 2 }),
            16..48 if row.is_multiple_of(2) => Some(Self { first: first % 8, stride: 8, weight: 4 }),
            48.. if row.is_multiple_of(4) => Some(Self { first, stride: 32, weight: 64 }),
            _ => None,
        }
    }
}
