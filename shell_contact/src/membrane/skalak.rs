//! Skalak's law: strain hardening, with a separate resistance to change of area.

use super::{Constant, Membrane, MembraneJet};
use crate::scalar::Scalar;

/// `w = (G_s/4)[I1² + 2 I1 − 2 I2 + C I2²]` with `I1 = q + m − 2`, `I2 = qm − 1`,
/// `C = ν/(1−ν)` and `G_s = 1/(2(1+ν))`, so that `χ = 1` is the two-dimensional Young modulus.
/// (`I1² + 2 I1 − 2 I2 = (q−1)² + (m−1)²`.)
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Skalak {
    /// Poisson ratio `ν` at small strain, in `[0, 1)`.
    pub poisson: f64,
}

impl Skalak {
    /// Skalak's constant `C = ν/(1−ν)`.
    pub fn area_constant(&self) -> f64 {
        self.poisson / (1.0 - self.poisson)
    }
}

impl Membrane for Skalak {
    #[inline(always)]
    fn energy<T: Scalar>(&self, q: T, m: T) -> T {
        let quarter = 0.125 / (1.0 + self.poisson);
        let (x, y) = (q - 1.0, m - 1.0);
        let i2 = x + y + x * y;
        (x * x + y * y + i2 * i2 * self.area_constant()) * quarter
    }

    #[inline(always)]
    fn jet<T: Scalar>(&self, q: T, m: T) -> MembraneJet<T> {
        let c = self.area_constant();
        let half = 0.25 / (1.0 + self.poisson);
        let (x, y) = (q - 1.0, m - 1.0);
        let i2 = x + y + x * y;
        let ci2 = i2 * c;
        MembraneJet {
            w: (x * x + y * y + i2 * ci2) * (0.5 * half),
            w_q: (x + ci2 * m) * half,
            w_m: (y + ci2 * q) * half,
            w_qq: (m * m * c + 1.0) * half,
            w_qm: (ci2 + q * m * c) * half,
            w_mm: (q * q * c + 1.0) * half,
        }
    }

    #[inline(always)]
    fn shear<T: Scalar>(&self, q: T, m: T) -> T {
        let half = 0.25 / (1.0 + self.poisson);
        (-((q * m - 1.0) * self.area_constant()) + 1.0) * half
    }

    #[inline(always)]
    fn slopes_by<T: Scalar>(&self, constant: Constant, q: T, m: T) -> (T, T) {
        if constant != Constant::Poisson {
            return (T::constant(0.0), T::constant(0.0));
        }
        let nu = self.poisson;
        let half = 0.25 / (1.0 + nu);
        // of half, and of C times half
        let by_half = -half / (1.0 + nu);
        let by_area = self.area_constant() * by_half + half / ((1.0 - nu) * (1.0 - nu));
        let (x, y) = (q - 1.0, m - 1.0);
        let i2 = x + y + x * y;
        (x * by_half + i2 * m * by_area, y * by_half + i2 * q * by_area)
    }
}
