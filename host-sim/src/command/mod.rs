//! The commands of the tool, and what they share: how they end and how they print.

mod ablate;
mod align;
mod bench;
mod contours;
mod degradation;
mod demo;
mod depth;
mod eval;
mod play;
mod power;
mod receive;
mod record;
mod rig;
mod scene;
mod shared;
mod silicon;
mod study;
mod twin;

use std::ffi::OsString;
use std::io::{self, ErrorKind, Write};
use std::{env, fmt};

use anyhow::{Context, Result};
use clap::{CommandFactory, Parser, Subcommand, error};

/// Exit status of wrong input: files, options, anything the user can put right.
const STATUS_INPUT: u8 = 2;
/// Exit status of a run that came to its end and found something wrong.
const STATUS_FINDING: u8 = 1;

/// Stereo depth by Haar contours and extremum search, on recorded frames: the same core as on the chip
#[derive(Debug, Parser)]
#[command(name = "haarline", version)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Two rectified views in, a disparity map out
    Depth(depth::Args),
    /// Scores a method on scenes with known truth, next to OpenCV's figures
    Eval(eval::Args),
    /// Renders a scene with known truth and shows what the core makes of it
    Demo(demo::Args),
    /// Renders families of scenes with exact truth, for haarline eval
    Scene(scene::Args),
    /// A whole recording in, disparity maps and pictures out, frame by frame
    Play(play::Args),
    /// A pair or a recording in, the bytes a camera port would store of it out
    Record(record::Args),
    /// Row offset, roll and scale of a rig found from its own frames, no target needed
    Align(align::Args),
    /// Rig descriptions: what the cameras are like and how they stand
    Rig(rig::Args),
    /// Row packets that a chip sent in, disparity maps out
    Receive(receive::Args),
    /// Scores the method full without one of its parts each: what every part brings
    Ablate(ablate::Args),
    /// The firmware application on an emulated Cortex-M: same bytes, every instruction counted
    Twin(twin::Args),
    /// The methods on a bare board: every row compared with the host's, cycles by stage, a table to send us
    Silicon(silicon::Args),
    /// How long the methods take on this machine, and OpenCV's in turn with them
    Bench(bench::Args),
    /// What the program takes: planned without hardware, and from the recordings of a current meter
    Power(power::Args),
    /// Repeats the paper's experiments: tables, plots and a page
    Study(study::Args),
    /// The contours of an image as a picture, as the methods look for them
    Contours(contours::Args),
}

/// How a command ends when it does not succeed.
#[derive(Debug)]
pub struct Failure {
    /// What is wrong and what would be right, in one line.
    pub line: String,
    /// The process's exit status.
    pub status: u8,
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        let status = if error.is::<Finding>() { STATUS_FINDING } else { STATUS_INPUT };
        Self { line: one_line(&format!("{error:#}")), status }
    }
}

/// What a complete run found wrong: a figure over its limit (`--fail-over`), damaged frames.
#[derive(Debug)]
struct Finding(String);

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Finding {}

impl Cli {
    /// Reads the process's arguments. Help and version are printed and end the process.
    ///
    /// # Errors
    /// If they are not understood.
    pub fn from_args() -> Result<Self, Failure> {
        Self::parse_line(env::args_os()).or_else(|error| {
            if error.use_stderr() {
                return Err(Failure { line: condense(&error), status: STATUS_INPUT });
            }
            print(&error.to_string())?;
            std::process::exit(0);
        })
    }

    fn parse_line(arguments: impl IntoIterator<Item = OsString>) -> Result<Self, error::Error> {
        Self::try_parse_from(arguments)
    }

    /// Runs the command.
    ///
    /// # Errors
    /// If the input is wrong, or the run found something wrong.
    pub fn run(self) -> Result<(), Failure> {
        match self.command {
            Command::Depth(args) => args.run()?,
            Command::Eval(args) => args.run()?,
            Command::Demo(args) => args.run()?,
            Command::Scene(args) => args.run()?,
            Command::Play(args) => args.run()?,
            Command::Record(args) => args.run()?,
            Command::Align(args) => args.run()?,
            Command::Rig(args) => args.run()?,
            Command::Receive(args) => args.run()?,
            Command::Ablate(args) => args.run()?,
            Command::Twin(args) => args.run()?,
            Command::Silicon(args) => args.run()?,
            Command::Bench(args) => args.run()?,
            Command::Power(args) => args.run()?,
            Command::Study(args) => args.run()?,
            Command::Contours(args) => args.run()?,
        }
        Ok(())
    }
}

/// clap's message in one line, without the usage.
fn condense(error: &error::Error) -> String {
    if error.kind() == error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return missing_command(&error.to_string());
    }
    let text = error.to_string();
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let told = lines.take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"));
    let joined = told.collect::<Vec<_>>().join(" ").replace(" tip: ", "; ");
    format!("{}; --help tells more", joined.strip_prefix("error: ").unwrap_or(&joined))
}

/// Which commands there are where one is missing, as in the usage of `help`.
fn missing_command(help: &str) -> String {
    let usage = help.lines().find_map(|line| line.trim().strip_prefix("Usage: ")).unwrap_or_default();
    let (mut command, mut path) = (Cli::command(), "haarline".to_owned());
    for word in usage.split_whitespace().skip(1) {
        let Some(inner) = command.find_subcommand(word).cloned() else { break };
        (command, path) = (inner, format!("{path} {word}"));
    }
    let names: Vec<&str> =
        command.get_subcommands().map(clap::Command::get_name).filter(|name| *name != "help").collect();
    format!("a command is missing: {}; {path} --help tells more", names.join(", "))
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Reads a whole number of an option.
fn whole_number(text: &str) -> Result<i64, &'static str> {
    text.parse().map_err(|_| "must be a whole number")
}

/// Reads a whole number that is not negative.
fn natural_number(text: &str) -> Result<u64, &'static str> {
    text.parse().map_err(|_| "must be a whole number, 0 or more")
}

/// Reads a number of an option.
fn number(text: &str) -> Result<f64, &'static str> {
    text.parse().map_err(|_| "must be a number")
}

/// Prints to the standard output. Where nobody reads it any more, that is no error.
fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error).context("the standard output"),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn refused(line: &str) -> String {
        let arguments = line.split(' ').map(OsString::from);
        let error = Cli::parse_line(arguments).unwrap_err();
        condense(&error)
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    /// Every long option, with its command and what it takes.
    fn options(command: &clap::Command, found: &mut Vec<(String, String, String)>) {
        for argument in command.get_arguments() {
            let Some(long) = argument.get_long() else { continue };
            let takes_value = argument.get_action().takes_values();
            let values = argument.get_value_names().filter(|_| takes_value).unwrap_or_default();
            found.push((long.to_owned(), command.get_name().to_owned(), format!("{values:?}")));
        }
        command.get_subcommands().for_each(|command| options(command, found));
    }

    #[test]
    fn one_name_is_one_thing_in_all_commands() {
        // What is written differs; ablate takes several noises; a report may go to a file; eval scores the obstacles
        // that others write.
        const EXCEPTIONS: [&str; 4] = ["output", "noise", "json", "obstacles"];
        let mut found = Vec::new();
        options(&Cli::command(), &mut found);
        assert!(found.len() > 150, "{}", found.len());
        let mut first: std::collections::BTreeMap<&str, &(String, String, String)> = std::collections::BTreeMap::new();
        for option in found.iter().filter(|(long, ..)| !EXCEPTIONS.contains(&long.as_str())) {
            let other = first.entry(&option.0).or_insert(option);
            assert_eq!(option.2, other.2, "--{} of {} and {}", option.0, option.1, other.1);
        }
        // Whoever reads a recording can be told how its views are stored.
        for command in ["play", "record", "align", "twin"] {
            for wanted in ["layout", "left", "right", "first", "wiring"] {
                let is_there = found.iter().any(|(long, name, _)| name == command && long == wanted);
                assert!(is_there, "{command} --{wanted}");
            }
        }
    }

    #[test]
    fn a_refusal_is_one_line_that_names_the_option() {
        let cases = [
            ("haarline", "a command is missing: depth, "),
            ("haarline rig", "a command is missing: new, import, "),
            ("haarline power", "a command is missing: measure, plan, count; haarline power --help"),
            ("haarline dept", "unrecognized subcommand 'dept'"),
            ("haarline depth", "<LEFT>"),
            ("haarline depth a b --focal-px x", "--focal-px"),
            ("haarline depth a b --metod lite", "--method"),
            ("haarline eval d --method best", "lite"),
            ("haarline eval d --fail-over tot2", "KEY=VALUE"),
            ("haarline eval d --fail-over tot9=3", "tot9"),
            ("haarline play r", "--output"),
            ("haarline play r -o d --frames 5", "A..B"),
            ("haarline play r -o d --frames -1..3", "counted from 0"),
            ("haarline play r -o d --layout side", "side-by-side"),
            ("haarline ablate d --noise 0,x", "--noise"),
            ("haarline play r -o d --raw 320 --wiring pixel", "320x240"),
            ("haarline play r -o d --raw 31x240 --wiring pixel", "32 to 1280 px"),
            ("haarline play r -o d --raw 320x240 --wiring frame", "side-by-side"),
            ("haarline record l -o d --wiring pixel", "RIGHT"),
            ("haarline record -o d --wiring pixel", "LEFT"),
            ("haarline record l r --wiring pixel", "--output"),
            ("haarline study", "<NAME>"),
            ("haarline study detial -o d", "detail"),
            ("haarline study all", "--output"),
            ("haarline study all -o d --seed -1", "--seed"),
            ("haarline study all -o d --only room", "--scenes"),
        ];
        for (line, wanted) in cases {
            let told = refused(line);
            assert!(told.contains(wanted) && !told.contains('\n'), "{line}: {told}");
        }
    }
}
