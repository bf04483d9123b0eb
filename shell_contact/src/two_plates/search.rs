//! Asymmetric states that no known branch contains.

use super::{TwoPlatesProblem, spring_pairs};
use continuation::{Branch, NewtonSettings, Point, Problem, newton};

/// States nearer than this to each other, relative to what sets the asymmetric one apart from its
/// mirror image, are the same: Newton's method leaves 1e-9 of it, other states are tenths away.
const SAME: f64 = 1e-3;
/// What sets a state apart from its mirror image, in the metric, where it is its own.
pub(super) const SYMMETRIC: f64 = 1e-6;
/// Points nearer to the end of a step, in steps, say nothing of the branch that the end does not.
const APART: f64 = 0.1;
/// Halvings of a step.
const HALVINGS: usize = 60;

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

/// Where a branch passes `z0`, between its points: on the polynomial through those about it.
fn passing(branch: &Branch, z0: f64) -> Vec<Vec<f64>> {
    let points = &branch.points;
    let crosses = |k: &usize| (points[*k].p - z0) * (points[k + 1].p - z0) <= 0.0;
    let crossed = (0..points.len().saturating_sub(1)).filter(crosses);
    let between = crossed.map(|k| {
        let nodes = about(points, k);
        let at = |s: f64| weights(&nodes, s);
        let off = |s: f64| nodes.iter().zip(at(s)).map(|(x, w)| w * (x.p - z0)).sum::<f64>();
        let (mut low, mut high) = (points[k].s, points[k + 1].s);
        let below = points[k].p < points[k + 1].p;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if (off(middle) < 0.0) == below { low = middle } else { high = middle }
        }
        let mut u = vec![0.0; points[k].u.len()];
        for (x, w) in nodes.iter().zip(at(0.5 * (low + high))) {
            u.iter_mut().zip(&x.u).for_each(|(u, x)| *u += w * x);
        }
        u
    });
    between.collect()
}

/// The ends of the step behind point `k`, and the nearest points to both sides that are not beside them.
fn about(points: &[Point], k: usize) -> Vec<&Point> {
    let step = points[k + 1].s - points[k].s;
    let apart = |a: &Point, b: &Point| (a.s - b.s).abs() > APART * step;
    let mut nodes = vec![&points[k]];
    if step > 0.0 {
        nodes.push(&points[k + 1]);
        nodes.extend(points[..k].iter().rev().find(|x| apart(x, &points[k])));
        nodes.extend(points[k + 2..].iter().find(|x| apart(x, &points[k + 1])));
    }
    nodes
}

/// Lagrange's weights at `s`.
fn weights(nodes: &[&Point], s: f64) -> Vec<f64> {
    let weight = |x: &Point| {
        let others = nodes.iter().filter(|y| y.s != x.s);
        others.map(|y| (s - y.s) / (x.s - y.s)).product()
    };
    nodes.iter().map(|x| weight(x)).collect()
}
