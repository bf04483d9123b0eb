//! Contact of the shell with a plate at given distance, as a [`Problem`].
//!
//! Unknowns: spline coefficients of the displacement (module [`crate::spline`]); residual: gradient
//! of the total potential energy of the half shell over `2π`; Jacobian: its Hessian. The number of
//! negative eigenvalues is the number of unstable modes at fixed plate distance.

use crate::density::Coefficients;
use crate::energy::{self, gradients};
use crate::film::{Film, Potential};
use crate::gas::Gas;
use crate::membrane::Constant;
use crate::meridian::Mesh;
use crate::observables::{self, Observation};
use crate::params::{Dimensionless, Law, ParameterError, Shell};
use crate::plate::{self, Variable};
use crate::spline::HALF_BANDWIDTH;
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, Name, ParamId, Parameter, Problem, Stability};
use std::f64::consts::PI;

/// Indices of the parameters in `p`.
pub mod parameter {
    use continuation::ParamId;

    /// Height of the plate above the equator, `z0/R0`.
    pub const Z0: ParamId = ParamId(0);
    /// Adhesion `w0/χ`.
    pub const ADHESION: ParamId = ParamId(1);
    /// Bending stiffness `k_b/(χR0²)`.
    pub const BENDING: ParamId = ParamId(2);
    /// Ambient pressure `P_A R0/χ`.
    pub const PRESSURE: ParamId = ParamId(3);
    /// Film length `δ_A/R0`.
    pub const FILM: ParamId = ParamId(4);
    /// Surface tension `γ_BW/χ`.
    pub const SURFACE_TENSION: ParamId = ParamId(5);
    /// Exponent of the gas `γ`.
    pub const GAS_EXPONENT: ParamId = ParamId(6);
    /// Poisson's ratio `ν`.
    pub const POISSON: ParamId = ParamId(7);
    /// The share `b` of Mooney and Rivlin's law, for a shell of that law.
    pub const B: ParamId = ParamId(8);
    /// How many there are at most.
    pub const COUNT: usize = 9;
}

/// What of the plate's film a parameter is, if it is.
pub(crate) fn variable(which: ParamId) -> Option<Variable> {
    match which {
        parameter::Z0 => Some(Variable::Height),
        parameter::ADHESION => Some(Variable::Adhesion),
        parameter::FILM => Some(Variable::Length),
        _ => None,
    }
}

/// What constant of the material a parameter is, if it is.
pub(crate) fn constant(which: ParamId) -> Option<Constant> {
    match which {
        parameter::POISSON => Some(Constant::Poisson),
        parameter::B => Some(Constant::MooneyB),
        _ => None,
    }
}

/// The parameters of gas and material, which problems with plates have in common; `b` is the last, and
/// is there for a law that has it.
pub(crate) fn gas_and_material(law: Law) -> impl Iterator<Item = Parameter> {
    let parameter = |name, scale| Parameter::new(name, "", scale);
    let b = law.b().map(|_| parameter("b", 1.0));
    [parameter("gas_exponent", 1.0), parameter("poisson", 0.5)].into_iter().chain(b)
}

/// Their values in a case.
pub(crate) fn gas_and_material_of(exponent: f64, shell: &Shell) -> impl Iterator<Item = f64> {
    [exponent, shell.poisson].into_iter().chain(shell.law.b())
}

/// Beyond it the bending energy has no lower bound, nor has a membrane's. Exponents and `b` have no such
/// limit: differences in them may step over the ends of what a case may say.
pub(crate) const POISSON_RATIO: &str = "Poisson's ratio is not between -1 and 1";

/// A coated bubble between two plates, with a film's interaction potential.
#[derive(Debug, Clone)]
pub struct ContactProblem {
    pub(crate) mesh: Mesh,
    pub(crate) shell: Shell,
    pub(crate) potential: Film,
    groups: Dimensionless,
    parameters: Vec<Parameter>,
}

impl ContactProblem {
    /// The problem with the potential of Eq. (13a).
    ///
    /// # Errors
    /// Names the first parameter that is outside what the model allows.
    pub fn new(
        shell: &Shell,
        groups: &Dimensionless,
        mesh: Mesh,
    ) -> Result<ContactProblem, ParameterError> {
        ContactProblem::with_potential(shell, groups, mesh, Film::FourTwo)
    }
}

impl ContactProblem {
    /// The problem with another potential.
    ///
    /// # Errors
    /// Names the first parameter that is outside what the model allows.
    pub fn with_potential(
        shell: &Shell,
        groups: &Dimensionless,
        mesh: Mesh,
        potential: Film,
    ) -> Result<ContactProblem, ParameterError> {
        shell.validate()?;
        groups.validate()?;
        let scale = |value: f64, otherwise: f64| if value > 0.0 { value } else { otherwise };
        let parameter = Parameter::new;
        let own = [
            parameter("z0", "R0", 1.0),
            parameter("adhesion", "chi", scale(groups.adhesion, 1e-3)),
            parameter("bending", "chi R0^2", groups.bending),
            parameter("pressure", "chi/R0", scale(groups.pressure, 1.0)),
            parameter("film", "R0", groups.film),
            parameter("surface_tension", "chi", scale(groups.surface_tension, 1e-2)),
        ];
        let parameters = own.into_iter().chain(gas_and_material(shell.law)).collect();
        Ok(ContactProblem { mesh, shell: *shell, potential, groups: *groups, parameters })
    }

    /// The unstressed sphere: an equilibrium when there is no film.
    pub fn initial_state(&self) -> Vec<f64> {
        vec![0.0; self.mesh.unknowns()]
    }

    /// The case's parameters with the plate at `z0`, in the order of [`Problem::parameters`].
    pub fn parameters_at(&self, z0: f64) -> Vec<f64> {
        let g = &self.groups;
        let own = [z0, g.adhesion, g.bending, g.pressure, g.film, g.surface_tension];
        own.into_iter().chain(gas_and_material_of(g.gas_exponent, &self.shell)).collect()
    }

    /// The potential of the film.
    pub fn film(&self) -> Film {
        self.potential
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The shell's material.
    pub fn shell(&self) -> &Shell {
        &self.shell
    }

    /// The dimensionless groups of the case.
    pub fn groups(&self) -> &Dimensionless {
        &self.groups
    }

    /// Whether the shell stays on its side of plate, axis and equator: what an evaluation would
    /// refuse, at a fraction of its cost.
    ///
    /// # Errors
    /// Says what is violated.
    pub fn admissible(&self, u: &[f64], p: &[f64]) -> Result<(), EvalError> {
        let (c, _) = self.coefficients(u, p)?;
        energy::admissible(&self.mesh, u, self.potential.wall(&c))
    }

    /// Everything that is reported of a state.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn observation(&self, u: &[f64], p: &[f64]) -> Result<Observation, EvalError> {
        observables::observe(self, u, p)
    }

    /// The numbers of the density and the gas, from the values in `p`.
    pub(crate) fn coefficients(
        &self,
        u: &[f64],
        p: &[f64],
    ) -> Result<(Coefficients, Gas), EvalError> {
        let known = self.parameters.len();
        if let Some(at) = (0..known).find(|&i| !p.get(i).is_some_and(|x| x.is_finite())) {
            return Err(EvalError::NotFinite { at: u.len() + at });
        }
        let [plate, adhesion, bending, ambient, film, surface_tension, exponent, poisson, b]: [f64;
            parameter::COUNT] = std::array::from_fn(|i| p.get(i).copied().unwrap_or(f64::NAN));
        let bad = |what, ParamId(i): ParamId, value| {
            Err(EvalError::Inadmissible { what, at: u.len() + i, value })
        };
        if bending <= 0.0 {
            return bad("the bending stiffness is not positive", parameter::BENDING, bending);
        }
        if film <= 0.0 {
            return bad("the film length is not positive", parameter::FILM, film);
        }
        if poisson.abs() >= 1.0 {
            return bad(POISSON_RATIO, parameter::POISSON, poisson);
        }
        let c = Coefficients { bending, poisson, b, surface_tension, adhesion, film, plate };
        Ok((c, Gas { ambient, surface_tension, exponent }))
    }

    /// Hessian, and gradient unless `r` is empty.
    fn linearise_as(
        &self,
        law: &Shell,
        u: &[f64],
        (c, gas): (&Coefficients, &Gas),
        r: &mut [f64],
        j: &mut SymmetricBand,
    ) -> Result<(), EvalError> {
        j.set_zero();
        let (stiffness, v) = j.rank_one_mut();
        let volume = energy::volume_gradient(&self.mesh, u, v)?;
        *stiffness = gas.stiffness(volume);
        let excess = gas.excess(volume);
        for (r, v) in r.iter_mut().zip(v) {
            *r = -excess * *v;
        }
        energy::add_linearisation(&self.mesh, u, law, &self.potential, c, excess, r, j)
    }

    fn residual_as(
        &self,
        law: &Shell,
        u: &[f64],
        (c, gas): (&Coefficients, &Gas),
        r: &mut [f64],
    ) -> Result<(), EvalError> {
        let volume = energy::volume_gradient(&self.mesh, u, r)?;
        let excess = gas.excess(volume);
        for r in r.iter_mut() {
            *r *= -excess;
        }
        let film = &self.potential;
        energy::add_gradient(&self.mesh, u, film.wall(c), r, &gradients::Energy { law, film, c })
    }
}

impl Problem for ContactProblem {
    type Jacobian = SymmetricBand;

    fn dim(&self) -> usize {
        self.mesh.unknowns()
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.dim(), HALF_BANDWIDTH)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let (c, gas) = self.coefficients(u, p)?;
        self.residual_as(&c.material(self.shell.law), u, (&c, &gas), r)
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        self.linearise(u, p, &mut [], j)
    }

    fn linearise(
        &self,
        u: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut SymmetricBand,
    ) -> Result<(), EvalError> {
        let (c, gas) = self.coefficients(u, p)?;
        self.linearise_as(&c.material(self.shell.law), u, (&c, &gas), r, j)
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let (c, gas) = self.coefficients(u, p)?;
        let mesh = &self.mesh;
        let film = &self.potential;
        let by_excess: Option<fn(&Gas, f64) -> f64> = match which {
            parameter::PRESSURE => Some(Gas::excess_by_ambient),
            parameter::SURFACE_TENSION => Some(Gas::excess_by_surface_tension),
            parameter::GAS_EXPONENT => Some(Gas::excess_by_exponent),
            _ => None,
        };
        if let Some(by_excess) = by_excess {
            let factor = -by_excess(&gas, energy::volume_gradient(mesh, u, out)?);
            out.iter_mut().for_each(|out| *out *= factor);
        } else {
            energy::volume(mesh, u)?;
            out.fill(0.0);
        }
        if let Some(variable) = variable(which) {
            return plate::add_gradient_by(mesh, film, u, &c, variable, out);
        }
        if let Some(constant) = constant(which) {
            let law = &c.material(self.shell.law);
            let gradient = gradients::Material { law, constant, c: &c };
            return energy::add_gradient(mesh, u, film.wall(&c), out, &gradient);
        }
        match which {
            parameter::BENDING => {
                let gradient = gradients::Bending { poisson: c.poisson };
                energy::add_gradient(mesh, u, film.wall(&c), out, &gradient)
            }
            parameter::SURFACE_TENSION => {
                energy::add_gradient(mesh, u, film.wall(&c), out, &gradients::Area)
            }
            _ => energy::admissible(mesh, u, film.wall(&c)),
        }
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.mesh.mass().mul(x, y);
    }

    /// Displacements and plate distance are lengths in `R0`.
    fn unknown_scale(&self, which: ParamId) -> Option<f64> {
        (which == parameter::Z0).then_some(1.0)
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    fn observables(&self) -> &[Name] {
        &observables::OBSERVABLES
    }

    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let values = self.observation(u, p)?.to_array();
        for (out, value) in out.iter_mut().zip(values) {
            *out = value;
        }
        Ok(())
    }

    fn observable_slope(
        &self,
        k: usize,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        du: &[f64],
        dp: f64,
    ) -> Result<Option<f64>, EvalError> {
        let (c, gas) = self.coefficients(u, p)?;
        let volume_slope = || energy::volume_along(&self.mesh, u, du, self.potential.wall(&c));
        match observables::NAMES.get(k).copied() {
            Some("force") => {
                let (mesh, film) = (&self.mesh, &self.potential);
                let by = variable(which).map(|variable| (variable, dp));
                let mut slope = plate::pull_along(mesh, film, u, &c, du, by)?;
                if which == parameter::BENDING {
                    slope -= 0.5 * plate::pull(mesh, film, u, &c)? * dp / c.bending;
                }
                Ok(Some(plate::force_factor(c.bending) * slope))
            }
            Some("pole_height") => Ok(Some(self.mesh.displacement_in(du, 0, 0.0)[0].1)),
            Some("volume") => Ok(Some(4.0 * PI * volume_slope()?)),
            Some("gas_pressure") => {
                let volume = energy::volume(&self.mesh, u)?;
                let direct = match which {
                    parameter::PRESSURE => 1.0 + gas.excess_by_ambient(volume),
                    parameter::SURFACE_TENSION => gas.excess_by_surface_tension(volume),
                    parameter::GAS_EXPONENT => gas.excess_by_exponent(volume),
                    _ => 0.0,
                };
                Ok(Some(direct * dp - gas.stiffness(volume) * volume_slope()?))
            }
            _ => Ok(None),
        }
    }
}
