//! What is known of one cycle: multipliers, stability, errors, and what is observed on it.

use super::collocation::CycleProblem;
use super::cycle::Cycle;
use super::floquet::Multiplier;
use super::mesh::{Orbit, halved};
use crate::any_problem::DynProblem;
use crate::linalg::Bordered;
use crate::problem::{EvalError, ParamId, Problem};
use crate::settings::{Counting, Settings};
use crate::step::{Constraint, Core, Precision, Refusal, State, Weights, dot};
use serde::{Deserialize, Serialize};

/// Deviation of the trivial multiplier from 1 above which it is not told from the others: nothing is
/// known of stability then, nor of errors.
const UNKNOWN: f64 = 0.05;
/// The parameter's part of a tangent, in its scale, below which the finer solution is sought on the plane
/// across the branch and not at the same parameter.
const VERTICAL: f64 = 0.05;
/// Factor by which the change on halving the intervals is less than the error: `1/(1 − 2^(−2m))`, at
/// most 16/15, and what the asymptotic law leaves open.
const SAFETY: f64 = 1.5;
/// Unknowns that are observed where the problem has no observables, at most.
const MOST_UNKNOWNS: usize = 16;

/// A cycle of a branch with what is known of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CyclePoint {
    /// The orbit, its period and the parameters.
    pub cycle: Cycle,
    /// The Floquet multipliers, the largest first, the trivial one among them; empty where they have no
    /// finite values.
    pub multipliers: Vec<Multiplier>,
    /// Index of the trivial multiplier, the one nearest to 1.
    pub trivial: Option<usize>,
    /// How far the trivial multiplier is from 1: the error that is seen, of which the other multipliers
    /// have at least as much; `None` without multipliers.
    pub trivial_error: Option<f64>,
    /// Estimated relative error of period and states at the mesh points, from the solution with every
    /// interval halved; `None` where it was not sought or not found, and where the trivial multiplier is
    /// not identified: the mesh is too coarse for its errors to be estimated.
    pub error: Option<f64>,
    /// The same, of the period alone.
    pub period_error: Option<f64>,
    /// Estimated error of the parameter: not zero where the branch is vertical and the finer solution
    /// was sought across it.
    pub parameter_error: Option<f64>,
    /// Number of multipliers outside the unit circle, the trivial one not counted; `None` where that one
    /// is not identified.
    pub unstable: Option<usize>,
    /// Whether that number is certain as far as the errors of the multipliers are: the trivial one is
    /// identified, and no other is within its error of the unit circle.
    pub certified: bool,
}

/// Index of the multiplier nearest to 1.
pub(super) fn trivial(all: &[Multiplier]) -> Option<usize> {
    let off = |m: &Multiplier| m.distance(&Multiplier::ONE);
    (0..all.len()).min_by(|a, b| off(&all[*a]).total_cmp(&off(&all[*b])))
}

/// A solution on the finer mesh, and where the tangent leads from there.
pub(super) struct Finer {
    pub(super) state: State,
    /// What the correction changed, in the problem's metric.
    pub(super) moved: f64,
    /// Values of the tests one small step along the branch, and the parameter there.
    pub(super) ahead: Option<State>,
    pub(super) multipliers: Vec<Multiplier>,
    mesh_values: Vec<f64>,
    period: f64,
}

/// Solves for the same point with every interval halved; `None` where that fails. `across` has it sought
/// on the plane across the branch in any case, with a second point ahead.
pub(super) fn finer(
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
    let mesh_values = state.u.chunks(2 * m * n).flat_map(|c| &c[..n.min(c.len())]).copied();
    let mesh_values = mesh_values.take(n * coarse.intervals()).collect();
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

impl CyclePoint {
    /// What is known of a solution of the collocation equations.
    pub(super) fn of(
        equations: &CycleProblem<'_>,
        x: &[f64],
        p: &[f64],
        finer: Option<&Finer>,
        which: ParamId,
    ) -> Self {
        let cycle = equations.cycle(x, p);
        let mut multipliers = equations.multipliers(x, p).unwrap_or_default();
        let trivial = trivial(&multipliers);
        let trivial_error = trivial.map(|t| multipliers[t].distance(&Multiplier::ONE));
        let (mut error, mut period_error, mut parameter_error) = (None, None, None);
        // halving says nothing of an orbit that neither mesh resolves
        let resolved = trivial_error.is_some_and(|off| off <= UNKNOWN);
        if let Some(finer) = finer.filter(|_| resolved) {
            let period = SAFETY * (finer.period / cycle.period - 1.0).abs();
            let (n, m) = (equations.n, equations.basis.degree);
            let states = (0..equations.intervals() * n).map(|i| {
                let (j, k) = (i / n, i % n);
                (x[j * m * n + k] - finer.mesh_values[i]).abs()
            });
            let states = SAFETY * states.fold(0.0, f64::max) / cycle.amplitude();
            error = Some(period.max(states));
            period_error = Some(period);
            parameter_error = Some(SAFETY * (finer.state.p - p[which.0]).abs());
            assign_errors(&mut multipliers, &finer.multipliers, trivial_error.unwrap_or(f64::NAN));
        }
        let mut point = CyclePoint {
            cycle,
            multipliers,
            trivial,
            trivial_error,
            error,
            period_error,
            parameter_error,
            unstable: None,
            certified: false,
        };
        point.judge();
        point
    }

    /// Counts unstable multipliers.
    fn judge(&mut self) {
        let (Some(trivial), Some(off)) = (self.trivial, self.trivial_error) else { return };
        if off.is_nan() || off > UNKNOWN {
            return;
        }
        let others = || self.multipliers.iter().enumerate().filter(|(i, _)| *i != trivial);
        self.unstable = Some(others().filter(|(_, m)| m.log_modulus > 0.0).count());
        let certain = |(_, m): (usize, &Multiplier)| {
            m.error.is_some_and(|error| m.log_modulus.abs() > 2.0 * error)
        };
        let away = others().all(certain);
        self.certified = away && self.error.is_some();
    }
}

/// Errors of the multipliers: how much they change when the intervals are halved, each against the
/// nearest one that is left, what the trivial one shows, and rounding.
fn assign_errors(multipliers: &mut [Multiplier], finer: &[Multiplier], trivial: f64) {
    let mut free: Vec<&Multiplier> = finer.iter().collect();
    for multiplier in multipliers {
        let nearest = (0..free.len())
            .min_by(|a, b| free[*a].distance(multiplier).total_cmp(&free[*b].distance(multiplier)));
        let change = nearest.map_or(f64::NAN, |i| free.swap_remove(i).distance(multiplier));
        let rounding = 1e-14 * (1.0 + multiplier.log_modulus.abs());
        let error = SAFETY * change + trivial + rounding;
        multiplier.error = error.is_finite().then_some(error);
    }
}

/// Names of the columns that are observed on cycles.
pub(super) fn columns(problem: &DynProblem<'_>) -> Vec<String> {
    let own = problem.observables();
    let names: Vec<String> = if own.is_empty() {
        (0..problem.dim().min(MOST_UNKNOWNS)).map(|i| format!("u[{i}]")).collect()
    } else {
        own.iter().map(|name| name.to_string()).collect()
    };
    names
        .iter()
        .flat_map(|name| ["max", "min", "mean"].map(|what| format!("{what}_{name}")))
        .collect()
}

/// Their values: maximum, minimum and mean over the period.
pub(super) fn observe(problem: &DynProblem<'_>, cycle: &Cycle) -> Result<Vec<f64>, EvalError> {
    let own = problem.observables().len();
    let count = if own == 0 { problem.dim().min(MOST_UNKNOWNS) } else { own };
    let basis = super::basis::Basis::new(cycle.degree);
    let n = problem.dim();
    let orbit = Orbit { n, mesh: &cycle.mesh, values: &cycle.values, basis: &basis };
    let (mut u, mut values) = (vec![0.0; n], vec![0.0; own]);
    let mut at = |t: f64, out: &mut [f64]| -> Result<(), EvalError> {
        orbit.at(t, &mut u);
        if own == 0 {
            out.copy_from_slice(&u[..count]);
        } else {
            problem.observe(&u, &cycle.parameters, &mut values)?;
            out.copy_from_slice(&values);
        }
        Ok(())
    };
    let per_interval = 2 * cycle.degree;
    let mut times = Vec::new();
    let mut means = vec![0.0; count];
    let mut here = vec![0.0; count];
    for w in cycle.mesh.windows(2) {
        let h = w[1] - w[0];
        times.extend((0..per_interval).map(|k| w[0] + h * k as f64 / per_interval as f64));
        for (point, weight) in basis.points.iter().zip(&basis.weights) {
            at(w[0] + h * point, &mut here)?;
            means.iter_mut().zip(&here).for_each(|(m, v)| *m += h * weight * v);
        }
    }
    let mut samples = vec![0.0; times.len() * count];
    for (t, sample) in times.iter().zip(samples.chunks_exact_mut(count)) {
        at(*t, sample)?;
    }
    let mut out = Vec::with_capacity(3 * count);
    for k in 0..count {
        for sign in [1.0, -1.0] {
            let value = |i: usize| sign * samples[i * count + k];
            let best = (0..times.len()).max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap_or(0);
            let last = times.len() - 1;
            let mut lo = if best == 0 { times[last] - 1.0 } else { times[best - 1] };
            let mut hi = if best == last { 1.0 } else { times[best + 1] };
            let mut top = value(best);
            for _ in 0..50 {
                let (a, b) = (lo + 0.382 * (hi - lo), lo + 0.618 * (hi - lo));
                at(a, &mut here)?;
                let left = sign * here[k];
                at(b, &mut here)?;
                let right = sign * here[k];
                top = top.max(left).max(right);
                if left > right { hi = b } else { lo = a }
            }
            out.push(sign * top);
        }
        out.push(means[k]);
    }
    Ok(out)
}
