//! Corrections with factors of a state near by, where factorisations are what a step costs.
//!
//! The state is corrected further than Newton's method needs to: beside an avoided crossing of gap 1e-10
//! an error of 1e-11 picks the other branch, and a quadratically convergent iteration leaves far less
//! than its tolerance. The tangent of the factors is corrected by a measured difference of the residual
//! along it, and what would move it much, or could turn its parameter's part round, is refused.
//!
//! Orientation and counts are those of the factors. They hold for the state too where the matrices differ
//! by little beside how nearly singular they are, which is measured along what is nearest to their kernel;
//! and where no eigenvalue comes near its change of sign. Otherwise the state gets factors of its own.

use super::super::State;
use super::{Constraint, Core, Corrected, STANDS_STILL};
use crate::linalg::Matrix;
use crate::singular::arbitrary;

/// A correction of Newton's method, relative to the state, after which its factors are good enough.
const NEAR_FACTORS: f64 = 1e-4;
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

/// Largest change of a vector near the kernel, `K⁻¹ (K(x) − K) v` for a unit `v`, with which the
/// determinants have the same sign: a tenth of what makes the matrix singular.
const SAME_SIGN: f64 = 0.1;
/// An eigenvalue smaller than this part of its change in the step may have the other sign.
const CLOSE: f64 = 0.1;

impl Core<'_> {
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
            && self.keeps_orientation(x)
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

    /// Whether the determinant at `x` has the sign of that of the factors.
    fn keeps_orientation(&mut self, x: &State) -> bool {
        // inverse iteration: what is nearest to the kernel prevails
        self.du.iter_mut().enumerate().for_each(|(i, d)| *d = arbitrary(41, i));
        let mut g = [0.0];
        self.bordered.solve(&mut self.jacobian, &mut self.du, &mut g);
        self.problem.metric(&self.du, &mut self.mdu);
        let norm = self.weights.norm(&self.mdu, &self.du, g[0]);
        if !(norm.is_finite() && norm > 0.0) {
            return false;
        }
        self.du.iter_mut().for_each(|d| *d /= norm);
        let dp = g[0] / norm;
        let [place, there] = &mut self.shifted;
        for ((place, u), v) in place.iter_mut().zip(&x.u).zip(&self.du) {
            *place = u + DIFFERENCE * v;
        }
        let Ok(p) = self.guard.admit(x.p + DIFFERENCE * dp) else { return false };
        self.p[self.which.0] = p;
        if self.problem.residual(place, &self.p, there).is_err() {
            return false;
        }
        self.jacobian.mul(&self.du, &mut self.mdu);
        let column = self.bordered.column(0);
        for (((du, f), y), c) in self.du.iter_mut().zip(&*there).zip(&self.mdu).zip(column) {
            *du = f / DIFFERENCE - y - dp * c;
        }
        let mut g = [0.0];
        self.bordered.solve(&mut self.jacobian, &mut self.du, &mut g);
        self.problem.metric(&self.du, &mut self.mdu);
        self.weights.norm(&self.mdu, &self.du, g[0]) <= SAME_SIGN
    }

    /// Whether what was read from the factors of a state near `x` says of `x` itself nothing certain,
    /// after a step from `base`: something changed its sign, or nearly did.
    pub(super) fn is_near_change(base: &State, x: &State) -> bool {
        let close = |a: f64, b: f64| b.abs() <= CLOSE * (a - b).abs();
        x.orientation != base.orientation
            || x.count != base.count
            || x.critical
            || close(base.pair, x.pair)
            || close(base.real, x.real)
    }
}
