//! Going on from a branch that was traced before, and traces without an observer.

use super::input::check;
use super::{TraceError, Tracer};
use crate::branch::{Branch, Event, EventKind};
use crate::problem::Problem;
use crate::settings::Settings;
use std::ops::ControlFlow;

impl<'a> Tracer<'a> {
    /// Prepares a trace that goes on along a branch from its point number `index`, such as the last
    /// one, or that of an event; for another range, with other steps, or from a file. It goes the
    /// branch's way unless the settings say whether the parameter is to increase. At a special point
    /// that has no tangent of its own, a fold met exactly or a branch point, it starts from the next
    /// point of the branch, or from the one before where there is none; [`Tracer::leaving`] follows
    /// the branches that cross there.
    ///
    /// ```
    /// use continuation::{Settings, Tracer, samples::Cusp};
    /// let settings = Settings { target: Some(0.0), ..Settings::default() };
    /// let half = Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings)?.run_quietly();
    /// let saved = serde_json::to_string(&half).unwrap();
    ///
    /// let half: continuation::Branch = serde_json::from_str(&saved).unwrap();
    /// let settings = Settings { target: Some(2.0), ..Settings::default() };
    /// let last = half.points.len() - 1;
    /// let rest = Tracer::from_point(&Cusp, &half, last, settings)?.run_quietly();
    /// assert_eq!((rest.points[0].p, rest.points.last().unwrap().p), (0.0, 2.0));
    /// # Ok::<(), continuation::TraceError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Tracer::new`], and when the branch is not one of this problem or has no such point.
    pub fn from_point<P: Problem>(
        problem: &'a P,
        branch: &Branch,
        index: usize,
        settings: Settings,
    ) -> Result<Self, TraceError> {
        let foreign = |what| TraceError::Foreign { what };
        let parameters = problem.parameters();
        let which = parameters
            .iter()
            .position(|known| known.name == branch.parameter)
            .ok_or(foreign("the problem has no such parameter"))?;
        check("the parameter vector", &branch.parameters, parameters.len())?;
        if index >= branch.points.len() {
            return Err(foreign("it has no such point"));
        }
        let start = |at: usize| {
            let from = branch.restart_point(at).ok_or(foreign("it has no such point"))?;
            let mut p = branch.parameters.clone();
            p[which] = from.p;
            let increasing = settings.increasing.or(Some(from.increasing));
            let settings = Settings { increasing, ..settings.clone() };
            Tracer::of(problem, &branch.parameter, &from.u, &p, settings)
        };
        let at = branch.points[index].event.and_then(|event| branch.events.get(event));
        let singular =
            |event: &Event| matches!(event.kind, EventKind::Fold | EventKind::BranchPoint);
        let (next, before) = (Some(index + 1), index.checked_sub(1));
        let order = match at.is_some_and(singular) {
            true => [next, before, Some(index)],
            false => [Some(index), next, before],
        };
        let mut order = order.into_iter().flatten().filter(|at| *at < branch.points.len());
        let first = order.next().map_or(Err(foreign("it has no such point")), start);
        if !matches!(first, Err(TraceError::Tangent(_) | TraceError::Start(_))) {
            return first;
        }
        // what was tried first is the reason to tell
        order.find_map(|at| start(at).ok()).map_or(first, Ok)
    }

    /// Traces to the end and collects the branch, as [`Tracer::run`] does, with nobody to watch it.
    pub fn run_quietly(self) -> Branch {
        self.run(&mut |_| ControlFlow::Continue(()))
    }
}
