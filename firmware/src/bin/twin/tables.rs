//! The rig's tables, which the host gives as a file: too long for a command line.

use haarline::rectify::node_count;
use haarline::{Correction, LensTable, Rectification};
use haarline_firmware::app::ring::MAX_WIDTH;
use semihosting::io::Read;
use static_cell::ConstStaticCell;

use crate::file;
use crate::options::Options;

/// Nodes of the tallest table: 37 x 32 rows.
#[expect(clippy::cast_possible_truncation, reason = "320")]
const MOST_NODES: usize = node_count(MAX_WIDTH as u16) * 40;
const MOST_CORRECTION: usize = Correction::MAX_NODES[0] * Correction::MAX_NODES[1];

static LENS_NODES: [ConstStaticCell<[[i16; 2]; MOST_NODES]>; 2] =
    [const { ConstStaticCell::new([[0; 2]; MOST_NODES]) }; 2];
static CORRECTION_NODES: ConstStaticCell<[i16; MOST_CORRECTION]> = ConstStaticCell::new([0; MOST_CORRECTION]);

/// How many nodes the file has.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    /// Of each view's lens table; 0 without lenses.
    pub lens: usize,
    /// Of the correction, and of a row of it; 0 without.
    pub correction: usize,
    pub columns: u16,
}

/// The rectification with the tables that the file holds: nodes of the left and the right view, then those of the
/// correction, all of them little-endian.
pub fn complete(mut rectification: Rectification, options: &Options) -> Result<Rectification, &'static str> {
    let Counts { lens, correction, columns } = options.tables;
    if lens == 0 && correction == 0 {
        return Ok(rectification);
    }
    let mut file = file::open(file::TABLES)?;
    let mut number = || -> Result<i16, &'static str> {
        let mut bytes = [0; 2];
        file.read_exact(&mut bytes).map_err(|_| "tables.bin ends early")?;
        Ok(i16::from_le_bytes(bytes))
    };
    if lens > 0 {
        let size = [options.config.width, u16::try_from(options.height).unwrap_or(u16::MAX)];
        let [left, right] = &LENS_NODES;
        let mut table = |cell: &'static ConstStaticCell<[[i16; 2]; MOST_NODES]>| {
            let nodes = cell.take().get_mut(..lens).ok_or("the rig's lens tables are too large")?;
            for node in &mut *nodes {
                *node = [number()?, number()?];
            }
            LensTable::new(size, nodes).ok_or("the rig's lens tables are those of another size")
        };
        rectification.lenses = Some([table(left)?, table(right)?]);
    }
    if correction > 0 {
        let nodes = CORRECTION_NODES.take().get_mut(..correction).ok_or("the rig's correction is too large")?;
        for node in &mut *nodes {
            *node = number()?;
        }
        rectification.correction = Some(Correction::new(columns, nodes).ok_or("the rig's correction is none")?);
    }
    Ok(rectification)
}
