//! Beside the mirror-symmetric branches of a contact case those that are not: the same shell from pole
//! to pole, between two equal plates.
//!
//! Where a branch loses its mirror symmetry one leaves it; others are found from pairs of symmetric
//! states in series, and joined to the forks at which they end. Of each branch and its mirror image,
//! which have the same numbers, one is followed.

use super::diagram::DiagramProgress;
use super::stability::Stability;
use super::{Progress, RunError, contact, two_plates};
use crate::case::{ContactCase, ResolvedCase};
use crate::record::view::Curve;
use crate::record::{BranchOrigin, BranchRecord, Symmetry, TraceResult};
use continuation::diagram::Joint;
use continuation::{Branch, Settings, StopReason};
use shell_contact::two_plates::{
    TwoPlatesGroups, TwoPlatesProblem, follow_asymmetric, leave_symmetry, next_unconnected,
};
use shell_contact::{ContactBranch, force_watches};
use std::ops::ControlFlow;

/// Places over the range of the parameter at which states on no known branch are sought. Families found
/// so far extend over tenths of it.
const PLACES: usize = 40;
/// How far from a fork that cannot be left they are sought too, in R0.
const BESIDE: [f64; 4] = [1e-3, -1e-3, 1e-2, -1e-2];
/// A branch ends at a fork if it is no farther from it, in z0: it ends at the last point before its
/// mirror image, where states differ by 1e-6 from their images.
const AT_FORK: f64 = 1e-5;

/// A loss of mirror symmetry.
struct Fork {
    branch: usize,
    event: usize,
    point: usize,
    z0: f64,
    depth: usize,
    /// The branches that begin here.
    begun: Vec<usize>,
    /// Those that end here, with their special point if one was located.
    ended: Vec<(usize, Option<usize>)>,
}

/// The symmetric branches of a diagram, as far as they matter here.
#[derive(Default)]
pub(super) struct Symmetric {
    branches: Vec<Branch>,
    forks: Vec<Fork>,
}

/// What was found.
#[derive(Default)]
pub(super) struct Asymmetric {
    pub(super) branches: Vec<BranchRecord>,
    pub(super) joints: Vec<Joint>,
    /// Forks with no branch.
    pub(super) left_out: usize,
    /// Branches that ended early.
    pub(super) unfinished: usize,
    /// Other branch points on them, which nothing follows.
    pub(super) further: usize,
    /// Changes of counts of modes with waves along them.
    pub(super) waves: usize,
    /// Whether as many branches as the case allows were followed.
    pub(super) full: bool,
    pub(super) interrupted: bool,
    pub(super) newton_iterations: usize,
}

impl Fork {
    fn is_met(&self) -> bool {
        !(self.begun.is_empty() && self.ended.is_empty())
    }
}

impl Symmetric {
    /// Keeps a branch and the special points number `forks` on it, where mirror symmetry is lost.
    pub(super) fn add(&mut self, id: usize, depth: usize, branch: &Branch, forks: &[usize]) {
        for &event in forks {
            let at = &branch.events[event];
            let (point, z0) = (at.point, at.p);
            let (begun, ended) = (Vec::new(), Vec::new());
            self.forks.push(Fork { branch: id, event, point, z0, depth, begun, ended });
        }
        self.branches.push(branch.clone());
    }
}

/// Follows the asymmetric branches of a case.
///
/// # Errors
/// When the model refuses the parameters.
pub(super) fn follow(
    case: &ResolvedCase,
    contact: &ContactCase,
    zero_force: Option<f64>,
    symmetric: Symmetric,
    observer: &mut dyn FnMut(DiagramProgress) -> ControlFlow<()>,
) -> Result<Asymmetric, RunError> {
    let half = contact::problem(case, contact)?;
    let film = half.film();
    let problem = TwoPlatesProblem::with_potentials(
        half.shell(),
        &TwoPlatesGroups::equal(half.groups()),
        half.mesh().clone(),
        (film, film),
    )
    .map_err(|error| RunError::Parameters { case: case.name.clone(), error })?;
    let path = contact::path(case);
    let range = symmetric.branches.first().map_or((0.0, 0.0), range);
    let domain = case.diagram.within.unwrap_or(range);
    let settings = Settings { target: None, domain: Some(domain), ..path };
    let mut search = Search {
        case,
        problem: &problem,
        settings,
        zero_force,
        symmetric,
        observer,
        found: Vec::new(),
        out: Asymmetric::default(),
    };
    search.leave_forks();
    if case.diagram.search && case.diagram.depth > 0 {
        search.follow_springs(domain);
    }
    Ok(search.finish())
}

/// The range of the parameter on a branch.
fn range(branch: &Branch) -> (f64, f64) {
    let values = branch.points.iter().map(|point| point.p);
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

struct Search<'s, 'o> {
    case: &'s ResolvedCase,
    problem: &'s TwoPlatesProblem,
    settings: Settings,
    zero_force: Option<f64>,
    symmetric: Symmetric,
    observer: &'s mut (dyn FnMut(DiagramProgress) -> ControlFlow<()> + 'o),
    found: Vec<Branch>,
    out: Asymmetric,
}

impl Search<'_, '_> {
    /// Number of the next branch in the diagram.
    fn next_id(&self) -> usize {
        self.symmetric.branches.len() + self.found.len()
    }

    fn is_full(&mut self) -> bool {
        self.out.full = self.next_id() >= self.case.diagram.max_branches;
        self.out.full || self.out.interrupted
    }

    /// One branch from every fork that none has met yet.
    fn leave_forks(&mut self) {
        for k in 0..self.symmetric.forks.len() {
            let Fork { branch, event, point, depth, .. } = self.symmetric.forks[k];
            let met = self.symmetric.forks[k].is_met();
            if met || depth >= self.case.diagram.depth || self.is_full() {
                continue;
            }
            let trunk = &self.symmetric.branches[branch];
            let unstable = trunk.points[point].unstable;
            let (settings, watches) = (self.settings.clone(), force_watches());
            let (done, waiting) = (self.next_id(), self.symmetric.forks.len() - k);
            let observer = &mut *self.observer;
            let mut listen = |at: &continuation::Progress| observer(progress(done, waiting, at));
            let left = leave_symmetry(
                self.problem,
                trunk,
                point,
                unstable,
                settings,
                &watches,
                &mut listen,
            );
            // one that is too sharp to be left may be met from elsewhere
            let Ok(traced) = left else { continue };
            let id = self.next_id();
            self.symmetric.forks[k].begun.push(id);
            self.take(traced, BranchOrigin::Switch { branch, event }, depth + 1);
        }
    }

    /// Branches on which states lie that are found from two springs.
    fn follow_springs(&mut self, (low, high): (f64, f64)) {
        let unmet = self.symmetric.forks.iter().filter(|fork| !fork.is_met());
        let beside = unmet.flat_map(|fork| BESIDE.map(|d| fork.z0 + d));
        let over = (1..PLACES).map(|k| low + (high - low) * k as f64 / PLACES as f64);
        let places: Vec<f64> = beside.chain(over).filter(|z0| (low..high).contains(z0)).collect();
        for k in 0..self.symmetric.branches.len() {
            let mut before = None;
            loop {
                if self.is_full() {
                    return;
                }
                let known: Vec<&Branch> = self.found.iter().collect();
                let trunk = &self.symmetric.branches[k];
                let Some(state) = next_unconnected(self.problem, trunk, &known, &places) else {
                    break;
                };
                // a branch that does not lead through its own state would be found again and again
                if before == Some((state.z0, state.plates)) {
                    self.out.unfinished += 1;
                    break;
                }
                before = Some((state.z0, state.plates));
                let (settings, watches) = (self.settings.clone(), force_watches());
                let done = self.next_id();
                let observer = &mut *self.observer;
                let mut listen = |at: &continuation::Progress| observer(progress(done, 0, at));
                let traced = follow_asymmetric(
                    self.problem,
                    &state.u,
                    state.z0,
                    settings,
                    &watches,
                    &mut listen,
                );
                let Ok(traced) = traced else {
                    self.out.unfinished += 1;
                    break;
                };
                let depth = 1;
                self.take(traced, BranchOrigin::Springs { branch: k, parameter: state.z0 }, depth);
            }
        }
    }

    /// Adds a branch to what was found, and to the forks that it meets.
    fn take(&mut self, branch: Branch, mut from: BranchOrigin, depth: usize) {
        let id = self.next_id();
        // counts first: they put special points among those that the branch has
        let (done, observer) = (self.next_id(), &mut *self.observer);
        let mut stopped = false;
        let mut traced = ContactBranch::new(branch.clone(), self.zero_force);
        let stability = Stability::of_whole(self.case, self.problem, &mut traced, &mut |branch| {
            let wish = observer(DiagramProgress { branches: done, waiting: 0, branch });
            stopped |= wish.is_break();
            wish
        });
        self.out.interrupted |= stopped;
        self.out.waves += stability.waves() + stability.missed();
        let mut ends = vec![(&branch.stopped, branch.points.last())];
        ends.extend(branch.began.as_ref().map(|began| (began, branch.points.first())));
        for (stop, point) in ends {
            self.out.interrupted |= stop.reason == StopReason::Interrupted;
            let Some(point) = point.filter(|_| stop.reason == StopReason::Retraced) else {
                continue;
            };
            let at = self.problem.parameters_at(point.p);
            let force = self.problem.observation(&point.u, &at).map_or(f64::NAN, |o| o.whole.force);
            // several forks may lie at one distance of the plates
            let nearest = self.symmetric.forks.iter_mut().filter(|fork| {
                let own = &self.symmetric.branches[fork.branch];
                let column = own.observables.iter().position(|name| name == "force");
                let other = column.map_or(f64::NAN, |k| own.points[fork.point].observables[k]);
                (fork.z0 - point.p).abs() < AT_FORK && (other - force).abs() < 0.01 * force.abs()
            });
            let Some(fork) = nearest.last() else { continue };
            if matches!(from, BranchOrigin::Springs { .. }) {
                from = BranchOrigin::Switch { branch: fork.branch, event: fork.event };
                fork.begun.push(id);
            } else {
                fork.ended.push((id, point.event.map(|event| stability.renumbered(event))));
            }
        }
        let complete = branch.is_complete();
        self.out.unfinished += usize::from(!complete);
        self.out.newton_iterations += branch.statistics.newton_iterations;
        let inner = branch.events_of(&continuation::EventKind::BranchPoint);
        let last = branch.points.len().saturating_sub(1);
        self.out.further += inner.filter(|event| event.point > 0 && event.point < last).count();
        let began = branch.began.as_ref().map(|stop| stop.reason);
        let (trace, curve): (TraceResult, Curve) =
            two_plates::on_diagram(self.case, self.problem, &traced, &stability);
        self.out.branches.push(BranchRecord {
            id,
            from,
            depth,
            symmetry: Some(Symmetry::Asymmetric),
            began_because: began,
            near: Vec::new(),
            trace,
            curve,
            orbits: None,
        });
        self.found.push(branch);
    }

    fn finish(mut self) -> Asymmetric {
        for fork in &self.symmetric.forks {
            self.out.left_out += usize::from(!fork.is_met());
            let ended = fork.ended.iter().filter_map(|(id, event)| Some((*id, (*event)?)));
            let passed = std::iter::once((fork.branch, fork.event)).chain(ended).collect();
            let begun = fork.begun.clone();
            self.out.joints.push(Joint { passed, begun, open: usize::from(!fork.is_met()) });
        }
        self.out
    }
}

fn progress(branches: usize, waiting: usize, at: &continuation::Progress) -> DiagramProgress {
    let branch = Progress { points: at.points, events: at.events, parameter: at.p };
    DiagramProgress { branches, waiting, branch }
}
