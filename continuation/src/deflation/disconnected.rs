//! Solutions that are on none of the known branches.

use super::known::Known;
use super::{
    Deflation, DeflationError, DeflationReport, DeflationSettings, check, check_branch, passing,
};
use crate::any_problem::DynProblem;
use crate::branch::Branch;
use crate::near::NearBifurcation;
use crate::problem::Problem;
use crate::step::dot;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Points of each branch from which attempts start.
const STATES: usize = 12;
/// Distances from a near-bifurcation at which its other branch is sought, in gaps.
const OFFSETS: [f64; 3] = [4.0, 20.0, 1.0];
/// How far from a near-bifurcation its other branch is sought, in units of the larger of the natural
/// amplitude and the distance of the known branch.
const BESIDE: f64 = 4.0;
/// The shortest and the longest one, in parts of the parameter's range.
const SPAN: (f64, f64) = (1e-4, 1.0);

/// A solution on no known branch: a start for [`crate::both_ways`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OffBranch {
    /// The unknowns.
    pub u: Vec<f64>,
    /// All parameters.
    pub p: Vec<f64>,
    /// The near-bifurcation beside which it was found, an index into those that were handed over;
    /// `None` where it was found at a chosen value.
    pub near: Option<usize>,
}

/// Solutions that none of `branches` passes, found by deflation beside the near-bifurcations `near`
/// and at the chosen values of the branches' parameter.
///
/// Beside a near-bifurcation attempts start from the known branches mirrored in it and from steps
/// along its direction, either way, at parameters on both sides; outside of the branches' range of the
/// parameter only where nothing is found inside and a fold is what bounds it. At a chosen value they start beside
/// the known solutions there ([`Deflation`]) and from states of the branches at other values. A
/// solution is on a branch if Newton's method leads to it from where the branch passes the value.
///
/// Several of them may be on one branch, which is not known before it is followed:
///
/// ```
/// use continuation::deflation::{DeflationSettings, disconnected, lies_on};
/// use continuation::{DenseProblem, NearSettings, Settings, Tracer, both_ways, near_bifurcations};
/// use std::ops::ControlFlow;
///
/// let problem = DenseProblem::from_residual(1, &["p"], |x, p, r| {
///     r[0] = p[0] * x[0] - x[0].powi(3) + 1e-3;
/// });
/// let mut go_on = |_: &_| ControlFlow::Continue(());
/// let settings = Settings { domain: Some((-1.0, 1.0)), ..Settings::default() };
/// let first = Tracer::new(&problem, "p", &[0.0], &[-1.0], settings.clone())?.run(&mut go_on);
/// let near = near_bifurcations(&problem, &first, NearSettings::default())?;
///
/// let mut branches = vec![first];
/// let search = DeflationSettings::default();
/// for start in disconnected(&problem, &branches, &near, &[], &search)? {
///     let known = |b: &_| lies_on(&problem, b, &start.u, &start.p, &search);
///     if !branches.iter().map(known).collect::<Result<Vec<_>, _>>()?.contains(&true) {
///         let (u, p) = (&start.u, &start.p);
///         branches.push(both_ways(&problem, "p", u, p, settings.clone(), &[], &mut go_on)?);
///     }
/// }
/// assert_eq!(branches.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When no branch is given, a branch or a near-bifurcation is not one of this problem, a setting is
/// out of range or a value not finite.
pub fn disconnected<P: Problem + ?Sized>(
    problem: &P,
    branches: &[Branch],
    near: &[NearBifurcation],
    values: &[f64],
    settings: &DeflationSettings,
) -> Result<Vec<OffBranch>, DeflationError> {
    let mut go_on = |_: &DeflationReport| ControlFlow::Continue(());
    disconnected_observed(problem, branches, near, values, settings, &mut go_on)
}

/// The same; the observer is called after every attempt, with the report of the search at that value of
/// the parameter, and may end all of it. Nothing found is lost.
///
/// # Errors
/// As for [`disconnected`].
pub fn disconnected_observed<P: Problem + ?Sized>(
    problem: &P,
    branches: &[Branch],
    near: &[NearBifurcation],
    values: &[f64],
    settings: &DeflationSettings,
    observer: &mut dyn FnMut(&DeflationReport) -> ControlFlow<()>,
) -> Result<Vec<OffBranch>, DeflationError> {
    let branches: Vec<&Branch> = branches.iter().collect();
    off_branches(&problem, &branches, near, values, settings, observer)
}

/// [`disconnected_observed`], of branches that lie anywhere.
pub(crate) fn off_branches(
    problem: &DynProblem<'_>,
    branches: &[&Branch],
    near: &[NearBifurcation],
    values: &[f64],
    settings: &DeflationSettings,
    observer: &mut dyn FnMut(&DeflationReport) -> ControlFlow<()>,
) -> Result<Vec<OffBranch>, DeflationError> {
    let mut run = |search: Deflation<'_>| {
        let mut stopped = false;
        let found = search.run_observed(&mut |report| {
            let flow = observer(report);
            stopped |= flow.is_break();
            flow
        });
        (found.solutions.into_iter().map(|s| s.u).collect::<Vec<_>>(), stopped)
    };
    let first = branches.first().ok_or(DeflationError::NoBranch)?;
    let which = check_branch(problem, first)?;
    check("the chosen values", values, values.len())?;
    let at = |value: f64| {
        let mut p = first.parameters.clone();
        p[which] = value;
        p
    };
    let mut found = Vec::new();
    for (k, one) in near.iter().enumerate() {
        check("a near-bifurcation", &one.u, problem.dim())?;
        check("its direction", &one.direction.du, problem.dim())?;
        let before = found.len();
        for inside in [true, false] {
            for side in [1.0, -1.0] {
                for value in offsets(branches, which, problem, one, side, inside) {
                    let p = at(value);
                    let search = beside(problem, branches, which, one, &p, settings)?;
                    let (solutions, stopped) = run(search);
                    let some = !solutions.is_empty();
                    let start = |u| OffBranch { u, p: p.clone(), near: Some(k) };
                    found.extend(solutions.into_iter().map(start));
                    if stopped {
                        return Ok(found);
                    }
                    if some {
                        break;
                    }
                }
            }
            if found.len() > before {
                break;
            }
        }
    }
    for value in values {
        let p = at(*value);
        let mut search = Deflation::of(problem, &p, settings.clone())?;
        for branch in branches {
            search = search.along(branch, STATES)?;
        }
        let (solutions, stopped) = run(search);
        found.extend(solutions.into_iter().map(|u| OffBranch { u, p: p.clone(), near: None }));
        if stopped {
            break;
        }
    }
    Ok(found)
}

/// Whether a branch passes the solution `u` at the parameters `p`: whether that is the solution to
/// which Newton's method leads from one of the places where the branch passes the value.
///
/// # Errors
/// When the branch is not one of this problem, a setting is out of range, or a vector has the wrong
/// length or is not finite.
pub fn lies_on<P: Problem + ?Sized>(
    problem: &P,
    branch: &Branch,
    u: &[f64],
    p: &[f64],
    settings: &DeflationSettings,
) -> Result<bool, DeflationError> {
    is_on(&problem, branch, u, p, settings)
}

/// [`lies_on`] of a problem of unknown type.
pub(crate) fn is_on(
    problem: &DynProblem<'_>,
    branch: &Branch,
    u: &[f64],
    p: &[f64],
    settings: &DeflationSettings,
) -> Result<bool, DeflationError> {
    settings.validate()?;
    let which = check_branch(problem, branch)?;
    check("the solution", u, problem.dim())?;
    check("the parameter vector", p, problem.parameters().len())?;
    if (0..p.len()).any(|k| k != which && p[k] != branch.parameters[k]) {
        return Ok(false);
    }
    let passing = passing::solutions(problem, branch, p, which, settings);
    let mut known = Known::new(problem);
    known.solutions = passing.solutions;
    known.length = passing::extent(&mut known, branch);
    let met = known.contains(u, settings.separation);
    Ok(met || passing.unresolved.iter().any(|passage| passage.covers(&mut known, u)))
}

/// Values of the parameter on one side of a near-bifurcation, inside or outside of the range of the
/// branches. Beyond the end of a branch, where it goes on without being known, there are none.
fn offsets(
    branches: &[&Branch],
    which: usize,
    problem: &DynProblem<'_>,
    near: &NearBifurcation,
    side: f64,
    inside: bool,
) -> Vec<f64> {
    let name = &problem.parameters()[which].name;
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
    for branch in branches.iter().filter(|b| b.parameter == *name) {
        for p in branch.points.iter().map(|point| point.p) {
            (lo, hi) = (lo.min(p), hi.max(p));
        }
        for end in [branch.points.first(), branch.points.last()].into_iter().flatten() {
            (first, last) = (first.min(end.p), last.max(end.p));
        }
    }
    let value = |x: f64| near.p + side * (x * near.gap).clamp(SPAN.0, SPAN.1) * (hi - lo);
    let allowed = |p: &f64| match inside {
        true => (lo..=hi).contains(p),
        false => (*p < lo && lo < first) || (*p > hi && hi > last),
    };
    OFFSETS.into_iter().map(value).filter(allowed).collect()
}

/// The search at the parameters `p` beside a near-bifurcation.
fn beside<'a>(
    problem: &'a DynProblem<'a>,
    branches: &[&Branch],
    which: usize,
    near: &NearBifurcation,
    p: &[f64],
    settings: &DeflationSettings,
) -> Result<Deflation<'a>, DeflationError> {
    let mut starts: Vec<Vec<f64>> = Vec::new();
    let mut m = vec![0.0; problem.dim()];
    let v = &near.direction.du;
    problem.metric(v, &mut m);
    let vv = dot(v, &m);
    let mut opposite = p.to_vec();
    opposite[which] = 2.0 * near.p - p[which];
    let (mut here, mut there) = (Vec::new(), Vec::new());
    for branch in branches {
        if check_branch(problem, branch)? == which {
            here.extend(passing::states(branch, p[which]));
            there.extend(passing::states(branch, opposite[which]));
        }
    }
    // what belongs to other parts of the diagram is far away
    let mut scratch = vec![0.0; problem.dim()];
    let mut apart = |u: &Vec<f64>| {
        let d: Vec<f64> = u.iter().zip(&near.u).map(|(a, b)| a - b).collect();
        problem.metric(&d, &mut scratch);
        dot(&d, &scratch).max(0.0).sqrt()
    };
    let nearest = here.iter().map(&mut apart).fold(f64::INFINITY, f64::min);
    let natural = near.direction.amplitude.abs() * vv.max(0.0).sqrt();
    let size = if nearest.is_finite() { nearest.max(natural) } else { natural };
    let reach = settings.reach.unwrap_or(BESIDE * size);
    here.retain(|u| apart(u) <= reach);
    there.retain(|u| apart(u) <= reach);
    let reach = (reach > 0.0).then_some(reach);
    let settings = DeflationSettings { modes: 0, reach, ..settings.clone() };
    for u in here {
        let from: Vec<f64> = u.iter().zip(&near.u).map(|(a, b)| a - b).collect();
        let along = if vv > 0.0 { dot(&from, &m) / vv } else { 0.0 };
        starts.push(u.iter().zip(v).map(|(u, v)| u - 2.0 * along * v).collect());
        starts.push(u.iter().zip(&from).map(|(u, d)| u - 2.0 * d).collect());
    }
    for u in there {
        starts.push(near.u.iter().zip(&u).map(|(c, u)| 2.0 * c - u).collect());
        starts.push(u);
    }
    let part = near.gap.sqrt();
    for x in [part, 4.0 * part, near.gap, 1.0] {
        for amplitude in [x * near.direction.amplitude, -x * near.direction.amplitude] {
            starts.push(near.u.iter().zip(v).map(|(u, v)| u + amplitude * v).collect());
        }
    }
    let mut search = Deflation::of(problem, p, settings)?.starts(&starts)?;
    for branch in branches {
        search = search.along(branch, 0)?;
    }
    Ok(search)
}
