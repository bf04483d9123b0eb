//! The smallest singular value of `[F_u F_p]`, followed along a branch.
//!
//! The bordered matrix of [`super::kernel`] with one border more than a regular point needs: its
//! borders, renewed by the solutions of the point before, tend to the tangent, to the right and to
//! the left vector of the smallest singular value, as in inverse iteration; `|G|` tends to the value.

use super::kernel::{Frame, arbitrary};
use super::probe::{Extended, Probe};
use crate::problem::{EvalError, Problem};

/// Renewals of the borders at the first point, and at every further one.
const RENEWALS: [usize; 2] = [4, 1];

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
    pub(crate) fn at<P: Problem>(
        &mut self,
        probe: &mut Probe<'_, P>,
        z: &Extended,
        along: &Extended,
    ) -> Result<Option<(f64, Extended)>, EvalError> {
        probe.assemble(z)?;
        if !self.begun {
            let n = probe.dim();
            let row = probe.covector(along);
            self.frame.set_row(0, &row);
            let u = (0..n).map(|m| arbitrary(1, m)).collect();
            let row = probe.covector(&Extended { u, p: 0.0 });
            self.frame.set_row(1, &row);
            let column: Vec<f64> = (0..n).map(|m| arbitrary(2, m)).collect();
            self.frame.set_column(0, &column);
        }
        self.frame.factor(probe);
        for _ in 0..RENEWALS[usize::from(self.begun)] {
            if self.frame.renew(probe).is_none() {
                self.begun = false;
                return Ok(None);
            }
        }
        self.begun = true;
        let (v0, g0) = self.frame.right(probe, 0);
        let (v1, g1) = self.frame.right(probe, 1);
        let (g0, g1) = (g0[0], g1[0]);
        let value = g0.hypot(g1);
        if !value.is_finite() {
            self.begun = false;
            return Ok(None);
        }
        // on the kernel of `[F_u F_p]`, `G y = 0`
        let mut tangent = Extended::zero(probe.dim());
        tangent.add(g1 / value, &v0);
        tangent.add(-g0 / value, &v1);
        let norm = probe.norm(&tangent);
        tangent.scale(1.0 / norm);
        Ok(Some((value, tangent)))
    }
}
