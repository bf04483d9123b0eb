//! Results on disk: the output folder, and what is kept of long work so that nothing is lost.

mod checkpoint;
mod compute;
mod folder;
mod manifest;
mod sealed;
mod sweep;
mod tables;
mod temporary;

#[cfg(test)]
mod tests;

pub use checkpoint::{Checkpoint, CheckpointError};
pub use compute::{Computed, compute};
pub use folder::{Folder, FolderError};
pub use manifest::{Earlier, Files, with_files};
pub use sweep::{Kept, Store, StoreError, of_one_sweep};
pub use tables::{TableError, phase_csv, write_curves, write_events};
