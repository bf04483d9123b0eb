//! The potential of Eq. (13a): a well between two powers of the film's height.

use super::{FilmJet, Potential};
use crate::scalar::Scalar;

/// `w_int = W0 [(δ_A/δ)⁴ − 2(δ_A/δ)²]`, Eq. (13a): attraction at long range, repulsion at short
/// range, minimum `−W0` at `δ = δ_A`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FourTwo;

impl Potential for FourTwo {
    #[inline(always)]
    fn energy<T: Scalar>(&self, delta: T, adhesion: T, length: T) -> T {
        let ratio = length / delta;
        let x = ratio * ratio;
        adhesion * x * (x - 2.0)
    }

    #[inline(always)]
    fn jet<T: Scalar>(&self, delta: T, adhesion: f64, length: f64) -> FilmJet<T> {
        let inverse = delta.recip();
        let ratio = inverse * length;
        let x = ratio * ratio;
        let wx = x * adhesion;
        FilmJet {
            w: wx * (x - 2.0),
            d1: (wx - wx * x) * inverse * 4.0,
            d2: wx * (x * 20.0 - 12.0) * (inverse * inverse),
        }
    }

    #[inline(always)]
    fn by_adhesion<T: Scalar>(&self, delta: T, _adhesion: f64, length: f64) -> (T, T) {
        let jet = self.jet(delta, 1.0, length);
        (jet.w, jet.d1)
    }

    #[inline(always)]
    fn by_length<T: Scalar>(&self, delta: T, adhesion: f64, length: f64) -> (T, T) {
        let inverse = delta.recip();
        let ratio = inverse * length;
        let x = ratio * ratio;
        let k = 4.0 * adhesion / length;
        ((x * x - x) * k, (x - x * x * 2.0) * inverse * (2.0 * k))
    }
}

#[cfg(test)]
mod tests {
    use super::super::check;
    use super::*;

    #[test]
    fn derivatives_agree_with_dual_numbers() {
        check::derivatives(&FourTwo, &[0.6, 0.999, 1.5, 12.0]);
    }

    #[test]
    fn minimum_is_minus_the_adhesion_at_the_film_length() {
        check::well(&FourTwo);
    }
}
