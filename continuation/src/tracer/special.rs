//! Special points of a step: located one after the other, then recorded.

use super::Tracer;
use crate::branch::{Detail, Event, EventKind, StopReason};
use crate::events::{Candidate, Located, Role, locate};
use crate::problem::Problem;
use crate::singular::{fold_form, locate_branch_point, locate_hopf};
use crate::step::Refusal;

/// Part of the step to which a Hopf point is bracketed before Newton's method takes over.
const BRACKET: f64 = 1e-3;

/// A located special point of a step.
pub(super) struct Special {
    pub(super) candidate: Candidate,
    pub(super) place: Located,
    detail: Detail,
}

impl<P: Problem> Tracer<'_, P> {
    /// Locates every candidate of the step, sorted along it; the trace's end cuts the rest off.
    pub(super) fn locate_all(&mut self, h: f64, final_say: bool) -> Result<Vec<Special>, Refusal> {
        let candidates = self.detector.found().to_vec();
        let mut located: Vec<Special> = Vec::with_capacity(candidates.len());
        // branch points first: a pitchfork met from its side is not a fold besides
        let crossing = |c: &&Candidate| matches!(c, Candidate::BranchPoint { .. });
        let mut own_fold = false;
        for candidate in candidates.iter().filter(crossing) {
            let special = self.locate_one(h, candidate, final_say)?;
            if let Detail::Crossing(crossing) = &special.detail {
                own_fold |= crossing.from_side;
            }
            located.push(special);
        }
        let fold_too = !located.is_empty() && candidates.contains(&Candidate::Fold);
        if fold_too && !own_fold && !final_say {
            return Err(Refusal::SeveralEvents);
        }
        for candidate in candidates.iter().filter(|c| !crossing(c)) {
            if !(own_fold && *candidate == Candidate::Fold) {
                located.push(self.locate_one(h, candidate, final_say)?);
            }
        }
        located.sort_by(|a, b| a.place.at.total_cmp(&b.place.at));
        if let Some(end) = located.iter().position(|l| l.candidate.ends_trace()) {
            located.truncate(end + 1);
        }
        Ok(located)
    }

    /// Locates a candidate; its state is in the work space.
    fn locate_one(
        &mut self,
        h: f64,
        candidate: &Candidate,
        final_say: bool,
    ) -> Result<Special, Refusal> {
        let Self { core, current: a, trial: b, work, settings, .. } = self;
        let tolerance = settings.event_tolerance;
        let (place, detail) = match *candidate {
            Candidate::BranchPoint { kernel } => {
                match locate_branch_point(core, a, b, h, kernel, work) {
                    Ok(found) => {
                        let place = Located { at: found.at, error: found.error };
                        (place, Detail::Crossing(found.crossing))
                    }
                    Err(refusal) if !final_say => return Err(refusal),
                    // steps cannot become shorter: as near as bisection comes
                    Err(_) => match locate(core, a, b, h, candidate, tolerance, work) {
                        Ok(place) => (place, Detail::None),
                        Err(_) => {
                            work.copy_from(b);
                            (Located { at: h, error: h }, Detail::None)
                        }
                    },
                }
            }
            Candidate::Hopf => {
                let place = locate(core, a, b, h, candidate, BRACKET * h, work)?;
                let (at, omega) = (place.at, work.frequency);
                match locate_hopf(core, a, b, h, at, omega, work)? {
                    Some(found) => {
                        let place = Located { at: found.at, error: found.error };
                        (place, found.form.map_or(Detail::None, Detail::Hopf))
                    }
                    None => (locate(core, a, b, h, candidate, tolerance, work)?, Detail::None),
                }
            }
            _ => {
                let place = locate(core, a, b, h, candidate, tolerance, work)?;
                let mut detail = Detail::None;
                if *candidate == Candidate::Fold {
                    let left = core.left_at_fold();
                    let mut probe = core.probe();
                    if let Ok(form) = fold_form(&mut probe, work, &left) {
                        detail = Detail::Fold(form);
                    }
                    core.statistics.newton_iterations += probe.assemblies;
                }
                (place, detail)
            }
        };
        Ok(Special { candidate: *candidate, place, detail })
    }

    /// Records a located state as a point and, unless it only lands on a parameter value, as an
    /// event. The state is in the work space if the step has no other special point.
    pub(super) fn record(
        &mut self,
        h: f64,
        special: &Special,
        s_trial: f64,
        specials: usize,
    ) -> Result<(), Refusal> {
        let Special { candidate, place, detail } = special;
        if specials > 1 {
            self.locate_one(h, candidate, true)?;
        }
        let s = self.s + (s_trial - self.s) * place.at / h;
        let before = self.running_unstable;
        let after = match candidate {
            Candidate::Fold | Candidate::BranchPoint { .. } | Candidate::Hopf => {
                self.trial.unstable
            }
            _ => before,
        };
        self.running_unstable = after;
        let index = self.emitted + self.queue.len();
        let kind = self.kind(candidate);
        let residual = self.core.residual(&self.work).map_err(Refusal::Evaluation)?;
        let unstable = match (before, after) {
            (Some(a), Some(b)) => Some(a.min(b)),
            _ => before,
        };
        let event = kind.as_ref().map(|_| self.events.len());
        let point = self.point(&self.work, s, event, unstable);
        if let Some(kind) = kind {
            self.events.push(Event {
                kind,
                point: index,
                p: self.work.p,
                unstable_before: before,
                unstable_after: after,
                residual,
                error_estimate: place.error * self.work.length,
                detail: detail.clone(),
            });
        }
        self.queue.push_back(point);
        if candidate.ends_trace() {
            match candidate {
                Candidate::Parameter { role: Role::Target, .. } => {
                    self.end(StopReason::Target, String::new());
                }
                Candidate::Parameter { .. } => {
                    self.end(StopReason::Domain, "the bound of the domain was reached".to_owned());
                }
                _ => self.end(StopReason::Target, "an observable reached its value".to_owned()),
            }
        }
        Ok(())
    }

    /// What a candidate is called; `None` for a point that is no event.
    fn kind(&self, candidate: &Candidate) -> Option<EventKind> {
        let name = |observable: usize| self.core.problem.observables()[observable].to_owned();
        match *candidate {
            Candidate::Fold => Some(EventKind::Fold),
            Candidate::BranchPoint { .. } => Some(EventKind::BranchPoint),
            Candidate::Hopf => Some(EventKind::Hopf),
            Candidate::Value { observable, level, .. } if level == 0.0 => {
                Some(EventKind::Zero(name(observable)))
            }
            Candidate::Value { observable, .. } => {
                Some(EventKind::Named(format!("{}-value", name(observable))))
            }
            Candidate::Extremum { observable } if self.current.slopes[observable] < 0.0 => {
                Some(EventKind::Minimum(name(observable)))
            }
            Candidate::Extremum { observable } => Some(EventKind::Maximum(name(observable))),
            Candidate::Parameter { role: Role::Landing, .. } => Some(EventKind::Target),
            Candidate::Parameter { .. } => None,
        }
    }
}
