//! Branches of periodic orbits of a user's problem.

use crate::branch::RawBranch;
use crate::engine::{Engine, Outcome, Request, engine, event_of, report, request};
use continuation::EventKind;
use continuation::cycles::{CycleBranch, CyclePoint, CycleSettings, SmallCycle, trace};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::sync::Arc;

/// Version of the bytes.
const FORMAT: u32 = 1;

/// A branch of periodic orbits; immutable.
#[pyclass(frozen, module = "arclen._arclen")]
pub(crate) struct RawOrbits {
    inner: Arc<CycleBranch>,
}

#[pymethods]
impl RawOrbits {
    /// The points as those of any branch.
    #[getter]
    fn branch(&self) -> RawBranch {
        self.inner.branch.clone().into()
    }

    /// Estimated errors of the parameter at the special points.
    #[getter]
    fn event_errors(&self) -> Vec<Option<f64>> {
        self.inner.event_errors.clone()
    }

    /// Times and states of one cycle, from time 0 to the period.
    #[allow(clippy::type_complexity)]
    fn orbit<'py>(
        &self,
        py: Python<'py>,
        index: usize,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>)> {
        let cycle = &self.point_at(index)?.cycle;
        let n = cycle.dim();
        let mut times = Vec::with_capacity(cycle.values.len() / n.max(1) + 1);
        for w in cycle.mesh.windows(2) {
            let part = (w[1] - w[0]) / cycle.degree as f64;
            times.extend((0..cycle.degree).map(|k| cycle.period * (w[0] + part * k as f64)));
        }
        times.push(cycle.period);
        let mut states = cycle.values.clone();
        states.extend_from_within(..n);
        let count = times.len();
        let states = PyArray1::from_vec(py, states).reshape([count, n])?;
        Ok((PyArray1::from_vec(py, times), states))
    }

    /// The states of one cycle at given times.
    fn at<'py>(
        &self,
        py: Python<'py>,
        index: usize,
        times: Vec<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let cycle = &self.point_at(index)?.cycle;
        if let Some(bad) = times.iter().find(|t| !t.is_finite()) {
            return Err(PyValueError::new_err(format!("t: {bad} is no time")));
        }
        let states: Vec<f64> =
            times.iter().flat_map(|t| cycle.state(t.rem_euclid(cycle.period))).collect();
        PyArray1::from_vec(py, states).reshape([times.len(), cycle.dim()])
    }

    /// What is known of one cycle but its states.
    fn point<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        let point = self.point_at(index)?;
        let dict = PyDict::new(py);
        let value = |m: &continuation::cycles::Multiplier| {
            let (re, im) = m.value();
            (re, im, m.log_modulus, m.argument, m.error)
        };
        let multipliers: Vec<_> = point.multipliers.iter().map(value).collect();
        dict.set_item("multipliers", multipliers)?;
        dict.set_item("trivial", point.trivial)?;
        dict.set_item("trivial_error", point.trivial_error)?;
        dict.set_item("error", point.error)?;
        dict.set_item("period", point.cycle.period)?;
        dict.set_item("period_error", point.period_error)?;
        dict.set_item("parameter_error", point.parameter_error)?;
        dict.set_item("intervals", point.cycle.mesh.len() - 1)?;
        Ok(dict)
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        ciborium::into_writer(&(FORMAT, &*self.inner), &mut bytes)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let (format, inner): (u32, CycleBranch) =
            ciborium::from_reader(bytes).map_err(|error| {
                PyValueError::new_err(format!("these bytes are no periodic orbits: {error}"))
            })?;
        if format != FORMAT {
            let what = format!("the orbits have format {format}, this version reads {FORMAT}");
            return Err(PyValueError::new_err(what));
        }
        if !is_sound(&inner) {
            return Err(PyValueError::new_err("the branch contradicts itself"));
        }
        Ok(RawOrbits { inner: Arc::new(inner) })
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let py = slf.py();
        Ok((slf.getattr("from_bytes")?, (slf.get().to_bytes(py)?,)))
    }
}

impl RawOrbits {
    fn point_at(&self, index: usize) -> PyResult<&CyclePoint> {
        self.inner.cycles.get(index).ok_or_else(|| {
            let count = self.inner.cycles.len();
            PyIndexError::new_err(format!("point {index} of a branch of {count} points"))
        })
    }
}

/// Whether indices and lengths of orbits from bytes fit together.
fn is_sound(all: &CycleBranch) -> bool {
    let (points, events) = (all.branch.points.len(), all.branch.events.len());
    let whole = |point: &CyclePoint| {
        let (n, cycle) = (point.cycle.dim(), &point.cycle);
        n > 0
            && cycle.mesh.len() > 1
            && cycle.values.len() == n * cycle.degree * (cycle.mesh.len() - 1)
            && (2..=7).contains(&cycle.degree)
    };
    all.cycles.len() == points
        && all.event_errors.len() == events
        && all.cycles.iter().all(whole)
        && all.branch.events.iter().all(|event| event.point < points)
        && all.branch.points.iter().all(|point| {
            point.observables.len() == all.branch.observables.len()
                && point.event.is_none_or(|event| event < events)
        })
}

/// Where a branch of cycles begins.
enum From<'b> {
    Equilibria(&'b continuation::Branch),
    Cycles(&'b CycleBranch),
}

/// The cycles that leave a Hopf point of a branch of equilibria, or a period doubling or branch point of a
/// branch of cycles.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn follow_orbits(
    py: Python<'_>,
    engine_of: &Engine,
    branch: Option<&RawBranch>,
    orbits: Option<&RawOrbits>,
    event: usize,
    way: (usize, bool),
    cycles: &Bound<'_, PyAny>,
    settings: &Bound<'_, PyAny>,
    watches: &Bound<'_, PyAny>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Outcome<RawOrbits>> {
    let (direction, forward) = way;
    let Request { settings, watches } = request(settings, watches)?;
    let cycles: CycleSettings = pythonize::depythonize(cycles)
        .map_err(|error| PyValueError::new_err(format!("the settings: {error}")))?;
    let from = match (branch, orbits) {
        (_, Some(orbits)) => From::Cycles(&orbits.inner),
        (Some(branch), None) => From::Equilibria(&branch.inner),
        (None, None) => return Err(PyValueError::new_err("no branch to begin from")),
    };
    let (found, failure) = engine_of.run(py, move |problem| {
        let mut observer = |at: &continuation::Progress| report(problem, progress.as_ref(), at);
        let (parameter, small) = match from {
            From::Equilibria(branch) => {
                let event = event_of(branch, event)?;
                let small = SmallCycle::at_hopf(problem, branch, event, &cycles);
                (&branch.parameter, small.map_err(engine)?)
            }
            From::Cycles(orbits) => {
                let event = event_of(&orbits.branch, event)?;
                let small = if event.kind == EventKind::BranchPoint {
                    SmallCycle::at_branch_point(problem, orbits, event, direction, forward, &cycles)
                } else {
                    SmallCycle::at_doubling(problem, orbits, event, &cycles)
                };
                (&orbits.branch.parameter, small.map_err(engine)?)
            }
        };
        let mut settings = settings;
        // away from the special point, unless another way was asked for
        settings.increasing = settings.increasing.or(Some(small.increasing));
        let start = &small.cycle;
        trace(problem, parameter, start, &settings, &cycles, &watches, &mut observer)
            .map_err(engine)
    })?;
    Ok((found.map(|inner| RawOrbits { inner: Arc::new(inner) }), failure))
}
