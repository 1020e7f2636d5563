//! Where things of the program are: its own symbols say so.

use anyhow::{Context, Result};
use object::{Object, ObjectSymbol, SymbolKind};

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

/// The addresses of the functions in the ELF file whose names, as the linker knows them, have all of `parts`.
///
/// # Errors
/// If the bytes are no ELF file.
pub fn functions(elf: &[u8], parts: &[&str]) -> Result<Vec<u64>> {
    let file = object::File::parse(elf)?;
    let is_meant = |name: &str| parts.iter().all(|part| name.contains(part));
    let mut addresses: Vec<u64> = file
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.name().is_ok_and(is_meant))
        // The lowest bit says that it is Thumb code.
        .map(|symbol| symbol.address() & !1)
        .collect();
    addresses.sort_unstable();
    addresses.dedup();
    Ok(addresses)
}
