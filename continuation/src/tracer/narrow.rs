//! A Hopf point between two real eigenvalues on either side.
//!
//! With a small mass, two real eigenvalues meet, leave the real axis, cross the imaginary one and come
//! back to the real axis within a tiny part of a step: at its ends the count has changed by two, and
//! no pair is seen. The count itself leads there.

use super::Tracer;
use super::special::Special;
use crate::branch::Detail;
use crate::events::{Candidate, Located, bend, interpolate};
use crate::singular::locate_hopf;
use crate::step::{Constraint, Precision};

/// Bisections of the step.
const BISECTIONS: usize = 48;

impl Tracer<'_> {
    /// The Hopf point in the step of scaled length `h`, at whose ends the count is certain and differs
    /// by two; `None` if there is none.
    pub(super) fn narrow_hopf(&mut self, h: f64) -> Option<Special> {
        let Self { core, current: a, trial: b, work, .. } = self;
        if !(a.certified && b.certified) {
            return None;
        }
        let bend = bend(core, a, b);
        let fewest = a.pairs.min(b.pairs);
        let (mut lo, mut hi, mut seen) = (0.0, h, false);
        for _ in 0..BISECTIONS {
            let at = 0.5 * (lo + hi);
            interpolate(a, b, h, bend, at, work);
            core.correct(Constraint::Plane(a, at), work, Precision::Event).ok()?;
            if work.pairs > fewest {
                seen = true;
                let omega = work.frequency;
                if let Ok(Some(found)) = locate_hopf(core, a, b, h, at, omega, work) {
                    let place = Located { at: found.at, error: found.error };
                    let detail = found.form.map_or(Detail::None, Detail::Hopf);
                    let (candidate, state) = (Candidate::Hopf, work.clone());
                    let eigenvectors = found.vector.into_iter().collect();
                    return Some(Special { candidate, place, detail, eigenvectors, state });
                }
            }
            if work.count == a.count {
                lo = at;
            } else if work.count == b.count {
                hi = at;
            } else {
                return None;
            }
        }
        // as near as bisection comes
        let place = Located { at: hi, error: hi - lo };
        let state = work.clone();
        let (candidate, detail, eigenvectors) = (Candidate::Hopf, Detail::None, Vec::new());
        seen.then_some(Special { candidate, place, detail, eigenvectors, state })
    }
}
