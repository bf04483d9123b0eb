//! Whether the elements resolve what the solution varies on: the film's length, and the shell's wavelength.
//!
//! Bending against the film's stiffness makes the length `ℓ = (k_b/|w_int''|)^{1/4}`, largest `|w_int''|`
//! where the film is thinnest; bending against stretching makes wavelengths `λ = 2π (k_b R0²/χ)^{1/4}`.
//! Where an element is about as long as either the discrete shell has states of its own: tens of folds as
//! contact goes from one element to the next. Both are in `R0`; elements are measured unstretched.

use crate::contact::ContactProblem;
use crate::film::Potential;
use crate::half::HalfMeridian;
use continuation::EvalError;
use std::f64::consts::TAU;

/// Elements per film length from which on a mesh is called fine enough. Of 369 random shells of all laws,
/// with and without surface tension and grading, against meshes four times as fine: of those with so many
/// and [`FEWEST_PER_WAVELENGTH`] none had other folds, another end, or a force wrong by 2 %; with fewer,
/// down from 0.76, some had (a smaller sample: `tests/resolution.rs`).
pub const FEWEST_PER_FILM_LENGTH: f64 = 1.0;
/// The same for elements per wavelength of the shell.
pub const FEWEST_PER_WAVELENGTH: f64 = 15.0;

/// How many elements there are for each length of the solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Elements per film length where that is least; infinite without a film.
    pub per_film_length: f64,
    /// Elements per wavelength of the shell, by the longest element.
    pub per_wavelength: f64,
}

impl Resolution {
    /// Whether both are enough.
    pub fn is_enough(&self) -> bool {
        self.factor() <= 1.0
    }

    /// How many times as many elements would be enough, at least.
    pub fn factor(&self) -> f64 {
        let film = FEWEST_PER_FILM_LENGTH / self.per_film_length;
        film.max(FEWEST_PER_WAVELENGTH / self.per_wavelength)
    }

    /// The smaller of both numbers, each.
    #[must_use]
    pub fn least(self, other: Resolution) -> Resolution {
        Resolution {
            per_film_length: self.per_film_length.min(other.per_film_length),
            per_wavelength: self.per_wavelength.min(other.per_wavelength),
        }
    }
}

impl<F: Potential> ContactProblem<F> {
    /// How well the elements resolve the state `u` with the parameters `p`.
    ///
    /// # Errors
    /// When the parameters are out of range.
    pub fn resolution(&self, u: &[f64], p: &[f64]) -> Result<Resolution, EvalError> {
        let (c, _) = self.coefficients(u, p)?;
        let mesh = &self.mesh;
        let (mut longest, mut film) = (0.0_f64, f64::INFINITY);
        for e in 0..mesh.elements() {
            let (start, end) =
                (HalfMeridian::knots(mesh).at(e), HalfMeridian::knots(mesh).at(e + 1));
            let length = end - start;
            longest = longest.max(length);
            for part in [0.0, 0.5, 1.0] {
                let at = start + part * length;
                let [(_, w), ..] = mesh.displacement_in(u, e, at);
                let delta = c.plate - at.cos() - w;
                let stiffness = self.potential.jet(delta, c.adhesion, c.film).d2.abs();
                let own = (c.bending / stiffness).sqrt().sqrt();
                film = film.min(own / length);
            }
        }
        let wavelength = TAU * c.bending.sqrt().sqrt();
        Ok(Resolution { per_film_length: film, per_wavelength: wavelength / longest })
    }
}
