//! Corrections with factors of a state near by, where factorisations are what a step costs.
//!
//! The state is corrected further than Newton's method needs to: beside an avoided crossing of gap 1e-10
//! an error of 1e-11 picks the other branch, and a quadratically convergent iteration leaves far less
//! than its tolerance. The tangent of the factors is corrected by a measured difference of the residual
//! along it, and what would move it much, or could turn its parameter's part round, is refused: the
//! orientation and the counts would not be those of the state.

use super::super::State;
use super::{Constraint, Core, Corrected, STANDS_STILL};
use crate::linalg::Matrix;
use crate::problem::Problem;

/// A correction of Newton's method, relative to the state, after which its factors are good enough.
const NEAR_FACTORS: f64 = 1e-3;
/// Most corrections with the same factors.
const MOST: usize = 4;
/// Each of them must shrink by this.
const FAST: f64 = 0.05;
/// Part of the tolerance to which the state is corrected.
const CONVERGED: f64 = 0.01;
/// Length of a difference along the tangent, in the scaled metric.
const DIFFERENCE: f64 = 1e-6;
/// A tangent that it moves by more needs new factors.
const STEADY: f64 = 1e-3;

impl<P: Problem + ?Sized> Core<'_, P> {
    /// Goes on from a correction of Newton's method of length `report.last` without new factors; true
    /// where that led to a solution and its tangent. Otherwise the state keeps the corrections made.
    pub(super) fn follow_up(
        &mut self,
        constraint: Constraint<'_>,
        x: &mut State,
        size: f64,
        report: &mut Corrected,
    ) -> bool {
        self.jacobian.prefers_solves()
            && matches!(constraint, Constraint::Plane(..))
            && report.last <= NEAR_FACTORS * size
            && self.chords(constraint, x, CONVERGED * self.tolerance * size, report)
            && self.tangent_by_chord(x)
    }

    /// Corrections, each a residual and a solve, while they shrink fast; true if they converged.
    ///
    /// The first of them is what the next correction of Newton's method would begin with, and counts
    /// for the contraction.
    fn chords(
        &mut self,
        constraint: Constraint<'_>,
        x: &mut State,
        converged: f64,
        report: &mut Corrected,
    ) -> bool {
        for chord in 0..MOST {
            let Ok((correction, dp)) = self.correction(constraint, x) else { return false };
            let ratio = correction / report.last;
            if ratio.is_nan() || ratio > FAST {
                return false;
            }
            for (u, du) in x.u.iter_mut().zip(&self.du) {
                *u -= du;
            }
            x.p -= dp;
            report.last = correction;
            if chord == 0 && correction > converged {
                report.contraction = report.contraction.max(ratio);
            }
            if 4.0 * ratio * correction <= converged {
                return true;
            }
        }
        false
    }

    /// The tangent at `x`: that of the factors, corrected by what the residual changes along it.
    fn tangent_by_chord(&mut self, x: &mut State) -> bool {
        self.solve_tangent(x);
        if self.normalise(x).is_err() {
            return false;
        }
        let [place, slope] = &mut self.shifted;
        for ((place, u), t) in place.iter_mut().zip(&x.u).zip(&x.tu) {
            *place = u + DIFFERENCE * t;
        }
        let Ok(p) = self.guard.admit(x.p + DIFFERENCE * x.tp) else { return false };
        self.p[self.which.0] = p;
        if self.problem.residual(place, &self.p, slope).is_err() {
            return false;
        }
        // at `x` itself it vanishes, but for what the corrections left
        self.du.iter_mut().zip(slope.iter()).for_each(|(du, f)| *du = f / DIFFERENCE);
        let mut g = [0.0];
        self.bordered.solve(&mut self.jacobian, &mut self.du, &mut g);
        self.problem.metric(&self.du, &mut self.mdu);
        let moved = self.weights.norm(&self.mdu, &self.du, g[0]);
        let steady =
            moved <= STEADY && x.tp.abs() > 4.0 * moved.max(STANDS_STILL) * self.weights.parameter;
        if steady {
            x.tu.iter_mut().zip(&self.du).for_each(|(t, d)| *t -= d);
            x.tp -= g[0];
        }
        steady
    }
}
