//! OpenCV in a process of its own, which times its methods.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result, anyhow, ensure};
use haarline::Config;

use crate::StereoPair;

/// OpenCV's methods: StereoBM of 9 px, StereoSGBM as its documentation sets it, and two of its modes.
pub const METHODS: [&str; 4] = ["StereoBM", "StereoSGBM", "StereoSGBM_3WAY", "StereoSGBM_HH"];

const PYTHON: &str = "python3";
const SCRIPT: &str = include_str!("opencv.py");
const MISSING: &str = "OpenCV for python3 is missing: python3 -m pip install opencv-python-headless";

/// The process, ready to time one pair.
pub struct OpenCv {
    child: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// OpenCV's.
    pub version: String,
}

impl OpenCv {
    /// Starts it for a pair. OpenCV searches multiples of 16 disparities only.
    ///
    /// # Errors
    /// If Python or OpenCV is missing.
    pub fn start(pair: &StereoPair, config: &Config) -> Result<Self> {
        let mut python = Command::new(PYTHON);
        python.args(["-c", SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = python.spawn().map_err(|error| anyhow!("{PYTHON} cannot be run ({error}); {MISSING}"))?;
        let (requests, answers) = child.stdin.take().zip(child.stdout.take()).context(PYTHON)?;
        let mut opencv = Self { child, requests, answers: BufReader::new(answers), version: String::new() };
        let Config { min_disparity, num_disparities, .. } = config;
        let head =
            format!("{} {} {min_disparity} {}\n", pair.width(), pair.height(), num_disparities.next_multiple_of(16));
        let sent = [head.as_bytes(), &pair.left.luma, &pair.right.luma];
        let sent = sent.into_iter().try_for_each(|part| opencv.requests.write_all(part));
        let version = sent.and_then(|()| opencv.requests.flush()).ok().and_then(|()| opencv.answer().ok());
        opencv.version = version.filter(|version| !version.is_empty()).context(MISSING)?;
        Ok(opencv)
    }

    /// Times one run of a method.
    ///
    /// # Errors
    /// If the process fails.
    pub fn time(&mut self, method: &str) -> Result<Duration> {
        writeln!(self.requests, "{method}").and_then(|()| self.requests.flush()).context("OpenCV's process")?;
        let answer = self.answer()?;
        let nanoseconds = answer.parse().with_context(|| format!("OpenCV's {method} failed on this pair"))?;
        Ok(Duration::from_nanos(nanoseconds))
    }

    fn answer(&mut self) -> Result<String> {
        let mut line = String::new();
        let length = self.answers.read_line(&mut line).context("OpenCV's process")?;
        ensure!(length > 0, "OpenCV's process has ended");
        Ok(line.trim().to_owned())
    }
}

impl Drop for OpenCv {
    fn drop(&mut self) {
        // It has nothing to save.
        let _ = self.child.kill().and_then(|()| self.child.wait());
    }
}
