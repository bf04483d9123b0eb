//! What a sweep leaves: the outcome of every case, and the JSON and summary of all.

mod json;
mod record;
mod summary;

pub use json::{SweepResult, sweep_json};
pub use record::{CaseRecord, LossRecord, Status, events_table};
pub use summary::sweep_summary;
