//! `arclen fit --plan CASE`: what a lever, a range and a noise would identify of a shell.

use super::error::{Missing, PlanError};
use super::lab::{Lab, Wishes};
use crate::case::{ContactCase, Device, Law, ProblemCase, ResolvedCase, Stiffness};
use identify::Key;
use identify::plan::{Depth, Experiment, QUANTITIES, plan};
use serde_json::json;
use shell_contact::film::Film;
use std::fmt::Write as _;

/// Name of the file.
pub const PLAN: &str = "plan.json";
/// Depths that are compared.
const DEPTHS: usize = 10;
/// Samples of approach and of retract.
const SAMPLES: usize = 600;
/// Relative standard deviation that counts as known.
const KNOWN: f64 = 0.05;

/// A plan.
pub struct Plan {
    /// Name of the case.
    pub name: String,
    noise: f64,
    depths: Vec<Depth>,
}

/// Computes it.
///
/// # Errors
/// When the case has no lever or no units, and when something has to be known that is not.
pub fn planned(case: &ResolvedCase, lab: &Lab, wishes: Wishes<'_>) -> Result<Plan, PlanError> {
    let name = || case.name.clone();
    let ProblemCase::Contact(contact) = &case.problem else {
        return Err(PlanError::NotContact { case: name() });
    };
    if contact.device != Device::Grip {
        return Err(PlanError::Device { case: name() });
    }
    let noise = lab.noise.ok_or(Missing::Noise)?;
    let lab = with_case(lab, contact, &case.name)?;
    let law = contact.shell.law.name();
    Lab::allows(law, wishes)?;
    let setup = lab.setup(law, None, wishes)?;
    let reach = f64::from(setup.contacts) * setup.base[Key::Radius];
    let experiment = Experiment {
        before: (case.path.start - 1.0) * reach,
        deepest: case.path.end,
        setup,
        noise,
        samples: SAMPLES,
    };
    let depths =
        plan(&experiment, DEPTHS).map_err(|error| PlanError::Model { case: name(), error })?;
    Ok(Plan { name: name(), noise, depths })
}

/// The laboratory with the case's shell as the truth.
fn with_case(lab: &Lab, contact: &ContactCase, name: &str) -> Result<Lab, PlanError> {
    let case = || name.to_owned();
    let Some(physical) = &contact.physical else {
        return Err(PlanError::NotPhysical { case: case() });
    };
    if physical.potential != Film::FourTwo {
        return Err(PlanError::Potential { case: case() });
    }
    let mut lab = lab.clone();
    let poisson = contact.shell.poisson;
    let (chi, bending) = match &physical.stiffness {
        Stiffness::Homogeneous { young, thickness } => {
            let (e, h) = (young.si, thickness.si);
            (e * h, e * h * h * h / (12.0 * (1.0 - poisson * poisson)))
        }
        Stiffness::Moduli { chi, bending } => (chi.si, bending.si),
    };
    let values = [
        (Key::Chi, chi),
        (Key::Bending, bending),
        (Key::Radius, physical.radius.si),
        (Key::Pressure, physical.pressure.si),
        (Key::Adhesion, physical.adhesion.si),
        (Key::Film, physical.film.si),
        (Key::SurfaceTension, physical.surface_tension.si),
        (Key::GasExponent, physical.gas_exponent),
        (Key::Poisson, poisson),
    ];
    for (key, value) in values {
        lab.base[key] = value;
        // what is known with an error is known about this shell
        for prior in lab.priors.iter_mut().filter(|prior| prior.key == key) {
            prior.value = value;
        }
    }
    if let Law::MooneyRivlin { b } = contact.shell.law {
        lab.base[Key::MooneyB] = b;
    }
    Ok(lab)
}

impl Plan {
    /// The JSON.
    pub fn json(&self) -> Result<String, serde_json::Error> {
        let depths: Vec<serde_json::Value> = self
            .depths
            .iter()
            .map(|depth| {
                let sd: serde_json::Map<String, serde_json::Value> = QUANTITIES
                    .iter()
                    .zip(&depth.sd)
                    .map(|(quantity, sd)| (quantity.name().to_owned(), json!(sd)))
                    .collect();
                json!({
                    "deformation": depth.deformation,
                    "travel": depth.travel,
                    "force": depth.force,
                    "relative_sd": sd,
                })
            })
            .collect();
        let needed: serde_json::Map<String, serde_json::Value> = QUANTITIES
            .iter()
            .enumerate()
            .map(|(k, quantity)| (quantity.name().to_owned(), json!(self.needed(k))))
            .collect();
        let value = json!({
            "case": self.name,
            "noise": self.noise,
            "samples": SAMPLES,
            "depths": depths,
            "deformation_for_5_percent": needed,
        });
        serde_json::to_string_pretty(&value).map(|text| text + "\n")
    }

    /// The least deformation of those compared at which a quantity is known to 5 %.
    fn needed(&self, k: usize) -> Option<f64> {
        self.depths.iter().find(|depth| depth.sd[k] <= KNOWN).map(|depth| depth.deformation)
    }

    /// A table for people.
    pub fn summary(&self) -> String {
        let mut out = String::new();
        let _ = writeln!(
            out,
            "{}: relative standard deviations of a fit, by how deep the curve goes ({SAMPLES} + {SAMPLES} \
             samples, noise {:.3} nN)",
            self.name,
            1e9 * self.noise
        );
        let _ = write!(out, "{:>9} {:>9} {:>9}", "depth/R0", "nm", "nN");
        for quantity in QUANTITIES {
            let _ = write!(out, " {:>11}", quantity.name());
        }
        out.push('\n');
        for depth in &self.depths {
            let _ = write!(
                out,
                "{:>9.4} {:>9.1} {:>9.2}",
                depth.deformation,
                1e9 * depth.travel,
                1e9 * depth.force
            );
            for sd in &depth.sd {
                let text =
                    if *sd < 10.0 { format!("{:.2} %", 100.0 * sd) } else { "not".to_owned() };
                let _ = write!(out, " {text:>11}");
            }
            out.push('\n');
        }
        for (k, quantity) in QUANTITIES.iter().enumerate().take(2) {
            let _ = match self.needed(k) {
                Some(depth) => writeln!(
                    out,
                    "{} is known to 5 % from a deformation of {depth:.3} R0 on",
                    quantity.name()
                ),
                None => writeln!(out, "{} is not known to 5 % at any of these", quantity.name()),
            };
        }
        out
    }
}
