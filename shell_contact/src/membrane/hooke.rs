//! Hooke's law for membranes, Eq. (6a): quadratic in the Green strains.

use super::{Constant, Membrane, MembraneJet};
use crate::scalar::Scalar;

/// `w = [(q−1)² + 2ν(q−1)(m−1) + (m−1)²] / (8(1−ν²))`, Eq. (6a) with `χ = 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hooke {
    /// Poisson ratio `ν`.
    pub poisson: f64,
}

impl Membrane for Hooke {
    #[inline(always)]
    fn energy<T: Scalar>(&self, q: T, m: T) -> T {
        let nu = self.poisson;
        let (x, y) = (q - 1.0, m - 1.0);
        (x * x + x * y * (2.0 * nu) + y * y) * (0.125 / (1.0 - nu * nu))
    }

    #[inline(always)]
    fn jet<T: Scalar>(&self, q: T, m: T) -> MembraneJet<T> {
        let nu = self.poisson;
        let k = 0.25 / (1.0 - nu * nu);
        let (x, y) = (q - 1.0, m - 1.0);
        let w_q = (x + y * nu) * k;
        let w_m = (y + x * nu) * k;
        MembraneJet {
            w: (x * w_q + y * w_m) * 0.5,
            w_q,
            w_m,
            w_qq: T::constant(k),
            w_qm: T::constant(k * nu),
            w_mm: T::constant(k),
        }
    }

    #[inline(always)]
    fn shear<T: Scalar>(&self, _q: T, _m: T) -> T {
        T::constant(0.25 / (1.0 + self.poisson))
    }

    #[inline(always)]
    fn slopes_by<T: Scalar>(&self, constant: Constant, q: T, m: T) -> (T, T) {
        if constant != Constant::Poisson {
            return (T::constant(0.0), T::constant(0.0));
        }
        let nu = self.poisson;
        let k = 0.25 / (1.0 - nu * nu);
        let by_k = 2.0 * nu * k / (1.0 - nu * nu);
        let (x, y) = (q - 1.0, m - 1.0);
        ((x + y * nu) * by_k + y * k, (y + x * nu) * by_k + x * k)
    }
}
