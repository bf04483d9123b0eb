//! Where a step begins: ahead of the last states.

use super::Tracer;
use crate::events::basis;

/// Cosine between the last two tangents below which the cubic through them is not trusted.
const SMOOTH: f64 = 0.9;

/// Weights of the last two states and their tangents in a prediction.
#[derive(Debug, Clone, Copy)]
struct Ahead {
    previous: f64,
    previous_tangent: f64,
    current: f64,
    tangent: f64,
}

impl Tracer<'_> {
    /// Extrapolates the branch by a scaled length `h` along the tangent: by the cubic through the last two
    /// states with their tangents; by the parabola of the tangents where they turn much; along the tangent at
    /// first.
    pub(super) fn predict(&mut self, h: f64) {
        let ahead = self.ahead(h);
        let Self { current, previous, trial, .. } = self;
        trial.p = ahead.of((previous.p, previous.tp), (current.p, current.tp));
        for i in 0..trial.u.len() {
            trial.u[i] = ahead.of((previous.u[i], previous.tu[i]), (current.u[i], current.tu[i]));
        }
    }

    /// The parameter of that.
    pub(super) fn predicted(&self, h: f64) -> f64 {
        let Self { current, previous, .. } = self;
        self.ahead(h).of((previous.p, previous.tp), (current.p, current.tp))
    }

    fn ahead(&self, h: f64) -> Ahead {
        let Self { current, previous, .. } = self;
        let along = Ahead { previous: 0.0, previous_tangent: 0.0, current: 1.0, tangent: h };
        if self.past <= 0.0 {
            return along;
        }
        // measured along the latest tangent, whose plane the step ends on
        let weights = self.core.weights;
        let secant = current.u.iter().zip(&previous.u).zip(&current.mtu);
        let secant: f64 = secant.map(|((u, u0), m)| (u - u0) * m).sum();
        let last = secant / (weights.unknowns * weights.unknowns)
            + current.tp * (current.p - previous.p) / (weights.parameter * weights.parameter);
        let cos = weights.dot(&current.mtu, current.tp, &previous.tu, previous.tp);
        if last > 0.0 && cos > SMOOTH * weights.norm(&previous.mtu, &previous.tu, previous.tp) {
            let [w0, w1, w2, w3] = basis(1.0 + h / last);
            return Ahead {
                previous: w0,
                previous_tangent: w1 * last / cos,
                current: w2,
                tangent: w3 * last,
            };
        }
        if self.previous_h > 0.0 {
            let bend = 0.5 * h * h / self.previous_h;
            return Ahead { previous_tangent: -bend, tangent: h + bend, ..along };
        }
        along
    }
}

impl Ahead {
    /// The prediction from value and slope at both states.
    fn of(&self, (before, slope_before): (f64, f64), (now, slope): (f64, f64)) -> f64 {
        self.previous * before
            + self.previous_tangent * slope_before
            + self.current * now
            + self.tangent * slope
    }
}
