//! Loading devices: what holds the plates, and what follows for stability and hysteresis.
//!
//! A rigid [`Device::Grip`] prescribes the plate's height `z0`, a [`Device::DeadLoad`] the force, a
//! [`Device::Cantilever`] the height `z_base = z0 − F/k_c` of its base. A device sees all states of
//! one branch but calls others of them stable: the Hessian is bordered with `z0`, and folds lie
//! where `dF/dz0` is infinite, 0 or `k_c` (module [`under`]). [`LoadedProblem`] is continued in
//! the device's own parameter; [`Relaxation`] follows the dissipative motion that a jump is;
//! [`travel`] goes once to and fro, and [`maxwell_points`] finds pairs of states of equal potential.

mod balance;
mod cycle;
mod flow;
mod loaded;
mod maxwell;
mod plate;
mod start;
pub mod under;
mod walker;

pub use balance::{Balance, balance};
pub use cycle::{Cycle, CycleError, CyclePoint, CycleSettings, Direction, JUMP, Jump, travel};
pub use flow::{Motion, MotionError, Relaxation, RelaxationSettings, Side};
pub use loaded::LoadedProblem;
pub use maxwell::{MaxwellPoint, maxwell_points};
pub(crate) use start::device_settings;
pub use start::{StartError, device_watches, free_start, loaded_start, trace_loaded};

use continuation::{EvalError, ParamId, Problem};

/// What holds the plates.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Device {
    /// A rigid grip: the plate's height is prescribed.
    #[default]
    Grip,
    /// A dead load: the force is prescribed.
    DeadLoad,
    /// A spring behind each plate.
    Cantilever {
        /// Its stiffness `k_c` in `√(χk_b)/R0`, positive. An instrument of stiffness `K` that closes
        /// both plates has `k_c = 2K`.
        stiffness: f64,
    },
}

/// Why there is no problem with a device.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// A grip leaves the plate no freedom.
    #[error("under a grip the plate's height is no unknown: use ContactProblem")]
    Grip,
    /// A stiffness that is not positive and finite.
    #[error("the cantilever's stiffness is {value}; it must be positive and finite")]
    Stiffness {
        /// The value given.
        value: f64,
    },
}

impl Device {
    /// The names of the devices.
    pub const NAMES: [&'static str; 3] = ["grip", "dead-load", "cantilever"];

    /// Its name, as in files.
    pub fn name(self) -> &'static str {
        match self {
            Device::Grip => Self::NAMES[0],
            Device::DeadLoad => Self::NAMES[1],
            Device::Cantilever { .. } => Self::NAMES[2],
        }
    }

    /// Stiffness of a cantilever.
    pub fn stiffness(self) -> Option<f64> {
        match self {
            Device::Cantilever { stiffness } => Some(stiffness),
            Device::Grip | Device::DeadLoad => None,
        }
    }

    /// Name of its parameter, as in files.
    pub fn parameter_name(self) -> &'static str {
        match self {
            Device::Grip => "z0",
            Device::DeadLoad => "force",
            Device::Cantilever { .. } => "base",
        }
    }

    /// Value of its parameter at an equilibrium.
    pub fn parameter(self, z0: f64, force: f64) -> f64 {
        match self {
            Device::Grip => z0,
            Device::DeadLoad => force,
            Device::Cantilever { stiffness } => z0 - force / stiffness,
        }
    }

    /// Whether its plates approach when its parameter grows.
    pub fn approaches_upwards(self) -> bool {
        self == Device::DeadLoad
    }

    /// `∫F dz0` along its line, at one value of its parameter, from one height to another.
    pub fn work(self, parameter: f64, from: f64, to: f64) -> f64 {
        match self {
            Device::Grip => 0.0,
            Device::DeadLoad => parameter * (to - from),
            Device::Cantilever { stiffness } => {
                stiffness * (to - from) * (0.5 * (from + to) - parameter)
            }
        }
    }

    /// Potential of both devices in `χR0²`, `root` being `√k_b`; zero at `z0 = 0` under a dead load
    /// and for a relaxed spring.
    pub(crate) fn potential(self, root: f64, parameter: f64, z0: f64) -> f64 {
        let from = if let Device::Cantilever { .. } = self { parameter } else { 0.0 };
        2.0 * root * self.work(parameter, from, z0)
    }

    /// Derivative of the total potential by the parameter at an equilibrium.
    pub(crate) fn potential_slope(self, root: f64, z0: f64, force: f64) -> f64 {
        match self {
            Device::DeadLoad => 2.0 * root * z0,
            _ => -2.0 * root * force,
        }
    }
}

/// A shell between plates under a device. The residual is the gradient of the total potential of the
/// shell (or half of one) with its device, over `2π`; `p[0]` is the device's parameter.
pub trait Loading: Problem {
    /// The device.
    fn device(&self) -> Device;
    /// The case's parameters with the device's own at `value`.
    fn parameters_at(&self, value: f64) -> Vec<f64>;
    /// Half the distance of the plates, in `R0`: over a mirror-symmetric shell the plate's height.
    fn plate(&self, x: &[f64], p: &[f64]) -> f64;
    /// Force on a plate in `√(χk_b)`, the mean where two plates carry different ones.
    ///
    /// # Errors
    /// When the state is not admissible.
    fn mean_force(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError>;
    /// The observables of the forces on the upper and the lower plate; one of both where they are equal.
    fn forces(&self) -> [usize; 2] {
        [0, 0]
    }
    /// Its derivative along a direction in which the device's parameter, the first, moves by `dp`; NaN if it
    /// is not known.
    ///
    /// # Errors
    /// When the state is not admissible.
    fn mean_force_along(
        &self,
        x: &[f64],
        p: &[f64],
        dx: &[f64],
        dp: f64,
    ) -> Result<f64, EvalError> {
        let slope = |k| self.observable_slope(k, x, p, ParamId(0), dx, dp);
        let [top, bottom] = self.forces();
        let upper = slope(top)?.unwrap_or(f64::NAN);
        let lower = if bottom == top { upper } else { slope(bottom)?.unwrap_or(f64::NAN) };
        Ok(0.5 * (upper + lower))
    }
    /// Total energy of the whole shell, in `χR0²`.
    ///
    /// # Errors
    /// When the state is not admissible.
    fn energy(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError>;
    /// `h += a M`, `M` the matrix of the metric, which is that of the drag too.
    fn add_drag(&self, a: f64, h: &mut Self::Jacobian);
    /// The unknowns under a grip.
    fn shell_part<'x>(&self, x: &'x [f64]) -> &'x [f64];
    /// Force on a plate as it is reported: on the upper one.
    ///
    /// # Errors
    /// When the state is not admissible.
    fn force(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        self.mean_force(x, p)
    }
    /// `√k_b`, in `√χR0`.
    fn root(&self, p: &[f64]) -> f64;
    /// Total potential of the whole shell and both devices, in `χR0²`.
    ///
    /// # Errors
    /// When the state is not admissible.
    fn potential(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        Ok(self.energy(x, p)? + self.device().potential(self.root(p), p[0], self.plate(x, p)))
    }
    /// The free shell between plates at half the distance `z0`, of a device from which plates can
    /// fly away.
    fn free(&self, _z0: f64) -> Option<Vec<f64>> {
        None
    }
    /// The mirror image of a state, where it is a state of the same problem and may be another one.
    fn mirrored(&self, _x: &[f64], _p: &[f64]) -> Option<Vec<f64>> {
        None
    }
}
