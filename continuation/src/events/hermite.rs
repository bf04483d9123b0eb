//! Cubic Hermite interpolation of a function from its values and slopes at both ends of a step.

/// A function changes by less than this many times what its ends show.
const MANY: f64 = 10.0;

/// A cubic on `[0, h]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cubic {
    pub(crate) h: f64,
    pub(crate) g: [f64; 2],
    pub(crate) s: [f64; 2],
}

impl Cubic {
    /// Value at `x`.
    pub(crate) fn value(&self, x: f64) -> f64 {
        let [a, b, c, d] = basis(x / self.h);
        a * self.g[0] + b * self.h * self.s[0] + c * self.g[1] + d * self.h * self.s[1]
    }

    /// How far the ends disagree: the change against the trapezoidal rule of the slopes,
    /// relative to both. Zero for a quadratic.
    pub(crate) fn mismatch(&self) -> f64 {
        let change = self.g[1] - self.g[0];
        let sum = 0.5 * self.h * (self.s[0] + self.s[1]);
        let size = change.abs() + 0.5 * self.h * (self.s[0].abs() + self.s[1].abs());
        if size > 0.0 { (change - sum).abs() / size } else { 0.0 }
    }

    /// Positions of interior extrema.
    pub(crate) fn extrema(&self) -> [Option<f64>; 2] {
        // derivative: a t² + b t + c with t = x/h
        let change = self.g[1] - self.g[0];
        let (s0, s1) = (self.h * self.s[0], self.h * self.s[1]);
        let (a, b, c) = (3.0 * (s0 + s1) - 6.0 * change, 6.0 * change - 4.0 * s0 - 2.0 * s1, s0);
        let discriminant = b * b - 4.0 * a * c;
        if discriminant.is_nan() || discriminant <= 0.0 {
            return [None, None];
        }
        let q = -0.5 * (b + discriminant.sqrt().copysign(b));
        let inside = |t: f64| (t > 0.0 && t < 1.0).then_some(t * self.h);
        let first = if a == 0.0 { None } else { inside(q / a) };
        let second = if q == 0.0 { None } else { inside(c / q) };
        [first, second]
    }

    /// The slope `s₀ + b t + a t²` at `x = t h` where it is least or largest inside, and `a`.
    pub(crate) fn turn_of_slope(&self) -> Option<(f64, f64)> {
        let change = (self.g[1] - self.g[0]) / self.h;
        let [s0, s1] = self.s;
        let (a, b) = (3.0 * (s0 + s1) - 6.0 * change, 6.0 * change - 4.0 * s0 - 2.0 * s1);
        let turn = -0.5 * b / a;
        (turn > 0.0 && turn < 1.0).then_some((s0 + 0.5 * b * turn, a))
    }

    /// How much the function changes, by its values or by its slopes.
    pub(crate) fn change(&self) -> f64 {
        let by_slopes = self.h * self.s[0].abs().max(self.s[1].abs());
        (self.g[1] - self.g[0]).abs().max(by_slopes)
    }

    /// Whether a function like this may have a zero inside: not one whose ends are many times as far from zero, on the same
    /// side, as it changes, however badly its slopes are known.
    pub(crate) fn may_vanish(&self) -> bool {
        let [g0, g1] = self.g;
        let nearest = if g0 * g1 > 0.0 { g0.abs().min(g1.abs()) } else { 0.0 };
        MANY * self.change() > nearest
    }

    /// Whether the cubic has two zeros inside though the ends have the same sign.
    pub(crate) fn hides_zeros(&self) -> bool {
        let [g0, g1] = self.g;
        g0 * g1 > 0.0 && self.extrema().into_iter().flatten().any(|x| self.value(x) * g0 < 0.0)
    }

    /// Whether the cubic has two extrema inside though the slopes have the same sign.
    pub(crate) fn hides_extrema(&self) -> bool {
        self.s[0] * self.s[1] > 0.0 && self.extrema().iter().all(Option::is_some)
    }
}

/// Hermite basis at `t` in [0, 1]: value and slope at 0, value and slope at 1.
pub(crate) fn basis(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [2.0 * t3 - 3.0 * t2 + 1.0, t3 - 2.0 * t2 + t, -2.0 * t3 + 3.0 * t2, t3 - t2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cubic(f: impl Fn(f64) -> f64, df: impl Fn(f64) -> f64, h: f64) -> Cubic {
        Cubic { h, g: [f(0.0), f(h)], s: [df(0.0), df(h)] }
    }

    #[test]
    fn a_cubic_is_reproduced_with_its_extrema() {
        let c = cubic(|x| x * x * x - 2.0 * x * x + x - 3.0, |x| 3.0 * x * x - 4.0 * x + 1.0, 1.5);
        let x: f64 = 0.7;
        assert!((c.value(x) - (x.powi(3) - 2.0 * x * x + x - 3.0)).abs() < 1e-14);
        let mut found: Vec<f64> = c.extrema().into_iter().flatten().collect();
        found.sort_by(f64::total_cmp);
        assert!((found[0] - 1.0 / 3.0).abs() < 1e-12 && (found[1] - 1.0).abs() < 1e-12);
        assert!(c.hides_extrema());
    }

    #[test]
    fn two_zeros_between_ends_of_one_sign_are_seen() {
        let c = cubic(|x| (x - 0.4) * (x - 0.6), |x| 2.0 * x - 1.0, 1.0);
        assert!(c.hides_zeros() && !c.hides_extrema());
        let d = cubic(|x| (x - 0.5) * (x - 0.5) + 0.1, |x| 2.0 * x - 1.0, 1.0);
        assert!(!d.hides_zeros());
    }

    #[test]
    fn far_from_zero_it_does_not_matter_what_slopes_are() {
        let at = |level: f64| Cubic { h: 1e-3, g: [level, level + 1e-6], s: [6e-3, -2e-3] };
        assert!(at(1e-5).may_vanish() && at(-5e-5).may_vanish());
        assert!(!at(1e-4).may_vanish() && !at(-0.5).may_vanish());
        assert!(Cubic { h: 1.0, g: [-1e3, 1e-9], s: [0.0; 2] }.may_vanish());
    }

    #[test]
    fn a_quadratic_has_no_mismatch() {
        let c = cubic(|x| x * x + 3.0 * x, |x| 2.0 * x + 3.0, 0.3);
        assert!(c.mismatch() < 1e-15);
    }
}
