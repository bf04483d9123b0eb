//! Small systems `du/dt = f(u, p)` with derivatives written out.

use continuation::linalg::{Dense, Matrix};
use continuation::{EvalError, Name, ParamId, Parameter, Problem, Stability};

/// `N` rates of change and their derivatives.
pub trait System<const N: usize>: Send + Sync {
    /// Names of the unknowns, which are the observables too.
    const UNKNOWNS: &'static [Name];
    /// The parameters.
    const PARAMETERS: &'static [Parameter];
    /// `f(u, p)`.
    fn rates(u: [f64; N], p: &[f64]) -> [f64; N];
    /// `∂f/∂u`, by rows.
    fn by_unknowns(u: [f64; N], p: &[f64]) -> [[f64; N]; N];
    /// `∂f/∂p[which]`.
    fn by_parameter(u: [f64; N], p: &[f64], which: usize) -> [f64; N];
}

/// A [`System`] as a problem: eigenvalues with positive real part are unstable.
#[derive(Debug, Clone, Copy, Default)]
pub struct Ode<S, const N: usize>(pub S);

/// The state as an array.
fn state<const N: usize>(u: &[f64]) -> [f64; N] {
    std::array::from_fn(|i| u[i])
}

fn copy(from: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
    out.copy_from_slice(from);
    match from.iter().position(|x| !x.is_finite()) {
        Some(at) => Err(EvalError::NotFinite { at }),
        None => Ok(()),
    }
}

impl<S: System<N>, const N: usize> Problem for Ode<S, N> {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        N
    }

    fn parameters(&self) -> &[Parameter] {
        S::PARAMETERS
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(N)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        copy(&S::rates(state(u), p), r)
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set_zero();
        for (i, row) in S::by_unknowns(state(u), p).iter().enumerate() {
            for (k, value) in row.iter().enumerate() {
                j.set(i, k, *value);
            }
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
        copy(&S::by_parameter(state(u), p, which.0), out)
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }

    fn observables(&self) -> &[Name] {
        S::UNKNOWNS
    }

    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out.copy_from_slice(u);
        Ok(())
    }

    fn observable_slope(
        &self,
        k: usize,
        _u: &[f64],
        _p: &[f64],
        _which: ParamId,
        du: &[f64],
        _dp: f64,
    ) -> Result<Option<f64>, EvalError> {
        Ok(Some(du[k]))
    }
}
