//! How long `haarline power measure` reads a recording, in times of the `csv` crate's plain reading of the same file.
//!
//! `cargo bench -p haarline-sim --bench power_measure [-- ROWS]`: ROWS of a PPK2's export (default 300,000, 100 kS/s),
//! written to a file; ends with exit status 1 if it takes more than 1.6 times as long.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;

use haarline_sim::power::current_file::Setup;
use haarline_sim::power::measurement::Measurement;

/// Rows read in all: few rows and many rounds, then on a busy machine one of each is not disturbed.
const READ: u64 = 20_000_000;
/// What the ratio may be.
const MOST: f64 = 1.6;

fn write(path: &Path, rows: u64) -> std::io::Result<()> {
    let mut csv = BufWriter::new(File::create(path)?);
    writeln!(csv, "Timestamp(ms),Current(uA),D0-D7,D0,D1,D2,D3,D4,D5,D6,D7")?;
    let levels = ["00000000,0,0", "10000000,1,0", "11000000,1,1", "01000000,0,1"];
    for row in 0..rows {
        let microamperes = 20_000.0 + (row * 7919 % 10_007) as f64 * 1.37;
        let levels = levels[(row / 50 % 4) as usize];
        writeln!(csv, "{}.{:02},{microamperes:.3},{levels},0,0,0,0,0,0", row / 100, row % 100)?;
    }
    csv.flush()
}

fn plain(path: &Path) -> u64 {
    let mut reader = csv::Reader::from_path(path).expect("the file was written");
    let (mut record, mut rows) = (csv::ByteRecord::new(), 0);
    while reader.read_byte_record(&mut record).expect("every row can be read") {
        rows += 1;
    }
    rows
}

fn measured(path: &Path) -> u64 {
    let setup = Setup { volts: Some(3.3), rate: None, pins: [0, 1] };
    let file = File::open(path).expect("the file was written");
    Measurement::read(file, &setup).expect("every row can be read").samples
}

fn main() {
    // cargo's own argument, then ours.
    let rows = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(300_000);
    let folder = tempfile::tempdir().expect("a folder for the recording");
    let path = folder.path().join("ppk2.csv");
    write(&path, rows).expect("room for the recording");
    let timed = |read: fn(&Path) -> u64| {
        let begin = Instant::now();
        assert_eq!(read(&path), rows);
        begin.elapsed().as_secs_f64()
    };
    let rounds = (0..(READ / rows.max(1)).max(3)).map(|_| [timed(plain), timed(measured)]);
    let [plain, measured] = rounds.fold([f64::INFINITY; 2], |[a, b], [plain, ours]| [a.min(plain), b.min(ours)]);
    let (ratio, million) = (measured / plain, 1e-6 * rows as f64);
    println!(
        "{million} M rows: {:.1} M rows/s, {ratio:.2} times as long as plain reading ({:.1} M rows/s)",
        million / measured,
        million / plain
    );
    if ratio > MOST {
        eprintln!("more than {MOST} times as long");
        std::process::exit(1);
    }
}
