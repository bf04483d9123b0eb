//! The same shell with its equator held, or its upper plate on a spring.
//!
//! Held, as by a pipette or a gel: the equator's material ring stays in the mid-plane, `w(π/2) = 0`,
//! and a multiplier `Λ` takes up the difference of the plates' forces. This is how a shell is kept
//! that feels one plate only: free to move, it would carry no force at all.
//!
//! On a spring: the lower plate is rigid at `z = −base`, the upper one hangs on a cantilever whose
//! base is at `z = base`, so that `z_t = base + F_top/k_c`; the reported `z0` is half the distance
//! of the plates.

use super::observe::equator;
use super::{NAMES, TwoPlatesObservation, TwoPlatesProblem, parameter};
use crate::density::Coefficients;
use crate::gas::Gas;
use crate::half::HalfMeridian;
use crate::observables::Profile;
use crate::params::ParameterError;
use crate::plate::{self, Variable};
use crate::spline::HALF_BANDWIDTH;
use continuation::linalg::{Arrow, SymmetricBand};
use continuation::{EvalError, Name, ParamId, Parameter, Problem, Stability, literals};
use std::f64::consts::{FRAC_PI_2, PI};

/// Names of the observables: those of the shell between plates, then half their distance.
const WITH_Z0: [&str; NAMES.len() + 1] = {
    let mut names = ["z0"; NAMES.len() + 1];
    let mut k = 0;
    while k < NAMES.len() {
        names[k] = NAMES[k];
        k += 1;
    }
    names
};

static OBSERVABLES: [Name; WITH_Z0.len()] = literals(WITH_Z0);

/// What holds shell and plates beside the grip.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Support {
    /// Whether the equator is held in the mid-plane.
    pub held: bool,
    /// Stiffness of a cantilever behind the upper plate, in `√(χk_b)/R0`; rigid without one.
    pub spring: Option<f64>,
}

/// A [`TwoPlatesProblem`] with a [`Support`]: unknowns are those of the shell, then `Λ` if it is
/// held, then `z_t` if the upper plate hangs on a spring. Residual: the gradient over `2π` of
/// `E − Λ w(π/2) + (√k_b/4π) k_c (z_t − base)²`; the Jacobian is the band of the shell with a border
/// for each of the others. `Λ = (√k_b/2π)(F_top − F_bottom)` at an equilibrium. `p[0]` is `z0`, or
/// `base` with a spring.
#[derive(Debug, Clone)]
pub struct SupportedProblem<'c> {
    shell: &'c TwoPlatesProblem,
    support: Support,
    parameters: Vec<Parameter>,
    /// `∂w(π/2)/∂u`
    equator: Vec<f64>,
}

impl<'c> SupportedProblem<'c> {
    /// The shell with a support.
    ///
    /// # Errors
    /// When the stiffness is not positive.
    pub fn new(shell: &'c TwoPlatesProblem, support: Support) -> Result<Self, ParameterError> {
        if let Some(value) = support.spring.filter(|k| !(*k > 0.0 && k.is_finite())) {
            return Err(ParameterError::OutOfRange {
                key: "plate.top.stiffness",
                value,
                allowed: "positive",
                remedy: "k_c in sqrt(chi k_b)/R0; a rigid plate needs none",
            });
        }
        let mut parameters = shell.parameters().to_vec();
        if let (Some(_), Some(first)) = (support.spring, parameters.first_mut()) {
            first.name = "base".into();
        }
        let [top, _] = shell.halves();
        let mut equator = vec![0.0; shell.dim()];
        let last = top.elements() - 1;
        let basis = top.knots().basis(last, FRAC_PI_2)[0];
        let mut local = [0.0; 8];
        for (j, value) in basis.into_iter().enumerate() {
            local[2 * j + 1] = value;
        }
        top.scatter(last, &local, &mut equator);
        Ok(SupportedProblem { shell, support, parameters, equator })
    }

    /// The shell and its plates.
    pub fn shell(&self) -> &'c TwoPlatesProblem {
        self.shell
    }

    /// What holds them.
    pub fn support(&self) -> Support {
        self.support
    }

    /// Name of the parameter that is continued.
    pub fn parameter_name(&self) -> &str {
        &self.parameters[0].name
    }

    /// The case's parameters with the first of them at `value`.
    pub fn parameters_at(&self, value: f64) -> Vec<f64> {
        self.shell.parameters_at(value)
    }

    /// The unknowns of a shell `u` without a difference of forces, the upper plate at `plate`.
    pub fn state(&self, u: &[f64], plate: f64) -> Vec<f64> {
        let held = self.support.held.then_some(0.0);
        let plate = self.support.spring.map(|_| plate);
        u.iter().copied().chain(held).chain(plate).collect()
    }

    /// Everything that is reported of a state, and half the distance of the plates.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn observation(
        &self,
        x: &[f64],
        p: &[f64],
    ) -> Result<(TwoPlatesObservation, f64), EvalError> {
        let (u, c, gas) = self.inner(x, p)?;
        Ok((self.shell.observed(u, &c, &gas)?, self.half_distance(x, p)))
    }

    /// Half the distance of the plates.
    pub(super) fn half_distance(&self, x: &[f64], p: &[f64]) -> f64 {
        let plate = self.spring_border().and_then(|k| x.get(self.shell.dim() + k));
        plate.map_or(p[0], |plate| 0.5 * (plate + p[0]))
    }

    /// Index of `z_t` among the unknowns beside the shell's, with a spring.
    pub(super) fn spring_border(&self) -> Option<usize> {
        self.support.spring.map(|_| self.plate_border())
    }

    /// [`TwoPlatesProblem::profile`].
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn profile(&self, x: &[f64], p: &[f64], samples: usize) -> Result<Profile, EvalError> {
        let (u, c, _) = self.inner(x, p)?;
        self.shell.profile_between(u, &c, samples)
    }

    /// Heights of the upper plate and of the lower over `z = 0`, infinite for one that is not there.
    ///
    /// # Errors
    /// When there is no such state.
    pub fn plates(&self, x: &[f64], p: &[f64]) -> Result<[f64; 2], EvalError> {
        let (_, c, _) = self.inner(x, p)?;
        Ok([c[0].plate, -c[1].plate])
    }

    fn borders(&self) -> usize {
        usize::from(self.support.held) + usize::from(self.support.spring.is_some())
    }

    /// Index of `z_t` among the unknowns beside the shell's.
    fn plate_border(&self) -> usize {
        usize::from(self.support.held)
    }

    /// The shell's unknowns, and the numbers of either half with the plates where they are.
    pub(crate) fn inner<'x>(
        &self,
        x: &'x [f64],
        p: &[f64],
    ) -> Result<(&'x [f64], [Coefficients; 2], Gas), EvalError> {
        let (u, more) = x.split_at(self.shell.dim());
        let (mut c, gas) = self.shell.coefficients(x.len(), p)?;
        if self.support.spring.is_some() {
            let at = u.len() + self.plate_border();
            let plate = more.get(self.plate_border()).copied().unwrap_or(f64::NAN);
            if !plate.is_finite() {
                return Err(EvalError::NotFinite { at });
            }
            c[0].plate = if c[0].adhesion == 0.0 { f64::INFINITY } else { plate };
        }
        Ok((u, c, gas))
    }

    /// `√k_b/2π`, which turns reported forces into those of the residual.
    fn unit(c: &[Coefficients; 2]) -> f64 {
        c[0].bending.sqrt() / (2.0 * PI)
    }

    /// The rows of the residual beside the shell's, and what `Λ` adds to those.
    fn add_rows(
        &self,
        x: &[f64],
        p: &[f64],
        c: &[Coefficients; 2],
        r: &mut [f64],
    ) -> Result<(), EvalError> {
        let n = self.shell.dim();
        let (u, more) = x.split_at(n);
        let (shell, rows) = r.split_at_mut(n);
        if self.support.held {
            for (r, e) in shell.iter_mut().zip(&self.equator) {
                *r -= more[0] * e;
            }
            rows[0] = -equator(&self.shell.halves()[0], u);
        }
        if let Some(stiffness) = self.support.spring {
            let k = self.plate_border();
            let [top, _] = self.shell.pulls(u, c)?;
            rows[k] = top + Self::unit(c) * stiffness * (more[k] - p[0]);
        }
        match rows.iter().position(|r| !r.is_finite()) {
            Some(k) => Err(EvalError::NotFinite { at: n + k }),
            None => Ok(()),
        }
    }

    /// What of either plate's film a parameter is: a base carries the lower plate alone.
    fn variables(&self, which: ParamId) -> [Option<Variable>; 2] {
        let [top, bottom] = super::variables(which);
        let on_spring = self.support.spring.is_some() && which == parameter::Z0;
        [top.filter(|_| !on_spring), bottom]
    }

    fn border(
        &self,
        u: &[f64],
        c: &[Coefficients; 2],
        gas: &Gas,
        j: &mut Arrow<SymmetricBand>,
    ) -> Result<(), EvalError> {
        let borders = self.borders();
        for i in 0..borders {
            for k in 0..borders {
                j.set_corner(i, k, 0.0);
            }
        }
        if self.support.held {
            for (to, from) in j.column_mut(0).iter_mut().zip(&self.equator) {
                *to = -from;
            }
            for (to, from) in j.row_mut(0).iter_mut().zip(&self.equator) {
                *to = -from;
            }
        }
        if let Some(stiffness) = self.support.spring {
            let k = self.plate_border();
            let by = [Some(Variable::Height), None];
            self.shell.gradient_by(u, c, gas, &by, parameter::Z0, j.column_mut(k))?;
            self.shell.gradient_by(u, c, gas, &by, parameter::Z0, j.row_mut(k))?;
            let [top, _] = self.shell.halves();
            let film = &self.shell.potentials.0;
            let corner = plate::pull_by(&top, film, u, &c[0], Variable::Height)?;
            j.set_corner(k, k, corner + Self::unit(c) * stiffness);
        }
        Ok(())
    }
}

impl Problem for SupportedProblem<'_> {
    type Jacobian = Arrow<SymmetricBand>;

    fn dim(&self) -> usize {
        self.shell.dim() + self.borders()
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> Arrow<SymmetricBand> {
        Arrow::new(SymmetricBand::new(self.shell.dim(), HALF_BANDWIDTH), self.borders())
    }

    fn residual(&self, x: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let (u, c, gas) = self.inner(x, p)?;
        self.shell.gradient(u, &c, &gas, &mut r[..u.len()])?;
        self.add_rows(x, p, &c, r)
    }

    fn jacobian(&self, x: &[f64], p: &[f64], j: &mut Self::Jacobian) -> Result<(), EvalError> {
        let (u, c, gas) = self.inner(x, p)?;
        self.shell.gradient_and_hessian(u, &c, &gas, &mut [], j.core_mut())?;
        self.border(u, &c, &gas, j)
    }

    fn linearise(
        &self,
        x: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut Self::Jacobian,
    ) -> Result<(), EvalError> {
        let (u, c, gas) = self.inner(x, p)?;
        self.shell.gradient_and_hessian(u, &c, &gas, &mut r[..u.len()], j.core_mut())?;
        self.border(u, &c, &gas, j)?;
        self.add_rows(x, p, &c, r)
    }

    fn parameter_derivative(
        &self,
        x: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let (u, c, gas) = self.inner(x, p)?;
        let (shell, rows) = out.split_at_mut(u.len());
        rows.fill(0.0);
        let by = self.variables(which);
        self.shell.gradient_by(u, &c, &gas, &by, which, shell)?;
        if let Some(stiffness) = self.support.spring {
            let k = self.plate_border();
            if let Some(by) = by[0] {
                let [top, _] = self.shell.halves();
                let film = &self.shell.potentials.0;
                rows[k] = plate::pull_by(&top, film, u, &c[0], by)?;
            }
            let unit = Self::unit(&c);
            rows[k] += match which {
                parameter::Z0 => -unit * stiffness,
                parameter::BENDING => {
                    0.5 * unit / c[0].bending * stiffness * (x[u.len() + k] - p[0])
                }
                _ => 0.0,
            };
        }
        Ok(())
    }

    /// That of the shell, plus `dz_t²`; a multiplier has no length.
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        let n = self.shell.dim();
        self.shell.metric(&x[..n], &mut y[..n]);
        y[n..].fill(0.0);
        if self.support.spring.is_some() {
            let k = n + self.plate_border();
            y[k] = x[k];
        }
    }

    /// As of the shell, unless a spring's base moves much farther than that.
    fn unknown_scale(&self, which: ParamId) -> Option<f64> {
        (which == parameter::Z0 && self.support.spring.is_none()).then_some(1.0)
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    fn multipliers(&self) -> usize {
        usize::from(self.support.held)
    }

    fn observables(&self) -> &[Name] {
        &OBSERVABLES
    }

    fn observe(&self, x: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let (seen, z0) = self.observation(x, p)?;
        let all = seen.to_array().into_iter().chain([z0]);
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
        let (u, c, gas) = self.inner(x, p)?;
        let (du, more) = dx.split_at(u.len());
        let mut moved = self.variables(which).map(|by| by.map(|variable| (variable, dp)));
        let base = if which == parameter::Z0 { dp } else { 0.0 };
        let mut z0 = base;
        if self.support.spring.is_some() {
            let dz = more[self.plate_border()];
            z0 = 0.5 * (dz + base);
            match moved[0] {
                // a film that changes and a plate that moves: left to differences
                Some(_) if NAMES.get(k) == Some(&"force") => return Ok(None),
                Some(_) => {}
                None => moved[0] = Some((Variable::Height, dz)),
            }
        }
        if k == NAMES.len() {
            return Ok(Some(z0));
        }
        self.shell.slope(k, (u, du), &c, &gas, moved, (which, dp))
    }
}
