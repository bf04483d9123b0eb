//! Shells that buckle: adhesive and hard, measured by an instrument that jumps where its lever does.

use crate::common::{Normal, heights, parameters};
use identify::branch::Effort;
use identify::data::{Curve, Direction};
use identify::fit::{Setup, objective::Prior};
use identify::lever::Reading;
use identify::model::Model;
use identify::{Key, LawName, Parameters, Profiles, identify};

/// What an instrument reads that follows each stretch to its end: jumps are where the lever jumps, not where data
/// say so.
pub(crate) fn measure(curve: &mut Curve, model: &Model, p: &Parameters, noise: f64, seed: u64) {
    let mut normal = Normal(seed);
    let (branch, _) = model.branch(curve, p, &[]).unwrap();
    let stretches = &branch.stretches;
    let farthest = curve.farthest();
    let (mut at, mut reading) = (0, Reading::default());
    for segment in &mut curve.segments {
        for (height, force) in segment.height.iter().zip(&mut segment.force) {
            let travel = p[Key::Contact] - height;
            match segment.direction {
                Direction::Approach => {
                    while at + 1 < stretches.len() && travel > stretches[at].to {
                        at += 1;
                    }
                }
                Direction::Retract => {
                    while at > 0 && travel < stretches[at].from {
                        at -= 1;
                    }
                }
            }
            branch.read(&stretches[at], travel, &[], &mut reading);
            let baseline = p[Key::Offset] + p[Key::Tilt] * (farthest - height);
            *force = reading.force + baseline + noise * normal.next();
        }
    }
}

/// A measurement of such a shell, and what is known of it.
pub(crate) struct Buckled {
    pub(crate) curve: Curve,
    pub(crate) setup: Setup,
    pub(crate) truth: Parameters,
    /// Largest jump of the force on the way in, N.
    pub(crate) jump: f64,
}

/// Least jump of one that buckles, N.
const LEAST_JUMP: f64 = 1.5e-7;
/// The largest: a laboratory would take a stiffer lever.
const MOST_JUMP: f64 = 3e-6;

/// The shell of a seed; `None` where it does not buckle, does not snap off, or needs a finer mesh than a test has.
///
/// Drawn are the radius (1 to 2.5 µm), Young's modulus (1 to 4 GPa), the thickness (1 to 2.5 % of the radius), the
/// adhesion (7e-4 to 5e-3 of the stretching modulus), the film's length (2 to 5 % of the radius), the lever, the
/// deformation at the end (20 to 35 %), the noise (0.15 to 1.5 nN), the optical radius with an error of 3 %, and the
/// baseline.
pub(crate) fn draw(seed: u64) -> Option<Buckled> {
    let mut normal = Normal(seed.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(11));
    let mut between = |low: f64, high: f64| low * (high / low).powf(normal.uniform());
    let radius = between(1e-6, 2.5e-6);
    let young = between(1e9, 4e9);
    let thickness = radius * between(0.01, 0.025);
    let chi = young * thickness;
    let bending = young * thickness.powi(3) / (12.0 * 0.75);
    let adhesion = chi * between(7e-4, 5e-3);
    let film = radius * between(0.02, 0.05);
    let lever = (chi * bending).sqrt() / (2.0 * radius) * between(40.0, 300.0);
    let depth = between(0.2, 0.35);
    let noise = between(1.5e-10, 1.5e-9);
    let mut truth = parameters([chi, bending, adhesion, film, radius, lever, 6e-6]);
    truth[Key::Offset] = 3e-9 * normal.next();
    truth[Key::Tilt] = 1e-3 * normal.next();
    let optical = radius * (0.03 * normal.next()).exp();
    let effort = Effort {
        elements: 240,
        points: 2000,
        force_error: 1e-3 * noise,
        work: f64::INFINITY,
        max_angle: Effort::ANGLE,
    };
    let model = Model { law: LawName::Hooke, contacts: 2, nominal_spring_constant: lever, effort };
    // as deep as was drawn; as far out as it takes to come off
    let (branch, resolution) =
        model.branch_over((-radius, 2.0 * radius * depth), &truth, &[]).ok()?;
    let deepest = branch.nodes().iter().find(|node| node.z < 1.0 - depth)?;
    let travel = branch.travel(deepest.z, deepest.force);
    let outwards = branch.stretches.get(1).map(|stretch| -stretch.from)?;
    if !resolution.is_enough() || outwards > 0.8 * radius {
        return None;
    }
    let farthest = (1.5 * outwards).max(5.0 * film).max(0.2 * radius) + 0.3 * travel;
    let mut curve = heights(6e-6 + farthest, 6e-6 - travel, 600);
    measure(&mut curve, &model, &truth, noise, seed);
    let force = &curve.segments[0].force;
    let jump = force.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    if !(LEAST_JUMP..MOST_JUMP).contains(&jump) {
        return None;
    }
    let mut base = Parameters::default();
    base[Key::SpringConstant] = lever;
    base[Key::Radius] = optical;
    let prior = Prior { key: Key::Radius, value: optical, sd: 0.03 * optical };
    let mut setup = Setup::new(LawName::Hooke, base, vec![prior]);
    setup.spring_constant_sd = 0.0;
    Some(Buckled { curve, setup, truth, jump })
}

impl Buckled {
    /// Whether generic starts end where a start at the truth does, or lower.
    pub(crate) fn is_found(&self, seed: u64) -> bool {
        let chi2 = |setup: &Setup| {
            let fit = identify(&self.curve, setup, &Profiles::None);
            fit.map_or(f64::INFINITY, |found| found.report.quality.chi2_dof)
        };
        let told = Setup { start: Some(self.truth), ..self.setup.clone() };
        // a branch that exceeds its budget at the truth: the noise alone
        let least = chi2(&told).min(2.0);
        let chi2 = chi2(&self.setup);
        let found = chi2 < 1.02 * least + 0.01;
        println!(
            "{seed}: chi2/dof {chi2:.3}, {least:.3} from the truth; jump {:.0} nN{}",
            1e9 * self.jump,
            if found { "" } else { ": missed" }
        );
        found
    }
}
