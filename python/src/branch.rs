//! A traced branch, as arrays.

use continuation::{Branch, Event, EventKind};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyIndexError, PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use pythonize::pythonize;
use std::sync::Arc;

/// A branch; immutable.
#[pyclass(frozen, module = "arclen._arclen")]
pub(crate) struct RawBranch {
    pub(crate) inner: Arc<Branch>,
}

impl From<Branch> for RawBranch {
    fn from(branch: Branch) -> Self {
        RawBranch { inner: Arc::new(branch) }
    }
}

/// Version of the bytes.
const FORMAT: u32 = 1;

#[pymethods]
impl RawBranch {
    fn __len__(&self) -> usize {
        self.inner.points.len()
    }

    #[getter]
    fn parameter(&self) -> &str {
        &self.inner.parameter
    }

    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.parameters)
    }

    #[getter]
    fn observables(&self) -> Vec<String> {
        self.inner.observables.clone()
    }

    #[getter]
    fn dim(&self) -> usize {
        self.inner.points.first().map_or(0, |point| point.u.len())
    }

    /// A column of numbers.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let column = self.inner.column(name).ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        let array = PyArray1::from_vec(py, column);
        array.readwrite().make_nonwriteable();
        Ok(array)
    }

    /// The unknowns of a point.
    fn u<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_slice(py, &self.point_at(index)?.u))
    }

    /// The unknowns of all points, a row each.
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let all: Vec<f64> = self.inner.points.iter().flat_map(|p| p.u.iter().copied()).collect();
        PyArray1::from_vec(py, all).reshape([self.inner.points.len(), self.dim()])
    }

    /// Everything of a point but its unknowns.
    fn point<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        let point = self.point_at(index)?;
        let dict = PyDict::new(py);
        dict.set_item("s", point.s)?;
        dict.set_item("p", point.p)?;
        dict.set_item("dp_ds", point.dp_ds)?;
        dict.set_item("unstable", point.unstable)?;
        dict.set_item("certified", point.certified)?;
        dict.set_item("eigenvalues", &point.eigenvalues)?;
        dict.set_item("observables", &point.observables)?;
        dict.set_item("event", point.event)?;
        Ok(dict)
    }

    /// The special points, a dictionary each.
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for event in &self.inner.events {
            list.append(event_dict(py, event)?)?;
        }
        Ok(list)
    }

    /// Why it ends at the last point, and why at the first if that is an end: reason and detail.
    #[getter]
    fn stopped(&self) -> ((String, String), Option<(String, String)>) {
        let tell = |stop: &continuation::Stop| (stop.reason.to_string(), stop.detail.clone());
        (tell(&self.inner.stopped), self.inner.began.as_ref().map(tell))
    }

    #[getter]
    fn is_complete(&self) -> bool {
        self.inner.is_complete()
    }

    #[getter]
    fn is_certain(&self) -> bool {
        self.inner.is_certain()
    }

    /// Where special points may be missing: from, to, reason.
    #[getter]
    fn doubts(&self) -> Vec<(f64, f64, String)> {
        self.inner.doubts.iter().map(|d| (d.from, d.to, d.reason.clone())).collect()
    }

    #[getter]
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(pythonize(py, &self.inner.statistics)?)
    }

    fn to_csv(&self) -> PyResult<String> {
        let mut csv = Vec::new();
        self.inner.write_csv(&mut csv)?;
        String::from_utf8(csv).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        ciborium::into_writer(&(FORMAT, &*self.inner), &mut bytes)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let (format, branch): (u32, Branch) = ciborium::from_reader(bytes).map_err(|error| {
            PyValueError::new_err(format!("these bytes are no branch: {error}"))
        })?;
        if format != FORMAT {
            let what = format!("the branch has format {format}, this version reads {FORMAT}");
            return Err(PyValueError::new_err(what));
        }
        if !is_sound(&branch) {
            return Err(PyValueError::new_err("the branch contradicts itself"));
        }
        Ok(branch.into())
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let py = slf.py();
        Ok((slf.getattr("from_bytes")?, (slf.get().to_bytes(py)?,)))
    }
}

impl RawBranch {
    fn point_at(&self, index: usize) -> PyResult<&continuation::Point> {
        self.inner.points.get(index).ok_or_else(|| {
            let count = self.inner.points.len();
            PyIndexError::new_err(format!("point {index} of a branch of {count} points"))
        })
    }
}

/// Whether indices and lengths of a branch from bytes fit together.
fn is_sound(branch: &Branch) -> bool {
    let Some(first) = branch.points.first() else { return branch.events.is_empty() };
    let (points, events) = (branch.points.len(), branch.events.len());
    branch.points.iter().all(|point| {
        point.u.len() == first.u.len()
            && point.observables.len() == branch.observables.len()
            && point.event.is_none_or(|event| event < events)
    }) && branch.events.iter().all(|event| event.point < points)
}

/// The short label of a kind in the tradition of AUTO and MATCONT.
fn label(kind: &EventKind) -> &'static str {
    match kind {
        EventKind::Fold => "LP",
        EventKind::BranchPoint => "BP",
        EventKind::Hopf => "H",
        EventKind::Cusp => "CP",
        EventKind::BogdanovTakens => "BT",
        EventKind::ZeroHopf => "ZH",
        EventKind::GeneralisedHopf => "GH",
        EventKind::DoubleHopf => "HH",
        EventKind::PeriodDoubling => "PD",
        EventKind::NeimarkSacker => "NS",
        EventKind::SingularityInduced => "SIB",
        EventKind::StabilityChange => "SC",
        EventKind::Minimum(_) => "MIN",
        EventKind::Maximum(_) => "MAX",
        // values that the user asked for
        _ => "UZ",
    }
}

fn event_dict<'py>(py: Python<'py>, event: &Event) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("kind", event.kind.to_string())?;
    dict.set_item("label", label(&event.kind))?;
    dict.set_item("point", event.point)?;
    dict.set_item("p", event.p)?;
    dict.set_item("unstable_before", event.unstable_before)?;
    dict.set_item("unstable_after", event.unstable_after)?;
    dict.set_item("residual", event.residual)?;
    dict.set_item("error_estimate", event.error_estimate)?;
    dict.set_item("detail", pythonize(py, &event.detail)?)?;
    let modes = PyList::empty(py);
    for mode in event.critical_modes() {
        modes.append((mode.re, mode.im))?;
    }
    dict.set_item("modes", modes)?;
    Ok(dict)
}
