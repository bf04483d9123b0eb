//! Levenberg and Marquardt's method within bounds, on a hyperplane where one combination is held.

use super::objective::{Evaluation, Objective};
use nalgebra::{DMatrix, DVector};

/// How a descent ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most evaluations.
    pub evaluations: usize,
    /// Decrease of the cost, per step, below which it has converged; a tenth of a standard deviation moves
    /// it by 0.01.
    pub tolerance: f64,
    /// First damping, relative to a unit diagonal.
    pub damping: f64,
}

/// A combination of the coordinates that keeps its value: `a · x = c`.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// `a`.
    pub along: DVector<f64>,
    /// `c`.
    pub value: f64,
}

/// The end of a descent.
#[derive(Debug, Clone)]
pub struct Minimum {
    /// Where.
    pub x: DVector<f64>,
    /// The objective there.
    pub at: Evaluation,
    /// Whether it converged.
    pub converged: bool,
    /// Evaluations of the model.
    pub evaluations: usize,
}

/// Damping from a start that is only a guess.
pub const CAREFUL: f64 = 1e-3;
/// Damping near a minimum. Directions that the data hardly fix have eigenvalues of 1e-6 of the largest: a
/// step that is damped more gains nothing along them, and says nothing about having arrived.
pub const BOLD: f64 = 1e-9;
/// Damping beyond which no step is worth trying.
const LAST_DAMPING: f64 = 1e7;
/// Longest step of a logarithm: a factor of 2.7 in one step.
const LONGEST: f64 = 1.0;

/// Descends from `start`; `None` when the model has no value there. The same start gives the same end.
pub fn descend(
    objective: &Objective<'_>,
    start: &DVector<f64>,
    held: Option<&Held>,
    limits: Limits,
) -> Option<Minimum> {
    let mut x = start.clone();
    objective.clamp(&mut x);
    let at = objective.evaluate(&x).ok()?;
    let found = descend_from(objective, x, at, held, limits);
    Some(Minimum { evaluations: found.evaluations + 1, ..found })
}

/// Descends from a place within the bounds at which the objective is known. A descent that is stopped has not
/// converged.
pub fn descend_from(
    objective: &Objective<'_>,
    mut x: DVector<f64>,
    mut at: Evaluation,
    held: Option<&Held>,
    limits: Limits,
) -> Minimum {
    let mut evaluations = 0;
    let mut damping = limits.damping;
    // an undamped step failed: what damped ones gain must do
    let mut refused = false;
    let mut converged = false;
    while evaluations < limits.evaluations
        && damping < LAST_DAMPING
        && !objective.attended.is_stopped()
    {
        let Some(step) = step(objective, &x, &at, held, damping) else { break };
        let mut next = &x + step;
        objective.clamp(&mut next);
        evaluations += 1;
        let tried = objective.evaluate(&next).ok().filter(|e| e.cost.is_finite());
        let violation = |x: &DVector<f64>| held.map_or(0.0, |h| (h.along.dot(x) - h.value).abs());
        // the first step to the hyperplane may cost
        let towards = violation(&x) > 1e-9;
        match tried {
            Some(tried) if tried.cost <= at.cost || towards => {
                let gain = at.cost - tried.cost;
                let settled = gain < limits.tolerance && !towards;
                (x, at) = (next, tried);
                damping = (damping * 0.1).max(1e-9);
                if settled && (refused || damping <= 10.0 * BOLD) {
                    converged = true;
                    break;
                }
                if settled {
                    damping = BOLD;
                }
            }
            Some(tried) if tried.cost - at.cost < limits.tolerance && damping > 1.0 => {
                // nothing to gain in any direction
                converged = true;
                break;
            }
            // the model is no smoother than its branches: what the undamped step promises may be less than that
            _ if !towards && promised(objective, &x, &at, held) < limits.tolerance => {
                converged = true;
                break;
            }
            _ => {
                refused = true;
                damping = (damping * 8.0).max(1e-6);
            }
        }
    }
    Minimum { x, at, converged, evaluations }
}

/// What the undamped step would gain if the residuals were linear.
fn promised(
    objective: &Objective<'_>,
    x: &DVector<f64>,
    at: &Evaluation,
    held: Option<&Held>,
) -> f64 {
    let step = step(objective, x, at, held, BOLD);
    step.map_or(f64::INFINITY, |step| -at.gradient.dot(&step))
}

/// The damped step, with what is at a bound and pushed against it left out.
fn step(
    objective: &Objective<'_>,
    x: &DVector<f64>,
    at: &Evaluation,
    held: Option<&Held>,
    damping: f64,
) -> Option<DVector<f64>> {
    let n = x.len();
    let active: Vec<usize> = (0..n)
        .filter(|&k| {
            let (low, high) = objective.bounds[k];
            !(x[k] <= low && at.gradient[k] > 0.0 || x[k] >= high && at.gradient[k] < 0.0)
        })
        .collect();
    let m = active.len();
    let extra = usize::from(held.is_some());
    let mut matrix = DMatrix::zeros(m + extra, m + extra);
    let mut rhs = DVector::zeros(m + extra);
    // scaled to a unit diagonal
    let scale: Vec<f64> = active
        .iter()
        .map(|&k| at.normal[(k, k)].sqrt())
        .map(|s| if s > 0.0 { s } else { 1.0 })
        .collect();
    for (i, &a) in active.iter().enumerate() {
        for (j, &b) in active.iter().enumerate() {
            matrix[(i, j)] = at.normal[(a, b)] / (scale[i] * scale[j]);
        }
        matrix[(i, i)] += damping;
        rhs[i] = -at.gradient[a] / scale[i];
    }
    if let Some(held) = held {
        for (i, &a) in active.iter().enumerate() {
            matrix[(i, m)] = held.along[a] / scale[i];
            matrix[(m, i)] = held.along[a] / scale[i];
        }
        rhs[m] = held.value - held.along.dot(x);
    }
    let solution = matrix.lu().solve(&rhs)?;
    let mut step = DVector::zeros(n);
    for (i, &a) in active.iter().enumerate() {
        step[a] = solution[i] / scale[i];
    }
    if !step.iter().all(|s| s.is_finite()) {
        return None;
    }
    let longest = objective
        .free
        .iter()
        .zip(step.iter())
        .filter(|(key, _)| key.is_logarithmic())
        .fold(0.0_f64, |l, (_, s)| l.max(s.abs()));
    if longest > LONGEST && held.is_none() {
        step *= LONGEST / longest;
    }
    Some(step)
}
