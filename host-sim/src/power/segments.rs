//! The runs of the program `profile`: each method works for some seconds, then the chip sleeps for one.

use super::blocks::{Block, Blocks};

/// A sleep between two segments lasts at least that long, s; a shorter rest belongs to the segment.
const LEAST_SLEEP: f64 = 0.4;
/// A segment lasts at least that long, s; less is a blip in a sleep.
const LEAST_WORK: f64 = 1.0;
/// So much more power than in sleep tells work from sleep, where no pins do.
const LEAST_CONTRAST: f64 = 1.3;
/// The most segments that are told.
const MOST: usize = 10_000;

/// A stretch of work between two sleeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// When it begins, s from the first sample.
    pub begin: f64,
    /// Time in it, s.
    pub seconds: f64,
    /// Energy measured in it, J, and how long that was measured, s.
    pub joules: f64,
    /// Measured time, s: less where samples were lost.
    pub measured: f64,
}

impl Segment {
    /// Mean power, W.
    #[must_use]
    pub fn watts(&self) -> f64 {
        self.joules / self.measured
    }
}

/// The whole segments, with a sleep before and after each; none where work and sleep cannot be told apart.
#[must_use]
pub fn find(blocks: &Blocks) -> Vec<Segment> {
    let (all, length) = (blocks.all(), blocks.length());
    let Some(works) = working(all) else { return Vec::new() };
    let blocks_of = |seconds: f64| (seconds / length).ceil() as usize;
    let mut runs = runs(&works);
    join(&mut runs, true, blocks_of(0.05).min(blocks_of(LEAST_WORK)));
    join(&mut runs, false, blocks_of(LEAST_SLEEP));
    join(&mut runs, true, blocks_of(LEAST_WORK));
    let mut found = Vec::new();
    let mut begin = 0;
    for (index, &(is_work, count)) in runs.iter().enumerate() {
        if is_work && index > 0 && index + 1 < runs.len() && found.len() < MOST {
            found.push(segment(&all[begin..begin + count], begin as f64 * length, length));
        }
        begin += count;
    }
    found.retain(|segment| segment.measured > 0.0);
    found
}

fn segment(blocks: &[Block], begin: f64, length: f64) -> Segment {
    let joules = blocks.iter().map(|block| block.joules).sum();
    let measured = blocks.iter().map(|block| f64::from(block.seconds)).sum();
    Segment { begin, seconds: blocks.len() as f64 * length, joules, measured }
}

/// Whether the program works in each block: as the pins tell, else by its power.
fn working(blocks: &[Block]) -> Option<Vec<bool>> {
    let sum = |of: fn(&Block) -> f32| blocks.iter().map(|block| f64::from(of(block))).sum::<f64>();
    let (measured, told) = (sum(|block| block.seconds), sum(|block| block.told));
    let by_pins = told > 0.5 * measured;
    let threshold = if by_pins { 0.0 } else { threshold(blocks)? };
    let mut last = false;
    let works = blocks.iter().map(|block| {
        let now = match by_pins {
            true if block.told > 0.0 => Some(block.idle < 0.5 * block.told),
            true => None,
            false => block.watts().map(|watts| watts > threshold),
        };
        // What was not measured goes on as it was.
        last = now.unwrap_or(last);
        last
    });
    Some(works.collect())
}

/// The power between sleep and work, W: in the middle of the two means that it separates.
fn threshold(blocks: &[Block]) -> Option<f64> {
    let watts: Vec<f64> = blocks.iter().filter_map(Block::watts).collect();
    let least = watts.iter().copied().fold(f64::INFINITY, f64::min);
    let most = watts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mean = |is_in: &dyn Fn(f64) -> bool| {
        let (sum, count) =
            watts.iter().filter(|&&w| is_in(w)).fold((0.0, 0.0), |(sum, count), w| (sum + w, count + 1.0));
        (count > 0.0).then(|| sum / count)
    };
    let mut threshold = (least + most) / 2.0;
    for _ in 0..50 {
        let (low, high) = (mean(&|w| w <= threshold)?, mean(&|w| w > threshold)?);
        let middle = (low + high) / 2.0;
        if (middle - threshold).abs() <= 1e-9 * middle.abs() {
            return (high > LEAST_CONTRAST * low.max(0.0)).then_some(threshold);
        }
        threshold = middle;
    }
    None
}

/// Stretches of equal values, with their lengths.
fn runs(works: &[bool]) -> Vec<(bool, usize)> {
    works.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect()
}

/// Joins runs of that kind that are shorter than `least` with their neighbours.
fn join(runs: &mut Vec<(bool, usize)>, kind: bool, least: usize) {
    let mut joined: Vec<(bool, usize)> = Vec::with_capacity(runs.len());
    for &(is_work, count) in runs.iter() {
        let is_work = if is_work == kind && count < least { !kind } else { is_work };
        match joined.last_mut() {
            Some(last) if last.0 == is_work => last.1 += count,
            _ => joined.push((is_work, count)),
        }
    }
    *runs = joined;
}

#[cfg(test)]
mod tests {
    use super::super::current_file::Sample;
    use super::super::phase::Phase;
    use super::*;

    /// Blocks of stretches of so many ms at that power, mW; with pins, 10 mW and less are idle.
    fn blocks(stretches: &[(usize, f64)], has_pins: bool) -> Blocks {
        let mut blocks = Blocks::new(0.0, 1e-4);
        let mut at = 0.0;
        for &(milliseconds, milliwatts) in stretches {
            let told = if milliwatts <= 10.0 { Phase::Idle } else { Phase::Compute };
            for _ in 0..milliseconds * 10 {
                let sample = Sample { seconds: at, watts: milliwatts / 1000.0, phase: has_pins.then_some(told) };
                blocks.add(&sample, at + 1e-9, 1e-4);
                at += 1e-4;
            }
        }
        blocks
    }

    #[test]
    fn whole_segments_are_found_with_and_without_pins() {
        let stretches = [
            (500, 80.0),
            (1000, 8.0),
            (3000, 80.0),
            (1000, 8.0),
            (1500, 60.0),
            (100, 8.0),
            (1400, 60.0),
            (1000, 8.0),
            (40, 90.0),
            (200, 8.0),
        ];
        for has_pins in [true, false] {
            let found = find(&blocks(&stretches, has_pins));
            let told: Vec<[f64; 2]> = found.iter().map(|segment| [segment.begin, segment.seconds]).collect();
            assert_eq!(found.len(), 2, "{told:?}");
            for (segment, [begin, seconds, watts]) in
                found.iter().zip([[1.5, 3.0, 0.08], [5.5, 3.0, (2.9 * 60.0 + 0.8) / 3e3]])
            {
                assert!((segment.begin - begin).abs() < 0.003 && (segment.seconds - seconds).abs() < 0.005, "{told:?}");
                assert!((segment.watts() / watts - 1.0).abs() < 0.005, "{} W, {watts} W", segment.watts());
            }
        }
    }

    #[test]
    fn a_steady_current_has_no_segments() {
        assert!(find(&blocks(&[(4000, 50.0)], false)).is_empty());
        assert!(find(&blocks(&[(2000, 50.0), (2000, 55.0), (2000, 50.0)], false)).is_empty());
        assert!(find(&Blocks::new(0.0, 1.0)).is_empty());
    }
}
