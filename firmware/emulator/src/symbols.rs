//! Where things of the program are: its own symbols say so.

use anyhow::Result;
use object::{Object, ObjectSymbol, SymbolKind};

/// The name of the log's control block.
pub const CONTROL_BLOCK: &str = "_SEGGER_RTT";

/// The address of a variable of that name in the ELF file; none if it has none.
///
/// # Errors
/// If the bytes are no ELF file.
pub fn variable(elf: &[u8], name: &str) -> Result<Option<u64>> {
    let file = object::File::parse(elf)?;
    let found = file.symbols().find(|symbol| symbol.name() == Ok(name));
    Ok(found.map(|symbol| symbol.address()))
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
