//! Corrector: Newton's method on `f(u, p) = 0` bordered by one scalar constraint.
//!
//! One factorisation of the Jacobian per iteration serves the correction, the tangent, the
//! orientation and the inertia. The iteration stops on the size of the correction that is still
//! to come, estimated from the measured quadratic convergence, so that a good step needs no
//! assembly that only confirms.

mod chords;
mod nearly_singular;
mod noise;

use super::stability::StabilityCount;
use super::{Guard, Refusal, State, Weights};
use crate::any_problem::{DynProblem, Held};
use crate::branch::Statistics;
use crate::linalg::{AnyMatrix, Bordered, BorderedFacts, max_abs};
use crate::problem::{EvalError, ParamId, check_finite, check_pattern};
use crate::settings::Settings;
use crate::singular::{Extended, Probe, arbitrary};
use crate::suspect::{WrongDerivative, wrong_derivative};

/// The scalar equation that closes the system.
#[derive(Clone, Copy)]
pub(crate) enum Constraint<'s> {
    /// The plane normal to the tangent of a state, at this scaled arclength from it.
    Plane(&'s State, f64),
    /// The parameter takes this value; the state orients the tangent.
    Parameter(&'s State, f64),
}

/// How well the corrector must know where it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Precision {
    /// The solution is converged; tangent and inertia belong to a state within 1e-4 of it.
    Step,
    /// The tangent too belongs to the converged solution.
    Event,
    /// As [`Precision::Event`], for a place that does not depend on the tangent: where factorisations are
    /// dear it may be corrected by a difference.
    Place,
    /// As [`Precision::Step`], for a look at the branch: neither stability nor observables.
    Look,
}

/// What a correction did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corrected {
    /// Scaled length of the first correction.
    pub(crate) first: f64,
    /// Largest ratio of successive corrections.
    pub(crate) contraction: f64,
    /// Scaled length of the last correction.
    pub(crate) last: f64,
}

/// Corrections that shrink by less may be noise.
const SLOW: f64 = 0.2;
/// A residual below this part of its terms is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// A tangent along which the residual changes by this many times what the parameter changes is steep.
const STEEP: f64 = 1e2;

/// The parameter's part of the tangent, in its scale, below which tangent and counts are those of the
/// state, not of the iterate before it.
const STANDS_STILL: f64 = 1e-6;

/// The problem, its matrices and all work space of the tracer.
pub(crate) struct Core<'a> {
    pub(crate) problem: Held<'a>,
    pub(crate) which: ParamId,
    pub(crate) weights: Weights,
    guard: Guard,
    pub(crate) statistics: Statistics,
    /// Which observables' slopes are wanted.
    pub(crate) wanted: Vec<bool>,
    tolerance: f64,
    max_iterations: usize,
    p: Vec<f64>,
    jacobian: AnyMatrix,
    bordered: Bordered,
    facts: Option<BorderedFacts>,
    stability: StabilityCount,
    r: Vec<f64>,
    pub(super) du: Vec<f64>,
    pub(super) mdu: Vec<f64>,
    shifted: [Vec<f64>; 2],
    observed: [Vec<f64>; 2],
}

/// The scale of the parameter at the start of a curve of special points, of which no range is
/// expected: the value that it has there, or what is typical of it where that is nearly zero.
pub(crate) fn curve_scale(problem: &DynProblem<'_>, which: ParamId, start: f64) -> f64 {
    let typical = problem.parameters()[which.0].scale.abs();
    if start.abs() > 1e-6 * typical { start.abs() } else { typical }
}

impl<'a> Core<'a> {
    pub(crate) fn new(
        problem: impl Into<Held<'a>>,
        which: ParamId,
        p: &[f64],
        weights: Weights,
        settings: &Settings,
    ) -> Self {
        let problem = problem.into();
        let n = problem.dim();
        let m = problem.observables().len();
        Core {
            which,
            weights,
            guard: Guard::new(settings.domain),
            statistics: Statistics::default(),
            wanted: vec![false; m],
            tolerance: settings.tolerance,
            max_iterations: settings.max_iterations,
            p: p.to_vec(),
            jacobian: problem.new_jacobian(),
            bordered: Bordered::new(n, 1),
            facts: None,
            stability: StabilityCount::new(&*problem, settings.eigenvalues, settings.counting),
            r: vec![0.0; n],
            du: vec![0.0; n],
            mdu: vec![0.0; n],
            shifted: [vec![0.0; n], vec![0.0; n]],
            observed: [vec![0.0; m], vec![0.0; m]],
            problem,
        }
    }

    /// Residual at a state, largest component.
    pub(crate) fn residual(&mut self, x: &State) -> Result<f64, EvalError> {
        self.p[self.which.0] = self.guard.admit(x.p)?;
        self.problem.residual(&x.u, &self.p, &mut self.r)?;
        Ok(self.r.iter().fold(0.0, |m, v| m.max(v.abs())))
    }

    fn assemble(&mut self, u: &[f64], p: f64) -> Result<(), EvalError> {
        self.p[self.which.0] = self.guard.admit(p)?;
        self.statistics.newton_iterations += 1;
        self.problem.linearise(u, &self.p, &mut self.r, &mut self.jacobian)?;
        check_pattern(&self.jacobian)?;
        let column = self.bordered.column_mut(0);
        self.problem.parameter_derivative(u, &self.p, self.which, column)?;
        check_finite(&self.r)?;
        check_finite(self.bordered.column_mut(0))
    }

    fn border(&mut self, constraint: Constraint<'_>) {
        let w = self.weights;
        match constraint {
            Constraint::Plane(base, _) => {
                let factor = 1.0 / (w.unknowns * w.unknowns);
                for (c, m) in self.bordered.row_mut(0).iter_mut().zip(&base.mtu) {
                    *c = factor * m;
                }
                self.bordered.set_corner(0, 0, base.tp / (w.parameter * w.parameter));
            }
            Constraint::Parameter(..) => {
                self.bordered.row_mut(0).fill(0.0);
                self.bordered.set_corner(0, 0, 1.0);
            }
        }
    }

    /// Corrects `x.u`, `x.p` onto the branch and computes the tangent, observables and
    /// stability there.
    pub(crate) fn correct(
        &mut self,
        constraint: Constraint<'_>,
        x: &mut State,
        precision: Precision,
    ) -> Result<Corrected, Refusal> {
        let w = self.weights;
        self.problem.metric(&x.u, &mut self.mdu);
        let size = 1.0 + w.norm(&self.mdu, &x.u, x.p);
        let (converged, near) = (self.tolerance * size, 1e-4 * size);
        let mut report = Corrected { first: 0.0, contraction: 0.0, last: f64::INFINITY };
        for iteration in 0..self.max_iterations {
            self.assemble(&x.u, x.p).map_err(Refusal::Evaluation)?;
            self.border(constraint);
            let facts = self.bordered.factor(&mut self.jacobian);
            self.facts = Some(facts);
            let rounding = self.residual_is_rounding(x);
            let mut g = [self.miss(constraint, x)];
            self.du.copy_from_slice(&self.r);
            self.bordered.solve(&mut self.jacobian, &mut self.du, &mut g);
            self.problem.metric(&self.du, &mut self.mdu);
            let correction = w.norm(&self.mdu, &self.du, g[0]);
            if !correction.is_finite() || !self.du.iter().all(|x| x.is_finite()) {
                crate::newton::finite_rows(&self.jacobian, &mut self.mdu)
                    .map_err(Refusal::Evaluation)?;
                return Err(Refusal::Singular);
            }
            for (u, du) in x.u.iter_mut().zip(&self.du) {
                *u -= du;
            }
            x.p -= g[0];
            if let Constraint::Parameter(_, value) = constraint {
                x.p = value;
            }
            let mut expected = correction;
            // corrections that no longer shrink, of a residual that is rounding
            let mut stagnant =
                rounding && iteration > 1 && correction > 0.5 * report.last && correction <= near;
            if iteration == 0 {
                report.first = correction;
            } else {
                let ratio = correction / report.last;
                if correction > converged && !stagnant && ratio > SLOW {
                    stagnant = correction <= near && self.is_noise(constraint, x, correction);
                }
                if correction > converged && !stagnant {
                    report.contraction = report.contraction.max(ratio);
                    // later ratios of a converging iteration are smaller still
                    if ratio > 0.5 && iteration > 1 || ratio > 2.0 {
                        return Err(Refusal::Contraction { contraction: ratio });
                    }
                }
                // quadratic convergence: what the next correction would be
                expected = (correction * ratio * ratio * 100.0).min(correction);
            }
            report.last = correction;
            let done = match precision {
                Precision::Step | Precision::Look => expected <= converged && correction <= near,
                // tangents of a nearly singular state magnify what a first correction left
                Precision::Event | Precision::Place => {
                    correction <= 3.0 * converged && iteration > 0
                }
            };
            if done || stagnant {
                self.finish(constraint, x, precision)?;
                return Ok(report);
            }
            if precision != Precision::Event && self.follow_up(constraint, x, size, &mut report) {
                self.complete(x, precision)?;
                if let Constraint::Plane(base, _) = constraint
                    && Self::is_near_change(base, x)
                {
                    self.assemble(&x.u, x.p).map_err(Refusal::Evaluation)?;
                    self.facts = Some(self.bordered.factor(&mut self.jacobian));
                    self.finish(constraint, x, precision)?;
                }
                return Ok(report);
            }
        }
        Err(Refusal::Contraction { contraction: report.contraction })
    }

    /// Whether the assembled residual is no more than the rounding errors of its terms. Where the
    /// unknowns vanish, nothing else says how small a correction can become.
    fn residual_is_rounding(&self, x: &State) -> bool {
        let terms = self.bordered.core_norm() * max_abs(&x.u)
            + max_abs(self.bordered.column(0)) * x.p.abs();
        max_abs(&self.r) <= ROUNDING * terms
    }

    /// Tangent, orientation, stability and observables from the latest factors.
    fn finish(
        &mut self,
        constraint: Constraint<'_>,
        x: &mut State,
        precision: Precision,
    ) -> Result<(), Refusal> {
        if let Constraint::Parameter(base, _) = constraint {
            self.border(Constraint::Plane(base, 0.0));
            self.facts = Some(self.bordered.factor(&mut self.jacobian));
        }
        self.solve_tangent(x);
        self.normalise(x)?;
        if x.tp.abs() < STANDS_STILL * self.weights.parameter {
            // the last correction may be all there is of the parameter: factors of the state itself
            self.assemble(&x.u, x.p).map_err(Refusal::Evaluation)?;
            self.facts = Some(self.bordered.factor(&mut self.jacobian));
            self.solve_tangent(x);
        }
        self.complete(x, precision)
    }

    /// The tangent from the latest factors, of any length.
    fn solve_tangent(&mut self, x: &mut State) {
        x.tu.fill(0.0);
        let mut g = [1.0];
        self.bordered.solve(&mut self.jacobian, &mut x.tu, &mut g);
        x.tp = g[0];
    }

    /// Everything at `x` that follows from its tangent, which need not be normalised yet.
    fn complete(&mut self, x: &mut State, precision: Precision) -> Result<(), Refusal> {
        self.normalise(x)?;
        if precision == Precision::Look {
            return Ok(());
        }
        if self.stability.wants_eigenvalues() {
            self.assemble(&x.u, x.p).map_err(Refusal::Evaluation)?;
            self.facts = Some(self.bordered.factor(&mut self.jacobian));
        }
        let Some(facts) = self.facts else { return Err(Refusal::Singular) };
        x.orientation = facts.det_sign.unwrap_or(0);
        let at = (self.which, &mut self.p[..]);
        self.stability.judge(&*self.problem, &mut self.jacobian, facts.core.inertia, at, x);
        self.observe(x).map_err(Refusal::Evaluation)
    }

    fn normalise(&mut self, x: &mut State) -> Result<(), Refusal> {
        self.problem.metric(&x.tu, &mut x.mtu);
        let norm = self.weights.norm(&x.mtu, &x.tu, x.tp);
        if !(norm.is_finite() && norm > 0.0) {
            return Err(Refusal::Singular);
        }
        x.length = (super::dot(&x.mtu, &x.tu) + x.tp * x.tp).max(0.0).sqrt();
        x.slopes.fill(0.0);
        x.scale_tangent(1.0 / norm);
        Ok(())
    }

    /// Observables and their slopes along the tangent.
    fn observe(&mut self, x: &mut State) -> Result<(), EvalError> {
        if x.values.is_empty() {
            return Ok(());
        }
        self.p[self.which.0] = self.guard.admit(x.p)?;
        self.problem.observe(&x.u, &self.p, &mut x.values)?;
        let mut differences = false;
        for k in (0..x.values.len()).filter(|&k| self.wanted[k]) {
            let slope = self.problem.observable_slope(k, &x.u, &self.p, self.which, &x.tu, x.tp)?;
            x.slopes[k] = slope.unwrap_or(f64::NAN);
            differences |= slope.is_none();
        }
        if !differences {
            return Ok(());
        }
        // central differences for the observables without a slope of their own
        let h = 1e-6;
        for (side, sign) in [(0, 1.0), (1, -1.0)] {
            for i in 0..x.u.len() {
                self.shifted[side][i] = x.u[i] + sign * h * x.tu[i];
            }
            self.p[self.which.0] = self.guard.nearest(x.p + sign * h * x.tp);
            self.problem.observe(&self.shifted[side], &self.p, &mut self.observed[side])?;
        }
        for k in (0..x.values.len()).filter(|&k| self.wanted[k]) {
            if x.slopes[k].is_nan() {
                x.slopes[k] = (self.observed[0][k] - self.observed[1][k]) / (2.0 * h);
            }
        }
        Ok(())
    }

    /// The first state: `x.u` solves `f(u, x.p) = 0`; computes its tangent, the parameter
    /// increasing or not, and the weights: `range` is how far the parameter is expected to go.
    pub(crate) fn start(
        &mut self,
        x: &mut State,
        increasing: bool,
        range: f64,
    ) -> Result<(), Refusal> {
        self.assemble(&x.u, x.p).map_err(Refusal::Evaluation)?;
        let sign = if increasing { 1.0 } else { -1.0 };
        // any border that is not orthogonal to the tangent serves: the parameter first, and
        // where the start is a fold, the direction that this solve returns, or no particular one
        for corner in [1.0, 0.0] {
            let mut rhs = [1.0];
            for (i, c) in self.bordered.row_mut(0).iter_mut().enumerate() {
                *c = if corner == 0.0 { arbitrary(1, i) } else { 0.0 };
            }
            self.bordered.set_corner(0, 0, corner);
            self.bordered.factor(&mut self.jacobian);
            x.tu.fill(0.0);
            self.bordered.solve(&mut self.jacobian, &mut x.tu, &mut rhs);
            x.tp = rhs[0];
            let size = max_abs(&x.tu).max(x.tp.abs());
            if size.is_finite() && size > 0.0 {
                x.tu.iter_mut().for_each(|t| *t /= size);
                x.tp /= size;
                break;
            }
        }
        self.problem.metric(&x.tu, &mut x.mtu);
        self.weights = self.weigh(x, range);
        self.normalise(x)?;
        x.scale_tangent(sign);
        let base = x.clone();
        self.border(Constraint::Plane(&base, 0.0));
        self.facts = Some(self.bordered.factor(&mut self.jacobian));
        self.solve_tangent(x);
        self.complete(x, Precision::Event)
    }

    /// Weights at the start, where the tangent has any length: what the problem says, else how far
    /// the unknowns move along the tangent while the parameter passes its range, or the size that they
    /// have.
    fn weigh(&mut self, x: &State, range: f64) -> Weights {
        if let Some(scale) = self.problem.unknown_scale(self.which) {
            return Weights { unknowns: scale, parameter: scale };
        }
        if let Some(curve) = self.problem.special_points() {
            let parameter = curve_scale(&*self.problem, self.which, x.p);
            if let Some(unknowns) = curve.scale() {
                return Weights { unknowns, parameter };
            }
            if let Some(fallback) = curve.fallback_scale() {
                // a curve whose unknowns move is measured by the range that is asked for
                let reach = self.reach(x, range);
                if reach.is_finite() && reach > 1e-8 * fallback {
                    return Weights { unknowns: reach, parameter: range };
                }
                return Weights { unknowns: fallback, parameter };
            }
        }
        self.problem.metric(&x.u, &mut self.mdu);
        let size = super::dot(&self.mdu, &x.u).max(0.0).sqrt();
        let reach = self.reach(x, range);
        // a tangent along the parameter but for rounding says nothing
        let along = if reach > 1e-8 * size { reach } else { 0.0 };
        let unknowns = [along, size, 1.0].into_iter().find(|x| x.is_finite() && *x > 0.0);
        Weights { unknowns: unknowns.unwrap_or(1.0), parameter: range }
    }

    /// Weights where nothing is known of a tangent.
    pub(crate) fn weigh_without_tangent(&mut self, x: &State, range: f64) {
        self.problem.metric(&x.u, &mut self.mdu);
        let size = super::dot(&self.mdu, &x.u).max(0.0).sqrt();
        let size = if size > 0.0 && size.is_finite() { size } else { 1.0 };
        self.weights = match self.problem.unknown_scale(self.which) {
            Some(scale) => Weights { unknowns: scale, parameter: scale },
            None => Weights { unknowns: size, parameter: range },
        };
    }

    /// Weights of a start whose tangent is known, and its tangent in them.
    pub(crate) fn weigh_anew(&mut self, x: &mut State, range: f64) -> Result<(), Refusal> {
        self.weights = self.weigh(x, range);
        self.normalise(x)
    }

    /// How far the unknowns move along the tangent while the parameter passes its range, but not so
    /// far that the residual changes much more on that way than the parameter changes it: beside a
    /// fold, where the tangent is steep, the branch bends long before.
    fn reach(&mut self, x: &State, range: f64) -> f64 {
        let norm = super::dot(&x.mtu, &x.tu).max(0.0).sqrt();
        let along = norm / x.tp.abs() * range;
        let mut reach = if along.is_finite() { along } else { f64::MAX.sqrt() };
        let by_parameter = max_abs(self.bordered.column(0)) * range;
        if !(norm > 0.0 && by_parameter > 0.0) {
            return along;
        }
        self.p[self.which.0] = x.p;
        for k in 0..2000 {
            let place = &mut self.shifted[0];
            for ((place, u), t) in place.iter_mut().zip(&x.u).zip(&x.tu) {
                *place = u + reach / norm * t;
            }
            let value = self.problem.residual(place, &self.p, &mut self.du);
            let change = value.map_or(f64::INFINITY, |()| max_abs(&self.du));
            let most = if k == 0 { STEEP } else { 2.0 };
            if change <= most * by_parameter || reach <= f64::MIN_POSITIVE {
                return reach;
            }
            reach *= 0.5;
        }
        along
    }

    /// How far a state of a curve of special points is from one where two of them meet.
    pub(crate) fn separation(&mut self, x: &State) -> Result<Option<f64>, Refusal> {
        let Some(curve) = self.problem.special_points() else { return Ok(None) };
        self.p[self.which.0] = x.p;
        curve.separation(&x.u, &self.p).map_err(Refusal::Evaluation)
    }

    /// The derivative that is not that of the residual at `x`, if there is one beyond doubt.
    pub(crate) fn wrong_derivative(&mut self, x: &State) -> Option<WrongDerivative> {
        self.p[self.which.0] = x.p;
        let guard = self.guard;
        wrong_derivative(&*self.problem, self.which, (&x.u, &self.p), guard, self.weights.unknowns)
    }

    /// What the count of unstable modes remembers of the latest state.
    pub(crate) fn counted(&self) -> usize {
        self.stability.last
    }

    /// Sets what it remembers.
    pub(crate) fn set_counted(&mut self, last: usize) {
        self.stability.last = last;
    }

    /// Asks for the slopes of these observables from now on, and at `x` at once.
    pub(crate) fn want(
        &mut self,
        observables: impl Iterator<Item = usize>,
        x: &mut State,
    ) -> Result<(), EvalError> {
        for k in observables {
            self.wanted[k] = true;
        }
        self.observe(x)
    }

    /// For the analysis of a special point near by.
    pub(crate) fn probe(&self) -> Probe<'a> {
        Probe::new(self.problem.clone(), self.which, &self.p, self.weights).within(self.guard)
    }

    /// Makes `x` the state at `z` with this tangent; its stability is not judged.
    pub(crate) fn place(
        &mut self,
        x: &mut State,
        z: &Extended,
        tangent: &Extended,
    ) -> Result<(), EvalError> {
        x.u.copy_from_slice(&z.u);
        x.tu.copy_from_slice(&tangent.u);
        (x.p, x.tp) = (z.p, tangent.p);
        if self.normalise(x).is_err() {
            return Err(EvalError::NotFinite { at: 0 });
        }
        x.eigenvalues.clear();
        if self.stability.wants_eigenvalues() {
            self.assemble(&x.u, x.p)?;
            let at = (&x.u[..], &self.p[..]);
            self.stability.eigenvalues(&*self.problem, &mut self.jacobian, at, &mut x.eigenvalues);
        }
        self.observe(x)
    }

    /// The left null vector `ψ` of the Jacobian at a fold, with `ψᵀ F_p = 1`, from the latest
    /// factors.
    pub(crate) fn left_at_fold(&mut self) -> Vec<f64> {
        let mut w = vec![0.0; self.du.len()];
        self.bordered.solve_transpose(&mut self.jacobian, &mut w, &mut [1.0]);
        w
    }

    /// Distance between two states in the scaled metric and the cosines of the angles between
    /// the secant and the tangents at both ends.
    pub(crate) fn secant(&mut self, a: &State, b: &State) -> (f64, f64, f64) {
        for i in 0..a.u.len() {
            self.du[i] = b.u[i] - a.u[i];
        }
        let dp = b.p - a.p;
        self.problem.metric(&self.du, &mut self.mdu);
        let distance = self.weights.norm(&self.mdu, &self.du, dp);
        let at = |x: &State| {
            let along = self.weights.dot(&self.mdu, dp, &x.tu, x.tp);
            if distance > 0.0 { along / distance } else { 1.0 }
        };
        (distance, at(a), at(b))
    }

    /// How far the latest factors say that `x` is from the branch in a plane, in the scaled metric.
    pub(super) fn distance_from_branch(
        &mut self,
        constraint: Constraint<'_>,
        x: &State,
    ) -> Result<f64, Refusal> {
        Ok(self.correction(constraint, x)?.0)
    }

    /// The correction that the latest factors make, in `du`: its scaled length, and its parameter's part.
    fn correction(&mut self, constraint: Constraint<'_>, x: &State) -> Result<(f64, f64), Refusal> {
        self.residual(x).map_err(Refusal::Evaluation)?;
        self.du.copy_from_slice(&self.r);
        let mut g = [self.miss(constraint, x)];
        self.bordered.solve(&mut self.jacobian, &mut self.du, &mut g);
        self.problem.metric(&self.du, &mut self.mdu);
        Ok((self.weights.norm(&self.mdu, &self.du, g[0]), g[0]))
    }

    /// What the constraint still misses at `x`.
    fn miss(&self, constraint: Constraint<'_>, x: &State) -> f64 {
        let w = self.weights;
        match constraint {
            Constraint::Plane(base, distance) => {
                let du = x.u.iter().zip(&base.u).zip(&base.mtu);
                let along: f64 = du.map(|((u, u0), m)| (u - u0) * m).sum();
                along / (w.unknowns * w.unknowns)
                    + base.tp * (x.p - base.p) / (w.parameter * w.parameter)
                    - distance
            }
            Constraint::Parameter(_, value) => x.p - value,
        }
    }

    /// Length of `u - u0` in the problem's metric.
    pub(crate) fn excursion(&mut self, u: &[f64], u0: &[f64]) -> f64 {
        for i in 0..u.len() {
            self.du[i] = u[i] - u0[i];
        }
        self.problem.metric(&self.du, &mut self.mdu);
        super::dot(&self.mdu, &self.du).max(0.0).sqrt()
    }
}
