//! `haarline power count`: what every method costs and how accurate it is, for `haarline power plan`.

use std::path::PathBuf;

use anyhow::{Result, ensure};

use super::super::shared::{progress, read_scenes, scene_folders};
use super::super::{Finding, print};
use crate::output;
use crate::output::claims::Claims;
use crate::power::plan::accuracy::Accuracy;
use crate::power::plan::cost::CostModel;
use crate::power::plan::counts::{self, Count};
use crate::power::plan::{check, counting};
use crate::score::evaluation;
use crate::score::scene::Scene;
use crate::study::Chip;
use crate::twin::elf;
use crate::twin::machine::Machine;

/// Arguments of `haarline power count`.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct Args {
    /// Folder of scene folders as for haarline eval, of 320 px: accuracy is that on all of them
    #[arg(value_name = "SCENES_DIR")]
    scenes: PathBuf,
    /// The scenes that instructions are counted on
    #[arg(
        long,
        value_name = "A,B,...",
        value_delimiter = ',',
        default_value = "teddy,cones,dolls,v3q_motorcycle,v3q_playroom,eth3d_terrace_2s,kitti15_000003,kitti15_000010"
    )]
    only: Vec<String>,
    /// The program, as `cargo twin` or `cargo twin-m33` builds it [default: that of the
    /// environment variable HAARLINE_TWIN, or built by cargo if this folder is in Haarline's sources]
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Where counts.csv (counts_m33.csv of a program for an505) and accuracy.csv go, in the sources host-sim/src/power/plan
    #[arg(short, long = "output", value_name = "DIR", required_unless_present = "check")]
    output: Option<PathBuf>,
    /// Counts at sizes that are not stored instead, and ends with exit status 1 if one is more than 5 % off what haarline power
    /// plan makes of the stored ones, 6 % on random views
    #[arg(long, conflicts_with = "output")]
    check: bool,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let folders = scene_folders(&self.scenes, &self.only)?;
        let scenes = evaluation::load(&folders)?;
        let narrow = scenes.iter().find(|scene| scene.pair.width() != usize::from(counting::WIDTH));
        ensure!(
            narrow.is_none(),
            "{}: is {} px wide, where {} are needed",
            narrow.map_or("", |scene| &scene.name),
            narrow.map_or(0, |scene| scene.pair.width()),
            counting::WIDTH
        );
        let elf = self.elf.clone().map_or_else(|| elf::find(Machine::An386), Ok)?;
        let chip = Chip::read(&elf)?;
        let file = counts::file_name(chip.machine.processor());
        let mut claims = Claims::new();
        claims.read(&self.elf);
        read_scenes(&mut claims, &folders);
        let Some(output) = &self.output else { return self.check(&chip, &scenes) };
        claims.write_in("-o", output, |name| [file, "accuracy.csv"].contains(&name))?;
        let counts = self.count(&chip, &scenes, &counting::STORED)?;
        let all = evaluation::load(&scene_folders(&self.scenes, &[])?)?;
        let progress = progress(2 * counting::METHODS.len() * all.len(), "accuracy")?;
        let accuracy = Accuracy::measure(&all, || progress.inc(1));
        progress.finish_and_clear();
        output::write(&output.join(file), &counts::encode(&counts)?)?;
        output::write(&output.join("accuracy.csv"), &Accuracy::encode(&accuracy?)?)?;
        print(&format!("{} counts and the accuracy on {} scenes: {}\n", counts.len(), all.len(), output.display()))
    }

    fn count(&self, chip: &Chip, scenes: &[Scene], sizes: &[(u16, u16)]) -> Result<Vec<Count>> {
        let progress = progress(counting::jobs(scenes.len(), sizes.len()), "counts")?;
        let counts = counting::count(chip, scenes, sizes, || progress.inc(1));
        progress.finish_and_clear();
        counts
    }

    fn check(&self, chip: &Chip, scenes: &[Scene]) -> Result<()> {
        let model = CostModel::fit(&counts::stored(chip.machine.processor())?)?;
        let counted = self.count(chip, scenes, &counting::CHECKED)?;
        let errors = check::errors(&model, &counted)?;
        print(&check::text(&errors))?;
        let off = errors.iter().find(|error| error.is_too_great());
        ensure!(
            off.is_none(),
            Finding(format!(
                "the plan's instructions of {} are off by {:.1} %: count anew by haarline power count SCENES_DIR -o \
                 host-sim/src/power/plan",
                off.map_or("", |error| error.method),
                off.map_or(0.0, |error| error.worst_mean_percent)
            ))
        );
        Ok(())
    }
}
