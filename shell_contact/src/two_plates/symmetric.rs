//! The mirror-symmetric branch of a shell between two equal plates, traced on half the shell.
//!
//! Where nothing tells up from down the equations leave mirror images mirror images, and the Hessian at
//! one splits: into the half model's for even variations and `K_anti` for odd ones
//! ([`crate::modes`]). So the branch that begins at the sphere is that of the half model. It is traced
//! there, where no odd mode disturbs it: a fold and the loss of symmetry beside it, which may be 1e-10
//! apart, are found apart, and a point costs half as much. Its states are lifted to the whole
//! meridian; the number of unstable modes is the sum of both counts; and where the odd one changes lies
//! a pitchfork, by symmetry.
//!
//! An upper plate on a spring keeps the symmetry about the plane between the plates if the shell is free
//! to follow it: it is then half a shell on a spring twice as stiff. Held at its equator it does not.

use super::fork::odd_mode;
use super::{SupportedProblem, TwoPlatesProblem, parameter};
use crate::contact::ContactProblem;
use crate::device::{Device, LoadedProblem, Loading, device_settings};
use crate::modes::{
    AsymmetricModes, Parity, Scan, ScanSettings, Scanned, SymmetryBreaking, WholeShell, scan_branch,
};
use crate::params::Dimensionless;
use crate::trace::force_watches;
use continuation::linalg::Bordered;
use continuation::{
    Branch, Criticality, Crossing, Detail, Direction, Doubt, Eigenvector, EvalError, Event,
    EventKind, Point, Problem, Progress, Settings, Shape, Stop, StopReason, TraceError, Tracer,
};
use std::ops::ControlFlow;

/// Half of a whole shell whose states may be mirror images.
#[derive(Debug, Clone)]
pub struct MirrorHalf {
    /// The half.
    pub shell: ContactProblem,
    /// What holds its plate.
    pub device: Device,
}

/// A branch of mirror images from pole to pole.
#[derive(Debug, Clone)]
pub struct SymmetricBranch {
    /// The branch, in the parameter of the whole problem. Arclengths are those of the half.
    pub branch: Branch,
    /// What is unstable with waves about each of its points, and where that changes; of modes without
    /// waves the branch has its own counts. Empty unless it was asked for.
    pub waves: Scanned,
}

/// Amplitudes along the odd mode, in `R0`, at which the bend of a pitchfork is measured, from the first
/// by a factor to the last: at large ones the next power disturbs it, at small ones the error of the
/// point, 1e-10, divided by the square. Beside a sharp fold only the smallest ones have states.
const LARGEST_AMPLITUDE: f64 = 1e-2;
const SMALLEST_AMPLITUDE: f64 = 1e-6;
const SHRINK: f64 = 0.4;
/// A bend with a smaller error, relative, is good enough.
const GOOD: f64 = 1e-3;
/// A plate distance is known to a few roundings, and a spring's base to what they do to the force.
const ROUNDED: f64 = 1.0 + 4.0 * f64::EPSILON;
/// Newton steps to a state at an amplitude.
const STEPS: usize = 10;
/// A step, in `R0`, that is rounding.
const CONVERGED: f64 = 1e-11;
/// A bend is known if it is this many times its error.
const KNOWN: f64 = 4.0;

/// Traces the branch of mirror images that begins at the sphere between plates at `start`, as
/// [`Tracer`] would trace `problem`: with zeros and extrema of the force, to where `settings` say.
/// `None` where the two plates differ, a support tells up from down, or the start is refused. With `scan`, modes with waves are
/// counted and located too.
///
/// # Errors
/// When there is no first point; a branch that ends early is a result.
pub fn trace_symmetric<P: WholeShell>(
    problem: &P,
    start: f64,
    settings: Settings,
    scan: Option<ScanSettings>,
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Option<Result<SymmetricBranch, TraceError>> {
    let MirrorHalf { shell, device } = problem.mirror_half()?;
    // what the whole refuses at the start, as plates that cross, it says better itself
    let rest = problem.joined_images(&shell.initial_state(), start, start);
    problem.residual(&rest, &problem.parameters_at(start), &mut vec![0.0; problem.dim()]).ok()?;
    let settings = device_settings(device, settings);
    let traced = match device {
        Device::Grip => {
            let (u, p) = (shell.initial_state(), shell.parameters_at(start));
            run(&shell, "z0", &u, &p, settings, observer)
        }
        _ => {
            let loaded = LoadedProblem::new(&shell, device).ok()?;
            let (x, p) = (loaded.state(&shell.initial_state(), start), loaded.parameters_at(start));
            run(&loaded, device.parameter_name(), &x, &p, settings, observer)
        }
    };
    let half = match traced {
        Ok(half) => half,
        Err(error) => return Some(Err(error)),
    };
    // states of the half are states of the whole; were one refused, the whole would be traced itself
    Lift { problem, shell: &shell, device }.branch(half, scan, observer).ok().map(Ok)
}

fn run<P: Problem>(
    problem: &P,
    name: &str,
    u: &[f64],
    p: &[f64],
    settings: Settings,
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Branch, TraceError> {
    Ok(Tracer::new(problem, name, u, p, settings)?.watching(&force_watches())?.run(observer))
}

impl TwoPlatesProblem {
    /// The half model of which mirror images are states, between plates that are alike.
    pub(crate) fn half_shell(&self) -> Option<ContactProblem> {
        let g = self.groups();
        // without a film the shell floats: nothing says where its mirror is
        if !self.plates_are_alike() || g.top.adhesion <= 0.0 {
            return None;
        }
        let groups = Dimensionless {
            bending: g.bending,
            pressure: g.pressure,
            adhesion: g.top.adhesion,
            film: g.top.film,
            surface_tension: g.surface_tension,
            gas_exponent: g.gas_exponent,
        };
        let film = self.potentials.0;
        ContactProblem::with_potential(self.shell(), &groups, self.mesh().clone(), film).ok()
    }
}

impl SupportedProblem<'_> {
    /// What is left of the symmetry with a support.
    pub(crate) fn mirror_half_of(&self) -> Option<MirrorHalf> {
        let support = self.support();
        if support.held {
            return None;
        }
        let device = match support.spring {
            Some(stiffness) => Device::Cantilever { stiffness: 2.0 * stiffness },
            None => Device::Grip,
        };
        Some(MirrorHalf { shell: self.shell().half_shell()?, device })
    }
}

/// States of a half as those of the whole.
struct Lift<'p, P> {
    problem: &'p P,
    shell: &'p ContactProblem,
    device: Device,
}

impl<P: WholeShell> Lift<'_, P> {
    /// A state of half the shell under a plate at `z0`, at a value of the device's parameter.
    fn state(&self, u: &[f64], z0: f64, parameter: f64) -> Vec<f64> {
        self.problem.joined_images(u, z0, parameter)
    }

    /// The device's parameter at a state.
    fn parameter(&self, u: &[f64], z0: f64) -> Result<f64, EvalError> {
        if self.device == Device::Grip {
            return Ok(z0);
        }
        let force = self.shell.mean_force(u, &self.shell.parameters_at(z0))?;
        Ok(self.device.parameter(z0, force))
    }

    fn observed(&self, x: &[f64], parameter: f64) -> Result<Vec<f64>, EvalError> {
        let mut out = vec![f64::NAN; self.problem.observables().len()];
        self.problem.observe(x, &self.problem.parameters_at(parameter), &mut out)?;
        Ok(out)
    }

    /// Lifts a branch of the half, with a pitchfork wherever an odd mode turns.
    fn branch(
        &self,
        half: Branch,
        scan: Option<ScanSettings>,
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<SymmetricBranch, EvalError> {
        let height = half.observables.iter().position(|name| name == "z0");
        let plate = |point: &Point| height.map_or(point.p, |k| point.observables[k]);
        // odd modes always: they are the whole problem's own
        let settings =
            ScanSettings { max_n: scan.map_or(0, |scan| scan.max_n), ..scan.unwrap_or_default() };
        let points = &half.points;
        let mut told = |done: usize| match points.get(done.saturating_sub(1)) {
            Some(point) => observer(&Progress {
                points: points.len(),
                events: half.events.len(),
                p: point.p,
                s: point.s,
            }),
            None => ControlFlow::Continue(()),
        };
        let mut stopped = half.stopped.clone();
        let counted = match stopped.reason {
            StopReason::Interrupted => None,
            _ => Some(scan_branch(self.shell, &half, &settings, &mut told)?),
        };
        let scanned = match counted {
            Some(scanned) if scanned.points.len() == points.len() => scanned,
            // somebody ended the work: the branch keeps its points, with what they count themselves
            counted => {
                if counted.is_some() {
                    let detail = "interrupted while modes were counted".to_owned();
                    stopped = Stop { reason: StopReason::Interrupted, detail };
                }
                let own = ScanSettings { max_n: 0, ..settings };
                scan_branch(self.shell, &half, &own, &mut |_| ControlFlow::Continue(()))?
            }
        };
        let mut modes = AsymmetricModes::new(self.shell.mesh());
        let mut out = Branch {
            parameters: self.problem.parameters_at(half.parameters[0]),
            observables: self.problem.observables().iter().map(ToString::to_string).collect(),
            points: Vec::with_capacity(points.len()),
            events: Vec::with_capacity(half.events.len()),
            doubts: half.doubts.clone(),
            began: half.began.clone(),
            stopped,
            statistics: half.statistics,
            parameter: half.parameter.clone(),
        };
        let mut waves = Scanned::default();
        let mut found = scanned.events.iter().peekable();
        for (index, point) in points.iter().enumerate() {
            let Some(own) = scanned.points.get(index) else { break };
            let (u, z0) = (&point.u[..self.shell.dim()], plate(point));
            let x = self.state(u, z0, point.p);
            let event = point.event.map(|event| {
                let event = &half.events[event];
                let and = |even: Option<usize>| even.map(|even| even + own.antisymmetric);
                out.events.push(Event {
                    point: out.points.len(),
                    unstable_before: and(event.unstable_before),
                    unstable_after: and(event.unstable_after),
                    eigenvectors: event.eigenvectors.iter().map(|v| self.eigenvector(v)).collect(),
                    ..event.clone()
                });
                out.events.len() - 1
            });
            out.points.push(Point {
                unstable: point.unstable.map(|even| even + own.antisymmetric),
                certified: point.certified && own.antisymmetric_certain,
                eigenvalues: Vec::new(),
                observables: self.observed(&x, point.p)?,
                event,
                u: x,
                ..point.clone()
            });
            waves.points.push(of_waves(own.clone()));
            let here: Vec<&SymmetryBreaking> =
                std::iter::from_fn(|| found.next_if(|one| one.after_point == index)).collect();
            let Some(next) = points.get(index + 1) else { continue };
            let mut from = 0.0;
            for (k, one) in here.iter().enumerate() {
                let parameter = self.parameter(&one.u, one.z0)?;
                let state = self.state(&one.u, one.z0, parameter);
                // of the place in the device's parameter, which may be the faster one
                let other = self.parameter(&one.other_end.0, one.other_end.1)?;
                let rounding = self.parameter(&one.u, one.z0 * ROUNDED)? - parameter;
                let width = one.error_estimate.max((parameter - other).abs());
                let error_estimate = width + rounding.abs();
                if one.n > 0 {
                    // shares are those of the way to the next point that the whole has
                    let to = here[k..].iter().find(|other| other.n == 0).map_or(1.0, |o| o.share);
                    let share = if to > from { (one.share - from) / (to - from) } else { 0.0 };
                    waves.events.push(SymmetryBreaking {
                        after_point: out.points.len() - 1,
                        share,
                        z0: parameter,
                        u: state,
                        error_estimate,
                        mode_shape: one
                            .mode_shape
                            .mirrored(one.parity.unwrap_or(Parity::Symmetric)),
                        ..(*one).clone()
                    });
                    continue;
                }
                from = one.share;
                modes.assemble(self.shell, &one.u, &self.shell.parameters_at(one.z0))?;
                waves.points.push(of_waves(modes.scan(settings.max_n)));
                let (even, certified) = even_between(&half, [point, next]);
                let (s, dp_ds) = (
                    point.s + one.share * (next.s - point.s),
                    point.dp_ds + one.share * (next.dp_ds - point.dp_ds),
                );
                let place = (&state[..], parameter, error_estimate);
                let crossing = self.pitchfork(one, [point, next], place)?;
                out.events.push(Event {
                    kind: EventKind::BranchPoint,
                    point: out.points.len(),
                    p: parameter,
                    unstable_before: even.map(|even| even + one.modes_before),
                    unstable_after: even.map(|even| even + one.modes_after),
                    residual: self.residual(&state, parameter)?,
                    error_estimate,
                    detail: Detail::Crossing(crossing),
                    eigenvectors: Vec::new(),
                });
                out.points.push(Point {
                    s,
                    p: parameter,
                    dp_ds,
                    // the state is marginal
                    unstable: even.map(|even| even + one.modes_before.min(one.modes_after)),
                    certified,
                    eigenvalues: Vec::new(),
                    observables: self.observed(&state, parameter)?,
                    event: Some(out.events.len() - 1),
                    u: state,
                });
            }
        }
        for (index, n, parity) in scanned.missed {
            if n > 0 {
                let after = out.points.partition_point(|point| point.s <= points[index].s);
                waves.missed.push((after.saturating_sub(1), n, parity));
                continue;
            }
            let at = |k: usize| points.get(k).map_or(f64::NAN, |point| point.p);
            out.doubts.push(Doubt {
                from: at(index),
                to: at(index + 1),
                reason:
                    "the mirror symmetry is lost or regained here, at a place that was not found"
                        .to_owned(),
            });
        }
        if scan.is_none() {
            waves = Scanned::default();
        }
        Ok(SymmetricBranch { branch: out, waves })
    }

    /// A critical vector of the half as one of the whole, of Euclidean length 1.
    fn eigenvector(&self, half: &Eigenvector) -> Eigenvector {
        let lifted = |v: &[f64]| -> Vec<f64> {
            // states are lifted by a linear map, the plate's height among them
            let (u, plate) = v.split_at(self.shell.dim().min(v.len()));
            let whole = self.state(u, plate.first().copied().unwrap_or(0.0), 0.0);
            let length = whole.iter().map(|x| x * x).sum::<f64>().sqrt();
            whole.into_iter().map(|x| x / length).collect()
        };
        let im = if half.im.is_empty() { Vec::new() } else { lifted(&half.im) };
        Eigenvector { re: lifted(&half.re), im }
    }

    fn residual(&self, x: &[f64], parameter: f64) -> Result<f64, EvalError> {
        let mut r = vec![0.0; self.problem.dim()];
        self.problem.residual(x, &self.problem.parameters_at(parameter), &mut r)?;
        Ok(r.iter().fold(0.0, |most, r| most.max(r.abs())))
    }

    /// The branches that meet where an odd mode turns: the symmetric one, and one that begins along the
    /// mode with the parameter at rest.
    fn pitchfork(
        &self,
        one: &SymmetryBreaking,
        ends: [&Point; 2],
        (x, parameter, error): (&[f64], f64, f64),
    ) -> Result<Crossing, EvalError> {
        let plate = |point: &Point| match self.device {
            Device::Grip => point.p,
            _ => point.u.last().copied().unwrap_or(f64::NAN),
        };
        let [a, b] =
            ends.map(|point| self.state(&point.u[..self.shell.dim()], plate(point), point.p));
        let along = a.iter().zip(&b).map(|(a, b)| b - a).collect();
        let traced = self.direction(along, ends[1].p - ends[0].p);
        let mode = self.odd_mode(one);
        let bend = match &mode {
            Some(mode) => self.bend(x, parameter, mode, error)?,
            None => None,
        };
        // new states lie where the parameter goes with the bend
        let (curvature, error) = bend.unwrap_or((0.0, f64::INFINITY));
        let known = bend.is_some() && curvature.abs() > KNOWN * error && traced.dp != 0.0;
        let forwards = curvature * traced.dp > 0.0;
        let facing = if forwards { one.modes_after } else { one.modes_before };
        let criticality = if facing == one.modes_before.max(one.modes_after) {
            Criticality::Supercritical
        } else {
            Criticality::Subcritical
        };
        let leaving =
            mode.map(|mode| Direction { bend: 0.5 * curvature, ..self.direction(mode, 0.0) });
        Ok(Crossing {
            shape: Shape::Pitchfork,
            criticality: known.then_some(criticality),
            from_side: false,
            multiplicity: 1,
            curvature,
            curvature_error: error,
            traced,
            leaving: leaving.into_iter().collect(),
        })
    }

    /// The odd vector that turns, of length 1 in the metric. It moves neither plate: the forces on both
    /// change alike, as the shell is free, and one against the other, as it is odd.
    fn odd_mode(&self, one: &SymmetryBreaking) -> Option<Vec<f64>> {
        let whole = self.problem.between_plates();
        let u = whole.joined(&one.u, &one.u, 0.0);
        let mut mode = odd_mode(whole, &u, &whole.parameters_at(one.z0)).ok()?;
        mode.resize(self.problem.dim(), 0.0);
        let length = self.length(&mode);
        mode.iter_mut().for_each(|x| *x /= length);
        Some(mode)
    }

    /// `d²p/dx²` along the branch that leaves by the mode, and its error: from the states at two
    /// amplitudes, the pair that says it best. None where no such states are found, as beside a fold
    /// that is sharper than any amplitude.
    fn bend(
        &self,
        x: &[f64],
        at: f64,
        mode: &[f64],
        error: f64,
    ) -> Result<Option<(f64, f64)>, EvalError> {
        let mut normal = vec![0.0; mode.len()];
        self.problem.metric(mode, &mut normal);
        let mut best: Option<(f64, f64)> = None;
        let mut larger: Option<(f64, f64)> = None;
        let mut amplitude = LARGEST_AMPLITUDE / SHRINK;
        while amplitude > SMALLEST_AMPLITUDE {
            amplitude *= SHRINK;
            let found = self.at_amplitude(x, at, mode, &normal, amplitude);
            let bend = found.map(|p| 2.0 * (p - at) / (amplitude * amplitude));
            if let (Some(near), Some((far, from))) = (bend, larger) {
                // the next power is the fourth
                let part = (amplitude / from).powi(2);
                let value = (near - part * far) / (1.0 - part);
                let own = (value - near).abs() + 2.0 * error / (amplitude * amplitude);
                if best.is_none_or(|(_, so_far)| own < so_far) {
                    best = Some((value, own));
                }
                if own < GOOD * value.abs() {
                    break;
                }
            }
            larger = bend.map(|bend| (bend, amplitude));
        }
        Ok(best)
    }

    /// The parameter of the state at an amplitude along the mode.
    fn at_amplitude(
        &self,
        from: &[f64],
        at: f64,
        mode: &[f64],
        normal: &[f64],
        amplitude: f64,
    ) -> Option<f64> {
        let n = from.len();
        let mut x: Vec<f64> = from.iter().zip(mode).map(|(x, m)| x + amplitude * m).collect();
        let mut jacobian = self.problem.new_jacobian();
        let (mut bordered, mut r, mut value) = (Bordered::new(n, 1), vec![0.0; n], at);
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let p = self.problem.parameters_at(value);
            self.problem.linearise(&x, &p, &mut r, &mut jacobian).ok()?;
            let column = bordered.column_mut(0);
            self.problem.parameter_derivative(&x, &p, parameter::Z0, column).ok()?;
            bordered.row_mut(0).copy_from_slice(normal);
            bordered.set_corner(0, 0, 0.0);
            bordered.factor(&mut jacobian);
            let along = normal.iter().zip(x.iter().zip(from)).map(|(m, (x, f))| m * (x - f));
            let mut g = [along.sum::<f64>() - amplitude];
            bordered.solve(&mut jacobian, &mut r, &mut g);
            x.iter_mut().zip(&r).for_each(|(x, d)| *x -= d);
            value -= g[0];
            let size = r.iter().fold(g[0].abs(), |most, d| most.max(d.abs()));
            if size < CONVERGED || (size < 1e2 * CONVERGED && size > 0.3 * last) {
                // a step that fell back onto the trunk or went elsewhere is no state of the fork
                return ((value - at).abs() < amplitude).then_some(value);
            }
            if !size.is_finite() || size > 1e2 * amplitude {
                return None;
            }
            last = size;
        }
        None
    }

    /// A direction of unit length in the metric.
    fn direction(&self, mut du: Vec<f64>, dp: f64) -> Direction {
        let length = self.length(&du).hypot(dp);
        du.iter_mut().for_each(|x| *x /= length);
        Direction { du, dp: dp / length, bend: 0.0, amplitude: 0.0, offset: None }
    }

    fn length(&self, x: &[f64]) -> f64 {
        let mut y = vec![0.0; x.len()];
        self.problem.metric(x, &mut y);
        x.iter().zip(&y).map(|(x, y)| x * y).sum::<f64>().max(0.0).sqrt()
    }
}

/// The count of even modes between two points, and whether it is certain.
fn even_between(half: &Branch, [a, b]: [&Point; 2]) -> (Option<usize>, bool) {
    let after = match a.event.and_then(|k| half.events.get(k)) {
        Some(event) => event.unstable_after,
        None => a.unstable,
    };
    let before = match b.event.and_then(|k| half.events.get(k)) {
        Some(event) => event.unstable_before,
        None => b.unstable,
    };
    (after, a.certified && b.certified && after == before)
}

/// A count beside that of a branch that counts the modes without waves itself.
fn of_waves(scan: Scan) -> Scan {
    Scan { antisymmetric: 0, ..scan }
}
