//! Asymmetric states that no known branch contains.

use super::{TwoPlatesProblem, spring_pairs};
use continuation::{Branch, NewtonSettings, Problem, newton};

/// States nearer than this to each other, relative to what sets the asymmetric one apart from its
/// mirror image, are the same: Newton's method leaves 1e-9 of it, other states are tenths away.
const SAME: f64 = 1e-3;
/// What sets a state apart from its mirror image, in the metric, where it is its own.
pub(super) const SYMMETRIC: f64 = 1e-6;

/// An asymmetric state on no known branch.
#[derive(Debug, Clone, PartialEq)]
pub struct Unconnected {
    /// Half the distance of the plates.
    pub z0: f64,
    /// The state.
    pub u: Vec<f64>,
    /// Distances of the upper plate and of the lower from the equator, of the two springs it was
    /// found from.
    pub plates: [f64; 2],
}

/// The first asymmetric state at one of the distances `at`, in their order, that is found from two
/// springs ([`spring_pairs`] of the symmetric branch) and lies on none of the `known` branches of
/// the problem, nor does its mirror image. `None` when there is no more: traced, the state's branch
/// joins the known ones for the next call. That nothing is found proves nothing.
pub fn next_unconnected(
    problem: &TwoPlatesProblem,
    symmetric: &Branch,
    known: &[&Branch],
    at: &[f64],
) -> Option<Unconnected> {
    at.iter().find_map(|&z0| {
        let p = problem.parameters_at(z0);
        let settle = |mut u: Vec<f64>| {
            newton(problem, &mut u, &p, &NewtonSettings::default()).ok().map(|_| u)
        };
        let mut states: Option<Vec<Vec<f64>>> = None;
        for pair in spring_pairs(problem, symmetric, z0) {
            let Some(u) = settle(pair.u) else { continue };
            let image = problem.reflected(&u);
            let apart = distance(problem, &u, &image);
            if apart < SYMMETRIC {
                continue;
            }
            let states = states.get_or_insert_with(|| {
                let passing = known.iter().flat_map(|branch| passing(branch, z0));
                passing.filter_map(settle).collect()
            });
            let is_known = |v: &Vec<f64>| {
                let nearest = distance(problem, v, &u).min(distance(problem, v, &image));
                nearest < SAME * apart
            };
            if !states.iter().any(is_known) {
                return Some(Unconnected { z0, u, plates: pair.plates });
            }
        }
        None
    })
}

/// Length of the difference of two states in the metric.
pub(super) fn distance<P: Problem>(problem: &P, a: &[f64], b: &[f64]) -> f64 {
    let d: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let mut y = vec![0.0; d.len()];
    problem.metric(&d, &mut y);
    d.iter().zip(&y).map(|(d, y)| d * y).sum::<f64>().max(0.0).sqrt()
}

/// Where a branch passes `z0`, between its points.
fn passing(branch: &Branch, z0: f64) -> Vec<Vec<f64>> {
    let crossed = branch.points.windows(2).filter(|w| (w[0].p - z0) * (w[1].p - z0) <= 0.0);
    let between = crossed.map(|w| {
        let step = w[1].p - w[0].p;
        let share = if step == 0.0 { 0.0 } else { (z0 - w[0].p) / step };
        w[0].u.iter().zip(&w[1].u).map(|(a, b)| a + share * (b - a)).collect()
    });
    between.collect()
}
