//! From a measured force curve of a coated microbubble to its properties.

pub mod assign;
pub mod attend;
pub mod branch;
pub mod data;
pub mod error;
pub mod fit;
mod identification;
pub mod lever;
pub mod model;
pub mod parameters;
pub mod plan;
pub mod record;
mod remarks;
pub mod uncertainty;

pub use attend::{Attended, Progress, Stage};
pub use data::{Curve, Layout};
pub use error::{DataError, FitError, ModelError};
pub use identification::{Identification, PROFILED, Profiles, identify, identify_attended};
pub use parameters::{Key, Parameters};
pub use shell_contact::LawName;
