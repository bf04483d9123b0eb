//! A problem of unknown type: the engine is compiled for it once, in this package.

use crate::linalg::AnyMatrix;
use crate::name::Name;
use crate::problem::{EvalError, ParamId, Parameter, Problem, SpecialPoints, Stability};
use std::ops::Deref;
use std::sync::Arc;

/// What a [`Problem`] does, whatever its matrices are.
pub(crate) trait AnyProblem: Send + Sync {
    fn dim(&self) -> usize;
    fn parameters(&self) -> &[Parameter];
    fn new_jacobian(&self) -> AnyMatrix;
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError>;
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut AnyMatrix) -> Result<(), EvalError>;
    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError>;
    fn derivative_error(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        du: &[f64],
        dp: f64,
        out: &mut [f64],
    ) -> Result<(), EvalError>;
    fn linearise(
        &self,
        u: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut AnyMatrix,
    ) -> Result<(), EvalError>;
    fn metric(&self, x: &[f64], y: &mut [f64]);
    fn unknown_scale(&self, which: ParamId) -> Option<f64>;
    fn stability(&self) -> Stability;
    fn mass(&self, m: &mut AnyMatrix) -> bool;
    fn energy_hessian(&self, u: &[f64], p: &[f64], h: &mut AnyMatrix) -> Result<(), EvalError>;
    fn multipliers(&self) -> usize;
    fn special_points(&self) -> Option<&dyn SpecialPoints>;
    fn observables(&self) -> &[Name];
    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError>;
    fn observable_slope(
        &self,
        k: usize,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        du: &[f64],
        dp: f64,
    ) -> Result<Option<f64>, EvalError>;
}

/// A problem of unknown type.
pub(crate) type DynProblem<'a> = dyn AnyProblem + 'a;

/// A problem that somebody else keeps, or one that is kept here.
#[derive(Clone)]
pub(crate) enum Held<'a> {
    /// Of somebody else.
    Borrowed(&'a DynProblem<'a>),
    /// Kept as long as anybody has it.
    Shared(Arc<DynProblem<'a>>),
}

impl<'a> Deref for Held<'a> {
    type Target = DynProblem<'a>;

    fn deref(&self) -> &Self::Target {
        match self {
            Held::Borrowed(problem) => *problem,
            Held::Shared(problem) => &**problem,
        }
    }
}

impl<'a, P: AnyProblem + 'a> From<&'a P> for Held<'a> {
    fn from(problem: &'a P) -> Self {
        Held::Borrowed(problem)
    }
}

impl<'a> From<&'a DynProblem<'a>> for Held<'a> {
    fn from(problem: &'a DynProblem<'a>) -> Self {
        Held::Borrowed(problem)
    }
}

impl<P: Problem> AnyProblem for P {
    fn dim(&self) -> usize {
        Problem::dim(self)
    }

    fn parameters(&self) -> &[Parameter] {
        Problem::parameters(self)
    }

    fn new_jacobian(&self) -> AnyMatrix {
        AnyMatrix::new(Problem::new_jacobian(self))
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        Problem::residual(self, u, p, r)
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut AnyMatrix) -> Result<(), EvalError> {
        Problem::jacobian(self, u, p, j.get_mut())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        Problem::parameter_derivative(self, u, p, which, out)
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
        Problem::derivative_error(self, u, p, which, du, dp, out)
    }

    fn linearise(
        &self,
        u: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut AnyMatrix,
    ) -> Result<(), EvalError> {
        Problem::linearise(self, u, p, r, j.get_mut())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        Problem::metric(self, x, y);
    }

    fn unknown_scale(&self, which: ParamId) -> Option<f64> {
        Problem::unknown_scale(self, which)
    }

    fn stability(&self) -> Stability {
        Problem::stability(self)
    }

    fn mass(&self, m: &mut AnyMatrix) -> bool {
        Problem::mass(self, m.get_mut())
    }

    fn energy_hessian(&self, u: &[f64], p: &[f64], h: &mut AnyMatrix) -> Result<(), EvalError> {
        Problem::energy_hessian(self, u, p, h.get_mut())
    }

    fn multipliers(&self) -> usize {
        Problem::multipliers(self)
    }

    fn special_points(&self) -> Option<&dyn SpecialPoints> {
        Problem::special_points(self)
    }

    fn observables(&self) -> &[Name] {
        Problem::observables(self)
    }

    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        Problem::observe(self, u, p, out)
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
        Problem::observable_slope(self, k, u, p, which, du, dp)
    }
}
