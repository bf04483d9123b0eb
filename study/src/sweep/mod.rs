//! Parameter studies: what a sweep file may say, and the cases that it stands for.
//!
//! A sweep file is a case file with tables `[[vary]]`. With `case = …` it takes another case as its
//! base, over which its own keys are laid. Every `[[vary]]` gives one key several values; the cases
//! are all their combinations, the last key varying fastest, except that keys with the same `zip`
//! advance together. The order of the cases, and so their numbers, depend on the file alone.

mod axis;
mod plan;
mod read;
mod shard;

#[cfg(test)]
mod tests;

pub use plan::{Axis, Plan, Setting};
pub use read::{Sweep, SweepCase, SweepError, load};
pub use shard::Shard;
