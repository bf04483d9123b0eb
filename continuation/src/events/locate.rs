//! Location of a special point between two solutions.
//!
//! The branch between them is parametrised by the distance from the first in the direction of
//! its tangent; every evaluation is a converged solution on the branch, reached from a Hermite
//! interpolant of both ends, with its tangent exact. On it the test function (dp/ds of the
//! exact tangent for a fold) is a smooth scalar with a simple zero, which a bracketed
//! superlinear search finds to rounding.

use super::detect::Candidate;
use super::hermite::basis;
use super::root::Search;
use crate::step::{Constraint, Core, Precision, Refusal, State};

/// Where a special point was found; its state is in the work space handed to [`locate`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Located {
    /// Scaled distance from the step's first end.
    pub(crate) at: f64,
    /// Estimated error of `at`.
    pub(crate) error: f64,
}

pub(super) const MAX_EVALUATIONS: usize = 60;

/// Locates `candidate` between `a` and `b`, a scaled distance `h` apart; its state goes to `x`.
pub(crate) fn locate(
    core: &mut Core<'_>,
    a: &State,
    b: &State,
    h: f64,
    candidate: &Candidate,
    tolerance: f64,
    x: &mut State,
) -> Result<Located, Refusal> {
    let bend = bend(core, a, b);
    let tolerance = match candidate {
        // the corrector itself is singular there
        Candidate::BranchPoint { .. } => tolerance.max(1e-7 * h),
        // bisection
        Candidate::Stability { .. } => tolerance.max(1e-9 * h),
        _ => tolerance,
    };
    let (ta, tb) = (candidate.test(a, a.orientation), candidate.test(b, a.orientation));
    if tb == 0.0 {
        x.copy_from(b);
        return Ok(Located { at: h, error: tolerance });
    }
    if let Candidate::Parameter { value, .. } = *candidate
        && let Some(at) = parameter_guess(a, b, h, bend, value)
    {
        interpolate(a, b, h, bend, at, x);
        if core.correct(Constraint::Parameter(a, value), x, Precision::Event).is_ok() {
            // the value itself, and not what is left of it after corrections
            if (x.p - value).abs() <= 1e-14 * (value.abs() + core.weights.parameter) {
                x.p = value;
            }
            return Ok(Located { at, error: f64::EPSILON * (1.0 + value.abs()) });
        }
    }
    if ta * tb > 0.0 {
        return Err(Refusal::Unresolved);
    }
    let mut search = Search::new(0.0, ta, h, tb);
    let mut correction = 0.0_f64;
    let mut evaluated = None;
    for _ in 0..MAX_EVALUATIONS {
        let at = search.next(0.3 * tolerance);
        interpolate(a, b, h, bend, at, x);
        match core.correct(Constraint::Plane(a, at), x, Precision::Event) {
            Ok(done) => correction = done.last,
            // as close to the singular point as the corrector gets
            Err(_) if matches!(candidate, Candidate::BranchPoint { .. }) => break,
            Err(refusal) => return Err(refusal),
        }
        let value = candidate.test(x, a.orientation);
        if !value.is_finite() {
            return Err(Refusal::Unresolved);
        }
        search.record(at, value);
        evaluated = Some(at);
        if value == 0.0 || search.error() <= tolerance || search.width() <= tolerance {
            break;
        }
    }
    let (best, _) = search.best();
    if evaluated != Some(best) {
        interpolate(a, b, h, bend, best, x);
        correction = core.correct(Constraint::Plane(a, best), x, Precision::Event)?.last;
    }
    let mut error = error_at(&search, correction);
    if matches!(candidate, Candidate::BranchPoint { .. } | Candidate::Stability { .. }) {
        // signs alone do not say at which end
        error = error.max(search.width());
    }
    Ok(Located { at: best, error })
}

/// The estimated error of the best end of a bracket, whose state the last correction moved by
/// `correction`.
pub(super) fn error_at(search: &Search, correction: f64) -> f64 {
    let (best, _) = search.best();
    // the secant's own error is a small part of what it says
    1.25 * search.error().max(correction).max(f64::EPSILON * (1.0 + best))
}

/// Where the Hermite cubic of the parameter takes a value.
fn parameter_guess(a: &State, b: &State, h: f64, bend: f64, value: f64) -> Option<f64> {
    let p = |x: f64| {
        let [w0, w1, w2, w3] = basis(x / h);
        w0 * a.p + w1 * h * a.tp + w2 * b.p + w3 * h * b.tp / bend - value
    };
    // the first crossing: a fold may lie before or behind it
    let pieces = 16;
    let (mut lo, mut f_lo) = (0.0, p(0.0));
    for k in 1..=pieces {
        let hi = h * f64::from(k) / f64::from(pieces);
        let f_hi = p(hi);
        if f_lo * f_hi < 0.0 || f_hi == 0.0 {
            let mut search = Search::new(lo, f_lo, hi, f_hi);
            for _ in 0..MAX_EVALUATIONS {
                if search.width() <= 1e-14 * h || search.best().1 == 0.0 {
                    break;
                }
                let x = search.next(1e-15 * h);
                search.record(x, p(x));
            }
            return Some(search.best().0);
        }
        (lo, f_lo) = (hi, f_hi);
    }
    None
}

/// By how much the branch's own speed exceeds that of its projection at the far end: the cosine
/// between the tangents at both.
pub(crate) fn bend(core: &Core<'_>, a: &State, b: &State) -> f64 {
    core.weights.dot(&a.mtu, a.tp, &b.tu, b.tp)
}

/// Hermite interpolation of the solution at a scaled distance `at` from `a` along its tangent.
pub(crate) fn interpolate(a: &State, b: &State, h: f64, bend: f64, at: f64, x: &mut State) {
    let [w0, w1, w2, w3] = basis(at / h);
    let (w1, w3) = (w1 * h, w3 * h / bend);
    for i in 0..x.u.len() {
        x.u[i] = w0 * a.u[i] + w1 * a.tu[i] + w2 * b.u[i] + w3 * b.tu[i];
    }
    x.p = w0 * a.p + w1 * a.tp + w2 * b.p + w3 * b.tp;
}
