//! Curves of simple branch points that persist.

use super::differences::{Along, Differences};
use super::trace::{Curve, trace};
use super::underlying::{CurveError, Underlying};
use super::work::TraceWork;
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Event, EventKind, Stop, StopReason};
use crate::events::Watch;
use crate::linalg::{AnyMatrix, Arrow, Bordered, Matrix};
use crate::name::Name;
use crate::problem::{EvalError, Others, ParamId, Parameter, Problem, SpecialPoints};
use crate::settings::Settings;
use crate::step::dot;
use crate::tracer::Progress;
use std::ops::ControlFlow;

/// Names of the residual that remains among the observables, as it is and relative to what the
/// nonlinearity does over the scales of `u` and `p`.
const BETA: &str = "beta";
const UNFOLDING: &str = "unfolding";
/// Relative unfolding at which the curve ends. The branches are then apart by about its root.
const UNFOLDED: f64 = 1e-6;
/// Cosine between borders and null vectors below which the borders are renewed.
const ALIGNED: f64 = 0.9;
/// Rounding of a bilinear form, relative to the largest entry and the lengths of both vectors.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The simple branch points of a problem in two parameters, where they persist, by symmetry say:
/// `f(u, p, q) + βb = 0`, `G₁ = G₂ = 0`, traced in `q`.
///
/// ```text
/// | f_u   b  f_p | |v₁ v₂|   |0  0|
/// | c₁ᵀ   0  γ₁  | |G₁ G₂| = |1  0|
/// | c₂ᵀ   0  γ₂  | |π₁ π₂|   |0  1|
/// ```
/// `[f_u f_p]` has a null space of two dimensions exactly where `G = 0`. A [`Problem`] with the
/// unknowns `(u, β, p)`: in that order each border cures what the core before it lacks, also on
/// a trivial branch, where `f_p = 0`. Where branch points persist, `β` vanishes along the whole curve; where they
/// are destroyed by `q` (a perfect pitchfork by an imperfection), `β` measures by how much, and the
/// curve ends.
///
/// Where two branch points of a symmetric branch meet, the quadratic form on the null space vanishes
/// and the equations have a double root, which determines no state beyond half the digits. No step ends
/// there: the curve goes on behind it, or ends with a step that is too small.
///
/// Observables are `p`, those of the original problem, `beta` and `unfolding`.
#[derive(Clone)]
pub struct BranchPointCurve<'a> {
    base: Underlying<'a>,
    names: Vec<Name>,
    /// The start, `(u, β, p)`.
    start: Vec<f64>,
    /// The bordered matrix there: both halves of the curve begin with the same one.
    at_start: Kernel,
    work: TraceWork<Work>,
}

#[derive(Clone)]
struct Work {
    at: Vec<f64>,
    level: Level,
    p: Vec<f64>,
    r: Vec<f64>,
    jacobian: AnyMatrix,
    kernel: Kernel,
    differences: [Differences; 2],
    scratch: Vec<f64>,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Nothing,
    Null,
    Gradient,
}

/// The bordered matrix and its null vectors. Where the borders were renewed last, `v₁` is the null
/// vector of `f_u`, `π₁ = 0`.
#[derive(Clone)]
struct Kernel {
    bordered: Bordered,
    /// `v_i` and `π_i`.
    right: [Vec<f64>; 2],
    pi: [f64; 2],
    g: [f64; 2],
    left: Vec<f64>,
    /// Cosine and sine of the angle by which the equations `G = 0` are turned: the first one is
    /// then the one that changes along `v₁`.
    turn: [f64; 2],
}

impl Kernel {
    fn new(n: usize) -> Self {
        let arbitrary = crate::singular::arbitrary;
        let mut bordered = Bordered::new(n, 2);
        for k in 0..2 {
            bordered.row_mut(k).iter_mut().enumerate().for_each(|(i, c)| *c = arbitrary(k + 1, i));
            bordered.set_corner(k, 1, arbitrary(k + 1, n));
        }
        bordered.column_mut(0).iter_mut().enumerate().for_each(|(i, b)| *b = arbitrary(3, i));
        let right = [vec![0.0; n], vec![0.0; n]];
        let left = vec![0.0; n];
        Kernel { bordered, right, pi: [0.0; 2], g: [0.0; 2], left, turn: [1.0, 0.0] }
    }

    /// Solves with `f_p` in the last column of the border.
    fn solve<A: Matrix>(&mut self, a: &mut A) -> bool {
        self.bordered.factor(a);
        let mut tail = [1.0, 0.0];
        self.left.fill(0.0);
        self.bordered.solve_transpose(a, &mut self.left, &mut tail);
        for k in 0..2 {
            tail = [0.0; 2];
            tail[k] = 1.0;
            self.right[k].fill(0.0);
            self.bordered.solve(a, &mut self.right[k], &mut tail);
            (self.g[k], self.pi[k]) = (tail[0], tail[1]);
        }
        let all = self.right.iter().flatten().chain(&self.left).chain(&self.pi).chain(&self.g);
        all.copied().all(f64::is_finite)
    }

    /// Takes `G` for zero where it is no more than the rounding of `wᵀAv`: on a stiff problem
    /// nothing else says when it is solved.
    fn drop_rounding(&mut self, a: f64) {
        let length = |x: &[f64]| dot(x, x).sqrt();
        let left = length(&self.left);
        for (g, v) in self.g.iter_mut().zip(&self.right) {
            if g.abs() <= ROUNDING * a * left * length(v) {
                *g = 0.0;
            }
        }
    }

    /// The pair `x`, turned as the equations are.
    fn turned(&self, x: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.turn;
        [c * x[0] + s * x[1], c * x[1] - s * x[0]]
    }
}

impl<'a> BranchPointCurve<'a> {
    /// The curve through a simple branch point of `branch` when the parameter `second` varies too.
    ///
    /// # Errors
    /// When the event is no simple branch point of a branch of this problem, or there is no such
    /// parameter.
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
        let mut base = Underlying::at(problem, branch, event, second, EventKind::BranchPoint)?;
        if event.crossing().is_some_and(|crossing| crossing.multiplicity != 1) {
            return Err(CurveError::NoNullVector);
        }
        if let Some(leaving) = event.crossing().and_then(|crossing| crossing.leaving.first()) {
            base.widen(&leaving.du)?;
        }
        Self::new(base)
    }

    /// The curve of branch points of cycles through the state `u` of their equations.
    pub(crate) fn of_cycles(
        problem: &'a DynProblem<'a>,
        parameters: (ParamId, ParamId),
        at: (Vec<f64>, Vec<f64>),
        scales: (f64, f64),
    ) -> Result<Self, CurveError> {
        Self::new(Underlying::of_cycles(problem, parameters, at, scales))
    }

    fn new(base: Underlying<'a>) -> Result<Self, CurveError> {
        let (problem, n) = (base.problem, base.problem.dim());
        let names = base.names(&[BETA, UNFOLDING]);
        let mut start = base.u.clone();
        start.extend([0.0, base.p[base.first.0]]);
        let parameters = [base.first, base.second];
        let differences = || Differences::new(problem, 1, &parameters);
        let mut work = Work {
            at: vec![f64::NAN; n + 2 + base.parameters.len()],
            level: Level::Nothing,
            p: base.p.clone(),
            r: vec![0.0; n],
            jacobian: problem.new_jacobian(),
            kernel: Kernel::new(n),
            differences: [differences(), differences()],
            scratch: vec![0.0; n],
        };
        problem.jacobian(&base.u, &base.p, &mut work.jacobian)?;
        let column = work.kernel.bordered.column_mut(1);
        problem.parameter_derivative(&base.u, &base.p, base.first, column)?;
        for _ in 0..4 {
            if !work.kernel.solve(&mut work.jacobian) {
                return Err(CurveError::NoNullVector);
            }
            take(&base, &mut work);
        }
        let at_start = work.kernel.clone();
        let mut curve =
            BranchPointCurve { base, names, start, at_start, work: TraceWork::new(work) };
        curve.turn(&mut curve.work.get(), &curve.start, &curve.base.start())?;
        curve.at_start = curve.work.get().kernel.clone();
        Ok(curve)
    }

    /// The unknowns `(u, β, p)` at the branch point where the curve starts.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// The curve's parameters there: those of the problem but for `p`.
    pub fn start_parameters(&self) -> Vec<f64> {
        self.base.start()
    }

    /// Where the trace ends because the branch point does not persist.
    pub(crate) fn bounds() -> [Watch; 2] {
        [UNFOLDED, -UNFOLDED].map(|level| Watch::stop_at(UNFOLDING, level))
    }

    /// Traces the curve both ways from its start, as far as branch points persist; see
    /// [`FoldCurve::trace`](super::FoldCurve::trace).
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

    /// [`BranchPointCurve::trace`] with the borders of this copy.
    fn follow(
        &self,
        settings: &Settings,
        watches: &[Watch],
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Curve, CurveError> {
        let mut all: Vec<Watch> = watches.to_vec();
        all.extend(Self::bounds());
        let second = &self.base.parameters[self.base.second_of_curve().0].name;
        let start = (&second[..], &self.start[..], &self.base.start()[..]);
        let mut curve = trace(self, start, settings, &all, observer)?;
        self.explain(&mut curve);
        Ok(curve)
    }

    /// Says that the branch point does not persist where that is why the curve ends.
    fn explain(&self, curve: &mut Curve) {
        let unfolding = self.names.len() - 1;
        for first in [true, false] {
            let points = &curve.branch.points;
            let Some(point) = (if first { points.first() } else { points.last() }) else { return };
            let unfolded = (point.observables[unfolding].abs() / UNFOLDED - 1.0).abs() < 1e-3;
            let end = if first { &mut curve.first_end } else { &mut curve.branch.stopped };
            if end.reason != StopReason::Target || !unfolded {
                continue;
            }
            let name = &self.base.parameters[self.base.second_of_curve().0].name;
            let beta = point.observables[unfolding - 1];
            let detail = format!(
                "the branch point does not persist: at {name} = {:.10} it is unfolded (β = {beta:.3e})",
                point.p
            );
            *end = Stop { reason: StopReason::Domain, detail };
            if let Some(event) = point.event {
                curve.forget(event);
            }
        }
    }

    fn bring(
        &self,
        work: &mut Work,
        x: &[f64],
        curve: &[f64],
        level: Level,
    ) -> Result<(), EvalError> {
        let (n, problem) = (self.base.problem.dim(), self.base.problem);
        let known = work.at[..n + 2] == *x && work.at[n + 2..] == *curve;
        if known && work.level >= level {
            return Ok(());
        }
        if !known || work.level < Level::Null {
            work.level = Level::Nothing;
            self.base.fill(x[n + 1], curve, &mut work.p);
            problem.linearise(&x[..n], &work.p, &mut work.r, &mut work.jacobian)?;
            let column = work.kernel.bordered.column_mut(1);
            problem.parameter_derivative(&x[..n], &work.p, self.base.first, column)?;
            if !work.kernel.solve(&mut work.jacobian) {
                return Err(EvalError::NotFinite { at: n + 1 });
            }
            work.kernel.drop_rounding(work.jacobian.norm());
            let b = work.kernel.bordered.column(0);
            work.r.iter_mut().zip(b).for_each(|(r, b)| *r += x[n] * b);
            work.at[..n + 2].copy_from_slice(x);
            work.at[n + 2..].copy_from_slice(curve);
            work.level = Level::Null;
        }
        if level < Level::Gradient {
            return Ok(());
        }
        let Work { kernel, differences, p, scratch, .. } = work;
        for (k, differences) in differences.iter_mut().enumerate() {
            let length = self.base.length(&kernel.right[k], scratch) / self.base.scales.unknowns;
            let unit = 1.0 / length.hypot(kernel.pi[k] / self.base.scales.first);
            let along = Along { u: &kernel.right[k], p: kernel.pi[k], unit };
            differences.along(problem, (&x[..n], p), along, &[&kernel.left])?;
        }
        work.level = Level::Gradient;
        Ok(())
    }

    /// Turns the equations so that only the first one changes along `v₁`.
    fn turn(&self, work: &mut Work, x: &[f64], curve: &[f64]) -> Result<(), EvalError> {
        self.bring(work, x, curve, Level::Gradient)?;
        let v = &work.kernel.right[0];
        let along = [0, 1].map(|k| dot(&work.differences[k].derivatives[0], v));
        let size = along[0].hypot(along[1]);
        if size > 0.0 {
            work.kernel.turn = along.map(|a| a / size);
        }
        Ok(())
    }

    /// `∂G_k` by the first and the second parameter.
    fn by_parameters(work: &Work, k: usize) -> [f64; 2] {
        let derivatives = &work.differences[k].derivatives;
        [1, 2].map(|i| -dot(&work.kernel.left, &derivatives[i]))
    }
}

/// Replaces the borders by the null vectors, orthonormal in the scaled metric, and the left one.
fn take(base: &Underlying<'_>, work: &mut Work) {
    let Work { kernel, scratch, .. } = work;
    let (u2, p2) = (base.scales.unknowns.powi(2), base.scales.first.powi(2));
    for k in 0..2 {
        let (done, rest) = kernel.right.split_at_mut(k);
        let v = &mut rest[0];
        base.problem.metric(v, scratch);
        for (i, d) in done.iter().enumerate() {
            let along = dot(d, scratch) / u2 + kernel.pi[i] * kernel.pi[k] / p2;
            v.iter_mut().zip(d).for_each(|(v, d)| *v -= along * d);
            kernel.pi[k] -= along * kernel.pi[i];
        }
        base.problem.metric(v, scratch);
        let norm = (dot(v, scratch) / u2 + kernel.pi[k].powi(2) / p2).sqrt();
        v.iter_mut().for_each(|v| *v /= norm);
        kernel.pi[k] /= norm;
    }
    // a turn in the plane of both: orthonormal they remain
    let size = kernel.pi[0].hypot(kernel.pi[1]);
    if size > 0.0 {
        let [s, c] = kernel.pi.map(|pi| pi / size);
        let [first, second] = &mut kernel.right;
        for (a, b) in first.iter_mut().zip(second) {
            (*a, *b) = (c * *a - s * *b, s * *a + c * *b);
        }
        kernel.pi = [0.0, size];
    }
    for k in 0..2 {
        base.problem.metric(&kernel.right[k], scratch);
        let row = kernel.bordered.row_mut(k).iter_mut().zip(scratch.iter());
        row.for_each(|(c, m)| *c = m / u2);
        kernel.bordered.set_corner(k, 1, kernel.pi[k] / p2);
    }
    let norm = dot(&kernel.left, &kernel.left).sqrt();
    let b = kernel.bordered.column_mut(0).iter_mut().zip(&kernel.left);
    b.for_each(|(b, w)| *b = w / norm);
}

/// Whether the null vectors have turned away from the borders.
fn astray(base: &Underlying<'_>, work: &mut Work) -> bool {
    let Work { kernel, scratch, .. } = work;
    let (u2, p2) = (base.scales.unknowns.powi(2), base.scales.first.powi(2));
    // the rows are of unit length, and dual to the null vectors
    let longest = (0..2)
        .map(|k| {
            base.problem.metric(&kernel.right[k], scratch);
            dot(&kernel.right[k], scratch) / u2 + kernel.pi[k].powi(2) / p2
        })
        .fold(0.0, f64::max);
    let left = dot(&kernel.left, &kernel.left).sqrt();
    longest.sqrt() > 1.0 / ALIGNED || left > 1.0 / ALIGNED
}

impl BranchPointCurve<'_> {
    /// The quadratic form on the kernel, whose vectors are as long as the scales.
    fn form(work: &Work) -> [[f64; 2]; 2] {
        let kernel = &work.kernel;
        let mut form = [[0.0; 2]; 2];
        for (k, row) in form.iter_mut().enumerate() {
            let by_first = Self::by_parameters(work, k)[0];
            for (i, entry) in row.iter_mut().enumerate() {
                let by_u = dot(&work.differences[k].derivatives[0], &kernel.right[i]);
                *entry = kernel.pi[i] * by_first - by_u;
            }
        }
        form
    }
}

impl Problem for BranchPointCurve<'_> {
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
        r[n..].copy_from_slice(&work.kernel.turned(work.kernel.g));
        Ok(())
    }

    fn jacobian(&self, x: &[f64], p: &[f64], j: &mut Self::Jacobian) -> Result<(), EvalError> {
        let work = &mut *self.work.get();
        self.bring(work, x, p, Level::Gradient)?;
        let kernel = &work.kernel;
        let [first, second] = [0, 1].map(|k| &work.differences[k].derivatives[0]);
        for (i, (a, b)) in first.iter().zip(second).enumerate() {
            let turned = kernel.turned([*a, *b]);
            (j.row_mut(0)[i], j.row_mut(1)[i]) = (-turned[0], -turned[1]);
        }
        let corner = kernel.turned([0, 1].map(|k| Self::by_parameters(work, k)[0]));
        for k in 0..2 {
            j.column_mut(k).copy_from_slice(kernel.bordered.column(k));
            j.set_corner(k, 0, 0.0);
            j.set_corner(k, 1, corner[k]);
        }
        let core = j.core_mut();
        core.set_zero();
        core.axpy(1.0, &work.jacobian);
        Ok(())
    }

    fn linearise(
        &self,
        x: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut Self::Jacobian,
    ) -> Result<(), EvalError> {
        if *x == self.start {
            let work = &mut *self.work.get();
            work.kernel.clone_from(&self.at_start);
            work.level = Level::Nothing;
        }
        self.residual(x, p, r)?;
        self.jacobian(x, p, j)
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
        let second = which == self.base.second;
        out[n..].fill(0.0);
        if second {
            let by_second = [0, 1].map(|k| Self::by_parameters(work, k)[1]);
            out[n..].copy_from_slice(&work.kernel.turned(by_second));
        }
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        let n = self.base.problem.dim();
        self.base.problem.metric(&x[..n], &mut y[..n]);
        y[n] = 0.0;
        y[n + 1] = self.base.scales.metric.powi(2) * x[n + 1];
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
        let last = out.len() - 1;
        let work = &mut *self.work.get();
        self.bring(work, x, p, Level::Gradient)?;
        out[0] = x[n + 1];
        self.base.problem.observe(&x[..n], &work.p, &mut out[1..last - 1])?;
        let curved = Self::form(work).iter().flatten().fold(0.0_f64, |m, f| m.max(f.abs()));
        out[last - 1] = x[n];
        out[last] = if curved > 0.0 { x[n] / curved } else { 0.0 };
        // only here, at a state of the curve: borders from an iterate of Newton's method somewhere else
        // may belong to another orientation
        if astray(&self.base, work) {
            take(&self.base, work);
            work.level = Level::Nothing;
            self.turn(work, x, p)?;
        }
        Ok(())
    }
}

impl SpecialPoints for BranchPointCurve<'_> {
    fn others(&self, _x: &[f64], _p: &[f64]) -> Result<Others, EvalError> {
        Ok(Others::default())
    }

    fn fallback_scale(&self) -> Option<f64> {
        Some(self.base.scales.unknowns)
    }

    fn separation(&self, x: &[f64], p: &[f64]) -> Result<Option<f64>, EvalError> {
        let work = &mut *self.work.get();
        self.bring(work, x, p, Level::Gradient)?;
        let form = Self::form(work);
        // where the form vanishes or has a double root the tangents of the branches are not two
        let discriminant = form[0][1] * form[1][0] - form[0][0] * form[1][1];
        let left = dot(&work.kernel.left, &work.kernel.left).sqrt();
        Ok(Some(discriminant.abs().sqrt() / left))
    }

    fn zero(&self, _observable: usize) -> Option<EventKind> {
        None
    }
}
