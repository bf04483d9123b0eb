//! Curves of folds.

use super::differences::{Along, Differences, slope_step};
use super::null::Null;
use super::trace::{Curve, trace};
use super::underlying::{CurveError, Underlying};
use super::work::TraceWork;
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Event, EventKind, Point};
use crate::events::Watch;
use crate::linalg::{AnyMatrix, Arrow, Matrix, max_abs};
use crate::modes::{ModeSolver, has_certain_signs};
use crate::name::Name;
use crate::problem::{EvalError, Others, ParamId, Parameter, Problem, SpecialPoints, Stability};
use crate::settings::Settings;
use crate::step::{dot, hessian_inertia};
use crate::tracer::Progress;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Names of the functions whose zeros are cusps and Bogdanov-Takens points.
const TESTS: [&str; 2] = ["cusp", "bogdanov_takens"];
const KINDS: [EventKind; 2] = [EventKind::Cusp, EventKind::BogdanovTakens];
/// Step of the slopes of the tests, in scaled arclength.
const SLOPE: f64 = 1e-4;

/// The folds of a problem in two parameters: `f(u, p, q) = 0`, `g(u, p, q) = 0`, traced in `q`.
///
/// A [`Problem`] with the unknowns `(u, p)`, the last one being `p`; its parameters are those of the
/// original problem but for `p`. Arclength is `ds² = du·M du + (κ dp)² + dq²`, where `κ` is 1 if
/// the problem says that `u` and `p` have a common scale, and the ratio of their ranges on the
/// branch where the fold was found otherwise. Observables are `p` (under its name), those of the
/// original problem, `cusp` = `wᵀf_uu[v, v]`, normalised to be the cosine between `v` and the
/// normal of `g = 0`, and, of a problem `M du/dt = f`, `bogdanov_takens` = `wᵀMv / |w||Mv|`. The
/// number of unstable modes is that of the modes beside the critical one.
///
/// A fold curve does not end at a [cusp](EventKind::Cusp), a
/// [Bogdanov-Takens](EventKind::BogdanovTakens) or a [zero-Hopf](EventKind::ZeroHopf) point; it is
/// traced through. Where it turns in `q` (at cusps, and elsewhere) no event is made of that.
#[derive(Clone)]
pub struct FoldCurve<'a> {
    pub(super) base: Underlying<'a>,
    names: Vec<Name>,
    /// Number of the first test among the observables.
    first_test: usize,
    mass: Option<AnyMatrix>,
    /// The start, `(u, p)`.
    start: Vec<f64>,
    modes: Arc<ModeSolver>,
    work: TraceWork<Work>,
}

/// What is known at the latest state.
#[derive(Clone)]
struct Work {
    /// The state and the parameters of the curve, and for which of them the rest is known.
    at: Vec<f64>,
    level: Level,
    p: Vec<f64>,
    r: Vec<f64>,
    jacobian: AnyMatrix,
    null: Null,
    /// Along the right null vector: for the left one, `p` and `q`.
    differences: Differences,
    g_first: f64,
    g_second: f64,
    scratch: Vec<f64>,
    shifted: Vec<f64>,
    curve_p: Vec<f64>,
    tests: [[f64; 2]; 2],
    slopes: [f64; 2],
    /// The direction of which the slopes are known.
    along: Vec<f64>,
    /// Estimated errors of the tests.
    errors: [f64; 2],
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Nothing,
    Null,
    Gradient,
}

impl<'a> FoldCurve<'a> {
    /// The curve through a fold of `branch` when the parameter `second` varies too.
    ///
    /// # Errors
    /// When the event is no fold of a branch of this problem, or there is no such parameter.
    pub fn at<P: Problem>(
        problem: &'a P,
        branch: &Branch,
        event: &Event,
        second: &str,
    ) -> Result<Self, CurveError> {
        Self::new(Underlying::at(problem, branch, event, second, EventKind::Fold)?)
    }

    /// The curve of limit points of cycles through the state `u` of their equations.
    pub(crate) fn of_cycles(
        problem: &'a DynProblem<'a>,
        parameters: (ParamId, ParamId),
        at: (Vec<f64>, Vec<f64>),
        scales: (f64, f64),
    ) -> Result<Self, CurveError> {
        Self::new(Underlying::of_cycles(problem, parameters, at, scales))
    }

    pub(super) fn new(base: Underlying<'a>) -> Result<Self, CurveError> {
        let (problem, n) = (base.problem, base.problem.dim());
        let dynamics = problem.stability() == Stability::Dynamics;
        let names = base.names(&TESTS[..if dynamics { 2 } else { 1 }]);
        let mut mass = problem.new_jacobian();
        mass.set_zero();
        let mass = problem.mass(&mut mass).then_some(mass);
        let mut start = base.u.clone();
        start.push(base.p[base.first.0]);
        let m = base.parameters.len();
        let mut work = Work {
            at: vec![f64::NAN; n + 1 + m],
            level: Level::Nothing,
            p: base.p.clone(),
            r: vec![0.0; n],
            jacobian: problem.new_jacobian(),
            null: Null::new(n),
            differences: Differences::new(problem, 1, &[base.first, base.second]),
            g_first: 0.0,
            g_second: 0.0,
            scratch: vec![0.0; n],
            shifted: vec![0.0; n + 1],
            curve_p: vec![0.0; m],
            tests: [[0.0; 2]; 2],
            slopes: [0.0; 2],
            along: Vec::with_capacity(2 * n + 4 + m),
            errors: [0.0; 2],
        };
        problem.jacobian(&base.u, &base.p, &mut work.jacobian)?;
        // arbitrary borders become the null vectors
        for _ in 0..4 {
            if !work.null.solve(&mut work.jacobian) {
                return Err(CurveError::NoNullVector);
            }
            work.null.take();
        }
        let modes = Arc::new(ModeSolver::new(problem, 0));
        let first_test = 1 + problem.observables().len();
        let work = TraceWork::new(work);
        Ok(FoldCurve { base, names, first_test, mass, start, modes, work })
    }

    /// The unknowns `(u, p)` at the fold where the curve starts.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// The curve's parameters there: those of the problem but for `p`.
    pub fn start_parameters(&self) -> Vec<f64> {
        self.base.start()
    }

    /// Traces the curve both ways from its start, with cusps, Bogdanov-Takens and zero-Hopf points.
    /// A zero of the test is a cusp only if one of the parameters turns there.
    ///
    /// The settings are those of the second parameter: `domain` bounds it. Bounds of the first one
    /// are watched by its name: `Watch::stop_at("p", 2.0)`.
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

    /// [`FoldCurve::trace`] with the borders of this copy.
    fn follow(
        &self,
        settings: &Settings,
        watches: &[Watch],
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Curve, CurveError> {
        let mut all: Vec<Watch> = watches.to_vec();
        all.extend(self.names[self.first_test..].iter().map(|name| Watch::zero(name)));
        let second = &self.base.parameters[self.base.second_of_curve().0].name;
        let start = (&second[..], &self.start[..], &self.base.start()[..]);
        let mut curve = trace(self, start, settings, &all, observer)?;
        self.confirm_cusps(&mut curve);
        Ok(curve)
    }

    /// Drops zeros of the cusp's test at which neither parameter turns. Where another mode is
    /// critical too the null vector is not unique: the test says nothing, and its sign may change
    /// without a zero.
    fn confirm_cusps(&self, curve: &mut Curve) {
        let n = self.base.problem.dim();
        for index in (0..curve.branch.events.len()).rev() {
            let Event { kind: EventKind::Cusp, point, error_estimate, .. } =
                curve.branch.events[index]
            else {
                continue;
            };
            let points = &curve.branch.points;
            let at = &points[point];
            // neighbours that are apart by more than the error of the location
            let apart = |other: &&Point| (other.s - at.s).abs() > 1e2 * error_estimate;
            let before = points[..point].iter().rev().find(apart);
            let (Some(before), Some(after)) = (before, points[point + 1..].iter().find(apart))
            else {
                continue;
            };
            let turns = |x: f64, y: f64, z: f64| (x - y) * (z - y) >= 0.0;
            let second = turns(before.p, at.p, after.p);
            if !second && !turns(before.u[n], at.u[n], after.u[n]) {
                curve.forget(index);
            }
        }
    }

    /// Brings `work` to the given level at a state.
    fn bring(
        &self,
        work: &mut Work,
        x: &[f64],
        curve: &[f64],
        level: Level,
    ) -> Result<(), EvalError> {
        let n = self.base.problem.dim();
        let known = work.at[..=n] == *x && work.at[n + 1..] == *curve;
        if known && work.level >= level {
            return Ok(());
        }
        if !known || work.level < Level::Null {
            work.level = Level::Nothing;
            self.base.fill(x[n], curve, &mut work.p);
            self.base.problem.linearise(&x[..n], &work.p, &mut work.r, &mut work.jacobian)?;
            if !work.null.solve(&mut work.jacobian) {
                return Err(EvalError::NotFinite { at: n });
            }
            work.at[..=n].copy_from_slice(x);
            work.at[n + 1..].copy_from_slice(curve);
            work.level = Level::Null;
        }
        if level == Level::Gradient {
            let Work { null, differences, scratch, p, .. } = work;
            let unit = self.base.scales.unknowns / self.base.length(&null.right, scratch);
            let along = Along { u: &null.right, p: 0.0, unit };
            differences.along(self.base.problem, (&x[..n], p), along, &[&null.left])?;
            work.g_first = -dot(&null.left, &differences.derivatives[1]);
            work.g_second = -dot(&null.left, &differences.derivatives[2]);
            work.level = Level::Gradient;
        }
        Ok(())
    }

    /// The tests at a state of which the gradient is known.
    fn tests(&self, work: &mut Work) -> [f64; 2] {
        let Work { null, differences, scratch, g_first, g_second, jacobian, .. } = work;
        let scales = &self.base.scales;
        let row = &differences.derivatives[0];
        let along = scales.unknowns / self.base.length(&null.right, scratch);
        let quadratic = dot(row, &null.right) * along;
        let gradient = dot(row, row).sqrt() * dot(&null.right, &null.right).sqrt() * along;
        let size = gradient.hypot(*g_first * scales.first).hypot(*g_second * scales.second);
        // errors of the differences, and of g itself: rounding of the products with the matrix
        let norms = [&null.left, &null.right].map(|x| dot(x, x).sqrt());
        let by_differences = differences.error * max_abs(row) * norms[1] * along;
        let lengths = norms[0] * norms[1];
        let by_rounding = f64::EPSILON * jacobian.norm() * lengths;
        let error = if size > 0.0 { [by_differences / size, by_rounding / size] } else { [0.0; 2] };
        let cusp = if size > 0.0 { quadratic / size } else { 0.0 };
        let mv = match &self.mass {
            Some(mass) => {
                mass.mul(&null.right, scratch);
                &*scratch
            }
            None => &null.right,
        };
        let norms = (dot(&null.left, &null.left) * dot(mv, mv)).sqrt();
        let takens = dot(&null.left, mv) / norms;
        work.errors = [error[0] + error[1], 8.0 * f64::EPSILON + error[1]];
        [cusp, takens]
    }

    fn tests_at(&self, work: &mut Work, x: &[f64], curve: &[f64]) -> Result<[f64; 2], EvalError> {
        self.bring(work, x, curve, Level::Gradient)?;
        Ok(self.tests(work))
    }

    /// Slopes of both tests along a direction, by differences.
    fn test_slopes(
        &self,
        work: &mut Work,
        (x, curve): (&[f64], &[f64]),
        which: ParamId,
        (dx, dq): (&[f64], f64),
    ) -> Result<(), EvalError> {
        let key = x.iter().chain(curve).chain(dx).chain(std::iter::once(&dq));
        if work.along.iter().eq(key.clone()) {
            return Ok(());
        }
        let step = slope_step(SLOPE, curve[which.0], dq);
        for (side, sign) in [(0, step), (1, -step)] {
            let mut place = std::mem::take(&mut work.shifted);
            let mut p = std::mem::take(&mut work.curve_p);
            place.iter_mut().zip(x).zip(dx).for_each(|((y, x), d)| *y = x + sign * d);
            p.copy_from_slice(curve);
            p[which.0] += sign * dq;
            let tests = self.tests_at(work, &place, &p);
            (work.shifted, work.curve_p) = (place, p);
            work.tests[side] = tests?;
        }
        for k in 0..2 {
            work.slopes[k] = (work.tests[0][k] - work.tests[1][k]) / (2.0 * step);
        }
        work.along.clear();
        work.along.extend(key);
        // what the tests themselves are uncertain by, at the state
        self.tests_at(work, x, curve)?;
        Ok(())
    }
}

impl Problem for FoldCurve<'_> {
    type Jacobian = Arrow<AnyMatrix>;

    fn dim(&self) -> usize {
        self.base.problem.dim() + 1
    }

    fn parameters(&self) -> &[Parameter] {
        &self.base.parameters
    }

    fn new_jacobian(&self) -> Self::Jacobian {
        Arrow::new(self.base.problem.new_jacobian(), 1)
    }

    fn residual(&self, x: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let n = self.base.problem.dim();
        let work = &mut *self.work.get();
        self.bring(work, x, p, Level::Null)?;
        r[..n].copy_from_slice(&work.r);
        r[n] = work.null.g;
        Ok(())
    }

    fn jacobian(&self, x: &[f64], p: &[f64], j: &mut Self::Jacobian) -> Result<(), EvalError> {
        let n = self.base.problem.dim();
        let work = &mut *self.work.get();
        self.bring(work, x, p, Level::Gradient)?;
        let first = self.base.first;
        self.base.problem.parameter_derivative(&x[..n], &work.p, first, j.column_mut(0))?;
        let row = j.row_mut(0).iter_mut().zip(&work.differences.derivatives[0]);
        row.for_each(|(row, d)| *row = -d);
        j.set_corner(0, 0, work.g_first);
        let core = j.core_mut();
        core.set_zero();
        core.axpy(1.0, &work.jacobian);
        Ok(())
    }

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
        out[n] = if which == self.base.second {
            work.g_second
        } else {
            self.other_derivative(work, &x[..n], which)?
        };
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.base.metric(x, y);
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
        let tests = self.tests_at(work, x, p)?;
        out[0] = x[n];
        self.base.problem.observe(&x[..n], &work.p, &mut out[1..self.first_test])?;
        out[self.first_test..].iter_mut().zip(tests).for_each(|(out, test)| *out = test);
        // not from an iterate of Newton's method: its orientation may be another one
        work.renew();
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
        let work = &mut *self.work.get();
        if k == 0 {
            return Ok(Some(dx[n]));
        }
        if let Some(test) = k.checked_sub(self.first_test) {
            self.test_slopes(work, (x, p), which, (dx, dq))?;
            return Ok(Some(work.slopes[test]));
        }
        self.base.fill(x[n], p, &mut work.p);
        work.level = Level::Nothing;
        self.base.own_slope(k - 1, &x[..n], &work.p, which, dx, dq)
    }
}

impl FoldCurve<'_> {
    /// `∂g` by a parameter other than the two of the curve.
    fn other_derivative(
        &self,
        work: &mut Work,
        u: &[f64],
        which: ParamId,
    ) -> Result<f64, EvalError> {
        let Work { null, scratch, shifted, p, .. } = work;
        let n = u.len();
        let unit = 1e-4 * self.base.scales.unknowns / self.base.length(&null.right, scratch);
        let mut slope = 0.0;
        for sign in [1.0, -1.0] {
            let step = sign * unit;
            let place = shifted.iter_mut().zip(u).zip(&null.right);
            place.for_each(|((y, u), v)| *y = u + step * v);
            self.base.problem.parameter_derivative(&shifted[..n], p, which, scratch)?;
            slope -= dot(&null.left, scratch) / (2.0 * step);
        }
        Ok(slope)
    }
}

impl Work {
    /// Adapts the borders to the latest null vectors.
    fn renew(&mut self) {
        if self.level > Level::Nothing && self.null.renew() {
            self.level = Level::Nothing;
        }
    }
}

impl SpecialPoints for FoldCurve<'_> {
    fn others(&self, x: &[f64], p: &[f64]) -> Result<Others, EvalError> {
        let work = &mut *self.work.get();
        self.bring(work, x, p, Level::Null)?;
        let problem = self.base.problem;
        let multipliers = problem.multipliers();
        match problem.stability() {
            Stability::None => return Ok(Others::default()),
            Stability::SeparateHessian => {
                let mut hessian = problem.new_jacobian();
                let inertia = hessian_inertia(problem, &x[..problem.dim()], p, &mut hessian);
                let unstable = inertia.map(|(negative, _)| negative.saturating_sub(multipliers));
                return Ok(Others { unstable, certified: inertia.is_some(), values: Vec::new() });
            }
            Stability::EnergyHessian if work.null.negative.is_some() => {
                let unstable = work.null.negative.map(|n| n.saturating_sub(multipliers));
                return Ok(Others { unstable, certified: true, values: Vec::new() });
            }
            _ => {}
        }
        let Some(spectrum) = self.modes.spectrum(&work.jacobian) else {
            return Ok(Others::default());
        };
        let certified = has_certain_signs(&spectrum, f64::INFINITY);
        let mut values = spectrum.values;
        let size = |v: &(f64, f64)| v.0.hypot(v.1);
        let critical =
            (0..values.len()).min_by(|a, b| size(&values[*a]).total_cmp(&size(&values[*b])));
        if let Some(critical) = critical {
            values.swap_remove(critical);
        }
        let sign = if problem.stability() == Stability::Dynamics { 1.0 } else { -1.0 };
        let unstable = values.iter().filter(|(re, _)| sign * re > 0.0).count();
        let unstable = Some(unstable.saturating_sub(multipliers));
        Ok(Others { unstable, certified, values })
    }

    fn scale(&self) -> Option<f64> {
        Some(self.base.scales.unknowns)
    }

    fn zero(&self, observable: usize) -> Option<EventKind> {
        let test = observable.checked_sub(self.first_test)?;
        KINDS.get(test).cloned()
    }

    fn error(&self, observable: usize) -> f64 {
        let errors = self.work.get().errors;
        let test = observable.checked_sub(self.first_test);
        test.and_then(|test| errors.get(test)).copied().unwrap_or(0.0)
    }

    fn crossing_pair(&self) -> Option<EventKind> {
        Some(EventKind::ZeroHopf)
    }
}
