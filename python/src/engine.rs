//! The engine as methods: every one releases the interpreter's lock and takes it back for callbacks.

use crate::branch::RawBranch;
use crate::problem::{Spec, UserProblem};
use continuation::codim2::{BranchPointCurve, CurveError, FoldCurve, HopfCurve};
use continuation::deflation::{Deflation, DeflationSettings, disconnected_observed};
use continuation::diagram::{DiagramSettings, Explorer};
use continuation::{
    Branch, Event, EventKind, NearSettings, NewtonSettings, Progress, Settings, TraceError, Tracer,
    Watch, both_ways, check_derivatives, modes, near_bifurcations, newton,
};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use pythonize::{depythonize, pythonize};
use std::ops::ControlFlow;

pyo3::create_exception!(
    _arclen,
    EngineError,
    PyValueError,
    "The engine could not do what was asked; the message says why and what to do."
);

/// An error of the engine; those of input are as good as others, for they all say what is wrong.
pub(crate) fn engine(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// What a computation gave, and the exception that ended it.
pub(crate) type Outcome<T> = (Option<T>, Option<PyErr>);

/// What a trace is told by the Python side.
pub(crate) struct Request {
    pub(crate) settings: Settings,
    pub(crate) watches: Vec<Watch>,
}

pub(crate) fn request(
    settings: &Bound<'_, PyAny>,
    watches: &Bound<'_, PyAny>,
) -> PyResult<Request> {
    let settings = read(settings, "the settings")?;
    Ok(Request { settings, watches: read(watches, "the watches")? })
}

fn read<T: serde::de::DeserializeOwned>(value: &Bound<'_, PyAny>, what: &str) -> PyResult<T> {
    depythonize(value).map_err(|error| PyValueError::new_err(format!("{what}: {error}")))
}

/// A problem with all that can be computed of it. Immutable: several threads may use one at a time.
#[pyclass(frozen, module = "arclen._arclen")]
pub(crate) struct Engine {
    pub(crate) spec: Spec,
}

impl Engine {
    /// Runs `work` without the interpreter's lock.
    pub(crate) fn run<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&UserProblem<'_>) -> Result<T, String> + Send,
    ) -> PyResult<Outcome<T>> {
        let (done, failure) = py.detach(|| {
            let problem = match UserProblem::new(&self.spec) {
                Ok(problem) => problem,
                Err(error) => return (Err(engine(error)), None),
            };
            let done = work(&problem);
            (done, problem.calls.take_failure())
        });
        match (done, failure) {
            (Ok(value), failure) => Ok((Some(value), failure)),
            (Err(_), Some(failure)) => Ok((None, Some(failure))),
            (Err(message), None) => Err(EngineError::new_err(message)),
        }
    }

    fn trace_with(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        work: impl FnOnce(
            &UserProblem<'_>,
            &mut dyn FnMut(&Progress) -> ControlFlow<()>,
        ) -> Result<Branch, String>
        + Send,
    ) -> PyResult<Outcome<RawBranch>> {
        let (branch, failure) = self.run(py, |problem| {
            let mut observer = |at: &Progress| report(problem, progress.as_ref(), at);
            work(problem, &mut observer)
        })?;
        Ok((branch.map(RawBranch::from), failure))
    }
}

/// Tells the user's callback where a trace stands; it may stop it by returning True.
pub(crate) fn report(
    problem: &UserProblem<'_>,
    progress: Option<&Py<PyAny>>,
    at: &Progress,
) -> ControlFlow<()> {
    if problem.calls.is_aborted() {
        return ControlFlow::Break(());
    }
    let Some(progress) = progress else { return ControlFlow::Continue(()) };
    let told = problem.calls.attached(|py, _| {
        let answer = progress.bind(py).call1((at.points, at.events, at.p, at.s))?;
        answer.is_truthy()
    });
    match told {
        Ok(false) => ControlFlow::Continue(()),
        Ok(true) | Err(_) => ControlFlow::Break(()),
    }
}

pub(crate) fn event_of(branch: &Branch, event: usize) -> Result<&Event, String> {
    branch.events.get(event).ok_or_else(|| format!("the branch has no special point {event}"))
}

#[pymethods]
impl Engine {
    #[getter]
    fn storage(&self) -> &'static str {
        self.spec.empty.name()
    }

    /// A branch from a solution near `u`, in one direction.
    #[allow(clippy::too_many_arguments)]
    fn trace(
        &self,
        py: Python<'_>,
        parameter: &str,
        u: Vec<f64>,
        p: Vec<f64>,
        settings: &Bound<'_, PyAny>,
        watches: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Outcome<RawBranch>> {
        let Request { settings, watches } = request(settings, watches)?;
        self.trace_with(py, progress, move |problem, observer| {
            let tracer = Tracer::new(problem, parameter, &u, &p, settings).map_err(engine)?;
            Ok(tracer.watching(&watches).map_err(engine)?.run(observer))
        })
    }

    /// The same in both directions.
    #[allow(clippy::too_many_arguments)]
    fn both_ways(
        &self,
        py: Python<'_>,
        parameter: &str,
        u: Vec<f64>,
        p: Vec<f64>,
        settings: &Bound<'_, PyAny>,
        watches: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Outcome<RawBranch>> {
        let Request { settings, watches } = request(settings, watches)?;
        self.trace_with(py, progress, move |problem, observer| {
            both_ways(problem, parameter, &u, &p, settings, &watches, observer).map_err(engine)
        })
    }

    /// On from a point of a branch.
    fn restart(
        &self,
        py: Python<'_>,
        branch: &RawBranch,
        point: usize,
        settings: &Bound<'_, PyAny>,
        watches: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Outcome<RawBranch>> {
        let Request { settings, watches } = request(settings, watches)?;
        let from = &*branch.inner;
        self.trace_with(py, progress, move |problem, observer| {
            let tracer = Tracer::from_point(problem, from, point, settings).map_err(engine)?;
            Ok(tracer.watching(&watches).map_err(engine)?.run(observer))
        })
    }

    /// A branch that leaves a branch point.
    #[allow(clippy::too_many_arguments)]
    fn leave(
        &self,
        py: Python<'_>,
        branch: &RawBranch,
        event: usize,
        direction: usize,
        forward: bool,
        settings: &Bound<'_, PyAny>,
        watches: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Outcome<RawBranch>> {
        let Request { settings, watches } = request(settings, watches)?;
        let from = &*branch.inner;
        self.trace_with(py, progress, move |problem, observer| {
            let event = event_of(from, event)?;
            let crossing = event.crossing().ok_or_else(|| {
                format!("the {} at {} has no branches that leave it", event.kind, event.p)
            })?;
            let count = crossing.leaving.len();
            let direction = crossing.leaving.get(direction).ok_or_else(|| {
                format!("direction {direction}: {count} branches leave this branch point")
            })?;
            let tracer = Tracer::leaving(problem, from, event, direction, forward, settings);
            let tracer = tracer.and_then(|tracer| tracer.watching(&watches)).map_err(engine)?;
            Ok(tracer.run(observer))
        })
    }

    /// The curve of a fold, Hopf point or branch point in a second parameter.
    #[allow(clippy::too_many_arguments)]
    fn curve(
        &self,
        py: Python<'_>,
        branch: &RawBranch,
        event: usize,
        second: &str,
        settings: &Bound<'_, PyAny>,
        watches: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Outcome<RawBranch>> {
        let Request { settings, watches } = request(settings, watches)?;
        let from = &*branch.inner;
        self.trace_with(py, progress, move |problem, observer| {
            let event = event_of(from, event)?;
            let curve = match event.kind {
                EventKind::Fold => FoldCurve::at(problem, from, event, second)
                    .and_then(|curve| curve.trace(&settings, &watches, observer)),
                EventKind::Hopf => HopfCurve::at(problem, from, event, second)
                    .and_then(|curve| curve.trace(&settings, &watches, observer)),
                EventKind::BranchPoint => BranchPointCurve::at(problem, from, event, second)
                    .and_then(|curve| curve.trace(&settings, &watches, observer)),
                ref kind => {
                    return Err(format!(
                        "a {kind} has no curve: those of folds, Hopf points and branch points do"
                    ));
                }
            };
            curve.map(|curve| curve.branch).map_err(|error: CurveError| engine(error))
        })
    }

    /// A whole diagram.
    #[allow(clippy::too_many_arguments)]
    fn diagram<'py>(
        &self,
        py: Python<'py>,
        parameter: &str,
        u: Vec<f64>,
        p: Vec<f64>,
        settings: &Bound<'_, PyAny>,
        watches: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Outcome<Bound<'py, PyDict>>> {
        let settings: DiagramSettings = read(settings, "the settings")?;
        let watches: Vec<Watch> = read(watches, "the watches")?;
        let (diagram, failure) = self.run(py, move |problem| {
            let explorer = Explorer::new(problem, parameter, &u, &p, settings, &watches);
            let mut explorer = explorer.map_err(engine)?;
            let mut observer = |at: &continuation::diagram::DiagramProgress<'_>| {
                report(problem, progress.as_ref(), &at.at)
            };
            while !problem.calls.is_aborted() {
                if explorer.next_branch(&mut observer).map_err(engine)?.is_none() {
                    break;
                }
            }
            Ok(explorer.finish())
        })?;
        let Some(diagram) = diagram else { return Ok((None, failure)) };
        let dict = PyDict::new(py);
        dict.set_item("is_complete", diagram.is_complete())?;
        dict.set_item("stopped", pythonize(py, &diagram.stopped)?)?;
        dict.set_item("joints", pythonize(py, &diagram.joints)?)?;
        let branches = PyList::empty(py);
        for one in diagram.branches {
            let entry = PyDict::new(py);
            entry.set_item("origin", pythonize(py, &one.origin)?)?;
            entry.set_item("depth", one.depth)?;
            entry.set_item("near", pythonize(py, &one.near)?)?;
            entry.set_item("branch", Bound::new(py, RawBranch::from(one.branch))?)?;
            branches.append(entry)?;
        }
        dict.set_item("branches", branches)?;
        Ok((Some(dict), failure))
    }

    /// A solution at fixed parameters: `(u, iterations, correction)`.
    #[allow(clippy::type_complexity)]
    fn newton<'py>(
        &self,
        py: Python<'py>,
        u: Vec<f64>,
        p: Vec<f64>,
        tolerance: f64,
        max_iterations: usize,
    ) -> PyResult<Outcome<(Bound<'py, PyArray1<f64>>, usize, f64)>> {
        let (found, failure) = self.run(py, move |problem| {
            let mut u = u;
            let settings = NewtonSettings { tolerance, max_iterations };
            let report = newton(problem, &mut u, &p, &settings).map_err(engine)?;
            Ok((u, report))
        })?;
        let found = found
            .map(|(u, report)| (PyArray1::from_vec(py, u), report.iterations, report.correction));
        Ok((found, failure))
    }

    /// Eigenvalues and modes of a state.
    #[allow(clippy::type_complexity)]
    fn modes(
        &self,
        py: Python<'_>,
        u: Vec<f64>,
        p: Vec<f64>,
        count: usize,
    ) -> PyResult<Outcome<(Vec<(f64, f64)>, Vec<Vec<f64>>, bool)>> {
        self.check_lengths(&u, &p)?;
        self.run(py, move |problem| {
            let found = modes(problem, &u, &p, count).map_err(engine)?;
            Ok((found.values, found.vectors, found.certified))
        })
    }

    /// Deviations of the derivatives from differences: jacobian, (row, column), parameters.
    #[allow(clippy::type_complexity)]
    fn check(
        &self,
        py: Python<'_>,
        u: Vec<f64>,
        p: Vec<f64>,
        scale: f64,
    ) -> PyResult<Outcome<(f64, (usize, usize), Vec<f64>)>> {
        self.check_lengths(&u, &p)?;
        self.run(py, move |problem| {
            let found = check_derivatives(problem, &u, &p, scale).map_err(engine)?;
            Ok((found.jacobian, found.at, found.parameters))
        })
    }

    /// Further solutions at the same parameters.
    #[allow(clippy::too_many_arguments, clippy::type_complexity)]
    fn deflate<'py>(
        &self,
        py: Python<'py>,
        p: Vec<f64>,
        known: Vec<Vec<f64>>,
        starts: Vec<Vec<f64>>,
        branches: Vec<Py<RawBranch>>,
        states: usize,
        settings: &Bound<'_, PyAny>,
    ) -> PyResult<Outcome<(Vec<Bound<'py, PyArray1<f64>>>, Bound<'py, PyAny>)>> {
        let settings: DeflationSettings = read(settings, "the settings")?;
        let (found, failure) = self.run(py, move |problem| {
            let mut search = Deflation::new(problem, &p, settings)
                .and_then(|search| search.known(&known))
                .and_then(|search| search.starts(&starts))
                .map_err(engine)?;
            for branch in &branches {
                search = search.along(&branch.get().inner, states).map_err(engine)?;
            }
            Ok(search.run_observed(&mut |_| match problem.calls.is_aborted() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }))
        })?;
        let Some(found) = found else { return Ok((None, failure)) };
        let report = pythonize(py, &found.report)?;
        let solutions = found.solutions.into_iter();
        let solutions = solutions.map(|one| PyArray1::from_vec(py, one.u)).collect();
        Ok((Some((solutions, report)), failure))
    }

    /// Solutions on none of the branches, beside their near-bifurcations and at values of the parameter.
    #[allow(clippy::type_complexity)]
    fn disconnected(
        &self,
        py: Python<'_>,
        branches: Vec<Py<RawBranch>>,
        values: Vec<f64>,
        settings: &Bound<'_, PyAny>,
    ) -> PyResult<Outcome<Vec<(Vec<f64>, Vec<f64>)>>> {
        let settings: DeflationSettings = read(settings, "the settings")?;
        self.run(py, move |problem| {
            let branches: Vec<Branch> =
                branches.iter().map(|branch| (*branch.get().inner).clone()).collect();
            let mut near = Vec::new();
            for branch in &branches {
                let found = near_bifurcations(problem, branch, NearSettings::default());
                near.extend(found.map_err(engine)?);
            }
            let found =
                disconnected_observed(problem, &branches, &near, &values, &settings, &mut |_| {
                    match problem.calls.is_aborted() {
                        true => ControlFlow::Break(()),
                        false => ControlFlow::Continue(()),
                    }
                });
            Ok(found.map_err(engine)?.into_iter().map(|one| (one.u, one.p)).collect())
        })
    }

    /// Bifurcations that a small change of the problem would make.
    fn near<'py>(
        &self,
        py: Python<'py>,
        branch: &RawBranch,
    ) -> PyResult<Outcome<Bound<'py, PyAny>>> {
        let branch = &*branch.inner;
        let (found, failure) = self.run(py, move |problem| {
            near_bifurcations(problem, branch, NearSettings::default()).map_err(engine)
        })?;
        let found = found.map(|found| pythonize(py, &found)).transpose()?;
        Ok((found, failure))
    }
}

impl Engine {
    /// Functions of a state take slices of the right length for granted.
    fn check_lengths(&self, u: &[f64], p: &[f64]) -> PyResult<()> {
        use continuation::linalg::Matrix;
        let (n, m) = (self.spec.empty.dim(), self.spec.parameters.len());
        for (what, got, expected) in [("u", u.len(), n), ("p", p.len(), m)] {
            if got != expected {
                let error = TraceError::Length { what, got, expected };
                return Err(EngineError::new_err(error.to_string()));
            }
        }
        Ok(())
    }
}
