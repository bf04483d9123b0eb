//! The figures of the reference paper.

use crate::attended::attended;
use crate::studies::{given, json};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Figures: JSON, files, summary, whether all was computed; and the exception that ended the work.
#[pyfunction]
pub(crate) fn compute_figures<'py>(
    py: Python<'py>,
    names: Vec<String>,
    keys: Vec<String>,
) -> PyResult<(Bound<'py, PyDict>, Option<PyErr>)> {
    let refused = |error: paper::FigureError| PyValueError::new_err(error.to_string());
    let numbers = paper::numbers(&names).map_err(refused)?;
    let plan = paper::plan(&numbers, &given(keys)).map_err(refused)?;
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let work = move || {
        plan.compute(&flag, &mut |_| ()).map(|computed| {
            let files = paper::files(&computed, Some(&study::case::PictureCase::default()))
                .map_err(|error| error.to_string());
            let complete = computed.early.is_empty();
            (paper::json(&computed), files, paper::summary(&computed), complete)
        })
    };
    let mut failure = None;
    let outcome = attended(py, work, |raised| {
        if failure.is_some() {
            return Some(raised);
        }
        stop.store(true, Ordering::SeqCst);
        failure = Some(raised);
        None
    })?;
    let (text, files, summary, complete) = outcome.map_err(refused)?;
    let dict = PyDict::new(py);
    dict.set_item("json", json(text)?)?;
    dict.set_item("summary", summary)?;
    dict.set_item("complete", complete)?;
    let written = PyDict::new(py);
    for (name, bytes) in files.map_err(PyRuntimeError::new_err)? {
        written.set_item(name, PyBytes::new(py, &bytes))?;
    }
    dict.set_item("files", written)?;
    Ok((dict, failure))
}
