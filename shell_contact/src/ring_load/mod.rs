//! A ring load that flattens the shell where it touches it, as a [`Problem`]; Eq. (27) after
//! Updike and Kalnins.
//!
//! The plate touches the shell along a ring of material points `S_L = α` only, where the meridian is
//! level: potential energy `+ Q z(S_L)`, constraint `z'(S_L) = 0` (27c), continued in the contact
//! angle `α`. Unknowns: spline coefficients `x` of the displacement on a mesh that moves with the
//! ring, and `q = Q/k_b`, `Q` the ring's force per `2π`. The Jacobian `[K f; cᵀ 0]`, `f =
//! ∂z(S_L)/∂x`, `c = ∂z'(S_L)/∂x`, has its folds in `α`; stability is that at fixed height of the
//! ring, the inertia of `[K f; fᵀ 0]`.
//!
//! The flat state inside the ring gives way to a dimple by a pitchfork that the curvature of the
//! reference sphere unfolds slightly. A moment `m` at the ring (residual `+ m c`) unfolds it too:
//! the fold curve in `(α, m)` has the cusp that organises both.

#[cfg(test)]
mod certify;
mod mesh;
mod moving;
mod observe;

pub use mesh::DEFAULT_GRADING;
pub use observe::{NAMES, RingObservation, RingProfile};

use crate::contact::{POISSON_RATIO, gas_and_material, gas_and_material_of};
use crate::density::Coefficients;
use crate::energy::{self, gradients};
use crate::film::NoFilm;
use crate::gas::Gas;
use crate::membrane::Constant;
use crate::meridian::Mesh;
use crate::params::{ParameterError, Shell};
use crate::spline::HALF_BANDWIDTH;
use continuation::linalg::{Arrow, SymmetricBand};
use continuation::{EvalError, Matrix, Name, ParamId, Parameter, Problem, Stability};
use mesh::{LEAST_ANGLE, Layout};
use moving::{AtRing, Moving, MovingMesh};
use std::f64::consts::FRAC_PI_2;

/// Indices of the parameters in `p`.
pub mod parameter {
    use continuation::ParamId;

    /// Contact angle `α`, in radians.
    pub const ALPHA: ParamId = ParamId(0);
    /// Moment at the ring per `2π`, in `χR0²`.
    pub const MOMENT: ParamId = ParamId(1);
    /// Bending stiffness `k_b/(χR0²)`.
    pub const BENDING: ParamId = ParamId(2);
    /// Ambient pressure `P_A R0/χ`.
    pub const PRESSURE: ParamId = ParamId(3);
    /// Gas exponent.
    pub const GAS_EXPONENT: ParamId = ParamId(4);
    /// Poisson's ratio `ν`.
    pub const POISSON: ParamId = ParamId(5);
    /// The share `b` of Mooney and Rivlin's law, for a shell of that law.
    pub const B: ParamId = ParamId(6);
    /// How many there are at most.
    pub const COUNT: usize = 7;
}

/// The contact angle for which the mesh is made, and at which lengths are measured.
const NOMINAL: f64 = std::f64::consts::PI / 18.0;
/// Typical moment in units of `k_b`: a tenth of what bends the shell by its own curvature.
const MOMENT_SCALE: f64 = 0.1;

/// The dimensionless groups of a ring-loaded shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingGroups {
    /// Bending stiffness `k_b/(χR0²)`.
    pub bending: f64,
    /// Ambient pressure `P_A R0/χ`; of no effect at gas exponent 0.
    pub pressure: f64,
    /// Gas exponent: 0 is a gas at constant pressure.
    pub gas_exponent: f64,
}

/// A shell squeezed by rings.
#[derive(Debug, Clone)]
pub struct RingLoadProblem {
    shell: Shell,
    groups: RingGroups,
    parameters: Vec<Parameter>,
    coefficients: usize,
    mass: SymmetricBand,
    moving: Moving,
}

/// The values of the parameters, checked.
struct Values {
    alpha: f64,
    moment: f64,
    c: Coefficients,
    gas: Gas,
}

/// What stands in the last row of the bordered matrix.
#[derive(Clone, Copy, PartialEq)]
enum Row {
    /// The constraint (27c): the Jacobian.
    Level,
    /// The ring's height: the Hessian at fixed height.
    Height,
}

impl RingLoadProblem {
    /// The problem on a mesh of `elements`, three tenths of them inside the ring; elements at the
    /// equator are `grading` times as long as those at the ring ([`DEFAULT_GRADING`]).
    ///
    /// # Errors
    /// Names the first parameter that is outside what the model allows.
    pub fn new(
        shell: &Shell,
        groups: &RingGroups,
        elements: usize,
        grading: f64,
    ) -> Result<RingLoadProblem, ParameterError> {
        shell.validate()?;
        let refuse = |key, value, allowed| {
            Err(ParameterError::OutOfRange { key, value, allowed, remedy: "check its unit" })
        };
        let RingGroups { bending, pressure, gas_exponent } = *groups;
        if !(bending > 0.0 && bending.is_finite()) {
            return refuse("bending", bending, "greater than 0");
        }
        if !(pressure >= 0.0 && pressure.is_finite()) {
            return refuse("pressure", pressure, "0 or greater");
        }
        if !(gas_exponent >= 0.0 && gas_exponent.is_finite()) {
            return refuse("gas_exponent", gas_exponent, "0 or greater");
        }
        let mut moving = MovingMesh::new(Layout::new(elements, grading)?, NOMINAL);
        let (mesh, _) = moving.at(NOMINAL);
        let (coefficients, mass) = (mesh.unknowns(), mesh.mass().clone());
        let own = [
            Parameter::new("alpha", "rad", NOMINAL),
            Parameter::new("moment", "chi R0^2", MOMENT_SCALE * bending),
            Parameter::new("bending", "chi R0^2", bending),
            Parameter::new("pressure", "chi/R0", if pressure > 0.0 { pressure } else { 1.0 }),
        ];
        Ok(RingLoadProblem {
            shell: *shell,
            groups: *groups,
            parameters: own.into_iter().chain(gas_and_material(shell.law)).collect(),
            coefficients,
            mass,
            moving: Moving::new(moving),
        })
    }

    /// The unstressed sphere, from which Newton's method finds the flat state.
    pub fn initial_state(&self) -> Vec<f64> {
        vec![0.0; self.dim()]
    }

    /// The case's parameters at a contact angle in radians, in the order of
    /// [`Problem::parameters`]; no moment.
    pub fn parameters_at(&self, alpha: f64) -> Vec<f64> {
        let g = &self.groups;
        let own = [alpha, 0.0, g.bending, g.pressure];
        own.into_iter().chain(gas_and_material_of(g.gas_exponent, &self.shell)).collect()
    }

    /// The shell's material.
    pub fn shell(&self) -> &Shell {
        &self.shell
    }

    /// The dimensionless groups of the case.
    pub fn groups(&self) -> &RingGroups {
        &self.groups
    }

    fn values(&self, u: &[f64], p: &[f64]) -> Result<Values, EvalError> {
        let known = self.parameters.len();
        if let Some(at) = (0..known).find(|&i| !p.get(i).is_some_and(|x| x.is_finite())) {
            return Err(EvalError::NotFinite { at: u.len() + at });
        }
        let [alpha, moment, bending, ambient, exponent, poisson, b]: [f64; parameter::COUNT] =
            std::array::from_fn(|i| p.get(i).copied().unwrap_or(f64::NAN));
        let bad = |what, ParamId(i): ParamId, value| {
            Err(EvalError::Inadmissible { what, at: u.len() + i, value })
        };
        if !(LEAST_ANGLE..=FRAC_PI_2 - LEAST_ANGLE).contains(&alpha) {
            return bad("the ring is not between pole and equator", parameter::ALPHA, alpha);
        }
        if bending <= 0.0 {
            return bad("the bending stiffness is not positive", parameter::BENDING, bending);
        }
        if poisson.abs() >= 1.0 {
            return bad(POISSON_RATIO, parameter::POISSON, poisson);
        }
        let c = Coefficients {
            bending,
            poisson,
            b,
            surface_tension: 0.0,
            adhesion: 0.0,
            film: 1.0,
            plate: f64::INFINITY,
        };
        Ok(Values { alpha, moment, c, gas: Gas { ambient, surface_tension: 0.0, exponent } })
    }

    /// The shell with the material of these values.
    fn material(&self, values: &Values) -> Shell {
        values.c.material(self.shell.law)
    }

    /// The matrix, and the gradient unless `r` is empty.
    fn assemble(
        &self,
        law: &Shell,
        (u, values): (&[f64], &Values),
        r: &mut [f64],
        j: &mut Arrow<SymmetricBand>,
        row: Row,
    ) -> Result<(), EvalError> {
        let Values { alpha, moment, c, gas } = values;
        let mut moving = self.moving.lock();
        let (mesh, ring) = moving.at(*alpha);
        let (x, q) = u.split_at(self.coefficients);
        let (out, _) = r.split_at_mut(r.len().min(self.coefficients));
        j.set_zero();
        let (stiffness, v) = j.core_mut().rank_one_mut();
        let volume = energy::volume_gradient(mesh, x, v)?;
        *stiffness = gas.stiffness(volume);
        let excess = gas.excess(volume);
        for (out, v) in out.iter_mut().zip(v) {
            *out = -excess * *v;
        }
        energy::add_linearisation(mesh, x, law, &NoFilm, c, excess, out, j.core_mut())?;
        if !r.is_empty() {
            add_ring(ring, u, c.bending * q[0], *moment, *alpha, r);
        }
        for at in ring {
            let force = c.bending * at.height[0];
            j.column_mut(0)[at.unknown] += force;
            j.row_mut(0)[at.unknown] += if row == Row::Level { at.slope[0] } else { force };
        }
        Ok(())
    }

    fn residual_as(
        &self,
        law: &Shell,
        u: &[f64],
        values: &Values,
        r: &mut [f64],
    ) -> Result<(), EvalError> {
        let Values { alpha, moment, c, gas } = values;
        let mut moving = self.moving.lock();
        let (mesh, ring) = moving.at(*alpha);
        let (x, q) = u.split_at(self.coefficients);
        let (out, _) = r.split_at_mut(self.coefficients);
        let volume = energy::volume_gradient(mesh, x, out)?;
        let excess = gas.excess(volume);
        for out in out.iter_mut() {
            *out *= -excess;
        }
        let gradient = gradients::Energy { law, film: &NoFilm, c };
        energy::add_gradient(mesh, x, c.plate, out, &gradient)?;
        add_ring(ring, u, c.bending * q[0], *moment, *alpha, r);
        Ok(())
    }
}

/// Adds the ring's force and moment to the gradient and sets the constraint `z'(S_L)`.
fn add_ring(ring: &[AtRing; 4], u: &[f64], force: f64, moment: f64, alpha: f64, r: &mut [f64]) {
    let mut slope = -alpha.sin();
    for at in ring {
        r[at.unknown] += force * at.height[0] + moment * at.slope[0];
        slope += at.slope[0] * u[at.unknown];
    }
    if let Some(last) = r.last_mut() {
        *last = slope;
    }
}

impl Problem for RingLoadProblem {
    type Jacobian = Arrow<SymmetricBand>;

    fn dim(&self) -> usize {
        self.coefficients + 1
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> Arrow<SymmetricBand> {
        Arrow::new(SymmetricBand::new(self.coefficients, HALF_BANDWIDTH), 1)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let values = self.values(u, p)?;
        self.residual_as(&self.material(&values), u, &values, r)
    }

    fn jacobian(
        &self,
        u: &[f64],
        p: &[f64],
        j: &mut Arrow<SymmetricBand>,
    ) -> Result<(), EvalError> {
        self.linearise(u, p, &mut [], j)
    }

    fn linearise(
        &self,
        u: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut Arrow<SymmetricBand>,
    ) -> Result<(), EvalError> {
        let values = self.values(u, p)?;
        self.assemble(&self.material(&values), (u, &values), r, j, Row::Level)
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let Values { alpha, moment, c, gas } = self.values(u, p)?;
        let mut moving = self.moving.lock();
        let (x, q) = u.split_at(self.coefficients);
        let (mesh, ring) = moving.at(alpha);
        let ring = *ring;
        energy::admissible(mesh, x, c.plate)?;
        out.fill(0.0);
        let (shell, _) = out.split_at_mut(self.coefficients);
        match which {
            parameter::ALPHA => {
                let law = &c.material(self.shell.law);
                moving.angle_derivative(law, x, &c, &gas, shell);
                let mut slope = -alpha.cos();
                for at in &ring {
                    let force = c.bending * q[0];
                    shell[at.unknown] += force * at.height[1] + moment * at.slope[1];
                    slope += at.slope[1] * x[at.unknown];
                }
                out[self.coefficients] = slope;
            }
            parameter::MOMENT => {
                for at in &ring {
                    shell[at.unknown] += at.slope[0];
                }
            }
            parameter::BENDING => {
                let gradient = gradients::Bending { poisson: c.poisson };
                energy::add_gradient(mesh, x, c.plate, shell, &gradient)?;
                for at in &ring {
                    shell[at.unknown] += q[0] * at.height[0];
                }
            }
            parameter::PRESSURE => {
                let volume = energy::volume_gradient(mesh, x, shell)?;
                let change = gas.excess_by_ambient(volume);
                shell.iter_mut().for_each(|v| *v *= -change);
            }
            parameter::GAS_EXPONENT => {
                let volume = energy::volume_gradient(mesh, x, shell)?;
                let change = gas.excess_by_exponent(volume);
                shell.iter_mut().for_each(|v| *v *= -change);
            }
            parameter::POISSON | parameter::B => {
                let constant = match which {
                    parameter::B => Constant::MooneyB,
                    _ => Constant::Poisson,
                };
                let law = &c.material(self.shell.law);
                let gradient = gradients::Material { law, constant, c: &c };
                energy::add_gradient(mesh, x, c.plate, shell, &gradient)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// That of the displacements on the mesh at 10 degrees; the force has none.
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        let (y, last) = y.split_at_mut(self.coefficients);
        self.mass.mul(&x[..self.coefficients], y);
        last.fill(0.0);
    }

    fn stability(&self) -> Stability {
        Stability::SeparateHessian
    }

    fn energy_hessian(
        &self,
        u: &[f64],
        p: &[f64],
        h: &mut Arrow<SymmetricBand>,
    ) -> Result<(), EvalError> {
        let values = self.values(u, p)?;
        self.assemble(&self.material(&values), (u, &values), &mut [], h, Row::Height)
    }

    fn multipliers(&self) -> usize {
        1
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
        let bending = self.values(u, p)?.c.bending;
        let n = self.coefficients;
        let direct = if which == parameter::BENDING { u[n] * dp } else { 0.0 };
        let force = observe::FORCE_UNIT * (bending * du[n] + direct);
        Ok((observe::NAMES.get(k) == Some(&"force")).then_some(force))
    }
}

/// The mesh is only looked at.
impl RingLoadProblem {
    fn with_mesh<R>(&self, alpha: f64, look: impl FnOnce(&Mesh, &[AtRing; 4], usize) -> R) -> R {
        let mut moving = self.moving.lock();
        let outside = moving.outside();
        let (mesh, ring) = moving.at(alpha);
        look(mesh, ring, outside)
    }
}
