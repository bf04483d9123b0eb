//! A problem in other units.

use continuation::linalg::Matrix;
use continuation::{EvalError, ParamId, Parameter, Problem, Stability};

/// `a f(u/b, p/c)`, one `c` for each parameter, the last one for all that follow.
pub(crate) struct Scaled<P> {
    inner: P,
    a: f64,
    b: f64,
    c: Vec<f64>,
    parameters: Vec<Parameter>,
}

impl<P: Problem> Scaled<P> {
    pub(crate) fn new(inner: P, a: f64, b: f64, c: &[f64]) -> Self {
        let last = c[c.len() - 1];
        let c: Vec<f64> =
            (0..inner.parameters().len()).map(|k| c.get(k).copied().unwrap_or(last)).collect();
        let scaled = inner.parameters().iter().zip(&c);
        let parameters =
            scaled.map(|(q, c)| Parameter { scale: c * q.scale, ..q.clone() }).collect();
        Scaled { inner, a, b, c, parameters }
    }

    fn unscaled(&self, u: &[f64], p: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let p = p.iter().zip(&self.c).map(|(x, c)| x / c).collect();
        (u.iter().map(|x| x / self.b).collect(), p)
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
        out.iter_mut().for_each(|x| *x *= self.a / self.c[which.0]);
        Ok(())
    }
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.inner.metric(x, y);
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
