//! What is observed on a cycle: maximum, minimum and mean of every observable.

use super::basis::Basis;
use super::cycle::Cycle;
use super::mesh::Orbit;
use crate::any_problem::DynProblem;
use crate::problem::EvalError;

/// Unknowns that are observed where the problem has no observables, at most.
const MOST_UNKNOWNS: usize = 16;
/// Part of an interval up to which the time of an extremum is sought: the value is then exact to rounding.
const TIME: f64 = 1e-9;
/// Larger part of the golden section.
const GOLDEN: f64 = 0.381_966_011_250_105;

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
    let basis = Basis::new(cycle.degree);
    let n = problem.dim();
    let orbit = Orbit { n, mesh: &cycle.mesh, values: &cycle.values, basis: &basis };
    let (mut u, mut values) = (vec![0.0; n], vec![0.0; own]);
    let mut value = |u: &[f64], out: &mut [f64]| -> Result<(), EvalError> {
        if own == 0 {
            out.copy_from_slice(&u[..count]);
        } else {
            problem.observe(u, &cycle.parameters, &mut values)?;
            out.copy_from_slice(&values);
        }
        Ok(())
    };
    let (m, per_interval) = (cycle.degree, 2 * cycle.degree);
    let mut regular = vec![0.0; per_interval * (m + 1)];
    for (k, weights) in regular.chunks_exact_mut(m + 1).enumerate() {
        basis.evaluate(k as f64 / per_interval as f64, weights);
    }
    let mut times = Vec::with_capacity(per_interval * orbit.intervals());
    let mut samples = vec![0.0; per_interval * orbit.intervals() * count];
    let mut places = samples.chunks_exact_mut(count);
    let (mut means, mut here) = (vec![0.0; count], vec![0.0; count]);
    for (j, w) in cycle.mesh.windows(2).enumerate() {
        let h = w[1] - w[0];
        for ((k, weights), place) in regular.chunks_exact(m + 1).enumerate().zip(&mut places) {
            times.push(w[0] + h * k as f64 / per_interval as f64);
            orbit.within(j, weights, &mut u);
            value(&u, place)?;
        }
        for (weights, weight) in basis.values.chunks_exact(m + 1).zip(&basis.weights) {
            orbit.within(j, weights, &mut u);
            value(&u, &mut here)?;
            means.iter_mut().zip(&here).for_each(|(m, v)| *m += h * weight * v);
        }
    }
    let mut out = Vec::with_capacity(3 * count);
    for k in 0..count {
        for sign in [1.0, -1.0] {
            let sample = |i: usize| sign * samples[i * count + k];
            let best = (0..times.len()).max_by(|a, b| sample(*a).total_cmp(&sample(*b)));
            let best = best.unwrap_or(0);
            let last = times.len() - 1;
            let lo = if best == 0 { times[last] - 1.0 } else { times[best - 1] };
            let hi = if best == last { 1.0 } else { times[best + 1] };
            let top = highest((lo, times[best], hi), sample(best), |t| {
                orbit.at(t, &mut u);
                value(&u, &mut here)?;
                Ok(sign * here[k])
            })?;
            out.push(sign * top);
        }
        out.push(means[k]);
    }
    Ok(out)
}

/// The largest value between `lo` and `hi`, near the place `x` where it is `top`: by parabolas, and by golden
/// sections where these do not serve (Brent 1973).
fn highest(
    (mut lo, mut x, mut hi): (f64, f64, f64),
    mut top: f64,
    mut value: impl FnMut(f64) -> Result<f64, EvalError>,
) -> Result<f64, EvalError> {
    let tolerance = TIME * (hi - lo);
    // the best three places, the steps last made
    let (mut w, mut v) = ((x, top), (x, top));
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if (x - middle).abs() <= 2.0 * tolerance - 0.5 * (hi - lo) {
            break;
        }
        let r = (x - w.0) * (v.1 - top);
        let q = (x - v.0) * (w.1 - top);
        let (mut p, mut q) = ((x - v.0) * q - (x - w.0) * r, 2.0 * (q - r));
        if q > 0.0 {
            p = -p;
        }
        q = q.abs();
        let parabola = before.abs() > tolerance
            && p.abs() < (0.5 * q * before).abs()
            && p > q * (lo - x)
            && p < q * (hi - x);
        if parabola {
            (before, step) = (step, p / q);
        } else {
            before = if x < middle { hi - x } else { lo - x };
            step = GOLDEN * before;
        }
        let place = x + if step.abs() >= tolerance { step } else { tolerance.copysign(step) };
        let here = value(place)?;
        if here >= top {
            if place < x {
                hi = x
            } else {
                lo = x
            }
            (v, w) = (w, (x, top));
            (x, top) = (place, here);
        } else {
            if place < x {
                lo = place
            } else {
                hi = place
            }
            if here >= w.1 || w.0 == x {
                (v, w) = (w, (place, here));
            } else if here >= v.1 || v.0 == x || v.0 == w.0 {
                v = (place, here);
            }
        }
    }
    Ok(top)
}
