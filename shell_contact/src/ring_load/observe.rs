//! What is reported of a ring-loaded shell.

use super::{RingLoadProblem, Values};
use crate::energy;
use crate::film::NoFilm;
use crate::meridian::Mesh;
use crate::resolution::{self, Resolution};
use continuation::{EvalError, Name, literals};
use std::f64::consts::{FRAC_PI_2, PI};

/// Names of the observables, in the order of [`RingObservation::to_array`].
pub const NAMES: [&str; 8] = [
    "deflection_over_h",
    "force",
    "pole_height",
    "ring_height",
    "admissible",
    "energy_total",
    "pole_over_h",
    "highest_over_h",
];

/// The same, as a problem gives them.
pub(super) static OBSERVABLES: [Name; NAMES.len()] = literals(NAMES);

/// Force in units of `2πχR0`, times this, is what is reported.
pub(super) const FORCE_UNIT: f64 = 1e6;
/// A shell that rises above the ring by less than this part of its thickness does not.
const FLAT: f64 = 1e-6;
/// Steps of Newton's method towards the highest point of an element.
const CLIMB: usize = 4;

/// What is reported of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingObservation {
    /// How far the ring has gone down, `(1 − z(S_L))/h`, from the pole of the unstressed shell;
    /// `h` is the thickness of a homogeneous shell of the same bending stiffness.
    pub deflection_over_h: f64,
    /// `10⁶ F/(2πχR0)`, positive in compression; `χ = Eh`.
    pub force: f64,
    /// `z(0)`, in `R0`.
    pub pole_height: f64,
    /// `z(S_L)`, in `R0`.
    pub ring_height: f64,
    /// Whether no point of the shell lies above the ring's plane, where the plate is.
    pub admissible: bool,
    /// Energy of the whole shell and its gas without that of the load, in `χR0²`.
    pub energy_total: f64,
    /// Height of the pole above the ring, `(z(0) − z(S_L))/h`; negative in a dimple.
    pub pole_over_h: f64,
    /// Height of the highest point of the shell above the ring, in `h`.
    pub highest_over_h: f64,
}

impl RingObservation {
    /// The values in the order of [`NAMES`]; `admissible` is 1 or 0.
    pub fn to_array(&self) -> [f64; NAMES.len()] {
        [
            self.deflection_over_h,
            self.force,
            self.pole_height,
            self.ring_height,
            f64::from(u8::from(self.admissible)),
            self.energy_total,
            self.pole_over_h,
            self.highest_over_h,
        ]
    }
}

/// The deformed meridian.
#[derive(Debug, Clone, PartialEq)]
pub struct RingProfile {
    /// Distance from the axis, in `R0`.
    pub sigma: Vec<f64>,
    /// Height above the equator, in `R0`.
    pub z: Vec<f64>,
}

impl RingLoadProblem {
    /// Everything that is reported of a state.
    ///
    /// # Errors
    /// When the state is not admissible to the model.
    pub fn observation(&self, u: &[f64], p: &[f64]) -> Result<RingObservation, EvalError> {
        let Values { alpha, c, gas, .. } = self.values(u, p)?;
        let h = thickness(c.bending, c.poisson);
        let (x, q) = u.split_at(u.len().saturating_sub(1));
        self.with_mesh(alpha, |mesh, _, outside| {
            let parts = energy::parts(mesh, x, &c.material(self.shell.law), &NoFilm, &c)?;
            let ring = alpha.cos() + mesh.displacement_in(x, outside, alpha)[0].1;
            let pole = 1.0 + mesh.displacement_in(x, 0, 0.0)[0].1;
            let highest = highest(mesh, x);
            let energy = parts.stretching + parts.bending + gas.energy(parts.volume);
            Ok(RingObservation {
                deflection_over_h: (1.0 - ring) / h,
                force: FORCE_UNIT * c.bending * q.first().copied().unwrap_or(f64::NAN),
                pole_height: pole,
                ring_height: ring,
                admissible: highest - ring <= FLAT * h,
                energy_total: 4.0 * PI * energy,
                pole_over_h: (pole - ring) / h,
                highest_over_h: ((highest - ring) / h).max(0.0),
            })
        })
    }

    /// How well the elements resolve the shell with the parameters `p`, by the longest one within a
    /// wavelength of the ring, beyond which what the ring does has decayed; there is no film.
    ///
    /// # Errors
    /// When the parameters are out of range.
    pub fn resolution(&self, u: &[f64], p: &[f64]) -> Result<Resolution, EvalError> {
        let Values { alpha, c, .. } = self.values(u, p)?;
        let wavelength = resolution::wavelength(&c);
        let near = (alpha - wavelength, alpha + wavelength);
        let longest = self.with_mesh(alpha, |mesh, _, _| resolution::longest(mesh, near));
        Ok(Resolution { per_film_length: f64::INFINITY, per_wavelength: wavelength / longest })
    }

    /// The deformed meridian at `samples` places from pole to equator.
    ///
    /// # Errors
    /// When the parameters are outside the model.
    pub fn profile(&self, u: &[f64], p: &[f64], samples: usize) -> Result<RingProfile, EvalError> {
        let alpha = self.values(u, p)?.alpha;
        let x = &u[..u.len().saturating_sub(1)];
        Ok(self.with_mesh(alpha, |mesh, _, _| {
            let last = samples.max(2) - 1;
            let places = (0..=last).map(|i| mesh.place(x, FRAC_PI_2 * i as f64 / last as f64));
            let (sigma, z) = places.map(|at| (at.s[0], at.z[0])).unzip();
            RingProfile { sigma, z }
        }))
    }
}

/// Thickness over radius of a homogeneous shell with this bending stiffness (Eq. 11).
fn thickness(bending: f64, nu: f64) -> f64 {
    (12.0 * (1.0 - nu * nu) * bending).sqrt()
}

/// `max z`: the highest knot or Gauss point, and the top of the arc about it.
fn highest(mesh: &Mesh, x: &[f64]) -> f64 {
    let (mut best, mut at) = (f64::NEG_INFINITY, (0, 0.0));
    for e in 0..mesh.elements() {
        let (start, end) = (mesh.knots().at(e), mesh.knots().at(e + 1));
        if end == start {
            continue;
        }
        for part in [0.0, 0.25, 0.5, 0.75] {
            let s = start + part * (end - start);
            let z = s.cos() + mesh.displacement_in(x, e, s)[0].1;
            if z > best {
                (best, at) = (z, (e, s));
            }
        }
    }
    let (_, mut s) = at;
    for _ in 0..CLIMB {
        let [_, z1, z2] = mesh.place(x, s).z;
        if z2 >= 0.0 {
            break;
        }
        let next = (s - z1 / z2).clamp(0.0, FRAC_PI_2);
        s = next;
        best = best.max(mesh.place(x, s).z[0]);
    }
    best
}
