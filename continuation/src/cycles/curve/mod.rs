//! Curves of limit points of cycles and of period doublings in two parameters.
//!
//! A limit point is a fold of the collocation equations, and a period doubling a branch point of those for the
//! cycle run through twice, from which the cycles of twice the period leave: the extended systems of
//! [`codim2`](crate::codim2) serve both. As on a branch of cycles the trace goes over to an adapted mesh after a few
//! points, across its tangent.

mod halves;

use super::collocation::CycleProblem;
use super::cycle::{Cycle, CycleError};
use super::floquet::Multiplier;
use super::mesh::{Orbit, halved};
use super::settings::CycleSettings;
use super::trace::CycleBranch;
use crate::any_problem::DynProblem;
use crate::branch::{Event, EventKind, Point, Stop, StopReason};
use crate::codim2::{BranchPointCurve, CurveError, FoldCurve};
use crate::events::Watch;
use crate::problem::{ParamId, Problem};
use crate::settings::{Counting, Settings};
use crate::step::State;
use crate::tracer::{Baton, Progress, TraceError, Tracer};
use halves::{confirm_cusps, join};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Amplitude, relative to the largest of the curve, at which shrinking cycles are taken to vanish.
const VANISHED: f64 = 0.03;
/// The same where the trace cannot go on.
const NEARLY: f64 = 0.2;
/// Cosine between the orbit's derivative and the reference's below which the orbit is that of the other side of
/// an equilibrium, and below which the reference is renewed.
const ALIGNED: [f64; 2] = [-0.5, 0.8];
/// Largest correction, in the scaled metric, on going over to another mesh.
const OVER: f64 = 1e-2;
/// Error that is aimed at, at least: differences of the Jacobian leave no less.
const LEAST: f64 = 1e-9;
/// Factor by which the change on halving the intervals is less than the error.
const SAFETY: f64 = 1.5;

/// Which special cycles a curve consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpecialCycles {
    /// Limit points of cycles.
    LimitPoints,
    /// Period doublings.
    Doublings,
}

/// A special cycle on a curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CycleCurvePoint {
    /// The cycle, with the values of all parameters.
    pub cycle: Cycle,
    /// Its multipliers, the largest first; empty where they have no finite values. At a limit point two are 1,
    /// known to the root of rounding.
    pub multipliers: Vec<Multiplier>,
    /// Arclength along the curve.
    pub s: f64,
    /// The special point of the curve here: an index into [`CycleCurve::events`].
    pub event: Option<usize>,
    /// Estimated relative error of the period and error of the first parameter in its range along the branch, from
    /// the curve with every interval halved; known where the mesh was adapted.
    pub error: Option<f64>,
}

/// A curve of special cycles in two parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CycleCurve {
    /// What it consists of.
    pub kind: SpecialCycles,
    /// Names of both parameters; the second one is continued.
    pub parameters: [String; 2],
    /// The points from one end to the other.
    pub points: Vec<CycleCurvePoint>,
    /// Its special points: cusps of limit points ([`EventKind::Cusp`]); [`Event::p`] is the second parameter.
    pub events: Vec<Event>,
    /// Why it ends at the first point.
    pub began: Stop,
    /// Why it ends at the last point.
    pub stopped: Stop,
    /// Jacobian assemblies.
    pub newton_iterations: usize,
    indices: [usize; 2],
}

impl CycleCurve {
    /// The values of both parameters at a point.
    pub fn at(&self, point: &CycleCurvePoint) -> [f64; 2] {
        self.indices.map(|i| point.cycle.parameters[i])
    }
}

/// Follows a limit point of cycles, or a period doubling, of `branch` both ways while the parameter `second`
/// varies too. Settings are those of the second parameter, whose `domain` bounds it; `first` bounds the first.
///
/// A curve of limit points ends where the cycles shrink to an equilibrium
/// ([`CyclesVanish`](StopReason::CyclesVanish)), which is a generalised Hopf point.
///
/// # Errors
/// When the event is of another kind or not of this branch, there is no such parameter, the settings are unusable,
/// or the curve has no tangent at its start.
pub fn curve<P: Problem>(
    problem: &P,
    branch: &CycleBranch,
    event: &Event,
    second: &str,
    (settings, cycles): (&Settings, &CycleSettings),
    first: Option<(f64, f64)>,
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<CycleCurve, CycleError> {
    cycles.validate()?;
    let kind = match event.kind {
        EventKind::Fold => SpecialCycles::LimitPoints,
        EventKind::PeriodDoubling => SpecialCycles::Doublings,
        _ => {
            let (found, wanted) = (event.kind.clone(), EventKind::Fold);
            return Err(CycleError::Kind { found, wanted });
        }
    };
    let all = problem.parameters();
    let index = |name: &str| all.iter().position(|q| q.name == name);
    let Some(at) = index(&branch.branch.parameter) else {
        return Err(CycleError::Foreign { what: "it has no such parameter" });
    };
    let Some(other) = index(second) else {
        let known = all.iter().map(|q| &q.name[..]).collect::<Vec<_>>().join(", ");
        return Err(CurveError::UnknownParameter { name: second.to_owned(), known }.into());
    };
    if at == other {
        return Err(CurveError::SameParameter { name: second.to_owned() }.into());
    }
    let known = branch.cycles.get(event.point);
    let known = known.ok_or(CycleError::Foreign { what: "it has no such point" })?;
    let mut start = Cycle { parameters: branch.branch.parameters.clone(), ..known.cycle.clone() };
    start.check(problem.dim(), all.len())?;
    start.parameters[at] = event.p;
    let range = branch.branch.points.iter().map(|point| (point.p - event.p).abs());
    let range = range.fold(0.0, f64::max);
    let largest = branch.cycles.iter().map(|c| c.cycle.amplitude()).fold(0.0, f64::max);
    let mut bounds = Vec::new();
    if let Some((low, high)) = first {
        bounds.extend([low, high].map(|level| Watch::stop_at(&all[at].name, level)));
    }
    let mut run = Run {
        problem: &problem,
        kind,
        parameters: [ParamId(at), ParamId(other)],
        settings: Settings { counting: Counting::Few, eigenvalues: 0, ..settings.clone() },
        cycles,
        bounds,
        range: if range > 0.0 { range } else { all[at].scale.abs().max(f64::MIN_POSITIVE) },
        largest,
        before: 0,
        assemblies: 0,
        interrupted: false,
    };
    let mut halves = Vec::new();
    for increasing in [false, true] {
        if run.interrupted {
            break;
        }
        let half = run.half(&start, increasing, observer)?;
        run.before += half.points.len();
        halves.push(half);
    }
    let one = halves.pop().ok_or(CycleError::Constant)?;
    let names = [all[at].name.to_string(), second.to_owned()];
    let mut curve = match halves.pop() {
        None => CycleCurve {
            kind,
            parameters: names,
            points: one.points,
            events: one.events,
            began: Stop { reason: StopReason::Interrupted, detail: String::new() },
            stopped: one.stopped,
            newton_iterations: 0,
            indices: [at, other],
        },
        Some(back) => join(back, one, (kind, names, [at, other])),
    };
    curve.newton_iterations = run.assemblies;
    confirm_cusps(&mut curve);
    Ok(curve)
}

/// What is followed one way from the start.
struct Half {
    points: Vec<CycleCurvePoint>,
    events: Vec<Event>,
    stopped: Stop,
}

impl Half {
    /// The end where there is no way over to another mesh; an error at the start.
    fn given_up(mut self, error: CycleError) -> Result<Self, CycleError> {
        if self.points.is_empty() {
            return Err(error);
        }
        let detail = format!("there is no way over to another mesh: {error}");
        self.stopped = Stop { reason: StopReason::StepTooSmall, detail };
        Ok(self)
    }
}

/// The extended system of a curve.
enum Extended<'a> {
    Fold(Box<FoldCurve<'a>>),
    BranchPoint(Box<BranchPointCurve<'a>>),
}

impl<'a> Extended<'a> {
    fn problem<'p>(&'p self) -> &'p DynProblem<'p> {
        match self {
            Extended::Fold(curve) => &**curve,
            Extended::BranchPoint(curve) => &**curve,
        }
    }

    fn start(&self) -> (&[f64], Vec<f64>) {
        match self {
            Extended::Fold(curve) => (curve.start(), curve.start_parameters()),
            Extended::BranchPoint(curve) => (curve.start(), curve.start_parameters()),
        }
    }
}

struct Run<'p, 's> {
    problem: &'p DynProblem<'p>,
    kind: SpecialCycles,
    /// The first and the second.
    parameters: [ParamId; 2],
    settings: Settings,
    cycles: &'s CycleSettings,
    bounds: Vec<Watch>,
    /// Of the first parameter.
    range: f64,
    largest: f64,
    /// Points of the other half.
    before: usize,
    assemblies: usize,
    interrupted: bool,
}

/// Where a mesh is left: the cycle, and the state with its tangent.
struct Left {
    cycle: Cycle,
    baton: Baton,
}

impl Run<'_, '_> {
    /// Follows the curve one way.
    fn half(
        &mut self,
        start: &Cycle,
        increasing: bool,
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Half, CycleError> {
        let settings = Settings { increasing: Some(increasing), ..self.settings.clone() };
        let name = &self.problem.parameters()[self.parameters[1].0].name;
        let mut half = Half {
            points: Vec::new(),
            events: Vec::new(),
            stopped: Stop { reason: StopReason::Interrupted, detail: String::new() },
        };
        let mut cycle = start.clone();
        let mut left: Option<Left> = None;
        loop {
            let whole = self.whole(&cycle);
            let equations = match CycleProblem::of(self.problem, &whole) {
                Ok(equations) => equations,
                Err(error) => return half.given_up(error),
            };
            let extended = match self.extended(&equations, &whole) {
                Ok(extended) => extended,
                Err(error) => return half.given_up(error),
            };
            let (x, p) = extended.start();
            let tracer = match &left {
                None => Tracer::of(extended.problem(), name, x, &p, settings.clone())?,
                Some(left) => {
                    let baton = self.carried(left, &equations, &extended, &whole);
                    let which = self.second_of_curve();
                    let settings = settings.clone();
                    match Tracer::resume(extended.problem(), which, &p, &baton, settings, OVER) {
                        Ok(tracer) => tracer,
                        Err(refusal) => return half.given_up(TraceError::Tangent(refusal).into()),
                    }
                }
            };
            let mut watches = self.bounds.clone();
            match &extended {
                Extended::Fold(_) => watches.push(Watch::zero("cusp")),
                Extended::BranchPoint(_) => watches.extend(BranchPointCurve::bounds()),
            }
            let tracer = tracer.watching(&watches)?;
            match self.segment(&equations, tracer, &cycle, left.is_some(), &mut half, observer) {
                Err(stop) => {
                    half.stopped = stop;
                    return Ok(half);
                }
                Ok(next) => {
                    cycle = self.adapted(&next, &mut half, &equations);
                    left = Some(next);
                }
            }
        }
    }

    fn second_of_curve(&self) -> ParamId {
        let [first, second] = self.parameters;
        ParamId(second.0 - usize::from(second.0 > first.0))
    }

    /// The cycle whose equations are extended: run through twice for period doublings.
    fn whole(&self, cycle: &Cycle) -> Cycle {
        if self.kind == SpecialCycles::LimitPoints {
            return cycle.clone();
        }
        let mut mesh: Vec<f64> = cycle.mesh.iter().map(|t| 0.5 * t).collect();
        mesh.extend(cycle.mesh.iter().skip(1).map(|t| 0.5 + 0.5 * t));
        let mut values = cycle.values.clone();
        values.extend_from_slice(&cycle.values);
        Cycle { mesh, values, period: 2.0 * cycle.period, ..cycle.clone() }
    }

    fn extended<'e>(
        &self,
        equations: &'e CycleProblem<'e>,
        whole: &Cycle,
    ) -> Result<Extended<'e>, CycleError> {
        let at = (equations.unknowns(whole), whole.parameters.clone());
        let scales = (equations.unit * whole.period, self.range);
        let parameters = (self.parameters[0], self.parameters[1]);
        Ok(match self.kind {
            SpecialCycles::LimitPoints => {
                let curve = FoldCurve::of_cycles(equations, parameters, at, scales)?;
                Extended::Fold(Box::new(curve))
            }
            SpecialCycles::Doublings => {
                let curve = BranchPointCurve::of_cycles(equations, parameters, at, scales)?;
                Extended::BranchPoint(Box::new(curve))
            }
        })
    }

    /// The cycle of a state of the extended system.
    fn cycle(&self, equations: &CycleProblem<'_>, x: &[f64], q: f64, p: &[f64]) -> Cycle {
        let n = equations.dim();
        let mut p = p.to_vec();
        p[self.parameters[0].0] = x[x.len() - 1];
        p[self.parameters[1].0] = q;
        let whole = equations.cycle(&x[..n], &p);
        if self.kind == SpecialCycles::LimitPoints {
            return whole;
        }
        let count = (whole.mesh.len() - 1) / 2;
        let nodes = count * whole.degree * whole.dim();
        Cycle {
            mesh: whole.mesh[..=count].iter().map(|t| 2.0 * t).collect(),
            values: whole.values[..nodes].to_vec(),
            period: 0.5 * whole.period,
            ..whole
        }
    }

    /// Traces on one mesh until it is to be adapted, or to the end.
    fn segment(
        &mut self,
        equations: &CycleProblem<'_>,
        mut tracer: Tracer<'_>,
        from: &Cycle,
        resumed: bool,
        half: &mut Half,
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Left, Stop> {
        let base = half.points.last().map_or(0.0, |point| point.s);
        let (mut count, mut skip) = (0, resumed);
        let mut outcome = None;
        while outcome.is_none()
            && let Some(point) = tracer.next()
        {
            if std::mem::take(&mut skip) {
                continue;
            }
            let cycle = self.cycle(equations, &point.u, point.p, &from.parameters);
            let aligned = equations.alignment(&point.u[..equations.dim()]);
            let amplitude = cycle.amplitude();
            if let Some(last) = half.points.last()
                && (aligned < ALIGNED[0]
                    || amplitude < VANISHED * self.largest && amplitude < last.cycle.amplitude())
            {
                outcome = Some(Err(self.vanishing(half)));
                break;
            }
            self.largest = self.largest.max(amplitude);
            self.record(cycle, &point, base, &tracer, half);
            count += 1;
            if half.points.len() >= self.settings.max_points {
                let detail = "the largest number of points was reached".to_owned();
                outcome = Some(Err(Stop { reason: StopReason::MaxPoints, detail }));
            }
            let (points, events) = (self.before + half.points.len(), half.events.len());
            let progress = Progress { points, events, p: point.p, s: base + point.s };
            if !self.interrupted && observer(&progress).is_break() {
                self.interrupted = true;
                tracer.interrupt();
            }
            let due = count >= self.cycles.adapt_every || aligned < ALIGNED[1];
            if due && outcome.is_none() && point.event.is_none() && tracer.stopped().is_none() {
                let baton = tracer.baton(tracer.expected_range());
                if baton.at.u == point.u
                    && let Some(last) = half.points.last()
                {
                    outcome = Some(Ok(Left { cycle: last.cycle.clone(), baton }));
                }
            }
        }
        let finished = tracer.into_branch(Vec::new());
        self.assemblies += finished.statistics.newton_iterations;
        outcome.unwrap_or_else(|| Err(self.near_vanishing(finished.stopped, half)))
    }

    /// A trace that cannot go on where the cycles are about to vanish.
    fn near_vanishing(&self, stop: Stop, half: &Half) -> Stop {
        let stuck = matches!(stop.reason, StopReason::StepTooSmall | StopReason::BranchesTooClose);
        let [.., a, b] = &half.points[..] else { return stop };
        let (x, y) = (a.cycle.amplitude(), b.cycle.amplitude());
        if !(stuck && y < x && y < NEARLY * self.largest) {
            return stop;
        }
        let vanishing = self.vanishing(half);
        Stop { detail: format!("{}; {}", vanishing.detail, stop.detail), ..vanishing }
    }

    /// What to say of cycles that vanish.
    fn vanishing(&self, half: &Half) -> Stop {
        let mut detail = "the cycles shrink to an equilibrium".to_owned();
        if let [.., a, b] = &half.points[..] {
            // both parameters vary as the square of the amplitude
            let (x, y) = (a.cycle.amplitude().powi(2), b.cycle.amplitude().powi(2));
            let [p, q] = self.parameters.map(|i| {
                let [p, q] = [a, b].map(|point| point.cycle.parameters[i.0]);
                q - (p - q) * y / (x - y)
            });
            if p.is_finite() && q.is_finite() {
                let [first, second] = self.parameters.map(|i| &self.problem.parameters()[i.0].name);
                detail =
                    format!("{detail}, by extrapolation near {first} = {p:.6}, {second} = {q:.6}");
            }
        }
        Stop { reason: StopReason::CyclesVanish, detail }
    }

    fn record(&self, cycle: Cycle, point: &Point, base: f64, tracer: &Tracer<'_>, half: &mut Half) {
        let multipliers = CycleProblem::of(self.problem, &cycle).ok().and_then(|equations| {
            equations.multipliers(&equations.unknowns(&cycle), &cycle.parameters).ok()
        });
        let event = point.event.and_then(|e| tracer.events().get(e));
        let event = event.filter(|event| event.kind == EventKind::Cusp).map(|event| {
            half.events.push(Event { point: half.points.len(), ..event.clone() });
            half.events.len() - 1
        });
        half.points.push(CycleCurvePoint {
            cycle,
            multipliers: multipliers.unwrap_or_default(),
            s: base + point.s,
            event,
            error: None,
        });
    }

    /// The state and its tangent on another mesh.
    fn carried(
        &self,
        left: &Left,
        equations: &CycleProblem<'_>,
        extended: &Extended<'_>,
        whole: &Cycle,
    ) -> Baton {
        let mut baton = left.baton.clone();
        let (x, _) = extended.start();
        let n = equations.dim();
        let mut at = State::new(x.len(), extended.problem().observables().len());
        at.u.copy_from_slice(x);
        (at.p, at.tp) = (baton.at.p, baton.at.tp);
        let (old, m) = (&baton.at.tu, whole.degree);
        // unknowns beside those of the cycle
        let others = x.len() - n;
        let end = old.len() - others - 1;
        let from = self.whole(&left.cycle);
        let tangent = Orbit {
            n: whole.dim(),
            mesh: &from.mesh,
            values: &old[..end],
            basis: &equations.basis,
        };
        at.tu[..n - 1].copy_from_slice(&tangent.on(&whole.mesh, m));
        at.tu[n - 1] = old[end] * equations.unit * from.period / baton.at.u[end];
        at.tu[n..].copy_from_slice(&old[end + 1..]);
        at.u[n..].copy_from_slice(&baton.at.u[end + 1..]);
        baton.at = at;
        baton
    }

    /// The latest cycle on a mesh that fits it; sets its error.
    fn adapted(&self, left: &Left, half: &mut Half, equations: &CycleProblem<'_>) -> Cycle {
        let error = self.error(left);
        if let Some(last) = half.points.last_mut() {
            last.error = error;
        }
        let cycle = &left.cycle;
        let mut intervals = (cycle.mesh.len() - 1) as f64;
        if let Some(error) = error {
            let power = 0.5 / cycle.degree as f64;
            let ratio = (error / self.cycles.accuracy.max(LEAST)).powf(power);
            intervals *=
                if ratio > 1.0 { (1.2 * ratio).min(2.0) } else { (1.1 * ratio).clamp(0.7, 1.0) };
        }
        let count = intervals.ceil() as usize;
        let count = count.clamp(self.cycles.intervals, self.cycles.max_intervals);
        let orbit = Orbit {
            n: cycle.dim(),
            mesh: &cycle.mesh,
            values: &cycle.values,
            basis: &equations.basis,
        };
        cycle.on(orbit.equidistributed(count))
    }

    /// By how much period and first parameter change on the curve with every interval halved.
    fn error(&self, left: &Left) -> Option<f64> {
        if !self.cycles.check {
            return None;
        }
        let fine = left.cycle.on(halved(&left.cycle.mesh));
        let whole = self.whole(&fine);
        let equations = CycleProblem::of(self.problem, &whole).ok()?;
        let extended = self.extended(&equations, &whole).ok()?;
        let baton = self.carried(left, &equations, &extended, &whole);
        let (_, p) = extended.start();
        let which = self.second_of_curve();
        let settings = self.settings.clone();
        let found = Tracer::resume(extended.problem(), which, &p, &baton, settings, OVER).ok()?;
        let found = found.baton(self.range).at;
        let there = self.cycle(&equations, &found.u, found.p, &fine.parameters);
        let period = (there.period / left.cycle.period - 1.0).abs();
        let first = self.parameters[0].0;
        let by = (there.parameters[first] - left.cycle.parameters[first]).abs() / self.range;
        Some(SAFETY * period.max(by))
    }
}
