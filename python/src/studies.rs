//! Cases and what is computed of them: the program's own studies, as tables and JSON.

use continuation::Stop;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::ops::ControlFlow;
use std::path::Path;
use study::case::keys::{Key, TABLES};
use study::case::{self, Override, ProblemCase, ResolvedCase};
use study::record::{
    Cell, DiagramResult, MapResult, Outline, Table, TraceResult, branch_csv, cycle_json,
    cycle_table, diagram_json, events_json, map_json,
};
use study::run::{self, KeepNothing, Saved};

/// A checked case; immutable.
#[pyclass(frozen, module = "arclen._arclen")]
pub(crate) struct RawCase {
    pub(crate) case: ResolvedCase,
    notes: Vec<String>,
}

fn loaded(found: Result<case::LoadedCase, case::LoadError>) -> PyResult<RawCase> {
    let found = found.map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(RawCase { case: found.case, notes: found.notes })
}

pub(crate) fn given(keys: Vec<String>) -> Vec<Override> {
    keys.into_iter().map(|text| Override::given_by("keyword", text)).collect()
}

/// A shipped case, a problem of the catalogue, or a file.
#[pyfunction]
pub(crate) fn find_case(what: &str, keys: Vec<String>) -> PyResult<RawCase> {
    loaded(case::load(Path::new(what), &given(keys), &case::catalogue()))
}

/// The case that a text says.
#[pyfunction]
pub(crate) fn parse_case(name: &str, text: &str, keys: Vec<String>) -> PyResult<RawCase> {
    let plain = case::plain_name(name);
    loaded(case::load_text(name, &plain, text, &given(keys), &case::catalogue()))
}

/// The tables of case files, in the order of their list: table, problems, names of the keys.
#[pyfunction]
pub(crate) fn case_keys() -> Vec<(&'static str, &'static str, Vec<&'static str>)> {
    let names = |keys: &[Key]| keys.iter().map(|key| key.name).collect();
    TABLES.iter().map(|table| (table.table, table.problems, names(table.keys))).collect()
}

/// Shipped cases, and the catalogue: names with a line about each.
#[pyfunction]
pub(crate) fn list_cases() -> (Vec<String>, Vec<(String, String)>) {
    let shipped = case::SHIPPED.iter().map(|(name, _)| (*name).to_owned()).collect();
    let catalogue = case::catalogue().into_iter().map(|entry| (entry.name, entry.summary));
    (shipped, catalogue.collect())
}

#[pymethods]
impl RawCase {
    #[getter]
    fn name(&self) -> &str {
        &self.case.name
    }

    /// The word of `problem` in its file, or the name of a problem of the catalogue.
    #[getter]
    fn problem(&self) -> &str {
        self.case.problem.name()
    }

    /// Whether its quantities have units.
    #[getter]
    fn is_physical(&self) -> bool {
        self.case.problem.is_physical()
    }

    /// Names of the parameters of a problem of the catalogue, but for the continued one.
    #[getter]
    fn parameters(&self) -> Vec<&str> {
        match &self.case.problem {
            ProblemCase::Catalogue(case) => case.parameters.keys().map(String::as_str).collect(),
            _ => Vec::new(),
        }
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    fn to_toml(&self) -> String {
        self.case.to_toml()
    }

    /// The meridian in a state: distances from the axis, heights, pressure of the film.
    #[allow(clippy::type_complexity)]
    fn meridian<'py>(
        &self,
        py: Python<'py>,
        u: Vec<f64>,
        parameter: f64,
    ) -> PyResult<Option<[Bound<'py, PyArray1<f64>>; 3]>> {
        let found = py.detach(|| run::meridian(&self.case, &u, parameter));
        let found = found.map_err(|error| PyValueError::new_err(error.to_string()))?;
        let arrays = |one: Outline| {
            [one.sigma, one.z, one.pressure].map(|values| PyArray1::from_vec(py, values))
        };
        Ok(found.map(arrays))
    }

    /// A branch: its record, and the exception that ended it.
    fn trace<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Option<PyErr>)> {
        let mut watcher = Watcher::new(progress);
        let result = py.detach(|| {
            run::run_trace(&self.case, &mut |at| watcher.tell(at.points, at.events, at.parameter))
        });
        Ok((trace_dict(py, &self.case, &watcher.settle(result)?)?, watcher.failure))
    }

    /// A diagram.
    fn diagram<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Option<PyErr>)> {
        let mut watcher = Watcher::new(progress);
        let result = py.detach(|| {
            let (saved, keep) = (Saved::default(), &mut KeepNothing);
            run::run_diagram(&self.case, false, saved, keep, &mut |at| {
                watcher.tell(at.branch.points, at.branch.events, at.branch.parameter)
            })
        });
        Ok((diagram_dict(py, &self.case, &watcher.settle(result)?)?, watcher.failure))
    }

    /// A cycle of loading and unloading.
    fn cycle<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Option<PyErr>)> {
        let mut watcher = Watcher::new(progress);
        let result = py.detach(|| {
            run::run_cycle(&self.case, false, &mut |at| {
                watcher.tell(at.points, at.events, at.parameter)
            })
        });
        let result = watcher.settle(result)?;
        let dict = PyDict::new(py);
        dict.set_item("json", json(cycle_json(&result))?)?;
        dict.set_item("path", table_dict(py, &cycle_table(&result))?)?;
        dict.set_item("branch", table_dict(py, &result.branch)?)?;
        Ok((dict, watcher.failure))
    }

    /// Curves of special points in the parameter and another key.
    fn map<'py>(
        &self,
        py: Python<'py>,
        over: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Option<PyErr>)> {
        let mut watcher = Watcher::new(progress);
        let result = py.detach(|| {
            run::run_map(&self.case, over, &mut |at| {
                watcher.tell(at.points, at.events, at.parameter)
            })
        });
        Ok((map_dict(py, &self.case, &watcher.settle(result)?)?, watcher.failure))
    }
}

/// Told of every point: asks for Ctrl-C and calls the user's function.
struct Watcher {
    progress: Option<Py<PyAny>>,
    failure: Option<PyErr>,
}

impl Watcher {
    fn new(progress: Option<Py<PyAny>>) -> Self {
        Watcher { progress, failure: None }
    }

    fn tell(&mut self, points: usize, events: usize, parameter: f64) -> ControlFlow<()> {
        if self.failure.is_some() {
            return ControlFlow::Break(());
        }
        let told = Python::attach(|py| {
            py.check_signals()?;
            let Some(progress) = &self.progress else { return Ok(false) };
            // there is no arclength to tell
            progress.bind(py).call1((points, events, parameter, f64::NAN))?.is_truthy()
        });
        match told {
            Ok(false) => ControlFlow::Continue(()),
            Ok(true) => ControlFlow::Break(()),
            Err(error) => {
                self.failure = Some(error);
                ControlFlow::Break(())
            }
        }
    }

    /// The result, or why there is none.
    fn settle<T, E: std::fmt::Display>(&mut self, result: Result<T, E>) -> PyResult<T> {
        result.map_err(|error| match self.failure.take() {
            Some(failure) => failure,
            None => PyValueError::new_err(error.to_string()),
        })
    }
}

pub(crate) fn json<E: std::fmt::Display>(text: Result<String, E>) -> PyResult<String> {
    text.map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

/// A table: `columns`, a list of (name, label, unit, values), and `csv`.
fn table_dict<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyList::empty(py);
    for (at, name) in table.columns().iter().enumerate() {
        let is_text = table.rows().iter().any(|row| matches!(row.get(at), Some(Cell::Text(_))));
        let values = if is_text || name == "event" {
            let word = |row: &Vec<Cell>| match row.get(at) {
                Some(Cell::Text(word)) => word.clone(),
                Some(Cell::Real(value)) => value.to_string(),
                Some(Cell::Count(count)) => count.to_string(),
                _ => String::new(),
            };
            table.rows().iter().map(word).collect::<Vec<String>>().into_pyobject(py)?.into_any()
        } else {
            let finite = |value: f64| if value.is_finite() { value } else { f64::NAN };
            let numbers = table.numbers(name).into_iter().map(finite).collect();
            let array = PyArray1::<f64>::from_vec(py, numbers);
            array.readwrite().make_nonwriteable();
            array.into_any()
        };
        columns.append((name, table.label(name), table.unit(name), values))?;
    }
    let csv = branch_csv(table).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let dict = PyDict::new(py);
    dict.set_item("columns", columns)?;
    dict.set_item("csv", String::from_utf8_lossy(&csv).into_owned())?;
    Ok(dict)
}

fn trace_dict<'py>(
    py: Python<'py>,
    case: &ResolvedCase,
    result: &TraceResult,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = table_dict(py, &result.table)?;
    dict.set_item("json", json(events_json(case, result))?)?;
    let pictures = &result.pictures;
    let shapes = PyList::empty(py);
    for shape in &pictures.shapes {
        let one = PyDict::new(py);
        one.set_item("label", &shape.label)?;
        one.set_item("sigma", PyArray1::from_slice(py, &shape.sigma))?;
        one.set_item("z", PyArray1::from_slice(py, &shape.z))?;
        one.set_item("plate", shape.plate)?;
        shapes.append(one)?;
    }
    dict.set_item("shapes", shapes)?;
    let modes = PyDict::new(py);
    for shape in &result.shapes {
        let one = PyDict::new(py);
        one.set_item("n", shape.n)?;
        one.set_item("parity", shape.parity)?;
        one.set_item("s", PyArray1::from_slice(py, &shape.s))?;
        for (name, amplitudes) in ["u", "v", "w"].into_iter().zip(&shape.amplitudes) {
            one.set_item(name, PyArray1::from_slice(py, amplitudes))?;
        }
        modes.set_item(shape.event, one)?;
    }
    dict.set_item("modes", modes)?;
    let states = PyList::empty(py);
    for event in &result.events {
        let vectors = PyList::empty(py);
        for vector in &event.eigenvectors {
            let imaginary = (!vector.im.is_empty()).then(|| PyArray1::from_slice(py, &vector.im));
            vectors.append((PyArray1::from_slice(py, &vector.re), imaginary))?;
        }
        states.append((PyArray1::from_slice(py, &event.u), vectors))?;
    }
    dict.set_item("states", states)?;
    Ok(dict)
}

fn diagram_dict<'py>(
    py: Python<'py>,
    case: &ResolvedCase,
    result: &DiagramResult,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("json", json(diagram_json(case, result))?)?;
    let branches = PyList::empty(py);
    for one in &result.branches {
        branches.append(trace_dict(py, case, &one.trace)?)?;
    }
    dict.set_item("branches", branches)?;
    let joints = pythonize::pythonize(py, &result.joints)?;
    dict.set_item("joints", joints)?;
    Ok(dict)
}

fn map_dict<'py>(
    py: Python<'py>,
    case: &ResolvedCase,
    result: &MapResult,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("json", json(map_json(case, result))?)?;
    let curves = PyList::empty(py);
    for curve in &result.curves {
        let one = table_dict(py, &curve.table)?;
        one.set_item("kind", &curve.kind)?;
        let word = |stop: &Stop| stop.reason.to_string();
        one.set_item("stopped", (word(&curve.began), word(&curve.stopped)))?;
        curves.append(one)?;
    }
    dict.set_item("curves", curves)?;
    Ok(dict)
}
