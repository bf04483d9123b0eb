//! Small problems with known answers, for examples and tests.

use crate::linalg::{Dense, Matrix, SymmetricBand};
use crate::name::Name;
use crate::names;
use crate::problem::{EvalError, ParamId, Parameter, Problem, Stability};

/// The cusp `μ + λ x − x³ = 0`, read as `dx/dt`.
///
/// Folds at `μ = ±2 (λ/3)^{3/2}`: ±0.384900179460 for λ = 1.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cusp;

static CUSP_PARAMETERS: [Parameter; 2] =
    [Parameter::new("mu", "", 1.0), Parameter::new("lambda", "", 1.0)];

impl Problem for Cusp {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        1
    }

    fn parameters(&self) -> &[Parameter] {
        &CUSP_PARAMETERS
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(1)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r[0] = p[0] + p[1] * u[0] - u[0].powi(3);
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set(0, 0, p[1] - 3.0 * u[0] * u[0]);
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        _p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out[0] = if which.0 == 0 { 1.0 } else { u[0] };
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }

    fn observables(&self) -> &[Name] {
        names!["x"]
    }

    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out[0] = u[0];
        Ok(())
    }
}

/// The Bratu problem `−u″ = λ eᵘ`, `u(0) = u(1) = 0`, by second-order finite differences on `n`
/// interior nodes, multiplied by the spacing (the energy's gradient and Hessian).
///
/// ```
/// use continuation::{EventKind, Settings, Tracer, Watch, samples::Bratu};
/// use std::ops::ControlFlow;
///
/// let (problem, n) = (Bratu::new(99), 99);
/// let settings = Settings { increasing: Some(true), ..Settings::default() };
/// let branch = Tracer::new(&problem, "lambda", &vec![0.0; n], &[0.0], settings)?
///     .watching(&[Watch::stop_at("max_u", 8.0)])?
///     .run(&mut |_| ControlFlow::Continue(()));
/// let fold = branch.events_of(&EventKind::Fold).next().map(|e| e.p);
/// assert!((fold.unwrap() - 3.513_647_903_969).abs() < 1e-11);
/// # Ok::<(), continuation::TraceError>(())
/// ```
///
/// Fold at λ = 3.513830719125 (θ tanh θ = 1) in the limit; 3.513647903969 with 99 interior
/// nodes, 3.5138278698498 with 800.
#[derive(Debug, Clone, Copy)]
pub struct Bratu {
    n: usize,
}

static BRATU_PARAMETERS: [Parameter; 1] = [Parameter::new("lambda", "", 1.0)];

impl Bratu {
    /// With `n ≥ 1` interior nodes.
    pub fn new(n: usize) -> Self {
        Bratu { n: n.max(1) }
    }

    fn spacing(&self) -> f64 {
        1.0 / (self.n as f64 + 1.0)
    }
}

impl Problem for Bratu {
    type Jacobian = SymmetricBand;

    fn dim(&self) -> usize {
        self.n
    }

    fn parameters(&self) -> &[Parameter] {
        &BRATU_PARAMETERS
    }

    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.n, 1)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let h = self.spacing();
        let at = |i: usize| if i == 0 || i > self.n { 0.0 } else { u[i - 1] };
        for i in 1..=self.n {
            r[i - 1] = (2.0 * at(i) - at(i - 1) - at(i + 1)) / h - h * p[0] * at(i).exp();
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        let h = self.spacing();
        j.set_zero();
        for i in 0..self.n {
            let column = j.column_mut(i);
            column[0] = 2.0 / h - h * p[0] * u[i].exp();
            if let Some(below) = column.get_mut(1) {
                *below = -1.0 / h;
            }
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        _p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let h = self.spacing();
        for (o, x) in out.iter_mut().zip(u) {
            *o = -h * x.exp();
        }
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        let h = self.spacing();
        for (y, x) in y.iter_mut().zip(x) {
            *y = h * x;
        }
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    fn observables(&self) -> &[Name] {
        names!["max_u"]
    }

    /// The maximum is at the middle of the interval; between two nodes there, the mean of four
    /// values of the interpolating cubic.
    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let n = self.n;
        out[0] = if n % 2 == 1 {
            u[n / 2]
        } else {
            let at = |i: usize| if i == 0 || i > n { 0.0 } else { u[i - 1] };
            let m = n / 2;
            (9.0 * (at(m) + at(m + 1)) - at(m - 1) - at(m + 2)) / 16.0
        };
        Ok(())
    }

    fn observable_slope(
        &self,
        _k: usize,
        _u: &[f64],
        p: &[f64],
        _which: ParamId,
        du: &[f64],
        _dp: f64,
    ) -> Result<Option<f64>, EvalError> {
        let mut out = [0.0];
        self.observe(du, p, &mut out)?;
        Ok(Some(out[0]))
    }
}
