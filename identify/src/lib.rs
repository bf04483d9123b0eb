//! From a measured force curve of a coated microbubble to its properties.

pub mod assign;
pub mod branch;
pub mod data;
pub mod error;
pub mod fit;
pub mod lever;
pub mod model;
pub mod parameters;

pub use error::ModelError;
pub use parameters::{Key, LawName, Parameters};
