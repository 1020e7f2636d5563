//! `haarline study`: the paper's experiments, repeated and measured.

use std::path::PathBuf;
use std::sync::LazyLock;

use anyhow::Result;
use clap::ValueEnum;
use clap::builder::PossibleValue;

use super::shared::{progress, quoted, read_scenes, scene_folders};
use super::{natural_number, print};
use crate::output::claims::Claims;
use crate::score::scene::Scene;
use crate::study::page::{Origin, page};
use crate::study::{Chip, Outcome, Part, STUDIES, Setup, Study, Table, rendered};
use crate::{output, score::evaluation, score::report};

/// Columns of a paragraph on the terminal.
const LINE: usize = 100;

/// Arguments of `haarline study`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Which experiment
    #[arg(value_name = "NAME", value_enum)]
    name: Choice,
    /// Where tables (CSV), plots (SVG) and the page (HTML) go; files of the same names are replaced
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
    /// Seed of everything random
    #[arg(long, value_name = "S", default_value_t = 0, allow_hyphen_values = true, value_parser = natural_number)]
    seed: u64,
    /// Folder of scene folders as for haarline eval, for the studies on frames [default: rendered scenes]
    #[arg(long, value_name = "SCENES_DIR")]
    scenes: Option<PathBuf>,
    /// Counts the instructions of Table 1 on the emulated Cortex-M4F: the program, as `cargo twin` builds it in
    /// target/thumbv7em-none-eabihf/firmware/twin
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Only these of them
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', requires = "scenes")]
    only: Vec<String>,
}

/// A study, or all of them.
#[derive(Debug, Clone, Copy)]
enum Choice {
    One(&'static Study),
    All,
}

impl ValueEnum for Choice {
    fn value_variants<'a>() -> &'a [Self] {
        static CHOICES: LazyLock<Vec<Choice>> =
            LazyLock::new(|| STUDIES.iter().map(Choice::One).chain([Choice::All]).collect());
        &CHOICES
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self {
            Self::One(study) => PossibleValue::new(study.name).help(study.about),
            Self::All => PossibleValue::new("all").help("All of them, and one page index.html"),
        })
    }
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let folders = self.scenes.as_deref().map(|scenes| scene_folders(scenes, &self.only)).transpose()?;
        let scenes = match &folders {
            Some(folders) => evaluation::load(folders)?,
            None => rendered::scenes(self.seed),
        };
        let chip = self.elf.as_deref().map(Chip::read).transpose()?;
        let mut claims = Claims::new();
        claims.read(&self.elf);
        read_scenes(&mut claims, folders.as_deref().unwrap_or_default());
        let is_ours = |name: &str| [".csv", ".svg", ".html"].iter().any(|end| name.ends_with(end));
        claims.write_in("-o", &self.output, is_ours)?;
        let scenes_name = self.describe_scenes(scenes.len());
        let studies = match self.name {
            Choice::One(study) => vec![study],
            Choice::All => STUDIES.iter().collect(),
        };
        let found = studies.into_iter().map(|study| self.study(study, &scenes, &scenes_name, chip.as_ref()));
        let outcomes = found.collect::<Result<Vec<Outcome>>>()?;
        self.write_page(&outcomes, &scenes_name)
    }

    fn describe_scenes(&self, count: usize) -> String {
        self.scenes.as_ref().map_or_else(|| rendered::NAME.to_owned(), |folder| report::scenes_of(count, folder))
    }

    /// Does one study, prints what it found and writes its tables and plots.
    fn study(&self, study: &Study, scenes: &[Scene], scenes_name: &str, chip: Option<&Chip>) -> Result<Outcome> {
        let progress = progress(0, study.name)?;
        let outcome = (study.run)(&Setup { seed: self.seed, scenes, scenes_name, chip, progress: &progress });
        progress.finish_and_clear();
        let outcome = outcome?;
        print(&match self.name {
            Choice::One(_) => text(&outcome),
            Choice::All => line(&outcome),
        })?;
        for part in &outcome.parts {
            match part {
                Part::Text(_) => {}
                Part::Table(table) => {
                    self.write(&format!("{}_{}.csv", study.name, table.name), &table.encode_csv()?)?
                }
                Part::Plot(plot) => self.write(&format!("{}_{}.svg", study.name, plot.name), plot.svg.as_bytes())?,
            }
        }
        Ok(outcome)
    }

    fn write_page(&self, outcomes: &[Outcome], scenes: &str) -> Result<()> {
        let (name, title) = match (self.name, outcomes) {
            (Choice::One(study), [outcome]) => (format!("{}.html", study.name), outcome.title.as_str()),
            _ => ("index.html".to_owned(), "Haarline: the paper's studies"),
        };
        let origin = Origin { command: &self.command_line(), seed: self.seed, scenes };
        self.write(&name, page(title, &origin, outcomes).as_bytes())?;
        let hint = match self.name {
            Choice::One(_) => "",
            Choice::All => "; haarline study NAME -o DIR prints the tables of one, too",
        };
        print(&format!("page: {}{hint}\n", self.output.join(name).display()))
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<()> {
        output::write(&self.output.join(name), bytes)
    }

    /// The command that makes the same page; where it goes is no part of it.
    fn command_line(&self) -> String {
        let name = match self.name {
            Choice::One(study) => study.name,
            Choice::All => "all",
        };
        let mut line = format!("haarline study {name} -o DIR --seed {}", self.seed);
        if let Some(scenes) = &self.scenes {
            line += &format!(" --scenes {}", quoted(&scenes.display().to_string()));
        }
        if let Some(elf) = &self.elf {
            line += &format!(" --elf {}", quoted(&elf.display().to_string()));
        }
        if !self.only.is_empty() {
            line += &format!(" --only {}", quoted(&self.only.join(",")));
        }
        line
    }
}

/// That a study was done, where the page tells what all of them found.
fn line(outcome: &Outcome) -> String {
    let count = |is_one: fn(&Part) -> bool| outcome.parts.iter().filter(|part| is_one(part)).count();
    let tables = count(|part| matches!(part, Part::Table(_)));
    let plots = count(|part| matches!(part, Part::Plot(_)));
    format!("{:<10} {}: tables {tables}, plots {plots}\n", outcome.name, outcome.title)
}

/// What a study found, to read on a terminal.
fn text(outcome: &Outcome) -> String {
    let mut text = format!("{}\n{}\n\n", outcome.title, "=".repeat(outcome.title.chars().count()));
    for part in &outcome.parts {
        match part {
            Part::Text(words) => text += &format!("{}\n\n", wrap(words)),
            Part::Table(table) => text += &format!("{}\n\n{}\n\n", wrap(&table.caption), printed(table)),
            Part::Plot(plot) => text += &format!("[{}_{}.svg] {}\n\n", outcome.name, plot.name, plot.caption),
        }
    }
    text
}

fn printed(table: &Table) -> String {
    let mut printed = report::table(table.columns.clone(), table.word_columns());
    printed.add_rows(table.rows.clone());
    printed.trim_fmt()
}

/// Breaks a paragraph into lines.
fn wrap(words: &str) -> String {
    let mut lines = vec![String::new()];
    for word in words.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= LINE => *line += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_paragraph_is_broken_between_words() {
        let words = "word ".repeat(50);
        let lines = wrap(&words);
        assert!(lines.lines().all(|line| line.len() <= LINE), "{lines}");
        assert_eq!(lines.split_whitespace().count(), 50);
    }
}
