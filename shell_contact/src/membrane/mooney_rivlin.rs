//! The Mooney-Rivlin law of an incompressible film, Eq. (6b): strain softening.

use super::{Constant, Membrane, MembraneJet};
use crate::scalar::Scalar;

/// `w = (1/6)[(1−b)(q + m + 1/(qm) − 3) + b(1/q + 1/m + qm − 3)]`: Eq. (6b) with
/// `I1 + 2 = q + m`, `I2 + 1 = qm`, shear modulus `χ/3`, and its value at rest subtracted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MooneyRivlin {
    /// The share `b` of the second term, in `[0, 1]`; 0 is neo-Hookean.
    pub b: f64,
}

const HALF_SHEAR: f64 = 1.0 / 6.0;

impl Membrane for MooneyRivlin {
    #[inline(always)]
    fn energy<T: Scalar>(&self, q: T, m: T) -> T {
        let (g, h) = ((1.0 - self.b) * HALF_SHEAR, self.b * HALF_SHEAR);
        let (x, y) = (q - 1.0, m - 1.0);
        let (xx, xy, yy) = (x * x, x * y, y * y);
        // q + m + 1/(qm) - 3 and 1/q + 1/m + qm - 3 without the cancellation
        let first = (xx + xy + yy + xy * (x + y)) / (q * m);
        let second = xx / q + yy / m + xy;
        first * g + second * h
    }

    #[inline(always)]
    fn jet<T: Scalar>(&self, q: T, m: T) -> MembraneJet<T> {
        let (g, h) = ((1.0 - self.b) * HALF_SHEAR, self.b * HALF_SHEAR);
        let (x, y) = (q - 1.0, m - 1.0);
        let j = (q * m).recip();
        let (iq, im) = (j * m, j * q); // 1/q, 1/m
        let (iqq, imm) = (iq * iq, im * im);
        let (xx, xy, yy) = (x * x, x * y, y * y);
        let first = (xx + xy + yy + xy * (x + y)) * j;
        let second = xx * iq + yy * im + xy;
        let unit = T::constant(1.0);
        MembraneJet {
            w: first * g + second * h,
            w_q: (unit - j * iq) * g + (m - iqq) * h,
            w_m: (unit - j * im) * g + (q - imm) * h,
            w_qq: (j * iqq * g + iqq * iq * h) * 2.0,
            w_qm: j * j * g + h,
            w_mm: (j * imm * g + imm * im * h) * 2.0,
        }
    }

    #[inline(always)]
    fn shear<T: Scalar>(&self, q: T, m: T) -> T {
        let (g, h) = ((1.0 - self.b) * HALF_SHEAR, self.b * HALF_SHEAR);
        let j = (q * m).recip();
        let jj = j * j;
        jj * g + ((q + m) * jj - 1.0) * h
    }

    #[inline(always)]
    fn slopes_by<T: Scalar>(&self, constant: Constant, q: T, m: T) -> (T, T) {
        if constant != Constant::MooneyB {
            return (T::constant(0.0), T::constant(0.0));
        }
        let j = (q * m).recip();
        let (iq, im) = (j * m, j * q); // 1/q, 1/m
        let of = |over: T, other: T| (other - over * over - 1.0 + j * over) * HALF_SHEAR;
        (of(iq, m), of(im, q))
    }
}
