//! A problem whose unknowns are its observables.

use continuation::{EvalError, ParamId, Parameter, Problem, Stability};

/// The problem `inner` with its unknowns as observables, by these names.
#[derive(Debug, Clone)]
pub struct Components<P> {
    inner: P,
    names: &'static [&'static str],
}

impl<P: Problem> Components<P> {
    /// Names for the first unknowns of `inner`.
    pub fn new(inner: P, names: &'static [&'static str]) -> Self {
        let names = &names[..names.len().min(inner.dim())];
        Components { inner, names }
    }
}

impl<P: Problem> Problem for Components<P> {
    type Jacobian = P::Jacobian;

    fn dim(&self) -> usize {
        self.inner.dim()
    }

    fn parameters(&self) -> &[Parameter] {
        self.inner.parameters()
    }

    fn new_jacobian(&self) -> P::Jacobian {
        self.inner.new_jacobian()
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        self.inner.residual(u, p, r)
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut P::Jacobian) -> Result<(), EvalError> {
        self.inner.jacobian(u, p, j)
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        self.inner.parameter_derivative(u, p, which, out)
    }

    fn linearise(
        &self,
        u: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut P::Jacobian,
    ) -> Result<(), EvalError> {
        self.inner.linearise(u, p, r, j)
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.inner.metric(x, y);
    }

    fn unknown_scale(&self, which: ParamId) -> Option<f64> {
        self.inner.unknown_scale(which)
    }

    fn stability(&self) -> Stability {
        self.inner.stability()
    }

    fn mass(&self, m: &mut P::Jacobian) -> bool {
        self.inner.mass(m)
    }

    fn multipliers(&self) -> usize {
        self.inner.multipliers()
    }

    fn observables(&self) -> &[&'static str] {
        self.names
    }

    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        for (out, u) in out.iter_mut().zip(u) {
            *out = *u;
        }
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
