//! How far the discrete shell is from the continuous one: estimated by a mesh twice as fine, and kept below a
//! tolerance by a mesh that is made for a branch.

mod demand;
mod refined;

pub use demand::{Demand, Place, ToleranceError};
pub use refined::{Refined, Shift};
