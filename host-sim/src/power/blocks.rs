//! A recording in short blocks: what is plotted, and in what segments are found.

use super::current_file::Sample;
use super::phase::Phase;

/// Length of a block at first, s.
const SHORTEST: f64 = 1e-3;
/// The most blocks: where more come, two become one.
const MOST: usize = 1 << 20;

/// What was added up in a block.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Block {
    /// Energy, J.
    pub joules: f64,
    /// Measured time, s.
    pub seconds: f32,
    /// Time in which the phase was known, s.
    pub told: f32,
    /// Of that, idle, s.
    pub idle: f32,
}

impl Block {
    fn add(&mut self, other: &Self) {
        self.joules += other.joules;
        self.seconds += other.seconds;
        self.told += other.told;
        self.idle += other.idle;
    }

    /// Mean power, W, if anything was measured.
    #[must_use]
    pub fn watts(&self) -> Option<f64> {
        (self.seconds > 0.0).then(|| self.joules / f64::from(self.seconds))
    }
}

/// Blocks of one length, from the first sample on.
#[derive(Debug, Clone)]
pub struct Blocks {
    blocks: Vec<Block>,
    length: f64,
    /// Blocks a second.
    rate: f64,
    begin: f64,
}

impl Blocks {
    /// None yet; the first sample comes at `begin`, s, and one after the other in `period` s.
    #[must_use]
    pub fn new(begin: f64, period: f64) -> Self {
        let length = SHORTEST.max(4.0 * period);
        Self { blocks: Vec::new(), length, rate: 1.0 / length, begin }
    }

    /// Adds what a sample holds for `seconds`, shorter than a block, from `at` on.
    pub fn add(&mut self, sample: &Sample, at: f64, seconds: f64) {
        let mut index = ((at - self.begin) * self.rate) as usize;
        while index >= MOST {
            self.halve();
            index /= 2;
        }
        if index >= self.blocks.len() {
            self.blocks.resize(index + 1, Block::default());
        }
        let length = seconds as f32;
        let told = if sample.phase.is_some() { length } else { 0.0 };
        let idle = if sample.phase == Some(Phase::Idle) { length } else { 0.0 };
        self.blocks[index].add(&Block { joules: sample.watts * seconds, seconds: length, told, idle });
    }

    fn halve(&mut self) {
        self.length *= 2.0;
        self.rate /= 2.0;
        let both = self.blocks.chunks(2).map(|pair| {
            let mut sum = pair[0];
            pair[1..].iter().for_each(|block| sum.add(block));
            sum
        });
        self.blocks = both.collect();
    }

    /// All, in order.
    #[must_use]
    pub fn all(&self) -> &[Block] {
        &self.blocks
    }

    /// Length of a block, s.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The same in at most `count` parts: when each begins, s from the first sample; least, mean and greatest power of the
    /// blocks in it, W.
    #[must_use]
    pub fn parts(&self, count: usize) -> Vec<(f64, [f64; 3])> {
        let size = self.blocks.len().div_ceil(count.max(1)).max(1);
        let parts = self.blocks.chunks(size).enumerate();
        let part = |(index, blocks): (usize, &[Block])| {
            let mut sum = Block::default();
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for block in blocks {
                sum.add(block);
                let watts = block.watts()?;
                (least, most) = (least.min(watts), most.max(watts));
            }
            Some(((index * size) as f64 * self.length, [least, sum.watts()?, most]))
        };
        parts.filter_map(part).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn however_long_the_energy_stays_and_the_blocks_are_bounded() {
        let sample = Sample { seconds: 0.0, watts: 0.25, phase: Some(Phase::Idle) };
        let mut blocks = Blocks::new(100.0, 0.5);
        assert_eq!(blocks.length(), 2.0);
        let count = 10 * MOST;
        (0..count).for_each(|index| blocks.add(&sample, 100.0 + 0.5 * index as f64, 0.5));
        assert!(blocks.all().len() <= MOST);
        let joules: f64 = blocks.all().iter().map(|block| block.joules).sum();
        assert!((joules / (0.125 * count as f64) - 1.0).abs() < 1e-9);
        let parts = blocks.parts(10);
        assert!(parts.len() <= 10 && parts.iter().all(|(_, watts)| (watts[1] - 0.25).abs() < 1e-6), "{parts:?}");
    }
}
