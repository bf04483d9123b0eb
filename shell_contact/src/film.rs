//! The interaction potential between shell and plate across the liquid film, Eq. (13).
//!
//! `δ = z_p − z` is the film's height (as in Eq. (17); Eq. (13c) has the opposite sign); the
//! potential acts per deformed area. It is undefined at `δ ≤ 0`: a solver that steps through the
//! plate finds a spurious zero of the force on the other side, so such states are refused by
//! [`crate::energy`], not clamped here.

use crate::scalar::Scalar;

/// Value and derivatives of a potential in the film height `δ`.
#[derive(Debug, Clone, Copy)]
pub struct FilmJet<T> {
    /// `w_int`.
    pub w: T,
    /// `w_int'`.
    pub d1: T,
    /// `w_int''`.
    pub d2: T,
}

/// An interaction potential with a depth (adhesion `W0`) and a length (`δ_A`).
pub trait Potential: Copy + Send + Sync {
    /// The potential alone.
    fn energy<T: Scalar>(&self, delta: T, adhesion: T, length: T) -> T;
    /// The potential and its derivatives in `δ`.
    fn jet<T: Scalar>(&self, delta: T, adhesion: f64, length: f64) -> FilmJet<T>;
    /// `∂w_int/∂W0` and its derivative in `δ`.
    fn by_adhesion<T: Scalar>(&self, delta: T, adhesion: f64, length: f64) -> (T, T);
    /// `∂w_int/∂δ_A` and its derivative in `δ`.
    fn by_length<T: Scalar>(&self, delta: T, adhesion: f64, length: f64) -> (T, T);
}

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

/// No film: the shell feels no plate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct NoFilm;

impl Potential for NoFilm {
    #[inline(always)]
    fn energy<T: Scalar>(&self, _delta: T, _adhesion: T, _length: T) -> T {
        T::constant(0.0)
    }

    #[inline(always)]
    fn jet<T: Scalar>(&self, _delta: T, _adhesion: f64, _length: f64) -> FilmJet<T> {
        let none = T::constant(0.0);
        FilmJet { w: none, d1: none, d2: none }
    }

    #[inline(always)]
    fn by_adhesion<T: Scalar>(&self, _delta: T, _adhesion: f64, _length: f64) -> (T, T) {
        (T::constant(0.0), T::constant(0.0))
    }

    #[inline(always)]
    fn by_length<T: Scalar>(&self, _delta: T, _adhesion: f64, _length: f64) -> (T, T) {
        (T::constant(0.0), T::constant(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::{close, partials};

    #[test]
    fn derivatives_agree_with_dual_numbers() {
        let (w0, length) = (2e-3, 1.0 / 30.0);
        for delta in [0.02, 0.0333, 0.05, 0.4] {
            let d = partials([delta, w0, length], |x| FourTwo.energy(x[0], x[1], x[2]));
            let jet = FourTwo.jet(delta, w0, length);
            close(jet.w, d.value, 1e-12, 1e-18);
            close(jet.d1, d.gradient[0], 1e-12, 1e-16);
            close(jet.d2, d.hessian[0][0], 1e-12, 1e-14);
            let (w, d1) = FourTwo.by_adhesion(delta, w0, length);
            close(w, d.gradient[1], 1e-12, 1e-15);
            close(d1, d.hessian[0][1], 1e-12, 1e-13);
            let (w, d1) = FourTwo.by_length(delta, w0, length);
            close(w, d.gradient[2], 1e-12, 1e-16);
            close(d1, d.hessian[0][2], 1e-12, 1e-14);
        }
    }

    #[test]
    fn minimum_is_minus_the_adhesion_at_the_film_length() {
        let jet = FourTwo.jet(0.03, 2e-3, 0.03);
        close(jet.w, -2e-3, 1e-15, 0.0);
        assert!(jet.d1.abs() < 1e-16 && jet.d2 > 0.0);
    }
}
