//! QEMU, and one run of the program in it.

use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail};
use clap::ValueEnum;

use super::cycles::Core;

const QEMU: &str = "qemu-system-arm";

/// An emulated machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Machine {
    /// Cortex-M4F
    An386,
    /// Cortex-M7
    An500,
    /// Cortex-M33
    An505,
}

impl Machine {
    /// The name on the command line and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::An386 => "an386",
            Self::An500 => "an500",
            Self::An505 => "an505",
        }
    }

    /// Its processor.
    #[must_use]
    pub fn core(self) -> &'static str {
        match self {
            Self::An386 => "Cortex-M4F",
            Self::An500 => "Cortex-M7",
            Self::An505 => "Cortex-M33",
        }
    }

    /// The same for the model of cycles.
    #[must_use]
    pub fn processor(self) -> Core {
        match self {
            Self::An386 => Core::CortexM4,
            Self::An500 => Core::CortexM7,
            Self::An505 => Core::CortexM33,
        }
    }

    /// The compiler's target for its programs.
    #[must_use]
    pub fn target(self) -> &'static str {
        match self {
            Self::An386 | Self::An500 => "thumbv7em-none-eabihf",
            Self::An505 => "thumbv8m.main-none-eabihf",
        }
    }

    /// Runs the program `program` of the folder `folder`, which is where its files lie, too.
    ///
    /// # Errors
    /// If QEMU is missing, the program fails, or it takes longer than `limit`.
    pub fn run(self, folder: &Path, program: &str, arguments: &[String], limit: Duration) -> Result<()> {
        let mut config = String::from("enable=on,target=native,arg=twin");
        for argument in arguments {
            // QEMU's options are parted by commas.
            config += &format!(",arg={}", argument.replace(',', ",,"));
        }
        let log = folder.join("qemu.log");
        let errors = File::create(&log).context("the folder for the run")?;
        let mut qemu = Command::new(QEMU);
        qemu.current_dir(folder).arg("-machine").arg(format!("mps2-{}", self.name()));
        qemu.args(["-nographic", "-monitor", "none", "-serial", "none"]);
        // An instruction is 64 ns of virtual time: the program's clock counts on it.
        qemu.args(["-icount", "shift=6,sleep=off", "-semihosting-config", &config, "-kernel", program]);
        qemu.stdin(Stdio::null()).stdout(Stdio::null()).stderr(errors);
        let mut child = qemu.spawn().map_err(|error| missing(&error))?;
        let ended = wait(&mut child, limit);
        let mut told = String::new();
        File::open(&log).and_then(|mut file| file.read_to_string(&mut told)).ok();
        let told = told.trim();
        match ended? {
            Some(0) => Ok(()),
            Some(_) if !told.is_empty() => bail!("the emulated program: {}", told.trim_start_matches("error: ")),
            status => bail!("the emulated program ended without a word (status {status:?})"),
        }
    }
}

fn missing(error: &std::io::Error) -> anyhow::Error {
    match error.kind() {
        ErrorKind::NotFound => {
            anyhow!("{QEMU} is missing: install it (Debian, Ubuntu: sudo apt install {QEMU}; macOS: brew install qemu)")
        }
        _ => anyhow!("{QEMU} cannot be run: {error}"),
    }
}

/// Waits for the end, but no longer than `limit`; the exit status.
fn wait(child: &mut Child, limit: Duration) -> Result<Option<i32>> {
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait().context(QEMU)? {
            return Ok(status.code());
        }
        if begin.elapsed() > limit {
            child.kill().and_then(|()| child.wait()).context(QEMU)?;
            bail!("the emulated program did not end within {} s: raise --timeout, or ask for less", limit.as_secs());
        }
        thread::sleep(Duration::from_millis(5));
    }
}
