//! Branches that come close to each other: crossed where there is a branch point, not where there is
//! none.

use super::Tracer;
use crate::events::{Located, bend, interpolate};
use crate::step::{Constraint, Core, Precision, Refusal, State};

/// Part of the step within which a branch point that Newton's method does not meet is bracketed.
const NARROW: f64 = 1e-2;
/// Lengths at which the other side of a branch point is tried, in terms of the shortest step that
/// changed the orientation: its corner blurs short steps; longer ones see the crossing branches only.
const LENGTHS: [f64; 4] = [1.0, 8.0, 64.0, 512.0];

/// Part of the largest separation on a curve of special points below which two of them meet where a trace
/// cannot go on: ten times that which ends a trace by itself.
const STANDS: f64 = 10.0 * super::MEETING;

impl Tracer<'_> {
    /// Where steps fail at every length though a longer one had reached a state of the other
    /// orientation, the branch runs into a branch point, near which short steps see rounding only.
    /// The shortest step that did cross is taken if there is a branch point in it. If there is none,
    /// two branches pass each other: returns a bound of the distance between them.
    pub(super) fn cross(&mut self, refusal: &Refusal) -> Result<(), Option<f64>> {
        if matches!(refusal, Refusal::Evaluation(_) | Refusal::Meeting) {
            return Err(None);
        }
        let Some(h) = self.crossing.take() else { return Err(None) };
        if self.s - self.anchor_s > 2.0 * h * self.anchor.length {
            return Err(None);
        }
        std::mem::swap(&mut self.current, &mut self.anchor);
        (self.previous_h, self.past) = (0.0, 0.0);
        let mut close = h * self.current.length;
        let longest = self.size.longest(self.current.length);
        for h in LENGTHS.map(|factor| factor * h) {
            if h > longest {
                break;
            }
            match self.attempt(h, true) {
                Ok(()) => return Ok(()),
                Err(Refusal::BranchesClose { gap }) => close = close.min(gap),
                Err(_) => {}
            }
        }
        std::mem::swap(&mut self.current, &mut self.anchor);
        Err(Some(close))
    }

    /// Why the trace ends between two branches that cannot be told apart.
    pub(super) fn too_close(&self, gap: f64, refusal: &Refusal) -> String {
        let (name, p) = self.place();
        format!(
            "at {name} = {p:.10} another branch passes at a distance of {gap:.1e} or less, too close \
             to be told apart; the last step was refused because: {refusal}"
        )
    }

    /// Whether two special points of a curve meet where the trace stands: states there are known to fewer
    /// digits than the shortest step asks for, whatever the last step was refused for.
    pub(super) fn stands_at_meeting(&mut self) -> bool {
        let separation = self.core.separation(&self.current);
        separation.is_ok_and(|s| s.is_some_and(|s| s < STANDS * self.separation))
    }

    /// Why the trace ends where steps from `first` down to `last` were refused.
    pub(super) fn too_small(&self, first: f64, last: f64, refusal: &Refusal) -> String {
        let (name, p) = self.place();
        format!(
            "at {name} = {p:.10} steps from {first:.1e} down to {last:.1e} were refused, the last \
             because: {refusal}"
        )
    }

    pub(super) fn place(&self) -> (&str, f64) {
        (&self.core.problem.parameters()[self.core.which.0].name, self.current.p)
    }
}

/// Whether the branch from `a` to `b`, a scaled length `h` apart, passes through the place where its
/// orientation changes: states on both sides of it are as near to each other as the place is known.
pub(super) fn passes_through(
    core: &mut Core<'_>,
    a: &State,
    b: &State,
    h: f64,
    place: Located,
) -> Result<(), Refusal> {
    if place.error > NARROW * h {
        return Err(Refusal::Orientation);
    }
    let bend = bend(core, a, b);
    let mut sides = [a.clone(), b.clone()];
    let mut width = (4.0 * place.error).max(1e-6 * h);
    while width <= NARROW * h {
        let places = [(place.at - width).max(0.0), (place.at + width).min(h)];
        let mut reached = true;
        for (x, at) in sides.iter_mut().zip(places) {
            interpolate(a, b, h, bend, at, x);
            reached &= core.correct(Constraint::Plane(a, at), x, Precision::Event).is_ok();
        }
        let [before, after] = &sides;
        if reached && before.orientation * after.orientation < 0 {
            let (distance, ..) = core.secant(before, after);
            let jumps = distance > 1.5 * (places[1] - places[0]);
            let close = Refusal::BranchesClose { gap: distance * a.length };
            return if jumps { Err(close) } else { Ok(()) };
        }
        // nearer to it the corrector is singular
        width *= 10.0;
    }
    Err(Refusal::Orientation)
}
