//! The collocation equations as a [`Problem`].

use super::basis::Basis;
use super::cycle::{Cycle, CycleError};
use super::floquet::{Multiplier, multipliers};
use super::matrix::CycleMatrix;
use super::mesh::Orbit;
use crate::any_problem::DynProblem;
use crate::linalg::{AnyMatrix, Dense, Matrix};
use crate::name::Name;
use crate::names;
use crate::pool::Pool;
use crate::problem::{
    EvalError, ParamId, Parameter, Problem, Stability, check_finite, check_pattern,
};
use crate::step::dot;

/// Largest number of unknowns of an interval, `n m`: its block is dense.
pub const MAX_BLOCK: usize = 800;

/// Range of an orbit, relative to its largest value, below which it is a single state to rounding.
const CONSTANT: f64 = 1e-12;

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
    mass: Option<Dense>,
    work: Pool<Work>,
}

struct Work {
    u: Vec<f64>,
    du: Vec<f64>,
    f: Vec<f64>,
    jacobian: AnyMatrix,
    unit: Vec<f64>,
    /// The state and the parameters whose multipliers are known.
    at: Vec<f64>,
    known: Vec<Multiplier>,
    /// For the multipliers alone.
    matrix: Option<CycleMatrix>,
}

impl Work {
    fn new(problem: &DynProblem<'_>) -> Self {
        let vector = || vec![0.0; problem.dim()];
        Work {
            u: vector(),
            du: vector(),
            f: vector(),
            jacobian: problem.new_jacobian(),
            unit: vector(),
            at: Vec::new(),
            known: Vec::new(),
            matrix: None,
        }
    }
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
        let orbit = Orbit { n, mesh: &mesh, values: &cycle.values, basis: &basis };
        let mut phase = vec![0.0; intervals * m * n];
        let (mut slope, mut weighted) = (vec![0.0; n], vec![0.0; n]);
        let mut square = 0.0;
        for j in 0..intervals {
            let h = mesh[j + 1] - mesh[j];
            for i in 0..m {
                slope.fill(0.0);
                for (k, by) in basis.slopes[i].iter().enumerate() {
                    slope.iter_mut().zip(orbit.node(j, k)).for_each(|(s, u)| *s += by * u);
                }
                problem.metric(&slope, &mut weighted);
                // slope is h u', and the weight of the point h w
                square += basis.weights[i] * dot(&slope, &weighted) / h;
                let place = &mut phase[(j * m + i) * n..(j * m + i + 1) * n];
                place.iter_mut().zip(&weighted).for_each(|(p, x)| *p = basis.weights[i] * x);
            }
        }
        let norm = square.sqrt();
        let size = crate::linalg::max_abs(&cycle.values);
        if !(norm.is_finite() && norm > 0.0 && cycle.amplitude() > CONSTANT * size) {
            return Err(CycleError::Constant);
        }
        phase.iter_mut().for_each(|x| *x /= norm);
        // |u'| over 2π: the amplitude of the orbit if it is a circle
        let unit = norm / (2.0 * std::f64::consts::PI) / cycle.period;
        Ok(CycleProblem {
            problem,
            n,
            mesh,
            unit,
            phase,
            mass: mass(problem)?,
            work: Pool::new(Work::new(problem)),
            basis,
        })
    }

    fn with<R>(&self, evaluate: impl FnOnce(&mut Work) -> R) -> R {
        self.work.with(|| Work::new(self.problem), evaluate)
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

    /// The Floquet multipliers of the solution, the largest first; the error of none is known yet.
    ///
    /// # Errors
    /// Where the problem has no value, or an interval is too long for its solution.
    pub fn multipliers(&self, x: &[f64], p: &[f64]) -> Result<Vec<Multiplier>, EvalError> {
        self.with(|work| {
            self.find_multipliers(work, x, p)?;
            Ok(work.known.clone())
        })
    }

    fn find_multipliers(&self, work: &mut Work, x: &[f64], p: &[f64]) -> Result<(), EvalError> {
        let known = work.at.len() == x.len() + p.len()
            && work.at[..x.len()] == *x
            && work.at[x.len()..] == *p;
        if known {
            return Ok(());
        }
        work.at.clear();
        let mut matrix = work.matrix.take().unwrap_or_else(|| self.new_jacobian());
        let found = self.assemble(work, x, p, &mut matrix).and_then(|()| {
            matrix.condense();
            multipliers(self.n, self.intervals(), |j, r, c| matrix.transfer(j, r, c))
                .ok_or(EvalError::NotFinite { at: 0 })
        });
        work.matrix = Some(matrix);
        work.known = found?;
        work.at.extend_from_slice(x);
        work.at.extend_from_slice(p);
        Ok(())
    }

    /// The solution `w` of the linearised equations with `w(T) = −w(0)`, at the nodes, of length 1 in the
    /// metric: of a cycle with a multiplier −1, by inverse iteration. `None` where it is not finite.
    pub(super) fn flip(&self, x: &[f64], p: &[f64]) -> Result<Option<Vec<f64>>, EvalError> {
        let size = self.dim();
        let mut matrix = CycleMatrix::new(self.n, self.basis.degree, self.intervals(), -1.0);
        self.with(|work| self.assemble(work, x, p, &mut matrix))?;
        for block in &mut matrix.blocks {
            block.column.fill(0.0);
            block.row.fill(0.0);
            block.row_left.fill(0.0);
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
            let Work { u, du, f, .. } = work;
            let (mut along, mut square) = (0.0, 0.0);
            for j in 0..self.intervals() {
                let h = self.mesh[j + 1] - self.mesh[j];
                for i in 0..m {
                    self.interpolate(x, (j, i), u, du);
                    let at = (j * m + i) * n;
                    along += dot(&self.phase[at..at + n], du) / h;
                    self.problem.metric(du, f);
                    square += self.basis.weights[i] * dot(du, f) / h;
                }
            }
            along / square.sqrt()
        })
    }

    /// State and derivative, times the interval's length, at Gauss point `i` of interval `j`.
    fn interpolate(&self, x: &[f64], (j, i): (usize, usize), u: &mut [f64], du: &mut [f64]) {
        let orbit = self.orbit(x);
        u.fill(0.0);
        du.fill(0.0);
        for k in 0..=self.basis.degree {
            let (value, slope) = (self.basis.values[i][k], self.basis.slopes[i][k]);
            for ((u, du), node) in u.iter_mut().zip(du.iter_mut()).zip(orbit.node(j, k)) {
                *u += value * node;
                *du += slope * node;
            }
        }
    }

    fn assemble(
        &self,
        work: &mut Work,
        x: &[f64],
        p: &[f64],
        matrix: &mut CycleMatrix,
    ) -> Result<(), EvalError> {
        let (n, m) = (self.n, self.basis.degree);
        let period = x[self.dim() - 1] / self.unit;
        matrix.set_zero();
        for j in 0..self.intervals() {
            let h = self.mesh[j + 1] - self.mesh[j];
            let block = &mut matrix.blocks[j];
            for i in 0..m {
                let Work { u, du, f, jacobian, unit, .. } = work;
                self.interpolate(x, (j, i), u, du);
                self.problem.linearise(u, p, f, jacobian)?;
                check_pattern(jacobian)?;
                let row = i * n;
                for (r, f) in f.iter().enumerate() {
                    block.column[row + r] = -h / self.unit * f;
                }
                let (values, slopes) = (&self.basis.values[i], &self.basis.slopes[i]);
                let size = n * m;
                let mut add = |r: usize, c: usize, value: f64, by: &[f64]| {
                    block.left[row + r + c * size] += by[0] * value;
                    for (k, by) in by.iter().enumerate().skip(1) {
                        block.inner.add(row + r, (k - 1) * n + c, by * value);
                    }
                };
                match &self.mass {
                    None => (0..n).for_each(|r| add(r, r, 1.0, slopes)),
                    Some(mass) => {
                        for c in 0..n {
                            (0..n).for_each(|r| add(r, c, mass.get(r, c), slopes));
                        }
                    }
                }
                let scale = -h * period;
                if !jacobian.entries(&mut |r, c, value| add(r, c, scale * value, values)) {
                    for c in 0..n {
                        unit.fill(0.0);
                        unit[c] = 1.0;
                        jacobian.mul(unit, du);
                        (0..n).for_each(|r| add(r, c, scale * du[r], values));
                    }
                }
                let phase = &self.phase[(j * m + i) * n..(j * m + i + 1) * n];
                for (k, by) in values.iter().enumerate() {
                    let place = if k == 0 {
                        &mut block.row_left[..]
                    } else {
                        &mut block.row[(k - 1) * n..k * n]
                    };
                    place.iter_mut().zip(phase).for_each(|(r, p)| *r += by * p);
                }
            }
        }
        Ok(())
    }

    /// The two functions of the multipliers: `(Π(1 + μ), Π(μ_i μ_j − 1))`, over the root of the sum of the
    /// squares of the polynomials' coefficients, the trivial multiplier left out of the second.
    fn tests(known: &[Multiplier]) -> [f64; 2] {
        let doubling = normalised(known.iter().map(|m| (m.log_modulus, m.argument)), -1.0);
        let trivial = super::point::trivial(known);
        let others: Vec<&Multiplier> =
            known.iter().enumerate().filter(|(i, _)| Some(*i) != trivial).map(|(_, m)| m).collect();
        let pairs = others.iter().enumerate().flat_map(|(i, a)| {
            others[i + 1..]
                .iter()
                .map(move |b| (a.log_modulus + b.log_modulus, a.argument + b.argument))
        });
        [doubling, normalised(pairs, 1.0)]
    }
}

/// `Π(μ − z)`, `z` 1 or −1, over the root of the sum of the squares of the coefficients of the
/// polynomial `Π(μ + x)`: at most of order one whatever the sizes of the numbers, and as smooth.
fn normalised(values: impl Iterator<Item = (f64, f64)>, z: f64) -> f64 {
    let (mut coefficients, mut product) = (vec![(1.0, 0.0)], (1.0, 0.0));
    let times = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    for (log, argument) in values {
        // large numbers by their reciprocals: a common factor
        let (value, one) = if log > 0.0 {
            let turn = if argument.abs() == std::f64::consts::PI {
                (-1.0, 0.0)
            } else {
                (argument.cos(), argument.sin())
            };
            (turn, (-log).exp())
        } else {
            let size = log.exp();
            let turn = if argument.abs() == std::f64::consts::PI {
                (-size, 0.0)
            } else {
                (size * argument.cos(), size * argument.sin())
            };
            (turn, 1.0)
        };
        product = times(product, (value.0 - z * one, value.1));
        let before = coefficients.clone();
        coefficients.push((0.0, 0.0));
        for (k, c) in coefficients.iter_mut().enumerate() {
            let low = before.get(k).map_or((0.0, 0.0), |b| times(*b, value));
            let high = if k > 0 { before[k - 1] } else { (0.0, 0.0) };
            *c = (low.0 + one * high.0, low.1 + one * high.1);
        }
    }
    let size = coefficients.iter().map(|c| c.0 * c.0 + c.1 * c.1).sum::<f64>().sqrt();
    product.0 / size
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
            let Work { u, du, f, .. } = work;
            let period = x[end] / self.unit;
            if period.is_nan() || period <= 0.0 {
                return Err(EvalError::Inadmissible {
                    what: "the period is not positive",
                    at: end,
                    value: period,
                });
            }
            r[end] = 0.0;
            for j in 0..self.intervals() {
                let h = self.mesh[j + 1] - self.mesh[j];
                for i in 0..m {
                    self.interpolate(x, (j, i), u, du);
                    self.problem.residual(u, p, f)?;
                    check_finite(f)?;
                    let at = (j * m + i) * n;
                    let place = &mut r[at..at + n];
                    match &self.mass {
                        None => place.copy_from_slice(du),
                        Some(mass) => mass.mul(du, place),
                    }
                    place.iter_mut().zip(f.iter()).for_each(|(r, f)| *r -= h * period * f);
                    r[end] += dot(&self.phase[at..at + n], u);
                }
            }
            Ok(())
        })
    }

    fn jacobian(&self, x: &[f64], p: &[f64], j: &mut CycleMatrix) -> Result<(), EvalError> {
        self.with(|work| self.assemble(work, x, p, j))
    }

    fn parameter_derivative(
        &self,
        x: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let (n, m, end) = (self.n, self.basis.degree, self.dim() - 1);
        self.with(|work| {
            let Work { u, du, f, .. } = work;
            let period = x[end] / self.unit;
            out[end] = 0.0;
            for j in 0..self.intervals() {
                let h = self.mesh[j + 1] - self.mesh[j];
                for i in 0..m {
                    self.interpolate(x, (j, i), u, du);
                    self.problem.parameter_derivative(u, p, which, f)?;
                    let place = &mut out[(j * m + i) * n..(j * m + i + 1) * n];
                    place.iter_mut().zip(f.iter()).for_each(|(o, f)| *o = -h * period * f);
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
        let (n, m, end) = (self.n, self.basis.degree, self.dim() - 1);
        self.with(|work| {
            let Work { u, du, f, unit, .. } = work;
            let period = x[end] / self.unit;
            out[end] = 0.0;
            for j in 0..self.intervals() {
                let h = self.mesh[j + 1] - self.mesh[j];
                for i in 0..m {
                    self.interpolate(x, (j, i), u, du);
                    self.interpolate(dx, (j, i), unit, du);
                    self.problem.derivative_error(u, p, which, unit, dp, f)?;
                    let place = &mut out[(j * m + i) * n..(j * m + i + 1) * n];
                    place.iter_mut().zip(f.iter()).for_each(|(o, f)| *o = h * period * f);
                }
            }
            Ok(())
        })
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        let (n, m, end) = (self.n, self.basis.degree, self.dim() - 1);
        self.with(|work| {
            let Work { u, du, f, .. } = work;
            y[..end].fill(0.0);
            y[end] = x[end];
            let nodes = self.intervals() * m;
            for j in 0..self.intervals() {
                let h = self.mesh[j + 1] - self.mesh[j];
                for i in 0..m {
                    self.interpolate(x, (j, i), u, du);
                    self.problem.metric(u, f);
                    for (k, value) in self.basis.values[i].iter().enumerate() {
                        let at = (j * m + k) % nodes * n;
                        let weight = h * self.basis.weights[i] * value;
                        y[at..at + n].iter_mut().zip(f.iter()).for_each(|(y, f)| *y += weight * f);
                    }
                }
            }
        })
    }

    fn observables(&self) -> &[Name] {
        names![PERIOD, DOUBLING, TORUS]
    }

    fn observe(&self, x: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let [doubling, torus] = self.with(|work| {
            self.find_multipliers(work, x, p)?;
            Ok::<_, EvalError>(Self::tests(&work.known))
        })?;
        out.copy_from_slice(&[x[self.dim() - 1] / self.unit, doubling, torus]);
        Ok(())
    }
}
