//! The collocation equations as a [`Problem`].

mod work;

use super::basis::Basis;
use super::block::sized;
use super::cycle::{Cycle, CycleError};
use super::floquet::{Multiplier, multipliers};
use super::functions::functions;
use super::interval::{fill, interpolate, rows_of, weigh};
use super::matrix::CycleMatrix;
use super::mesh::Orbit;
use crate::any_problem::DynProblem;
use crate::linalg::{Dense, Matrix};
use crate::name::Name;
use crate::names;
use crate::pool::Pool;
use crate::problem::{
    EvalError, ParamId, Parameter, Problem, Stability, check_finite, check_pattern,
};
use crate::step::dot;
use work::Work;

/// Largest number of unknowns of an interval, `n m`: its block is dense.
pub const MAX_BLOCK: usize = 800;

/// Range of an orbit, relative to its largest value, below which it is a single state to rounding.
const CONSTANT: f64 = 1e-12;

/// Step, in the scaled arclength, over which functions of the multipliers are differenced.
const SHIFT: f64 = 1e-6;

/// Name of the period among the observables.
pub(super) const PERIOD: &str = "period";
/// Name of the function that vanishes where a multiplier is −1.
pub(super) const DOUBLING: &str = "period_doubling";
/// Name of the function that vanishes where the product of two multipliers is 1.
pub(super) const TORUS: &str = "neimark_sacker";

/// Periodic solutions of `M du/dt = f(u, p)` on a fixed mesh, as the zeros of a [`Problem`].
///
/// Unknowns are the states at the nodes, interval by interval, and the period, in a unit in which it is
/// as long as the orbit at which the problem was made. Arclength is
/// `ds² = ∫₀¹ du·M du dτ + dθ² + dp²` with the metric of the original problem and the period `θ` in that
/// unit. Observables are `period`, `period_doubling` and `neimark_sacker`, two functions of the
/// multipliers that vanish where one is −1, and where the product of two is 1. It says nothing about
/// stability: the eigenvalues of its Jacobian are not the multipliers.
pub struct CycleProblem<'a> {
    pub(super) problem: &'a DynProblem<'a>,
    pub(super) n: usize,
    pub(super) basis: Basis,
    pub(super) mesh: Vec<f64>,
    /// The period times this is the last unknown.
    pub(super) unit: f64,
    /// The phase condition: at each Gauss point the derivative of the reference orbit, weighted.
    phase: Vec<f64>,
    /// The same as a row over the unknowns of each interval.
    border: Vec<f64>,
    mass: Option<Dense>,
    /// Whether the metric of the unknowns is the identity.
    plain: bool,
    work: Pool<Work>,
}

/// A dense copy of a constant mass matrix, if it has full rank.
pub(super) fn mass(problem: &DynProblem<'_>) -> Result<Option<Dense>, CycleError> {
    let n = problem.dim();
    let mut mass = problem.new_jacobian();
    mass.set_zero();
    if !problem.mass(&mut mass) {
        return Ok(None);
    }
    check_pattern(&mass)?;
    let mut full = Dense::new(n);
    let mut unit = vec![0.0; n];
    for c in 0..n {
        unit[c] = 1.0;
        mass.mul(&unit, full.column_mut(c));
        unit[c] = 0.0;
    }
    let facts = full.factor(f64::EPSILON * n as f64 * full.norm());
    if facts.perturbed > 0 { Err(CycleError::SingularMass) } else { Ok(Some(full)) }
}

/// Whether the metric leaves every unit vector as it is.
fn is_plain(problem: &DynProblem<'_>) -> bool {
    let n = problem.dim();
    let (mut unit, mut y) = (vec![0.0; n], vec![0.0; n]);
    (0..n).all(|c| {
        unit.fill(0.0);
        unit[c] = 1.0;
        problem.metric(&unit, &mut y);
        y == unit
    })
}

impl<'a> CycleProblem<'a> {
    /// The equations on the mesh of `cycle`, which is the reference orbit of the phase condition.
    ///
    /// # Errors
    /// When the problem is not `M du/dt = f(u, p)` with an `M` of full rank, when it has too many
    /// unknowns, and when the orbit does not fit it or is constant.
    pub fn new<P: Problem>(problem: &'a P, cycle: &Cycle) -> Result<Self, CycleError> {
        Self::of(problem, cycle)
    }

    /// [`CycleProblem::new`] of a problem of unknown type.
    pub(crate) fn of(problem: &'a DynProblem<'a>, cycle: &Cycle) -> Result<Self, CycleError> {
        let n = problem.dim();
        if problem.stability() != Stability::Dynamics {
            return Err(CycleError::NoDynamics);
        }
        cycle.check(n, problem.parameters().len())?;
        let size = n * cycle.degree;
        if size > MAX_BLOCK {
            return Err(CycleError::TooLarge { size, most: MAX_BLOCK });
        }
        let basis = Basis::new(cycle.degree);
        let (mesh, m) = (cycle.mesh.clone(), cycle.degree);
        let intervals = mesh.len() - 1;
        let work = Work::new(problem, m, intervals);
        let mut equations = CycleProblem {
            problem,
            n,
            mesh,
            unit: 1.0,
            phase: vec![0.0; intervals * m * n],
            border: vec![0.0; intervals * (m + 1) * n],
            mass: mass(problem)?,
            plain: is_plain(problem),
            work: Pool::new(work),
            basis,
        };
        let norm = equations.refer(&cycle.values, cycle.period);
        let size = crate::linalg::max_abs(&cycle.values);
        if !(norm.is_finite() && norm > 0.0 && cycle.amplitude() > CONSTANT * size) {
            return Err(CycleError::Constant);
        }
        Ok(equations)
    }

    /// Makes an orbit on the same mesh the reference of the phase condition; the norm of its derivative.
    pub(super) fn refer(&mut self, values: &[f64], period: f64) -> f64 {
        let (n, m) = (self.n, self.basis.degree);
        let k = n * m;
        let mut phase = std::mem::take(&mut self.phase);
        let mut square = 0.0;
        // what others know is of the reference before
        let mut work = self.work.take_one().unwrap_or_else(|| self.new_work());
        let Work { u, du, nodes, known, along, .. } = &mut work;
        known.at.clear();
        along.clear();
        for j in 0..self.intervals() {
            let h = self.mesh[j + 1] - self.mesh[j];
            self.interpolate(values, j, nodes, u, du);
            // the slope is h u', and the weight of the point h w
            let places = phase[j * k..(j + 1) * k].chunks_exact_mut(n);
            for ((slope, place), w) in du.chunks_exact(n).zip(places).zip(&self.basis.weights) {
                self.problem.metric(slope, place);
                square += w * dot(slope, place) / h;
                place.iter_mut().for_each(|p| *p *= w);
            }
        }
        self.work = Pool::new(work);
        let norm = square.sqrt();
        phase.iter_mut().for_each(|x| *x /= norm);
        self.border.fill(0.0);
        for (row, phase) in self.border.chunks_exact_mut(k + n).zip(phase.chunks_exact(k)) {
            for (i, phase) in phase.chunks_exact(n).enumerate() {
                for (l, place) in row.chunks_exact_mut(n).enumerate() {
                    let by = self.basis.values[i * (m + 1) + l];
                    place.iter_mut().zip(phase).for_each(|(r, p)| *r += by * p);
                }
            }
        }
        self.phase = phase;
        // |u'| over 2π: the amplitude of the orbit if it is a circle
        self.unit = norm / (2.0 * std::f64::consts::PI) / period;
        norm
    }

    fn new_work(&self) -> Work {
        Work::new(self.problem, self.basis.degree, self.intervals())
    }

    /// Evaluates with a work space that nobody else uses meanwhile.
    fn with<R>(&self, evaluate: impl FnOnce(&mut Work) -> R) -> R {
        self.work.with(|| self.new_work(), evaluate)
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.mesh.len() - 1
    }

    /// The unknowns of a cycle that has the mesh of this problem.
    pub fn unknowns(&self, cycle: &Cycle) -> Vec<f64> {
        let mut x = if cycle.mesh == self.mesh && cycle.degree == self.basis.degree {
            cycle.values.clone()
        } else {
            let basis = Basis::new(cycle.degree);
            let orbit =
                Orbit { n: self.n, mesh: &cycle.mesh, values: &cycle.values, basis: &basis };
            orbit.on(&self.mesh, self.basis.degree)
        };
        x.push(cycle.period * self.unit);
        x
    }

    /// The cycle to unknowns and parameters.
    pub fn cycle(&self, x: &[f64], p: &[f64]) -> Cycle {
        let end = self.dim() - 1;
        Cycle {
            mesh: self.mesh.clone(),
            degree: self.basis.degree,
            values: x[..end].to_vec(),
            period: x[end] / self.unit,
            parameters: p.to_vec(),
        }
    }

    /// The orbit of unknowns.
    pub(super) fn orbit<'o>(&'o self, x: &'o [f64]) -> Orbit<'o> {
        let end = self.dim() - 1;
        Orbit { n: self.n, mesh: &self.mesh, values: &x[..end], basis: &self.basis }
    }

    /// The Floquet multipliers of the solution, the largest first; the error of none is known yet. The iteration
    /// begins where the latest one ended: their rounding depends on that.
    ///
    /// # Errors
    /// Where the problem has no value, or an interval is too long for its solution.
    pub fn multipliers(&self, x: &[f64], p: &[f64]) -> Result<Vec<Multiplier>, EvalError> {
        self.with(|work| {
            self.find_multipliers(work, x, p)?;
            Ok(work.known.multipliers.clone())
        })
    }

    fn find_multipliers(&self, work: &mut Work, x: &[f64], p: &[f64]) -> Result<(), EvalError> {
        if work.known.is_at(x, p) {
            return Ok(());
        }
        let mut known = std::mem::take(&mut work.known);
        known.at.clear();
        let found = self.multipliers_at(work, x, p);
        work.known = known;
        work.known.tests = functions(found.as_ref().map_or(&[], Vec::as_slice));
        work.known.multipliers = found?;
        work.known.at.extend_from_slice(x);
        work.known.at.extend_from_slice(p);
        Ok(())
    }

    fn multipliers_at(
        &self,
        work: &mut Work,
        x: &[f64],
        p: &[f64],
    ) -> Result<Vec<Multiplier>, EvalError> {
        let mut matrix = work.matrix.take().unwrap_or_else(|| self.new_jacobian());
        let found = self.assemble(work, x, p, None, &mut matrix).and_then(|()| {
            matrix.condense(false);
            multipliers(self.n, matrix.transfers(), &mut work.latest)
                .ok_or(EvalError::NotFinite { at: 0 })
        });
        work.matrix = Some(matrix);
        found
    }

    /// The solution `w` of the linearised equations with `w(T) = −w(0)`, at the nodes, of length 1 in the
    /// metric: of a cycle with a multiplier −1, by inverse iteration. `None` where it is not finite.
    pub(super) fn flip(&self, x: &[f64], p: &[f64]) -> Result<Option<Vec<f64>>, EvalError> {
        let size = self.dim();
        let mut matrix = CycleMatrix::new(self.n, self.basis.degree, self.intervals(), -1.0);
        self.with(|work| self.assemble(work, x, p, None, &mut matrix))?;
        let wide = self.n * (self.basis.degree + 1) + 1;
        for j in 0..self.intervals() {
            let block = matrix.block_mut(j);
            let rows = block.len() / wide - 1;
            block.iter_mut().skip(wide - 1).step_by(wide).for_each(|column| *column = 0.0);
            block[rows * wide..].fill(0.0);
        }
        matrix.corner = 1.0;
        matrix.factor(0.0);
        let mut w: Vec<f64> = (0..size).map(|i| crate::singular::arbitrary(5, i)).collect();
        let mut y = vec![0.0; size];
        for _ in 0..3 {
            w[size - 1] = 0.0;
            matrix.solve(&mut w);
            self.metric(&w, &mut y);
            let norm = dot(&w, &y).max(0.0).sqrt();
            w.iter_mut().for_each(|x| *x /= norm);
        }
        w.pop();
        Ok(w.iter().all(|x| x.is_finite()).then_some(w))
    }

    /// Cosine between the derivatives of the orbit and of the reference.
    pub(super) fn alignment(&self, x: &[f64]) -> f64 {
        let (n, m) = (self.n, self.basis.degree);
        self.with(|work| {
            let Work { u, du, nodes, f, .. } = work;
            let (mut along, mut square) = (0.0, 0.0);
            for j in 0..self.intervals() {
                let h = self.mesh[j + 1] - self.mesh[j];
                self.interpolate(x, j, nodes, u, du);
                for (i, du) in du.chunks_exact(n).enumerate() {
                    let at = (j * m + i) * n;
                    along += dot(&self.phase[at..at + n], du) / h;
                    self.problem.metric(du, f);
                    square += self.basis.weights[i] * dot(du, f) / h;
                }
            }
            along / square.sqrt()
        })
    }

    /// States and derivatives, times the interval's length, at the Gauss points of interval `j`; its
    /// unknowns are copied to `nodes`.
    fn interpolate(&self, x: &[f64], j: usize, nodes: &mut [f64], u: &mut [f64], du: &mut [f64]) {
        let (n, k) = (self.n, self.n * self.basis.degree);
        nodes[..k].copy_from_slice(&x[j * k..(j + 1) * k]);
        let right = if j + 1 == self.intervals() { 0 } else { (j + 1) * k };
        nodes[k..].copy_from_slice(&x[right..right + n]);
        sized!(n, k, interpolate(&self.basis, nodes, u, du));
    }

    /// The Jacobian, and the residual if it is asked for.
    fn assemble(
        &self,
        work: &mut Work,
        x: &[f64],
        p: &[f64],
        mut residual: Option<&mut [f64]>,
        matrix: &mut CycleMatrix,
    ) -> Result<(), EvalError> {
        let (n, m, end) = (self.n, self.basis.degree, self.dim() - 1);
        let (k, wide) = (n * m, n * m + n + 1);
        let period = self.period(x)?;
        matrix.corner = 0.0;
        let mut phase = 0.0;
        for j in 0..self.intervals() {
            let h = self.mesh[j + 1] - self.mesh[j];
            let block = matrix.block_mut(j);
            let Work { u, du, nodes, f, jacobian, slopes, unit, .. } = work;
            self.interpolate(x, j, nodes, u, du);
            for (i, u) in u.chunks_exact(n).enumerate() {
                self.problem.linearise(u, p, f, jacobian)?;
                check_pattern(jacobian)?;
                check_finite(f)?;
                rows_of(jacobian, slopes, unit);
                let rows = &mut block[i * n * wide..(i + 1) * n * wide];
                let scale = -h * period;
                sized!(n, k, fill(&self.basis, i, (scale, -h / self.unit), (slopes, f), rows));
                if let Some(mass) = &self.mass {
                    let by = &self.basis.slopes[i * (m + 1)..(i + 1) * (m + 1)];
                    for (r, row) in rows.chunks_exact_mut(wide).enumerate() {
                        for (place, by) in row.chunks_exact_mut(n).zip(by) {
                            place[r] -= by;
                            (0..n).for_each(|c| place[c] += by * mass.get(r, c));
                        }
                    }
                }
                if let Some(residual) = &mut residual {
                    self.row(
                        &du[i * n..(i + 1) * n],
                        f,
                        h * period,
                        &mut residual[j * k + i * n..],
                    );
                }
            }
            let border = &self.border[j * (k + n)..(j + 1) * (k + n)];
            block[k * wide..(k + 1) * wide - 1].copy_from_slice(border);
            block[(k + 1) * wide - 1] = 0.0;
            phase += dot(border, nodes);
        }
        if let Some(residual) = residual {
            residual[end] = phase;
        }
        Ok(())
    }

    /// `M u′ − h T f` at one Gauss point.
    fn row(&self, du: &[f64], f: &[f64], by: f64, out: &mut [f64]) {
        let out = &mut out[..self.n];
        match &self.mass {
            None => out.copy_from_slice(du),
            Some(mass) => mass.mul(du, out),
        }
        out.iter_mut().zip(f).for_each(|(r, f)| *r -= by * f);
    }

    fn period(&self, x: &[f64]) -> Result<f64, EvalError> {
        let at = self.dim() - 1;
        let value = x[at] / self.unit;
        if value > 0.0 {
            return Ok(value);
        }
        Err(EvalError::Inadmissible { what: "the period is not positive", at, value })
    }
}

impl Problem for CycleProblem<'_> {
    type Jacobian = CycleMatrix;

    fn dim(&self) -> usize {
        self.intervals() * self.basis.degree * self.n + 1
    }

    fn parameters(&self) -> &[Parameter] {
        self.problem.parameters()
    }

    fn new_jacobian(&self) -> CycleMatrix {
        CycleMatrix::new(self.n, self.basis.degree, self.intervals(), 1.0)
    }

    /// `M u′ − h T f` at the Gauss points, and the phase condition.
    fn residual(&self, x: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let (n, m, end) = (self.n, self.basis.degree, self.dim() - 1);
        self.with(|work| {
            let Work { u, du, nodes, f, .. } = work;
            let (period, k) = (self.period(x)?, n * m);
            r[end] = 0.0;
            for j in 0..self.intervals() {
                let h = self.mesh[j + 1] - self.mesh[j];
                self.interpolate(x, j, nodes, u, du);
                for (i, (u, du)) in u.chunks_exact(n).zip(du.chunks_exact(n)).enumerate() {
                    self.problem.residual(u, p, f)?;
                    check_finite(f)?;
                    self.row(du, f, h * period, &mut r[j * k + i * n..]);
                }
                r[end] += dot(&self.border[j * (k + n)..(j + 1) * (k + n)], nodes);
            }
            Ok(())
        })
    }

    fn jacobian(&self, x: &[f64], p: &[f64], j: &mut CycleMatrix) -> Result<(), EvalError> {
        self.with(|work| self.assemble(work, x, p, None, j))
    }

    fn linearise(
        &self,
        x: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut CycleMatrix,
    ) -> Result<(), EvalError> {
        self.with(|work| self.assemble(work, x, p, Some(r), j))
    }

    fn parameter_derivative(
        &self,
        x: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let (n, end) = (self.n, self.dim() - 1);
        self.with(|work| {
            let Work { u, du, nodes, f, .. } = work;
            let period = self.period(x)?;
            out[end] = 0.0;
            for (j, out) in out[..end].chunks_exact_mut(u.len()).enumerate() {
                let h = self.mesh[j + 1] - self.mesh[j];
                self.interpolate(x, j, nodes, u, du);
                for (u, out) in u.chunks_exact(n).zip(out.chunks_exact_mut(n)) {
                    self.problem.parameter_derivative(u, p, which, f)?;
                    out.iter_mut().zip(f.iter()).for_each(|(o, f)| *o = -h * period * f);
                }
            }
            Ok(())
        })
    }

    fn derivative_error(
        &self,
        x: &[f64],
        p: &[f64],
        which: ParamId,
        dx: &[f64],
        dp: f64,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let (n, end) = (self.n, self.dim() - 1);
        self.with(|work| {
            let Work { u, du, nodes, f, .. } = work;
            let period = self.period(x)?;
            let mut along = vec![0.0; u.len()];
            out[end] = 0.0;
            for (j, out) in out[..end].chunks_exact_mut(u.len()).enumerate() {
                let h = self.mesh[j + 1] - self.mesh[j];
                self.interpolate(x, j, nodes, u, du);
                self.interpolate(dx, j, nodes, &mut along, du);
                let states = u.chunks_exact(n).zip(along.chunks_exact(n));
                for ((u, along), out) in states.zip(out.chunks_exact_mut(n)) {
                    self.problem.derivative_error(u, p, which, along, dp, f)?;
                    out.iter_mut().zip(f.iter()).for_each(|(o, f)| *o = h * period * f);
                }
            }
            Ok(())
        })
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        let (n, m, end) = (self.n, self.basis.degree, self.dim() - 1);
        self.with(|work| {
            let Work { weighed, nodes, .. } = work;
            let (k, last) = (n * m, self.intervals() - 1);
            // the metric of the unknowns first: it is the same everywhere
            if self.plain {
                y[..end].copy_from_slice(&x[..end]);
            } else {
                for (x, y) in x[..end].chunks_exact(n).zip(y.chunks_exact_mut(n)) {
                    self.problem.metric(x, y);
                }
            }
            // the first state, and what an interval adds to its right end until that is reached
            let (first, pending) = weighed.split_at_mut(n);
            first.copy_from_slice(&y[..n]);
            pending.fill(0.0);
            for j in 0..=last {
                let h = self.mesh[j + 1] - self.mesh[j];
                nodes[..k].copy_from_slice(&y[j * k..(j + 1) * k]);
                let right = if j == last { &*first } else { &y[(j + 1) * k..(j + 1) * k + n] };
                nodes[k..].copy_from_slice(right);
                let place = &mut y[j * k..(j + 1) * k];
                sized!(n, k, weigh(&self.basis, h, nodes, place, pending));
            }
            y[..n].iter_mut().zip(pending).for_each(|(y, by)| *y += *by);
            y[end] = x[end];
        })
    }

    fn observables(&self) -> &[Name] {
        names![PERIOD, DOUBLING, TORUS]
    }

    fn observe(&self, x: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        self.with(|work| {
            self.find_multipliers(work, x, p)?;
            let [doubling, torus] = work.known.tests;
            out.copy_from_slice(&[x[self.dim() - 1] / self.unit, doubling, torus]);
            Ok(())
        })
    }

    /// By central differences, of both functions of the multipliers at once; those at `x` stay known.
    fn observable_slope(
        &self,
        k: usize,
        x: &[f64],
        p: &[f64],
        which: ParamId,
        dx: &[f64],
        dp: f64,
    ) -> Result<Option<f64>, EvalError> {
        if k == 0 {
            return Ok(Some(dx[self.dim() - 1] / self.unit));
        }
        self.with(|work| {
            let key = || x.iter().chain(p).chain(dx).chain(std::iter::once(&dp));
            if !work.along.iter().eq(key()) {
                work.along.clear();
                let mut q = p.to_vec();
                let mut shifted = std::mem::take(&mut work.shifted);
                let mut sides = [[0.0; 2]; 2];
                let mut complete = true;
                for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
                    let step = sign * SHIFT;
                    q[which.0] = p[which.0] + step * dp;
                    shifted
                        .iter_mut()
                        .zip(x.iter().zip(dx))
                        .for_each(|(s, (x, d))| *s = x + step * d);
                    match self.multipliers_at(work, &shifted, &q) {
                        Ok(found) => *side = functions(&found),
                        Err(_) => complete = false,
                    }
                }
                work.shifted = shifted;
                if !complete {
                    // no value there: what is tried next says why
                    return Ok(None);
                }
                work.slopes_along = [0, 1].map(|i| (sides[0][i] - sides[1][i]) / (2.0 * SHIFT));
                work.along.extend(key());
            }
            Ok(Some(work.slopes_along[k - 1]))
        })
    }
}
