//! Whether a bordered Jacobian is singular to rounding, beside what its rows have to say.

use super::super::{State, Weights, dot};
use super::Core;
use crate::linalg::{Matrix, max_abs};
use crate::singular::arbitrary;

/// A row smaller than this part of the largest counts as that: it may be zero.
const ROW: f64 = 1e-4;
/// Growth of a solution, relative to its right-hand side row by row, above which a matrix deserves a
/// closer look.
const NEARLY_SINGULAR: f64 = 1e8;

impl Core<'_> {
    /// Whether the matrix bordered by the tangent of the latest start is singular to rounding, or so
    /// nearly that it may be.
    ///
    /// The size of a row is that of what it has to say a little way off: at a branch point of few
    /// unknowns its derivatives are all rounding.
    pub(crate) fn is_nearly_singular(&mut self, x: &State) -> bool {
        let n = self.du.len();
        let Weights { unknowns, parameter } = self.weights;
        // the size of each row, for unknowns and parameter in units of their scales
        let mut sizes = vec![0.0_f64; n];
        for seed in 31..33 {
            for (i, d) in self.du.iter_mut().enumerate() {
                *d = arbitrary(seed, i);
            }
            self.problem.metric(&self.du, &mut self.mdu);
            let norm = dot(&self.mdu, &self.du).max(0.0).sqrt();
            let length = if norm > 0.0 { unknowns / norm } else { 1.0 };
            self.du.iter_mut().for_each(|d| *d *= length);
            self.jacobian.mul(&self.du, &mut self.mdu);
            let dp = parameter * arbitrary(seed, n);
            for ((s, y), f) in sizes.iter_mut().zip(&self.mdu).zip(self.bordered.column(0)) {
                *s = s.max((y + dp * f).abs());
            }
        }
        if max_abs(&sizes) == 0.0 {
            return true;
        }
        let [here, there] = &mut self.shifted;
        there.copy_from_slice(&x.u);
        for (i, (place, u)) in there.iter_mut().zip(&x.u).enumerate() {
            *place += 0.1 * (u.abs() + unknowns) * arbitrary(34, i);
        }
        self.p[self.which.0] = x.p;
        let known = self.problem.residual(&x.u, &self.p, here).is_ok();
        if known && self.problem.residual(there, &self.p, &mut self.mdu).is_ok() {
            for ((s, a), b) in sizes.iter_mut().zip(&self.mdu).zip(&*here) {
                let change = (a - b).abs();
                *s = if change.is_finite() { s.max(change) } else { *s };
            }
        }
        let largest = max_abs(&sizes);
        for (i, (d, s)) in self.du.iter_mut().zip(&sizes).enumerate() {
            *d = s.max(ROW * largest) * arbitrary(33, i);
        }
        let mut g = [0.0];
        self.bordered.solve(&mut self.jacobian, &mut self.du, &mut g);
        self.problem.metric(&self.du, &mut self.mdu);
        let size = self.weights.norm(&self.mdu, &self.du, g[0]);
        size.is_nan() || size > NEARLY_SINGULAR
    }
}
