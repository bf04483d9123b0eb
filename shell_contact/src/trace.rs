//! The main job: the branch of a shell between approaching plates, with its special points.

use crate::contact::ContactProblem;
use continuation::{Branch, EventKind, Progress, Settings, TraceError, Tracer, Watch};
use std::ops::ControlFlow;

/// Name of the special point of most attractive force.
pub const PULL_OFF: &str = "pull-off";

/// A traced contact branch.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactBranch {
    /// Points and special points.
    pub branch: Branch,
    /// Plate distance at the first zero of the force on approach, from which deformation counts.
    pub zero_force: Option<f64>,
}

impl ContactBranch {
    /// A branch that was traced with [`force_watches`], in `z0` or in the parameter of a device; `zero_force` is where deformation counts
    /// from, by default the branch's own first zero of the force.
    pub fn new(mut branch: Branch, zero_force: Option<f64>) -> Self {
        name_pull_off(&mut branch);
        let zero = EventKind::Zero("force".to_owned());
        let height = branch.observables.iter().position(|name| name == "z0");
        let own = branch.events_of(&zero).next().map(|event| match height {
            Some(k) => branch.points[event.point].observables[k],
            None => event.p,
        });
        ContactBranch { zero_force: zero_force.or(own), branch }
    }

    /// Deformation `d̂ = ẑ0(F = 0) − ẑ0`, Eq. (19): plate against equator, one pole.
    pub fn deformation(&self, z0: f64) -> Option<f64> {
        self.zero_force.map(|zero| zero - z0)
    }
}

/// Traces the branch that starts at the free shell with the plates at `start`; `settings` says
/// where it ends. Zeros and extrema of the force are located; the lowest interior minimum below
/// zero is the pull-off.
///
/// # Errors
/// When the start is unusable; a branch that ends early is a result.
pub fn trace_contact(
    problem: &ContactProblem,
    start: f64,
    settings: Settings,
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<ContactBranch, TraceError> {
    let (u, p) = (problem.initial_state(), problem.parameters_at(start));
    let tracer = Tracer::new(problem, "z0", &u, &p, settings)?.watching(&force_watches())?;
    Ok(ContactBranch::new(tracer.run(observer), None))
}

/// What is watched on a contact branch: zeros and extrema of the force.
pub fn force_watches() -> [Watch; 2] {
    [Watch::zero("force"), Watch::extremum("force")]
}

/// Renames the lowest minimum of the force below zero.
fn name_pull_off(branch: &mut Branch) {
    let force = branch.observables.iter().position(|name| name == "force");
    let Some(force) = force else { return };
    let minimum = EventKind::Minimum("force".to_owned());
    let value = |k: usize| branch.points[branch.events[k].point].observables[force];
    let lowest = (0..branch.events.len())
        .filter(|&k| branch.events[k].kind == minimum && value(k) < 0.0)
        .min_by(|&a, &b| value(a).total_cmp(&value(b)));
    if let Some(k) = lowest {
        branch.events[k].kind = EventKind::Named(PULL_OFF.to_owned());
    }
}
