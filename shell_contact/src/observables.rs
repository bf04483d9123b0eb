//! What is reported of a state: force, energies, volume, contact radius, profiles.
//!
//! Energies and volume are those of the whole shell (`4π` times the integrals of the half shell
//! over `2π`), in `χR0²` and `R0³`; the force is that on one plate, in `√(χk_b)`, positive in
//! compression.

use crate::contact::ContactProblem;
use crate::density::Coefficients;
use crate::energy;
use crate::film::Potential;
use crate::half::HalfMeridian;
use crate::membrane::tensions;
use crate::plate;
use continuation::{EvalError, Name, literals};
use std::f64::consts::{FRAC_PI_2, PI};

/// Names of the observables, in the order of [`Observation::to_array`].
pub const NAMES: [&str; 11] = [
    "force",
    "pole_height",
    "gas_pressure",
    "volume",
    "energy_total",
    "energy_stretching",
    "energy_bending",
    "energy_film",
    "energy_gas",
    "energy_surface",
    "contact_radius",
];

/// The same, as a problem gives them.
pub(crate) static OBSERVABLES: [Name; NAMES.len()] = literals(NAMES);

/// What is reported of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// `F/√(χk_b)` on one plate, positive in compression.
    pub force: f64,
    /// `z(0)`, height of the pole above the equator, in `R0`.
    pub pole_height: f64,
    /// `P_G R0/χ`.
    pub gas_pressure: f64,
    /// Volume of the whole shell, in `R0³`.
    pub volume: f64,
    /// Sum of the energies below, in `χR0²`.
    pub energy_total: f64,
    /// Membrane energy.
    pub energy_stretching: f64,
    /// Bending energy.
    pub energy_bending: f64,
    /// Interaction with the plates.
    pub energy_film: f64,
    /// Compression of the gas; 0 at the rest volume.
    pub energy_gas: f64,
    /// Surface tension times the deformed area.
    pub energy_surface: f64,
    /// `σ` of the outermost point with `δ < δ_A`; NaN if there is none.
    pub contact_radius: f64,
}

impl Observation {
    /// The values in the order of [`NAMES`].
    pub fn to_array(&self) -> [f64; NAMES.len()] {
        [
            self.force,
            self.pole_height,
            self.gas_pressure,
            self.volume,
            self.energy_total,
            self.energy_stretching,
            self.energy_bending,
            self.energy_film,
            self.energy_gas,
            self.energy_surface,
            self.contact_radius,
        ]
    }
}

pub(crate) fn observe(
    problem: &ContactProblem,
    u: &[f64],
    p: &[f64],
) -> Result<Observation, EvalError> {
    let (c, gas) = problem.coefficients(u, p)?;
    let mesh = &problem.mesh;
    let law = c.material(problem.shell.law);
    let parts = energy::parts(mesh, u, &law, &problem.potential, &c)?;
    let whole = 4.0 * PI;
    let energies = [
        parts.stretching,
        parts.bending,
        parts.film,
        gas.energy(parts.volume),
        c.surface_tension * parts.area,
    ]
    .map(|e| whole * e);
    Ok(Observation {
        force: plate::force_factor(c.bending) * plate::pull(mesh, &problem.potential, u, &c)?,
        pole_height: 1.0 + mesh.displacement_in(u, 0, 0.0)[0].1,
        gas_pressure: gas.pressure(parts.volume),
        volume: whole * parts.volume,
        energy_total: energies.iter().sum(),
        energy_stretching: energies[0],
        energy_bending: energies[1],
        energy_film: energies[2],
        energy_gas: energies[3],
        energy_surface: energies[4],
        contact_radius: contact_radius(mesh, u, &c),
    })
}

/// `σ` where the film is `δ_A` high for the last time on the way from the pole.
pub(crate) fn contact_radius(mesh: &impl HalfMeridian, u: &[f64], c: &Coefficients) -> f64 {
    let knots = mesh.knots();
    let thin = |s: f64| c.plate - mesh.place(u, s).z[0] < c.film;
    let mut outside = FRAC_PI_2;
    if thin(outside) {
        return mesh.place(u, outside).s[0];
    }
    for e in (0..mesh.elements()).rev() {
        let (start, end) = (knots.at(e), knots.at(e + 1));
        if c.plate - (mesh.cos_knot(e) + mesh.local(u, e).w_bound()) >= c.film {
            outside = start; // thick everywhere in the element
            continue;
        }
        for quarter in (0..4).rev() {
            let s = start + 0.25 * f64::from(quarter) * (end - start);
            if thin(s) {
                let mut inside = s;
                for _ in 0..60 {
                    let middle = 0.5 * (inside + outside);
                    if thin(middle) {
                        inside = middle;
                    } else {
                        outside = middle;
                    }
                }
                return mesh.place(u, inside).s[0];
            }
            outside = s;
        }
    }
    f64::NAN
}

/// The deformed meridian with what acts on it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile {
    /// Reference angle `S` from the pole.
    pub angle: Vec<f64>,
    /// Distance from the axis `σ`.
    pub sigma: Vec<f64>,
    /// Height above the equator `z`.
    pub z: Vec<f64>,
    /// Film height `δ = z0 − z`.
    pub delta: Vec<f64>,
    /// Disjoining pressure `Π̂ = −w_int'(δ) σ_s δ_A/w0`, Eq. (17) in the scaling of Eq. (23):
    /// positive = repulsion, as in Fig. 3(b).
    pub disjoining_pressure: Vec<f64>,
    /// Meridional tension `τ_ss/χ` per deformed length, Eq. (8).
    pub tension_s: Vec<f64>,
    /// Hoop tension `τ_φφ/χ` per deformed length, Eq. (8).
    pub tension_phi: Vec<f64>,
}

impl Profile {
    /// A half at `samples ≥ 2` equally spaced reference angles, pole and equator included;
    /// `tensions` gives those of two stretches. The state is one that was found admissible.
    pub(crate) fn of<F: Potential>(
        half: &impl HalfMeridian,
        film: &F,
        u: &[f64],
        c: &Coefficients,
        samples: usize,
        tensions: impl Fn(f64, f64) -> (f64, f64),
    ) -> Profile {
        let samples = samples.max(2);
        let mut profile = Profile::default();
        for i in 0..samples {
            let angle = FRAC_PI_2 * i as f64 / (samples - 1) as f64;
            let place = half.place(u, angle);
            let ([s, s1, _], [z, z1, _]) = (place.s, place.z);
            let stretch_s = s1.hypot(z1);
            // at the pole both stretches are σ'
            let stretch_phi = if i == 0 { stretch_s } else { s / angle.sin() };
            let delta = c.plate - z;
            // per unit adhesion, so that Π̂ is defined without any
            let (_, d1) = film.by_adhesion(delta, c.adhesion, c.film);
            let (tau_s, tau_phi) = tensions(stretch_s, stretch_phi);
            profile.angle.push(angle);
            profile.sigma.push(s);
            profile.z.push(z);
            profile.delta.push(delta);
            profile.disjoining_pressure.push(-d1 * (s1 / stretch_s) * c.film);
            profile.tension_s.push(tau_s);
            profile.tension_phi.push(tau_phi);
        }
        profile
    }
}

impl ContactProblem {
    /// The meridian at `samples ≥ 2` equally spaced reference angles, pole and equator included.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn profile(&self, u: &[f64], p: &[f64], samples: usize) -> Result<Profile, EvalError> {
        let (c, _) = self.coefficients(u, p)?;
        energy::admissible(&self.mesh, u, self.potential.wall(&c))?;
        let law = c.material(self.shell.law);
        let tensions = |s, phi| tensions(&law, s, phi);
        Ok(Profile::of(&self.mesh, &self.potential, u, &c, samples, tensions))
    }
}
