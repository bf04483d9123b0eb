//! Where a branch passes a value of its parameter.

use super::DeflationSettings;
use super::attempt::{Damping, Solver};
use super::known::Known;
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Point};
use crate::newton;

/// Distance from the interpolated branch, relative to the chord, within which a solution is the
/// branch's own.
const NEAR: f64 = 0.3;

/// An approximation of a solution of the branch.
#[derive(Debug, Clone)]
pub(super) struct Passage {
    pub(super) u: Vec<f64>,
    /// The two neighbouring points; one and the same where the branch has a point at the value.
    pub(super) between: [Vec<f64>; 2],
}

impl Passage {
    /// Whether the solution `u` can be the one that is approximated.
    pub(super) fn covers(&self, known: &mut Known<'_>, u: &[f64]) -> bool {
        let [a, b] = &self.between;
        let size = known.norm(&self.u);
        known.distance(u, &self.u) <= NEAR * known.distance(a, b) + 1e-6 * size
    }
}

/// What is known of a branch at a value of its parameter.
#[derive(Debug, Clone, Default)]
pub(super) struct Passing {
    pub(super) solutions: Vec<Vec<f64>>,
    /// Those that Newton's method does not meet from the interpolated state.
    pub(super) unresolved: Vec<Passage>,
}

/// The branch's solutions at the parameters `p`, to rounding.
///
/// Newton's method may lead from two passages, near a fold say, to the same solution: then it is
/// deflated. A solution far from the passage is not the branch's.
pub(super) fn solutions(
    problem: &DynProblem<'_>,
    branch: &Branch,
    p: &[f64],
    which: usize,
    settings: &DeflationSettings,
) -> Passing {
    let mut own = Known::new(problem);
    let extent = extent(&mut own, branch);
    own.length = extent;
    let mut solver = Solver::new(problem, p);
    let limits = settings.newton();
    let mut unresolved = Vec::new();
    for passage in passages(branch, p[which]) {
        if own.contains(&passage.u, settings.separation) {
            continue; // the end of a closed loop
        }
        let [a, b] = &passage.between;
        let chord = own.distance(a, b);
        let mut u = passage.u.clone();
        if newton::solve(problem, &mut u, p, &limits).is_ok()
            && passage.covers(&mut own, &u)
            && !own.contains(&u, settings.separation)
        {
            own.solutions.push(u);
            continue;
        }
        if chord > 0.0 && !own.solutions.is_empty() {
            own.length = chord;
            let tried =
                solver.attempt(&mut own, &passage.u, (chord, None), Damping::Monotone, &limits);
            own.length = extent;
            if tried.is_ok()
                && passage.covers(&mut own, &solver.u)
                && !own.contains(&solver.u, settings.separation)
            {
                own.solutions.push(solver.u.clone());
                continue;
            }
        }
        unresolved.push(passage);
    }
    Passing { solutions: own.solutions, unresolved }
}

/// How far the branch leads from its first point.
pub(super) fn extent(known: &mut Known<'_>, branch: &Branch) -> f64 {
    let Some(first) = branch.points.first() else { return 0.0 };
    branch.points.iter().map(|point| known.distance(&point.u, &first.u)).fold(0.0, f64::max)
}

/// The branch's states at the parameter value `p`, interpolated.
pub(super) fn states(branch: &Branch, p: f64) -> impl Iterator<Item = Vec<f64>> {
    passages(branch, p).into_iter().map(|passage| passage.u)
}

/// The branch's solutions at the parameter value `p`, one for every passage, approximately.
///
/// Between two points the parameter is interpolated over arclength, by the cubic with its slopes at
/// both ends, so that near a fold both sheets are met; the unknowns linearly.
fn passages(branch: &Branch, p: f64) -> Vec<Passage> {
    let mut found = Vec::new();
    let at_point = |u: &Vec<f64>| Passage { u: u.clone(), between: [u.clone(), u.clone()] };
    for pair in branch.points.windows(2) {
        let [a, b] = pair else { continue };
        if a.p == p {
            found.push(at_point(&a.u));
        } else if (a.p - p) * (b.p - p) < 0.0 {
            let t = passage(a, b, p);
            let u = a.u.iter().zip(&b.u).map(|(a, b)| (1.0 - t) * a + t * b).collect();
            found.push(Passage { u, between: [a.u.clone(), b.u.clone()] });
        }
    }
    if let Some(last) = branch.points.last()
        && last.p == p
    {
        found.push(at_point(&last.u));
    }
    found
}

/// Where between `a` (0) and `b` (1), by bisection.
fn passage(a: &Point, b: &Point, p: f64) -> f64 {
    let h = b.s - a.s;
    let at = |t: f64| {
        let [a0, a1, b0, b1] = crate::events::basis(t);
        a0 * a.p + a1 * h * a.dp_ds + b0 * b.p + b1 * h * b.dp_ds - p
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if at(low) * at(middle) <= 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}
