//! One pair through one method, on the board and here.

use anyhow::{Context, Result, bail};
use haarline::{Config, ScanlinePair};
use haarline_link::message::{Answer, DISPARITIES, Figures, Method, Request};

use super::client::Client;
use crate::StereoPair;
use crate::stereo::method::MethodKind;

/// Times that a frame is begun anew after the board forgot it.
const ANEW: u32 = 5;

/// Who answers.
#[derive(Debug, Clone)]
pub struct Board {
    /// The chip's name.
    pub chip: String,
    /// Its silicon's revision.
    pub revision: String,
    /// The core's clock, MHz.
    pub mhz: u16,
    /// The compiler that made the program.
    pub compiler: String,
}

impl Board {
    /// Asks who is there.
    ///
    /// # Errors
    /// If nobody answers, or a program of another version does.
    pub fn find(client: &mut Client) -> Result<Self> {
        match client.ask(&Request::Hello)? {
            Answer::Hello { version: haarline_link::message::VERSION, chip, revision, mhz, compiler } => {
                Ok(Self { chip: chip.to_owned(), revision: revision.to_owned(), mhz, compiler: compiler.to_owned() })
            }
            Answer::Hello { version, .. } => {
                bail!("the board's program talks version {version} of the protocol: flash the one of this version")
            }
            other => bail!("the board answers {other:?} where it should say who it is"),
        }
    }
}

/// What came of a pair.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    /// What it cost.
    pub figures: Figures,
    /// Pixels of the left view.
    pub pixels: u64,
    /// Rows pushed.
    pub pushes: u64,
    /// The first row that is not the host's.
    pub different: Option<u32>,
}

/// A row as it was delivered.
struct Row {
    y: u32,
    disparity: Vec<u8>,
    confidence: Vec<u8>,
}

/// The host's method of that name.
#[must_use]
pub fn kind(method: Method) -> MethodKind {
    match method {
        Method::Full => MethodKind::Full,
        Method::Lite => MethodKind::Lite,
        Method::WaveletBlock => MethodKind::WaveletBlock,
        Method::Block => MethodKind::Block,
        Method::Sgm => MethodKind::Sgm,
    }
}

/// The configuration of every search.
#[must_use]
pub fn config(pair: &StereoPair) -> Config {
    Config { width: pair.width() as u16, min_disparity: 0, num_disparities: DISPARITIES as u16 }
}

/// Sends a pair through a method of the board, and compares every row with the host's. A board that forgot what it was
/// doing, after a reset, begins the pair anew.
///
/// # Errors
/// If the board falls silent, refuses the pair, or forgets it again and again.
pub fn run(client: &mut Client, method: Method, pair: &StereoPair) -> Result<Outcome> {
    let expected = expected(method, pair)?;
    let mut refused = String::new();
    for _ in 0..ANEW {
        match attempt(client, method, pair, &expected)? {
            Ok(outcome) => return Ok(outcome),
            Err(why) => refused = why,
        }
    }
    bail!("the board refuses {}: {refused}", method.name())
}

fn expected(method: Method, pair: &StereoPair) -> Result<Vec<Row>> {
    let mut method = kind(method).build(config(pair)).context("the configuration")?;
    let mut rows = Vec::new();
    let mut keep = |row: haarline::DisparityRow<'_>| {
        let disparity = row.disparity.iter().flat_map(|disparity| disparity.into_bits().to_le_bytes()).collect();
        rows.push(Row { y: row.y, disparity, confidence: row.confidence.to_vec() });
    };
    for y in 0..pair.height() {
        let rows = ScanlinePair { left: pair.left.row(y), right: pair.right.row(y) };
        method.push(rows, &mut keep).context("the host's method")?;
    }
    method.finish(&mut keep);
    Ok(rows)
}

/// The outcome, or why the board refused something.
fn attempt(
    client: &mut Client,
    method: Method,
    pair: &StereoPair,
    expected: &[Row],
) -> Result<Result<Outcome, String>> {
    let Config { width, min_disparity, .. } = config(pair);
    macro_rules! rows_after {
        ($request:expr) => {
            match client.ask($request)? {
                Answer::Done(rows) => rows,
                Answer::Refused(why) => return Ok(Err(why.to_owned())),
                other => bail!("the board answers {other:?}"),
            }
        };
    }
    rows_after!(&Request::Begin { method, width, min_disparity });
    let (mut taken, mut different) = (0, None);
    for y in 0..=pair.height() {
        let delivered = if y < pair.height() {
            let pixels = [pair.left.row(y), pair.right.row(y)].concat();
            rows_after!(&Request::Push(&pixels))
        } else {
            rows_after!(&Request::Finish)
        };
        while taken < delivered {
            match client.ask(&Request::Take(taken))? {
                Answer::Row { y, disparity, confidence } => {
                    let is_same = expected.get(taken as usize).is_some_and(|row| {
                        (row.y, &row.disparity[..], &row.confidence[..]) == (y, disparity, confidence)
                    });
                    if !is_same && different.is_none() {
                        different = Some(y);
                    }
                }
                Answer::Refused(why) => return Ok(Err(why.to_owned())),
                other => bail!("the board answers {other:?}"),
            }
            taken += 1;
        }
    }
    if (taken as usize) < expected.len() && different.is_none() {
        different = Some(taken);
    }
    match client.ask(&Request::Figures)? {
        Answer::Figures(figures) => {
            let (pixels, pushes) = ((pair.width() * pair.height()) as u64, pair.height() as u64);
            Ok(Ok(Outcome { figures, pixels, pushes, different }))
        }
        Answer::Refused(why) => Ok(Err(why.to_owned())),
        other => bail!("the board answers {other:?}"),
    }
}
