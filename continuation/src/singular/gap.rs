//! Whether a simple branch point is one, or two branches pass each other.
//!
//! Near a simple singular point, with `F_z V = 0`, `ψᵀF_z = 0` and `z + V y`, the equations reduce to
//! ```text
//!     δ + ½ yᵀ Q y = 0,    δ = ψᵀF(z),    Q = ψᵀF_zz[V, V].
//! ```
//! For `δ = 0` two lines cross. Otherwise the solutions are a hyperbola, whose two branches come as
//! near as the distance between its vertices; a step from one to the other is a jump. `δ = 0` has to
//! mean: no more than the rounding errors of `ψᵀF`. These show where the last digits of the state
//! change, because `ψᵀF` itself does not vary there to first order.

use super::kernel::{Singular, arbitrary};
use super::probe::{Extended, Probe};
use crate::problem::EvalError;
use crate::step::dot;

/// States at which the rounding errors are sampled.
const SAMPLES: usize = 6;
/// Change of each number of the state there, relative to it.
const LAST_DIGITS: f64 = 2.0 * f64::EPSILON;
/// Largest `δ` that is rounding, in terms of the largest of the samples' differences from it, which are
/// about twice the standard deviation.
const FACTOR: f64 = 4.0;

/// Distance between the two branches, in the scaled metric: 0 where they cross, to rounding, infinite
/// where there is nothing real.
pub(super) fn between_branches(probe: &mut Probe<'_>, found: &Singular) -> Result<f64, EvalError> {
    let (psi, z) = (&found.left[0], &found.z);
    let defect = dot(psi, probe.residual_at(z)?);
    if defect == 0.0 || found.gap == 0.0 {
        return Ok(0.0);
    }
    let mut rounding = 0.0_f64;
    let mut x = Extended::zero(z.u.len());
    for sample in 0..SAMPLES {
        let seed = 2 * sample + 3;
        for (i, (x, u)) in x.u.iter_mut().zip(&z.u).enumerate() {
            *x = u * (1.0 + LAST_DIGITS * arbitrary(seed, i));
        }
        x.p = z.p * (1.0 + LAST_DIGITS * arbitrary(seed + 1, 0));
        rounding = rounding.max((dot(psi, probe.residual_at(&x)?) - defect).abs());
    }
    let crosses = defect.abs() <= FACTOR * rounding;
    Ok(if crosses { 0.0 } else { vertices(&found.form[0], defect) })
}

/// Distance between the vertices of the hyperbola `defect + yᵀ form y / 2 = 0`; infinite where that
/// has no real points.
fn vertices(form: &[Vec<f64>], defect: f64) -> f64 {
    let (a, b, c) = (form[0][0], form[0][1], form[1][1]);
    let (mean, radius) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
    // its axis lies along the eigenvector whose eigenvalue balances the defect
    let value = if defect > 0.0 { radius - mean } else { radius + mean };
    if value > 0.0 { 2.0 * (2.0 * defect.abs() / value).sqrt() } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::vertices;

    #[test]
    fn vertices_of_hyperbolas() {
        // 2 x y = 1, vertices ±(1, 1)/√2
        let form = |a: f64, b: f64, c: f64| [vec![a, b], vec![b, c]];
        assert!((vertices(&form(0.0, 2.0, 0.0), -1.0) - 2.0).abs() < 1e-15);
        assert!((vertices(&form(0.0, 2.0, 0.0), 1.0) - 2.0).abs() < 1e-15);
        // x² − 4 y² = ±1
        assert!((vertices(&form(2.0, 0.0, -8.0), -1.0) - 2.0).abs() < 1e-15);
        assert!((vertices(&form(2.0, 0.0, -8.0), 1.0) - 1.0).abs() < 1e-15);
        // no real points
        assert_eq!(vertices(&form(2.0, 0.0, 8.0), 1.0), f64::INFINITY);
    }
}
