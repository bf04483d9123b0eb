//! Periodic orbits.

mod basis;
mod birth;
mod collocation;
mod cycle;
mod cyclic;
mod floquet;
mod matrix;
mod mesh;
mod point;
mod settings;
mod trace;

pub use birth::SmallCycle;
pub use collocation::{CycleProblem, MAX_BLOCK};
pub use cycle::{Cycle, CycleError};
pub use floquet::Multiplier;
pub use matrix::CycleMatrix;
pub use point::CyclePoint;
pub use settings::CycleSettings;
pub use trace::{CycleBranch, trace};
