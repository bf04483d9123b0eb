//! The binary `arclen`.
fn main() {}
