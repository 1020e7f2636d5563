//! The labels that are tried of a tile, and what each differs by: a list whose labels are checked as they come.
#![cfg_attr(
    any(haarline_dsp, haarline_sse2),
    expect(unsafe_code, reason = "windows at any byte, whose labels are checked as they come")
)]
#![allow(clippy::cast_possible_truncation, reason = "tiles are below 4096, places below 16")]

#[cfg(not(haarline_sse2))]
use crate::lanes::windows::tile_sad;
#[cfg(haarline_sse2)]
use crate::lanes::x86_64::tile::TileQuads;
use crate::lanes::{choose, demand};

/// Most disparities that a tile tries: six hypotheses, and the steps of the extremum search. A power of two, so that a
/// mask keeps places within it.
const MOST: usize = 16;
/// Places of labels: a power of two, so that a mask keeps within it whatever stands for no label.
const PLACES: usize = 512;

/// A label that is tried.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct Trial {
    /// Sum of absolute differences of the whole tile, place in the list, label: 20, 4 and 8 bits.
    pub(crate) key: u32,
    /// Sums of the four cells, two in a word: the upper and the lower ones.
    pub(crate) cells: [u32; 2],
    /// Records of four words are found by a shift.
    _unused: u32,
}

impl Trial {
    /// The label of a trial.
    #[inline(always)]
    pub(crate) const fn label_of(key: u32) -> u32 {
        key & 0xff
    }

    /// The sum of a trial over the whole tile.
    #[inline(always)]
    pub(crate) const fn sum_of(key: u32) -> u32 {
        key >> 12
    }
}

/// What was tried of a tile, in this order.
pub(crate) struct Trials<const BLOCKS: usize> {
    list: [Trial; MOST],
    len: usize,
    tile: usize,
    /// The byte of the right row that label 0 begins at.
    origin: usize,
    /// The labels that may be tried begin with this one, and how far they go.
    lowest: u32,
    span: u32,
    /// For each label the tile that tried it last, and its place in the list: 12 and 4 bits. The last one stands for no label.
    places: [u16; PLACES],
}

impl<const BLOCKS: usize> Trials<BLOCKS> {
    /// Of the tiles of a row.
    pub(crate) const fn new() -> Self {
        let nothing = Trial { key: 0, cells: [0; 2], _unused: 0 };
        Self { list: [nothing; MOST], len: 0, tile: 0, origin: 0, lowest: 0, span: 0, places: [u16::MAX; PLACES] }
    }

    /// Begins with a tile, each with one further right than the last: of `lowest..=highest` nothing was tried.
    ///
    /// # Panics
    /// If a window of these labels, eight columns that begin so many bytes before `origin`, is not within the row.
    #[inline(always)]
    pub(crate) fn start(&mut self, tile: usize, origin: usize, lowest: u32, highest: u32) {
        let (least, most) = (lowest as usize, highest as usize);
        demand(
            least <= most && most < 256 && most <= origin && origin - least + 8 <= 4 * BLOCKS && 2 * tile + 3 <= BLOCKS,
        );
        (self.len, self.tile, self.origin) = (0, tile, origin);
        (self.lowest, self.span) = (lowest, highest - lowest);
        // No label counts as tried.
        self.places[PLACES - 1] = (tile << 4) as u16;
    }

    /// How many were tried.
    #[inline(always)]
    pub(crate) const fn len(&self) -> usize {
        self.len
    }

    /// Puts a label on the list, if it may be tried and is not there; whatever is over 255 is no label.
    #[inline(always)]
    pub(crate) fn add(&mut self, label: u32) {
        if cfg!(haarline_dsp) {
            if self.place(label).is_none() && self.may_be_tried(label) {
                self.put(label);
            }
        } else {
            self.put_if_new(label);
        }
    }

    /// The same without a branch: a label that is not new is put behind the list, which is never full.
    #[inline(always)]
    fn put_if_new(&mut self, label: u32) {
        let is_new = self.place(label).is_none() & self.may_be_tried(label);
        let place = self.len % MOST;
        let tried = &mut self.places[label as usize % PLACES];
        *tried = choose(is_new, (self.tile << 4 | place) as u16, *tried);
        self.list[place].key = (place << 8) as u32 | label;
        self.len = place + usize::from(is_new);
    }

    #[inline(always)]
    const fn may_be_tried(&self, label: u32) -> bool {
        label.wrapping_sub(self.lowest) <= self.span
    }

    /// The place of a label that may be tried; now on the list if it was not.
    #[inline(always)]
    pub(crate) fn place_of(&mut self, label: u32) -> usize {
        match self.place(label) {
            Some(place) => place,
            None if self.may_be_tried(label) => self.put(label),
            None => 0,
        }
    }

    /// The place of a label, if it is on the list.
    #[inline(always)]
    fn place(&self, label: u32) -> Option<usize> {
        let place = usize::from(self.places[label as usize % PLACES]);
        (place >> 4 == self.tile).then_some(place % MOST)
    }

    #[inline(always)]
    fn put(&mut self, label: u32) -> usize {
        let place = self.len % MOST;
        self.places[label as usize % PLACES] = (self.tile << 4 | place) as u16;
        self.list[place].key = (place << 8) as u32 | label;
        self.len = place + 1;
        place
    }

    /// The trial at a place.
    #[inline(always)]
    pub(crate) fn at(&self, place: usize) -> &Trial {
        &self.list[place % MOST]
    }

    /// The trial that a key is of.
    #[inline(always)]
    pub(crate) fn of(&self, key: u32) -> &Trial {
        self.at((key >> 8) as usize)
    }

    /// All of them.
    #[inline(always)]
    pub(crate) fn list(&self) -> &[Trial] {
        &self.list[..self.len.min(MOST)]
    }

    /// Tries the labels of the list from a place on.
    #[inline(always)]
    pub(crate) fn evaluate(&mut self, from: usize, left: &[[u32; BLOCKS]; 4], right: &[[u32; BLOCKS]; 4]) {
        let len = self.len.min(MOST);
        if from >= len {
            return;
        }
        crate::count::evaluations(len - from);
        let first = 2 * self.tile + 1;
        #[cfg(haarline_dsp)]
        if BLOCKS <= super::MOST_TILE_SAD_WORDS {
            // SAFETY: `start` and `add` see to it that the windows of all labels on the list lie within the rows, which lie one
            // behind the other.
            unsafe {
                let left = left.as_ptr().cast::<u32>().add(first);
                let origin = right.as_ptr().cast::<u8>().add(self.origin);
                super::try_labels::<BLOCKS>(left, origin, &mut self.list[from..len]);
            }
            return;
        }
        #[cfg(haarline_sse2)]
        {
            // SAFETY: `start` and `add` see to it that the windows of all labels on the list lie within the rows.
            let tile = unsafe { TileQuads::load(left, 4 * first) };
            for trial in &mut self.list[from..len] {
                let byte = self.origin.wrapping_sub(Trial::label_of(trial.key) as usize);
                // SAFETY: as before.
                trial.cells = tile.sad(unsafe { TileQuads::load(right, byte) });
                let both = trial.cells[0] + trial.cells[1];
                trial.key |= ((both & 0xffff) + (both >> 16)) << 12;
            }
        }
        #[cfg(not(haarline_sse2))]
        for trial in &mut self.list[from..len] {
            let [a, b, c, d] =
                tile_sad(left, first, right, self.origin.wrapping_sub(Trial::label_of(trial.key) as usize));
            trial.cells = [a | b << 16, c | d << 16];
            trial.key |= (a + b + c + d) << 12;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCKS: usize = 40;

    #[test]
    fn each_label_is_tried_once() {
        let mut seed = 1_u32;
        let mut next = || crate::random::next(&mut seed);
        let [left, right] = [0; 2].map(|_: u32| [0; 4].map(|_: u32| [0; BLOCKS].map(|_: u32| next())));
        let mut trials = Trials::<BLOCKS>::new();
        for tile in 0..18 {
            let (origin, lowest, highest) = (8 * tile + 4, next() % 3, 3 + next() % 2);
            trials.start(tile, origin, lowest, highest);
            let mut wanted = [0; 9];
            let mut len = 0;
            for i in 0..7 {
                // The great ones stand for no label.
                let label = if i == 6 {
                    lowest
                } else {
                    [0, 1, 2, 3, 4, 5, u32::MAX, u32::MAX / 2, 0xffff][next() as usize % 9]
                };
                trials.add(label);
                if (lowest..=highest).contains(&label) && !wanted[..len].contains(&label) {
                    wanted[len] = label;
                    len += 1;
                }
                assert_eq!(trials.len(), len);
            }
            trials.evaluate(0, &left, &right);
            for (place, &label) in wanted[..len].iter().enumerate() {
                assert_eq!(trials.place_of(label), place);
                let trial = trials.at(place);
                let [a, b, c, d] =
                    crate::lanes::windows::tile_sad(&left, 2 * tile + 1, &right, origin - label as usize);
                assert_eq!((Trial::label_of(trial.key), Trial::sum_of(trial.key)), (label, a + b + c + d));
                assert_eq!(trial.cells, [a | b << 16, c | d << 16]);
                assert_eq!(trials.of(trial.key).key, trial.key);
            }
        }
    }
}
