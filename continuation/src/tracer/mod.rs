//! The tracer: an iterator over the points of a branch.
//!
//! ```
//! use continuation::{Settings, Tracer, EventKind, samples::Cusp};
//!
//! // μ + x − x³ = 0, from the lower sheet upwards: folds at μ = ±2/(3√3)
//! let settings = Settings { target: Some(2.0), ..Settings::default() };
//! let branch = Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings)?.run(&mut |_| {
//!     std::ops::ControlFlow::Continue(())
//! });
//! let folds: Vec<f64> = branch.events_of(&EventKind::Fold).map(|e| e.p).collect();
//! let exact = 2.0 / (3.0 * 3f64.sqrt());
//! assert_eq!(folds.len(), 2);
//! assert!((folds[0] - exact).abs() < 1e-12 && (folds[1] + exact).abs() < 1e-12);
//! # Ok::<(), continuation::TraceError>(())
//! ```

mod begin;
mod both_ways;
mod bound;
mod close;
mod closure;
mod examine;
mod input;
mod narrow;
mod out_of_points;
mod owning;
mod plateau;
mod predict;
mod restart;
mod resume;
mod snapshot;
mod special;
mod switching;
mod unbounded;
mod zoom;

pub(crate) use both_ways::both;
pub use both_ways::both_ways;
pub use input::{Progress, TraceError};
pub(crate) use resume::Baton;
pub(crate) use snapshot::Snapshot;

use crate::any_problem::Held;
use crate::branch::{Branch, Doubt, Event, Point, Statistics, Stop, StopReason};
use crate::events::{Detector, Hidden, Plateau, Stretch, Watch};
use crate::name::Name;
use crate::newton::{self, NewtonSettings};
use crate::problem::{EvalError, ParamId, Problem};
use crate::settings::{Settings, SettingsError};
use crate::sound::{check_sizes, examine};
use crate::step::{
    Constraint, Core, Precision, Refusal, State, StepSize, Weights, curve_scale, judge,
};
use input::{begins_at_target, check, detector, increases, no_start, range, singular_everywhere};
use special::Special;
use std::collections::VecDeque;
use std::ops::ControlFlow;
use switching::Departure;

/// Part of the separation on a curve of special points below which two of them meet.
const MEETING: f64 = 1e-3;
/// Steps up to this many of the shortest are not divided for pairs of eigenvalues that cross together.
const FINEST: f64 = 8.0;
/// What a step leaves open at whose length it is not divided further.
const TOUCHES: &str = "an eigenvalue comes so close to the imaginary axis that it may have crossed it and come \
                       back within a step";

/// Traces one branch; yields its points in order, special points included, the start first.
///
/// Work is done when the next point is asked for. After the last point [`Tracer::stopped`] says why
/// the trace ended.
pub struct Tracer<'a> {
    core: Core<'a>,
    settings: Settings,
    detector: Detector,
    size: StepSize,
    start: State,
    // where the other half of the branch ended for want of points, if this is a second half
    finish: Option<State>,
    start_p: Vec<f64>,
    // size of the unknowns by which their growth is measured
    extent: f64,
    previous: State,
    // scaled length of the last step; 0 when `previous` says nothing about the curvature
    previous_h: f64,
    // scaled distance from `previous`, also where its tangent has another scale; 0 at the start
    past: f64,
    current: State,
    trial: State,
    work: State,
    left_start: bool,
    // until the first step is done; not away from a branch point, whose scales are known
    first: bool,
    // set until the first step away from a branch point is done
    departure: Option<Departure>,
    // where a refused step is to end next, between its special points
    cut: Option<f64>,
    // the latest step that crossed to the other orientation, and where it began
    crossing: Option<f64>,
    anchor: State,
    anchor_s: f64,
    // the scales that were expected, while those of the branch are smaller
    expected: Option<Weights>,
    // corrections that took many assemblies
    laborious: usize,
    // whether the derivatives were looked at on another mesh
    examined: bool,
    // the largest separation on a curve of special points so far
    separation: f64,
    s: f64,
    running_unstable: Option<usize>,
    queue: VecDeque<Point>,
    emitted: usize,
    events: Vec<Event>,
    doubts: Vec<Doubt>,
    stop: Option<Stop>,
}

impl<'a> Tracer<'a> {
    /// Prepares a trace of the branch through the solution near `u` in the named parameter.
    ///
    /// `u` has length [`Problem::dim`], `p` holds the values of all parameters, of which all but the
    /// named one stay. Newton's method ([`newton()`](crate::newton())) leads from `u` to the first point.
    ///
    /// # Errors
    /// When the input is unusable, there is no solution near `u`, or the branch has no tangent there
    /// (at a fold or branch point).
    pub fn new<P: Problem>(
        problem: &'a P,
        parameter: &str,
        u: &[f64],
        p: &[f64],
        settings: Settings,
    ) -> Result<Self, TraceError> {
        Self::of(problem, parameter, u, p, settings)
    }

    /// [`Tracer::new`] of a problem of unknown type.
    pub(crate) fn of(
        held: impl Into<Held<'a>>,
        parameter: &str,
        u: &[f64],
        p: &[f64],
        settings: Settings,
    ) -> Result<Self, TraceError> {
        let held = held.into();
        let problem = &*held;
        settings.validate()?;
        check_sizes(problem)?;
        let n = problem.dim();
        let parameters = problem.parameters();
        let Some(which) = parameters.iter().position(|q| q.name == parameter) else {
            let known = crate::name::listed(parameters);
            return Err(TraceError::UnknownParameter { name: parameter.to_owned(), known });
        };
        check("the starting state", u, n)?;
        check("the parameter vector", p, parameters.len())?;
        if let Some((lo, hi)) = settings.domain
            && !(lo..=hi).contains(&p[which])
        {
            let allowed = "an interval that holds the start of the parameter";
            let value = if p[which] < lo { lo } else { hi };
            return Err(SettingsError { key: "domain", value, allowed }.into());
        }
        examine(problem, ParamId(which), u, p)?;
        let mut start = State::new(n, problem.observables().len());
        start.u.copy_from_slice(u);
        start.p = p[which];
        let mut range = range(&settings, start.p, &parameters[which]);
        let scaled = problem.special_points().is_some_and(|curve| curve.scale().is_some());
        if scaled && settings.target.is_none() {
            // how wide the domain is says nothing of the curve
            range = curve_scale(problem, ParamId(which), start.p);
        }
        let everywhere =
            |u: &[f64]| singular_everywhere(problem, ParamId(which), u, p, range, settings.domain);
        let report = newton::solve(problem, &mut start.u, p, &NewtonSettings::default()).map_err(
            |error| {
                no_start(problem, ParamId(which), (u, p), settings.domain, everywhere(u), error)
            },
        )?;
        begin::settle(problem, u, &mut start.u, p);

        let increasing = increases(&settings, start.p);
        let unit = Weights { unknowns: 1.0, parameter: 1.0 };
        let mut core = Core::new(held.clone(), ParamId(which), p, unit, &settings);
        core.statistics.newton_iterations += report.iterations;
        let crossing = begin::at(&mut core, &mut start, increasing, range, &everywhere)?;
        let mut tracer = Self::set_up(core, start, p, settings, range)?;
        tracer.begin_at_special_point(crossing);
        Ok(tracer)
    }

    /// The tracer that stands at `start`.
    fn set_up(
        mut core: Core<'a>,
        start: State,
        p: &[f64],
        settings: Settings,
        range: f64,
    ) -> Result<Self, TraceError> {
        let size = StepSize::new(&settings, range / core.weights.parameter, start.length);
        let detector = detector(&*core.problem, &[], &settings)?;
        let extent = unbounded::extent(&mut core, &start);
        let mut tracer = Tracer {
            core,
            settings,
            detector,
            size,
            finish: None,
            start_p: p.to_vec(),
            extent,
            previous: start.clone(),
            previous_h: 0.0,
            past: 0.0,
            current: start.clone(),
            trial: start.clone(),
            work: start.clone(),
            left_start: false,
            first: true,
            departure: None,
            cut: None,
            crossing: None,
            anchor: start.clone(),
            anchor_s: 0.0,
            expected: None,
            laborious: 0,
            examined: false,
            separation: 0.0,
            s: 0.0,
            running_unstable: start.unstable,
            queue: VecDeque::new(),
            emitted: 0,
            events: Vec::new(),
            doubts: Vec::new(),
            stop: None,
            start,
        };
        tracer.detector.learn(&tracer.start, &tracer.start);
        let first = tracer.point(&tracer.start, 0.0, None, tracer.start.unstable);
        tracer.queue.push_back(first);
        if begins_at_target(&tracer.settings, tracer.start.p) {
            let detail = "the target is where the trace begins".to_owned();
            tracer.end(StopReason::Target, detail);
        }
        if let Some((lo, hi)) = tracer.settings.domain {
            let (p, way) = (tracer.start.p, tracer.start.tp);
            if p == lo && way < 0.0 || p == hi && way > 0.0 {
                let detail = "the branch leaves the domain at its start".to_owned();
                tracer.end(StopReason::Domain, detail);
            }
        }
        Ok(tracer)
    }

    /// Watches for further special points, in place of those of an earlier call.
    ///
    /// # Errors
    /// When an observable is unknown, or has no value at the start.
    pub fn watching(mut self, watches: &[Watch]) -> Result<Self, TraceError> {
        self.detector = detector(&*self.core.problem, watches, &self.settings)?;
        self.core
            .want(self.detector.observables(), &mut self.start)
            .map_err(|error| TraceError::Tangent(Refusal::Evaluation(error)))?;
        self.current.copy_from(&self.start);
        self.previous.copy_from(&self.start);
        self.detector.learn(&self.start, &self.start);
        Ok(self)
    }

    /// Why the trace ended, once it has.
    pub fn stopped(&self) -> Option<&Stop> {
        self.stop.as_ref()
    }

    /// Special points found so far.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Cost so far.
    pub fn statistics(&self) -> Statistics {
        self.core.statistics
    }

    /// Traces to the end and collects the branch. The observer is called after every point and may
    /// stop the trace; nothing computed is lost, so that points of the last step may still follow.
    pub fn run(mut self, observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Branch {
        let points = self.exhaust(observer);
        self.into_branch(points)
    }

    /// All points to the end.
    fn exhaust(&mut self, observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Vec<Point> {
        let mut points = Vec::new();
        let mut interrupted = false;
        while let Some(point) = self.next() {
            let progress = Progress {
                points: points.len() + 1,
                events: self.events.len(),
                p: point.p,
                s: point.s,
            };
            points.push(point);
            if !interrupted && observer(&progress).is_break() {
                // what is computed already is still handed out
                interrupted = true;
                self.interrupt();
            }
        }
        points
    }

    /// Ends the trace at the point handed out last; keeps the first `events` special points.
    pub(crate) fn cut(&mut self, events: usize, reason: StopReason, detail: String) {
        self.events.truncate(events);
        self.queue.clear();
        self.end(reason, detail);
    }

    /// Ends the trace after the points that are computed already.
    pub(crate) fn interrupt(&mut self) {
        if self.stop.is_none() {
            self.end(StopReason::Interrupted, "interrupted".to_owned());
        }
    }

    /// Ends the trace as the problem wants it.
    fn abort(&mut self) {
        self.end(StopReason::Interrupted, EvalError::Aborted.to_string());
    }

    pub(crate) fn into_branch(self, points: Vec<Point>) -> Branch {
        let problem = &self.core.problem;
        let stopped =
            self.stop.unwrap_or(Stop { reason: StopReason::Interrupted, detail: String::new() });
        Branch {
            parameter: problem.parameters()[self.core.which.0].name.to_string(),
            parameters: self.start_p,
            observables: problem.observables().iter().map(Name::to_string).collect(),
            points,
            events: self.events,
            doubts: self.doubts,
            stopped,
            began: None,
            statistics: self.core.statistics,
        }
    }

    fn end(&mut self, reason: StopReason, detail: String) {
        self.stop = Some(Stop { reason, detail });
    }

    fn point(&self, x: &State, s: f64, event: Option<usize>, unstable: Option<usize>) -> Point {
        Point {
            s,
            p: x.p,
            u: x.u.clone(),
            dp_ds: x.tp / x.length,
            unstable,
            certified: unstable.is_some() && x.certified,
            eigenvalues: x.eigenvalues.clone(),
            observables: x.values.clone(),
            event,
        }
    }

    /// One accepted step: fills the queue, or ends the trace.
    fn advance(&mut self) {
        if self.emitted >= self.settings.max_points {
            let detail = self.out_of_points();
            return self.end(StopReason::MaxPoints, detail);
        }
        if let Some(departure) = self.departure.take() {
            return self.depart(&departure);
        }
        let mut length = self.current.length;
        let mut shortest = self.size.shortest(length);
        let mut h = self.size.h.clamp(shortest, self.size.longest(length).max(shortest));
        let first = h * length;
        loop {
            let final_say = h <= self.size.resolution(length);
            self.detector.set_finest(h <= FINEST * shortest);
            match self.attempt(h, final_say) {
                Ok(()) => {
                    self.core.statistics.accepted += 1;
                    self.detector.set_plateau(Plateau::Refuse);
                    self.examine_derivatives();
                    return;
                }
                Err(Refusal::Plateau) => {
                    if self.cross_plateau(h) {
                        return;
                    }
                }
                Err(Refusal::Evaluation(EvalError::Aborted)) => return self.abort(),
                Err(refusal) => {
                    self.core.statistics.rejected += 1;
                    if matches!(refusal, Refusal::Orientation | Refusal::BranchesClose { .. }) {
                        self.crossing = Some(h);
                        self.anchor.copy_from(&self.current);
                        self.anchor_s = self.s;
                    }
                    h = match (&refusal, self.cut.take()) {
                        (_, Some(between)) => between,
                        (Refusal::Evaluation(_), _) => 0.4 * h,
                        // not a part of the step that comes back to the same point
                        (Refusal::OnSpecialPoint, _) => 0.618 * h,
                        _ => 0.5 * h,
                    };
                    if let Some(zoomed) = self.zoom_in(&refusal, h) {
                        h = zoomed;
                        length = self.current.length;
                        shortest = self.size.shortest(length);
                    }
                    if h < shortest {
                        let refusal =
                            if self.stands_at_meeting() { Refusal::Meeting } else { refusal };
                        let mut detail = match self.cross(&refusal) {
                            Ok(()) => return,
                            Err(Some(gap)) => {
                                let detail = self.too_close(gap, &refusal);
                                return self.end(StopReason::BranchesTooClose, detail);
                            }
                            Err(None) => self.too_small(first, 2.0 * h * length, &refusal),
                        };
                        if let Some(wrong) = self.core.wrong_derivative(&self.current) {
                            detail = format!("{detail}; {wrong}");
                        }
                        return self.end(StopReason::StepTooSmall, detail);
                    }
                }
            }
        }
    }

    /// Tries a step of scaled length `h`.
    fn attempt(&mut self, h: f64, final_say: bool) -> Result<(), Refusal> {
        self.cut = None;
        self.predict(h);
        let before = self.core.statistics.newton_iterations;
        let (h, corrected) = match self.meets_bound(h) {
            Some((at, bound)) => self.step_to_bound(at, bound)?,
            None => {
                let Self { core, current, trial, .. } = self;
                (h, core.correct(Constraint::Plane(current, h), trial, Precision::Step)?)
            }
        };
        let Self { core, current, trial, work, settings, .. } = self;
        let laborious = core.statistics.newton_iterations - before >= examine::LABORIOUS;
        let secant = core.secant(current, trial);
        let tangents = core.weights.dot(&current.mtu, current.tp, &trial.tu, trial.tp);
        let quality = judge(settings, trial, h, &corrected, secant, tangents)?;
        if !final_say
            && core.cuts_a_corner((current, trial), h, &quality, secant, tangents, work)?
        {
            return Err(Refusal::Turn { angle: quality.angle });
        }
        if let Some(separation) = core.separation(trial)? {
            self.separation = self.separation.max(separation);
            if separation < MEETING * self.separation {
                return Err(Refusal::Meeting);
            }
        }
        if self.runs_along_bound() {
            let detail = "the branch runs along the bound of the domain".to_owned();
            self.end(StopReason::Domain, detail);
            return Ok(());
        }
        // counts that are lower bounds are followed up step by step: not beyond the end
        let certain = self.current.certified && self.trial.certified;
        let h = if certain { h } else { self.end_at_bound(h) };
        let longest = self.size.longest(self.current.length);
        let Self { core, previous, current, trial, detector, .. } = self;
        let (before, a, b) = (&*previous, &*current, &*trial);
        let range = core.weights.parameter;
        let step = Stretch { before, past: self.past, a, b, h, longest, range };
        let divisible = !final_say || h > FINEST * self.size.shortest(current.length);
        let touches = match step.hides_pair() {
            Hidden::Pair if divisible => return Err(Refusal::Unresolved),
            hidden => hidden != Hidden::Nothing,
        };
        detector.detect(current, trial, h, core.weights.parameter, final_say)?;
        let s_trial = self.s + self.metric_distance();
        // before the location, whose result is left in the same work space
        let returned = self.closes(h);
        let mut special = self.locate_all(h, final_say)?;
        let returned = returned.map(|(reason, at)| {
            // what lies beyond was met at the beginning; a special point at the start itself is met
            special.retain(|one| one.place.at <= at + 1e-4 * h);
            reason
        });
        let doubt = self.detector.doubt().or(touches.then_some(TOUCHES));
        let (from, to) = (self.current.p, self.trial.p);
        let length = self.trial.length;
        self.accept(h, &special, s_trial, returned)?;
        self.laborious += usize::from(laborious && self.laborious < examine::MANY);
        if let Some(reason) = doubt {
            self.doubts.push(Doubt { from, to, reason: reason.to_owned() });
        }
        // by scales that the step has changed
        let h = if self.expected.is_some() { h * length / self.current.length } else { h };
        let length = self.current.length;
        self.size.accept(h, &quality, &self.settings, length);
        Ok(())
    }

    fn metric_distance(&mut self) -> f64 {
        let du = self.core.excursion(&self.trial.u, &self.current.u);
        du.hypot(self.trial.p - self.current.p)
    }

    /// Records the step's special points and its end.
    fn accept(
        &mut self,
        h: f64,
        special: &[Special],
        s_trial: f64,
        returned: Option<StopReason>,
    ) -> Result<(), Refusal> {
        let (events_before, queue_before) = (self.events.len(), self.queue.len());
        let running = self.running_unstable;
        self.recount(special);
        for (i, found) in special.iter().enumerate() {
            let last = i + 1 == special.len();
            if let Err(refusal) = self.record(h, found, s_trial, last) {
                self.events.truncate(events_before);
                self.queue.truncate(queue_before);
                self.running_unstable = running;
                self.stop = None;
                return Err(refusal);
            }
        }
        if self.stop.is_none() {
            if let Some(reason) = returned {
                let detail = match reason {
                    StopReason::ClosedLoop => "the branch is a closed loop",
                    _ => "the branch came back over its start in the opposite direction",
                };
                self.end(reason, detail.to_owned());
            }
            // a landing on the step's own end is that point
            let last_is_end = special.last().is_some_and(|l| l.place.at >= h * (1.0 - 1e-12));
            if !last_is_end {
                let point = self.point(&self.trial, s_trial, None, self.trial.unstable);
                self.queue.push_back(point);
            }
            self.running_unstable = self.trial.unstable;
        }
        self.detector.learn(&self.current, &self.trial);
        self.s = s_trial;
        std::mem::swap(&mut self.previous, &mut self.current);
        std::mem::swap(&mut self.current, &mut self.trial);
        (self.previous_h, self.past) = (h, h);
        self.rescale(h);
        self.check_bounded();
        if !self.left_start {
            let away = self.core.excursion(&self.current.u, &self.start.u);
            self.left_start =
                away.hypot(self.current.p - self.start.p) > 1.5 * h * self.current.length;
        }
        Ok(())
    }

    /// Adapts the scales after a step of scaled length `h`: that of the unknowns to their growing
    /// range, and on a curve of special points, which no range is expected of, both.
    fn rescale(&mut self, h: f64) {
        if std::mem::take(&mut self.first) {
            self.zoom(h);
        }
        self.zoom_out();
        if self.core.problem.unknown_scale(self.core.which).is_some() {
            return;
        }
        let mut weights = self.core.weights;
        let range = self.core.excursion(&self.current.u, &self.start.u);
        if range > 2.0 * weights.unknowns {
            weights.unknowns = range;
        }
        let range = (self.current.p - self.start.p).abs();
        if self.core.problem.special_points().is_some() && range > weights.parameter {
            weights.parameter = 2.0 * range;
        }
        self.measure(weights);
    }
}

impl Iterator for Tracer<'_> {
    type Item = Point;

    fn next(&mut self) -> Option<Point> {
        if self.queue.is_empty() && self.stop.is_none() {
            self.advance();
        }
        let point = self.queue.pop_front();
        self.emitted += usize::from(point.is_some());
        point
    }
}
