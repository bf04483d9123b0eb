//! Whether the elements resolve what the solution varies on: the film's length, and the shell's wavelength.
//!
//! Bending against the film's stiffness makes the length `ℓ = (k_b/|w_int''|)^{1/4}`, largest `|w_int''|`
//! where the film is thinnest; bending against stretching makes wavelengths `λ = 2π (k_b R0²/χ)^{1/4}`.
//! Where an element is about as long as either the discrete shell has states of its own: tens of folds as
//! contact goes from one element to the next. Both are in `R0`; elements are measured unstretched.

use crate::contact::ContactProblem;
use crate::density::Coefficients;
use crate::film::{Film, Potential};
use crate::half::HalfMeridian;
use crate::two_plates::{SupportedProblem, TwoPlatesProblem};
use continuation::EvalError;
use std::f64::consts::{FRAC_PI_2, TAU};

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

impl ContactProblem {
    /// How well the elements resolve the state `u` with the parameters `p`.
    ///
    /// # Errors
    /// When the parameters are out of range.
    pub fn resolution(&self, u: &[f64], p: &[f64]) -> Result<Resolution, EvalError> {
        self.resolution_at(&self.resolution_sites(), u, p)
    }

    /// Where [`Self::resolution`] looks, for many states.
    pub fn resolution_sites(&self) -> Sites {
        Sites::of(&self.mesh)
    }

    /// [`Self::resolution`] at sites that are known.
    ///
    /// # Errors
    /// When the parameters are out of range.
    pub fn resolution_at(
        &self,
        sites: &Sites,
        u: &[f64],
        p: &[f64],
    ) -> Result<Resolution, EvalError> {
        let (c, _) = self.coefficients(u, p)?;
        Ok(of_half(&self.mesh, sites, &self.potential, u, &c))
    }
}

impl TwoPlatesProblem {
    /// How well the elements resolve the state `u` with the parameters `p`: the worse of both halves.
    ///
    /// # Errors
    /// When the parameters are out of range.
    pub fn resolution(&self, u: &[f64], p: &[f64]) -> Result<Resolution, EvalError> {
        let (c, _) = self.coefficients(u.len(), p)?;
        Ok(self.resolution_between(u, &c))
    }

    /// [`Self::resolution`] with plates at heights of their own.
    pub(crate) fn resolution_between(&self, u: &[f64], c: &[Coefficients; 2]) -> Resolution {
        let [top, bottom] = self.halves();
        // the mesh of one half is that of the other
        let sites = Sites::of(&top);
        let upper = of_half(&top, &sites, &self.potentials.0, u, &c[0]);
        upper.least(of_half(&bottom, &sites, &self.potentials.1, u, &c[1]))
    }
}

impl SupportedProblem<'_> {
    /// How well the elements resolve the state `x` with the parameters `p`: the worse of both halves.
    ///
    /// # Errors
    /// When the parameters are out of range.
    pub fn resolution(&self, x: &[f64], p: &[f64]) -> Result<Resolution, EvalError> {
        let (u, c, _) = self.inner(x, p)?;
        Ok(self.shell().resolution_between(u, &c))
    }
}

/// The wavelength of the shell.
pub(crate) fn wavelength(c: &Coefficients) -> f64 {
    TAU * c.bending.sqrt().sqrt()
}

/// Length of the longest of the elements that reach into an interval.
pub(crate) fn longest(half: &impl HalfMeridian, (low, high): (f64, f64)) -> f64 {
    let elements = (0..half.elements()).map(|e| (half.knots().at(e), half.knots().at(e + 1)));
    let near = elements.filter(|(start, end)| *end > low && *start < high);
    near.map(|(start, end)| end - start).fold(0.0, f64::max)
}

/// Ends and middle of every element: what of them does not depend on the state.
#[derive(Debug, Clone)]
pub struct Sites {
    each: Vec<[Site; 3]>,
    longest: f64,
}

#[derive(Debug, Clone)]
struct Site {
    cos: f64,
    /// That of the element's length.
    fourth_power: f64,
    /// The functions of the element.
    basis: [f64; 4],
}

impl Sites {
    fn of(half: &impl HalfMeridian) -> Sites {
        let knots = half.knots();
        let of = |element: usize| {
            let (start, end) = (knots.at(element), knots.at(element + 1));
            let length = end - start;
            [start, start + 0.5 * length, end].map(|at| {
                let [basis, ..] = knots.basis(element, at);
                Site { cos: at.cos(), fourth_power: length.powi(4), basis }
            })
        };
        let each = (0..half.elements()).map(of).collect();
        Sites { each, longest: longest(half, (0.0, FRAC_PI_2)) }
    }
}

fn of_half(
    half: &impl HalfMeridian,
    sites: &Sites,
    potential: &Film,
    u: &[f64],
    c: &Coefficients,
) -> Resolution {
    // fourth power of the lengths per element
    let mut least = f64::INFINITY;
    for (e, sites) in sites.each.iter().enumerate() {
        let local = half.local(u, e);
        for site in sites {
            let delta = c.plate - site.cos - local.height(&site.basis);
            let stiffness = potential.jet(delta, c.adhesion, c.film).d2.abs();
            least = least.min(c.bending / (stiffness * site.fourth_power));
        }
    }
    let film = least.sqrt().sqrt();
    Resolution { per_film_length: film, per_wavelength: wavelength(c) / sites.longest }
}
