//! The extension module `arclen._arclen`: the engine for problems that are Python functions, the studies of
//! cases, and the program.
//!
//! The Python side (`arclen/`) checks and converts what users write, and dresses what comes back; this side
//! computes. Nothing here panics on purpose; a panic would arrive as an exception of Python.

mod attended;
mod branch;
mod callbacks;
mod command;
mod engine;
mod figures;
mod fits;
mod orbits;
mod problem;
mod storage;
mod studies;
mod sweeps;

use branch::RawBranch;
use callbacks::{Callbacks, OutsidePattern};
use continuation::{Parameter, Stability};
use engine::{Engine, EngineError};
use numpy::PyReadonlyArray1;
use problem::Spec;
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use std::sync::Arc;
use storage::Storage;

/// Indices, from the Python side.
type Indices<'py> = PyReadonlyArray1<'py, i64>;

fn indices(values: &Indices<'_>) -> PyResult<Vec<usize>> {
    let index = |value: &i64| usize::try_from(*value);
    let all: Result<Vec<usize>, _> = values.as_array().iter().map(index).collect();
    all.map_err(|_| PyValueError::new_err("an index is negative"))
}

/// An empty Jacobian: dense without a pattern, else `(below, above)` or `(rows, columns)`.
fn storage(n: usize, pattern: Option<&Bound<'_, PyAny>>) -> PyResult<Storage> {
    let too_large = |what: &str| {
        PyMemoryError::new_err(format!(
            "{what} Jacobian of {n} unknowns does not fit into memory: give its `sparsity`"
        ))
    };
    let Some(pattern) = pattern else {
        return Storage::dense(n).ok_or_else(|| too_large("a dense"));
    };
    if let Ok((below, above)) = pattern.extract::<(usize, usize)>() {
        return Storage::band(n, below, above).ok_or_else(|| too_large("so wide a banded"));
    }
    let (rows, columns) = pattern.extract::<(Indices<'_>, Indices<'_>)>()?;
    let entries: Vec<(usize, usize)> =
        indices(&rows)?.into_iter().zip(indices(&columns)?).collect();
    Storage::sparse(n, &entries)
        .map_err(|error| PyValueError::new_err(format!("sparsity: {error}")))
}

/// A problem; everything was checked by the Python side, but for sizes.
#[pyfunction]
#[pyo3(signature = (n, f, jac, slope, parameters, observe, stability, pattern, mass, metric))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)]
fn make_engine(
    n: usize,
    f: Py<PyAny>,
    jac: Option<Py<PyAny>>,
    slope: Option<Py<PyAny>>,
    parameters: Vec<(String, String, f64)>,
    observe: Vec<(String, Py<PyAny>)>,
    stability: Option<&str>,
    pattern: Option<Bound<'_, PyAny>>,
    mass: Option<(Indices<'_>, Indices<'_>, PyReadonlyArray1<'_, f64>)>,
    metric: Option<Vec<f64>>,
) -> PyResult<Engine> {
    let stability = match stability {
        None => Stability::None,
        Some("dynamics") => Stability::Dynamics,
        Some("energy") => Stability::EnergyHessian,
        Some(other) => {
            return Err(PyValueError::new_err(format!(
                "stability={other:?}: it is \"dynamics\", \"energy\" or None"
            )));
        }
    };
    let empty = storage(n, pattern.as_ref())?;
    let mass = match mass {
        None => None,
        Some((rows, columns, values)) => {
            let entries = indices(&rows)?.into_iter().zip(indices(&columns)?);
            let values = values.as_array().to_vec();
            Some(entries.zip(values).map(|((i, j), value)| (i, j, value)).collect::<Vec<_>>())
        }
    };
    if let Some((i, j, _)) = mass.iter().flatten().find(|(i, j, _)| !empty.holds(*i, *j)) {
        return Err(PyValueError::new_err(format!(
            "entry ({i}, {j}) of the mass matrix is not in the pattern of the Jacobian"
        )));
    }
    if metric.as_ref().is_some_and(|weights| weights.len() != n) {
        return Err(PyValueError::new_err(format!("the metric needs {n} weights")));
    }
    let parameters = parameters
        .into_iter()
        .map(|(name, unit, scale)| Parameter::named(name, unit, scale))
        .collect();
    Ok(Engine {
        spec: Spec {
            parameters,
            observables: observe.iter().map(|(name, _)| name.clone().into()).collect(),
            stability,
            empty,
            mass,
            metric,
            callbacks: Arc::new(Callbacks { f, jac, slope, observe }),
        },
    })
}

/// The compiled part of arclen.
#[pymodule]
fn _arclen(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("EngineError", module.py().get_type::<EngineError>())?;
    module.add("OutsidePattern", module.py().get_type::<OutsidePattern>())?;
    module.add_function(wrap_pyfunction!(make_engine, module)?)?;
    module.add_class::<Engine>()?;
    module.add_class::<RawBranch>()?;
    module.add_class::<orbits::RawOrbits>()?;
    module.add_function(wrap_pyfunction!(orbits::follow_orbits, module)?)?;
    module.add_function(wrap_pyfunction!(studies::find_case, module)?)?;
    module.add_function(wrap_pyfunction!(studies::parse_case, module)?)?;
    module.add_function(wrap_pyfunction!(studies::list_cases, module)?)?;
    module.add_class::<studies::RawCase>()?;
    module.add_class::<sweeps::RawSweep>()?;
    module.add_function(wrap_pyfunction!(studies::case_keys, module)?)?;
    module.add_function(wrap_pyfunction!(command::run_command, module)?)?;
    module.add_function(wrap_pyfunction!(fits::lab_keys, module)?)?;
    module.add_function(wrap_pyfunction!(fits::curve_sources, module)?)?;
    module.add_function(wrap_pyfunction!(fits::fit_curve, module)?)?;
    module.add_function(wrap_pyfunction!(fits::plan_measurement, module)?)?;
    module.add_function(wrap_pyfunction!(figures::compute_figures, module)?)?;
    Ok(())
}
