//! `curves.csv`, `events.csv`, `phase.csv`: one tidy table each, with the case and the values that
//! vary in front.

use super::sweep::{Kept, StoreError};
use crate::record::number::exact;
use crate::record::{Cell, Table};
use crate::sweep::{Plan, Setting};
use std::io::Write;

/// Why a table could not be written.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// A case could not be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The table could not be written.
    #[error(transparent)]
    Csv(#[from] csv::Error),
}

/// The points of all cases.
///
/// # Errors
/// When a case cannot be read or the table cannot be written.
pub fn write_curves(plan: &Plan, cases: &[Kept], out: &mut dyn Write) -> Result<(), TableError> {
    let columns = union(cases.iter().map(|case| &case.curve));
    write(plan, cases, &columns, out, |(curve, _)| curve)
}

/// The special points of all cases.
///
/// # Errors
/// When a case cannot be read or the table cannot be written.
pub fn write_events(plan: &Plan, cases: &[Kept], out: &mut dyn Write) -> Result<(), TableError> {
    let columns = union(cases.iter().map(|case| &case.events));
    write(plan, cases, &columns, out, |(_, events)| events)
}

/// All columns, each once, in the order in which they are met.
fn union<'a>(all: impl Iterator<Item = &'a Vec<String>>) -> Vec<String> {
    let mut union: Vec<String> = Vec::new();
    for columns in all {
        for column in columns {
            if !union.contains(column) {
                union.push(column.clone());
            }
        }
    }
    union
}

fn write(
    plan: &Plan,
    cases: &[Kept],
    columns: &[String],
    out: &mut dyn Write,
    which: impl Fn((Table, Table)) -> Table,
) -> Result<(), TableError> {
    let mut writer = csv::Writer::from_writer(out);
    let keys = plan.axes.iter().map(|axis| &*axis.key);
    let titles = std::iter::once("case").chain(keys).chain(columns.iter().map(String::as_str));
    writer.write_record(titles)?;
    for case in cases {
        let table = which(case.tables()?);
        let at: Vec<Option<usize>> = columns
            .iter()
            .map(|column| table.columns().iter().position(|own| own == column))
            .collect();
        let front = front(plan, case.record.case);
        for row in table.rows() {
            let cells = at.iter().map(|at| at.map_or_else(String::new, |at| shown(&row[at])));
            writer.write_record(front.iter().cloned().chain(cells))?;
        }
    }
    writer.flush().map_err(csv::Error::from)?;
    Ok(())
}

/// The class of every case, and the numbers that decide it.
///
/// # Errors
/// What the writer reports; memory does not fail, so none is expected.
pub fn phase_csv(plan: &Plan, cases: &[Kept]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let keys = plan.axes.iter().map(|axis| &*axis.key);
    let titles = ["class", "folds", "pole_film", "stiffness", "softening", "knee"];
    writer.write_record(std::iter::once("case").chain(keys).chain(titles))?;
    for case in cases {
        let mut row = front(plan, case.record.case);
        match &case.record.phase {
            Some(phase) => {
                row.extend([phase.class.to_string(), phase.folds.to_string()]);
                let numbers = [phase.pole_film, phase.stiffness, phase.softening, phase.knee];
                row.extend(numbers.map(|value| value.map_or_else(String::new, exact)));
            }
            None => row.extend(titles.map(|title| match title {
                "class" => "unknown".to_owned(),
                _ => String::new(),
            })),
        }
        writer.write_record(row)?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}

/// The case and its values.
fn front(plan: &Plan, case: usize) -> Vec<String> {
    let settings = plan.settings(case).into_iter().map(|setting| match setting {
        Setting::Integer(value) => value.to_string(),
        Setting::Real(value) => exact(*value),
        Setting::Text(text) => text.clone(),
    });
    std::iter::once(case.to_string()).chain(settings).collect()
}

fn shown(cell: &Cell) -> String {
    match cell {
        Cell::Real(value) => exact(*value),
        Cell::Count(count) => count.to_string(),
        Cell::Text(text) => text.clone(),
        Cell::Empty => String::new(),
    }
}
