//! The `haarline` command: a thin shell around the library.

use std::io::{Write, stderr};
use std::panic::{self, PanicHookInfo};
use std::process::{self, ExitCode};

use haarline_sim::command::{Cli, Failure};
use haarline_sim::input::image_file;

/// Exit status of a fault of ours, as in sysexits.h (`EX_SOFTWARE`).
const STATUS_INTERNAL: i32 = 70;

fn main() -> ExitCode {
    panic::set_hook(Box::new(report_fault));
    match Cli::from_args().and_then(Cli::run) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure { line, status }) => {
            // Nowhere is left to tell if this fails, too.
            let _ = writeln!(stderr(), "error: {line}");
            ExitCode::from(status)
        }
    }
}

/// A panic is a fault in the tool, never in its input: says so in one line. But in an image's decoder, it is
/// caught, and the image told to be damaged.
fn report_fault(info: &PanicHookInfo<'_>) {
    if image_file::is_decoding() {
        return;
    }
    let place = info.location().map(|at| format!("{}:{}", at.file(), at.line())).unwrap_or_default();
    let cause = info.payload_as_str().unwrap_or("no message").replace('\n', " ");
    let _ = writeln!(stderr(), "error: internal fault at {place}: {cause}; please report it with the command you gave");
    process::exit(STATUS_INTERNAL);
}
