//! What one plate does to the half of the shell in front of it: `∂E/∂z_p` and its derivatives.
//!
//! `E` is the energy of that half over `2π`; the force on the plate is `−2π/√k_b ∂E/∂z_p`.

use crate::density::{self, Coefficients, Gradient, Site};
use crate::energy::{self, Direction, GradientAt, ValueAt};
use crate::film::{FilmJet, Potential};
use crate::half::HalfMeridian;
use crate::meridian::Place;
use crate::scalar::{Lanes, Scalar};
use continuation::EvalError;
use std::f64::consts::PI;

/// What a plate's film depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Variable {
    /// The plate's height `z_p`.
    Height,
    /// Adhesion `W0`.
    Adhesion,
    /// Film length `δ_A`.
    Length,
}

/// The factor by which `∂E/∂z_p` becomes the reported force.
pub(crate) fn force_factor(bending: f64) -> f64 {
    -2.0 * PI / bending.sqrt()
}

/// `∂E/∂z_p = ∫w_int'(δ) σ a dS`.
pub(crate) fn pull<F: Potential>(
    half: &impl HalfMeridian,
    film: &F,
    u: &[f64],
    c: &Coefficients,
) -> Result<f64, EvalError> {
    energy::integrate(half, u, film.wall(c), &Pull { film, c })
}

/// Partial derivative of [`pull`] at a fixed shell.
pub(crate) fn pull_by<F: Potential>(
    half: &impl HalfMeridian,
    film: &F,
    u: &[f64],
    c: &Coefficients,
    by: Variable,
) -> Result<f64, EvalError> {
    energy::integrate(half, u, film.wall(c), &PullBy { film, c, by })
}

/// Slope of [`pull`] in the direction `du` of the unknowns and by `dp` of the variable, if any.
pub(crate) fn pull_along<F: Potential>(
    half: &impl HalfMeridian,
    film: &F,
    u: &[f64],
    c: &Coefficients,
    du: &[f64],
    by: Option<(Variable, f64)>,
) -> Result<f64, EvalError> {
    energy::integrate_along(half, u, du, film.wall(c), &PullAlong { film, c, by })
}

/// Adds to `out` the derivative of the half's gradient by a variable.
pub(crate) fn add_gradient_by<F: Potential>(
    half: &impl HalfMeridian,
    film: &F,
    u: &[f64],
    c: &Coefficients,
    by: Variable,
    out: &mut [f64],
) -> Result<(), EvalError> {
    let wall = film.wall(c);
    match by {
        // one that is known when it is compiled: this is in every correction
        Variable::Height => energy::add_gradient(half, u, wall, out, &ByHeight { film, c }),
        _ => energy::add_gradient(half, u, wall, out, &GradientBy { film, c, by }),
    }
}

struct Pull<'a, F> {
    film: &'a F,
    c: &'a Coefficients,
}

impl<F: Potential> ValueAt for Pull<'_, F> {
    #[inline(always)]
    fn at(&self, at: &Site<Lanes>, x: &Place<Lanes>) -> Lanes {
        jet(self.film, self.c, x.z[0]).d1 * x.s[0] * stretch(x) * at.weight
    }
}

struct PullBy<'a, F> {
    film: &'a F,
    c: &'a Coefficients,
    by: Variable,
}

impl<F: Potential> ValueAt for PullBy<'_, F> {
    #[inline(always)]
    fn at(&self, at: &Site<Lanes>, x: &Place<Lanes>) -> Lanes {
        slope(self.film, self.c, x.z[0], self.by) * x.s[0] * stretch(x) * at.weight
    }
}

struct PullAlong<'a, F> {
    film: &'a F,
    c: &'a Coefficients,
    by: Option<(Variable, f64)>,
}

impl<F: Potential> Direction for PullAlong<'_, F> {
    #[inline(always)]
    fn at(&self, at: &Site<Lanes>, x: &Place<Lanes>, d: &Place<Lanes>) -> Lanes {
        let a = stretch(x);
        let f = jet(self.film, self.c, x.z[0]);
        let stretching = (x.s[1] * d.s[1] + x.z[1] * d.z[1]) / a;
        let along = f.d1 * (a * d.s[0] + x.s[0] * stretching) - f.d2 * x.s[0] * a * d.z[0];
        let direct = match self.by {
            Some((variable, dp)) => slope(self.film, self.c, x.z[0], variable) * dp,
            None => Lanes::ZERO,
        };
        (along + direct * x.s[0] * a) * at.weight
    }
}

struct ByHeight<'a, F> {
    film: &'a F,
    c: &'a Coefficients,
}

impl<F: Potential> GradientAt for ByHeight<'_, F> {
    #[inline(always)]
    fn at(&self, at: &Site<Lanes>, x: &Place<Lanes>) -> Gradient<Lanes> {
        let f = jet(self.film, self.c, x.z[0]);
        density::area_gradient(f.d1, -f.d2, at, x)
    }
}

struct GradientBy<'a, F> {
    film: &'a F,
    c: &'a Coefficients,
    by: Variable,
}

impl<F: Potential> GradientAt for GradientBy<'_, F> {
    #[inline(always)]
    fn at(&self, at: &Site<Lanes>, x: &Place<Lanes>) -> Gradient<Lanes> {
        let c = self.c;
        let delta = -(x.z[0] - c.plate);
        let (w, d1) = match self.by {
            Variable::Height => {
                let f = jet(self.film, c, x.z[0]);
                (f.d1, f.d2)
            }
            Variable::Adhesion => self.film.by_adhesion(delta, c.adhesion, c.film),
            Variable::Length => self.film.by_length(delta, c.adhesion, c.film),
        };
        density::area_gradient(w, -d1, at, x)
    }
}

/// Meridional stretch `a`.
#[inline(always)]
fn stretch(x: &Place<Lanes>) -> Lanes {
    (x.s[1] * x.s[1] + x.z[1] * x.z[1]).sqrt()
}

#[inline(always)]
fn jet<F: Potential>(film: &F, c: &Coefficients, z: Lanes) -> FilmJet<Lanes> {
    film.jet(-(z - c.plate), c.adhesion, c.film)
}

/// Derivative of `w_int'` by a variable.
#[inline(always)]
fn slope<F: Potential>(film: &F, c: &Coefficients, z: Lanes, by: Variable) -> Lanes {
    let delta = -(z - c.plate);
    match by {
        Variable::Height => film.jet(delta, c.adhesion, c.film).d2,
        Variable::Adhesion => film.by_adhesion(delta, c.adhesion, c.film).1,
        Variable::Length => film.by_length(delta, c.adhesion, c.film).1,
    }
}
