//! What a trace hands over, and how it becomes files and tables.

mod checkpoint;
mod cycle;
mod diagram;
mod events;
mod folder;
mod manifest;
mod map;
mod number;
mod result;
mod sealed;
mod summary;
mod sweep;
mod table;
mod temporary;

#[cfg(test)]
pub(crate) mod tests;

pub(crate) use checkpoint::Checkpoint;
pub(crate) use cycle::{CycleResult, FoldRecord, JumpRecord, PathModes, PathRow, ReportedCycle};
pub(crate) use cycle::{StretchRecord, Way, cycle_json, cycle_summary, cycle_table};
pub(crate) use diagram::{BranchRecord, DiagramResult, From, NearRecord, Symmetry};
pub(crate) use diagram::{diagram_json, diagram_summary};
pub(crate) use events::events_json;
pub(crate) use folder::Folder;
pub(crate) use manifest::{Earlier, Files, with_files};
pub(crate) use map::{MapCurve, MapPoint, MapResult, map_json, map_summary};
pub(crate) use result::{Cell, ContactRow, EventRecord, FormRecord, MaxwellRecord, Table};
pub(crate) use result::{ModeRecord, Pictures, ResolutionRecord, ShapeRecord};
pub(crate) use result::{StabilityRecord, TraceResult};
pub(crate) use summary::summary;
pub(crate) use sweep::{CaseRecord, Kept, Status, Store, StoreError, SweepResult, events_table};
pub(crate) use sweep::{
    of_one_sweep, phase_csv, sweep_json, sweep_summary, write_curves, write_events,
};
pub(crate) use table::{branch_csv, modes_csv};
