//! A cycle again with every interval halved, from which the errors come.

use super::collocation::CycleProblem;
use super::floquet::Multiplier;
use super::matrix::CycleMatrix;
use super::mesh::halved;
use crate::linalg::{Bordered, Matrix};
use crate::problem::{ParamId, Problem};
use crate::settings::{Counting, Settings};
use crate::step::{Constraint, Core, Precision, Refusal, State, Weights, dot};

/// The parameter's part of a tangent, in its scale, below which the finer solution is sought on the plane
/// across the branch and not at the same parameter.
const VERTICAL: f64 = 0.05;
/// Most corrections of a finer solution: three with factors of its own, the others with those before.
const MOST: usize = 9;
/// Ratio of corrections with the same factors above which new ones are worth their price.
const SLOW: f64 = 0.05;

/// A solution on the finer mesh, and where the tangent leads from there.
pub(super) struct Finer {
    pub(super) state: State,
    /// What the correction changed, in the problem's metric.
    pub(super) moved: f64,
    /// Values of the tests one small step along the branch, and the parameter there.
    pub(super) ahead: Option<State>,
    pub(super) multipliers: Vec<Multiplier>,
    pub(super) mesh_values: Vec<f64>,
    pub(super) period: f64,
}

/// The equations with every interval halved, and all that solving them needs: made once for a mesh.
pub(super) struct Halved<'a> {
    /// The mesh that is halved.
    mesh: Vec<f64>,
    equations: CycleProblem<'a>,
    matrix: CycleMatrix,
    x: Vec<f64>,
    r: Vec<f64>,
    weighed: Vec<f64>,
    start: Vec<f64>,
}

impl<'a> Halved<'a> {
    /// Storage for the mesh of `coarse`, and the orbit of `x` on it; `None` if there are no equations.
    pub(super) fn new(coarse: &CycleProblem<'a>, x: &[f64], p: &[f64]) -> Option<Self> {
        let cycle = coarse.cycle(x, p);
        let equations = CycleProblem::of(coarse.problem, &cycle.on(halved(&cycle.mesh))).ok()?;
        let size = equations.dim();
        Some(Halved {
            mesh: cycle.mesh,
            matrix: equations.new_jacobian(),
            x: vec![0.0; size],
            r: vec![0.0; size],
            weighed: vec![0.0; size],
            start: vec![0.0; size],
            equations,
        })
    }

    /// Whether it is for this mesh.
    pub(super) fn fits(&self, coarse: &CycleProblem<'a>) -> bool {
        self.mesh == coarse.mesh
    }

    /// The solution at the same parameters; `None` where Newton's method does not come to it.
    fn solve(&mut self, coarse: &CycleProblem<'a>, x: &[f64], p: &[f64]) -> Option<Finer> {
        let end = self.x.len() - 1;
        let period = x[coarse.dim() - 1] / coarse.unit;
        coarse.orbit(x).on_halved(&mut self.x[..end]);
        self.equations.refer(&self.x[..end], period);
        self.x[end] = period * self.equations.unit;
        self.start.copy_from_slice(&self.x);
        // measured by the amplitude, as on the branch
        let amplitude = self.equations.unit * period;
        self.equations.metric(&self.x, &mut self.weighed);
        let size = amplitude + dot(&self.x, &self.weighed).max(0.0).sqrt();
        let converged = 3.0 * Settings::default().tolerance * size;
        let (mut last, mut factored) = (f64::INFINITY, false);
        for correction in 0.. {
            if correction == MOST {
                return None;
            }
            if factored {
                self.equations.residual(&self.x, p, &mut self.r).ok()?;
            } else {
                self.equations.linearise(&self.x, p, &mut self.r, &mut self.matrix).ok()?;
                self.matrix.factor(0.0);
            }
            self.matrix.solve(&mut self.r);
            self.x.iter_mut().zip(&self.r).for_each(|(x, d)| *x -= d);
            self.equations.metric(&self.r, &mut self.weighed);
            let length = dot(&self.r, &self.weighed).max(0.0).sqrt();
            if !length.is_finite() || length > 2.0 * last {
                return None;
            }
            if length <= converged && correction > 0 {
                break;
            }
            // near the solution the factors are as good as new ones
            factored = if factored { length <= SLOW * last } else { length <= 1e-3 * size };
            last = length;
        }
        let multipliers = self.equations.multipliers(&self.x, p).ok()?;
        self.start.iter_mut().zip(&self.x).for_each(|(a, b)| *a -= b);
        self.equations.metric(&self.start, &mut self.weighed);
        let moved = dot(&self.start, &self.weighed).max(0.0).sqrt();
        Some(Finer {
            state: State::new(0, 0),
            moved,
            ahead: None,
            multipliers,
            mesh_values: mesh_values(&self.x, coarse.n, coarse.basis.degree),
            period: self.x[end] / self.equations.unit,
        })
    }
}

/// States at the points of the mesh that was halved.
fn mesh_values(x: &[f64], n: usize, m: usize) -> Vec<f64> {
    x[..x.len() - 1].chunks(2 * m * n).flat_map(|c| &c[..n]).copied().collect()
}

/// Solves for the point of a branch again with every interval halved; `None` where that fails. `dp_ds` is its
/// tangent's part along the parameter; `across` has it sought on the plane across the branch in any case, with a
/// second point ahead. `storage` is kept from point to point.
pub(super) fn finer<'a>(
    storage: &mut Option<Halved<'a>>,
    coarse: &CycleProblem<'a>,
    which: ParamId,
    (x, p, dp_ds): (&[f64], &[f64], f64),
    range: f64,
    across: bool,
) -> Option<Finer> {
    // the period in its unit is the amplitude
    let amplitude = x[coarse.dim() - 1];
    let by_parameter = (dp_ds / range).abs();
    let by_unknowns = (1.0 - dp_ds * dp_ds).max(0.0).sqrt() / amplitude;
    let vertical = by_parameter < VERTICAL * by_parameter.hypot(by_unknowns);
    if !(across || vertical) {
        if !storage.as_ref().is_some_and(|halved| halved.fits(coarse)) {
            *storage = Halved::new(coarse, x, p);
        }
        let found = storage.as_mut().and_then(|halved| halved.solve(coarse, x, p));
        if let Some(mut found) = found {
            found.state.p = p[which.0];
            return Some(found);
        }
    }
    beside(coarse, which, x, p, range, across)
}

/// Solves for the same point on the plane across the branch, or at the same parameter where that has a tangent
/// along it; `None` where that fails. `across` has it sought on the plane in any case, with a second point ahead.
fn beside(
    coarse: &CycleProblem<'_>,
    which: ParamId,
    x: &[f64],
    p: &[f64],
    range: f64,
    across: bool,
) -> Option<Finer> {
    let cycle = coarse.cycle(x, p);
    let (n, m) = (coarse.n, coarse.basis.degree);
    let fine = CycleProblem::of(coarse.problem, &cycle.on(halved(&cycle.mesh))).ok()?;
    let settings = Settings { counting: Counting::Few, ..Settings::default() };
    // the amplitude in the metric, and what the parameter is expected to pass
    let weights = Weights { unknowns: fine.unit * cycle.period, parameter: range };
    let mut core = Core::new(&fine, which, p, weights, &settings);
    let mut base = State::new(fine.dim(), 3);
    base.u = fine.unknowns(&cycle);
    base.p = p[which.0];
    tangent(&fine, which, p, weights, &mut base)?;
    let vertical = base.tp.abs() < VERTICAL * core.weights.parameter;
    let constraint = if across || vertical {
        Constraint::Plane(&base, 0.0)
    } else {
        Constraint::Parameter(&base, base.p)
    };
    let mut state = base.clone();
    core.correct(constraint, &mut state, Precision::Event).ok()?;
    let difference: Vec<f64> = state.u.iter().zip(&base.u).map(|(a, b)| a - b).collect();
    let mut y = vec![0.0; fine.dim()];
    fine.metric(&difference, &mut y);
    let moved = dot(&difference, &y).max(0.0).sqrt().hypot(state.p - base.p);
    let ahead = across.then(|| step_along(&mut core, &state).ok()).flatten();
    let mut q = p.to_vec();
    q[which.0] = state.p;
    let multipliers = fine.multipliers(&state.u, &q).ok()?;
    let mesh_values = mesh_values(&state.u, n, m);
    let period = state.u[fine.dim() - 1] / fine.unit;
    Some(Finer { state, moved, ahead, multipliers, mesh_values, period })
}

/// The tangent at a state near a solution, of unit length in the scaled metric; `None` where there is none.
fn tangent(
    problem: &CycleProblem<'_>,
    which: ParamId,
    p: &[f64],
    weights: Weights,
    x: &mut State,
) -> Option<()> {
    let mut jacobian = problem.new_jacobian();
    problem.jacobian(&x.u, p, &mut jacobian).ok()?;
    let mut bordered = Bordered::new(problem.dim(), 1);
    problem.parameter_derivative(&x.u, p, which, bordered.column_mut(0)).ok()?;
    // any border that is not orthogonal to the tangent
    let unit = weights.unknowns * (problem.dim() as f64).sqrt();
    for (i, c) in bordered.row_mut(0).iter_mut().enumerate() {
        *c = crate::singular::arbitrary(1, i) / unit;
    }
    bordered.set_corner(0, 0, 1.0 / weights.parameter);
    bordered.factor(&mut jacobian);
    x.tu.fill(0.0);
    let mut end = [1.0];
    bordered.solve(&mut jacobian, &mut x.tu, &mut end);
    x.tp = end[0];
    problem.metric(&x.tu, &mut x.mtu);
    let norm = weights.norm(&x.mtu, &x.tu, x.tp);
    x.length = (dot(&x.mtu, &x.tu) + x.tp * x.tp).max(0.0).sqrt();
    x.scale_tangent(1.0 / norm);
    (norm.is_finite() && norm > 0.0).then_some(())
}

/// A point a small step along the branch.
fn step_along(core: &mut Core<'_>, from: &State) -> Result<State, Refusal> {
    let h = 1e-3;
    let mut x = from.clone();
    x.u.iter_mut().zip(&from.tu).for_each(|(u, t)| *u += h * t);
    x.p += h * from.tp;
    core.correct(Constraint::Plane(from, h), &mut x, Precision::Event)?;
    Ok(x)
}
