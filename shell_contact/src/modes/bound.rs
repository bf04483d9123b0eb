//! The largest wave number at which a patch of the shell can be unstable.
//!
//! A patch with principal tensions `T_s, T_φ` (membrane, surface and film) and film stiffness
//! `q = w_int'' n_z²` is unstable to waves `(k_s, n/σ)` only if
//! `k_b K⁴ + min(T_s, T_φ) K² + min(q, 0) < 0`, `K² = k_s² + n²/σ²`; what curvature adds is
//! positive. Hence `n ≤ σ √([T⁻ + √(T⁻² + 4 k_b q⁻)]/(2 k_b))`, `T⁻`, `q⁻` the negative parts.
//! It holds for states that vary slowly over a wave; it is no theorem.

use crate::density::Coefficients;
use crate::energy::{self, Visitor};
use crate::film::Potential;
use crate::half::HalfMeridian;
use crate::membrane::Membrane;
use crate::meridian::{Cell, Place};
use crate::scalar::{Lanes, Scalar, WIDTH};
use continuation::EvalError;
use continuation::linalg::kernel::Arithmetic;

/// The largest such `n` over the meridian.
pub(super) fn largest_wave<L: Membrane, F: Potential>(
    mesh: &impl HalfMeridian,
    u: &[f64],
    law: &L,
    film: &F,
    c: &Coefficients,
) -> Result<f64, EvalError> {
    let mut largest = Largest { law, film, c, wave: 0.0 };
    energy::visit(mesh, u, film.wall(c), &mut largest)?;
    Ok(largest.wave)
}

struct Largest<'a, L, F> {
    law: &'a L,
    film: &'a F,
    c: &'a Coefficients,
    wave: f64,
}

impl<H, L: Membrane, F: Potential> Visitor<H> for Largest<'_, L, F> {
    #[inline(always)]
    fn cell<A: Arithmetic>(&mut self, cell: &Cell, x: &Place<Lanes>) {
        let Largest { law, film, c, wave } = self;
        let at = cell.site();
        let ([s, s1, _], [z, z1, _]) = (x.s, x.z);
        let q = s1 * s1 + z1 * z1;
        let hoop = s * at.csc;
        let jet = law.jet(q, hoop * hoop);
        let lambda = q.sqrt();
        let force = film.jet(-(z - c.plate), c.adhesion, c.film);
        let surface = force.w + c.surface_tension;
        let ts = lambda * jet.w_q / hoop * 2.0 + surface;
        let tf = hoop * jet.w_m / lambda * 2.0 + surface;
        let stiffness = force.d2 * s1 * s1 / q;
        for l in 0..WIDTH {
            let pull = (-ts.0[l]).max(-tf.0[l]).max(0.0);
            let soft = (-stiffness.0[l]).max(0.0);
            let k2 = (pull + (pull * pull + 4.0 * c.bending * soft).sqrt()) / (2.0 * c.bending);
            let n = s.0[l] * k2.sqrt();
            // NaN is kept: the scan then says that it is not certain
            if n > *wave || n.is_nan() {
                *wave = n;
            }
        }
    }
}
