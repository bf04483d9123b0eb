//! A reference to a problem is a problem, also one to a problem of unknown type:
//! `&dyn Problem<Jacobian = Dense>`.

use crate::name::Name;
use crate::problem::{EvalError, ParamId, Parameter, Problem, SpecialPoints, Stability};

impl<P: Problem + ?Sized> Problem for &P {
    type Jacobian = P::Jacobian;

    fn dim(&self) -> usize {
        (**self).dim()
    }

    fn parameters(&self) -> &[Parameter] {
        (**self).parameters()
    }

    fn new_jacobian(&self) -> Self::Jacobian {
        (**self).new_jacobian()
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        (**self).residual(u, p, r)
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Self::Jacobian) -> Result<(), EvalError> {
        (**self).jacobian(u, p, j)
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        (**self).parameter_derivative(u, p, which, out)
    }

    fn derivative_error(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        du: &[f64],
        dp: f64,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        (**self).derivative_error(u, p, which, du, dp, out)
    }

    fn linearise(
        &self,
        u: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut Self::Jacobian,
    ) -> Result<(), EvalError> {
        (**self).linearise(u, p, r, j)
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        (**self).metric(x, y);
    }

    fn unknown_scale(&self, which: ParamId) -> Option<f64> {
        (**self).unknown_scale(which)
    }

    fn stability(&self) -> Stability {
        (**self).stability()
    }

    fn mass(&self, m: &mut Self::Jacobian) -> bool {
        (**self).mass(m)
    }

    fn energy_hessian(
        &self,
        u: &[f64],
        p: &[f64],
        h: &mut Self::Jacobian,
    ) -> Result<(), EvalError> {
        (**self).energy_hessian(u, p, h)
    }

    fn multipliers(&self) -> usize {
        (**self).multipliers()
    }

    fn special_points(&self) -> Option<&dyn SpecialPoints> {
        (**self).special_points()
    }

    fn observables(&self) -> &[Name] {
        (**self).observables()
    }

    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        (**self).observe(u, p, out)
    }

    fn observable_slope(
        &self,
        k: usize,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        du: &[f64],
        dp: f64,
    ) -> Result<Option<f64>, EvalError> {
        (**self).observable_slope(k, u, p, which, du, dp)
    }
}
