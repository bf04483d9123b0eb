//! Where a cycle starts: a stable state at given values of a device's parameter.

use super::flow::{MotionError, Relaxation, RelaxationSettings};
use super::{Device, DeviceError, LoadedProblem, Loading};
use crate::contact::ContactProblem;
use crate::trace::{ContactBranch, force_watches};
use continuation::{
    Matrix, NewtonSettings, Problem, Progress, Settings, Stop, StopReason, TraceError, Tracer,
    Watch, newton,
};
use std::ops::ControlFlow;

/// Why there is no stable state to start from.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// The device is impossible.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The shell far from the plates has no state.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The motion from the shell at rest did not come to an end.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// No stable state has this value of the parameter.
    #[error(
        "no stable state has {name} = {value}; stable states seen from the free shell on have \
         {name} from {low:.6} to {high:.6}"
    )]
    NoState {
        /// Name of the parameter.
        name: &'static str,
        /// The value asked for.
        value: f64,
        /// Smallest value on a stable state.
        low: f64,
        /// Largest one.
        high: f64,
    },
}

/// The free shell between plates at `z0`: the state that Newton's method finds from the sphere at
/// rest, or if that is unstable or none, the one to which the sphere at rest moves.
///
/// # Errors
/// When there is none.
pub fn free_start(contact: &ContactProblem, z0: f64) -> Result<Vec<f64>, StartError> {
    let (mut u, p) = (contact.initial_state(), contact.parameters_at(z0));
    if newton(contact, &mut u, &p, &NewtonSettings::default()).is_ok() {
        let mut hessian = contact.new_jacobian();
        if contact.jacobian(&u, &p, &mut hessian).is_ok() {
            let floor = f64::EPSILON * hessian.norm();
            if hessian.factor(floor).inertia.is_some_and(|(negative, _)| negative == 0) {
                return Ok(u);
            }
        }
    }
    let mut relaxation = Relaxation::new(contact, RelaxationSettings::default());
    relaxation.from_state(contact, &contact.initial_state(), &p)?;
    Ok(relaxation.state().to_vec())
}

/// Traces the branch under a device in the device's own parameter, from [`loaded_start`] on;
/// `settings` says where it ends, and that of a dead load ends where the plate is far away.
///
/// # Errors
/// When there is no start; a branch that ends early is a result.
pub fn trace_loaded(
    loaded: &LoadedProblem<'_>,
    start: f64,
    settings: Settings,
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<ContactBranch, StartError> {
    let (x, p) = (loaded_start(loaded, start)?, loaded.parameters_at(start));
    let device = loaded.device();
    let (target, settings) = (settings.target, device_settings(device, settings));
    let mut watches = device_watches(device).to_vec();
    if device == Device::DeadLoad {
        watches.push(Watch::stop_at("z0", AWAY));
    }
    let tracer =
        Tracer::new(loaded, device.parameter_name(), &x, &p, settings)?.watching(&watches)?;
    let mut branch = tracer.run(observer);
    let met = branch.points.last().is_some_and(|last| Some(last.p) == target);
    if branch.stopped.reason == StopReason::Target && !met {
        let detail = "the plate is far away: no force holds it there".to_owned();
        branch.stopped = Stop { reason: StopReason::Domain, detail };
    }
    Ok(ContactBranch::new(branch, None))
}

/// Shortest step under a device, in `R0`.
const SHORTEST: f64 = 1e-10;

/// Settings without a shortest step get one that is fit for the folds of a device: where the force
/// falls steeply behind its maximum they are needles, far thinner than those of a grip.
pub(crate) fn device_settings(device: Device, settings: Settings) -> Settings {
    if device == Device::Grip || settings.min_step.is_some() {
        return settings;
    }
    let min_step = Some(settings.max_step.map_or(SHORTEST, |max| max.min(SHORTEST)));
    Settings { min_step, ..settings }
}

/// What is watched under a device: zeros and extrema of the force; under a dead load its extrema are
/// the folds, and those of the plate's height are watched.
pub fn device_watches(device: Device) -> [Watch; 2] {
    match device {
        Device::DeadLoad => [Watch::zero("force"), Watch::extremum("z0")],
        _ => force_watches(),
    }
}

/// Where the branch under a dead load ends, which goes on for ever, in `R0`.
const AWAY: f64 = 10.0;
/// How far from the equator the plates are where a shell counts as free, in `R0`.
const FAR: f64 = 5.0;
/// Step of the search, in `R0`.
const STEP: f64 = 0.05;
/// Plates nearer than this are not looked at.
const NEAREST: f64 = 0.02;

/// The first stable state under a device, on the branch that comes from the free shell far away,
/// that has this value of the device's parameter; the shell's unknowns and the plate's height.
///
/// # Errors
/// When there is none.
pub fn loaded_start(loaded: &LoadedProblem<'_>, value: f64) -> Result<Vec<f64>, StartError> {
    let (contact, device) = (loaded.contact(), loaded.device());
    let far = match device {
        Device::Cantilever { .. } => FAR.max(2.0 * value),
        _ => FAR,
    };
    let (u, p) = (free_start(contact, far)?, contact.parameters_at(far));
    let settings = Settings { target: Some(NEAREST), max_step: Some(STEP), ..Settings::default() };
    let mut tracer = Tracer::new(contact, "z0", &u, &p, settings)?;
    let mut hessian = loaded.new_jacobian();
    let at = loaded.parameters_at(value);
    let mut stable = |x: &[f64]| {
        let seen = loaded.jacobian(x, &at, &mut hessian);
        let floor = f64::EPSILON * hessian.norm();
        let inertia = seen.ok().and_then(|()| hessian.factor(floor).inertia);
        inertia.is_some_and(|(negative, _)| negative == 0)
    };
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut before: Option<(Vec<f64>, f64)> = None;
    for point in tracer.by_ref() {
        let x = loaded.state(&point.u, point.p);
        let here = device.parameter(point.p, point.observables[0]);
        if stable(&x) {
            (low, high) = (low.min(here), high.max(here));
        }
        if let Some((x0, there)) = before.replace((x, here))
            && (there - value) * (here - value) <= 0.0
            && let Some((x1, _)) = &before
        {
            let share = if here == there { 0.0 } else { (value - there) / (here - there) };
            let mut x: Vec<f64> = x0.iter().zip(x1).map(|(a, b)| a + share * (b - a)).collect();
            let far = 2.0 * (x1[u.len()] - x0[u.len()]).abs() + 1e-9;
            let middle = x[u.len()];
            if newton(loaded, &mut x, &at, &NewtonSettings::default()).is_ok()
                && (x[u.len()] - middle).abs() <= far
                && stable(&x)
            {
                return Ok(x);
            }
        }
    }
    Err(StartError::NoState { name: device.parameter_name(), value, low, high })
}
