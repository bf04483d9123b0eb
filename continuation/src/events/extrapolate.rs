//! Special points that undo each other within one step: a pair of eigenvalues, or a real one, that
//! crosses the imaginary axis and comes back, two folds.
//!
//! Both ends of the step have the same counts then. What betrays the two is a test function (the
//! real part nearest to the axis, the parameter's slope) that turns towards zero between the ends:
//! the parabola through its values at the last three points, or the cubic from both ends, touches zero
//! or nearly does. A function that stays clear of zero keeps more of its value in a shorter step, and
//! costs one or two refused steps.

use super::hermite::Cubic;
use crate::step::State;

/// Part of the value at the nearer end that is left at the turning point, below which a step is
/// divided.
const CLEAR: f64 = 0.3;
/// The same of the parameter's slope, which the cubic knows from both ends.
const CLEAR_SLOPE: f64 = 0.1;
/// What a parabola may be wrong by, as a part of its curvature times the square of the step: a fifth
/// of what it changes in half a step.
const ERROR: f64 = 0.025;
/// Where a parabola through the last three points may turn, in steps, and may be wrong about where.
const FARTHEST: f64 = 1.2;
/// Part of its value to which a function falls at the end of a step behind which, or before which, it
/// turns.
const NEARLY: f64 = 0.02;
/// Largest relative change of the imaginary part from point to point of one and the same pair.
const SAME_PAIR: f64 = 0.3;
/// The same of a pair near to the axis: pairs that avoid each other there turn sharply.
const SAME_NEAR: f64 = 0.15;
/// Distance of a pair from the axis, relative to its imaginary part, from which it is watched closely.
const NEAR: f64 = 0.2;
/// The same of a pair whose distance may be rounding.
const UNDAMPED: f64 = 1e-11;
/// The parameter's part of the tangent, relative to its range, below which its turns are rounding.
const STEEP: f64 = 1e-6;
/// Part of the longest step from which on nearly touching zero does not count: what touches it
/// without crossing does so at every length.
const SHORT: f64 = 1.0 / 64.0;
/// The same of what touches zero more closely: to this part of the nearer end's value.
const SHORTEST: f64 = 1e-5;
const CLOSE: f64 = 0.02;

/// What a step may hide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Hidden {
    /// Nothing that shows.
    Nothing,
    /// Two special points, perhaps: a shorter step will tell.
    Pair,
    /// The same, and shorter steps do not tell.
    Unknown,
}

/// A step and the point before it.
pub(crate) struct Stretch<'s> {
    pub(crate) before: &'s State,
    /// Scaled length from `before` to `a`; 0 where there is no point before.
    pub(crate) past: f64,
    pub(crate) a: &'s State,
    pub(crate) b: &'s State,
    /// Scaled length from `a` to `b`.
    pub(crate) h: f64,
    /// The longest step that is allowed there.
    pub(crate) longest: f64,
    /// Scale of the parameter.
    pub(crate) range: f64,
}

impl Stretch<'_> {
    /// Whether the step may hide two special points.
    pub(crate) fn hides_pair(&self) -> Hidden {
        let (a, b) = (self.a, self.b);
        let fold = a.tp * b.tp <= 0.0;
        // a pitchfork met from its side touches zero by itself
        let explained = fold || a.orientation != b.orientation;
        // it has reached the axis, to rounding
        if self.same_counts() && a.pairs > 0 && is_damped(a) && !is_damped(b) {
            return Hidden::Unknown;
        }
        if self.h <= SHORT * self.longest {
            let real = !explained && self.same_counts() && self.touches(|x| x.real, CLOSE);
            return match real || self.pair_touches(CLOSE) {
                false => Hidden::Nothing,
                true if self.h > SHORTEST * self.longest => Hidden::Pair,
                true => Hidden::Unknown,
            };
        }
        let hides = !fold && self.hides_folds() || self.hides_pairs() || {
            let touches = || self.touches(|x| x.real, CLEAR) || self.bounces();
            !explained && self.same_counts() && touches()
        };
        if hides { Hidden::Pair } else { Hidden::Nothing }
    }

    /// Whether the real eigenvalue nearest to zero, going on as before, would pass zero, and does not:
    /// it turns there, or the step has gone over to another branch, where branches cross.
    fn bounces(&self) -> bool {
        let Stretch { before, past, a, b, h, .. } = *self;
        let expected = a.real + (a.real - before.real) * h / past;
        past > 0.0
            && before.pairs == a.pairs
            && before.real * a.real > 0.0
            && a.real * b.real > 0.0
            && expected * a.real < 0.0
    }

    fn same_counts(&self) -> bool {
        let (a, b) = (self.a, self.b);
        a.pairs == b.pairs && a.count == b.count
    }

    fn hides_folds(&self) -> bool {
        let (a, b) = (self.a, self.b);
        let slope = Cubic { h: self.h, g: [a.p, b.p], s: [a.tp, b.tp] }.turn_of_slope();
        let least = a.tp.abs().min(b.tp.abs());
        least > STEEP * self.range
            && slope.is_some_and(|(slope, curvature)| {
                slope * a.tp.signum() < CLEAR_SLOPE * least + ERROR * curvature.abs()
            })
    }

    /// Pairs of eigenvalues: one and the same at all points, or, if the step is long, not the same at
    /// both ends though it is near to the axis.
    fn hides_pairs(&self) -> bool {
        let (a, b) = (self.a, self.b);
        if !self.same_counts() || a.pairs == 0 {
            return false;
        }
        if !same(a, b) {
            return self.h > 4.0 * SHORT * self.longest && (near(a) || near(b));
        }
        self.pair_touches(CLEAR)
    }

    /// Whether one and the same pair touches the axis to a part `clear` of its distance.
    fn pair_touches(&self, clear: f64) -> bool {
        let (before, a, b) = (self.before, self.a, self.b);
        let known = self.same_counts() && a.pairs > 0 && is_damped(a) && is_damped(b);
        known && same(before, a) && same(a, b) && self.touches(|x| x.pair, clear)
    }

    fn touches(&self, f: impl Fn(&State) -> f64, clear: f64) -> bool {
        let Stretch { before, past, a, b, h, .. } = *self;
        before.pairs == a.pairs && touches([before, a, b].map(f), past, h, clear)
    }
}

/// Whether the distance of the nearest pair from the axis is more than rounding.
fn is_damped(x: &State) -> bool {
    x.pair.abs() > UNDAMPED * x.frequency
}

/// Whether the nearest pair is near to the axis.
fn near(x: &State) -> bool {
    x.pair.abs() < NEAR * x.frequency
}

/// Whether the nearest pairs may be the same.
fn same(x: &State, y: &State) -> bool {
    let limit = if near(x) || near(y) { SAME_NEAR } else { SAME_PAIR };
    let largest = x.frequency.abs().max(y.frequency.abs());
    (x.frequency - y.frequency).abs() <= limit * largest
}

/// Whether the parabola through values at `-past`, 0 and `h` turns near zero or beyond it behind 0
/// though the values at both ends have one sign.
fn touches([before, a, b]: [f64; 3], past: f64, h: f64, clear: f64) -> bool {
    let sign = a.signum();
    if !(past > 0.0 && a * b > 0.0 && before.is_finite()) {
        return false;
    }
    let (left, right) = ((a - before) / past, (b - a) / h);
    let curvature = (right - left) / (past + h);
    let slope = left + curvature * past;
    if sign * slope >= 0.0 || sign * curvature <= 0.0 {
        return false;
    }
    let turn = -slope / (2.0 * curvature);
    let value = sign * (a + 0.5 * slope * turn);
    let error = ERROR * curvature.abs() * h * h;
    let close = turn < FARTHEST * h || b.abs() < NEARLY * a.abs();
    close && value < clear * a.abs().min(b.abs()) + error
}

#[cfg(test)]
mod tests {
    use super::{CLEAR, touches};

    #[test]
    fn a_parabola_that_dips_below_zero_between_ends_of_one_sign_is_seen() {
        let f = |x: f64| (x - 0.4) * (x - 0.6);
        assert!(touches([f(-1.0), f(0.0), f(1.0)], 1.0, 1.0, CLEAR));
        assert!(touches([-f(-0.3), -f(0.0), -f(1.0)], 0.3, 1.0, CLEAR));
    }

    #[test]
    fn a_dip_just_before_the_end_of_the_step_is_seen_though_the_function_is_no_parabola() {
        let f = |x: f64| ((x - 0.97).powi(2) - 1e-5) * (1.0 + 0.3 * x);
        assert!(touches([f(-1.0), f(0.0), f(1.0)], 1.0, 1.0, CLEAR));
    }

    #[test]
    fn a_turn_well_clear_of_zero_is_not_suspected() {
        let f = |x: f64| (x - 0.5) * (x - 0.5) + 0.2;
        assert!(!touches([f(-1.0), f(0.0), f(1.0)], 1.0, 1.0, CLEAR));
        assert!(!touches([f64::NAN, 1.0, 1.0], 1.0, 1.0, CLEAR));
    }
}
