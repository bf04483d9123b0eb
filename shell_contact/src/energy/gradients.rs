//! The pointwise gradients of the shell's energy and of what parameters add to it.

use super::GradientAt;
use crate::density::{self, Coefficients, Gradient, Site};
use crate::film::Potential;
use crate::membrane::{Constant, Membrane};
use crate::meridian::Place;
use crate::scalar::{Lanes, Scalar};

/// The energy without its gas term, [`density::gradient`].
pub(crate) struct Energy<'a, L, F> {
    pub(crate) law: &'a L,
    pub(crate) film: &'a F,
    pub(crate) c: &'a Coefficients,
}

impl<L: Membrane, F: Potential> GradientAt for Energy<'_, L, F> {
    #[inline(always)]
    fn at(&self, at: &Site<Lanes>, x: &Place<Lanes>) -> Gradient<Lanes> {
        density::gradient(self.law, self.film, self.c, at, x)
    }
}

/// The bending energy per unit `k_b`.
pub(crate) struct Bending {
    pub(crate) poisson: f64,
}

impl GradientAt for Bending {
    #[inline(always)]
    fn at(&self, at: &Site<Lanes>, x: &Place<Lanes>) -> Gradient<Lanes> {
        density::bending_gradient(self.poisson, at, x)
    }
}

/// The deformed area: the surface energy per unit `γ_BW`.
pub(crate) struct Area;

impl GradientAt for Area {
    #[inline(always)]
    fn at(&self, at: &Site<Lanes>, x: &Place<Lanes>) -> Gradient<Lanes> {
        density::area_gradient(Lanes::constant(1.0), Lanes::ZERO, at, x)
    }
}

/// The energy by a constant of the material.
pub(crate) struct Material<'a, L> {
    pub(crate) law: &'a L,
    pub(crate) constant: Constant,
    pub(crate) c: &'a Coefficients,
}

impl<L: Membrane> GradientAt for Material<'_, L> {
    #[inline(always)]
    fn at(&self, at: &Site<Lanes>, x: &Place<Lanes>) -> Gradient<Lanes> {
        density::material_gradient(self.law, self.constant, self.c, at, x)
    }
}
