//! `branch.csv`: one row per point.

use super::number::exact;
use super::result::{Cell, Table};

/// The table as CSV, numbers with full precision.
///
/// # Errors
/// What the writer reports; memory does not fail, so none is expected.
pub(crate) fn branch_csv(table: &Table) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(table.columns())?;
    for row in table.rows() {
        writer.write_record(row.iter().map(|cell| match cell {
            Cell::Real(value) => exact(*value),
            Cell::Count(count) => count.to_string(),
            Cell::Text(text) => text.clone(),
            Cell::Empty => String::new(),
        }))?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}
