//! A small problem from its residual alone.

use crate::linalg::{Dense, Matrix};
use crate::problem::{EvalError, ParamId, Parameter, Problem, Stability};
use std::cell::RefCell;

/// `f(u, p) = 0` with a dense Jacobian taken by differences: for up to some tens of unknowns.
///
/// The differences are central over four points, `f' ≈ (8(f₁ − f₋₁) − (f₂ − f₋₂))/(12 h)` with
/// `h` about 1e-3 of the unknown's magnitude: near 1e-12 for smooth `f` of order one. Where `f`
/// varies on much smaller lengths, implement [`Problem`] with derivatives of your own.
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
    scratch: RefCell<Scratch>,
}

struct Scratch {
    u: Vec<f64>,
    p: Vec<f64>,
    values: [Vec<f64>; 4],
}

/// Where the four-point difference evaluates, in steps.
const PLACES: [f64; 4] = [1.0, -1.0, 2.0, -2.0];
/// Step relative to the magnitude.
const STEP: f64 = 1e-3;

impl<F: Fn(&[f64], &[f64], &mut [f64])> DenseProblem<F> {
    /// `n` unknowns, named parameters, and `f(u, p, r)` that writes the residual to `r`; read as
    /// `du/dt = f`, so that eigenvalues with positive real part are unstable.
    pub fn from_residual(n: usize, parameters: &[&'static str], f: F) -> Self {
        let parameters: Vec<Parameter> =
            parameters.iter().map(|&name| Parameter { name, unit: "", scale: 1.0 }).collect();
        let scratch = Scratch {
            u: vec![0.0; n],
            p: vec![0.0; parameters.len()],
            values: std::array::from_fn(|_| vec![0.0; n]),
        };
        let scratch = RefCell::new(scratch);
        DenseProblem { n, parameters, stability: Stability::Dynamics, f, scratch }
    }

    /// What the Jacobian's eigenvalues mean, if not [`Stability::Dynamics`].
    #[must_use]
    pub fn with_stability(mut self, stability: Stability) -> Self {
        self.stability = stability;
        self
    }

    /// A typical magnitude of a parameter.
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
        let Scratch { u, p, values } = &mut *scratch;
        let size = match i.checked_sub(self.n) {
            None => u[i].abs().max(u.iter().fold(0.0, |m, x| m.max(x.abs()))),
            Some(k) => p[k].abs().max(self.parameters[k].scale.abs()),
        };
        // a power of two: the shifted values differ by exactly the step
        let h = (STEP * if size > 0.0 { size } else { 1.0 }).log2().round().exp2();
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
        for (k, o) in out.iter_mut().enumerate() {
            let near = values[0][k] - values[1][k];
            let far = values[2][k] - values[3][k];
            *o = (8.0 * near - far) / (12.0 * h);
        }
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
}
