//! What a measurement would identify, before it is made: the Fisher information of the model.
//!
//! The covariance is that of the linearised problem at the truth, with priors and the lever's error, for curves
//! that end deeper and deeper. It says what is possible at best; a fit's profiles say what was.

use crate::attend::Attended;
use crate::branch::Effort;
use crate::data::{Curve, Direction, Segment};
use crate::error::ModelError;
use crate::fit::Setup;
use crate::fit::objective::Objective;
use crate::lever::LeverBranch;
use crate::model::{Model, Prediction};
use crate::parameters::Key;
use crate::uncertainty::{Derived, Quantity, inverse};
use serde::Serialize;

/// A measurement that is planned.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// Law, lever, priors, and the shell as it is thought to be.
    pub setup: Setup,
    /// Standard deviation of the force's noise, N.
    pub noise: f64,
    /// Samples of approach and of retract.
    pub samples: usize,
    /// Travel of the piezo before the contact point, m.
    pub before: f64,
    /// Least height of the plate above the equator, in `R0`.
    pub deepest: f64,
}

/// What a curve to one depth would identify.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Depth {
    /// Approach of one pole beyond the free radius, in R0.
    pub deformation: f64,
    /// Travel of the piezo beyond the contact point, m.
    pub travel: f64,
    /// Largest force, N.
    pub force: f64,
    /// Relative standard deviations, in the order of [`QUANTITIES`].
    pub sd: Vec<f64>,
}

/// What is reported.
pub const QUANTITIES: [Quantity; 8] = [
    Quantity::Derived(Derived::Young),
    Quantity::Derived(Derived::Thickness),
    Quantity::Derived(Derived::ForceScale),
    Quantity::Key(Key::Chi),
    Quantity::Key(Key::Bending),
    Quantity::Key(Key::Adhesion),
    Quantity::Key(Key::Film),
    Quantity::Key(Key::Radius),
];

/// Elements of the mesh.
const ELEMENTS: usize = 160;
/// Points of the branch at most.
const POINTS: usize = 800;

/// Computes what curves to `depths` depths, evenly spaced, would identify.
///
/// # Errors
/// When the shell's parameters are impossible or its branch ends before the deepest height.
pub fn plan(experiment: &Experiment, depths: usize) -> Result<Vec<Depth>, ModelError> {
    let setup = &experiment.setup.with_lever();
    let mut p = setup.base;
    p[Key::Contact] = 0.0;
    let model = Model {
        law: setup.law,
        contacts: setup.contacts,
        nominal_spring_constant: p[Key::SpringConstant],
        effort: Effort {
            elements: ELEMENTS,
            points: POINTS,
            force_error: 0.01 * experiment.noise,
            work: f64::INFINITY,
            max_angle: Effort::ANGLE,
        },
    };
    let reach = f64::from(setup.contacts) * p[Key::Radius];
    // the lever bends too: far enough for the deepest height, cut where that is
    let keys = &setup.free;
    let stiff = (1.0 - experiment.deepest) * reach;
    let mut range = (-experiment.before, 1.5 * stiff);
    let branch = loop {
        match model.branch_over(range, &p, keys) {
            Ok((branch, _)) => break branch,
            Err(ModelError::TooShort { reached, .. } | ModelError::TooDear { reached, .. })
                if reached < range.1 && reached > 0.2 * stiff =>
            {
                range.1 = 0.97 * reached;
            }
            Err(error) => return Err(error),
        }
    };
    let deepest = branch.nodes().iter().filter(|n| n.z >= experiment.deepest);
    let most = deepest.map(|n| branch.travel(n.z, n.force)).fold(0.0, f64::max).min(range.1);
    let mut found = Vec::new();
    for k in 1..=depths {
        let travel = most * k as f64 / depths as f64;
        let curve = measure(experiment, &branch, travel);
        let prediction = model.predict(&curve, &branch, &p, keys, 1.0 / experiment.noise);
        let deformation = prediction
            .height
            .iter()
            .fold(0.0_f64, |d, z| if z.is_finite() { d.max(1.0 - z) } else { d });
        let force = prediction.force.iter().fold(0.0_f64, |m, f| m.max(*f));
        let sd = information(setup, experiment.noise, &curve, model, prediction);
        found.push(Depth { deformation, travel, force, sd });
    }
    Ok(found)
}

/// Heights of a curve that ends at a travel, with the forces that an approach and a retract would read.
fn measure(experiment: &Experiment, branch: &LeverBranch, travel: f64) -> Curve {
    let n = experiment.samples.max(8);
    let step = (travel + experiment.before) / (n - 1) as f64;
    let down: Vec<f64> = (0..n).map(|i| experiment.before - step * i as f64).collect();
    let up: Vec<f64> = down.iter().rev().copied().collect();
    let mut at = 0;
    let mut segments = Vec::new();
    for (direction, height) in [(Direction::Approach, down), (Direction::Retract, up)] {
        let mut force = Vec::with_capacity(n);
        let mut reading = crate::lever::Reading::default();
        for h in &height {
            let x = -h;
            while direction == Direction::Approach
                && at + 1 < branch.stretches.len()
                && x > branch.stretches[at].to
            {
                at += 1;
            }
            while direction == Direction::Retract && at > 0 && x < branch.stretches[at].from {
                at -= 1;
            }
            branch.read(&branch.stretches[at], x, &[], &mut reading);
            force.push(reading.force);
        }
        segments.push(Segment { direction, height, force });
    }
    Curve { name: "plan".to_owned(), segments, ..Curve::default() }
}

/// Relative standard deviations from the Fisher information.
fn information(
    setup: &Setup,
    noise: f64,
    curve: &Curve,
    model: Model,
    prediction: Prediction,
) -> Vec<f64> {
    let keys = &setup.free;
    let used = (0..prediction.beyond.len()).map(|i| {
        let jump =
            |j: usize| prediction.stretch.get(j).is_some_and(|s| *s != prediction.stretch[i]);
        prediction.beyond[i] == 0.0 && !jump(i + 1) && !jump(i.wrapping_sub(1))
    });
    let objective = Objective {
        curve,
        used: used.collect(),
        noise,
        widened: 1.0,
        model,
        base: setup.base,
        free: keys.clone(),
        priors: setup.priors.clone(),
        derived: setup.derived.clone(),
        attended: Attended::default(),
        bounds: vec![(f64::NEG_INFINITY, f64::INFINITY); keys.len()],
        robust: false,
        guide: None,
    };
    let mut at = objective.sum(prediction);
    objective.add_priors(&objective.place(&setup.base), &mut at);
    let every: Vec<usize> = (0..keys.len()).collect();
    let (covariance, _) = inverse(&at.normal, &every);
    QUANTITIES
        .into_iter()
        .map(|quantity| {
            let along = quantity.along(keys);
            along.map_or(0.0, |a| a.dot(&(&covariance * &a)).max(0.0).sqrt())
        })
        .collect()
}
