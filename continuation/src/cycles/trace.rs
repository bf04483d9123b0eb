//! Branches of cycles: the tracer on one mesh after the other.

use super::between::Between;
use super::collocation::{CycleProblem, DOUBLING, PERIOD, TORUS};
use super::cycle::{Cycle, CycleError};
use super::doubling::add_forms;
use super::finer::{Finer, Halved, finer};
use super::mesh::Orbit;
use super::observed::{columns, observe};
use super::point::CyclePoint;
use super::settings::CycleSettings;
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Doubt, Event, EventKind, Point, Statistics, Stop, StopReason};
use crate::events::Watch;
use crate::problem::{ParamId, Problem};
use crate::settings::{Counting, Settings};
use crate::step::State;
use crate::tracer::{Baton, Progress, TraceError, Tracer};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Cosine between the orbit's derivative and the reference's below which the reference is renewed.
const ALIGNED: f64 = 0.8;
/// Largest correction, in the scaled metric, on going over to another mesh.
const OVER: f64 = 1e-2;
/// What rounding leaves of the parameter at a special point, relative to its value and its range.
const ROUNDING: f64 = 1e-13;
/// By how much errors at the neighbours of a branch point are exceeded there.
const NEIGHBOURS: f64 = 3.0;

/// A branch of cycles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CycleBranch {
    /// The branch. Its observables are `period` and `max_x`, `min_x`, `mean_x` of every observable `x` of
    /// the problem, or of the unknowns `u[0]`, `u[1]`, … where it has none; its unknowns those of
    /// [`CycleProblem`], on meshes that change along the branch. Folds are limit points of cycles.
    pub branch: Branch,
    /// The cycle at each point, with its multipliers and errors.
    pub cycles: Vec<CyclePoint>,
    /// Estimated error of [`Event::p`] of each event, the error of the discretisation included; `None`
    /// where it is not known.
    pub event_errors: Vec<Option<f64>>,
}

/// Traces the branch of cycles through `start`, both its orbit and its parameters being a guess that
/// Newton's method corrects at the same parameters.
///
/// Settings are those of any trace; [`Settings::counting`] and [`Settings::eigenvalues`] mean nothing
/// here. `watches` may watch the `period` and values of the parameter.
///
/// # Errors
/// When the settings are unusable, the problem has no cycles ([`CycleError`]), or there is none near the
/// start.
pub fn trace<P: Problem + ?Sized>(
    problem: &P,
    parameter: &str,
    start: &Cycle,
    settings: &Settings,
    cycle_settings: &CycleSettings,
    watches: &[Watch],
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<CycleBranch, CycleError> {
    trace_of(&problem, parameter, start, settings, cycle_settings, watches, observer)
}

/// [`trace`] of a problem of unknown type.
pub(crate) fn trace_of(
    problem: &DynProblem<'_>,
    parameter: &str,
    start: &Cycle,
    settings: &Settings,
    cycle_settings: &CycleSettings,
    watches: &[Watch],
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<CycleBranch, CycleError> {
    cycle_settings.validate()?;
    let all = problem.parameters();
    let Some(which) = all.iter().position(|q| q.name == parameter).map(ParamId) else {
        let known = crate::name::listed(all);
        return Err(TraceError::UnknownParameter { name: parameter.to_owned(), known }.into());
    };
    let settings = Settings { counting: Counting::Few, eigenvalues: 0, ..settings.clone() };
    let mut watches = watches.to_vec();
    watches.extend([Watch::zero(DOUBLING), Watch::zero(TORUS)]);
    let mut run = Run {
        problem,
        which,
        settings,
        cycle_settings,
        watches,
        points: Vec::new(),
        cycles: Vec::new(),
        halved: None,
        moved: Vec::new(),
        between: Between::default(),
        events: Vec::new(),
        event_errors: Vec::new(),
        doubts: Vec::new(),
        statistics: Statistics::default(),
        range: 0.0,
        base_s: 0.0,
        largest: 0.0,
        shortest: f64::INFINITY,
        interrupted: false,
    };
    let mut equations = CycleProblem::of(problem, start)?;
    let (x, p) = (equations.unknowns(start), start.parameters.clone());
    let mut baton: Option<Baton> = None;
    // the mesh before, to which the trace returns where the step over would be a jump
    let mut before: Option<(CycleProblem<'_>, Baton)> = None;
    let stopped = loop {
        let settings = run.settings.clone();
        let went = {
            let resumed = match baton.as_ref() {
                None => {
                    let tracer = Tracer::new(&equations, parameter, &x, &p, settings)?;
                    run.range = tracer.expected_range();
                    Ok(tracer)
                }
                Some(from) => Tracer::resume(&equations, which, &p, from, settings, OVER),
            };
            match resumed {
                Ok(tracer) => {
                    let tracer = tracer.watching(&run.watches)?;
                    match run.segment(&equations, tracer, &p, baton.is_some(), observer) {
                        Outcome::End(stop) => break stop,
                        Outcome::Restart(next) => Ok(*next),
                    }
                }
                Err(refusal) => Err(refusal),
            }
        };
        match went {
            Ok(Restart { next, left }) => {
                before = Some((std::mem::replace(&mut equations, next.0), left));
                baton = Some(next.1);
            }
            Err(refusal) => {
                let Some((old, left)) = before.take() else {
                    return Err(TraceError::Tangent(refusal).into());
                };
                (equations, baton) = (old, Some(left));
            }
        }
    };
    Ok(run.finish(parameter, &p, stopped))
}

enum Outcome<'a> {
    End(Stop),
    Restart(Box<Restart<'a>>),
}

/// The way over to another mesh, and where it leaves the one before.
struct Restart<'a> {
    next: (CycleProblem<'a>, Baton),
    left: Baton,
}

pub(super) struct Run<'a, 's> {
    pub(super) problem: &'a DynProblem<'a>,
    pub(super) which: ParamId,
    settings: Settings,
    pub(super) cycle_settings: &'s CycleSettings,
    watches: Vec<Watch>,
    pub(super) points: Vec<Point>,
    pub(super) cycles: Vec<CyclePoint>,
    /// For solving the points again.
    halved: Option<Halved<'a>>,
    /// What halving the intervals moves at each point, in the metric.
    pub(super) moved: Vec<Option<f64>>,
    /// Points that have no errors yet.
    pub(super) between: Between,
    events: Vec<Event>,
    event_errors: Vec<Option<f64>>,
    doubts: Vec<Doubt>,
    statistics: Statistics,
    pub(super) range: f64,
    base_s: f64,
    /// Largest amplitude and shortest period so far.
    pub(super) largest: f64,
    pub(super) shortest: f64,
    interrupted: bool,
}

impl<'a> Run<'a, '_> {
    /// Traces on one mesh until it is to be adapted, or to the end.
    fn segment(
        &mut self,
        equations: &CycleProblem<'a>,
        mut tracer: Tracer<'_>,
        start: &[f64],
        resumed: bool,
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Outcome<'a> {
        let mut count = 0;
        let mut skip = resumed;
        let (mut ended, mut restart) = (None, None);
        while let Some(point) = tracer.next() {
            if std::mem::take(&mut skip) {
                continue;
            }
            if let Some(stop) = self.vanished(equations, &point, &tracer) {
                ended = Some(stop);
                break;
            }
            let event = point.event.and_then(|e| tracer.events().get(e)).cloned();
            if let Some(stop) = event.as_ref().and_then(|e| self.halved(equations, &point, e)) {
                ended = Some(stop);
                break;
            }
            count += 1;
            let due =
                count >= self.cycle_settings.adapt_every || equations.alignment(&point.u) < ALIGNED;
            self.record(equations, point, event, start, due);
            ended = self.unbounded().or_else(|| self.closed());
            if ended.is_none() && self.points.len() >= self.settings.max_points {
                let detail = "the largest number of points was reached".to_owned();
                ended = Some(Stop { reason: StopReason::MaxPoints, detail });
            }
            if ended.is_none() && !self.interrupted {
                let (points, events) = (self.points.len(), self.events.len());
                let last = &self.points[points - 1];
                let progress = Progress { points, events, p: last.p, s: last.s };
                if observer(&progress).is_break() {
                    self.interrupted = true;
                    tracer.interrupt();
                }
            }
            if ended.is_some() {
                break;
            }
            let last = &self.points[self.points.len() - 1];
            if due && last.event.is_none() && tracer.stopped().is_none() {
                let baton = tracer.baton(self.range);
                if baton.at.u == last.u {
                    restart = self.adapt(equations, baton);
                    if restart.is_some() {
                        break;
                    }
                    // it goes on with the old mesh, and the errors say how good that is
                    count = 0;
                }
            }
        }
        self.settle(equations, start);
        self.base_s = self.points.last().map_or(0.0, |point| point.s);
        let finished = tracer.into_branch(Vec::new());
        self.doubts.extend(finished.doubts);
        self.statistics.newton_iterations += finished.statistics.newton_iterations;
        self.statistics.accepted += finished.statistics.accepted;
        self.statistics.rejected += finished.statistics.rejected;
        match (ended, restart) {
            (Some(stop), _) => Outcome::End(stop),
            (None, Some(next)) => Outcome::Restart(next),
            (None, None) => Outcome::End(self.near_vanishing(finished.stopped)),
        }
    }

    /// Equations on a mesh that fits the latest cycle, and where to go on; `None` where there are none.
    fn adapt(&self, equations: &CycleProblem<'a>, mut baton: Baton) -> Option<Box<Restart<'a>>> {
        let left = baton.clone();
        let last = self.cycles.last()?;
        let settings = self.cycle_settings;
        let mut intervals = equations.intervals() as f64;
        intervals *= match last.error {
            Some(error) => {
                let power = 0.5 / last.cycle.degree as f64;
                let ratio = (error / settings.accuracy).powf(power);
                // towards what the accuracy asks for, more slowly downwards
                if ratio > 1.0 { (1.2 * ratio).min(2.0) } else { (1.1 * ratio).clamp(0.7, 1.0) }
            }
            // an orbit that the mesh does not resolve
            None if settings.check => 2.0,
            None => 1.0,
        };
        let count = (intervals.ceil() as usize).clamp(settings.intervals, settings.max_intervals);
        let mesh = equations.orbit(&baton.at.u).equidistributed(count);
        let cycle = last.cycle.on(mesh);
        let next = CycleProblem::of(self.problem, &cycle).ok()?;
        let (n, end) = (equations.n, baton.at.tu.len() - 1);
        let tangent = Orbit {
            n,
            mesh: &equations.mesh,
            values: &baton.at.tu[..end],
            basis: &equations.basis,
        };
        let mut tu = tangent.on(&next.mesh, cycle.degree);
        tu.push(baton.at.tu[end] * next.unit / equations.unit);
        let mut at = State::new(tu.len(), 3);
        at.u = next.unknowns(&cycle);
        (at.p, at.tp, at.tu) = (baton.at.p, baton.at.tp, tu);
        baton.at = at;
        // a branch that begins at an equilibrium is long beside its first cycle
        baton.measure_by(next.unit * cycle.period);
        Some(Box::new(Restart { next: (next, baton), left }))
    }

    /// The solution with every interval halved, if errors are asked for.
    pub(super) fn finer(
        &mut self,
        equations: &CycleProblem<'a>,
        at: (&[f64], &[f64], f64),
        across: bool,
    ) -> Option<Finer> {
        let check = self.cycle_settings.check;
        check.then(|| finer(&mut self.halved, equations, self.which, at, self.range, across))?
    }

    /// Adds a point with all that is known of it, and its event. Its errors may wait for those of later points
    /// if they are not `due`.
    fn record(
        &mut self,
        equations: &CycleProblem<'a>,
        mut point: Point,
        event: Option<Event>,
        start: &[f64],
        due: bool,
    ) {
        let mut p = start.to_vec();
        p[self.which.0] = point.p;
        let kind = event.as_ref().and_then(|event| kind(&event.kind));
        let solved = due || event.is_some() || self.between.is_full();
        let at = (&point.u[..], &p[..], point.dp_ds);
        let fine = if solved { self.finer(equations, at, kind.is_some()) } else { None };
        let cycle = CyclePoint::of(equations, &point.u, &p, fine.as_ref(), self.which);
        let fine = fine.filter(|_| cycle.error.is_some());
        (point.unstable, point.certified) = (cycle.unstable, cycle.certified);
        point.s += self.base_s;
        let observed = observe(self.problem, &cycle.cycle);
        let count = columns(self.problem).len();
        point.observables.truncate(1);
        point.observables.extend(observed.unwrap_or_else(|_| vec![f64::NAN; count]));
        point.event = None;
        if let Some(event) = event {
            self.record_event(event, &cycle, fine.as_ref(), &mut point);
        }
        self.largest = self.largest.max(cycle.cycle.amplitude());
        self.shortest = self.shortest.min(cycle.cycle.period);
        self.moved.push(fine.map(|fine| fine.moved));
        self.points.push(point);
        self.cycles.push(cycle);
        if self.cycle_settings.check {
            self.note(equations, start, solved);
        }
    }

    fn record_event(
        &mut self,
        mut event: Event,
        cycle: &CyclePoint,
        fine: Option<&Finer>,
        point: &mut Point,
    ) {
        match kind(&event.kind) {
            Some(Kind::Doubling) if !has_minus_one(cycle) => return,
            // two real multipliers whose product is 1: nothing happens
            Some(Kind::Torus) if !has_pair(cycle) => return,
            Some(Kind::Doubling) => event.kind = EventKind::PeriodDoubling,
            Some(Kind::Torus) => event.kind = EventKind::NeimarkSacker,
            _ => {}
        }
        event.point = self.points.len();
        let error = event_error(&event, fine, self.range);
        if let Some((length, _)) = error {
            event.error_estimate += length;
        }
        point.event = Some(self.events.len());
        let singular = matches!(
            event.kind,
            EventKind::Fold
                | EventKind::BranchPoint
                | EventKind::PeriodDoubling
                | EventKind::NeimarkSacker
        );
        self.event_errors.push(match error {
            Some((_, by)) => Some(by),
            None if singular => None,
            // a value of the parameter is met exactly
            None => (event.kind == EventKind::Target).then_some(0.0),
        });
        self.events.push(event);
    }

    /// The branch, with the counts beside its events.
    fn finish(mut self, parameter: &str, p: &[f64], stopped: Stop) -> CycleBranch {
        let regular: Vec<usize> = (0..self.points.len())
            .filter(|i| {
                let event = self.points[*i].event.map(|e| &self.events[e].kind);
                event.is_none_or(|kind| changes(kind).is_none())
            })
            .collect();
        for pair in regular.windows(2) {
            self.explain(pair[0], pair[1]);
        }
        let moved = |at: usize| -> Option<f64> {
            let around = [at.checked_sub(1), Some(at + 1)].into_iter().flatten();
            around.filter_map(|i| self.moved.get(i).copied().flatten()).reduce(f64::max)
        };
        for event in 0..self.events.len() {
            if self.events[event].kind == EventKind::BranchPoint
                && let Some(moved) = moved(self.events[event].point)
            {
                self.events[event].error_estimate += NEIGHBOURS * moved;
                let rounding = ROUNDING * (self.events[event].p.abs() + self.range);
                self.event_errors[event] = Some(self.events[event].error_estimate + rounding);
            }
        }
        let mut observables = vec![PERIOD.to_owned()];
        observables.extend(columns(self.problem));
        let mut found = CycleBranch {
            branch: Branch {
                parameter: parameter.to_owned(),
                parameters: p.to_vec(),
                observables,
                points: self.points,
                events: self.events,
                doubts: self.doubts,
                stopped,
                began: None,
                statistics: self.statistics,
            },
            cycles: self.cycles,
            event_errors: self.event_errors,
        };
        add_forms(self.problem, self.which, &mut found);
        found
    }

    /// Compares the counts at two successive regular points with the events between them.
    fn explain(&mut self, a: usize, b: usize) {
        let (before, after) = (self.points[a].unstable, self.points[b].unstable);
        let certified = self.points[a].certified && self.points[b].certified;
        let mut most = 0;
        for i in a + 1..b {
            let Some(e) = self.points[i].event else { continue };
            let event = &mut self.events[e];
            most += changes(&event.kind).unwrap_or(0);
            (event.unstable_before, event.unstable_after) = (before, after);
            self.points[i].unstable = before.zip(after).map(|(x, y)| x.min(y)).or(before);
            self.points[i].certified = certified;
        }
        let explained = match before.zip(after) {
            Some((x, y)) => x.abs_diff(y) <= most && x.abs_diff(y) % 2 == most % 2,
            None => before == after && most == 0,
        };
        if !explained {
            let (from, to) = (self.points[a].p, self.points[b].p);
            let reason = if certified {
                "the number of unstable multipliers changes without a special point that explains it"
            } else {
                "the number of unstable multipliers is not known well enough to say whether a special \
                 point is missing"
            };
            self.doubts.push(Doubt { from, to, reason: reason.to_owned() });
        }
    }
}

/// The special points that are read from the branch of the collocation equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Fold,
    Doubling,
    Torus,
}

fn kind(kind: &EventKind) -> Option<Kind> {
    match kind {
        EventKind::Fold => Some(Kind::Fold),
        EventKind::PeriodDoubling => Some(Kind::Doubling),
        EventKind::NeimarkSacker => Some(Kind::Torus),
        EventKind::Zero(name) if name == DOUBLING => Some(Kind::Doubling),
        EventKind::Zero(name) if name == TORUS => Some(Kind::Torus),
        _ => None,
    }
}

/// Number of multipliers that cross the unit circle at an event.
fn changes(kind: &EventKind) -> Option<usize> {
    match kind {
        EventKind::Fold | EventKind::BranchPoint | EventKind::PeriodDoubling => Some(1),
        EventKind::NeimarkSacker => Some(2),
        _ => None,
    }
}

/// Relative distance within which a located multiplier is where it is sought.
const THERE: f64 = 1e-4;

fn has_minus_one(cycle: &CyclePoint) -> bool {
    let there = |m: &&super::floquet::Multiplier| {
        m.argument == std::f64::consts::PI && m.log_modulus.abs() < THERE
    };
    cycle.multipliers.iter().any(|m| there(&m))
}

fn has_pair(cycle: &CyclePoint) -> bool {
    cycle.multipliers.iter().any(|m| m.argument.sin() > THERE && m.log_modulus.abs() < THERE)
}

/// The error of a special point from where it lies when every interval is halved: as a length, and that of
/// the parameter. `None` where that is not known.
fn event_error(event: &Event, fine: Option<&Finer>, range: f64) -> Option<(f64, f64)> {
    let fine = fine?;
    let ahead = fine.ahead.as_ref()?;
    let test = |x: &State| match kind(&event.kind) {
        Some(Kind::Fold) => Some(x.tp),
        Some(Kind::Doubling) => Some(x.values[1]),
        Some(Kind::Torus) => Some(x.values[2]),
        None => None,
    };
    let (here, there) = (test(&fine.state)?, test(ahead)?);
    // the zero, in steps from here
    let steps = here / (here - there);
    let p = fine.state.p + steps * (ahead.p - fine.state.p);
    let step = 1e-3 * fine.state.length;
    let length = 2.0 * (fine.moved + steps.abs() * step);
    let rounding = ROUNDING * (event.p.abs() + range);
    let by = 2.0 * (p - event.p).abs() + event.error_estimate + rounding;
    (length.is_finite() && by.is_finite()).then_some((length, by))
}
