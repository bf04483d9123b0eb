//! Onto another branch at a branch point.
//!
//! The tangents of the branches that leave are roots of the algebraic bifurcation equations (see
//! [`crate::Crossing`]); a step along one of them, corrected on the plane across it, is a point of
//! the new branch if it lies along that tangent and not along the one that was traced. Steps are
//! shortened until it does.

use super::Tracer;
use super::input::{TraceError, check, range};
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Direction, Event, StopReason};
use crate::problem::{EvalError, ParamId, Problem};
use crate::settings::Settings;
use crate::singular::Extended;
use crate::step::{Constraint, Core, Precision, Refusal, State, Weights, dot, judge};
use serde::{Deserialize, Serialize};

/// A slope at the branch point below this part of that after the first step is zero: what a symmetry
/// keeps stationary along the new branch is an extremum at the branch point itself, not after it.
const STATIONARY: f64 = 0.1;

/// Which way the new branch leaves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Departure {
    /// Tangent of the branch that led here, as a covector of the scaled metric times its length.
    old: Extended,
    /// `p − p₀` per square of the scaled step.
    bend: f64,
    /// A state of the new branch where it is told apart: the scaled step to it, and what the
    /// unknowns are there beyond the tangent.
    #[serde(default)]
    state: Option<(f64, Vec<f64>)>,
}

/// Turn, in radians, of a first step to such a state.
const FAR_TURN: f64 = 0.8;
/// Longest and shortest first step, as parts of the one to a state that tells branches apart.
const APART: [f64; 2] = [1.0, 0.5];

impl<'a> Tracer<'a> {
    /// Prepares a trace of a branch that leaves `branch` at one of its branch points, along
    /// `direction`, one of [`crate::Crossing::leaving`], or against it. The first point is the
    /// branch point itself. The parameters other than the continued one have their values of
    /// `branch`; `settings` are those of the new trace.
    ///
    /// ```
    /// use continuation::{DenseProblem, Settings, Tracer};
    /// use std::ops::ControlFlow;
    ///
    /// // a pitchfork: the branch x = 0 gives way to x = ±√p
    /// let problem = DenseProblem::from_residual(1, &["p"], |x, p, r| r[0] = p[0] * x[0] - x[0].powi(3));
    /// let settings = Settings { target: Some(1.0), ..Settings::default() };
    /// let trunk = Tracer::new(&problem, "p", &[0.0], &[-1.0], settings.clone())?
    ///     .run(&mut |_| ControlFlow::Continue(()));
    /// let event = &trunk.events[0];
    /// let crossing = event.crossing().unwrap();
    /// for forward in [true, false] {
    ///     let fork = Tracer::leaving(&problem, &trunk, event, &crossing.leaving[0], forward, settings.clone())?
    ///         .run(&mut |_| ControlFlow::Continue(()));
    ///     let end = fork.points.last().unwrap();
    ///     assert!((end.u[0].abs() - 1.0).abs() < 1e-12 && end.p == 1.0);
    /// }
    /// # Ok::<(), continuation::TraceError>(())
    /// ```
    ///
    /// A branch that cannot be reached is a trace of one point that stops with
    /// [`StopReason::StepTooSmall`] and says what was tried.
    ///
    /// # Errors
    /// When the settings are out of range, or the event is not a branch point of this problem.
    pub fn leaving<P: Problem>(
        problem: &'a P,
        branch: &Branch,
        event: &Event,
        direction: &Direction,
        forward: bool,
        settings: Settings,
    ) -> Result<Self, TraceError> {
        Self::off(problem, branch, event, direction, forward, settings)
    }

    /// [`Tracer::leaving`] of a problem of unknown type.
    pub(crate) fn off(
        problem: &'a DynProblem<'a>,
        branch: &Branch,
        event: &Event,
        direction: &Direction,
        forward: bool,
        settings: Settings,
    ) -> Result<Self, TraceError> {
        settings.validate()?;
        let n = problem.dim();
        let parameters = problem.parameters();
        let foreign = |what| TraceError::Foreign { what };
        let which = parameters
            .iter()
            .position(|q| q.name == branch.parameter)
            .ok_or(foreign("the problem has no such parameter"))?;
        let crossing = event.crossing().ok_or(foreign("the event is no branch point"))?;
        let at = branch.points.get(event.point).ok_or(foreign("it has no such point"))?;
        check("the branch point", &at.u, n)?;
        check("the direction", &direction.du, n)?;
        if let Some(offset) = &direction.offset {
            check("the direction's state", &offset.du, n)?;
        }
        check("the parameter vector", &branch.parameters, parameters.len())?;
        let mut p = branch.parameters.clone();
        p[which] = at.p;

        let range = range(&settings, at.p, &parameters[which]);
        let mut y = vec![0.0; n];
        let mut length = |x: &[f64]| {
            problem.metric(x, &mut y);
            dot(x, &y).max(0.0).sqrt()
        };
        let weights = match problem.unknown_scale(ParamId(which)) {
            Some(scale) => Weights { unknowns: scale, parameter: scale },
            None => {
                // the amplitude, or, for a direction along the parameter, the old branch's range
                let along = direction.amplitude * length(&direction.du);
                let far = |q: &crate::Point| {
                    let d: Vec<f64> = q.u.iter().zip(&at.u).map(|(a, b)| a - b).collect();
                    length(&d)
                };
                let before = branch.points.iter().map(far).fold(0.0, f64::max);
                let unknowns = if along > 1e-6 * before { along } else { before };
                Weights { unknowns: if unknowns > 0.0 { unknowns } else { 1.0 }, parameter: range }
            }
        };
        let mut core = Core::new(problem, ParamId(which), &p, weights, &settings);
        let sign = if forward { 1.0 } else { -1.0 };
        let mut start = State::new(n, problem.observables().len());
        let mut tangent = Extended { u: direction.du.clone(), p: direction.dp };
        tangent.scale(sign);
        core.place(&mut start, &Extended { u: at.u.clone(), p: at.p }, &tangent)
            .map_err(|error| TraceError::Tangent(Refusal::Evaluation(error)))?;
        (start.unstable, start.certified) = (at.unstable, at.certified);
        start.eigenvalues.clone_from(&at.eigenvalues);
        let mut probe = core.probe();
        let mut old = Extended { u: crossing.traced.du.clone(), p: crossing.traced.dp };
        let norm = probe.norm(&old);
        old.scale(1.0 / norm);
        let old = probe.covector(&old);
        let bend = direction.bend * start.length * start.length;
        let mut tracer = Self::set_up(core, start, &p, settings, range)?;
        tracer.first = false;
        let state = direction.offset.as_ref().map(|offset| {
            // what curves is the same on the opposite side
            let beyond = |(u, d): (&f64, &f64)| u - offset.multiple * d;
            let beyond = offset.du.iter().zip(&direction.du).map(beyond).collect();
            (offset.multiple / tracer.current.length, beyond)
        });
        tracer.departure = Some(Departure { old, bend, state });
        Ok(tracer)
    }

    /// The first step onto the new branch.
    pub(super) fn depart(&mut self, departure: &Departure) {
        let length = self.current.length;
        let (first, shortest) = match departure.state {
            Some((to, _)) => (APART[0] * to, APART[1] * to),
            None => (self.size.h, self.size.shortest(length)),
        };
        let mut h = first;
        loop {
            match self.set_off(h, departure) {
                Ok(()) => {
                    self.core.statistics.accepted += 1;
                    return;
                }
                Err(Refusal::Evaluation(EvalError::Aborted)) => return self.abort(),
                Err(refusal) => {
                    self.core.statistics.rejected += 1;
                    h *= if departure.state.is_some() { 0.9 } else { 0.5 };
                    if h < shortest {
                        let detail = format!(
                            "no step onto the branch from {:.1e} down to {:.1e} was accepted: \
                             {refusal}",
                            first * length,
                            shortest * length,
                        );
                        return self.end(StopReason::StepTooSmall, detail);
                    }
                }
            }
        }
    }

    fn set_off(&mut self, h: f64, departure: &Departure) -> Result<(), Refusal> {
        let Self { core, current, trial, settings, .. } = self;
        for i in 0..trial.u.len() {
            trial.u[i] = current.u[i] + h * current.tu[i];
        }
        trial.p = current.p + h * current.tp + departure.bend * h * h;
        if let Some((to, beyond)) = &departure.state {
            let square = (h / to).powi(2);
            trial.u.iter_mut().zip(beyond).for_each(|(u, d)| *u += square * d);
        }
        let corrected = core.correct(Constraint::Plane(current, h), trial, Precision::Step)?;
        let secant = core.secant(current, trial);
        let tangents = core.weights.dot(&current.mtu, current.tp, &trial.tu, trial.tp);
        // a state that is known may lie round the corner
        let turn = if departure.state.is_some() { FAR_TURN } else { 0.0 };
        let limits = Settings { max_angle: settings.max_angle.max(turn), ..settings.clone() };
        let quality = judge(&limits, trial, h, &corrected, secant, tangents)?;
        // along the new branch, not along the old one
        let old = &departure.old;
        let mut d = Extended { u: trial.u.clone(), p: trial.p };
        d.add(-1.0, &Extended { u: current.u.clone(), p: current.p });
        let (distance, along, _) = secant;
        let on_old = old.dot(&d).abs() / distance;
        let turned = old.dot(&Extended { u: trial.tu.clone(), p: trial.tp }).abs();
        if on_old >= along || turned >= tangents {
            return Err(Refusal::OldBranch);
        }
        // the direction at a branch point is as good as its normal form, and slopes along it no
        // better: those that values and slopes after the step say
        let slope = |before: f64, after: f64, end: f64| {
            let start = 2.0 * (after - before) / h - end;
            if start.abs() < STATIONARY * end.abs() { 0.0 } else { start }
        };
        for k in 0..current.slopes.len() {
            current.slopes[k] = slope(current.values[k], trial.values[k], trial.slopes[k]);
        }
        let outside = |(lo, hi): (f64, f64)| {
            current.p == lo && trial.p < lo || current.p == hi && trial.p > hi
        };
        if settings.domain.is_some_and(outside) {
            let detail = "the branch leaves the domain at its start".to_owned();
            self.end(StopReason::Domain, detail);
            return Ok(());
        }
        self.detector.detect(current, trial, h, core.weights.parameter, false)?;
        let s_trial = self.metric_distance();
        let special = self.locate_all(h, false)?;
        self.running_unstable = self.trial.unstable;
        self.accept(h, &special, s_trial, None)?;
        let length = self.current.length;
        self.size.accept(h, &quality, &self.settings, length);
        Ok(())
    }
}
