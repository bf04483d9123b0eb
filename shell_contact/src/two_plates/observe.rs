//! What is reported of a state between two plates.

use super::{Half, Side, TwoPlatesProblem, parameter};
use crate::density::Coefficients;
use crate::energy;
use crate::gas::Gas;
use crate::half::HalfMeridian;
use crate::membrane::tensions;
use crate::observables::{self, Observation, Profile, contact_radius};
use crate::plate::{self, Variable};
use continuation::{EvalError, Name, ParamId, literals};
use std::f64::consts::{FRAC_PI_2, PI};

/// How many there are beside those of the half model.
const OWN: usize = 5;

/// Names of the observables: those of the half model, in the order of
/// [`TwoPlatesObservation::to_array`], then those by plate.
pub const NAMES: [&str; observables::NAMES.len() + OWN] = {
    let own = ["pole_top", "pole_bottom", "shift", "force_bottom", "contact_radius_bottom"];
    let mut names = [""; observables::NAMES.len() + OWN];
    let mut k = 0;
    while k < names.len() {
        let shared = observables::NAMES.len();
        names[k] = if k < shared { observables::NAMES[k] } else { own[k - shared] };
        k += 1;
    }
    names
};

/// The same, as a problem gives them.
pub(super) static OBSERVABLES: [Name; NAMES.len()] = literals(NAMES);

/// What is reported of a state; lengths in `R0`, forces in `√(χk_b)`, positive in compression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoPlatesObservation {
    /// As of the half model: `force` and `contact_radius` of the upper plate, `pole_height` half the
    /// distance of the poles.
    pub whole: Observation,
    /// Upper pole above the equator.
    pub pole_top: f64,
    /// Lower pole below the equator.
    pub pole_bottom: f64,
    /// Equator (the ring of the material that was halfway between the poles) above the mid-plane.
    pub shift: f64,
    /// Force on the lower plate: that on the upper unless the equator is held.
    pub force_bottom: f64,
    /// As [`Observation::contact_radius`], of the lower plate.
    pub contact_radius_bottom: f64,
}

impl TwoPlatesObservation {
    /// The values in the order of [`NAMES`].
    pub fn to_array(&self) -> [f64; NAMES.len()] {
        let mut out = [0.0; NAMES.len()];
        let own = [
            self.pole_top,
            self.pole_bottom,
            self.shift,
            self.force_bottom,
            self.contact_radius_bottom,
        ];
        let all = self.whole.to_array().into_iter().chain(own);
        out.iter_mut().zip(all).for_each(|(out, value)| *out = value);
        out
    }
}

impl TwoPlatesProblem {
    /// Everything that is reported of a state.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn observation(&self, u: &[f64], p: &[f64]) -> Result<TwoPlatesObservation, EvalError> {
        let (c, gas) = self.coefficients(u.len(), p)?;
        self.observed(u, &c, &gas)
    }

    /// [`Self::observation`] with plates at heights of their own.
    pub(super) fn observed(
        &self,
        u: &[f64],
        c: &[Coefficients; 2],
        gas: &Gas,
    ) -> Result<TwoPlatesObservation, EvalError> {
        let parts = self.parts(u, c)?;
        let half_volume = 0.5 * parts.volume;
        let energies = [
            parts.stretching,
            parts.bending,
            parts.film,
            2.0 * gas.energy(half_volume),
            c[0].surface_tension * parts.area,
        ]
        .map(|e| 2.0 * PI * e);
        let forces = self.pulls(u, c)?.map(|pull| plate::force_factor(c[0].bending) * pull + 0.0);
        let halves = self.halves();
        let radii = [0, 1].map(|k| contact_radius(&halves[k], u, &c[k]));
        let poles = self.pole_heights(u);
        let shift = equator(&halves[0], u);
        Ok(TwoPlatesObservation {
            whole: Observation {
                force: forces[0],
                pole_height: 0.5 * (poles[0] + poles[1]),
                gas_pressure: gas.pressure(half_volume),
                volume: 2.0 * PI * parts.volume,
                energy_total: energies.iter().sum(),
                energy_stretching: energies[0],
                energy_bending: energies[1],
                energy_film: energies[2],
                energy_gas: energies[3],
                energy_surface: energies[4],
                contact_radius: radii[0],
            },
            pole_top: poles[0] - shift,
            pole_bottom: poles[1] + shift,
            shift,
            force_bottom: forces[1],
            contact_radius_bottom: radii[1],
        })
    }

    /// Heights of the poles over the plane `z = 0`, of either towards its plate.
    pub(super) fn pole_heights(&self, u: &[f64]) -> [f64; 2] {
        self.halves().map(|half| 1.0 + pole(&half, u))
    }

    /// Slope of observable `k` at a state and in a direction of the shell, where films move by
    /// `moved` and the parameter `which` by `dp`; `None` if it is not known.
    pub(super) fn slope(
        &self,
        k: usize,
        (u, du): (&[f64], &[f64]),
        c: &[Coefficients; 2],
        gas: &Gas,
        moved: [Option<(Variable, f64)>; 2],
        (which, dp): (ParamId, f64),
    ) -> Result<Option<f64>, EvalError> {
        let [top, bottom] = self.halves();
        let (upper, lower) = &self.potentials;
        let force = |side: Side| {
            let mut slope = match side {
                Side::Top => plate::pull_along(&top, upper, u, &c[0], du, moved[0])?,
                Side::Bottom => plate::pull_along(&bottom, lower, u, &c[1], du, moved[1])?,
            };
            if which == parameter::BENDING {
                let pull = self.pulls(u, c)?[side as usize];
                slope -= 0.5 * pull * dp / c[0].bending;
            }
            Ok(Some(plate::force_factor(c[0].bending) * slope))
        };
        let volume = || {
            let [wall_above, wall_below] = self.walls(c);
            let above = energy::volume_along(&top, u, du, wall_above)?;
            Ok(above + energy::volume_along(&bottom, u, du, wall_below)?)
        };
        let (poles, shift) = ([pole(&top, du), pole(&bottom, du)], equator(&top, du));
        match NAMES.get(k).copied() {
            Some("force") => force(Side::Top),
            Some("force_bottom") => force(Side::Bottom),
            Some("pole_height") => Ok(Some(0.5 * (poles[0] + poles[1]))),
            Some("pole_top") => Ok(Some(poles[0] - shift)),
            Some("pole_bottom") => Ok(Some(poles[1] + shift)),
            Some("shift") => Ok(Some(shift)),
            Some("volume") => volume().map(|slope: f64| Some(2.0 * PI * slope)),
            Some("gas_pressure") => {
                let half_volume = 0.5 * self.volume(u)?;
                let direct = match which {
                    parameter::PRESSURE => 1.0 + gas.excess_by_ambient(half_volume),
                    parameter::SURFACE_TENSION => gas.excess_by_surface_tension(half_volume),
                    parameter::GAS_EXPONENT => gas.excess_by_exponent(half_volume),
                    _ => 0.0,
                };
                volume().map(|slope| Some(direct * dp - 0.5 * gas.stiffness(half_volume) * slope))
            }
            _ => Ok(None),
        }
    }

    /// The meridian from the upper pole to the lower at `2 samples − 1` equally spaced angles,
    /// `samples ≥ 2` of either half. Film heights and pressures are those to the plate that faces
    /// the half.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn profile(&self, u: &[f64], p: &[f64], samples: usize) -> Result<Profile, EvalError> {
        let (c, _) = self.coefficients(u.len(), p)?;
        self.profile_between(u, &c, samples)
    }

    /// [`Self::profile`] with plates at heights of their own.
    pub(super) fn profile_between(
        &self,
        u: &[f64],
        c: &[Coefficients; 2],
        samples: usize,
    ) -> Result<Profile, EvalError> {
        let [top, bottom] = self.halves();
        let [wall_above, wall_below] = self.walls(c);
        energy::is_clear(&top, u, wall_above)?;
        energy::is_clear(&bottom, u, wall_below)?;
        self.check_poles(u)?;
        let law = c[0].material(self.shell.law);
        let tensions = |s, phi| tensions(&law, s, phi);
        let mut out = Profile::of(&top, &self.potentials.0, u, &c[0], samples, tensions);
        let below = Profile::of(&bottom, &self.potentials.1, u, &c[1], samples, tensions);
        // the equator is there already
        let below_equator = |values: &[f64]| values.iter().rev().skip(1).copied().collect();
        let parts: [(&mut Vec<f64>, Vec<f64>); 7] = [
            (&mut out.angle, below_equator(&below.angle)),
            (&mut out.sigma, below_equator(&below.sigma)),
            (&mut out.z, below_equator(&below.z)),
            (&mut out.delta, below_equator(&below.delta)),
            (&mut out.disjoining_pressure, below_equator(&below.disjoining_pressure)),
            (&mut out.tension_s, below_equator(&below.tension_s)),
            (&mut out.tension_phi, below_equator(&below.tension_phi)),
        ];
        let half = parts[0].0.len();
        for (all, more) in parts {
            all.extend(more);
        }
        out.angle[half..].iter_mut().for_each(|angle| *angle = PI - *angle);
        out.z[half..].iter_mut().for_each(|z| *z = -*z);
        Ok(out)
    }
}

/// `w` of the pole of a half, towards its plate.
fn pole(half: &Half<'_>, x: &[f64]) -> f64 {
    half.displacement_in(x, 0, 0.0)[0].1
}

/// `w` of the equator, of the upper half upwards.
pub(super) fn equator(top: &Half<'_>, x: &[f64]) -> f64 {
    top.displacement_in(x, top.elements() - 1, FRAC_PI_2)[0].1
}
