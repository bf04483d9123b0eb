//! Where a step begins: ahead of the last states.

use super::Tracer;

/// Cosine between the last two tangents below which a cubic through both states leads astray.
const STRAIGHT: f64 = 0.9;

/// Weights of the previous state and the latest one, and of their tangents.
type Ahead = [f64; 4];

impl Tracer<'_> {
    /// Extrapolation of the branch: by the cubic through the last two states and tangents where they
    /// hardly turn, by the parabola of the tangents where they do, along the tangent at first.
    pub(super) fn predict(&mut self, h: f64) {
        let [wa, wb, va, vb] = self.ahead(h);
        let Self { current: b, previous: a, trial, .. } = self;
        trial.p = wa * a.p + wb * b.p + va * a.tp + vb * b.tp;
        for i in 0..trial.u.len() {
            trial.u[i] = wa * a.u[i] + wb * b.u[i] + va * a.tu[i] + vb * b.tu[i];
        }
    }

    /// The parameter of that.
    pub(super) fn predicted(&self, h: f64) -> f64 {
        let [wa, wb, va, vb] = self.ahead(h);
        let (a, b) = (&self.previous, &self.current);
        wa * a.p + wb * b.p + va * a.tp + vb * b.tp
    }

    fn ahead(&self, h: f64) -> Ahead {
        if self.previous_h <= 0.0 {
            return [0.0, 1.0, 0.0, h];
        }
        let (a, b) = (&self.previous, &self.current);
        let weights = self.core.weights;
        let bend = weights.dot(&b.mtu, b.tp, &a.tu, a.tp);
        // length of the last step along the latest tangent
        let apart = |x: &[f64], y: f64| weights.dot(&b.mtu, b.tp, x, y);
        let last = apart(&b.u, b.p) - apart(&a.u, a.p);
        if bend > STRAIGHT && last > 0.5 * self.previous_h && std::env::var("NOCUBIC").is_err() {
            let t = 1.0 + h / last;
            let (square, cube) = (t * t, t * t * t);
            let ahead = 3.0 * square - 2.0 * cube;
            let slopes = [cube - 2.0 * square + t, cube - square];
            return [1.0 - ahead, ahead, slopes[0] * last / bend, slopes[1] * last];
        }
        let bent = 0.5 * h * h / self.previous_h;
        [0.0, 1.0, -bent, h + bent]
    }
}
