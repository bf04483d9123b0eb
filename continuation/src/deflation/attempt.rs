//! Deflated Newton's method from one start.
//!
//! With `δ = −J⁻¹f` the plain step, `g = ∇ log m · δ` and `τ = 1/(1 − g)`, the step of Newton's
//! method for `m(u) f(u) = 0` is `τ δ`, by the formula of Sherman and Morrison:
//! ```text
//! (m J + f ∇mᵀ) s = −m f,    s = τ δ:    τ (−m f) + τ f (∇m·δ) = −m f.
//! ```
//! The same formula gives the simplified correction at a trial state, `y = (m₁/m) J⁻¹f₁`,
//! `s̄ = −y − τ δ (∇ log m · y)`, whose length decides on the damping: the natural monotonicity
//! test, invariant under linear transformations of `f`. Where the corrections have become short
//! against the distance to every known solution, the plain method takes over and ends it.

use super::known::Known;
use crate::any_problem::DynProblem;
use crate::linalg::{AnyMatrix, Matrix};
use crate::newton::{self, NewtonSettings};
use crate::problem::{EvalError, check_finite};

/// Why an attempt gave no new solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Failure {
    /// The start, or every step from some state, is outside the problem's domain.
    Inadmissible,
    /// It ended at a known solution.
    Known,
    /// The states left every bound.
    Diverged,
    /// The iterations were used up, or no step reduced the error.
    Stalled,
}

/// How steps are shortened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Damping {
    /// Only where the problem has no value.
    Free,
    /// Until the natural monotonicity test holds.
    Monotone,
}

/// A solution that an attempt found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Converged {
    /// Length of the last correction.
    pub(super) correction: f64,
}

/// Work space of attempts.
pub(super) struct Solver<'a> {
    problem: &'a DynProblem<'a>,
    p: Vec<f64>,
    jacobian: AnyMatrix,
    /// Jacobian assemblies so far.
    pub(super) assemblies: usize,
    pub(super) u: Vec<f64>,
    r: Vec<f64>,
    delta: Vec<f64>,
    trial: Vec<f64>,
    metric: Vec<f64>,
}

/// Steps are no longer than this many lengths that matter.
const LONGEST: f64 = 10.0;
/// States farther from the start than this many lengths that matter are lost.
const LOST: f64 = 1e4;
/// Shortest damping.
const SHORTEST: f64 = 1e-4;
/// A correction that is so small a part of the distance to every known solution leads to a new one.
const APART: f64 = 1e-3;

impl<'a> Solver<'a> {
    pub(super) fn new(problem: &'a DynProblem<'a>, p: &[f64]) -> Self {
        let vector = || vec![0.0; problem.dim()];
        Solver {
            problem,
            p: p.to_vec(),
            jacobian: problem.new_jacobian(),
            assemblies: 0,
            u: vector(),
            r: vector(),
            delta: vector(),
            trial: vector(),
            metric: vector(),
        }
    }

    /// Searches from `start`; the solution is left in `u`. `reach` is a length that matters, `bound`
    /// how far from the start the attempt may go.
    pub(super) fn attempt(
        &mut self,
        known: &mut Known<'a>,
        start: &[f64],
        (reach, bound): (f64, Option<f64>),
        damping: Damping,
        limits: &NewtonSettings,
    ) -> Result<Converged, Failure> {
        self.u.copy_from_slice(start);
        let mut alpha = 1.0_f64;
        let mut longest = 0.0_f64;
        for iteration in 0..limits.max_iterations {
            self.assemble().map_err(|_| Failure::Inadmissible)?;
            self.delta.copy_from_slice(&self.r);
            self.jacobian.solve(&mut self.delta);
            self.delta.iter_mut().for_each(|x| *x = -*x);
            let correction = known.norm(&self.delta);
            if !correction.is_finite() {
                return Err(Failure::Stalled);
            }
            self.problem.metric(&self.delta, &mut self.metric);
            let (log, slope) = known.factor(&self.u, &self.metric);
            if !log.is_finite() {
                return Err(Failure::Known);
            }
            longest = longest.max(correction.min(reach));
            let near = limits.tolerance.sqrt() * longest.max(known.norm(&self.u));
            if correction <= near && (slope.abs() < APART || known.solutions.is_empty()) {
                return self.polish(limits);
            }
            let mut tau = 1.0 / (1.0 - slope);
            let limit = LONGEST * reach / correction;
            if tau.is_nan() || tau.abs() > limit {
                tau = limit.copysign(tau);
            }
            alpha = match damping {
                Damping::Free => 1.0,
                Damping::Monotone => (4.0 * alpha).min(1.0),
            };
            let mut evaluated = false;
            loop {
                for i in 0..self.u.len() {
                    self.trial[i] = self.u[i] + alpha * tau * self.delta[i];
                }
                let value = self
                    .problem
                    .residual(&self.trial, &self.p, &mut self.r)
                    .and_then(|()| check_finite(&self.r));
                if value.is_ok() {
                    evaluated = true;
                    if damping == Damping::Free
                        || self.shorter(
                            known,
                            log,
                            tau,
                            (1.0 - alpha / 4.0) * correction * tau.abs(),
                        )
                    {
                        break;
                    }
                }
                alpha /= 2.0;
                if alpha < SHORTEST {
                    let failure = if evaluated { Failure::Stalled } else { Failure::Inadmissible };
                    return Err(failure);
                }
            }
            std::mem::swap(&mut self.u, &mut self.trial);
            if (bound.is_some() || iteration % 8 == 7)
                && known.distance(&self.u, start) > bound.unwrap_or(LOST * reach)
            {
                return Err(Failure::Diverged);
            }
        }
        Err(Failure::Stalled)
    }

    /// The plain method, from a state so near that it stays.
    fn polish(&mut self, limits: &NewtonSettings) -> Result<Converged, Failure> {
        match newton::solve(self.problem, &mut self.u, &self.p, limits) {
            Ok(report) => {
                self.assemblies += report.iterations;
                Ok(Converged { correction: report.correction })
            }
            Err(_) => Err(Failure::Stalled),
        }
    }

    /// Residual, Jacobian and factors at `u`.
    fn assemble(&mut self) -> Result<(), EvalError> {
        self.assemblies += 1;
        self.problem.linearise(&self.u, &self.p, &mut self.r, &mut self.jacobian)?;
        check_finite(&self.r)?;
        let floor = f64::EPSILON * self.jacobian.norm();
        self.jacobian.factor(floor);
        Ok(())
    }

    /// Whether the simplified correction at the trial state, whose residual is in `r`, is no longer
    /// than `bound`; `log` is that of the factor at `u`.
    fn shorter(&mut self, known: &mut Known<'a>, log: f64, tau: f64, bound: f64) -> bool {
        let (log_trial, _) = known.factor(&self.trial, &self.metric);
        let growth = (log_trial - log).exp();
        self.jacobian.solve(&mut self.r);
        self.r.iter_mut().for_each(|y| *y *= growth);
        self.problem.metric(&self.r, &mut self.metric);
        let (_, along) = known.factor(&self.u, &self.metric);
        for (y, d) in self.r.iter_mut().zip(&self.delta) {
            *y += tau * along * d;
        }
        known.norm(&self.r) <= bound
    }
}
