//! What a trace hands over, and how it becomes files and tables.

mod events;
pub(crate) mod folder;
mod number;
pub(crate) mod result;
mod summary;
mod table;

#[cfg(test)]
pub(crate) mod tests;

pub(crate) use events::events_json;
pub(crate) use folder::{Folder, FolderError};
pub(crate) use result::{ContactRow, EventRecord, Pictures, Table, TraceResult};
pub(crate) use summary::summary;
pub(crate) use table::branch_csv;
