//! Files of the host.

use core::ffi::CStr;

use semihosting::fs::File;

/// Raw rows of the camera, frame after frame.
pub const RAW: &CStr = c"raw.bin";
/// Nodes of the rig's tables, if it has some.
pub const TABLES: &CStr = c"tables.bin";
/// Disparity rows.
pub const ROWS: &CStr = c"rows.bin";
/// Obstacles, a line a frame.
pub const OBSTACLES: &CStr = c"obstacles.txt";
/// What the run cost.
pub const REPORT: &CStr = c"report.txt";

/// Opens a file that has to be there.
pub fn open(name: &CStr) -> Result<File, &'static str> {
    File::open(name).map_err(|_| "raw.bin or tables.bin cannot be opened")
}

/// Creates a file.
pub fn create(name: &CStr) -> Result<File, &'static str> {
    File::create(name).map_err(|_| "a file cannot be created")
}
