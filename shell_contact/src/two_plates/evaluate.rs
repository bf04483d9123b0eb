//! Energy, gradient and Hessian of the whole shell over `2π`, as sums over its halves.
//!
//! The plates' heights are given one by one, so that the same serves plates at `±z0` and an upper
//! plate on a spring. The gas is that of the half model at half the volume: with
//! `E_gas = 2 gas(V̂/2)` its pressure is the same and the rank-one term of the Hessian half as
//! stiff, `γP_G/V̂`.

use super::{Half, Side, TwoPlatesProblem, parameter};
use crate::contact::POISSON_RATIO;
use crate::density::{Coefficients, Parts};
use crate::energy::{self, gradients};
use crate::film::{Potential, Wall};
use crate::gas::Gas;
use crate::membrane::Constant;
use crate::params::Shell;
use crate::plate::{self, Variable};
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, ParamId};
use std::f64::consts::PI;

const PLATES_CROSS: &str = "the plates cross: their distance is not positive";
const POLES_MEET: &str = "the dimples meet: the poles cross each other";

impl TwoPlatesProblem {
    /// The upper half and the lower.
    pub(crate) fn halves(&self) -> [Half<'_>; 2] {
        Side::BOTH.map(|side| Half::new(&self.mesh, side))
    }

    /// The numbers of either half's density, and the gas, with the plates at `±p[0]`; `unknowns`
    /// is their number, from which errors count on to the parameters.
    pub(crate) fn coefficients(
        &self,
        unknowns: usize,
        p: &[f64],
    ) -> Result<([Coefficients; 2], Gas), EvalError> {
        if let Some(k) =
            (0..self.parameters.len()).find(|&k| !p.get(k).is_some_and(|x| x.is_finite()))
        {
            return Err(EvalError::NotFinite { at: unknowns + k });
        }
        let value = |ParamId(k): ParamId| p[k];
        let positive = [
            (parameter::Z0, PLATES_CROSS),
            (parameter::BENDING, "the bending stiffness is not positive"),
            (parameter::FILM_TOP, "the film length of the upper plate is not positive"),
            (parameter::FILM_BOTTOM, "the film length of the lower plate is not positive"),
        ];
        for (which, what) in positive {
            if value(which) <= 0.0 {
                let (at, value) = (unknowns + which.0, value(which));
                return Err(EvalError::Inadmissible { what, at, value });
            }
        }
        let poisson = value(parameter::POISSON);
        if poisson.abs() >= 1.0 {
            let at = unknowns + parameter::POISSON.0;
            return Err(EvalError::Inadmissible { what: POISSON_RATIO, at, value: poisson });
        }
        let surface_tension = value(parameter::SURFACE_TENSION);
        let top = Coefficients {
            bending: value(parameter::BENDING),
            poisson,
            b: p.get(parameter::B.0).copied().unwrap_or(f64::NAN),
            surface_tension,
            adhesion: value(parameter::ADHESION_TOP),
            film: value(parameter::FILM_TOP),
            plate: value(parameter::Z0),
        };
        let bottom = Coefficients {
            adhesion: value(parameter::ADHESION_BOTTOM),
            film: value(parameter::FILM_BOTTOM),
            ..top
        };
        // a plate that the shell does not feel is out of its way
        let [top, bottom] = [top, bottom].map(|c| {
            let plate = if c.adhesion == 0.0 { f64::INFINITY } else { c.plate };
            Coefficients { plate, ..c }
        });
        let ambient = value(parameter::PRESSURE);
        let gas = Gas { ambient, surface_tension, exponent: value(parameter::GAS_EXPONENT) };
        Ok(([top, bottom], gas))
    }

    /// `V̂` of the whole shell, 2/3 for the sphere.
    pub(crate) fn volume(&self, u: &[f64]) -> Result<f64, EvalError> {
        let volumes = self.halves().map(|half| energy::half_volume(&half, u));
        energy::check_volume(volumes[0] + volumes[1], u)
    }

    /// [`Self::volume`], and its gradient in `v`.
    fn volume_gradient(&self, u: &[f64], v: &mut [f64]) -> Result<f64, EvalError> {
        v.fill(0.0);
        let volumes = self.halves().map(|half| energy::add_volume_gradient(&half, u, v));
        energy::check_volume(volumes[0] + volumes[1], u)
    }

    /// The distance of the poles is that of a shell that does not pass through itself there.
    pub(crate) fn check_poles(&self, u: &[f64]) -> Result<(), EvalError> {
        let [top, bottom] = self.pole_heights(u);
        let value = top + bottom;
        if value > 0.0 {
            Ok(())
        } else {
            Err(EvalError::Inadmissible { what: POLES_MEET, at: 0, value })
        }
    }

    /// The gradient of the energy in `r`.
    pub(super) fn gradient(
        &self,
        u: &[f64],
        c: &[Coefficients; 2],
        gas: &Gas,
        r: &mut [f64],
    ) -> Result<(), EvalError> {
        let excess = gas.excess(0.5 * self.volume_gradient(u, r)?);
        r.iter_mut().for_each(|r| *r *= -excess);
        self.add_gradients(&c[0].material(self.shell.law), u, c, r)?;
        self.check_poles(u)
    }

    fn add_gradients(
        &self,
        law: &Shell,
        u: &[f64],
        [above, below]: &[Coefficients; 2],
        r: &mut [f64],
    ) -> Result<(), EvalError> {
        let ([top, bottom], (upper, lower)) = (self.halves(), &self.potentials);
        let gradient = gradients::Energy { law, film: upper, c: above };
        energy::add_gradient(&top, u, upper.wall(above), r, &gradient)?;
        let gradient = gradients::Energy { law, film: lower, c: below };
        energy::add_gradient(&bottom, u, lower.wall(below), r, &gradient)
    }

    /// The gradient of the energy in `r`, unless that is empty, and its Hessian in `j`.
    pub(super) fn gradient_and_hessian(
        &self,
        u: &[f64],
        c: &[Coefficients; 2],
        gas: &Gas,
        r: &mut [f64],
        j: &mut SymmetricBand,
    ) -> Result<(), EvalError> {
        j.set_zero();
        let (stiffness, v) = j.rank_one_mut();
        let half_volume = 0.5 * self.volume_gradient(u, v)?;
        *stiffness = 0.5 * gas.stiffness(half_volume);
        let excess = gas.excess(half_volume);
        r.iter_mut().zip(v).for_each(|(r, v)| *r = -excess * *v);
        let ([top, bottom], (upper, lower)) = (self.halves(), &self.potentials);
        let law = &c[0].material(self.shell.law);
        energy::add_linearisation(&top, u, law, upper, &c[0], excess, r, j)?;
        energy::add_linearisation(&bottom, u, law, lower, &c[1], excess, r, j)?;
        self.check_poles(u)
    }

    /// The derivative of the gradient by a parameter, `which`, that is `by` of either plate.
    pub(super) fn gradient_by(
        &self,
        u: &[f64],
        c: &[Coefficients; 2],
        gas: &Gas,
        by: &[Option<Variable>; 2],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let by_excess: Option<fn(&Gas, f64) -> f64> = match which {
            parameter::PRESSURE => Some(Gas::excess_by_ambient),
            parameter::SURFACE_TENSION => Some(Gas::excess_by_surface_tension),
            parameter::GAS_EXPONENT => Some(Gas::excess_by_exponent),
            _ => None,
        };
        if let Some(by_excess) = by_excess {
            let factor = -by_excess(gas, 0.5 * self.volume_gradient(u, out)?);
            out.iter_mut().for_each(|out| *out *= factor);
        } else {
            self.volume(u)?;
            out.fill(0.0);
        }
        let (halves, (upper, lower)) = (self.halves(), &self.potentials);
        let walls = self.walls(c);
        for (k, (half, c)) in halves.iter().zip(c).enumerate() {
            match (by[k], which) {
                (Some(by), _) if k == 0 => plate::add_gradient_by(half, upper, u, c, by, out)?,
                (Some(by), _) => plate::add_gradient_by(half, lower, u, c, by, out)?,
                (None, parameter::BENDING) => {
                    let gradient = gradients::Bending { poisson: c.poisson };
                    energy::add_gradient(half, u, walls[k], out, &gradient)?;
                }
                (None, parameter::SURFACE_TENSION) => {
                    energy::add_gradient(half, u, walls[k], out, &gradients::Area)?;
                }
                (None, parameter::POISSON) => {
                    self.add_gradient_by_constant(half, u, c, walls[k], Constant::Poisson, out)?;
                }
                (None, parameter::B) => {
                    self.add_gradient_by_constant(half, u, c, walls[k], Constant::MooneyB, out)?;
                }
                (None, _) => energy::is_clear(half, u, walls[k])?,
            }
        }
        self.check_poles(u)
    }

    /// Adds the derivative of a half's gradient by a constant of the material.
    fn add_gradient_by_constant(
        &self,
        half: &Half<'_>,
        u: &[f64],
        c: &Coefficients,
        wall: Wall,
        constant: Constant,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let gradient = gradients::Material { law: &c.material(self.shell.law), constant, c };
        energy::add_gradient(half, u, wall, out, &gradient)
    }

    /// `∂E/∂z_p` of the upper plate and of the lower, each away from the equator.
    pub(super) fn pulls(&self, u: &[f64], c: &[Coefficients; 2]) -> Result<[f64; 2], EvalError> {
        let ([top, bottom], (upper, lower)) = (self.halves(), &self.potentials);
        Ok([plate::pull(&top, upper, u, &c[0])?, plate::pull(&bottom, lower, u, &c[1])?])
    }

    /// Mean of the forces on both plates, in `√(χk_b)`.
    pub(super) fn mean_force_between(
        &self,
        u: &[f64],
        c: &[Coefficients; 2],
    ) -> Result<f64, EvalError> {
        let [top, bottom] = self.pulls(u, c)?;
        Ok(0.5 * plate::force_factor(c[0].bending) * (top + bottom))
    }

    /// The parts of the energy of the whole shell.
    pub(super) fn parts(&self, u: &[f64], c: &[Coefficients; 2]) -> Result<Parts<f64>, EvalError> {
        let ([top, bottom], (upper, lower)) = (self.halves(), &self.potentials);
        let volume = self.volume(u)?;
        let law = &c[0].material(self.shell.law);
        let a = energy::half_parts(&top, u, law, upper, &c[0])?;
        let b = energy::half_parts(&bottom, u, law, lower, &c[1])?;
        self.check_poles(u)?;
        Ok(Parts {
            stretching: a.stretching + b.stretching,
            bending: a.bending + b.bending,
            film: a.film + b.film,
            area: a.area + b.area,
            volume,
        })
    }

    /// Total potential energy of the shell, in `χR0²`: the `energy_total` that is reported.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn total_energy(&self, u: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        let (c, gas) = self.coefficients(u.len(), p)?;
        self.energy_between(u, &c, &gas)
    }

    /// [`Self::total_energy`] with plates at heights of their own.
    pub(super) fn energy_between(
        &self,
        u: &[f64],
        c: &[Coefficients; 2],
        gas: &Gas,
    ) -> Result<f64, EvalError> {
        let parts = self.parts(u, c)?;
        let elastic = parts.stretching + parts.bending + parts.film;
        let gas = 2.0 * gas.energy(0.5 * parts.volume);
        Ok(2.0 * PI * (elastic + gas + c[0].surface_tension * parts.area))
    }
}
