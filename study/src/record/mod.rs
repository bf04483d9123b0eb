//! What a run hands over, as plain numbers, and how it becomes tables, JSON and summaries.

mod column;
mod cycle;
mod diagram;
mod events;
mod map;
pub(crate) mod number;
mod orbits;
mod outline;
pub mod phase;
mod physical;
mod result;
mod summary;
mod sweep;
mod table;
pub mod view;

#[cfg(test)]
mod tests;

pub(crate) use column::{PLATES, RING};
pub(crate) use cycle::MODES;
pub use cycle::{CycleResult, FoldRecord, JumpRecord, PathModes, PathRow, ReportedCycle};
pub use cycle::{StretchRecord, Way, cycle_json, cycle_summary, cycle_table};
pub use diagram::{BranchOrigin, BranchRecord, DiagramResult, NearRecord, Symmetry};
pub use diagram::{diagram_json, diagram_summary};
pub use events::events_json;
pub use map::{MapCurve, MapPoint, MapResult, map_json, map_summary};
pub use orbits::{CycleRecord, CyclesRecord, OrbitRecord, OrbitsRecord};
pub use outline::{Outline, State};
pub use physical::{Laboratory, PhysicalUnits, Scales, Unit, physical_table, spoken};
pub use result::{Cell, ContactRow, EventRecord, FormRecord, MaxwellRecord, Table};
pub use result::{
    MeshErrorRecord, ModeRecord, Pictures, PlaceError, ResolutionRecord, ShapeRecord,
};
pub use result::{StabilityRecord, TraceResult};
pub use summary::summary;
pub use sweep::{
    CaseRecord, LossRecord, Status, SweepResult, events_table, sweep_json, sweep_summary,
};
pub use table::{branch_csv, modes_csv};
