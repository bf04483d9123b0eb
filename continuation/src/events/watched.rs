//! Zeros and extrema of observables, which need not be continuous.
//!
//! A bracket shrinks to a pole or a jump as readily as to a zero. What tells them apart is that the
//! values at its ends do not: those of a continuous function approach each other.

use super::detect::Candidate;
use super::locate::{Located, MAX_EVALUATIONS, bend, error_at, interpolate};
use super::root::Search;
use crate::step::{Constraint, Core, Precision, Refusal, State};

/// A test function below this part of its values at the ends of the step is zero, however it got
/// there; slopes may be differences of the observable, and so have more noise.
const SMALL: f64 = 1e-6;
const SMALL_SLOPE: f64 = 1e-3;
/// A bracket shorter than an earlier one by this factor shows whether the values shrink.
const SHORTER: f64 = 30.0;
/// Part of the earlier difference that remains over a jump; a continuous function keeps less,
/// were it as steep as a tenth root.
const REMAINS: f64 = 0.7;
/// By how much a corner may exceed what the flatter slope explains.
const CORNER: f64 = 1e3;
/// Part of a step over which errors of a slope do not count.
const FAR: f64 = 1e-3;
/// The same for what only makes its rounding another.
const ASIDE: f64 = 1e-12;
/// By how much an error may exceed what two slopes show of it.
const NOISE: f64 = 4.0;
/// States by which the rounding of an extremum's slope is judged.
const DRAWS: u32 = 3;
/// Most corrections of an extremum's place.
const SETTLINGS: usize = 4;
/// Shortest bracket: state and distance are rounded.
const SHORTEST: f64 = 1e-14;

/// Locates a zero or an extremum of an observable between `a` and `b`, a scaled distance `h` apart;
/// its state goes to `x`. `None` where the observable has a pole or a jump instead.
pub(crate) fn locate_watched(
    core: &mut Core<'_>,
    (a, b): (&State, &State),
    h: f64,
    candidate: &Candidate,
    tolerance: f64,
    x: &mut State,
) -> Result<Option<Located>, Refusal> {
    let (observable, small, precision) = match *candidate {
        Candidate::Value { observable, .. } => (observable, SMALL, Precision::Place),
        Candidate::Extremum { observable } => (observable, SMALL_SLOPE, Precision::Event),
        _ => return Err(Refusal::Unresolved),
    };
    let bend = bend(core, a, b);
    let (ta, tb) = (candidate.test(a, a.orientation), candidate.test(b, a.orientation));
    if tb == 0.0 {
        x.copy_from(b);
        return Ok(Some(Located { at: h, error: tolerance }));
    }
    let least = small * ta.abs().max(tb.abs());
    let shortest = tolerance.min(1e-6 * h).max(SHORTEST);
    let mut search = Search::new(0.0, ta, h, tb);
    // widths of the bracket with the difference between its ends
    let mut brackets = vec![(h, (tb - ta).abs())];
    let mut values = vec![(0.0, ta), (h, tb)];
    let (mut correction, mut evaluated) = (0.0, None);
    for _ in 0..2 * MAX_EVALUATIONS {
        let at = search.next(0.3 * shortest);
        interpolate(a, b, h, bend, at, x);
        correction = core.correct(Constraint::Plane(a, at), x, precision)?.last;
        let value = candidate.test(x, a.orientation);
        if !value.is_finite() {
            return Ok(None);
        }
        search.record(at, value);
        values.push((at, value));
        brackets.push((search.width(), search.spread()));
        evaluated = Some(at);
        let near = search.error() <= tolerance || search.width() <= tolerance;
        let ends = search.best().1.abs() <= least || search.width() <= shortest;
        if value == 0.0 || (near && ends) {
            break;
        }
    }
    let (best, value) = search.best();
    if evaluated != Some(best) {
        interpolate(a, b, h, bend, best, x);
        correction = core.correct(Constraint::Plane(a, best), x, precision)?.last;
    }
    let shrinks = value.abs() <= least || continuous(&brackets);
    let found = match candidate {
        Candidate::Extremum { .. } => {
            let ends = [a, b, &*x].map(|s| (s.values[observable], s.slopes[observable]));
            extreme(ends, h, !shrinks)
        }
        _ => shrinks,
    };
    let mut located = Located { at: best, error: error_at(&search, correction) };
    if found && shrinks && matches!(candidate, Candidate::Extremum { .. }) {
        let value = |x: &State| candidate.test(x, a.orientation);
        settle(core, (a, h), (&values, tolerance), value, &mut located, x)?;
    }
    Ok(found.then_some(located))
}

/// Moves an extremum by what the slope of a state that is corrected once more says, and takes as its
/// error what that changes: a slope shows the error of a state much magnified where the tangent turns
/// fast, and then a bracket closes about a place that is no extremum.
fn settle(
    core: &mut Core<'_>,
    (a, h): (&State, f64),
    (values, tolerance): (&[(f64, f64)], f64),
    value: impl Fn(&State) -> f64,
    located: &mut Located,
    x: &mut State,
) -> Result<(), Refusal> {
    // how steep the slope is, over a distance on which its errors do not count
    let own = value(x);
    let away = values.iter().filter(|(at, _)| (at - located.at).abs() >= FAR * h);
    let near = away.min_by(|p, q| (p.0 - located.at).abs().total_cmp(&(q.0 - located.at).abs()));
    let Some(&(at, other)) = near else { return Ok(()) };
    let steep = (other - own) / (at - located.at);
    // a little beside it first, so that the rounding is another
    let aside = ASIDE * if located.at > 0.5 * h { -h } else { h };
    let (mut at, mut off) = (located.at + aside, f64::INFINITY);
    for _ in 0..SETTLINGS {
        let again = core.correct(Constraint::Plane(a, at), x, Precision::Event)?.last;
        let now = (value(x) / steep).abs();
        if !now.is_finite() {
            return Ok(());
        }
        let known = again.max(f64::EPSILON * (1.0 + at));
        (located.at, located.error) = (at, NOISE * now.max(known));
        if now <= tolerance.max(known) || 2.0 * now >= off {
            // one draw of the noise may be small by chance
            for k in 1..DRAWS {
                let beside = at + f64::from(k) * aside;
                core.correct(Constraint::Plane(a, beside), x, Precision::Event)?;
                located.error = located.error.max(NOISE * (value(x) / steep).abs());
            }
            break;
        }
        off = now;
        at = (at - value(x) / steep).clamp(0.0, h);
    }
    Ok(())
}

/// Whether the difference between the ends of the bracket has shrunk with it.
fn continuous(brackets: &[(f64, f64)]) -> bool {
    let Some(&(width, spread)) = brackets.last() else { return false };
    let before = brackets.iter().rev().find(|(w, _)| *w >= SHORTER * width);
    before.is_some_and(|(_, earlier)| spread <= REMAINS * earlier)
}

/// Whether `x` differs from both ends by no more than the slopes there explain, and, where it is a
/// corner, lies beyond both.
fn extreme([a, b, x]: [(f64, f64); 3], h: f64, corner: bool) -> bool {
    let (above, below) = (x.0 - a.0, x.0 - b.0);
    let steep = if corner { a.1.abs().min(b.1.abs()) } else { a.1.abs().max(b.1.abs()) };
    let beyond = above * a.1 >= 0.0 && below * a.1 >= 0.0;
    (beyond || !corner) && above.abs().max(below.abs()) <= CORNER * h * steep
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differences over brackets that halve around `at`.
    fn brackets(f: impl Fn(f64) -> f64, at: f64) -> Vec<(f64, f64)> {
        let widths = (1..40).map(|k| 0.5_f64.powi(k));
        widths.map(|w| (w, (f(at + 0.6 * w) - f(at - 0.4 * w)).abs())).collect()
    }

    #[test]
    fn zeros_of_steep_functions_are_told_from_jumps_and_poles() {
        assert!(continuous(&brackets(|x| x - 0.3, 0.3)));
        assert!(continuous(&brackets(|x| (x - 0.3).cbrt(), 0.3)));
        assert!(continuous(&brackets(|x| ((x - 0.3) * 1e9).tanh(), 0.3)));
        assert!(!continuous(&brackets(|x| (x - 0.3).signum(), 0.3)));
        assert!(!continuous(&brackets(|x| (x - 0.3).signum() + x, 0.3)));
        assert!(!continuous(&brackets(|x| 1.0 / (x - 0.3), 0.3)));
    }
}
