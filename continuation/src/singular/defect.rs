//! The smallest singular value of `[F_u F_p]`, followed along a branch.
//!
//! The bordered matrix of [`super::kernel`] with one border more than a regular point needs: its
//! borders, renewed by the solutions of the point before, tend to the tangent, to the right and to
//! the left vector of the smallest singular value, as in inverse iteration. On the span `Q` of the
//! right ones `[F_u F_p] Q = −B G`, so that `|G|` is a bound of the value that tends to it.

use super::kernel::{Frame, arbitrary};
use super::probe::{Extended, Probe};
use crate::problem::EvalError;
use crate::step::dot;

/// Renewals of the borders at the first point.
const RENEWALS: usize = 4;

/// Follows the smallest singular value; the unit is that of `f` per scaled length.
pub(crate) struct Defect {
    frame: Frame,
    begun: bool,
}

impl Defect {
    pub(crate) fn new(n: usize) -> Self {
        Defect { frame: Frame::new(n, 1), begun: false }
    }

    /// The singular value at `z`, and the tangent, of unit scaled length; `None` where the bordered
    /// matrix is singular. Any vector with a part along the branch will do for `along`.
    pub(crate) fn at(
        &mut self,
        probe: &mut Probe<'_>,
        z: &Extended,
        along: &Extended,
    ) -> Result<Option<(f64, Extended)>, EvalError> {
        probe.assemble(z)?;
        if self.begun {
            self.frame.factor(probe);
        } else if self.begin(probe, along).is_none() {
            return Ok(None);
        }
        let found = self.renew(probe);
        self.begun = found.is_some();
        Ok(found)
    }

    fn begin(&mut self, probe: &mut Probe<'_>, along: &Extended) -> Option<()> {
        let n = probe.dim();
        let row = probe.covector(along);
        self.frame.set_row(0, &row);
        let u = (0..n).map(|m| arbitrary(1, m)).collect();
        let row = probe.covector(&Extended { u, p: 0.0 });
        self.frame.set_row(1, &row);
        let column: Vec<f64> = (0..n).map(|m| arbitrary(2, m)).collect();
        self.frame.set_column(0, &column);
        self.frame.factor(probe);
        for _ in 0..RENEWALS {
            self.frame.renew(probe)?;
        }
        Some(())
    }

    /// Value and tangent from the latest factors, and borders for the next point.
    fn renew(&mut self, probe: &mut Probe<'_>) -> Option<(f64, Extended)> {
        let mut column: Vec<f64> = self.frame.left(probe, 0);
        let (mut v0, g0) = self.frame.right(probe, 0);
        let (mut v1, g1) = self.frame.right(probe, 1);
        let (mut g0, mut g1) = (g0[0], g1[0]);
        let norm = probe.norm(&v0);
        v0.scale(1.0 / norm);
        g0 /= norm;
        let c0 = probe.covector(&v0);
        let along = c0.dot(&v1);
        v1.add(-along, &v0);
        g1 -= along * g0;
        let norm = probe.norm(&v1);
        v1.scale(1.0 / norm);
        g1 /= norm;
        let length = dot(&column, &column).sqrt();
        column.iter_mut().for_each(|w| *w /= length);
        let value = g0.hypot(g1);
        let regular = length.is_finite() && length > 0.0 && norm > 0.0;
        if !(regular && value.is_finite()) {
            return None;
        }
        let c1 = probe.covector(&v1);
        self.frame.set_row(0, &c0);
        self.frame.set_row(1, &c1);
        self.frame.set_column(0, &column);
        // on the kernel of `[F_u F_p]`, `G y = 0`; anything where `G` vanishes
        let y = if value > 0.0 { [g1 / value, -g0 / value] } else { [1.0, 0.0] };
        let mut tangent = Extended::zero(probe.dim());
        tangent.add(y[0], &v0);
        tangent.add(y[1], &v1);
        Some((value, tangent))
    }
}
