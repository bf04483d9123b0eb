//! The contact problem as the plate sees it: energy, pull and stiffness.

use super::{Device, Loading};
use crate::contact::{ContactProblem, parameter, variable};
use crate::energy;
use crate::film::Potential;
use crate::plate;
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, ParamId};
use std::f64::consts::PI;

impl ContactProblem {
    /// Total potential energy of the whole shell, in `χR0²`: the `energy_total` that is reported.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn total_energy(&self, u: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        let (c, gas) = self.coefficients(u, p)?;
        let (mesh, film) = (&self.mesh, &self.potential);
        let parts = energy::parts(mesh, u, &c.material(self.shell.law), film, &c)?;
        let elastic = parts.stretching + parts.bending + parts.film;
        Ok(4.0 * PI * (elastic + gas.energy(parts.volume) + c.surface_tension * parts.area))
    }

    /// `∂E/∂z_p` of the half shell over `2π`; the reported force is `−2π/√k_b` times it.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn plate_pull(&self, u: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        let (c, _) = self.coefficients(u, p)?;
        plate::pull(&self.mesh, &self.potential, u, &c)
    }

    /// Partial derivative of [`Self::plate_pull`] by a parameter at a fixed shell; by `z0` it is the
    /// corner of the bordered Hessian.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn plate_pull_by(&self, u: &[f64], p: &[f64], which: ParamId) -> Result<f64, EvalError> {
        let (c, _) = self.coefficients(u, p)?;
        match variable(which) {
            Some(variable) => plate::pull_by(&self.mesh, &self.potential, u, &c, variable),
            None => energy::admissible(&self.mesh, u, self.potential.wall(&c)).map(|()| 0.0),
        }
    }

    /// The parameters of this problem with other values of all but the first, and the plate at
    /// `z0`; NaN for those that are missing, which is refused wherever they are used.
    pub(crate) fn with_plate(p: &[f64], z0: f64) -> [f64; parameter::COUNT] {
        let mut all = [f64::NAN; parameter::COUNT];
        for (to, from) in all.iter_mut().zip(p) {
            *to = *from;
        }
        all[parameter::Z0.0] = z0;
        all
    }
}

impl Loading for ContactProblem {
    fn device(&self) -> Device {
        Device::Grip
    }

    fn parameters_at(&self, value: f64) -> Vec<f64> {
        ContactProblem::parameters_at(self, value)
    }

    fn plate(&self, _: &[f64], p: &[f64]) -> f64 {
        p[parameter::Z0.0]
    }

    fn mean_force(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        Ok(-2.0 * PI / p[parameter::BENDING.0].sqrt() * self.plate_pull(x, p)?)
    }

    fn energy(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        self.total_energy(x, p)
    }

    fn root(&self, p: &[f64]) -> f64 {
        p[parameter::BENDING.0].sqrt()
    }

    fn shell_part<'x>(&self, x: &'x [f64]) -> &'x [f64] {
        x
    }

    fn add_drag(&self, a: f64, h: &mut SymmetricBand) {
        h.axpy(a, self.mesh.mass());
    }
}
