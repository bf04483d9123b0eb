//! The shell under a dead load or a cantilever: the plate's height is an unknown.

use super::{Device, DeviceError, Loading};
use crate::contact::{ContactProblem, parameter};
use crate::observables::{self, Observation};
use crate::spline::HALF_BANDWIDTH;
use continuation::linalg::{Arrow, SymmetricBand};
use continuation::{EvalError, Name, ParamId, Parameter, Problem, Stability, literals};
use std::f64::consts::PI;

/// Names of the observables: those of the contact problem, then `z0`.
const NAMES: [&str; observables::NAMES.len() + 1] = {
    let mut names = ["z0"; observables::NAMES.len() + 1];
    let mut k = 0;
    while k < observables::NAMES.len() {
        names[k] = observables::NAMES[k];
        k += 1;
    }
    names
};

static OBSERVABLES: [Name; NAMES.len()] = literals(NAMES);

/// Unknowns `(u, z0)`; residual: the gradient of the potential of half a shell and its device over
/// `2π`, `E + (√k_b/2π) F z0` under a dead load and `E + (√k_b/4π) k_c (z0 − z_base)²` on a
/// cantilever; Jacobian: its Hessian, the band bordered with `z0`. `p[0]` is the force or the base;
/// the other parameters are those of the [`ContactProblem`].
///
/// The metric is that of the shell plus `dz0²`, lengths in `R0`.
#[derive(Debug, Clone)]
pub struct LoadedProblem<'c> {
    contact: &'c ContactProblem,
    device: Device,
    parameters: Vec<Parameter>,
}

impl<'c> LoadedProblem<'c> {
    /// The shell under a device with a freedom of its own.
    ///
    /// # Errors
    /// For a grip, and for a stiffness that is not positive.
    pub fn new(contact: &'c ContactProblem, device: Device) -> Result<Self, DeviceError> {
        let own = |unit, scale| Parameter::new(device.parameter_name(), unit, scale);
        let first = match device {
            Device::Grip => return Err(DeviceError::Grip),
            Device::DeadLoad => own("sqrt(chi k_b)", 1.0),
            Device::Cantilever { stiffness } if stiffness > 0.0 && stiffness.is_finite() => {
                own("R0", 1.0)
            }
            Device::Cantilever { stiffness } => {
                return Err(DeviceError::Stiffness { value: stiffness });
            }
        };
        let others = contact.parameters().iter().skip(1).cloned();
        let parameters = [first].into_iter().chain(others).collect();
        Ok(LoadedProblem { contact, device, parameters })
    }

    /// The case's parameters with the device's own at `value`.
    pub fn parameters_at(&self, value: f64) -> Vec<f64> {
        self.contact.parameters_at(value)
    }

    /// The shell without its device.
    pub fn contact(&self) -> &'c ContactProblem {
        self.contact
    }

    /// The state of a shell `u` under a plate at `z0`.
    pub fn state(&self, u: &[f64], z0: f64) -> Vec<f64> {
        u.iter().copied().chain([z0]).collect()
    }

    /// Everything that is reported of a state of the shell.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn observation(&self, x: &[f64], p: &[f64]) -> Result<Observation, EvalError> {
        let (u, inner) = self.inner(x, p);
        self.contact.observation(u, &inner)
    }

    /// The shell and its parameters.
    fn inner<'x>(&self, x: &'x [f64], p: &[f64]) -> (&'x [f64], [f64; parameter::COUNT]) {
        let (u, z0) = x.split_at(self.contact.dim());
        let z0 = z0.first().copied().unwrap_or(f64::NAN);
        (u, ContactProblem::with_plate(p, z0))
    }

    /// `√k_b/2π`, which turns reported forces into those of the residual.
    fn unit(p: &[f64]) -> f64 {
        p[parameter::BENDING.0].sqrt() / (2.0 * PI)
    }

    /// The device's force on the plate, in `√(χk_b)`.
    fn load(&self, z0: f64, parameter: f64) -> f64 {
        match self.device {
            Device::Cantilever { stiffness } => stiffness * (z0 - parameter),
            _ => parameter,
        }
    }

    /// Derivatives of that force by `z0` and by the parameter.
    fn force_slopes(&self) -> (f64, f64) {
        match self.device {
            Device::Cantilever { stiffness } => (stiffness, -stiffness),
            _ => (0.0, 1.0),
        }
    }
}

impl Problem for LoadedProblem<'_> {
    type Jacobian = Arrow<SymmetricBand>;

    fn dim(&self) -> usize {
        self.contact.dim() + 1
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> Arrow<SymmetricBand> {
        Arrow::new(SymmetricBand::new(self.contact.dim(), HALF_BANDWIDTH), 1)
    }

    fn residual(&self, x: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let (u, inner) = self.inner(x, p);
        let n = u.len();
        self.contact.residual(u, &inner, &mut r[..n])?;
        let load = Self::unit(p) * self.load(x[n], p[0]);
        r[n] = self.contact.plate_pull(u, &inner)? + load;
        if r[n].is_finite() { Ok(()) } else { Err(EvalError::NotFinite { at: n }) }
    }

    fn jacobian(&self, x: &[f64], p: &[f64], j: &mut Self::Jacobian) -> Result<(), EvalError> {
        let (u, inner) = self.inner(x, p);
        self.contact.jacobian(u, &inner, j.core_mut())?;
        self.border(u, p, &inner, j)
    }

    fn linearise(
        &self,
        x: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut Self::Jacobian,
    ) -> Result<(), EvalError> {
        let (u, inner) = self.inner(x, p);
        let n = u.len();
        self.contact.linearise(u, &inner, &mut r[..n], j.core_mut())?;
        let load = Self::unit(p) * self.load(x[n], p[0]);
        r[n] = self.contact.plate_pull(u, &inner)? + load;
        self.border(u, p, &inner, j)?;
        if r[n].is_finite() { Ok(()) } else { Err(EvalError::NotFinite { at: n }) }
    }

    fn parameter_derivative(
        &self,
        x: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let (u, inner) = self.inner(x, p);
        let n = u.len();
        if which == ParamId(0) {
            self.contact.admissible(u, &inner)?;
            out[..n].fill(0.0);
            out[n] = Self::unit(p) * self.force_slopes().1;
            return Ok(());
        }
        self.contact.parameter_derivative(u, &inner, which, &mut out[..n])?;
        out[n] = self.contact.plate_pull_by(u, &inner, which)?;
        if which == parameter::BENDING {
            out[n] += 0.5 * Self::unit(p) / p[which.0] * self.load(x[n], p[0]);
        }
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        let n = self.contact.dim();
        self.contact.metric(&x[..n], &mut y[..n]);
        y[n] = x[n];
    }

    // no `unknown_scale`: the base of a soft spring is a length that moves much farther than the shell

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    fn observables(&self) -> &[Name] {
        &OBSERVABLES
    }

    fn observe(&self, x: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let values = self.observation(x, p)?.to_array();
        let all = values.into_iter().chain([x[self.contact.dim()]]);
        for (out, value) in out.iter_mut().zip(all) {
            *out = value;
        }
        Ok(())
    }

    fn observable_slope(
        &self,
        k: usize,
        x: &[f64],
        p: &[f64],
        which: ParamId,
        dx: &[f64],
        dp: f64,
    ) -> Result<Option<f64>, EvalError> {
        let (u, inner) = self.inner(x, p);
        let (du, dz) = (&dx[..u.len()], dx[u.len()]);
        if k == observables::NAMES.len() {
            return Ok(Some(dz));
        }
        if which != ParamId(0) && dp != 0.0 {
            return Ok(None);
        }
        // the device's parameter does not act on the shell directly
        self.contact.observable_slope(k, u, &inner, parameter::Z0, du, dz)
    }
}

impl LoadedProblem<'_> {
    fn border(
        &self,
        u: &[f64],
        p: &[f64],
        inner: &[f64],
        j: &mut Arrow<SymmetricBand>,
    ) -> Result<(), EvalError> {
        self.contact.parameter_derivative(u, inner, parameter::Z0, j.column_mut(0))?;
        self.contact.parameter_derivative(u, inner, parameter::Z0, j.row_mut(0))?;
        let corner = self.contact.plate_pull_by(u, inner, parameter::Z0)?;
        j.set_corner(0, 0, corner + Self::unit(p) * self.force_slopes().0);
        Ok(())
    }
}

impl Loading for LoadedProblem<'_> {
    fn device(&self) -> Device {
        self.device
    }

    fn parameters_at(&self, value: f64) -> Vec<f64> {
        LoadedProblem::parameters_at(self, value)
    }

    fn plate(&self, x: &[f64], _: &[f64]) -> f64 {
        x[self.contact.dim()]
    }

    fn mean_force(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        let (u, inner) = self.inner(x, p);
        self.contact.mean_force(u, &inner)
    }

    fn energy(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        let (u, inner) = self.inner(x, p);
        self.contact.total_energy(u, &inner)
    }

    fn root(&self, p: &[f64]) -> f64 {
        p[parameter::BENDING.0].sqrt()
    }

    fn shell_part<'x>(&self, x: &'x [f64]) -> &'x [f64] {
        &x[..self.contact.dim()]
    }

    fn free(&self, z0: f64) -> Option<Vec<f64>> {
        let u = super::start::free_start(self.contact, z0).ok()?;
        Some(self.state(&u, z0))
    }

    fn add_drag(&self, a: f64, j: &mut Arrow<SymmetricBand>) {
        self.contact.add_drag(a, j.core_mut());
        let corner = j.corner(0, 0);
        j.set_corner(0, 0, corner + a);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::{H, dot, duals, energy, problem, state};
    use crate::dual::{close, real};
    use crate::params::Law;
    use continuation::{Matrix, check_derivatives};
    use num_dual::DualNum;

    const DEVICES: [Device; 2] = [Device::DeadLoad, Device::Cantilever { stiffness: 7.0 }];

    /// The potential written once more, with the plate moved along `a` and `b` too.
    fn potential(
        device: Device,
        contact: &ContactProblem,
        x: &[f64],
        dual: [H; parameter::COUNT],
        z0: H,
    ) -> H {
        potential_along(device, contact, x, [&vec![0.0; x.len()], &vec![0.0; x.len()]], dual, z0)
    }

    fn potential_along(
        device: Device,
        contact: &ContactProblem,
        x: &[f64],
        [a, b]: [&[f64]; 2],
        dual: [H; parameter::COUNT],
        z0: H,
    ) -> H {
        let n = contact.dim();
        let mut inner = dual;
        inner[0] = z0;
        let unit = dual[parameter::BENDING.0].sqrt() * (0.5 / PI);
        let load = match device {
            Device::Cantilever { stiffness } => (z0 - dual[0]) * (z0 - dual[0]) * (0.5 * stiffness),
            _ => dual[0] * z0,
        };
        energy(contact, &x[..n], &a[..n], &b[..n], inner) + unit * load
    }

    #[test]
    fn residual_hessian_and_parameter_derivatives_agree_with_dual_numbers() {
        let contact = problem(Law::MooneyRivlin { b: 0.7 }, 4);
        let n = contact.dim();
        for device in DEVICES {
            let loaded = LoadedProblem::new(&contact, device).unwrap();
            let x = loaded.state(&state(n, 0.3, 0.01), 1.07);
            let p = loaded.parameters_at(0.9);
            let plain = duals(&p);
            let (mut r, mut alone) = (vec![0.0; n + 1], vec![0.0; n + 1]);
            let (mut j, mut again) = (loaded.new_jacobian(), loaded.new_jacobian());
            loaded.linearise(&x, &p, &mut r, &mut j).unwrap();
            loaded.residual(&x, &p, &mut alone).unwrap();
            loaded.jacobian(&x, &p, &mut again).unwrap();
            assert!((0..=n).all(|i| (r[i] - alone[i]).abs() < 1e-15));
            let (mut jb, mut jb_again) = (vec![0.0; n + 1], vec![0.0; n + 1]);
            for seed in 0..4 {
                let a = state(n + 1, 1.0 + f64::from(seed), 1.0);
                let b = state(n + 1, 2.7 * f64::from(seed), 1.0);
                let z0 = H::new(x[n], a[n], b[n], 0.0);
                let e = potential_along(device, &contact, &x, [&a, &b], plain, z0);
                let size = |x: &[f64], y: &[f64]| dot(x, x).sqrt() * dot(y, y).sqrt();
                close(dot(&r, &a), e.eps1, 1e-12, 1e-14 * size(&r, &a));
                j.mul(&b, &mut jb);
                again.mul(&b, &mut jb_again);
                close(dot(&a, &jb), e.eps1eps2, 1e-12, 1e-14 * size(&a, &jb));
                close(dot(&a, &jb), dot(&a, &jb_again), 1e-13, 1e-14 * size(&a, &jb));
                for k in 0..p.len() {
                    let mut dual = plain;
                    dual[k].eps2 = 1.0;
                    let still = vec![0.0; n + 1];
                    let z0 = H::new(x[n], a[n], 0.0, 0.0);
                    let e = potential_along(device, &contact, &x, [&a, &still], dual, z0);
                    loaded.parameter_derivative(&x, &p, ParamId(k), &mut alone).unwrap();
                    close(dot(&alone, &a), e.eps1eps2, 1e-12, 1e-13 * size(&alone, &a));
                }
            }
            let check = check_derivatives(&loaded, &x, &p, 1e-3).unwrap();
            assert!(check.is_within(1e-7), "{check:?}");
        }
    }

    /// `U_T + device = 4π` times the potential of the half shell over `2π`.
    #[test]
    fn potential_is_that_of_the_residual() {
        let contact = problem(Law::Hooke, 4);
        for device in DEVICES {
            let loaded = LoadedProblem::new(&contact, device).unwrap();
            let x = loaded.state(&state(contact.dim(), 0.3, 0.01), 1.07);
            let p = loaded.parameters_at(0.9);
            let plain = duals(&p);
            let half = potential(device, &contact, &x, plain, real(1.07)).re;
            close(loaded.potential(&x, &p).unwrap(), 4.0 * PI * half, 1e-12, 0.0);
        }
    }

    #[test]
    fn observable_slopes_agree_with_differences() {
        let contact = problem(Law::Hooke, 4);
        let n = contact.dim();
        for device in DEVICES {
            let loaded = LoadedProblem::new(&contact, device).unwrap();
            let (x, dx) = (loaded.state(&state(n, 0.3, 0.01), 1.07), state(n + 1, 1.9, 1.0));
            let p = loaded.parameters_at(0.9);
            let at = |t: f64| {
                let moved: Vec<f64> = x.iter().zip(&dx).map(|(x, d)| x + t * d).collect();
                let mut out = vec![0.0; NAMES.len()];
                loaded.observe(&moved, &p, &mut out).unwrap();
                out
            };
            let h = 1e-5;
            let (up, down, up2, down2) = (at(h), at(-h), at(2.0 * h), at(-2.0 * h));
            let mut known = 0;
            for k in 0..NAMES.len() {
                let slope = loaded.observable_slope(k, &x, &p, ParamId(0), &dx, 0.7).unwrap();
                if let Some(slope) = slope {
                    known += 1;
                    let difference = (8.0 * (up[k] - down[k]) - (up2[k] - down2[k])) / (12.0 * h);
                    close(slope, difference, 1e-8, 1e-9);
                }
            }
            assert_eq!(known, 5);
        }
    }

    #[test]
    fn impossible_devices_are_refused() {
        let contact = problem(Law::Hooke, 4);
        let new = |device| LoadedProblem::new(&contact, device).map(|_| ()).unwrap_err();
        assert_eq!(new(Device::Grip), DeviceError::Grip);
        for value in [0.0, -1.0, f64::INFINITY] {
            let error = new(Device::Cantilever { stiffness: value });
            assert_eq!(error, DeviceError::Stiffness { value });
        }
    }
}
