//! Sweeps whose cases are run one by one, by whoever wants to, and kept in the files of the program.

use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pythonize::pythonize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use study::case::catalogue;
use study::record::CaseRecord;
use study::run::run_sweep;
use study::store::{Store, write_curves, write_events};
use study::sweep::{Shard, Sweep, load};

/// A sweep with all its cases; immutable.
#[pyclass(frozen, module = "arclen._arclen")]
pub(crate) struct RawSweep {
    sweep: Sweep,
}

fn refuse(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

#[pymethods]
impl RawSweep {
    /// The sweep of a file, or a shipped one by its name; of a shard `k/n` its share of the cases.
    #[new]
    #[pyo3(signature = (path, shard = None))]
    fn new(path: PathBuf, shard: Option<&str>) -> PyResult<Self> {
        let shard = match shard {
            None => Shard::ALL,
            Some(text) => text.parse().map_err(|why| refuse(format!("shard={text:?}: {why}")))?,
        };
        let sweep = load(&path, shard, &catalogue()).map_err(refuse)?;
        Ok(RawSweep { sweep })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.sweep.plan.name
    }

    /// What the program appends to the name of a shard's folder.
    #[getter]
    fn suffix(&self) -> String {
        self.sweep.plan.shard.suffix()
    }

    fn __len__(&self) -> usize {
        self.sweep.cases.len()
    }

    /// Keys that vary.
    #[getter]
    fn keys(&self) -> Vec<&str> {
        self.sweep.plan.axes.iter().map(|axis| &*axis.key).collect()
    }

    /// Their values in a case.
    fn values<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        Ok(pythonize(py, &self.sweep.plan.settings(index))?)
    }

    /// Makes the folder, or takes what is in it: the numbers of the cases that are not kept yet.
    fn begin(&self, py: Python<'_>, out: PathBuf) -> PyResult<Vec<usize>> {
        py.detach(|| {
            let (store, kept) = self.kept(&out)?;
            store.begin(!kept.is_empty()).map_err(refuse)?;
            let done: Vec<usize> = kept.iter().map(|one| one.record.case).collect();
            let open = self.sweep.cases.iter().map(|case| case.index);
            Ok(open.filter(|index| !done.contains(index)).collect())
        })
    }

    /// Traces a case and keeps it.
    fn run<'py>(&self, py: Python<'py>, index: usize, out: PathBuf) -> PyResult<Bound<'py, PyAny>> {
        let case = self.sweep.cases.iter().find(|case| case.index == index);
        let case = case.ok_or_else(|| PyIndexError::new_err(format!("no case {index}")))?;
        let record = py.detach(|| {
            let store = Store::check(&out, &self.sweep.plan).map_err(refuse)?;
            let kept = Mutex::new(None);
            let never = AtomicBool::new(false);
            run_sweep(&[case], 1, &never, &|case, outcome| {
                let done = store.keep(case, &outcome).map(|kept| kept.record);
                *kept.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(done);
            })
            .map_err(refuse)?;
            let done = kept.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
            done.ok_or_else(|| refuse("the case was given up"))?.map_err(refuse)
        })?;
        Ok(pythonize(py, &record)?)
    }

    /// The records of all cases that are kept.
    fn records<'py>(&self, py: Python<'py>, out: PathBuf) -> PyResult<Bound<'py, PyAny>> {
        let records: Vec<CaseRecord> = py.detach(|| {
            let (_, kept) = self.kept(&out)?;
            Ok::<_, PyErr>(kept.into_iter().map(|one| one.record).collect())
        })?;
        Ok(pythonize(py, &records)?)
    }

    /// The points, and the special points, of all cases that are kept, as CSV.
    fn tables(&self, py: Python<'_>, out: PathBuf) -> PyResult<(String, String)> {
        py.detach(|| {
            let (_, kept) = self.kept(&out)?;
            let (mut curves, mut events) = (Vec::new(), Vec::new());
            write_curves(&self.sweep.plan, &kept, &mut curves).map_err(refuse)?;
            write_events(&self.sweep.plan, &kept, &mut events).map_err(refuse)?;
            let text = |bytes| String::from_utf8(bytes).map_err(refuse);
            Ok((text(curves)?, text(events)?))
        })
    }
}

impl RawSweep {
    fn kept(&self, out: &Path) -> PyResult<(Store, Vec<study::store::Kept>)> {
        let store = Store::check(out, &self.sweep.plan).map_err(refuse)?;
        let (kept, _) = store.load(&self.sweep.cases).map_err(refuse)?;
        Ok((store, kept))
    }
}
