//! What a trace is told, and why it could not begin.

use crate::any_problem::DynProblem;
use crate::events::{Beside, Detector, Watch};
use crate::newton::NewtonError;
use crate::problem::{ParamId, Parameter, Stability};
use crate::settings::{Settings, SettingsError};
use crate::singular::{Extended, Probe, deficient_everywhere};
use crate::sound::ProblemError;
use crate::step::Refusal;
use crate::step::{Guard, Weights, dot};
use crate::suspect::{WrongDerivative, wrong_derivative};

/// Why a trace could not begin; [`crate::guide::troubleshooting`] says what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// No parameter of that name.
    #[error("no parameter `{name}`; there are: {known}")]
    UnknownParameter {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// No observable of that name.
    #[error("no observable `{name}`; there are: {known}")]
    UnknownObservable {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A vector of the wrong length.
    #[error("{what} has length {got}, but the problem needs {expected}")]
    Length {
        /// Which vector.
        what: &'static str,
        /// Its length.
        got: usize,
        /// The right length.
        expected: usize,
    },
    /// The starting values are not finite.
    #[error("{what} holds a number that is not finite (index {at})")]
    NotFinite {
        /// Which vector.
        what: &'static str,
        /// Where.
        at: usize,
    },
    /// The problem itself is malformed.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// Newton's method failed with a derivative that is not that of the residual.
    #[error("no solution near the start, and {0}")]
    WrongDerivative(WrongDerivative),
    /// The Jacobian is singular at the start and at every solution near it: the solutions are no
    /// branch.
    #[error(
        "the Jacobian is singular along the whole branch (rank deficiency {deficiency}): a conserved \
         quantity, a symmetry that moves solutions, or an equation twice? Add what fixes it as an \
         equation (`linalg::Arrow` shows how)"
    )]
    SingularEverywhere {
        /// By how much the rank of the Jacobian, with the parameter's column, is short.
        deficiency: usize,
    },
    /// No solution at the start.
    #[error("no solution at the start: {0}")]
    Start(NewtonError),
    /// A branch without the point that is to be left, or of another problem.
    #[error("the branch is not one of this problem through that special point: {what}")]
    Foreign {
        /// What does not fit.
        what: &'static str,
    },
    /// The branch has no tangent at the start, or an observable has no value there.
    #[error("no tangent at the start: {0}")]
    Tangent(Refusal),
}

/// What an observer is told after every point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Points so far.
    pub points: usize,
    /// Special points so far.
    pub events: usize,
    /// Value of the continued parameter.
    pub p: f64,
    /// Arclength so far, in the problem's metric.
    pub s: f64,
}

/// The range over which the parameter is expected to vary.
pub(super) fn range(settings: &Settings, start: f64, parameter: &Parameter) -> f64 {
    match (settings.target, settings.domain) {
        (Some(target), _) if target != start => (target - start).abs(),
        (_, Some((lo, hi))) if (hi - lo).is_finite() => hi - lo,
        // bounded on one side only: the way to the bound
        (_, Some((lo, _))) if lo.is_finite() && lo != start => (start - lo).abs(),
        (_, Some((_, hi))) if hi.is_finite() && hi != start => (hi - start).abs(),
        _ => parameter.scale.abs().max(f64::MIN_POSITIVE),
    }
}

/// Whether the target is where the trace begins: at once reached, unless it is to be left first.
pub(super) fn begins_at_target(settings: &Settings, start: f64) -> bool {
    let rounding = |t: f64| 4.0 * f64::EPSILON * t.abs().max(start.abs());
    let there = settings.target.is_some_and(|t| (t - start).abs() <= rounding(t));
    there && settings.increasing.is_none()
}

/// The error of a start beside which the Jacobian is singular at every solution; `None` if it is not,
/// or if nothing can be said.
pub(super) fn singular_everywhere(
    problem: &DynProblem<'_>,
    which: ParamId,
    u: &[f64],
    p: &[f64],
    range: f64,
    domain: Option<(f64, f64)>,
) -> Option<TraceError> {
    let mut mu = vec![0.0; u.len()];
    problem.metric(u, &mut mu);
    let size = dot(&mu, u).max(0.0).sqrt();
    let scale = problem.unknown_scale(which);
    let weights = Weights {
        unknowns: scale.unwrap_or(if size > 0.0 && size.is_finite() { size } else { 1.0 }),
        parameter: scale.unwrap_or(range),
    };
    let mut probe = Probe::new(problem, which, p, weights);
    let z = Extended { u: u.to_vec(), p: p[which.0] };
    let deficiency = deficient_everywhere(&mut probe, &z, domain)?;
    Some(TraceError::SingularEverywhere { deficiency })
}

/// Why there is no first point: what is wrong with the problem near the start, or Newton's own error.
pub(super) fn no_start(
    problem: &DynProblem<'_>,
    which: ParamId,
    (u, p): (&[f64], &[f64]),
    domain: Option<(f64, f64)>,
    singular: Option<TraceError>,
    error: NewtonError,
) -> TraceError {
    if let Some(singular) = singular {
        return singular;
    }
    if matches!(error, NewtonError::Stuck { .. } | NewtonError::Singular { .. }) {
        let wrong = wrong_derivative(problem, which, (u, p), Guard::new(domain), 1.0);
        return wrong.map_or(TraceError::Start(error), TraceError::WrongDerivative);
    }
    TraceError::Start(error)
}

/// Whether the parameter increases at first.
pub(super) fn increases(settings: &Settings, start: f64) -> bool {
    settings.increasing.unwrap_or_else(|| settings.target.is_none_or(|target| target > start))
}

/// Checks a vector's length and that it is finite.
pub(super) fn check(what: &'static str, values: &[f64], expected: usize) -> Result<(), TraceError> {
    if values.len() != expected {
        return Err(TraceError::Length { what, got: values.len(), expected });
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(at) => Err(TraceError::NotFinite { what, at }),
        None => Ok(()),
    }
}

/// The error that names an observable that is not there.
fn unknown_observable(problem: &DynProblem<'_>, name: String) -> TraceError {
    TraceError::UnknownObservable { name, known: problem.observables().join(", ") }
}

/// What finds the special points of a step.
pub(super) fn detector(
    problem: &DynProblem<'_>,
    watches: &[Watch],
    settings: &Settings,
) -> Result<Detector, TraceError> {
    let (target, domain) = (settings.target, settings.domain);
    let extended = problem.special_points().map(|curve| Beside {
        pair: curve.crossing_pair().is_some(),
        zero: curve.crossing_zero().is_some(),
    });
    let separate = problem.stability() == Stability::SeparateHessian;
    Detector::new(watches, problem.observables(), target, domain, extended)
        .map(|detector| detector.with_separate_stability(separate))
        .map_err(|name| unknown_observable(problem, name))
}
