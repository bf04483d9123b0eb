//! A problem in other units.

use continuation::linalg::Matrix;
use continuation::{EvalError, ParamId, Parameter, Problem, Stability};

/// `a f(u/b, p/c)`.
pub(crate) struct Scaled<P> {
    inner: P,
    a: f64,
    b: f64,
    c: f64,
    parameters: Vec<Parameter>,
}

impl<P: Problem> Scaled<P> {
    pub(crate) fn new(inner: P, a: f64, b: f64, c: f64) -> Self {
        let parameters =
            inner.parameters().iter().map(|q| Parameter { scale: c * q.scale, ..q.clone() });
        let parameters = parameters.collect();
        Scaled { inner, a, b, c, parameters }
    }

    fn unscaled(&self, u: &[f64], p: &[f64]) -> (Vec<f64>, Vec<f64>) {
        (u.iter().map(|x| x / self.b).collect(), p.iter().map(|x| x / self.c).collect())
    }
}

impl<P: Problem> Problem for Scaled<P> {
    type Jacobian = P::Jacobian;
    fn dim(&self) -> usize {
        self.inner.dim()
    }
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn new_jacobian(&self) -> P::Jacobian {
        self.inner.new_jacobian()
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let (u, p) = self.unscaled(u, p);
        self.inner.residual(&u, &p, r)?;
        r.iter_mut().for_each(|r| *r *= self.a);
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut P::Jacobian) -> Result<(), EvalError> {
        let (u, p) = self.unscaled(u, p);
        let mut own = self.inner.new_jacobian();
        self.inner.jacobian(&u, &p, &mut own)?;
        j.set_zero();
        j.axpy(self.a / self.b, &own);
        Ok(())
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let (u, p) = self.unscaled(u, p);
        self.inner.parameter_derivative(&u, &p, which, out)?;
        out.iter_mut().for_each(|x| *x *= self.a / self.c);
        Ok(())
    }
    fn stability(&self) -> Stability {
        self.inner.stability()
    }
}

/// Factors of `f`, `u` and `p`.
pub(crate) const SCALES: [(f64, f64, f64); 8] = [
    (1e12, 1.0, 1.0),
    (1e-12, 1.0, 1.0),
    (1.0, 1e6, 1.0),
    (1.0, 1e-6, 1.0),
    (1.0, 1.0, 1e6),
    (1.0, 1.0, 1e-6),
    (1e-12, 1e6, 1e-6),
    (1e12, 1e-6, 1e6),
];
