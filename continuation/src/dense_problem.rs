//! A small problem from its residual alone.

use crate::linalg::{Dense, Matrix, max_abs};
use crate::problem::{EvalError, ParamId, Parameter, Problem, Stability};
use std::cell::RefCell;

/// `f(u, p) = 0` with a dense Jacobian taken by differences: for up to some tens of unknowns.
///
/// The differences are central over six points, with a step that is found for each unknown and
/// parameter by comparing steps over many decades, so that neither the unit of `u` nor that of `p`
/// matters: near 1e-13 for smooth `f`. Where `f` varies on much smaller lengths in some places than
/// in others, implement [`Problem`] with derivatives of your own.
///
/// ```
/// use continuation::{DenseProblem, EventKind, Settings, Tracer};
/// use std::ops::ControlFlow;
///
/// // AUTO's demo `ab`: two folds, two Hopf points
/// let ab = DenseProblem::from_residual(2, &["p"], |u, p, r| {
///     let rate = p[0] * (1.0 - u[0]) * u[1].exp();
///     r[0] = -u[0] + rate;
///     r[1] = -u[1] + 18.0 * rate - 3.0 * u[1];
/// });
/// let settings = Settings { target: Some(0.25), ..Settings::default() };
/// let branch = Tracer::new(&ab, "p", &[0.0, 0.0], &[0.0], settings)?
///     .run(&mut |_| ControlFlow::Continue(()));
/// assert_eq!(branch.events_of(&EventKind::Fold).count(), 2);
/// assert_eq!(branch.events_of(&EventKind::Hopf).count(), 2);
/// # Ok::<(), continuation::TraceError>(())
/// ```
pub struct DenseProblem<F> {
    n: usize,
    parameters: Vec<Parameter>,
    stability: Stability,
    f: F,
    names: Vec<&'static str>,
    observables: Vec<Box<Observable>>,
    scratch: RefCell<Scratch>,
}

/// A scalar function of unknowns and parameters.
type Observable = dyn Fn(&[f64], &[f64]) -> f64;

struct Scratch {
    u: Vec<f64>,
    p: Vec<f64>,
    values: [Vec<f64>; 6],
    /// Length over which `f` varies along each unknown and parameter; 0 until it is known.
    lengths: Vec<f64>,
    /// Largest derivative along each so far.
    sizes: Vec<f64>,
    best: Vec<f64>,
}

/// Where the six-point difference evaluates, in steps.
const PLACES: [f64; 6] = [1.0, -1.0, 2.0, -2.0, 3.0, -3.0];
/// Step relative to the length over which `f` varies.
const STEP: f64 = 4e-3;
/// Shortest step relative to the variable itself.
const SHORTEST: f64 = 1e-8;
/// Disagreement of the orders four and six above which the length is sought anew.
const DISAGREEMENT: f64 = 1e-7;
/// Decades beyond the magnitude at hand where a function that is flat there is not asked.
const FARTHEST: i32 = 2;
/// Disagreement that is good enough to stop looking for a better length.
const AGREEMENT: f64 = 1e-9;

impl<F: Fn(&[f64], &[f64], &mut [f64])> DenseProblem<F> {
    /// `n` unknowns, named parameters, and `f(u, p, r)` that writes the residual to `r`; read as
    /// `du/dt = f`, so that eigenvalues with positive real part are unstable. `u` and `r` have length
    /// `n`, `p` that of the names; every entry of `r` is to be written. A state without a value gives
    /// NaN, which the problem reports as an error.
    pub fn from_residual(n: usize, parameters: &[&'static str], f: F) -> Self {
        let parameters: Vec<Parameter> =
            parameters.iter().map(|&name| Parameter { name, unit: "", scale: 1.0 }).collect();
        let scratch = Scratch {
            u: vec![0.0; n],
            p: vec![0.0; parameters.len()],
            values: std::array::from_fn(|_| vec![0.0; n]),
            lengths: vec![0.0; n + parameters.len()],
            sizes: vec![0.0; n + parameters.len()],
            best: vec![0.0; n],
        };
        let scratch = RefCell::new(scratch);
        DenseProblem {
            n,
            parameters,
            stability: Stability::Dynamics,
            f,
            names: Vec::new(),
            observables: Vec::new(),
            scratch,
        }
    }

    /// What the Jacobian's eigenvalues mean, if not [`Stability::Dynamics`].
    #[must_use]
    pub fn with_stability(mut self, stability: Stability) -> Self {
        self.stability = stability;
        self
    }

    /// Adds a scalar function of unknowns and parameters, to be reported at every point and to
    /// be watched ([`crate::Watch`]).
    #[must_use]
    pub fn observing(
        mut self,
        name: &'static str,
        value: impl Fn(&[f64], &[f64]) -> f64 + 'static,
    ) -> Self {
        self.names.push(name);
        self.observables.push(Box::new(value));
        self
    }

    /// A typical magnitude of a parameter ([`Parameter::scale`]), by default 1; without effect if there
    /// is no such parameter.
    #[must_use]
    pub fn with_scale(mut self, which: ParamId, scale: f64) -> Self {
        if let Some(parameter) = self.parameters.get_mut(which.0) {
            parameter.scale = scale;
        }
        self
    }

    /// `∂f` along unknown `i`, or along parameter `i − n`, to `out`.
    fn difference(&self, i: usize, out: &mut [f64]) {
        let mut scratch = self.scratch.borrow_mut();
        let scratch = &mut *scratch;
        let known = scratch.lengths[i];
        if known > 0.0 && self.differ(scratch, i, known, out) <= DISAGREEMENT {
            scratch.sizes[i] = scratch.sizes[i].max(max_abs(out));
            return;
        }
        let here = match i.checked_sub(self.n) {
            None => {
                let (own, all) = (scratch.u[i].abs(), max_abs(&scratch.u));
                // a value that is small beside the others may be rounding
                let own = if own < 1e-6 * all { all } else { own };
                if own < 1e-10 { 0.0 } else { own }
            }
            Some(k) => scratch.p[k].abs().max(self.parameters[k].scale.abs()),
        };
        let here = here.max(known);
        let centre = if here > 0.0 { here } else { 1.0 };
        // lengths ever farther from the magnitude at hand; the one whose orders agree best wins
        let (mut least, mut flat) = (f64::INFINITY, false);
        for k in 0..33 {
            let decades = if k % 2 == 0 { -k / 2 } else { k / 2 + 1 };
            if flat && decades > FARTHEST {
                continue;
            }
            let length = centre * 10f64.powi(decades);
            let error = self.differ(scratch, i, length, out);
            flat |= error == DISAGREEMENT;
            if error < least {
                least = error;
                scratch.lengths[i] = length;
                scratch.best.copy_from_slice(out);
            }
            if least < AGREEMENT {
                break;
            }
        }
        if least.is_finite() {
            out.copy_from_slice(&scratch.best);
            scratch.sizes[i] = scratch.sizes[i].max(max_abs(out));
        }
    }

    /// The difference with a step for a given length, and by how much two orders disagree,
    /// relative to the derivative.
    fn differ(&self, scratch: &mut Scratch, i: usize, length: f64, out: &mut [f64]) -> f64 {
        let Scratch { u, p, values, sizes, .. } = scratch;
        // a power of two: the shifted values differ by exactly the step
        let here = if i < self.n { u[i] } else { p[i - self.n] };
        let h = (STEP * length).max(SHORTEST * here.abs()).log2().round().exp2();
        for (place, value) in PLACES.into_iter().zip(values.iter_mut()) {
            let slot = if i < self.n { &mut u[i] } else { &mut p[i - self.n] };
            let kept = *slot;
            *slot += place * h;
            (self.f)(u, p, value);
            if i < self.n {
                u[i] = kept;
            } else {
                p[i - self.n] = kept;
            }
        }
        let (mut size, mut apart) = (0.0_f64, 0.0_f64);
        for (k, o) in out.iter_mut().enumerate() {
            let d = |m: usize| values[m][k] - values[m + 1][k];
            let fourth = (8.0 * d(0) - d(2)) / (12.0 * h);
            let sixth = (45.0 * d(0) - 9.0 * d(2) + d(4)) / (60.0 * h);
            *o = sixth;
            size = size.max(sixth.abs());
            let difference = (sixth - fourth).abs();
            apart = if difference.is_nan() { f64::INFINITY } else { apart.max(difference) };
        }
        if !apart.is_finite() {
            return f64::INFINITY;
        }
        if size == 0.0 {
            return DISAGREEMENT; // a flat piece, unless a longer step resolves something
        }
        let terms = values.iter().map(|v| max_abs(v)).fold(0.0, f64::max);
        let rounding = f64::EPSILON * terms / h;
        // a derivative that is about to vanish says little for or against the length
        apart.max(rounding) / size.max(1e-2 * sizes[i])
    }

    fn place(&self, u: &[f64], p: &[f64]) {
        let mut scratch = self.scratch.borrow_mut();
        scratch.u.copy_from_slice(u);
        scratch.p.copy_from_slice(p);
    }
}

impl<F: Fn(&[f64], &[f64], &mut [f64])> Problem for DenseProblem<F> {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        self.n
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(self.n)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        (self.f)(u, p, r);
        crate::problem::check_finite(r)
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        self.place(u, p);
        j.set_zero();
        for i in 0..self.n {
            self.difference(i, j.column_mut(i));
            crate::problem::check_finite(j.column(i))?;
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        self.place(u, p);
        self.difference(self.n + which.0, out);
        Ok(())
    }

    fn stability(&self) -> Stability {
        self.stability
    }

    fn observables(&self) -> &[&'static str] {
        &self.names
    }

    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        for (out, observable) in out.iter_mut().zip(&self.observables) {
            *out = observable(u, p);
        }
        Ok(())
    }
}
