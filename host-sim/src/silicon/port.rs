//! A serial port, or the emulated chip's in its place.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};

/// How long a read waits for bytes.
const WAIT: Duration = Duration::from_millis(20);

/// Bytes to and from a board. A read that gets none in time returns none.
pub trait Port: Read + Write {}

impl<T: Read + Write> Port for T {}

/// Opens a serial port by its path, or `HOST:PORT` where somebody listens for the host of an emulated board.
///
/// # Errors
/// If there is no such port, or it cannot be set up.
pub fn open(name: &str, baud: u32) -> Result<Box<dyn Port>> {
    if !Path::new(name).exists()
        && let Some((host, port)) = name.rsplit_once(':')
        && let Ok(port) = port.parse::<u16>()
    {
        let stream =
            TcpStream::connect((host, port)).with_context(|| format!("--port {name}: nobody listens there"))?;
        stream.set_read_timeout(Some(WAIT))?;
        stream.set_nodelay(true)?;
        return Ok(Box::new(Timed(stream)));
    }
    serial(name, baud).with_context(|| format!("--port {name}"))
}

#[cfg(unix)]
fn serial(name: &str, baud: u32) -> Result<Box<dyn Port>> {
    use rustix::termios::{ControlModes, InputModes, OptionalActions, SpecialCodeIndex, isatty, tcgetattr, tcsetattr};

    let file = std::fs::OpenOptions::new().read(true).write(true).open(name);
    let file = file.context("cannot be opened: is the board plugged in, and are you in the group dialout?")?;
    anyhow::ensure!(isatty(&file), "is no serial port");
    let mut settings = tcgetattr(&file)?;
    settings.make_raw();
    settings.input_modes -= InputModes::IXON | InputModes::IXOFF;
    settings.control_modes -= ControlModes::CRTSCTS;
    settings.control_modes |= ControlModes::CREAD | ControlModes::CLOCAL;
    settings.set_speed(baud)?;
    // A read waits for a tenth of a second at most.
    settings.special_codes[SpecialCodeIndex::VMIN] = 0;
    settings.special_codes[SpecialCodeIndex::VTIME] = 1;
    tcsetattr(&file, OptionalActions::Flush, &settings).with_context(|| format!("does not do {baud} baud"))?;
    Ok(Box::new(Timed(file)))
}

#[cfg(not(unix))]
fn serial(_: &str, _: u32) -> Result<Box<dyn Port>> {
    anyhow::bail!("serial ports are supported on Linux and macOS only")
}

/// A read that waited in vain is none, not an error.
struct Timed<T>(T);

impl<T: Read> Read for Timed<T> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.0.read(buffer) {
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => Ok(0),
            other => other,
        }
    }
}

impl<T: Write> Write for Timed<T> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.0.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
