//! The shell from pole to pole between two plates, as a [`Problem`].
//!
//! Nothing is assumed to be a mirror image: an upper plate at `z = z0` and a lower one at `z = −z0`,
//! each with a potential, an adhesion and a film length of its own, act on the halves `S < π/2` and
//! `S > π/2` that face them,
//! ```text
//! E = E_top + E_bottom + 2 gas(V̂/2),   V̂ = V̂_top + V̂_bottom,   V̂ = ½∫_0^π σ²(−z') dS
//! ```
//! per `2π`, with `E_top` and `E_bottom` the integrals of module [`crate::energy`] over one half
//! each ([`Half`]). A state that is its own mirror image has exactly the numbers of
//! [`ContactProblem`](crate::ContactProblem); the price is a jump of the load at the equator of the
//! order of `w_int'(z0)`, below every tolerance while the film is thin.
//!
//! The shell may move as a whole between the plates: `w = const` is an admissible variation, and
//! in equilibrium both plates carry the same force. [`SupportedProblem`] holds the equator in the
//! mid-plane instead, or puts the upper plate on a spring. Among the axisymmetric variations those
//! that break the mirror symmetry are counted: the zero of their stiffness is a branch point here.
//! Modes `cos nφ` are those of [`crate::modes::WholeModes`]; cycles those of
//! [`crate::device::travel`], which begin at a [`stable_start`]. That a dimple touches anything but the
//! opposite pole is not noticed.
//!
//! ```
//! use continuation::{NewtonSettings, Problem, newton};
//! use shell_contact::two_plates::{Plate, TwoPlatesGroups, TwoPlatesProblem};
//! use shell_contact::{Law, Mesh, Shell};
//!
//! let plate = Plate { adhesion: 2e-3, film: 1.0 / 30.0 };
//! let groups = TwoPlatesGroups {
//!     bending: 3e-5,
//!     pressure: 3e-3,
//!     surface_tension: 0.0,
//!     gas_exponent: 1.07,
//!     top: plate,
//!     bottom: plate,
//! };
//! let shell = Shell { law: Law::Hooke, poisson: 0.5 };
//! let problem = TwoPlatesProblem::new(&shell, &groups, Mesh::uniform(50)?)?;
//! let (mut u, p) = (problem.initial_state(), problem.parameters_at(1.02));
//! newton(&problem, &mut u, &p, &NewtonSettings::default())?;
//! let seen = problem.observation(&u, &p)?;
//! assert!((seen.whole.force - seen.force_bottom).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(test)]
mod certify;
mod evaluate;
mod fork;
mod half;
mod loading;
mod observe;
mod pairs;
mod search;
mod supported;
mod symmetric;

pub use fork::{ForkError, follow_asymmetric, leave_symmetry};
pub use half::{Half, Side};
pub use loading::stable_start;
pub use observe::{NAMES, TwoPlatesObservation};
pub use pairs::{SpringPair, spring_pairs};
pub use search::{Unconnected, next_unconnected};
pub use supported::{Support, SupportedProblem};
pub use symmetric::{MirrorHalf, SymmetricBranch, trace_symmetric};

use crate::contact::{gas_and_material, gas_and_material_of};
use crate::density::Coefficients;
use crate::energy;
use crate::film::{Film, Potential, Wall};
use crate::meridian::{Mesh, add_mass};
use crate::params::{Dimensionless, ParameterError, Shell};
use crate::plate::Variable;
use crate::spline::{Component, HALF_BANDWIDTH};
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, Name, ParamId, Parameter, Problem, Stability};
use std::f64::consts::FRAC_PI_2;

/// Indices of the parameters in `p`.
pub mod parameter {
    use continuation::ParamId;

    /// Half the distance of the plates, `z0/R0`.
    pub const Z0: ParamId = ParamId(0);
    /// Bending stiffness `k_b/(χR0²)`.
    pub const BENDING: ParamId = ParamId(1);
    /// Ambient pressure `P_A R0/χ`.
    pub const PRESSURE: ParamId = ParamId(2);
    /// Surface tension `γ_BW/χ`.
    pub const SURFACE_TENSION: ParamId = ParamId(3);
    /// Adhesion `w0/χ` of the upper plate.
    pub const ADHESION_TOP: ParamId = ParamId(4);
    /// Film length `δ_A/R0` of the upper plate.
    pub const FILM_TOP: ParamId = ParamId(5);
    /// Adhesion `w0/χ` of the lower plate.
    pub const ADHESION_BOTTOM: ParamId = ParamId(6);
    /// Film length `δ_A/R0` of the lower plate.
    pub const FILM_BOTTOM: ParamId = ParamId(7);
    /// Exponent of the gas `γ`.
    pub const GAS_EXPONENT: ParamId = ParamId(8);
    /// Poisson's ratio `ν`.
    pub const POISSON: ParamId = ParamId(9);
    /// The share `b` of Mooney and Rivlin's law, for a shell of that law.
    pub const B: ParamId = ParamId(10);
}

/// What is in front of one plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plate {
    /// Adhesion `w0/χ`, the depth of the potential; with zero the plate is not there.
    pub adhesion: f64,
    /// Film length `δ_A/R0`, positive.
    pub film: f64,
}

/// The dimensionless groups of Eq. (21a), with a film for each plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoPlatesGroups {
    /// Bending stiffness `k_b/(χR0²)`.
    pub bending: f64,
    /// Ambient pressure `P_A R0/χ`.
    pub pressure: f64,
    /// Surface tension `γ_BW/χ`.
    pub surface_tension: f64,
    /// Gas exponent `γ`: 0 is constant pressure, 1 isothermal.
    pub gas_exponent: f64,
    /// The upper plate.
    pub top: Plate,
    /// The lower plate.
    pub bottom: Plate,
}

impl TwoPlatesGroups {
    /// Those of a shell between two equal plates.
    pub fn equal(groups: &Dimensionless) -> TwoPlatesGroups {
        let plate = Plate { adhesion: groups.adhesion, film: groups.film };
        TwoPlatesGroups {
            bending: groups.bending,
            pressure: groups.pressure,
            surface_tension: groups.surface_tension,
            gas_exponent: groups.gas_exponent,
            top: plate,
            bottom: plate,
        }
    }

    /// Checks every group.
    ///
    /// # Errors
    /// Names the first that is outside what the model allows; of the plates as `plate.top.film`.
    pub fn validate(&self) -> Result<(), ParameterError> {
        for (plate, keys) in [
            (self.top, ["plate.top.adhesion", "plate.top.film"]),
            (self.bottom, ["plate.bottom.adhesion", "plate.bottom.film"]),
        ] {
            let groups = Dimensionless {
                bending: self.bending,
                pressure: self.pressure,
                adhesion: plate.adhesion,
                film: plate.film,
                surface_tension: self.surface_tension,
                gas_exponent: self.gas_exponent,
            };
            groups.validate().map_err(|error| error.renamed(["adhesion", "film"], keys))?;
        }
        Ok(())
    }
}

/// A coated bubble between two plates at `±z0`, free to move between them.
#[derive(Debug, Clone)]
pub struct TwoPlatesProblem {
    mesh: Mesh,
    pub(crate) shell: Shell,
    pub(crate) potentials: (Film, Film),
    groups: TwoPlatesGroups,
    parameters: Vec<Parameter>,
    mass: SymmetricBand,
}

impl TwoPlatesProblem {
    /// The problem with the potential of Eq. (13a) at both plates; `mesh` is that of either half.
    ///
    /// # Errors
    /// Names the first parameter that is outside what the model allows.
    pub fn new(
        shell: &Shell,
        groups: &TwoPlatesGroups,
        mesh: Mesh,
    ) -> Result<TwoPlatesProblem, ParameterError> {
        TwoPlatesProblem::with_potentials(shell, groups, mesh, (Film::FourTwo, Film::FourTwo))
    }
}

impl TwoPlatesProblem {
    /// The problem with other potentials, of the upper plate and of the lower.
    ///
    /// # Errors
    /// Names the first parameter that is outside what the model allows.
    pub fn with_potentials(
        shell: &Shell,
        groups: &TwoPlatesGroups,
        mesh: Mesh,
        potentials: (Film, Film),
    ) -> Result<TwoPlatesProblem, ParameterError> {
        shell.validate()?;
        groups.validate()?;
        let scale = |value: f64, otherwise: f64| if value > 0.0 { value } else { otherwise };
        let parameter = Parameter::new;
        let own = [
            parameter("z0", "R0", 1.0),
            parameter("bending", "chi R0^2", groups.bending),
            parameter("pressure", "chi/R0", scale(groups.pressure, 1.0)),
            parameter("surface_tension", "chi", scale(groups.surface_tension, 1e-2)),
            parameter("adhesion_top", "chi", scale(groups.top.adhesion, 1e-3)),
            parameter("film_top", "R0", groups.top.film),
            parameter("adhesion_bottom", "chi", scale(groups.bottom.adhesion, 1e-3)),
            parameter("film_bottom", "R0", groups.bottom.film),
        ];
        let parameters = own.into_iter().chain(gas_and_material(shell.law)).collect();
        let unknowns = Half::unknowns(&mesh);
        let mut mass = SymmetricBand::new(unknowns, HALF_BANDWIDTH);
        for side in Side::BOTH {
            // half of either: a step is as long as in the half model
            add_mass(&Half::new(&mesh, side), 0.5, &mut mass);
        }
        let (shell, groups) = (*shell, *groups);
        Ok(TwoPlatesProblem { mesh, shell, potentials, groups, parameters, mass })
    }

    /// The unstressed sphere: an equilibrium when there is no film.
    pub fn initial_state(&self) -> Vec<f64> {
        vec![0.0; Half::unknowns(&self.mesh)]
    }

    /// The case's parameters with the plates at `±z0`, in the order of [`Problem::parameters`].
    pub fn parameters_at(&self, z0: f64) -> Vec<f64> {
        let g = &self.groups;
        let (top, bottom) = (g.top, g.bottom);
        let own = [
            z0,
            g.bending,
            g.pressure,
            g.surface_tension,
            top.adhesion,
            top.film,
            bottom.adhesion,
            bottom.film,
        ];
        own.into_iter().chain(gas_and_material_of(g.gas_exponent, &self.shell)).collect()
    }

    /// The mesh of either half.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The shell's material.
    pub fn shell(&self) -> &Shell {
        &self.shell
    }

    /// The dimensionless groups of the case.
    pub fn groups(&self) -> &TwoPlatesGroups {
        &self.groups
    }

    /// Whether the shell stays on its side of plates and axis and its poles apart: what an
    /// evaluation would refuse, at a fraction of its cost.
    ///
    /// # Errors
    /// Says what is violated.
    pub fn admissible(&self, u: &[f64], p: &[f64]) -> Result<(), EvalError> {
        let (c, _) = self.coefficients(u.len(), p)?;
        self.admissible_between(u, &c)
    }

    /// [`Self::admissible`] with plates at heights of their own.
    pub(crate) fn admissible_between(
        &self,
        u: &[f64],
        c: &[Coefficients; 2],
    ) -> Result<(), EvalError> {
        self.volume(u)?;
        for (half, wall) in self.halves().iter().zip(self.walls(c)) {
            energy::is_clear(half, u, wall)?;
        }
        self.check_poles(u)
    }

    /// What either half must stay clear of.
    pub(crate) fn walls(&self, [above, below]: &[Coefficients; 2]) -> [Wall; 2] {
        [self.potentials.0.wall(above), self.potentials.1.wall(below)]
    }

    /// The state whose upper half is that of `top` and whose lower half is the mirror image of that
    /// of `bottom`, both states of a [`ContactProblem`](crate::ContactProblem) on the same mesh,
    /// moved upwards by `shift`. Two equal ones without a shift are a state of this problem where
    /// they are one of that; two states of equal force at different plates nearly are, at half the
    /// sum of the distances and with a shift of half the difference, bottom minus top. Where their
    /// radii and slopes at the equator differ each is stretched half the way to the other, by
    /// `α sin³S` and `−β sin⁴S cos S`: a kink would cost more energy than the rest, and this leaves
    /// the thin films at the poles as they are.
    pub fn joined(&self, top: &[f64], bottom: &[f64], shift: f64) -> Vec<f64> {
        let knots = self.mesh.knots();
        let n = self.mesh.elements();
        let equator = |state| {
            let d = self.mesh.displacement_in(state, n - 1, FRAC_PI_2);
            (d[0].0, d[1].1)
        };
        let ends = [equator(top), equator(bottom)];
        let difference = (ends[1].0 - ends[0].0, ends[1].1 - ends[0].1);
        let mut out = self.initial_state();
        for ((half, state), towards) in self.halves().iter().zip([top, bottom]).zip([0.5, -0.5]) {
            for j in 0..=n {
                // the equator belongs to both
                let share = if j == n { 0.5 } else { 1.0 };
                let (sin, cos) = knots.at(j).sin_cos();
                let stretch = (
                    towards * difference.0 * sin.powi(3),
                    -towards * difference.1 * cos * sin.powi(4),
                );
                for (component, stretch, lift) in
                    [(Component::U, stretch.0, 0.0), (Component::W, stretch.1, shift)]
                {
                    let Some((i, sign)) = half.slot(component, j as isize) else { continue };
                    let own = knots.slot(component, j as isize).and_then(|(k, _)| state.get(k));
                    out[i] += share * (sign * (own.copied().unwrap_or(0.0) + stretch) + lift);
                }
            }
        }
        out
    }

    /// A state moved upwards as a whole.
    pub(crate) fn lifted(&self, mut u: Vec<f64>, by: f64) -> Vec<f64> {
        let [top, _] = self.halves();
        for j in 0..=2 * self.mesh.elements() as isize {
            if let Some(w) = top.slot(Component::W, j).and_then(|(i, _)| u.get_mut(i)) {
                *w += by;
            }
        }
        u
    }

    /// The mirror image of a state: what was above is below.
    pub fn reflected(&self, u: &[f64]) -> Vec<f64> {
        let [top, bottom] = self.halves();
        let mut out = self.initial_state();
        for j in 0..=2 * self.mesh.elements() as isize {
            for component in [Component::U, Component::W] {
                // coefficient j from one pole becomes that from the other
                let places = top.slot(component, j).zip(bottom.slot(component, j));
                if let Some(((i, a), (k, b))) = places {
                    out[i] = a * b * u[k];
                }
            }
        }
        out
    }
}

impl Problem for TwoPlatesProblem {
    type Jacobian = SymmetricBand;

    fn dim(&self) -> usize {
        Half::unknowns(&self.mesh)
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.dim(), HALF_BANDWIDTH)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let (c, gas) = self.coefficients(u.len(), p)?;
        self.gradient(u, &c, &gas, r)
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
        let (c, gas) = self.coefficients(u.len(), p)?;
        self.gradient_and_hessian(u, &c, &gas, r, j)
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let (c, gas) = self.coefficients(u.len(), p)?;
        self.gradient_by(u, &c, &gas, &variables(which), which, out)
    }

    /// Half of `∫_0^π(u² + w²) sin S dS`: on a mirror-symmetric branch a step is as long as that of
    /// the half model.
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.mass.mul(x, y);
    }

    /// Displacements and plate distance are lengths in `R0`.
    fn unknown_scale(&self, which: ParamId) -> Option<f64> {
        (which == parameter::Z0).then_some(1.0)
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    fn observables(&self) -> &[Name] {
        &observe::OBSERVABLES
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
        let (c, gas) = self.coefficients(u.len(), p)?;
        let moved = variables(which).map(|by| by.map(|variable| (variable, dp)));
        self.slope(k, (u, du), &c, &gas, moved, (which, dp))
    }
}

/// What of either plate's film a parameter is, if it is.
fn variables(which: ParamId) -> [Option<Variable>; 2] {
    match which {
        parameter::Z0 => [Some(Variable::Height); 2],
        parameter::ADHESION_TOP => [Some(Variable::Adhesion), None],
        parameter::FILM_TOP => [Some(Variable::Length), None],
        parameter::ADHESION_BOTTOM => [None, Some(Variable::Adhesion)],
        parameter::FILM_BOTTOM => [None, Some(Variable::Length)],
        _ => [None; 2],
    }
}
