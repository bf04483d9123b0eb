//! From a measured force curve of a coated microbubble to its properties.

pub mod assign;
pub mod branch;
pub mod data;
pub mod error;
pub mod fit;
pub mod identify;
pub mod lever;
pub mod model;
pub mod parameters;
pub mod record;
mod remarks;
pub mod uncertainty;

pub use data::{Curve, Layout};
pub use error::{DataError, FitError, ModelError};
pub use identify::{Identification, Profiles, identify};
pub use parameters::{Key, LawName, Parameters};
