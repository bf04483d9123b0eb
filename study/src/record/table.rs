//! `branch.csv`: one row per point; `modes.csv`: one per knot of every mode.

use super::number::exact;
use super::result::{Cell, ShapeRecord, Table};

/// The table as CSV, numbers with full precision.
///
/// # Errors
/// What the writer reports; memory does not fail, so none is expected.
pub fn branch_csv(table: &Table) -> Result<Vec<u8>, csv::Error> {
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

/// The amplitudes of modes as CSV: one row per knot of each.
///
/// # Errors
/// What the writer reports; memory does not fail, so none is expected.
pub fn modes_csv(shapes: &[ShapeRecord]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["event", "n", "parity", "s", "u", "v", "w"])?;
    for shape in shapes {
        let (event, n) = (shape.event.to_string(), shape.n.to_string());
        let [u, v, w] = &shape.amplitudes;
        for (((s, u), v), w) in shape.s.iter().zip(u).zip(v).zip(w) {
            let [s, u, v, w] = [s, u, v, w].map(|x| exact(*x));
            writer.write_record([&event, &n, shape.parity, &s, &u, &v, &w])?;
        }
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}
