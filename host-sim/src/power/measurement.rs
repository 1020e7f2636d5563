//! A recording of a current added up.

use std::io::Read;

use anyhow::{Result, bail, ensure};
use serde::Serialize;

use super::blocks::Blocks;
use super::current_file::{CurrentFile, Kind, Sample, Setup};
use super::phase::Phase;

/// Samples that the period is found from.
const FIRST: usize = 4096;
/// So many lost samples are shared by their neighbours; more are lost time.
const MOST_SHARED: f64 = 20.0;
/// A waveform's points that lie farther apart are means over more than a phase of the program, s.
const COARSEST_WAVEFORM: f64 = 2e-3;

/// Energy and the time that it was measured for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Tally {
    /// Energy, J.
    pub joules: f64,
    /// Time, s.
    pub seconds: f64,
    /// The greatest power of a sample, W.
    pub peak_watts: f64,
}

impl Tally {
    fn add(&mut self, watts: f64, seconds: f64) {
        self.joules += watts * seconds;
        self.seconds += seconds;
        self.peak_watts = self.peak_watts.max(watts);
    }

    /// Mean power, W, if anything was measured.
    #[must_use]
    pub fn watts(&self) -> Option<f64> {
        (self.seconds > 0.0).then(|| self.joules / self.seconds)
    }
}

/// What a recording tells.
#[derive(Debug, Clone)]
pub struct Measurement {
    /// Who wrote it.
    pub kind: Kind,
    /// Samples.
    pub samples: u64,
    /// Time from sample to sample, s: the median of the first ones.
    pub period: f64,
    /// Lost samples that their neighbours share.
    pub shared: f64,
    /// Longer stretches without samples, and how long they are, s.
    pub gaps: u64,
    /// The same.
    pub lost_seconds: f64,
    /// Whether the last row was cut off.
    pub is_cut: bool,
    /// Whether the file has the phase pins.
    pub has_phases: bool,
    /// All.
    pub total: Tally,
    /// By phase, in the order of [`Phase::ALL`].
    pub phases: [Tally; Phase::ALL.len()],
    /// Where the pins tell no phase.
    pub untold: Tally,
    /// In short blocks.
    pub blocks: Blocks,
}

impl Measurement {
    /// Reads a whole recording; a few megabytes of it are in memory, however long it is.
    ///
    /// # Errors
    /// If it is no such file, a row cannot be read, the time goes back, or its points are means over too long a time.
    pub fn read(from: impl Read, setup: &Setup) -> Result<Self> {
        let mut file = CurrentFile::open(from, setup)?;
        let mut first = Vec::new();
        while first.len() < FIRST
            && let Some(sample) = file.read()?
        {
            first.push(sample);
        }
        ensure!(first.len() > 1, "has {} whole rows, where at least two are needed", first.len());
        let period = period(&first)?;
        let is_coarse = file.kind() == Kind::Waveform && period > COARSEST_WAVEFORM;
        ensure!(
            !is_coarse,
            "its points lie {:.1} ms apart, each the mean of many samples: zoom in until they are {} ms or less, or log \
             statistics",
            1e3 * period,
            1e3 * COARSEST_WAVEFORM
        );
        let mut measured = Self {
            kind: file.kind(),
            samples: 1,
            period,
            shared: 0.0,
            gaps: 0,
            lost_seconds: 0.0,
            is_cut: false,
            has_phases: file.has_phases(),
            total: Tally::default(),
            phases: Default::default(),
            untold: Tally::default(),
            blocks: Blocks::new(first[0].seconds, period),
        };
        let mut last = first[0];
        for next in first.drain(1..) {
            measured.step(&last, &next)?;
            last = next;
        }
        while let Some(next) = file.read()? {
            measured.step(&last, &next)?;
            last = next;
        }
        measured.add(&last, last.seconds, period);
        measured.is_cut = file.is_cut();
        Ok(measured)
    }

    /// What `sample` holds until `next` comes.
    fn step(&mut self, sample: &Sample, next: &Sample) -> Result<()> {
        let step = next.seconds - sample.seconds;
        ensure!(step > 0.0, "after {} s the time goes back to {} s", sample.seconds, next.seconds);
        self.samples += 1;
        if step < 1.5 * self.period {
            self.add(sample, sample.seconds, step);
            return Ok(());
        }
        let missing = (step / self.period).round() - 1.0;
        if missing <= MOST_SHARED {
            self.shared += missing;
            self.add(sample, sample.seconds, step / 2.0);
            self.add(next, sample.seconds + step / 2.0, step / 2.0);
        } else {
            self.gaps += 1;
            self.lost_seconds += step - self.period;
            self.add(sample, sample.seconds, self.period);
        }
        Ok(())
    }

    fn add(&mut self, sample: &Sample, at: f64, seconds: f64) {
        self.total.add(sample.watts, seconds);
        let tally = sample.phase.map_or(&mut self.untold, |phase| &mut self.phases[phase as usize]);
        tally.add(sample.watts, seconds);
        self.blocks.add(sample, at, seconds);
    }

    /// The tally of a phase.
    #[must_use]
    pub fn phase(&self, phase: Phase) -> &Tally {
        &self.phases[phase as usize]
    }
}

/// The usual time from sample to sample.
fn period(samples: &[Sample]) -> Result<f64> {
    let mut steps: Vec<f64> = samples.windows(2).map(|pair| pair[1].seconds - pair[0].seconds).collect();
    steps.sort_by(f64::total_cmp);
    match steps[steps.len() / 2] {
        period if period > 0.0 => Ok(period),
        _ => bail!("its times do not go on: most of the first rows have the time of the row before"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETUP: Setup = Setup { volts: Some(2.0), rate: None, pins: [0, 1] };

    fn read(csv: &str) -> Result<Measurement> {
        Measurement::read(csv.as_bytes(), &SETUP)
    }

    #[test]
    fn lost_samples_are_shared_or_lost_time() {
        let mut csv = String::from("Timestamp(ms),Current(uA),D0-D7\n");
        let mut row = |milliseconds: u32, levels: &str| csv += &format!("{milliseconds},500000,{levels}\n");
        (0..10).for_each(|at| row(at, "00000000"));
        (14..20).for_each(|at| row(at, "11000000"));
        (60..70).for_each(|at| row(at, "XX------"));
        let found = read(&csv).unwrap();
        assert_eq!((found.samples, found.shared, found.gaps), (26, 4.0, 1));
        let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-9, "{found}, {wanted}");
        near(found.lost_seconds, 0.040);
        near(found.phase(Phase::Idle).seconds, 0.0115);
        near(found.phase(Phase::Compute).joules, 0.0085);
        near(found.untold.seconds, 0.010);
        near(found.total.watts().unwrap(), 1.0);
    }

    #[test]
    fn times_that_do_not_go_on_are_refused() {
        let table = |times: &[&str]| {
            let rows: String = times.iter().map(|time| format!("{time},1\n")).collect();
            read(&format!("Timestamp(ms),Current(uA)\n{rows}")).unwrap_err().to_string()
        };
        assert!(table(&["0", "1", "2", "1"]).contains("goes back"));
        assert!(table(&["5", "5", "5"]).contains("do not go on"));
        assert!(table(&["5"]).contains("1 whole rows"));
    }
}
