//! A problem whose residual is a Python function.

use crate::callbacks::{Callbacks, Calls};
use crate::storage::{Storage, assign};
use continuation::linalg::Matrix;
use continuation::{
    BandProblem, BoxedResidual, DenseProblem, EvalError, Name, ParamId, Parameter, Problem,
    SparseProblem, Stability,
};
use std::sync::Arc;

/// Where the parameter is moved to see whether the residual is affine in it, in units of a step: no
/// multiples of each other, so that nothing periodic agrees by chance.
const AFFINE: [f64; 5] = [0.0, -1.0, 1.0, 0.381_966, -0.618_034];

/// What a problem is made of; shared by all computations with it.
pub(crate) struct Spec {
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) observables: Vec<Name>,
    pub(crate) stability: Stability,
    pub(crate) empty: Storage,
    /// Entries of the mass matrix, if it is not the identity.
    pub(crate) mass: Option<Vec<(usize, usize, f64)>>,
    /// Weights of the unknowns in the arclength.
    pub(crate) metric: Option<Vec<f64>>,
    pub(crate) callbacks: Arc<Callbacks>,
}

/// Derivatives by differences of the residual.
enum Differences {
    Dense(DenseProblem<BoxedResidual>),
    Band(BandProblem<BoxedResidual>),
    Sparse(Box<SparseProblem<BoxedResidual>>),
}

impl Differences {
    fn new(spec: &Spec, calls: &Arc<Calls>) -> Result<Self, EvalError> {
        let n = spec.empty.dim();
        let names: Vec<Name> = spec.parameters.iter().map(|one| one.name.clone()).collect();
        let calls = Arc::clone(calls);
        let f: BoxedResidual = Box::new(move |u: &[f64], p: &[f64], r: &mut [f64]| {
            if calls.residual(u, p, r).is_err() {
                r.fill(f64::NAN);
            }
        });
        let scaled = |which: usize| spec.parameters[which].scale;
        if spec.callbacks.jac.is_some() {
            // for the parameters alone
            let mut problem = BandProblem::from_residual(n, (0, 0), &names, f);
            for which in 0..names.len() {
                problem = problem.with_scale(ParamId(which), scaled(which));
            }
            return Ok(Differences::Band(problem));
        }
        Ok(match &spec.empty {
            Storage::Dense(_) => {
                let mut problem = DenseProblem::from_residual(n, &names, f);
                for which in 0..names.len() {
                    problem = problem.with_scale(ParamId(which), scaled(which));
                }
                Differences::Dense(problem)
            }
            Storage::Band(band) => {
                let mut problem = BandProblem::from_residual(n, band.bandwidths(), &names, f);
                for which in 0..names.len() {
                    problem = problem.with_scale(ParamId(which), scaled(which));
                }
                Differences::Band(problem)
            }
            Storage::Sparse(sparse) => {
                let column = |j: usize| sparse.column(j).0.iter().map(move |i| (*i, j));
                let pattern: Vec<(usize, usize)> = (0..n).flat_map(column).collect();
                let mut problem = SparseProblem::from_residual(n, &pattern, &names, f)?;
                for which in 0..names.len() {
                    problem = problem.with_scale(ParamId(which), scaled(which));
                }
                Differences::Sparse(Box::new(problem))
            }
        })
    }
}

macro_rules! each {
    ($self:expr, $problem:pat => $call:expr) => {
        match $self {
            Differences::Dense($problem) => $call,
            Differences::Band($problem) => $call,
            Differences::Sparse($problem) => $call,
        }
    };
}

/// A problem during one computation, on one thread.
pub(crate) struct UserProblem<'s> {
    spec: &'s Spec,
    pub(crate) calls: Arc<Calls>,
    differences: Differences,
}

impl<'s> UserProblem<'s> {
    pub(crate) fn new(spec: &'s Spec) -> Result<Self, EvalError> {
        let calls = Arc::new(Calls::new(Arc::clone(&spec.callbacks)));
        let differences = Differences::new(spec, &calls)?;
        Ok(UserProblem { spec, calls, differences })
    }

    /// `∂f/∂p[which]` where `f` is affine in that parameter to rounding, as most are: five residuals in place
    /// of some forty. Differences over two steps on either side must agree to rounding of the largest
    /// value, so that what is accepted is as good as any difference; `None` otherwise.
    fn affine_slope(&self, u: &[f64], p: &[f64], which: ParamId, out: &mut [f64]) -> Option<()> {
        let n = out.len();
        let h = 0.5 * self.spec.parameters[which.0].scale.max(p[which.0].abs());
        let (mut shifted, mut values) = (p.to_vec(), vec![0.0; 5 * n]);
        let mut largest = 0.0_f64;
        for (step, r) in AFFINE.iter().zip(values.chunks_exact_mut(n)) {
            shifted[which.0] = p[which.0] + step * h;
            self.residual(u, &shifted, r).ok()?;
            largest = r.iter().fold(largest, |m, x| m.max(x.abs()));
        }
        let rounding = 32.0 * f64::EPSILON * largest;
        for row in 0..n {
            let [centre, low, high, near, far] = [0, 1, 2, 3, 4].map(|k| values[k * n + row]);
            let slope = 0.5 * (high - low);
            let bent = (high - 2.0 * centre + low).abs();
            let line = |step: f64, value: f64| (value - centre - step * slope).abs();
            if bent.max(line(AFFINE[3], near)).max(line(AFFINE[4], far)) > rounding {
                return None;
            }
            out[row] = slope / h;
        }
        Some(())
    }

    /// What was computed by differences, unless a call within them ended the computation.
    fn unless_aborted(&self, done: Result<(), EvalError>) -> Result<(), EvalError> {
        if self.calls.is_aborted() { Err(EvalError::Aborted) } else { done }
    }
}

impl Problem for UserProblem<'_> {
    type Jacobian = Storage;

    fn dim(&self) -> usize {
        self.spec.empty.dim()
    }

    fn parameters(&self) -> &[Parameter] {
        &self.spec.parameters
    }

    fn new_jacobian(&self) -> Storage {
        self.spec.empty.clone()
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        self.calls.residual(u, p, r)?;
        match r.iter().position(|x| !x.is_finite()) {
            Some(at) => Err(EvalError::NotFinite { at }),
            None => Ok(()),
        }
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Storage) -> Result<(), EvalError> {
        if let Some(done) = self.calls.jacobian(u, p, j) {
            return done;
        }
        let done = match &self.differences {
            Differences::Dense(problem) => assign(
                j,
                |j| if let Storage::Dense(m) = j { Some(m) } else { None },
                |m| problem.jacobian(u, p, m),
            ),
            Differences::Band(problem) => assign(
                j,
                |j| if let Storage::Band(m) = j { Some(m) } else { None },
                |m| problem.jacobian(u, p, m),
            ),
            Differences::Sparse(problem) => assign(
                j,
                |j| if let Storage::Sparse(m) = j { Some(&mut **m) } else { None },
                |m| problem.jacobian(u, p, m),
            ),
        };
        self.unless_aborted(done)
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        if let Some(done) = self.calls.slope(u, p, which, out) {
            return done;
        }
        if self.affine_slope(u, p, which, out).is_some() {
            return Ok(());
        }
        let done =
            each!(&self.differences, problem => problem.parameter_derivative(u, p, which, out));
        self.unless_aborted(done)
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
        let callbacks = &self.spec.callbacks;
        // what the user computes is exact
        let dp = if callbacks.slope.is_some() { 0.0 } else { dp };
        if callbacks.jac.is_some() && dp == 0.0 {
            out.fill(0.0);
            return Ok(());
        }
        let still = vec![0.0; du.len()];
        let du = if callbacks.jac.is_some() { &still[..] } else { du };
        let done =
            each!(&self.differences, problem => problem.derivative_error(u, p, which, du, dp, out));
        self.unless_aborted(done)
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        match &self.spec.metric {
            Some(weights) => {
                y.iter_mut().zip(x).zip(weights).for_each(|((y, x), weight)| *y = weight * x);
            }
            None => y.copy_from_slice(x),
        }
    }

    fn stability(&self) -> Stability {
        self.spec.stability
    }

    fn mass(&self, m: &mut Storage) -> bool {
        let Some(entries) = &self.spec.mass else { return false };
        for (row, column, value) in entries {
            // the pattern was made to hold them
            m.add(*row, *column, *value);
        }
        true
    }

    fn observables(&self) -> &[Name] {
        &self.spec.observables
    }

    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        self.calls.observe(u, p, out)
    }
}
