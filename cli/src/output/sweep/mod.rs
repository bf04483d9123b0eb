//! What a sweep leaves: the outcome of every case while it runs, tables and JSON of all in the end.

mod json;
mod record;
mod store;
mod summary;
mod tables;

pub(crate) use json::{SweepResult, sweep_json};
pub(crate) use record::{CaseRecord, Status, events_table};
pub(crate) use store::{Kept, Store, StoreError, of_one_sweep};
pub(crate) use summary::sweep_summary;
pub(crate) use tables::{phase_csv, write_curves, write_events};
