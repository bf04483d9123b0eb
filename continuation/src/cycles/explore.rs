//! All branches of cycles that leave the Hopf points of branches of equilibria.

use super::birth::SmallCycle;
use super::cycle::{Cycle, CycleError};
use super::observed::observe;
use super::settings::CycleSettings;
use super::trace::{CycleBranch, trace_of};
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Event, EventKind, StopReason};
use crate::problem::Problem;
use crate::settings::Settings;
use crate::tracer::Progress;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::ops::ControlFlow;

/// Relative difference of periods and extrema of one cycle on two meshes.
const SAME: f64 = 1e-6;
/// Difference of interpolated periods beyond which two cycles are not compared further: interpolation
/// between neighbouring points of a branch is better than that.
const NEAR: f64 = 0.2;
/// A Hopf point is the end of shrinking cycles if it lies within this part of what is extrapolated.
const EXTRAPOLATED: f64 = 0.5;
/// The same of their frequency, relative, and of the distance of their mean, in their amplitude: the
/// amplitude is at most a fifth of the largest, so that both are corrections of second order.
const FREQUENCY: f64 = 0.2;
/// Relative difference of twice the period of cycles and the period of doubled ones beside them.
const HALVED: f64 = 0.05;

/// Where a branch of cycles begins; `event` is an index into the events of the branch named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum CycleOrigin {
    /// At a Hopf point of a branch of equilibria.
    Hopf {
        /// The branch: its place in the list that was given.
        branch: usize,
        /// Its event.
        event: usize,
    },
    /// At a period doubling of a branch of cycles.
    Doubling {
        /// The branch: its place among [`Explored::branches`].
        branch: usize,
        /// Its event.
        event: usize,
    },
    /// At a branch point of a branch of cycles.
    Crossing {
        /// The branch: its place among [`Explored::branches`].
        branch: usize,
        /// Its event.
        event: usize,
        /// Number of the direction, as in [`Crossing::leaving`](crate::Crossing::leaving).
        index: usize,
        /// Along the direction, or against it.
        forward: bool,
    },
}

/// How far cycles are followed.
#[derive(Debug, Clone, PartialEq)]
pub struct Follow<'s> {
    /// How each branch is traced. Its direction is the one that leads away from the special point; it ends
    /// at the bounds of the domain.
    pub trace: &'s Settings,
    /// How cycles are discretised.
    pub cycles: &'s CycleSettings,
    /// Most period doublings and branch points between a branch of cycles and its Hopf point.
    pub depth: usize,
    /// Most branches of cycles.
    pub max_branches: usize,
}

/// A branch of cycles of a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowedCycles {
    /// Where it begins.
    pub from: CycleOrigin,
    /// Period doublings and branch points between it and its Hopf point.
    pub depth: usize,
    /// The branch.
    pub cycles: CycleBranch,
    /// The Hopf point at which its cycles vanish, where that is one of those given: branch and event.
    pub vanishes_at: Option<(usize, usize)>,
}

/// What was found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Explored {
    /// The branches, in the order in which they were followed.
    pub branches: Vec<FollowedCycles>,
    /// Special points from which no branch could be followed, and why.
    pub failed: Vec<(CycleOrigin, CycleError)>,
    /// Special points at which known cycles end, or at which the cycles that leave are known ones.
    pub known: Vec<CycleOrigin>,
    /// Special points whose cycles lie deeper than asked for.
    pub deeper: Vec<CycleOrigin>,
    /// Neimark-Sacker points, whose tori are not followed: place of the branch, and event.
    pub tori: Vec<(usize, usize)>,
    /// Branch points of cycles at which it is not known what leaves: place of the branch, and event.
    pub unresolved: Vec<(usize, usize)>,
    /// Whether the largest number of branches was reached while others waited.
    pub full: bool,
    /// Whether the observer asked to stop.
    pub interrupted: bool,
}

impl Explored {
    /// Whether every branch of cycles that was met was followed to an end of its own, and nothing is open:
    /// no special point failed, lies too deep or is a torus, every count is certain, and no period has
    /// grown without bound: homoclinic orbits are approached, not followed.
    pub fn is_complete(&self) -> bool {
        let nothing_open = self.failed.is_empty()
            && self.deeper.is_empty()
            && self.tori.is_empty()
            && self.unresolved.is_empty();
        let done = |one: &FollowedCycles| {
            one.cycles.branch.is_complete() && one.cycles.branch.is_certain()
        };
        nothing_open && !self.full && !self.interrupted && self.branches.iter().all(done)
    }
}

/// Follows the cycles that leave the Hopf points of branches of equilibria in the same parameter, and
/// what leaves those at period doublings and branch points. `chosen` says which Hopf points are wanted, by
/// place of the branch and number of the event. A branch that is met a second time is not followed again.
///
/// # Errors
/// When the settings are unusable or the problem has no cycles. A special point from which nothing can be
/// followed is among [`Explored::failed`].
pub fn explore<P: Problem + ?Sized>(
    problem: &P,
    equilibria: &[&Branch],
    chosen: &dyn Fn(usize, usize) -> bool,
    follow: &Follow<'_>,
    observer: &mut dyn FnMut(usize, &Progress) -> ControlFlow<()>,
) -> Result<Explored, CycleError> {
    explore_of(&problem, equilibria, chosen, follow, observer)
}

/// [`explore`] of a problem of unknown type.
pub(crate) fn explore_of(
    problem: &DynProblem<'_>,
    equilibria: &[&Branch],
    chosen: &dyn Fn(usize, usize) -> bool,
    follow: &Follow<'_>,
    observer: &mut dyn FnMut(usize, &Progress) -> ControlFlow<()>,
) -> Result<Explored, CycleError> {
    follow.cycles.validate()?;
    let mut waiting: VecDeque<(CycleOrigin, usize)> = VecDeque::new();
    for (branch, one) in equilibria.iter().enumerate() {
        let hopf = one.events.iter().enumerate().filter(|(_, e)| e.kind == EventKind::Hopf);
        waiting.extend(hopf.map(|(event, _)| (CycleOrigin::Hopf { branch, event }, 0)));
    }
    waiting.retain(|(from, _)| match from {
        CycleOrigin::Hopf { branch, event } => chosen(*branch, *event),
        _ => true,
    });
    let mut found = Explored::default();
    while let Some((from, depth)) = waiting.pop_front() {
        if found.ends_at(from) {
            found.known.push(from);
            continue;
        }
        let small = match found.start(problem, equilibria, from, follow.cycles) {
            Ok(Some(small)) => small,
            Ok(None) => continue,
            Err(error @ (CycleError::NoDynamics | CycleError::SingularMass)) => return Err(error),
            Err(error) => {
                found.failed.push((from, error));
                continue;
            }
        };
        let parameter = found.parameter(equilibria, from);
        if found.has(problem, &parameter, &small.cycle) {
            found.known.push(from);
            continue;
        }
        if found.branches.len() >= follow.max_branches {
            found.full = true;
            break;
        }
        let settings =
            Settings { increasing: Some(small.increasing), target: None, ..follow.trace.clone() };
        let number = found.branches.len();
        let traced = trace_of(
            problem,
            &parameter,
            &small.cycle,
            &settings,
            follow.cycles,
            &[],
            &mut |progress| observer(number, progress),
        );
        let cycles = match traced {
            Ok(cycles) => cycles,
            Err(error) => {
                found.failed.push((from, error));
                continue;
            }
        };
        found.interrupted |= cycles.branch.stopped.reason == StopReason::Interrupted;
        let vanishes_at = vanishing(&cycles, equilibria);
        found.branches.push(FollowedCycles { from, depth, cycles, vanishes_at });
        found.list(number, depth, follow.depth, &mut waiting);
        if found.interrupted {
            break;
        }
    }
    Ok(found)
}

impl Explored {
    /// Whether known cycles end at this special point.
    fn ends_at(&self, from: CycleOrigin) -> bool {
        match from {
            CycleOrigin::Hopf { branch, event } => {
                self.branches.iter().any(|one| one.vanishes_at == Some((branch, event)))
            }
            CycleOrigin::Doubling { branch, event } => {
                let parent = &self.branches[branch].cycles;
                let Some(event) = parent.branch.events.get(event) else { return false };
                self.branches.iter().any(|one| {
                    let of_parent =
                        matches!(one.from, CycleOrigin::Doubling { branch: b, .. } if b == branch);
                    of_parent && halves(&one.cycles, parent, event)
                })
            }
            CycleOrigin::Crossing { .. } => false,
        }
    }

    /// The special points of a branch from which others leave.
    fn list(
        &mut self,
        branch: usize,
        depth: usize,
        most: usize,
        waiting: &mut VecDeque<(CycleOrigin, usize)>,
    ) {
        let mut leaving = Vec::new();
        for (event, at) in self.branches[branch].cycles.branch.events.iter().enumerate() {
            match at.kind {
                EventKind::PeriodDoubling => leaving.push(CycleOrigin::Doubling { branch, event }),
                EventKind::NeimarkSacker => self.tori.push((branch, event)),
                EventKind::BranchPoint => {
                    let count = at.crossing().map_or(0, |crossing| crossing.leaving.len());
                    if count == 0 {
                        self.unresolved.push((branch, event));
                    }
                    leaving.extend((0..2 * count).map(|k| CycleOrigin::Crossing {
                        branch,
                        event,
                        index: k / 2,
                        forward: k % 2 == 0,
                    }));
                }
                _ => {}
            }
        }
        if depth < most {
            waiting.extend(leaving.into_iter().map(|from| (from, depth + 1)));
        } else {
            self.deeper.extend(leaving);
        }
    }

    /// The parameter along the branch that a special point lies on.
    fn parameter(&self, equilibria: &[&Branch], from: CycleOrigin) -> String {
        match from {
            CycleOrigin::Hopf { branch, .. } => equilibria[branch].parameter.clone(),
            CycleOrigin::Doubling { branch, .. } | CycleOrigin::Crossing { branch, .. } => {
                self.branches[branch].cycles.branch.parameter.clone()
            }
        }
    }

    /// The first cycle that leaves a special point; `None` where the event is no longer there.
    fn start(
        &self,
        problem: &DynProblem<'_>,
        equilibria: &[&Branch],
        from: CycleOrigin,
        settings: &CycleSettings,
    ) -> Result<Option<SmallCycle>, CycleError> {
        let event = |branch: &'_ Branch, at: usize| branch.events.get(at).cloned();
        match from {
            CycleOrigin::Hopf { branch, event: at } => {
                let Some(event) = event(equilibria[branch], at) else { return Ok(None) };
                SmallCycle::of_hopf(problem, equilibria[branch], &event, settings).map(Some)
            }
            CycleOrigin::Doubling { branch, event: at } => {
                let single = &self.branches[branch].cycles;
                let Some(event) = event(&single.branch, at) else { return Ok(None) };
                SmallCycle::of_doubling(problem, single, &event, settings).map(Some)
            }
            CycleOrigin::Crossing { branch, event: at, index, forward } => {
                let crossed = &self.branches[branch].cycles;
                let Some(event) = event(&crossed.branch, at) else { return Ok(None) };
                SmallCycle::of_branch_point(problem, crossed, &event, index, forward, settings)
                    .map(Some)
            }
        }
    }

    /// Whether a cycle lies on one of the branches: the cycle of a branch that is near it, solved for
    /// at its parameter, has the same period and the same extrema.
    fn has(&self, problem: &DynProblem<'_>, parameter: &str, cycle: &Cycle) -> bool {
        let all = problem.parameters();
        let Some(which) = all.iter().position(|q| q.name == parameter) else { return false };
        let p = cycle.parameters[which];
        let Ok(own) = observe(problem, cycle) else { return false };
        let size = own.iter().fold(cycle.amplitude(), |m, x| m.max(x.abs()));
        let is_same = |other: &Cycle| {
            let Ok(solved) = other.at(which, p).solved(problem) else { return false };
            let Ok(values) = observe(problem, &solved) else { return false };
            (solved.period - cycle.period).abs() <= SAME * cycle.period
                && values.iter().zip(&own).all(|(a, b)| (a - b).abs() <= SAME * size)
        };
        self.branches.iter().any(|one| {
            one.cycles.cycles.windows(2).any(|pair| {
                let [a, b] = [&pair[0].cycle, &pair[1].cycle];
                let [q, r] = [a, b].map(|c| c.parameters[which]);
                if q == r || (p - q) * (p - r) > 0.0 {
                    return false;
                }
                let part = (p - q) / (r - q);
                let period = a.period + part * (b.period - a.period);
                let near = (period - cycle.period).abs() <= NEAR * cycle.period;
                near && is_same(if part < 0.5 { a } else { b })
            })
        })
    }
}

impl Cycle {
    /// The same orbit with another value of a parameter: a guess.
    fn at(&self, which: usize, p: f64) -> Cycle {
        let mut cycle = self.clone();
        cycle.parameters[which] = p;
        cycle
    }
}

/// Whether doubled cycles come back to the single ones at a period doubling: beside their last point, as
/// far as the steps before it tell.
fn halves(doubled: &CycleBranch, single: &CycleBranch, event: &Event) -> bool {
    let ([.., a, b], Some(last)) = (&doubled.branch.points[..], doubled.cycles.last()) else {
        return false;
    };
    let Some(at) = single.cycles.get(event.point) else { return false };
    doubled.branch.stopped.reason == StopReason::PeriodHalved
        && (event.p - b.p).abs() <= 2.0 * (b.p - a.p).abs()
        && (2.0 * at.cycle.period / last.cycle.period - 1.0).abs() <= HALVED
}

/// The Hopf point at which shrinking cycles vanish.
fn vanishing(cycles: &CycleBranch, equilibria: &[&Branch]) -> Option<(usize, usize)> {
    if cycles.branch.stopped.reason != StopReason::CyclesVanish {
        return None;
    }
    let [.., a, b] = &cycles.cycles[..] else { return None };
    let [a, b] = [&a.cycle, &b.cycle];
    let points = &cycles.branch.points;
    let [p, q] = [points[points.len() - 2].p, points[points.len() - 1].p];
    // the parameter varies as the square of the amplitude
    let (x, y) = (a.amplitude().powi(2), b.amplitude().powi(2));
    let end = q - (p - q) * y / (x - y);
    let mean = b.mean();
    let reach = EXTRAPOLATED * (end - q).abs() + SAME * (1.0 + q.abs());
    let fits = |branch: &Branch, event: &Event| {
        let Some(form) = event.hopf() else { return false };
        let Some(point) = branch.points.get(event.point) else { return false };
        let period = std::f64::consts::TAU / form.frequency;
        let off = point.u.iter().zip(&mean).fold(0.0_f64, |m, (u, v)| m.max((u - v).abs()));
        branch.parameter == cycles.branch.parameter
            && (event.p - end).abs() <= reach
            && (period / b.period - 1.0).abs() <= FREQUENCY
            && off <= b.amplitude()
    };
    let all = equilibria.iter().enumerate().flat_map(|(k, branch)| {
        branch.events.iter().enumerate().map(move |(e, event)| (k, e, *branch, event))
    });
    let fitting = all.filter(|(_, _, branch, event)| fits(branch, event));
    let nearest = fitting.min_by(|a, b| (a.3.p - end).abs().total_cmp(&(b.3.p - end).abs()));
    nearest.map(|(branch, event, ..)| (branch, event))
}
