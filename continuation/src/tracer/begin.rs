//! Where a branch begins: a start that is rounding, and one that is a special point itself.

use super::{TraceError, Tracer};
use crate::any_problem::DynProblem;
use crate::branch::{Detail, Doubt, Event, EventKind};
use crate::problem::Stability;
use crate::singular::{Begun, branch_point_at, fold_form, locate_hopf, max_abs};
use crate::step::{Constraint, Core, Precision, State};

/// A state this much smaller than the one that Newton's method began with is what is left of zero:
/// its corrections converge to 1e-12 of that.
const LEFT_OVER: f64 = 1e-9;
/// Number of unknowns up to which the rank of every start is looked at: that costs next to nothing.
const SMALL: usize = 60;
/// Part of the first step to which a special point at the start is seen from both sides: what else lies
/// that near is not told apart.
const BESIDE: f64 = 1e-3;
/// A parameter's part of the tangent, or a real part beside its imaginary part, below which a start
/// deserves a closer look.
const SUSPECT: f64 = 1e-6;
/// Distance in the parameter, relative to its size and range, of a fold at the start.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Scaled distance of a Hopf point at the start: rounding.
const AT_START: f64 = 1e-10;

/// Sets `u` to zero where it is what Newton's method left of zero and zero solves the equations as
/// well: scales must not come from a state that is rounding.
pub(super) fn settle(problem: &DynProblem<'_>, guess: &[f64], u: &mut [f64], p: &[f64]) {
    if max_abs(u) > LEFT_OVER * max_abs(guess) {
        return;
    }
    let n = u.len();
    let (mut here, mut there, zero) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let known =
        problem.residual(u, p, &mut here).is_ok() && problem.residual(&zero, p, &mut there).is_ok();
    if known && there.iter().all(|r| r.is_finite()) && max_abs(&there) <= max_abs(&here) {
        u.fill(0.0);
    }
}

/// The first state with its tangent and weights; the branch point that it is, if it is one.
///
/// # Errors
/// [`TraceError::SingularEverywhere`] from `everywhere`; where the start has no tangent.
pub(super) fn at(
    core: &mut Core<'_>,
    start: &mut State,
    increasing: bool,
    range: f64,
    everywhere: &dyn Fn(&[f64]) -> Option<TraceError>,
) -> Result<Option<Begun>, TraceError> {
    let begun = core.start(start, increasing, range);
    // one more solve tells whether it is worth a closer look
    let suspect = begun.is_err() || start.orientation == 0 || core.is_nearly_singular(start);
    if (suspect || start.u.len() <= SMALL)
        && let Some(error) = everywhere(&start.u)
    {
        return Err(error);
    }
    if suspect {
        let before = (start.clone(), core.weights);
        core.weigh_without_tangent(start, range);
        if let Some(crossing) = branch_point_at(core, start, increasing) {
            core.weigh_anew(start, range).map_err(TraceError::Tangent)?;
            return Ok(Some(crossing));
        }
        (*start, core.weights) = before;
    }
    begun.map_err(TraceError::Tangent)?;
    Ok(None)
}

impl Tracer<'_> {
    /// Reports the special point that the start is, if it is one; `crossing` is known where it is a
    /// branch point.
    pub(super) fn begin_at_special_point(&mut self, crossing: Option<Begun>) {
        if self.core.problem.special_points().is_some() {
            return;
        }
        let start = self.start.clone();
        let range = self.core.weights.parameter;
        if let Some(Begun { crossing, error }) = crossing {
            let (ahead, behind) = (self.beside(1.0), self.beside(-1.0));
            // of more modes each may go either way
            let modes = match crossing.leaving.len() {
                _ if crossing.from_side => Some(0),
                0 | 1 => Some(1),
                _ => None,
            };
            let detail = Detail::Crossing(crossing);
            self.announce(EventKind::BranchPoint, error, detail, (behind, ahead), modes);
            return;
        }
        if start.tp.abs() <= SUSPECT * range {
            let left = self.core.left_at_fold();
            let mut probe = self.core.probe();
            let form = fold_form(&mut probe, &start, &left).ok();
            let (form, missed) = form.unzip();
            self.core.statistics.newton_iterations += probe.assemblies;
            let slope = start.tp / start.length;
            // p − p₀ = ½ p″ s² and dp/ds = p″ s
            let off = form.map_or(f64::NAN, |form| slope / form.curvature);
            let moved = 0.5 * (off * slope).abs();
            if let Some(form) = form
                && moved <= ROUNDING * (start.p.abs() + range)
                && off.abs() <= SUSPECT * range.max(start.length)
            {
                let (ahead, behind) = (self.beside(1.0), self.beside(-1.0));
                self.start.tp = 0.0;
                let error = off.abs() / start.length + missed.unwrap_or(0.0);
                let detail = Detail::Fold(form);
                self.announce(EventKind::Fold, error, detail, (behind, ahead), Some(1));
            }
            return;
        }
        let dynamics = self.core.problem.stability() == Stability::Dynamics;
        if dynamics && start.pair.abs() <= SUSPECT * start.frequency {
            self.begin_at_hopf(&start);
        }
    }

    fn begin_at_hopf(&mut self, start: &State) {
        let h = BESIDE * self.size.h;
        let Some(ahead) = self.beside(1.0) else { return };
        let behind = self.beside(-1.0);
        let (a, length, at) = match &behind {
            Some(behind) => (behind, 2.0 * h, h),
            None => (start, h, 0.0),
        };
        let core = &mut self.core;
        let omega = start.frequency;
        let found = locate_hopf(core, a, &ahead, length, at, omega, &mut self.work).ok().flatten();
        let (error, detail) = match found {
            Some(found) if (found.at - at).abs() <= AT_START => {
                (found.error.max((found.at - at).abs()), found.form)
            }
            None if start.pair.abs() <= AT_START * omega => (AT_START, None),
            _ => return,
        };
        let detail = detail.map_or(Detail::None, Detail::Hopf);
        self.announce(EventKind::Hopf, error, detail, (behind, Some(ahead)), Some(2));
        (self.start.pair, self.current.pair) = (0.0, 0.0);
    }

    /// The branch a little way from the start, along its direction or against it; `None` where it
    /// would be outside the domain.
    fn beside(&mut self, side: f64) -> Option<State> {
        let h = side * BESIDE * self.size.h;
        let start = &self.start;
        let mut x = start.clone();
        x.u.iter_mut().zip(&start.tu).for_each(|(u, t)| *u += h * t);
        x.p += h * start.tp;
        let inside = |p: f64| self.settings.domain.is_none_or(|(lo, hi)| (lo..=hi).contains(&p));
        if !inside(x.p) {
            return None;
        }
        self.core.correct(Constraint::Plane(start, h), &mut x, Precision::Step).ok()?;
        inside(x.p).then_some(x)
    }

    /// Makes the first point the event that it is. What is compared with the next point is the state
    /// just behind it, and a doubt is left unless the count changes from the one side to the other by
    /// what the event explains, `modes` where that is known.
    fn announce(
        &mut self,
        kind: EventKind,
        error: f64,
        detail: Detail,
        (behind, ahead): (Option<State>, Option<State>),
        modes: Option<usize>,
    ) {
        let Ok(residual) = self.core.residual(&self.start) else { return };
        let start = &mut self.start;
        if let Some(ahead) = &ahead {
            start.orientation = ahead.orientation;
            (start.count, start.unstable) = (ahead.count, ahead.unstable);
            (start.pairs, start.unstable_pairs) = (ahead.pairs, ahead.unstable_pairs);
            (start.pair, start.frequency) = (ahead.pair, ahead.frequency);
            (start.real, start.far) = (ahead.real, ahead.far);
            (start.certified, start.critical) = (ahead.certified, false);
        }
        let before = behind.and_then(|x| x.unstable);
        let after = ahead.as_ref().and_then(|x| x.unstable);
        if let (Some(a), Some(b), Some(modes)) = (before, after, modes)
            && a.abs_diff(b) != modes
        {
            let (from, to) = (start.p, ahead.map_or(start.p, |x| x.p));
            let reason = "more than the special point at the start changes beside it".to_owned();
            self.doubts.push(Doubt { from, to, reason });
        }
        self.running_unstable = after.or(start.unstable);
        let unstable = before.into_iter().chain(after).min();
        let event = Event {
            kind,
            point: 0,
            p: start.p,
            unstable_before: before,
            unstable_after: after,
            residual,
            error_estimate: error * start.length,
            detail,
            eigenvectors: Vec::new(),
        };
        self.current = self.start.clone();
        self.previous = self.start.clone();
        let point = self.point(&self.start, 0.0, Some(0), unstable);
        self.events.push(event);
        if let Some(first) = self.queue.front_mut() {
            *first = point;
        }
    }
}
