//! Bracketed root finding that calls its function one value at a time.
//!
//! Chandrupatla's method (Adv. Eng. Softw. 28, 1997): inverse quadratic interpolation where it
//! is safe, bisection where it is not. The caller evaluates, because an evaluation here is a
//! corrector run that may be refused.

/// A bracketed search in progress.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Search {
    // [x1, x2] is the bracket with x1 the latest point, x3 the previous one
    x1: f64,
    x2: f64,
    x3: f64,
    f1: f64,
    f2: f64,
    f3: f64,
}

impl Search {
    /// A search on `[a, b]`, where the values have opposite signs (or one is zero).
    pub(crate) fn new(a: f64, fa: f64, b: f64, fb: f64) -> Self {
        Search { x1: b, x2: a, x3: a, f1: fb, f2: fa, f3: fa }
    }

    /// Width of the bracket.
    pub(crate) fn width(&self) -> f64 {
        (self.x1 - self.x2).abs()
    }

    /// Difference between the values at its ends.
    pub(crate) fn spread(&self) -> f64 {
        (self.f1 - self.f2).abs()
    }

    /// The end with the smaller value.
    pub(crate) fn best(&self) -> (f64, f64) {
        if self.f1.abs() <= self.f2.abs() { (self.x1, self.f1) } else { (self.x2, self.f2) }
    }

    /// Distance from the best end to the root of the secant over the bracket: an estimate of
    /// the error.
    pub(crate) fn error(&self) -> f64 {
        let slope = (self.f1 - self.f2) / (self.x1 - self.x2);
        let (_, f) = self.best();
        // near the end one side of the bracket is stale; the last two points are not
        let recent = (self.f1 - self.f3) / (self.x1 - self.x3);
        let steep = if recent.is_finite() && recent != 0.0 { recent } else { slope };
        (f / steep).abs().min(self.width())
    }

    /// Where to evaluate next, at least `tolerance` away from both ends.
    pub(crate) fn next(&self, tolerance: f64) -> f64 {
        let xi = (self.x1 - self.x2) / (self.x3 - self.x2);
        let phi = (self.f1 - self.f2) / (self.f3 - self.f2);
        let quadratic = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        let mut t = if quadratic {
            self.f1 / (self.f2 - self.f1) * (self.f3 / (self.f2 - self.f3))
                + (self.x3 - self.x1) / (self.x2 - self.x1)
                    * (self.f1 / (self.f3 - self.f1))
                    * (self.f2 / (self.f3 - self.f2))
        } else if self.x3 == self.x2 {
            // first evaluation: the secant
            self.f1 / (self.f1 - self.f2)
        } else {
            0.5
        };
        let least = (tolerance / self.width()).min(0.5);
        t = if t.is_finite() { t.clamp(least, 1.0 - least) } else { 0.5 };
        self.x1 + t * (self.x2 - self.x1)
    }

    /// Records a value.
    pub(crate) fn record(&mut self, x: f64, f: f64) {
        if (f > 0.0) == (self.f1 > 0.0) {
            (self.x3, self.f3) = (self.x1, self.f1);
        } else {
            (self.x3, self.f3) = (self.x2, self.f2);
            (self.x2, self.f2) = (self.x1, self.f1);
        }
        (self.x1, self.f1) = (x, f);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solve(f: impl Fn(f64) -> f64, a: f64, b: f64) -> (f64, usize) {
        let mut search = Search::new(a, f(a), b, f(b));
        let mut count = 0;
        while search.width() > 1e-13 && search.best().1 != 0.0 && count < 100 {
            let x = search.next(0.4e-13);
            search.record(x, f(x));
            count += 1;
        }
        (search.best().0, count)
    }

    #[test]
    fn smooth_and_nasty_functions() {
        let (x, count) = solve(|x| x * x * x - 2.0, 0.0, 2.0);
        assert!((x - 2.0_f64.cbrt()).abs() < 1e-13 && count < 15, "{x} after {count}");
        let (x, count) = solve(|x| (30.0 * x).exp() - 1e4, 0.0, 1.0);
        assert!((x - 1e4_f64.ln() / 30.0).abs() < 1e-13 && count < 40, "{x} after {count}");
        let (x, _) = solve(|x| if x < 0.3 { -1.0 } else { 1.0 }, 0.0, 1.0);
        assert!((x - 0.3).abs() < 1e-12);
    }
}
