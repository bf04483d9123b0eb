//! Branches without mirror symmetry: those that leave a symmetric one where the symmetry is lost, and
//! those that are known from a state on them.
//!
//! Where the stiffness of a symmetric state against odd variations is singular the branch point is a
//! pitchfork, by symmetry: the new states begin along the odd null vector `φ`, with `z0` stationary.
//! `φ` is found among odd vectors alone, so that nothing even disturbs it. The two halves of a pitchfork
//! are mirror images of each other, and one is followed; where it is symmetric again it would go on as
//! its own mirror image, and ends.
//!
//! Beside a fold at which a branch of the half nearly crosses another, as that of flat shapes and that
//! of buckled ones do, the pitchfork is as sharp as the fold: its parabola is narrower than any step.
//! Such a fork is not left here ([`ForkError::TooSharp`]); two springs ([`super::next_unconnected`])
//! give a state on its branch a little farther on.

use super::TwoPlatesProblem;
use super::search::{SYMMETRIC, distance};
use continuation::{
    Branch, Crossing, Detail, Direction, EvalError, Event, EventKind, Matrix, Point, Problem,
    Progress, Settings, Shape, Statistics, Stop, StopReason, TraceError, Tracer, Watch, both_ways,
};
use std::ops::ControlFlow;

/// Inverse iterations: at a branch point that is located to 1e-10 two are enough.
const ITERATIONS: usize = 30;
/// Change of the vector, of unit length, at which they end.
const SETTLED: f64 = 1e-10;

/// Why a branch cannot be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ForkError {
    /// The branch is not one of half the shell, or has no such point.
    #[error("the symmetric branch has no such point, or is not one in z0")]
    NoPoint,
    /// The state is no state of the whole shell.
    #[error("the symmetric state cannot be evaluated: {0}")]
    Evaluation(#[from] EvalError),
    /// No odd vector is singled out.
    #[error("no antisymmetric mode turns at this state")]
    NoMode,
    /// No step led to an asymmetric state.
    #[error("no step leads from the symmetric state to an asymmetric one")]
    TooSharp,
    /// The tracer refuses.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// Follows the branch that leaves `symmetric`, a branch of [`ContactProblem`](crate::ContactProblem)
/// in `z0` on the same mesh and with the same plate on both sides, at its point number `at`, where an
/// antisymmetric mode turns ([`crate::modes::scan_branch`]). That state is the first point; `unstable`
/// is the number of unstable axisymmetric modes there, of both parities, without the one that turns.
/// The branch ends as the settings say, or where it is symmetric again ([`StopReason::Retraced`]).
///
/// # Errors
/// When the point is no such state, or no other state is found beside it.
pub fn leave_symmetry(
    problem: &TwoPlatesProblem,
    symmetric: &Branch,
    at: usize,
    unstable: Option<usize>,
    settings: Settings,
    watches: &[Watch],
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Branch, ForkError> {
    let (trunk, event, direction) = fork(problem, symmetric, at, unstable)?;
    let tracer = Tracer::leaving(problem, &trunk, &event, &direction, true, settings)?;
    let branch = tracer.watching(watches)?.run(observer);
    let asymmetry = |point: &Point| distance(problem, &point.u, &problem.reflected(&point.u));
    if branch.points.get(1).is_none_or(|point| asymmetry(point) < SYMMETRIC) {
        return match branch.stopped.reason {
            StopReason::Interrupted => Ok(branch),
            _ => Err(ForkError::TooSharp),
        };
    }
    Ok(one_image(problem, branch, 1))
}

/// Follows the branch through the asymmetric state near `u` both ways, each as far as the settings say
/// or to where it is symmetric. `settings` need a domain.
///
/// # Errors
/// When there is no state near `u`.
pub fn follow_asymmetric(
    problem: &TwoPlatesProblem,
    u: &[f64],
    z0: f64,
    settings: Settings,
    watches: &[Watch],
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Branch, TraceError> {
    let p = problem.parameters_at(z0);
    let name = &problem.parameters()[super::parameter::Z0.0].name;
    let branch = both_ways(problem, name, u, &p, settings, watches, observer)?;
    let off = |point: &Point| distance(problem, &point.u, u) + (point.p - z0).abs();
    let nearest = (0..branch.points.len())
        .min_by(|a, b| off(&branch.points[*a]).total_cmp(&off(&branch.points[*b])));
    Ok(one_image(problem, branch, nearest.unwrap_or(0)))
}

/// The part of a branch about its point `inside` that is not the mirror image of the rest: up to where
/// it is symmetric, or passes from one image to the other between two points.
fn one_image(problem: &TwoPlatesProblem, mut branch: Branch, inside: usize) -> Branch {
    let odd = |k: usize| odd_part(problem, &branch.points[k].u);
    let turns = |from: usize, to: usize| {
        let (a, b) = (odd(from), odd(to));
        let mut y = vec![0.0; a.len()];
        problem.metric(&a, &mut y);
        y.iter().zip(&b).map(|(y, b)| y * b).sum::<f64>() <= 0.0
    };
    let is_symmetric = |k: usize| 2.0 * norm(problem, &odd(k)) < SYMMETRIC;
    // a symmetric state ends it, as its last; a turn without one is not taken
    let goes_on =
        |from: usize, to: usize| !is_symmetric(from) && (is_symmetric(to) || !turns(from, to));
    let mut last = inside;
    while last + 1 < branch.points.len() && goes_on(last, last + 1) {
        last += 1;
    }
    let mut first = inside;
    while first > 0 && goes_on(first, first - 1) {
        first -= 1;
    }
    let retraced = || Stop {
        reason: StopReason::Retraced,
        detail: "the branch is symmetric here; its mirror image goes on".to_owned(),
    };
    if last + 1 < branch.points.len() {
        branch.stopped = retraced();
    }
    if first > 0 {
        branch.began = Some(retraced());
    }
    let began = branch.points[first].s;
    branch.points.truncate(last + 1);
    branch.points.drain(..first);
    let dropped = branch.events.iter().take_while(|event| event.point < first).count();
    branch.events.drain(..dropped);
    branch.events.retain(|event| event.point <= last);
    for event in &mut branch.events {
        event.point -= first;
    }
    for point in &mut branch.points {
        point.s -= began;
        point.event = point.event.map(|event| event - dropped);
    }
    branch
}

/// What the engine needs to know of the branch point: a branch that holds it and its far ends, by
/// which lengths are scaled, the event, and the direction that leaves.
fn fork(
    problem: &TwoPlatesProblem,
    symmetric: &Branch,
    at: usize,
    unstable: Option<usize>,
) -> Result<(Branch, Event, Direction), ForkError> {
    let points = &symmetric.points;
    if at >= points.len() || symmetric.parameter != "z0" {
        return Err(ForkError::NoPoint);
    }
    let last = points.len() - 1;
    let whole = |k: usize| Point {
        u: problem.joined(&points[k].u, &points[k].u, 0.0),
        event: None,
        eigenvalues: Vec::new(),
        ..points[k].clone()
    };
    let (before, after) = (whole(at.saturating_sub(1)), whole((at + 1).min(last)));
    let along = before.u.iter().zip(&after.u).map(|(a, b)| b - a).collect();
    let traced = direction(problem, along, after.p - before.p);
    let state = Point { unstable, ..whole(at) };
    let parameters = problem.parameters_at(state.p);
    let leaving = direction(problem, odd_mode(problem, &state.u, &parameters)?, 0.0);
    let crossing = Crossing {
        shape: Shape::Pitchfork,
        criticality: None,
        from_side: false,
        multiplicity: 1,
        curvature: 0.0,
        curvature_error: f64::INFINITY,
        traced,
        leaving: vec![leaving.clone()],
    };
    let event = Event {
        kind: EventKind::BranchPoint,
        point: 0,
        p: state.p,
        unstable_before: None,
        unstable_after: None,
        residual: 0.0,
        error_estimate: 0.0,
        detail: Detail::Crossing(crossing),
        eigenvectors: Vec::new(),
    };
    let trunk = Branch {
        parameter: symmetric.parameter.clone(),
        parameters,
        observables: Vec::new(),
        points: vec![state, whole(0), whole(last)],
        events: Vec::new(),
        doubts: Vec::new(),
        stopped: symmetric.stopped.clone(),
        began: None,
        statistics: Statistics::default(),
    };
    Ok((trunk, event, leaving))
}

/// A direction of unit length. What happens along it the steps find out.
fn direction<P: Problem>(problem: &P, mut du: Vec<f64>, dp: f64) -> Direction {
    let length = norm(problem, &du).hypot(dp);
    du.iter_mut().for_each(|x| *x /= length);
    Direction { du, dp: dp / length, bend: 0.0, amplitude: 0.0, offset: None }
}

/// The odd vector whose stiffness is nearest to zero, by inverse iteration among odd vectors.
pub(super) fn odd_mode(
    problem: &TwoPlatesProblem,
    u: &[f64],
    p: &[f64],
) -> Result<Vec<f64>, ForkError> {
    let mut stiffness = problem.new_jacobian();
    problem.jacobian(u, p, &mut stiffness)?;
    stiffness.factor(f64::EPSILON * stiffness.norm());
    let unit = |x: &[f64]| {
        let mut odd = odd_part(problem, x);
        let length = norm(problem, &odd);
        odd.iter_mut().for_each(|x| *x /= length);
        length.is_normal().then_some(odd).ok_or(ForkError::NoMode)
    };
    // all modes have a share in it
    let start: Vec<f64> = (0..u.len()).map(|i| 1.0 / (1.0 + i as f64)).collect();
    let mut x = unit(&start)?;
    for _ in 0..ITERATIONS {
        let mut y = vec![0.0; x.len()];
        problem.metric(&x, &mut y);
        let mut next = y.clone();
        stiffness.solve(&mut next);
        let mut next = unit(&next)?;
        if y.iter().zip(&next).map(|(a, b)| a * b).sum::<f64>() < 0.0 {
            next.iter_mut().for_each(|x| *x = -*x);
        }
        let change = distance(problem, &x, &next);
        x = next;
        if change < SETTLED {
            return Ok(x);
        }
    }
    Err(ForkError::NoMode)
}

/// Half of what sets a vector apart from its mirror image.
fn odd_part(problem: &TwoPlatesProblem, x: &[f64]) -> Vec<f64> {
    x.iter().zip(&problem.reflected(x)).map(|(x, y)| 0.5 * (x - y)).collect()
}

fn norm<P: Problem>(problem: &P, x: &[f64]) -> f64 {
    distance(problem, x, &vec![0.0; x.len()])
}
