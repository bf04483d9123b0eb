//! Special points of a step: located one after the other, then recorded.

use super::Tracer;
use super::close::passes_through;
use crate::branch::{Detail, Eigenvector, Event, EventKind, FoldForm, StopReason};
use crate::events::{
    Candidate, Located, Role, bend, flat_fold, interpolate, locate, locate_watched,
};
use crate::singular::{
    Crossed, SAME_PARAMETER, SEEDS, fold_form, locate_branch_point_near, locate_branch_points,
    locate_hopf,
};
use crate::step::{Constraint, Core, Precision, Refusal, State};

/// Part of the step to which a Hopf point is bracketed before Newton's method takes over, and a branch
/// point towards which it left the domain.
const BRACKET: f64 = 1e-3;

/// Part of the step to which a branch point is bracketed where Newton's method met another.
const NEARER: f64 = 0.1;

/// Most modes that are sought at one point: the work grows like the fourth power of their number.
const MOST_MODES: usize = 12;

/// What is left at its zero of an eigenvalue that is continuous, relative to the step's ends; bracketing
/// leaves far less.
const JUMP: f64 = 1e-3;

/// Bisections by which a change of the count by several is divided into its parts.
const DIVISIONS: usize = 6;

/// A located special point of a step.
pub(super) struct Special {
    pub(super) candidate: Candidate,
    pub(super) place: Located,
    pub(super) detail: Detail,
    pub(super) eigenvectors: Vec<Eigenvector>,
    pub(super) state: State,
}

/// A fold whose dp/ds is that many times flatter than the step's ends say may be of higher order.
const FLAT: f64 = 1e-3;

/// The normal form of the fold at `x`, and a bound of the error of dp/ds, both 0 where there is none.
fn form_at_fold(core: &mut Core<'_>, x: &State) -> (Option<FoldForm>, f64) {
    let left = core.left_at_fold();
    let mut probe = core.probe();
    let form = fold_form(&mut probe, x, &left);
    core.statistics.newton_iterations += probe.assemblies;
    form.map_or((None, 0.0), |(form, missed)| (Some(form), missed))
}

impl Tracer<'_> {
    /// Ends the step of length `h` where the trace ends, if it passes its target or a bound of its
    /// domain: what lies beyond is not judged. The step's length then.
    pub(super) fn end_at_bound(&mut self, h: f64) -> f64 {
        let Some(end) = self.detector.end_between(self.current.p, self.trial.p) else { return h };
        let Self { core, current: a, trial: b, work, settings, .. } = self;
        let at_end = locate(core, a, b, h, &end, settings.event_tolerance, work).is_ok();
        let Candidate::Parameter { value, .. } = end else { return h };
        if !at_end || work.p != value {
            return h;
        }
        let (distance, cosine, _) = core.secant(a, work);
        let along = distance * cosine;
        if !(along > 0.0 && along <= h * (1.0 + 1e-9)) {
            return h;
        }
        b.copy_from(work);
        along
    }

    /// Locates every candidate of the step, sorted along it; the trace's end cuts the rest off.
    pub(super) fn locate_all(&mut self, h: f64, final_say: bool) -> Result<Vec<Special>, Refusal> {
        if self.detector.found().is_empty() {
            return Ok(Vec::new());
        }
        let candidates = self.detector.found().to_vec();
        let mut located: Vec<Special> = Vec::with_capacity(candidates.len());
        // branch points first: a pitchfork met from its side is not a fold besides
        let mut own_fold = false;
        for candidate in &candidates {
            if let Candidate::BranchPoint { kernel } = *candidate {
                self.locate_crossings(h, kernel, final_say, &mut located)?;
            }
        }
        for special in &located {
            if let Detail::Crossing(crossing) = &special.detail {
                own_fold |= crossing.from_side;
            }
        }
        let pitchfork = located.first().filter(|_| own_fold).map(|special| special.place.at);
        let fold_too = !located.is_empty() && candidates.contains(&Candidate::Fold);
        if fold_too && !own_fold && !final_say {
            return Err(Refusal::SeveralEvents);
        }
        for candidate in &candidates {
            let done = matches!(candidate, Candidate::BranchPoint { .. })
                || (own_fold && *candidate == Candidate::Fold);
            if done {
                continue;
            }
            // nor an extremum of what is the same on its two sides
            if let (Some(at), Candidate::Extremum { observable }) = (pitchfork, *candidate) {
                let (a, b) = (&self.current, &self.trial);
                if self.detector.is_extremal_at(a, b, observable, h, at) {
                    continue;
                }
                if !final_say {
                    return Err(Refusal::SeveralEvents);
                }
            }
            match *candidate {
                // tests of a curve of special points are continuous and know their noise
                Candidate::Value { observable, .. } if self.is_test(observable) => {
                    located.push(self.locate_one(h, candidate)?);
                    continue;
                }
                Candidate::Value { .. } | Candidate::Extremum { .. } => {
                    located.extend(self.locate_watched(h, candidate)?);
                    continue;
                }
                _ => {}
            }
            // at a special point the parameter's value cannot be solved for, and need not be
            let special = match *candidate {
                Candidate::Parameter { value, role } if role != Role::Landing => {
                    self.end_at(&located, *candidate, value)
                }
                _ => None,
            };
            let special = match special {
                Some(end) => end,
                None => self.locate_one(h, candidate)?,
            };
            if self.jumps(&special) {
                // one eigenvalue of the few gave way to another: shorter steps, or a doubt
                let certified = self.current.certified && self.trial.certified;
                match final_say {
                    true if certified => {}
                    false if certified || !self.detector.is_futile() => {
                        return Err(Refusal::Stability);
                    }
                    _ => {
                        self.detector.doubt_count();
                        continue;
                    }
                }
            }
            located.push(special);
        }
        // a fold at the end is the last value that the parameter takes: no crossing shows it
        for (value, role) in self.ends() {
            let candidate = Candidate::Parameter { value, role };
            if !located.iter().any(|l| l.candidate == candidate)
                && let Some(end) = self.end_at(&located, candidate, value)
            {
                located.push(end);
            }
        }
        // a value passed shortly before the fold is passed again behind it: one step for each
        let before = |l: &Special| {
            l.candidate == Candidate::Fold
                && self.detector.passes_before(self.current.p, l.state.p)
                && !self.ends().any(|(value, _)| self.is_at(l, value))
        };
        if !final_say && located.iter().any(before) {
            return Err(Refusal::SeveralEvents);
        }
        located.sort_by(|a, b| a.place.at.total_cmp(&b.place.at));
        if let Some(end) = located.iter().position(|l| l.candidate.ends_trace()) {
            located.truncate(end + 1);
        }
        Ok(located)
    }

    /// The values of the parameter at which the trace ends.
    fn ends(&self) -> impl Iterator<Item = (f64, Role)> + use<> {
        let target = self.settings.target.map(|value| (value, Role::Target));
        let (lo, hi) = self.settings.domain.unzip();
        let bounds = [lo, hi].into_iter().flatten().map(|value| (value, Role::Bound));
        target.into_iter().chain(bounds)
    }

    /// Whether a special point of the Jacobian lies at this value of the parameter, to rounding.
    fn is_at(&self, special: &Special, value: f64) -> bool {
        let singular = matches!(
            special.candidate,
            Candidate::Fold | Candidate::BranchPoint { .. } | Candidate::Hopf
        );
        let scale = value.abs() + self.core.weights.parameter;
        singular && value.is_finite() && (special.state.p - value).abs() <= SAME_PARAMETER * scale
    }

    /// The end of the trace at a special point that lies there.
    fn end_at(&self, located: &[Special], candidate: Candidate, value: f64) -> Option<Special> {
        let special = located.iter().find(|l| self.is_at(l, value))?;
        let mut state = special.state.clone();
        state.p = value;
        let (place, detail, eigenvectors) = (special.place, Detail::None, Vec::new());
        Some(Special { candidate, place, detail, eigenvectors, state })
    }

    fn locate_crossings(
        &mut self,
        h: f64,
        kernel: usize,
        final_say: bool,
        located: &mut Vec<Special>,
    ) -> Result<(), Refusal> {
        if kernel == 2
            && final_say
            && let Some(found) = self.narrow_hopf(h)
        {
            located.push(found);
            return Ok(());
        }
        let Self { core, current: a, trial: b, work, settings, .. } = self;
        let candidate = Candidate::BranchPoint { kernel };
        let special = |one: Crossed| Special {
            candidate: Candidate::BranchPoint { kernel: one.crossing.multiplicity },
            place: Located { at: one.at, error: one.error },
            detail: Detail::Crossing(one.crossing),
            eigenvectors: Vec::new(),
            state: one.state,
        };
        let near;
        // from elsewhere Newton's method meets a neighbour where modes lie close, and leaves the domain where
        // thin films forbid a long way
        if kernel == 1 && !final_say {
            let mut part = NEARER;
            let found = loop {
                let near = locate(core, a, b, h, &candidate, part * h, work)
                    .and_then(|_| locate_branch_point_near(core, (a, b), h, work, final_say));
                match near {
                    Err(Refusal::Evaluation(_)) if part > BRACKET => part = BRACKET,
                    Err(Refusal::Orientation) => {
                        let seeds = &SEEDS[..1];
                        let all = locate_branch_points(core, a, b, h, kernel, seeds, final_say)?;
                        located.extend(all.into_iter().map(special));
                        return Ok(());
                    }
                    near => break near?,
                }
            };
            located.push(special(found));
            return Ok(());
        }
        let mut seeds = &SEEDS[..];
        if kernel > 1 && !final_say {
            match divide(core, a, b, h, work) {
                Divided::Between(at) => {
                    self.cut = Some(at);
                    return Err(Refusal::SeveralEvents);
                }
                Divided::Together(at) => {
                    near = [at / h];
                    seeds = &near;
                }
                Divided::Unknown => {}
            }
        }
        let found = if kernel > MOST_MODES {
            Err(Refusal::ManyModes { modes: kernel })
        } else {
            locate_branch_points(core, a, b, h, kernel, seeds, final_say)
        };
        match found {
            Ok(found) => located.extend(found.into_iter().map(special)),
            Err(refusal) if !final_say || matches!(refusal, Refusal::BranchesClose { .. }) => {
                return Err(refusal);
            }
            // a count that is not certain may have changed without a reason
            Err(_) if kernel > 1 && !(a.certified && b.certified) => {
                self.detector.doubt_count();
            }
            Err(refusal @ Refusal::ManyModes { .. }) if a.orientation == b.orientation => {
                return Err(refusal);
            }
            // steps cannot become shorter: as near as bisection comes
            Err(_) => {
                let tolerance = settings.event_tolerance;
                let place = locate(core, a, b, h, &candidate, tolerance, work)?;
                passes_through(core, a, b, h, place)?;
                let seeds = [place.at / h];
                let kernel = kernel.min(MOST_MODES);
                match locate_branch_points(core, a, b, h, kernel, &seeds, true) {
                    Ok(found) => {
                        located.extend(found.into_iter().map(special));
                        return Ok(());
                    }
                    Err(refusal @ Refusal::BranchesClose { .. }) => return Err(refusal),
                    Err(_) => {}
                }
                self.detector.doubt_crossing();
                let state = self.work.clone();
                let (detail, eigenvectors) = (Detail::None, Vec::new());
                located.push(Special { candidate, place, detail, eigenvectors, state });
            }
        }
        Ok(())
    }

    /// Whether the eigenvalue whose sign changes is nowhere near zero where it does: another one is the
    /// nearest to the axis from there on.
    fn jumps(&self, special: &Special) -> bool {
        let candidate = &special.candidate;
        let nearest =
            matches!(candidate, Candidate::Hopf | Candidate::RealEigenvalue | Candidate::Infinite);
        if !nearest || special.detail != Detail::None {
            return false;
        }
        let test = |x: &State| candidate.test(x, self.current.orientation).abs();
        let size = test(&self.current).max(test(&self.trial));
        test(&special.state) > JUMP * size
    }

    /// Locates a candidate other than a branch point.
    fn locate_one(&mut self, h: f64, candidate: &Candidate) -> Result<Special, Refusal> {
        if *candidate == Candidate::Fold {
            return self.locate_fold(h);
        }
        let Self { core, current: a, trial: b, work, settings, .. } = self;
        let tolerance = settings.event_tolerance;
        let mut vector = None;
        let (place, detail) = match *candidate {
            Candidate::Hopf if core.problem.special_points().is_none() => {
                let place = locate(core, a, b, h, candidate, BRACKET * h, work)?;
                let (at, omega) = (place.at, work.frequency);
                match locate_hopf(core, a, b, h, at, omega, work)? {
                    Some(found) => {
                        let place = Located { at: found.at, error: found.error };
                        vector = found.vector;
                        (place, found.form.map_or(Detail::None, Detail::Hopf))
                    }
                    None => (locate(core, a, b, h, candidate, tolerance, work)?, Detail::None),
                }
            }
            _ => (locate(core, a, b, h, candidate, tolerance, work)?, Detail::None),
        };
        let eigenvectors = vector.into_iter().collect();
        Ok(Special { candidate: *candidate, place, detail, eigenvectors, state: work.clone() })
    }

    /// Locates a fold, of whatever order.
    fn locate_fold(&mut self, h: f64) -> Result<Special, Refusal> {
        let candidate = Candidate::Fold;
        let Self { core, current: a, trial: b, work, settings, .. } = self;
        let mut place = locate(core, a, b, h, &candidate, settings.event_tolerance, work)?;
        let (mut form, missed) = form_at_fold(core, work);
        let bent = form.map_or(0.0, |form| form.curvature.abs() * work.length * work.length);
        let flat = bent * h < FLAT * (b.tp - a.tp).abs();
        if flat || form.is_none_or(|form| form.order.is_none()) {
            let found = flat_fold(core, (a, b), h, (place.at, missed), work)?;
            if found.order != Some(2) {
                place = Located { at: found.at, error: found.error };
                // what stands at the place that the search took for it says nothing
                let spread = form.map_or(0.0, |form| form.curvature.abs() + form.curvature_error);
                let curvature_error = if form.is_some() { spread } else { f64::INFINITY };
                form = Some(FoldForm { curvature: 0.0, curvature_error, order: found.order });
            }
            interpolate(a, b, h, bend(core, a, b), place.at, work);
            core.correct(Constraint::Plane(a, place.at), work, Precision::Event)?;
        }
        if missed > 0.0 && form.is_some_and(|form| form.order == Some(2)) {
            place.error += missed / bent;
        }
        let eigenvectors = Eigenvector::real(work.tu.clone()).into_iter().collect();
        let detail = form.map_or(Detail::None, Detail::Fold);
        Ok(Special { candidate, place, detail, eigenvectors, state: work.clone() })
    }

    /// Whether zeros of the observable are special points of a curve.
    fn is_test(&self, observable: usize) -> bool {
        let curve = self.core.problem.special_points();
        curve.is_some_and(|curve| curve.zero(observable).is_some())
    }

    /// Locates a zero or extremum of an observable, unless it has a pole or a jump there.
    fn locate_watched(
        &mut self,
        h: f64,
        candidate: &Candidate,
    ) -> Result<Option<Special>, Refusal> {
        let Self { core, current: a, trial: b, work, settings, .. } = self;
        let place = locate_watched(core, (a, b), h, candidate, settings.event_tolerance, work)?;
        Ok(place.map(|place| {
            let state = work.clone();
            let eigenvectors = Vec::new();
            Special { candidate: *candidate, place, detail: Detail::None, eigenvectors, state }
        }))
    }

    /// Records a located state as a point and, unless it only lands on a parameter value, as an
    /// event. `last` says that no further one follows in this step.
    pub(super) fn record(
        &mut self,
        h: f64,
        special: &Special,
        s_trial: f64,
        last: bool,
    ) -> Result<(), Refusal> {
        let Special { candidate, place, detail, eigenvectors, state } = special;
        let s = self.s + (s_trial - self.s) * place.at / h;
        let before = self.running_unstable;
        let after = match candidate {
            Candidate::BranchPoint { kernel } if !last => {
                between(before, self.trial.unstable, *kernel)
            }
            Candidate::Hopf if !last => between(before, self.trial.unstable, 2),
            Candidate::Fold
            | Candidate::BranchPoint { .. }
            | Candidate::Hopf
            | Candidate::Infinite
            | Candidate::Stability { .. } => self.trial.unstable,
            _ if self.core.problem.special_points().is_some() => self.trial.unstable,
            _ => before,
        };
        self.running_unstable = after;
        let index = self.emitted + self.queue.len();
        let kind = self.kind(candidate);
        let residual = self.core.residual(state).map_err(Refusal::Evaluation)?;
        let unstable = match (before, after) {
            (Some(a), Some(b)) => Some(a.min(b)),
            _ => before,
        };
        let event = kind.as_ref().map(|_| self.events.len());
        let point = self.point(state, s, event, unstable);
        if let Some(kind) = kind {
            self.events.push(Event {
                kind,
                point: index,
                p: state.p,
                unstable_before: before,
                unstable_after: after,
                residual,
                error_estimate: (place.error + self.uncertainty(candidate, state)) * state.length,
                detail: detail.clone(),
                eigenvectors: eigenvectors.clone(),
            });
        }
        // a special point where the trace ends is its last point
        match self.queue.back_mut() {
            Some(back) if candidate.ends_trace() && back.event.is_some() && back.s == s => {
                back.p = point.p;
            }
            _ => self.queue.push_back(point),
        }
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

    /// By how much the error of an observable itself moves its zero, as a scaled length.
    fn uncertainty(&self, candidate: &Candidate, state: &State) -> f64 {
        match (self.core.problem.special_points(), candidate) {
            (Some(curve), &Candidate::Value { observable, .. }) => {
                let moved = curve.error(observable) / state.slopes[observable].abs();
                if moved.is_finite() { moved } else { 0.0 }
            }
            _ => 0.0,
        }
    }

    /// Where the count of unstable modes is not certain it comes from the few eigenvalues nearest
    /// to zero: no fewer are unstable, but one that has gone far is not among them. What has
    /// changed since the last point passed zero, and is among them at both ends.
    pub(super) fn recount(&mut self, special: &[Special]) {
        let Self { current: a, trial: b, .. } = self;
        if b.certified || self.core.problem.special_points().is_some() {
            return;
        }
        let known = (self.running_unstable, a.count, b.count, b.unstable);
        let (Some(running), Some(before), Some(after), Some(least)) = known else { return };
        let critical = special.iter().map(|one| match one.candidate {
            Candidate::Fold => 1,
            Candidate::BranchPoint { kernel } => kernel,
            Candidate::Hopf => 2,
            _ => 0,
        });
        let most = critical.sum::<usize>();
        let changed = if after >= before {
            running + (after - before).min(most)
        } else {
            running.saturating_sub((before - after).min(most))
        };
        b.unstable = Some(changed.max(least));
    }

    /// What a candidate is called; `None` for a point that is no event.
    fn kind(&self, candidate: &Candidate) -> Option<EventKind> {
        if let Some(curve) = self.core.problem.special_points() {
            let special = match *candidate {
                Candidate::Hopf => curve.crossing_pair(),
                Candidate::RealEigenvalue => curve.crossing_zero(),
                Candidate::Value { observable, level: 0.0, .. } => curve.zero(observable),
                _ => None,
            };
            if special.is_some() {
                return special;
            }
        }
        let name = |observable: usize| self.core.problem.observables()[observable].to_string();
        match *candidate {
            Candidate::Fold => Some(EventKind::Fold),
            Candidate::BranchPoint { .. } => Some(EventKind::BranchPoint),
            Candidate::Hopf => Some(EventKind::Hopf),
            Candidate::Infinite => Some(EventKind::SingularityInduced),
            Candidate::Stability { .. } => Some(EventKind::StabilityChange),
            Candidate::RealEigenvalue => None,
            Candidate::Value { observable, level: 0.0, .. } => {
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

/// What the counts within a step say of a change by several.
enum Divided {
    /// A part of it happens before this distance, the rest behind.
    Between(f64),
    /// All of it happens near this distance, as far as was looked.
    Together(f64),
    /// There are no counts, or no states.
    Unknown,
}

/// Bisects the step from `a` to `b` by the count, which is cheaper than Newton's method for several modes
/// that are critical at different places.
fn divide(core: &mut Core<'_>, a: &State, b: &State, h: f64, x: &mut State) -> Divided {
    let (Some(before), Some(after)) = (a.count, b.count) else { return Divided::Unknown };
    let bend = bend(core, a, b);
    let counted = core.counted();
    let (mut lo, mut hi) = (0.0, h);
    let mut divided = None;
    for _ in 0..DIVISIONS {
        let at = 0.5 * (lo + hi);
        interpolate(a, b, h, bend, at, x);
        if core.correct(Constraint::Plane(a, at), x, Precision::Event).is_err() {
            break;
        }
        match x.count {
            Some(count) if count == before => lo = at,
            Some(count) if count == after => hi = at,
            Some(count)
                if count.abs_diff(before) + count.abs_diff(after) == before.abs_diff(after) =>
            {
                divided = Some(at);
                break;
            }
            _ => break,
        }
    }
    core.set_counted(counted);
    match divided {
        Some(at) => Divided::Between(at),
        None if hi - lo < h => Divided::Together(0.5 * (lo + hi)),
        None => Divided::Unknown,
    }
}

/// The count after the first of several crossings, of `kernel` modes, on the way to `after`.
fn between(before: Option<usize>, after: Option<usize>, kernel: usize) -> Option<usize> {
    let (before, after) = (before?, after?);
    Some(if after > before { before + kernel } else { before.saturating_sub(kernel) })
}
