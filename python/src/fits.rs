//! Fits of measured curves, and plans of measurements: the program's own.

use crate::attended::attended;
use crate::studies::{RawCase, given, json};
use cli::advice::Advised;
use identify::data::Direction;
use identify::{Attended, LawName, Progress};
use numpy::PyArray1;
use pictures::fit::{Drawn, draw_fit};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use study::fit::files::{files, fit_json, summary};
use study::fit::lab::{self, Lab, Wishes};
use study::fit::plan::planned;
use study::fit::{self, Fault, Laws, Outcome};

/// What is asked of a fit, in the words of the program's options.
#[derive(Clone, FromPyObject)]
pub(crate) struct Asked {
    #[pyo3(item)]
    fix: Vec<String>,
    #[pyo3(item)]
    free: Vec<String>,
    #[pyo3(item)]
    prior: Vec<String>,
    #[pyo3(item)]
    segments: Option<String>,
    #[pyo3(item)]
    range: Option<String>,
    #[pyo3(item)]
    robust: bool,
}

impl Asked {
    fn wishes(&self) -> Wishes<'_> {
        Wishes {
            fix: &self.fix,
            free: &self.free,
            prior: &self.prior,
            only: match self.segments.as_deref() {
                Some("approach") => Some(Direction::Approach),
                Some("retract") => Some(Direction::Retract),
                _ => None,
            },
            range: self.range.as_deref(),
            robust: self.robust,
        }
    }
}

fn laboratory(known: Option<&PathBuf>, keys: Vec<String>) -> PyResult<Lab> {
    lab::load(known.map(PathBuf::as_path), "known", &given(keys))
        .map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The tables of a file of known values, and their keys.
#[pyfunction]
pub(crate) fn lab_keys() -> Vec<(&'static str, Vec<String>)> {
    lab::keys().into()
}

/// The places of curves: a file, or a file and a number in it.
#[pyfunction]
pub(crate) fn curve_sources(
    paths: Vec<PathBuf>,
    known: Option<PathBuf>,
    keys: Vec<String>,
) -> PyResult<Vec<(PathBuf, Option<usize>)>> {
    let lab = laboratory(known.as_ref(), keys)?;
    let found = fit::sources(&paths, &lab);
    Ok(found.into_iter().map(|source| (source.path, source.number)).collect())
}

/// A fit of one curve: its record, or in words why nothing fits it; and what it was stopped by.
type Found<'py> = (Option<Bound<'py, PyDict>>, Option<String>, Option<PyErr>);

/// Who waits for a fit: a function of Python that is told of progress and stops the fit by returning True, and
/// what it or a signal has raised.
struct Waiting {
    progress: Option<Py<PyAny>>,
    stop: AtomicBool,
    failure: Mutex<Option<PyErr>>,
}

impl Waiting {
    fn tell(&self, at: Progress) {
        let Some(progress) = &self.progress else { return };
        let told =
            Python::attach(|py| progress.bind(py).call1((at.stage.name(), at.share))?.is_truthy());
        match told {
            Ok(false) => {}
            Ok(true) => self.stop.store(true, Ordering::Relaxed),
            Err(error) => self.fail(error),
        }
    }

    /// Stops the fit; the first of several reasons counts.
    fn fail(&self, error: PyErr) {
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.get_or_insert(error);
        self.stop.store(true, Ordering::Relaxed);
    }

    fn failure(&self) -> Option<PyErr> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Fits one curve.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn fit_curve<'py>(
    py: Python<'py>,
    curve: (PathBuf, Option<usize>),
    known: Option<PathBuf>,
    keys: Vec<String>,
    law: Option<&str>,
    profile: Option<&str>,
    asked: Asked,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found<'py>> {
    let lab = laboratory(known.as_ref(), keys)?;
    let laws = match law {
        None => Laws::Known,
        Some("all") => Laws::All,
        Some(name) => match LawName::of(name) {
            Some(law) => Laws::One(law),
            None => {
                let known = LawName::ALL.map(LawName::name).join(", ");
                let text = format!("law={name}: must be one of {known}, all");
                return Err(PyValueError::new_err(text));
            }
        },
    };
    let profiles =
        fit::profiles(profile).map_err(|error| PyValueError::new_err(error.advised()))?;
    let source = fit::Source { path: curve.0, number: curve.1 };
    let waiting =
        Arc::new(Waiting { progress, stop: AtomicBool::new(false), failure: Mutex::new(None) });
    let other = Arc::clone(&waiting);
    let work = move || {
        let tell = |at: Progress| other.tell(at);
        let attended = Attended { stop: Some(&other.stop), listener: Some(&tell) };
        fit::fit_file(&source, &lab, laws, asked.wishes(), &profiles, attended)
    };
    // a fit that is asked to stop ends within milliseconds, and keeps what it has
    let stopping = |raised| {
        waiting.fail(raised);
        None
    };
    let found = attended(py, work, stopping)?;
    let failure = waiting.failure();
    match found {
        Ok(outcome) => Ok((Some(record(py, &outcome)?), None, failure)),
        // options become arguments in the package's own words
        Err(error) if error.fault() == Fault::Input => Err(PyValueError::new_err(error.advised())),
        Err(error) => Ok((None, Some(error.advised()), failure)),
    }
}

fn record<'py>(py: Python<'py>, outcome: &Outcome) -> PyResult<Bound<'py, PyDict>> {
    let fault = |error: &dyn std::fmt::Display| PyRuntimeError::new_err(error.to_string());
    let dict = PyDict::new(py);
    dict.set_item("json", json(fit_json(outcome))?)?;
    dict.set_item("summary", summary(outcome))?;
    dict.set_item("good", outcome.best.report.is_good())?;
    let written = PyDict::new(py);
    let tables = files(outcome).map_err(|error| fault(&error))?;
    let drawn = draw_fit(outcome, Drawn::Svg, &study::case::PictureCase::default())
        .map_err(|error| fault(&error))?;
    for (name, bytes) in tables.into_iter().chain(drawn) {
        written.set_item(name, String::from_utf8_lossy(&bytes))?;
    }
    dict.set_item("files", written)?;
    let rows = &outcome.best.rows;
    let columns = PyDict::new(py);
    let segments: Vec<&str> = rows.iter().map(|row| row.segment).collect();
    columns.set_item("segment", segments)?;
    type Number = fn(&identify::record::Row) -> f64;
    let numbers: [(&str, Number); 6] = [
        ("piezo", |row| row.piezo),
        ("separation", |row| row.separation),
        ("approach_one_pole", |row| row.approach_one_pole),
        ("force", |row| row.force),
        ("model", |row| row.model),
        ("residual", |row| row.residual),
    ];
    for (name, number) in numbers {
        columns.set_item(name, PyArray1::from_vec(py, rows.iter().map(number).collect()))?;
    }
    columns.set_item("used", PyArray1::from_vec(py, rows.iter().map(|row| row.used).collect()))?;
    dict.set_item("columns", columns)?;
    Ok(dict)
}

/// What a measurement of a case would identify: JSON, and a table for people.
#[pyfunction]
pub(crate) fn plan_measurement(
    py: Python<'_>,
    case: &RawCase,
    known: Option<PathBuf>,
    keys: Vec<String>,
    asked: Asked,
) -> PyResult<(String, String)> {
    let lab = laboratory(known.as_ref(), keys)?;
    let case = case.case.clone();
    let work = move || planned(&case, &lab, asked.wishes());
    let plan = attended(py, work, Some)?.map_err(|error| PyValueError::new_err(error.advised()))?;
    Ok((json(plan.json())?, plan.summary()))
}
