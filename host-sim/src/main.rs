//! The `haarline` command.
fn main() {}
