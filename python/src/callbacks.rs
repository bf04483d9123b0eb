//! Calls of the user's Python functions, and what becomes of their results and exceptions.

use crate::storage::Storage;
use continuation::linalg::Matrix;
use continuation::{EvalError, ParamId};
use numpy::{
    PyArray1, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray1, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

pyo3::create_exception!(
    _arclen,
    OutsidePattern,
    PyValueError,
    "The Jacobian has an entry outside its pattern; `args` are its rows and columns."
);

/// The user's functions.
pub(crate) struct Callbacks {
    pub(crate) f: Py<PyAny>,
    /// Calls `jac` and gives a dense array, or the data, rows and column starts of a sparse one.
    pub(crate) jac: Option<Py<PyAny>>,
    pub(crate) slope: Option<Py<PyAny>>,
    pub(crate) observe: Vec<(String, Py<PyAny>)>,
}

/// Calls from one computation. The first exception ends it: every later call is refused.
pub(crate) struct Calls {
    callbacks: Arc<Callbacks>,
    failure: Mutex<Option<PyErr>>,
    aborted: AtomicBool,
}

impl Calls {
    pub(crate) fn new(callbacks: Arc<Callbacks>) -> Self {
        Calls { callbacks, failure: Mutex::default(), aborted: AtomicBool::new(false) }
    }

    /// Whether a call has ended the computation.
    pub(crate) fn is_aborted(&self) -> bool {
        self.aborted.load(Ordering::Acquire)
    }

    /// The exception that ended the computation.
    pub(crate) fn take_failure(&self) -> Option<PyErr> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Does something with the interpreter; an exception ends the computation.
    pub(crate) fn attached<T>(
        &self,
        work: impl FnOnce(Python<'_>, &Callbacks) -> PyResult<T>,
    ) -> Result<T, EvalError> {
        if self.is_aborted() {
            return Err(EvalError::Aborted);
        }
        let done = Python::attach(|py| {
            // Ctrl-C is answered here where a function runs no Python code of its own
            py.check_signals()?;
            work(py, &self.callbacks)
        });
        done.map_err(|error| {
            self.failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            self.aborted.store(true, Ordering::Release);
            EvalError::Aborted
        })
    }

    pub(crate) fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        self.attached(|py, callbacks| {
            let value = callbacks.f.bind(py).call1((vector(py, u)?, vector(py, p)?))?;
            read_vector("f", &value, r)
        })
    }

    /// Calls `jac`, if there is one.
    pub(crate) fn jacobian(
        &self,
        u: &[f64],
        p: &[f64],
        j: &mut Storage,
    ) -> Option<Result<(), EvalError>> {
        let _ = self.callbacks.jac.as_ref()?;
        j.set_zero();
        Some(self.attached(|py, callbacks| {
            let Some(jac) = &callbacks.jac else { return Ok(()) };
            let value = jac.bind(py).call1((vector(py, u)?, vector(py, p)?))?;
            read_matrix(&value, j)
        }))
    }

    /// Calls `parameter_derivative`, if there is one.
    pub(crate) fn slope(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Option<Result<(), EvalError>> {
        let _ = self.callbacks.slope.as_ref()?;
        Some(self.attached(|py, callbacks| {
            let Some(slope) = &callbacks.slope else { return Ok(()) };
            let value = slope.bind(py).call1((vector(py, u)?, vector(py, p)?, which.0))?;
            read_vector("parameter_derivative", &value, out)
        }))
    }

    pub(crate) fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        if self.callbacks.observe.is_empty() {
            return Ok(());
        }
        self.attached(|py, callbacks| {
            let (u, p) = (vector(py, u)?, vector(py, p)?);
            for (out, (name, observable)) in out.iter_mut().zip(&callbacks.observe) {
                let value = observable.bind(py).call1((&u, &p))?;
                *out = value.extract::<f64>().map_err(|_| {
                    let got = kind(&value);
                    PyTypeError::new_err(format!(
                        "observe[{name:?}] must return a number, it returned {got}"
                    ))
                })?;
            }
            Ok(())
        })
    }
}

/// A new array, which its receiver may keep but not change: the engine's state is not the user's to write.
fn vector<'py>(py: Python<'py>, x: &[f64]) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let array = PyArray1::from_slice(py, x);
    array.readwrite().make_nonwriteable();
    Ok(array)
}

/// The name of an object's type, for messages.
fn kind(value: &Bound<'_, PyAny>) -> String {
    let name = value.get_type().qualname();
    name.map_or_else(|_| "an object".to_owned(), |name| name.to_string())
}

/// Reads what a function returned as a vector of the length of `out`.
fn read_vector(what: &str, value: &Bound<'_, PyAny>, out: &mut [f64]) -> PyResult<()> {
    let n = out.len();
    if let Ok(array) = value.cast::<PyArray1<f64>>() {
        return copy(what, &array.readonly(), out);
    }
    if value.is_none() {
        return Err(PyTypeError::new_err(format!(
            "{what} returned None; it must return an array of {n} numbers"
        )));
    }
    let numpy = value.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (value,)).map_err(|error| {
        PyTypeError::new_err(format!("{what} must return an array of {n} numbers: {error}"))
    })?;
    let Ok(untyped) = array.cast::<numpy::PyUntypedArray>() else {
        return Err(PyTypeError::new_err(format!("{what} returned {}, no array", kind(value))));
    };
    check_real(what, untyped)?;
    let shape = untyped.shape().to_vec();
    if shape.is_empty() && n == 1 {
        out[0] = array.call_method0("item")?.extract()?;
        return Ok(());
    }
    if shape != [n] {
        return Err(PyValueError::new_err(format!(
            "{what} returned an array of shape {}, expected ({n},)",
            tuple(&shape)
        )));
    }
    let array = array.call_method1("astype", ("float64",))?;
    match array.cast::<PyArray1<f64>>() {
        Ok(array) => copy(what, &array.readonly(), out),
        Err(_) => Err(PyTypeError::new_err(format!("{what} returned no array of numbers"))),
    }
}

fn copy(what: &str, array: &PyReadonlyArray1<'_, f64>, out: &mut [f64]) -> PyResult<()> {
    let (n, got) = (out.len(), array.len());
    if got != n {
        return Err(PyValueError::new_err(format!(
            "{what} returned an array of shape ({got},), expected ({n},)"
        )));
    }
    match array.as_slice() {
        Ok(values) => out.copy_from_slice(values),
        Err(_) => out.iter_mut().zip(array.as_array()).for_each(|(out, value)| *out = *value),
    }
    Ok(())
}

/// Floats of 64 bits and integers; single precision would never converge.
fn check_real(what: &str, array: &Bound<'_, numpy::PyUntypedArray>) -> PyResult<()> {
    let dtype = array.dtype();
    if dtype.kind() == b'f' && dtype.itemsize() == 8 || matches!(dtype.kind(), b'i' | b'u') {
        return Ok(());
    }
    Err(PyTypeError::new_err(format!("{what} returned dtype {dtype}; arclen needs float64")))
}

fn tuple(shape: &[usize]) -> String {
    let list: Vec<String> = shape.iter().map(usize::to_string).collect();
    if let [one] = &list[..] { format!("({one},)") } else { format!("({})", list.join(", ")) }
}

/// Reads what the Python side made of the user's Jacobian.
fn read_matrix(value: &Bound<'_, PyAny>, j: &mut Storage) -> PyResult<()> {
    if let Ok(array) = value.cast::<numpy::PyArray2<f64>>() {
        return read_dense(&array.readonly(), j);
    }
    let (data, rows, starts) = value.extract::<(
        PyReadonlyArray1<'_, f64>,
        PyReadonlyArray1<'_, i64>,
        PyReadonlyArray1<'_, i64>,
    )>()?;
    let (data, rows, starts) = (data.as_slice()?, rows.as_slice()?, starts.as_slice()?);
    let n = j.dim();
    let malformed = || PyValueError::new_err("jac returned a malformed sparse matrix");
    if starts.len() != n + 1 || rows.len() != data.len() {
        return Err(malformed());
    }
    let mut outside = Vec::new();
    for column in 0..n {
        let bounds = (usize::try_from(starts[column]), usize::try_from(starts[column + 1]));
        let (Ok(from), Ok(to)) = bounds else { return Err(malformed()) };
        let (Some(rows), Some(data)) = (rows.get(from..to), data.get(from..to)) else {
            return Err(malformed());
        };
        for (row, value) in rows.iter().zip(data) {
            let row = usize::try_from(*row).map_err(|_| malformed())?;
            if row >= n {
                return Err(malformed());
            }
            if !j.add(row, column, *value) && *value != 0.0 {
                outside.push((row, column));
            }
        }
    }
    refuse(outside)
}

fn read_dense(array: &numpy::PyReadonlyArray2<'_, f64>, j: &mut Storage) -> PyResult<()> {
    let n = j.dim();
    let view = array.as_array();
    if view.dim() != (n, n) {
        let (rows, columns) = view.dim();
        return Err(PyValueError::new_err(format!(
            "jac returned an array of shape ({rows}, {columns}), expected ({n}, {n})"
        )));
    }
    if let Storage::Dense(dense) = j {
        for column in 0..n {
            for (out, value) in dense.column_mut(column).iter_mut().zip(view.column(column)) {
                *out = *value;
            }
        }
        return Ok(());
    }
    let mut outside = Vec::new();
    for ((row, column), value) in view.indexed_iter() {
        if *value != 0.0 && !j.add(row, column, *value) {
            outside.push((row, column));
        }
    }
    refuse(outside)
}

/// The exception of entries that the pattern has no place for.
fn refuse(outside: Vec<(usize, usize)>) -> PyResult<()> {
    if outside.is_empty() {
        return Ok(());
    }
    let (rows, columns): (Vec<usize>, Vec<usize>) = outside.into_iter().unzip();
    Err(OutsidePattern::new_err((rows, columns)))
}
