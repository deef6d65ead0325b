//! The `isolux` program.
fn main() {}
