//! Curves of Hopf points.

use super::differences::{Along, Differences, slope_step};
use super::pair::{LEFT, PairNull, RIGHT};
use super::takens;
use super::trace::{Curve, trace};
use super::underlying::{CurveError, Underlying};
use super::work::TraceWork;
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Event, EventKind, Point};
use crate::events::Watch;
use crate::linalg::{AnyMatrix, Arrow, Matrix};
use crate::modes::{ModeSolver, has_certain_signs};
use crate::name::Name;
use crate::problem::{EvalError, Others, ParamId, Parameter, Problem, SpecialPoints};
use crate::settings::Settings;
use crate::singular::{Extended, Probe, lyapunov_coefficient};
use crate::step::{Weights, dot};
use crate::tracer::Progress;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Name of the frequency among the observables.
const OMEGA: &str = "omega";
/// Name of the function whose zeros are generalised Hopf points: the first Lyapunov coefficient.
const TEST: &str = "generalised_hopf";
/// Frequency, relative to that at the start, at which the curve is taken to end in a
/// Bogdanov-Takens point.
const LAST: f64 = 0.02;
/// Step of the slope of the test, in scaled arclength.
const SLOPE: f64 = 1e-3;
/// Number of eigenvalues sought where there is no full spectrum.
const FEW: usize = 10;

/// The Hopf points of a problem in two parameters: `f(u, p, q) = 0` and `g(u, p, ω, q) = 0`, traced
/// in `q`.
///
/// A [`Problem`] with the unknowns `(u, p, ω)`; its parameters are those of the original problem but
/// for `p`. Arclength is that of a [`FoldCurve`](super::FoldCurve) plus `(κ_ω dω)²`, by which the
/// frequency at the start is as long as the range of the unknowns. Observables are `p`, `omega`,
/// those of the original problem and `generalised_hopf`: the first Lyapunov coefficient with the
/// eigenvector as long as the range of the unknowns, times `ω²/ω₀³`, where `ω₀` is the frequency at
/// the start. The number of unstable modes is that of the modes beside the critical pair.
///
/// The curve ends at [Bogdanov-Takens points](EventKind::BogdanovTakens), where `ω` vanishes.
/// [Zero-Hopf](EventKind::ZeroHopf) and [double-Hopf](EventKind::DoubleHopf) points come from the
/// full spectrum of small dense matrices, else from the eigenvalues nearest to zero, among which
/// pairs of high frequency may be missing.
#[derive(Clone)]
pub struct HopfCurve<'a> {
    pub(super) base: Underlying<'a>,
    names: Vec<Name>,
    /// Index of the test among the observables.
    test: usize,
    /// The start, `(u, p, ω)`.
    start: Vec<f64>,
    /// Length of a unit of `ω` in the metric.
    frequency_metric: f64,
    modes: Arc<ModeSolver>,
    work: TraceWork<Work<'a>>,
}

#[derive(Clone)]
struct Work<'a> {
    /// The state and the parameters of the curve for which the rest is known.
    at: Vec<f64>,
    level: Level,
    p: Vec<f64>,
    r: Vec<f64>,
    jacobian: AnyMatrix,
    pair: PairNull,
    /// Along real and imaginary part of the right vector, for both parts of the left one.
    differences: [Differences; 2],
    /// Derivatives of `Re g` and `Im g` by `u`, `p`, `q` and `ω`.
    by_u: [Vec<f64>; 2],
    by_first: [f64; 2],
    by_second: [f64; 2],
    by_omega: [f64; 2],
    probe: Probe<'a>,
    scratch: Vec<f64>,
    error: f64,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Nothing,
    Null,
    Gradient,
}

impl<'a> HopfCurve<'a> {
    /// The curve through a Hopf point of `branch` when the parameter `second` varies too.
    ///
    /// # Errors
    /// When the event is no Hopf point of a branch of this problem, there is no such parameter, or
    /// the problem's matrix has no complex form.
    pub fn at<P: Problem>(
        problem: &'a P,
        branch: &Branch,
        event: &Event,
        second: &str,
    ) -> Result<Self, CurveError> {
        Self::of(problem, branch, event, second)
    }

    fn of(
        problem: &'a DynProblem<'a>,
        branch: &Branch,
        event: &Event,
        second: &str,
    ) -> Result<Self, CurveError> {
        let mut base = Underlying::at(problem, branch, event, second, EventKind::Hopf)?;
        let n = problem.dim();
        let mut jacobian = problem.new_jacobian();
        problem.jacobian(&base.u, &base.p, &mut jacobian)?;
        let mut pair = PairNull::new(problem).ok_or(CurveError::NoComplexForm)?;
        let modes = Arc::new(ModeSolver::new(problem, 0));
        let omega = match event.hopf() {
            Some(form) => form.frequency,
            None => {
                let all = modes.spectrum(&jacobian).ok_or(CurveError::NoNullVector)?;
                let pairs = all.values.into_iter().filter(|(_, im)| *im > 0.0);
                let near = pairs.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
                near.ok_or(CurveError::NoNullVector)?.1
            }
        };
        for _ in 0..4 {
            if !pair.solve(&jacobian, omega).ok_or(CurveError::NoComplexForm)? {
                return Err(CurveError::NoNullVector);
            }
            pair.take();
        }
        base.widen(pair.larger_part())?;
        let mut names = base.names(&[TEST]);
        names.insert(1, OMEGA.into());
        let mut start = base.u.clone();
        start.extend([base.p[base.first.0], omega]);
        let scales = base.scales;
        let weights = Weights { unknowns: scales.unknowns, parameter: scales.first };
        let parameters = [base.first, base.second];
        let differences = || Differences::new(problem, 2, &parameters);
        let work = Work {
            at: vec![f64::NAN; n + 2 + base.parameters.len()],
            level: Level::Nothing,
            p: base.p.clone(),
            r: vec![0.0; n],
            jacobian,
            pair,
            differences: [differences(), differences()],
            by_u: [vec![0.0; n], vec![0.0; n]],
            by_first: [0.0; 2],
            by_second: [0.0; 2],
            by_omega: [0.0; 2],
            probe: Probe::new(problem, base.first, &base.p, weights),
            scratch: vec![0.0; n],
            error: 0.0,
        };
        Ok(HopfCurve {
            names,
            test: 2 + problem.observables().len(),
            start,
            frequency_metric: scales.unknowns / omega,
            modes,
            work: TraceWork::new(work),
            base,
        })
    }

    /// The unknowns `(u, p, ω)` at the Hopf point where the curve starts.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// The curve's parameters there: those of the problem but for `p`.
    pub fn start_parameters(&self) -> Vec<f64> {
        self.base.start()
    }

    /// Traces the curve both ways from its start, to Bogdanov-Takens points where it has them, with
    /// generalised Hopf, zero-Hopf and double-Hopf points. See [`FoldCurve::trace`].
    ///
    /// [`FoldCurve::trace`]: super::FoldCurve::trace
    ///
    /// # Errors
    /// When the settings are unusable or the curve has no tangent at its start.
    pub fn trace(
        &self,
        settings: &Settings,
        watches: &[Watch],
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Curve, CurveError> {
        self.clone().follow(settings, watches, observer)
    }

    /// [`HopfCurve::trace`] with the borders of this copy.
    fn follow(
        &self,
        settings: &Settings,
        watches: &[Watch],
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Curve, CurveError> {
        let omega = self.start[self.start.len() - 1];
        let mut all: Vec<Watch> = watches.to_vec();
        all.extend([Watch::zero(TEST), Watch::stop_at(OMEGA, LAST * omega)]);
        let second = &self.base.parameters[self.base.second_of_curve().0].name;
        let start = (&second[..], &self.start[..], &self.base.start()[..]);
        let mut curve = trace(self, start, settings, &all, observer)?;
        self.confirm(&mut curve);
        takens::finish(self, &mut curve, LAST * omega);
        Ok(curve)
    }

    /// Drops zeros of the first Lyapunov coefficient on whose sides it is not known to have different
    /// signs, and to be larger: where it tends to zero its errors change sign, and at a pole it does itself.
    fn confirm(&self, curve: &mut Curve) {
        let n = self.base.problem.dim();
        for index in (0..curve.branch.events.len()).rev() {
            let event = &curve.branch.events[index];
            if event.kind != EventKind::GeneralisedHopf {
                continue;
            }
            let points = &curve.branch.points;
            let at = &points[event.point];
            let apart = |other: &&Point| (other.s - at.s).abs() > 1e2 * event.error_estimate;
            let before = points[..event.point].iter().rev().find(apart);
            let after = points[event.point + 1..].iter().find(apart);
            let here = at.observables[self.test].abs();
            let mut signs = [before, after].map(|side| {
                side.map_or(0.0, |side| {
                    let mut p = self.base.start();
                    p[self.base.second_of_curve().0] = side.p;
                    let work = &mut *self.work.get();
                    let value = self.lyapunov(work, &side.u[..n + 2], &p);
                    // a sign that the error allows; beside a pole, as at zero-Hopf points, less than there
                    let known = |l: &f64| l.abs() > 2.0 * work.error && l.abs() > 2.0 * here;
                    value.ok().filter(known).map_or(0.0, f64::signum)
                })
            });
            // at an end of the curve one side has to do
            if before.is_none() && after.is_none() {
                continue;
            }
            if before.is_none() || after.is_none() {
                signs = [signs[0] - signs[1], signs[1] - signs[0]];
            }
            if signs[0] * signs[1] >= 0.0 {
                curve.forget(index);
            }
        }
    }

    fn bring(
        &self,
        work: &mut Work<'a>,
        x: &[f64],
        curve: &[f64],
        level: Level,
    ) -> Result<(), EvalError> {
        let (n, problem) = (self.base.problem.dim(), self.base.problem);
        let omega = x[n + 1];
        let known = work.at[..n + 2] == *x && work.at[n + 2..] == *curve;
        if known && work.level >= level {
            return Ok(());
        }
        if !known || work.level < Level::Null {
            work.level = Level::Nothing;
            self.base.fill(x[n], curve, &mut work.p);
            problem.linearise(&x[..n], &work.p, &mut work.r, &mut work.jacobian)?;
            if !work.pair.solve(&work.jacobian, omega).unwrap_or(false) || omega == 0.0 {
                return Err(EvalError::NotFinite { at: n });
            }
            work.at[..n + 2].copy_from_slice(x);
            work.at[n + 2..].copy_from_slice(curve);
            work.level = Level::Null;
        }
        if level < Level::Gradient {
            return Ok(());
        }
        let Work { pair, differences, p, scratch, by_u, by_first, by_second, .. } = work;
        let length = (0..2).map(|k| self.base.length(&pair.parts[RIGHT + k], scratch).powi(2));
        let unit = self.base.scales.unknowns / length.sum::<f64>().sqrt();
        let (c, d) = (&pair.parts[LEFT], &pair.parts[LEFT + 1]);
        for (k, differences) in differences.iter_mut().enumerate() {
            let along = Along { u: &pair.parts[RIGHT + k], p: 0.0, unit };
            differences.along(problem, (&x[..n], p), along, &[c, d])?;
        }
        let [a, b] = [&differences[0].derivatives, &differences[1].derivatives];
        for k in 0..n {
            by_u[0][k] = -(a[0][k] + b[1][k]);
            by_u[1][k] = -(b[0][k] - a[1][k]);
        }
        for (i, by) in [(2, by_first), (3, by_second)] {
            *by = [-(dot(c, &a[i]) + dot(d, &b[i])), -(dot(c, &b[i]) - dot(d, &a[i]))];
        }
        let [re, im] = pair.product;
        work.by_omega = [-im, re];
        work.level = Level::Gradient;
        Ok(())
    }

    /// The test for generalised Hopf points.
    fn lyapunov(&self, work: &mut Work<'a>, x: &[f64], curve: &[f64]) -> Result<f64, EvalError> {
        let n = self.base.problem.dim();
        self.bring(work, x, curve, Level::Null)?;
        let Work { probe, pair, p, scratch, .. } = work;
        probe.set_parameters(p);
        let z = Extended { u: x[..n].to_vec(), p: x[n] };
        probe.assemble(&z)?;
        let omega = x[n + 1];
        let found = lyapunov_coefficient(probe, &z, omega, &pair.right, &pair.left)?;
        let (value, error) = found.unwrap_or((f64::NAN, f64::NAN));
        // the eigenvector, of Euclidean length 1, in the problem's metric
        let squares = (0..2).map(|k| self.base.length(&pair.parts[RIGHT + k], scratch).powi(2));
        let metric = squares.sum::<f64>() / dot(&pair.right, &pair.right);
        // of order one over the curve: near a Bogdanov-Takens point `l₁` grows without bound
        let start = self.start[n + 1];
        let unit = self.base.scales.unknowns.powi(2) / metric * omega.powi(2) / start.powi(3);
        work.error = error * unit;
        Ok(value * unit)
    }
}

impl Problem for HopfCurve<'_> {
    type Jacobian = Arrow<AnyMatrix>;

    fn dim(&self) -> usize {
        self.base.problem.dim() + 2
    }

    fn parameters(&self) -> &[Parameter] {
        &self.base.parameters
    }

    fn new_jacobian(&self) -> Self::Jacobian {
        Arrow::new(self.base.problem.new_jacobian(), 2)
    }

    fn residual(&self, x: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let n = self.base.problem.dim();
        let work = &mut *self.work.get();
        self.bring(work, x, p, Level::Null)?;
        r[..n].copy_from_slice(&work.r);
        r[n] = work.pair.g[0];
        r[n + 1] = work.pair.g[1] / x[n + 1];
        Ok(())
    }

    fn jacobian(&self, x: &[f64], p: &[f64], j: &mut Self::Jacobian) -> Result<(), EvalError> {
        let n = self.base.problem.dim();
        let omega = x[n + 1];
        let work = &mut *self.work.get();
        self.bring(work, x, p, Level::Gradient)?;
        let first = self.base.first;
        self.base.problem.parameter_derivative(&x[..n], &work.p, first, j.column_mut(0))?;
        j.column_mut(1).fill(0.0);
        for (k, divisor) in [(0, 1.0), (1, omega)] {
            let row = j.row_mut(k).iter_mut().zip(&work.by_u[k]);
            row.for_each(|(row, by)| *row = by / divisor);
            j.set_corner(k, 0, work.by_first[k] / divisor);
        }
        j.set_corner(0, 1, work.by_omega[0]);
        j.set_corner(1, 1, (work.by_omega[1] - work.pair.g[1] / omega) / omega);
        let core = j.core_mut();
        core.set_zero();
        core.axpy(1.0, &work.jacobian);
        Ok(())
    }

    /// For the second parameter; the curve varies no other one.
    fn parameter_derivative(
        &self,
        x: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let n = self.base.problem.dim();
        let which = self.base.original(which);
        let work = &mut *self.work.get();
        self.bring(work, x, p, Level::Gradient)?;
        self.base.problem.parameter_derivative(&x[..n], &work.p, which, &mut out[..n])?;
        let by = if which == self.base.second {
            work.by_second
        } else {
            let step = 1e-4 * self.base.problem.parameters()[which.0].scale.abs();
            let mut sides = [[0.0; 2]; 2];
            for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
                work.p[which.0] += sign * step;
                work.level = Level::Nothing;
                let Work { jacobian, pair, p, .. } = &mut *work;
                self.base.problem.jacobian(&x[..n], p, jacobian)?;
                pair.solve(jacobian, x[n + 1]);
                *side = pair.g;
                work.p[which.0] -= sign * step;
            }
            [0, 1].map(|k| (sides[0][k] - sides[1][k]) / (2.0 * step))
        };
        out[n] = by[0];
        out[n + 1] = by[1] / x[n + 1];
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        let n = self.base.problem.dim();
        self.base.metric(&x[..=n], &mut y[..=n]);
        y[n + 1] = self.frequency_metric.powi(2) * x[n + 1];
    }

    fn unknown_scale(&self, which: ParamId) -> Option<f64> {
        self.base.unknown_scale(which)
    }

    fn special_points(&self) -> Option<&dyn SpecialPoints> {
        Some(self)
    }

    fn observables(&self) -> &[Name] {
        &self.names
    }

    fn observe(&self, x: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let n = self.base.problem.dim();
        let work = &mut *self.work.get();
        out[self.test] = self.lyapunov(work, x, p)?;
        (out[0], out[1]) = (x[n], x[n + 1]);
        self.base.problem.observe(&x[..n], &work.p, &mut out[2..self.test])?;
        // not from an iterate of Newton's method: its orientation may be another one
        if work.level > Level::Nothing && work.pair.renew() {
            work.level = Level::Nothing;
        }
        Ok(())
    }

    fn observable_slope(
        &self,
        k: usize,
        x: &[f64],
        p: &[f64],
        which: ParamId,
        dx: &[f64],
        dq: f64,
    ) -> Result<Option<f64>, EvalError> {
        let n = self.base.problem.dim();
        if k < 2 {
            return Ok(Some(dx[n + k]));
        }
        let work = &mut *self.work.get();
        if k == self.test {
            let mut sides = [0.0; 2];
            let eps = slope_step(SLOPE, p[which.0], dq);
            for (value, step) in sides.iter_mut().zip([eps, -eps]) {
                let place: Vec<f64> = x.iter().zip(dx).map(|(x, d)| x + step * d).collect();
                let mut q = p.to_vec();
                q[which.0] += step * dq;
                *value = self.lyapunov(work, &place, &q)?;
            }
            return Ok(Some((sides[0] - sides[1]) / (2.0 * eps)));
        }
        self.base.fill(x[n], p, &mut work.p);
        work.level = Level::Nothing;
        self.base.own_slope(k - 2, &x[..n], &work.p, which, dx, dq)
    }
}

impl SpecialPoints for HopfCurve<'_> {
    fn others(&self, x: &[f64], p: &[f64]) -> Result<Others, EvalError> {
        let n = self.base.problem.dim();
        let work = &mut *self.work.get();
        self.bring(work, x, p, Level::Null)?;
        let all = self.modes.spectrum(&work.jacobian);
        let certified = all.as_ref().is_some_and(|s| has_certain_signs(s, f64::INFINITY));
        let mut values = all.map(|all| all.values).unwrap_or_else(|| {
            let floor = f64::EPSILON * work.jacobian.norm();
            work.jacobian.factor(floor);
            self.modes.few(self.base.problem, &mut work.jacobian, FEW)
        });
        for sign in [1.0, -1.0] {
            let target = sign * x[n + 1];
            let away = |v: &(f64, f64)| v.0.hypot(v.1 - target);
            let order = |a: &usize, b: &usize| away(&values[*a]).total_cmp(&away(&values[*b]));
            if let Some(critical) = (0..values.len()).min_by(order) {
                values.swap_remove(critical);
            }
        }
        let unstable = Some(values.iter().filter(|(re, _)| *re > 0.0).count());
        Ok(Others { unstable, certified, values })
    }

    fn scale(&self) -> Option<f64> {
        Some(self.base.scales.unknowns)
    }

    fn zero(&self, observable: usize) -> Option<EventKind> {
        (observable == self.test).then_some(EventKind::GeneralisedHopf)
    }

    fn error(&self, observable: usize) -> f64 {
        if observable == self.test { self.work.get().error } else { 0.0 }
    }

    fn crossing_pair(&self) -> Option<EventKind> {
        Some(EventKind::DoubleHopf)
    }

    fn crossing_zero(&self) -> Option<EventKind> {
        Some(EventKind::ZeroHopf)
    }
}
