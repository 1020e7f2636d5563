//! Where the log's control block is: the program's own symbol says so.

use anyhow::{Context, Result};
use object::{Object, ObjectSymbol};

/// The address of `_SEGGER_RTT` in the ELF file.
///
/// # Errors
/// If the bytes are no ELF file, or it keeps no log.
pub fn control_block(elf: &[u8]) -> Result<u64> {
    let file = object::File::parse(elf)?;
    file.symbols()
        .find(|symbol| symbol.name() == Ok("_SEGGER_RTT"))
        .map(|symbol| symbol.address())
        .context("the program has no log (_SEGGER_RTT)")
}
