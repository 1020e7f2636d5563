//! The obstacles of each frame, as a line: the frame's number, and each sector's distance in mm or `-`.

use core::fmt::Write as _;

use haarline::obstacle::MAX_SECTORS;
use haarline_firmware::app::lookout::Sighting;
use semihosting::fs::File;
use semihosting::io::Write;
use semihosting::{eprintln, process};

/// Writes a frame's obstacles down.
pub fn note(file: &mut File, sighting: &Sighting<MAX_SECTORS>) {
    // A number has ten digits at most.
    let mut line = heapless::String::<{ 12 * (1 + MAX_SECTORS) }>::new();
    let mut done = write!(line, "{}", sighting.frame);
    for nearest in sighting.nearest_mm.iter().take(sighting.sectors) {
        done = done.and(match nearest {
            Some(mm) => write!(line, " {mm}"),
            None => line.write_str(" -"),
        });
    }
    if done.and(line.write_char('\n')).is_err() || file.write_all(line.as_bytes()).is_err() {
        eprintln!("error: obstacles cannot be written");
        process::exit(1);
    }
}
