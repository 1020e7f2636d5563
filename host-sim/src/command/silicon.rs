//! `haarline silicon`: the methods on a bare board, without cameras.

use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, SystemTime};

use anyhow::{Context, Result, ensure};
use haarline_link::message::{Method, WIDTH};

use super::shared::progress;
use super::{Finding, print};
use crate::output::claims::Claims;
use crate::score::scene::find_scenes;
use crate::silicon::client::Client;
use crate::silicon::run::{Board, kind, run};
use crate::silicon::table::{HEAD, Line};
use crate::silicon::{instructions, port};
use crate::stereo::method::MethodKind;
use crate::{StereoPair, output};

/// Arguments of `haarline silicon`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// A folder of scenes, each a folder with left.png and right.png of 320 px width or less
    scenes: PathBuf,
    /// The board's serial port, on Linux mostly /dev/ttyACM0; or HOST:PORT of an emulated chip
    #[arg(long, value_name = "PORT")]
    port: String,
    /// The port's speed
    #[arg(long, value_name = "BAUD", default_value_t = 921_600)]
    baud: u32,
    /// Flashes this program first, by probe-rs: the ELF file of `bench`
    #[arg(long, value_name = "FILE")]
    flash: Option<PathBuf>,
    /// Methods to run; the state of sgm lies in the board's slower memory
    #[arg(long, value_enum, value_name = "A,B,...", value_delimiter = ',', default_values_t = [MethodKind::Full, MethodKind::Lite, MethodKind::WaveletBlock, MethodKind::Block, MethodKind::Sgm])]
    methods: Vec<MethodKind>,
    /// Only these scenes, by the names of their folders
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    only: Vec<String>,
    /// Counts the instructions of the same pairs in QEMU by this program, the ELF file of `twin`
    #[arg(long, value_name = "FILE")]
    twin: Option<PathBuf>,
    /// Where the table goes, Markdown: a row for each method
    #[arg(short, long = "output", value_name = "FILE")]
    output: Option<PathBuf>,
    /// Asks again after so long without an answer, ms
    #[arg(long, value_name = "MS", default_value_t = 400)]
    again: u64,
    /// Gives up after so long without a sign of the board, s
    #[arg(long, value_name = "S", default_value_t = 30)]
    patience: u64,
}

impl Args {
    pub(super) fn run(self) -> Result<()> {
        let methods = self.methods()?;
        let scenes = self.scenes()?;
        if let Some(path) = &self.output {
            let mut claims = Claims::new();
            let files = scenes.iter().flat_map(|(folder, _)| ["left.png", "right.png"].map(|view| folder.join(view)));
            claims.read(files.collect::<Vec<_>>());
            claims.write("-o", path)?;
        }
        if let Some(elf) = &self.flash {
            flash(elf)?;
        }
        let port = port::open(&self.port, self.baud)?;
        let sequence = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |time| time.subsec_nanos());
        let (again, patience) = (Duration::from_millis(self.again), Duration::from_secs(self.patience));
        let mut client = Client::new(port, (sequence >> 8) as u16, again, patience);
        let board = Board::find(&mut client).with_context(|| format!("--port {}", self.port))?;
        print(&format!(
            "{} revision {} at {} MHz, program by {}\n",
            board.chip, board.revision, board.mhz, board.compiler
        ))?;
        let mut table = HEAD.to_owned();
        let mut wrong = Vec::new();
        for method in methods {
            let line = self.line(&mut client, method, &scenes)?;
            print(&format!("{}: cycles a pixel: {}\n", line.method, line.stages()))?;
            for ((folder, _), outcome) in scenes.iter().zip(&line.outcomes) {
                if let Some(row) = outcome.different {
                    wrong.push(format!("{} of {}: row {row}", line.method, folder.display()));
                }
            }
            table += &line.markdown(&board);
        }
        print(&format!("\n{table}\nasked again {} times\n", client.repeats))?;
        if let Some(path) = &self.output {
            output::write(path, table.as_bytes())?;
        }
        ensure!(wrong.is_empty(), Finding(format!("not the host's rows: {}", wrong.join("; "))));
        Ok(())
    }

    fn methods(&self) -> Result<Vec<Method>> {
        let on_board = |kind_: &MethodKind| Method::ALL.into_iter().find(|&method| kind(method) == *kind_);
        let names = Method::ALL.map(Method::name).join(", ");
        let found = self
            .methods
            .iter()
            .map(|kind| on_board(kind).with_context(|| format!("--methods {}: the board has {names}", kind.name())));
        found.collect()
    }

    /// The scenes' folders and pairs.
    fn scenes(&self) -> Result<Vec<(PathBuf, StereoPair)>> {
        let name = |folder: &PathBuf| folder.file_name().map(|name| name.to_string_lossy().into_owned());
        let mut folders = find_scenes(&self.scenes)?;
        for wanted in &self.only {
            ensure!(
                folders.iter().any(|folder| name(folder).as_ref() == Some(wanted)),
                "--only {wanted}: no such scene in {}",
                self.scenes.display()
            );
        }
        folders.retain(|folder| self.only.is_empty() || name(folder).is_some_and(|name| self.only.contains(&name)));
        let read = |folder: PathBuf| {
            let pair = StereoPair::read(&folder.join("left.png"), &folder.join("right.png"))?;
            ensure!(
                pair.width() <= WIDTH,
                "{}: the views have a width of {} px, and the board takes {WIDTH} at most",
                folder.display(),
                pair.width()
            );
            Ok((folder, pair))
        };
        folders.into_iter().map(read).collect()
    }

    fn line(&self, client: &mut Client, method: Method, scenes: &[(PathBuf, StereoPair)]) -> Result<Line> {
        let bar = progress(scenes.len(), method.name())?;
        let mut line =
            Line { method: method.name(), outcomes: Vec::new(), instructions: self.twin.as_ref().map(|_| 0) };
        for (_, pair) in scenes {
            line.outcomes.push(run(client, method, pair)?);
            if let (Some(elf), Some(sum)) = (&self.twin, &mut line.instructions) {
                *sum += instructions::count(elf, kind(method), pair)?;
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(line)
    }
}

/// Puts the program onto the board and starts it.
fn flash(elf: &std::path::Path) -> Result<()> {
    for (verb, file) in [("download", Some(elf)), ("reset", None)] {
        let mut command = Command::new("probe-rs");
        command.arg(verb).args(["--chip", "STM32H743ZITx"]).args(file);
        let status = command.status();
        let status = status.context("--flash: probe-rs cannot be run: install it from https://probe.rs")?;
        ensure!(status.success(), "--flash: probe-rs {verb} failed, see above");
    }
    Ok(())
}
