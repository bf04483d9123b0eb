//! Once to and fro in a device's parameter: the stable state is followed, and where it ends the
//! dissipative motion leads to another.

mod jump;

use super::flow::{MotionError, Relaxation, RelaxationSettings};
use super::start::{device_settings, device_watches};
use super::walker::dot;
use super::{Device, Loading};
use continuation::{
    Detail, Event, EventKind, Point, Progress, Settings, Stop, StopReason, TraceError, Tracer,
};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Which way the plates go.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Towards each other.
    Approach,
    /// Away from each other.
    Retract,
}

impl Direction {
    /// Its name, as in files.
    pub fn name(self) -> &'static str {
        match self {
            Direction::Approach => "approach",
            Direction::Retract => "retract",
        }
    }
}

/// What is travelled, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleSettings {
    /// Where the device's parameter starts and ends.
    pub start: f64,
    /// Where it turns back.
    pub end: f64,
    /// How branches are followed; `max_points` is that of the whole cycle, the target is ignored.
    pub trace: Settings,
    /// How jumps are followed.
    pub relaxation: RelaxationSettings,
}

/// A state on the path travelled.
#[derive(Debug, Clone, PartialEq)]
pub struct CyclePoint {
    /// Which way the plates go.
    pub direction: Direction,
    /// The device's parameter.
    pub parameter: f64,
    /// The plate's height, in `R0`.
    pub z0: f64,
    /// Force on one plate, the upper if they carry different ones, in `√(χk_b)`.
    pub force: f64,
    /// Total energy of the whole shell, in `χR0²`.
    pub energy: f64,
    /// The same with the potential of both devices.
    pub potential: f64,
    /// The shell.
    pub u: Vec<f64>,
    /// Kind of the special point that it is, `jump` for the state that a jump led to.
    pub event: Option<String>,
}

/// A dissipative motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Jump {
    /// Which way the plates go.
    pub direction: Direction,
    /// The device's parameter, which does not change.
    pub parameter: f64,
    /// Index of the last point before, in [`Cycle::points`]; `None` if the plate comes back from far
    /// away.
    pub before: Option<usize>,
    /// Index of the first point after; `None` if the plate flies away.
    pub after: Option<usize>,
    /// Energy dissipated, in `χR0²` for the whole shell and both devices; `None` without bound, and for
    /// a plate that comes from far away.
    pub dissipated: Option<f64>,
    /// Steps of the motion.
    pub steps: usize,
}

/// A path once to and fro.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    /// The device.
    pub device: Device,
    /// The states, in the order in which they were passed.
    pub points: Vec<CyclePoint>,
    /// The jumps between them, in order.
    pub jumps: Vec<Jump>,
    /// Whether the last state is the first one or its mirror image, and the plate has not been far away
    /// in between.
    pub closed: bool,
    /// Why it ended: `ClosedLoop`; `Target` if it came back to another state; `Domain` if the plate
    /// flew away; else it is not complete.
    pub stopped: Stop,
    /// Jacobian assemblies, those of jumps included.
    pub newton_iterations: usize,
}

/// Why there is no cycle at all. One that ends early is a result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleError {
    /// Not even the first point could be computed.
    #[error(transparent)]
    Start(#[from] TraceError),
    /// The first state is unstable.
    #[error("the state at the start has {modes} unstable modes")]
    Unstable {
        /// How many.
        modes: usize,
    },
}

/// Event of a state that a jump led to.
pub const JUMP: &str = "jump";

/// Where a plate is that has flown away, in `R0`.
const FAR: f64 = 5.0;

/// States nearer than this, in `R0`, are the same.
const SAME: f64 = 1e-8;

/// Part of the way by which the parameter must go back to be called so.
const TURN: f64 = 1e-9;

/// Travels from `x`, a stable state near the start, to the end and back. The observer hears of every
/// point and may stop the cycle.
///
/// # Errors
/// When there is no first point, or it is unstable.
pub fn travel<P: Loading>(
    problem: &P,
    x: &[f64],
    settings: &CycleSettings,
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Cycle, CycleError> {
    let mut traveller = Traveller {
        problem,
        settings,
        relaxation: Relaxation::new(problem, settings.relaxation),
        cycle: Cycle {
            device: problem.device(),
            points: Vec::new(),
            jumps: Vec::new(),
            closed: false,
            stopped: Stop { reason: StopReason::Target, detail: String::new() },
            newton_iterations: 0,
        },
        x: x.to_vec(),
        parameter: settings.start,
        first: None,
        away: false,
    };
    let stopped = match traveller.legs(observer) {
        Ok(()) => traveller.end(),
        Err(End::Stop(stop)) => stop,
        Err(End::Error(error)) => return Err(error),
    };
    traveller.cycle.stopped = stopped;
    Ok(traveller.cycle)
}

struct Traveller<'p, P: Loading> {
    problem: &'p P,
    settings: &'p CycleSettings,
    relaxation: Relaxation<P>,
    cycle: Cycle,
    x: Vec<f64>,
    parameter: f64,
    first: Option<Vec<f64>>,
    /// Whether the plate has flown away.
    away: bool,
}

/// Why the cycle ends before it has come back.
enum End {
    Stop(Stop),
    Error(CycleError),
}

impl End {
    fn stop(reason: StopReason, detail: String) -> Self {
        End::Stop(Stop { reason, detail })
    }
}

/// How a stretch without jumps ends.
enum Stretch {
    Target,
    Lost,
    /// At a branch point, from which the stable states of another branch lead on.
    Passed,
}

/// What a point is to the stretch that leads to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reached {
    /// A stable state, from which the path goes on.
    Stable,
    /// A special point with which stability is lost.
    Loss,
    /// An unstable state, without a special point before it.
    Unstable,
}

/// Whether another branch may lead on from a point, and what the point is if none does.
fn reached(point: &Point, event: Option<&Event>) -> (bool, Reached) {
    let lost = event.and_then(|e| e.unstable_after).is_some_and(|n| n > 0);
    let meets = event.is_some_and(|e| e.kind == EventKind::BranchPoint);
    let turns = event
        .is_some_and(|e| matches!(&e.detail, Detail::Crossing(crossing) if crossing.from_side));
    judge(meets, turns, lost, point.unstable.is_some_and(|n| n > 0))
}

/// [`reached`], from whether the point is a branch point, its branch turns there, stability is lost with it, and its
/// state is unstable.
fn judge(branch_point: bool, turns: bool, lost: bool, unstable: bool) -> (bool, Reached) {
    let reached = match (lost, unstable) {
        // a state at the point may count as what lies behind it
        (true, _) => Reached::Loss,
        (false, true) => Reached::Unstable,
        (false, false) => Reached::Stable,
    };
    (branch_point && (lost || turns), reached)
}

impl<'p, P: Loading> Traveller<'p, P> {
    fn legs(&mut self, observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<(), End> {
        let CycleSettings { start, end, .. } = *self.settings;
        for (from, to) in [(start, end), (end, start)] {
            let upwards = to > from;
            let direction = if upwards == self.problem.device().approaches_upwards() {
                Direction::Approach
            } else {
                Direction::Retract
            };
            if self.away && !self.comes_back(direction, to)? {
                continue;
            }
            while self.parameter != to {
                match self.stretch(direction, to, observer)? {
                    Stretch::Target => break,
                    Stretch::Passed => {}
                    Stretch::Lost => self.jump(direction)?,
                }
                if self.away {
                    break;
                }
            }
        }
        Ok(())
    }

    /// A plate far away that is no longer pulled comes back: the attraction of the film alone brings it.
    /// False if the load pulls all the way.
    fn comes_back(&mut self, direction: Direction, to: f64) -> Result<bool, End> {
        let problem = self.problem;
        if to <= 0.0 {
            return Ok(false);
        }
        self.parameter = 0.0;
        let p = problem.parameters_at(self.parameter);
        let Some(from) = problem.free(FAR) else { return Ok(false) };
        let motion = self.relaxation.from_state(problem, &from, &p);
        self.cycle.newton_iterations += self.relaxation.assemblies();
        if let Err(error) = motion {
            return Err(self.refused(&error));
        }
        self.x.copy_from_slice(self.relaxation.state());
        let landed = self.landing(direction).map_err(|e| self.refused(&MotionError::Start(e)))?;
        self.cycle.jumps.push(Jump {
            direction,
            parameter: self.parameter,
            before: None,
            after: Some(self.cycle.points.len()),
            dissipated: None,
            steps: self.relaxation.steps(),
        });
        self.cycle.points.push(landed);
        self.away = false;
        Ok(true)
    }

    /// Follows the stable state until it is lost or the parameter is at `target`.
    fn stretch(
        &mut self,
        direction: Direction,
        target: f64,
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Stretch, End> {
        let mut tracer = self.tracer(target)?;
        let followed = self.follow(&mut tracer, direction, target, observer);
        self.cycle.newton_iterations += tracer.statistics().newton_iterations;
        if let Some(stretch) = followed? {
            return Ok(stretch);
        }
        match tracer.stopped() {
            Some(stop) if stop.reason == StopReason::Target => Ok(Stretch::Target),
            Some(stop) if stop.reason == StopReason::MaxPoints => Err(self.out_of_points()),
            Some(stop) => Err(End::Stop(stop.clone())),
            None => Err(End::stop(StopReason::Interrupted, String::new())),
        }
    }

    /// The tracer of a stretch.
    fn tracer(&self, target: f64) -> Result<Tracer<'p>, End> {
        let problem = self.problem;
        let left = self.settings.trace.max_points.saturating_sub(self.cycle.points.len());
        if left < 2 {
            return Err(self.out_of_points());
        }
        let trace = Settings {
            target: Some(target),
            domain: None,
            increasing: None,
            max_points: left,
            ..self.settings.trace.clone()
        };
        let trace = device_settings(problem.device(), trace);
        let name = problem.device().parameter_name();
        let p = problem.parameters_at(self.parameter);
        Tracer::new(problem, name, &self.x, &p, trace)
            .and_then(|tracer| tracer.watching(&device_watches(problem.device())))
            .map_err(|error| match self.cycle.points.is_empty() {
                true => End::Error(error.into()),
                false => self.cannot_go_on(&format!("the path does not go on: {error}")),
            })
    }

    /// Records the points of a stretch until one of them ends it; `None` where the tracer itself has ended.
    fn follow(
        &mut self,
        tracer: &mut Tracer<'_>,
        direction: Direction,
        target: f64,
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Option<Stretch>, End> {
        let mut fresh = self.cycle.points.is_empty();
        while let Some(point) = tracer.next() {
            let event = point.event.map(|e| tracer.events()[e].clone());
            if self.first.is_none() {
                if let Some(modes) = point.unstable.filter(|modes| *modes > 0) {
                    return Err(End::Error(CycleError::Unstable { modes }));
                }
                self.first = Some(point.u.clone());
            }
            // the first point of a later stretch is the last one of an earlier
            if fresh {
                self.record(direction, &point, event.as_ref());
            }
            fresh = true;
            let (step, ahead) = (point.p - self.parameter, target - self.parameter);
            let way = (self.settings.end - self.settings.start).abs();
            if step * ahead < 0.0 && step.abs() > TURN * way {
                return Err(self.cannot_go_on("the branch turns back without a loss of stability"));
            }
            self.x.copy_from_slice(&point.u);
            self.parameter = point.p;
            let progress = Progress {
                points: self.cycle.points.len(),
                events: self.cycle.jumps.len(),
                p: point.p,
                s: point.s,
            };
            if observer(&progress).is_break() {
                return Err(End::stop(StopReason::Interrupted, "interrupted".to_owned()));
            }
            let (meets, reached) = reached(&point, event.as_ref());
            if meets && self.pass(direction, target) {
                return Ok(Some(Stretch::Passed));
            }
            match reached {
                Reached::Stable => {}
                Reached::Loss => return Ok(Some(Stretch::Lost)),
                Reached::Unstable => {
                    return Err(self.cannot_go_on(
                        "the state is unstable, but the special point before it was not found",
                    ));
                }
            }
        }
        Ok(None)
    }

    fn out_of_points(&self) -> End {
        let limit = self.settings.trace.max_points;
        End::stop(StopReason::MaxPoints, format!("the limit of {limit} points was reached"))
    }

    /// The end of the path at the present parameter.
    fn cannot_go_on(&self, why: &str) -> End {
        let (name, at) = (self.problem.device().parameter_name(), self.parameter);
        End::stop(StopReason::StepTooSmall, format!("at {name} = {at:.10} {why}"))
    }

    fn record(&mut self, direction: Direction, point: &Point, event: Option<&Event>) {
        let problem = self.problem;
        let p = problem.parameters_at(point.p);
        let named = |name: &str| {
            let at = problem.observables().iter().position(|n| *n == name);
            at.map_or(f64::NAN, |k| point.observables[k])
        };
        let (z0, energy) = (problem.plate(&point.u, &p), named("energy_total"));
        let root = problem.root(&p);
        self.cycle.points.push(CyclePoint {
            direction,
            parameter: point.p,
            z0,
            force: named("force"),
            energy,
            potential: energy + problem.device().potential(root, point.p, z0),
            u: problem.shell_part(&point.u).to_vec(),
            event: event.map(|event| event.kind.to_string()),
        });
    }

    /// Whether a state is the first one.
    fn is_first(&self, x: &[f64]) -> bool {
        let Some(first) = &self.first else { return false };
        let difference: Vec<f64> = x.iter().zip(first).map(|(a, b)| a - b).collect();
        let mut m = vec![0.0; difference.len()];
        self.problem.metric(&difference, &mut m);
        dot(&m, &difference).max(0.0).sqrt() < SAME
    }

    /// After both ways: whether the path came back to its beginning.
    fn end(&mut self) -> Stop {
        let stop = |reason, detail: &str| Stop { reason, detail: detail.to_owned() };
        if self.away {
            return stop(StopReason::Domain, "the plate flew away: no state holds the load");
        }
        let problem = self.problem;
        let p = problem.parameters_at(self.parameter);
        let back = self.is_first(&self.x)
            || problem.mirrored(&self.x, &p).is_some_and(|image| self.is_first(&image));
        let bounded = self.cycle.jumps.iter().all(|jump| jump.dissipated.is_some());
        self.cycle.closed = back && bounded;
        match (back, bounded) {
            (true, true) => stop(StopReason::ClosedLoop, ""),
            (true, false) => stop(StopReason::Target, "the plate flew away and came back"),
            (false, _) => stop(
                StopReason::Target,
                "back at the start, but in another state than at first: the start lies where there \
                 are several",
            ),
        }
    }
}

impl Cycle {
    /// The point of most attractive force on the way back, from the turn on.
    pub fn pull_off(&self) -> Option<&CyclePoint> {
        let largest = self.points.iter().fold(0.0_f64, |m, p| m.max(p.force.abs()));
        let retract = self.points.iter().filter(|p| p.direction == Direction::Retract);
        // a force of zero is no attraction
        retract.filter(|p| p.force < -1e-12 * largest).min_by(|a, b| a.force.total_cmp(&b.force))
    }

    /// Energy dissipated by all jumps; `None` if one of them has no end.
    pub fn dissipated(&self) -> Option<f64> {
        self.jumps.iter().try_fold(0.0, |sum, jump| Some(sum + jump.dissipated?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_point_is_to_a_stretch() {
        use Reached::{Loss, Stable, Unstable};
        // branch point, its branch turns, stability lost, state unstable: may be passed, what it is otherwise
        for (signs, expected) in [
            ([false, false, false, false], (false, Stable)),
            ([false, false, false, true], (false, Unstable)),
            ([false, false, true, false], (false, Loss)),
            ([false, false, true, true], (false, Loss)),
            ([true, false, false, false], (false, Stable)),
            ([true, false, false, true], (false, Unstable)),
            ([true, false, true, false], (true, Loss)),
            ([true, false, true, true], (true, Loss)),
            ([true, true, false, false], (true, Stable)),
            ([true, true, false, true], (true, Unstable)),
            ([true, true, true, false], (true, Loss)),
        ] {
            let [branch_point, turns, lost, unstable] = signs;
            assert_eq!(judge(branch_point, turns, lost, unstable), expected, "{signs:?}");
        }
    }
}
