//! Periodic orbits.

mod basis;
mod collocation;
mod cycle;
mod cyclic;
mod floquet;
mod matrix;
mod mesh;
mod point;
mod settings;

pub use collocation::{CycleProblem, MAX_BLOCK};
pub use cycle::{Cycle, CycleError};
pub use floquet::Multiplier;
pub use matrix::CycleMatrix;
pub use settings::CycleSettings;
