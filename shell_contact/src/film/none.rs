//! No film.

use super::{FilmJet, Potential};
use crate::scalar::Scalar;

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
