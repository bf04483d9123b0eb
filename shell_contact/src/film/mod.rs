//! The interaction potential between shell and plate across the liquid film, Eq. (13).
//!
//! `δ = z_p − z` is the film's height (as in Eq. (17); Eq. (13c) has the opposite sign); the
//! potential acts per deformed area. Every potential has its minimum `−W0` at `δ = δ_A`: it attracts
//! at long range and repels nearer, so that adhesion and film length mean the same in all of them.
//!
//! A potential is undefined at `δ ≤ 0`, and may be without a bound further out: a solver that steps
//! through the plate, or over a barrier, finds a spurious zero of the force on the other side. Such
//! states are refused by [`crate::energy`] at the potential's [`Wall`], not clamped here.
//!
//! One potential per file. [`Film`] is the choice among them: densities and their sums are generic over
//! [`Potential`], problems take a [`Film`], so that they are compiled in this package and nowhere else.

mod dlvo;
mod four_two;
mod none;

pub use dlvo::{Dlvo, SurfaceForces, double_layer_of_surface_potential};
pub use four_two::FourTwo;
pub use none::NoFilm;

use crate::density::Coefficients;
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

    /// The height, in `δ_A`, at and below which there is no film: 0 for a potential that repels all
    /// the way to the plate.
    fn least_height(&self) -> f64 {
        0.0
    }

    /// What the shell must stay below.
    fn wall(&self, c: &Coefficients) -> Wall {
        let least = self.least_height();
        if least > 0.0 {
            Wall { height: c.plate - least * c.film, what: THE_FILM_BREAKS }
        } else {
            Wall::from(c.plate)
        }
    }
}

const THROUGH_THE_PLATE: &str = "the shell touches or passes the plate: film height not positive";
const THE_FILM_BREAKS: &str =
    "the film breaks: its height does not exceed that of the potential's barrier";

/// A height that the shell must stay below: the plate's, or that at which the film breaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wall {
    /// Height above the equator.
    pub height: f64,
    /// What is violated at or above it.
    pub what: &'static str,
}

impl From<f64> for Wall {
    /// The plate itself.
    fn from(plate: f64) -> Wall {
        Wall { height: plate, what: THROUGH_THE_PLATE }
    }
}

/// The potential of a film, as cases choose it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Film {
    /// Eq. (13a).
    #[default]
    FourTwo,
    /// Double-layer repulsion with van der Waals attraction.
    Dlvo(Dlvo),
}

/// Runs `$body` with `$film` bound to the potential as its own type.
macro_rules! with_film {
    ($choice:expr, |$film:ident| $body:expr) => {
        match $choice {
            Film::FourTwo => {
                let $film = &FourTwo;
                $body
            }
            Film::Dlvo($film) => $body,
        }
    };
}

impl Potential for Film {
    #[inline(always)]
    fn energy<T: Scalar>(&self, delta: T, adhesion: T, length: T) -> T {
        with_film!(self, |film| film.energy(delta, adhesion, length))
    }

    #[inline(always)]
    fn jet<T: Scalar>(&self, delta: T, adhesion: f64, length: f64) -> FilmJet<T> {
        with_film!(self, |film| film.jet(delta, adhesion, length))
    }

    #[inline(always)]
    fn by_adhesion<T: Scalar>(&self, delta: T, adhesion: f64, length: f64) -> (T, T) {
        with_film!(self, |film| film.by_adhesion(delta, adhesion, length))
    }

    #[inline(always)]
    fn by_length<T: Scalar>(&self, delta: T, adhesion: f64, length: f64) -> (T, T) {
        with_film!(self, |film| film.by_length(delta, adhesion, length))
    }

    fn least_height(&self) -> f64 {
        with_film!(self, |film| film.least_height())
    }
}

/// What every potential must satisfy, for the tests of each.
#[cfg(test)]
pub(crate) mod check {
    use super::{Dlvo, Film, Potential};
    use crate::dual::{close, partials};

    /// One potential of each kind.
    pub(crate) fn every() -> [Film; 2] {
        [Film::FourTwo, Film::Dlvo(Dlvo::new(0.15).unwrap())]
    }

    /// Every derivative agrees with dual numbers to rounding, at heights given in film lengths.
    pub(crate) fn derivatives<F: Potential>(film: &F, heights: &[f64]) {
        let (w0, length) = (2e-3, 1.0 / 30.0);
        for height in heights {
            let delta = height * length;
            let d = partials([delta, w0, length], |x| film.energy(x[0], x[1], x[2]));
            // sums of terms that cancel are exact to the rounding of the terms
            let jet = film.jet(delta, w0, length);
            close(jet.w, d.value, 1e-12, 1e-18);
            close(jet.d1, d.gradient[0], 1e-12, 1e-16);
            close(jet.d2, d.hessian[0][0], 1e-12, 1e-14);
            let (w, d1) = film.by_adhesion(delta, w0, length);
            close(w, d.gradient[1], 1e-12, 1e-15);
            close(d1, d.hessian[0][1], 1e-12, 1e-13);
            let (w, d1) = film.by_length(delta, w0, length);
            close(w, d.gradient[2], 1e-12, 1e-16);
            close(d1, d.hessian[0][2], 1e-12, 1e-14);
        }
    }

    /// The minimum is `−W0` at `δ_A`, and the film attracts beyond it.
    pub(crate) fn well<F: Potential>(film: &F) {
        let (w0, length) = (2e-3, 0.03);
        let jet = film.jet(length, w0, length);
        close(jet.w, -w0, 1e-14, 0.0);
        assert!(jet.d1.abs() < 1e-14 * w0 / length && jet.d2 > 0.0);
        for k in 1..400 {
            let delta = length * (1.0 + 0.05 * f64::from(k));
            let jet = film.jet(delta, w0, length);
            assert!(jet.w > -w0 && jet.w < 0.0 && jet.d1 > 0.0, "{delta}");
        }
        for k in 1..20 {
            let part = f64::from(k) / 20.0;
            let least = film.least_height();
            let delta = length * (least + (1.0 - least) * part);
            let jet = film.jet(delta, w0, length);
            assert!(jet.w > -w0 && jet.d1 < 0.0, "{delta}");
        }
    }
}
