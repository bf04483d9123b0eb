//! Where a step begins: ahead of the last states.

use super::Tracer;

/// Cosine between the last two tangents below which they say nothing of what lies ahead.
const SMOOTH: f64 = 0.5;

/// What the prediction adds to the current state.
struct Weights {
    /// Of the previous state less the current one.
    back: f64,
    /// Of the current tangent.
    tangent: f64,
    /// Of the previous tangent.
    previous: f64,
}

impl Tracer<'_> {
    /// The cubic through the last two states with their tangents, continued; along the tangent at first.
    pub(super) fn predict(&mut self, h: f64) {
        let Weights { back, tangent, previous: before } = self.ahead(h);
        let Self { current, previous, trial, .. } = self;
        for i in 0..trial.u.len() {
            trial.u[i] = current.u[i]
                + back * (previous.u[i] - current.u[i])
                + tangent * current.tu[i]
                + before * previous.tu[i];
        }
        trial.p = current.p
            + back * (previous.p - current.p)
            + tangent * current.tp
            + before * previous.tp;
    }

    /// The parameter of that.
    pub(super) fn predicted(&mut self, h: f64) -> f64 {
        let Weights { back, tangent, previous: before } = self.ahead(h);
        let Self { current, previous, .. } = self;
        current.p + back * (previous.p - current.p) + tangent * current.tp + before * previous.tp
    }

    /// The weights at a scaled distance `h` ahead. The branch is a function of the distance along the
    /// current tangent: as such its slope at the previous state is the tangent there over the cosine between both.
    fn ahead(&mut self, h: f64) -> Weights {
        let straight = Weights { back: 0.0, tangent: h, previous: 0.0 };
        if self.previous_h == 0.0 {
            return straight;
        }
        let Self { core, current, previous, .. } = self;
        let cosine = core.weights.dot(&previous.mtu, previous.tp, &current.tu, current.tp);
        let (distance, _, along) = core.secant(previous, current);
        let step = distance * along;
        if cosine < SMOOTH || step <= 0.0 {
            return straight;
        }
        // the Hermite basis at 1 + x, in a form that keeps its digits where x is small
        let x = h / step;
        Weights {
            back: x * x * (3.0 + 2.0 * x),
            tangent: h * (1.0 + x) * (1.0 + x),
            previous: h * x * (1.0 + x) / cosine,
        }
    }
}
