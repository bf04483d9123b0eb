//! What is unstable along a contact branch beyond the modes that the branch counts itself.

use super::{Observer, Progress};
use crate::case::{ResolvedCase, StabilityCase};
use crate::output::{Cell, ModeRecord, StabilityRecord};
use continuation::{Branch, Event, EventKind, Point, Problem, StopReason};
use shell_contact::modes::{Scan, ScanSettings, Scanned, SymmetryBreaking, scan_branch};
use shell_contact::{ContactBranch, ContactProblem};

/// Kind of the states at which a mode without the branch's symmetries turns.
pub(super) const KIND: &str = "symmetry-breaking";

/// Counts for each point, and the modes of the special points that were found.
#[derive(Default)]
pub(super) struct Stability {
    /// One for each point; empty when only the branch's own counts were asked for.
    scans: Vec<Scan>,
    /// In order along the branch.
    modes: Vec<ModeRecord>,
    missed: usize,
    full: bool,
    /// Whether it was interrupted.
    partial: bool,
}

impl Stability {
    /// Scans a traced branch if the case asks for it, and puts the special points found among its
    /// own. Under a device that is no grip they are counted, not located.
    pub(super) fn of(
        case: &ResolvedCase,
        problem: &ContactProblem,
        traced: &mut ContactBranch,
        observer: &mut Observer<'_>,
    ) -> Stability {
        let StabilityCase::Full { max_n } = case.stability else { return Stability::default() };
        if traced.branch.stopped.reason == StopReason::Interrupted {
            return Stability::default();
        }
        let settings = ScanSettings { max_n, ..ScanSettings::default() };
        let branch = &mut traced.branch;
        let (points, events) = (branch.points.len(), branch.events.len());
        let parameter = branch.points.last().map_or(f64::NAN, |point| point.p);
        let go_on = &mut |_| observer(Progress { points, events, parameter });
        // a branch of admissible states: what is refused is left without counts
        let Ok(scanned) = scan_branch(problem, branch, &settings, go_on) else {
            return Stability::default();
        };
        if branch.parameter != "z0" {
            let missed = scanned.events.len() + scanned.missed.len();
            let partial = scanned.points.len() < points;
            return Stability {
                scans: scanned.points,
                missed,
                full: true,
                partial,
                modes: Vec::new(),
            };
        }
        insert(problem, branch, scanned)
    }

    /// Names of the columns.
    pub(super) fn titles(&self) -> Vec<String> {
        let names = ["unstable_antisymmetric", "unstable_modes", "first_n", "stable"];
        if self.full { names.map(str::to_owned).to_vec() } else { Vec::new() }
    }

    /// Cells of a point.
    pub(super) fn cells(&self, index: usize, point: &Point) -> Vec<Cell> {
        let Some(scan) = self.scans.get(index) else { return Vec::new() };
        let word = match self.is_unstable(index, point) {
            true => "no",
            false if scan.certain && point.certified && point.unstable.is_some() => "yes",
            false => "unknown",
        };
        vec![scan.antisymmetric.into(), scan.modes.into(), scan.first_n.into(), word.into()]
    }

    /// Whether anything that was counted is unstable.
    pub(super) fn is_unstable(&self, index: usize, point: &Point) -> bool {
        let beyond = self.scans.get(index).is_some_and(|s| s.antisymmetric + s.modes > 0);
        beyond || point.unstable.is_some_and(|n| n > 0)
    }

    /// The mode of the branch's special point number `event`.
    pub(super) fn mode(&self, branch: &Branch, event: usize) -> Option<ModeRecord> {
        let own = |e: &&Event| e.kind == EventKind::Named(KIND.to_owned());
        own(&branch.events.get(event)?).then_some(())?;
        self.modes.get(branch.events[..event].iter().filter(own).count()).copied()
    }

    /// What was looked at.
    pub(super) fn record(&self) -> StabilityRecord {
        let largest = self.scans.iter().map(|scan| scan.n_max).max();
        StabilityRecord {
            full: self.full,
            max_n: largest.filter(|_| self.full),
            certain: self.full.then(|| !self.partial && self.scans.iter().all(|s| s.certain)),
            not_located: self.missed,
        }
    }
}

fn insert(problem: &ContactProblem, branch: &mut Branch, scanned: Scanned) -> Stability {
    let Scanned { points: counts, events, missed } = scanned;
    let mut out = Stability { missed: missed.len(), full: true, ..Stability::default() };
    let old = std::mem::take(&mut branch.points);
    out.partial = counts.len() < old.len();
    let mut place = Vec::with_capacity(old.len());
    let mut found = events.iter().peekable();
    let mut marks = Vec::new();
    for (index, point) in old.iter().enumerate() {
        place.push(branch.points.len());
        branch.points.push(Point { event: None, ..point.clone() });
        let own = counts.get(index);
        out.scans.extend(own.cloned());
        while let Some(one) = found.next_if(|one| one.after_point == index) {
            let Some((next, after)) = old.get(index + 1).zip(counts.get(index + 1)) else { break };
            let Some(state) = between(problem, point, next, one) else {
                out.missed += 1;
                continue;
            };
            // the state is marginal: it counts as the side of it on which more is unstable
            let more =
                own.filter(|s| s.modes + s.antisymmetric > after.modes + after.antisymmetric);
            out.scans.push(more.unwrap_or(after).clone());
            out.modes.push(ModeRecord {
                n: one.n,
                parity: one.parity.name(),
                before: one.modes_before,
                after: one.modes_after,
            });
            let mut residual = vec![0.0; problem.dim()];
            let known = problem.residual(&one.u, &problem.parameters_at(one.z0), &mut residual);
            let largest = residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
            marks.push(Event {
                kind: EventKind::Named(KIND.to_owned()),
                point: branch.points.len(),
                p: one.z0,
                unstable_before: point.unstable,
                unstable_after: next.unstable,
                residual: if known.is_ok() { largest } else { f64::NAN },
                error_estimate: one.error_estimate,
                detail: continuation::Detail::default(),
                eigenvectors: Vec::new(),
            });
            branch.points.push(state);
        }
    }
    for event in &mut branch.events {
        event.point = place.get(event.point).copied().unwrap_or(event.point);
    }
    branch.events.extend(marks);
    branch.events.sort_by_key(|event| event.point);
    for (k, event) in branch.events.iter().enumerate() {
        if let Some(point) = branch.points.get_mut(event.point) {
            point.event = Some(k);
        }
    }
    out
}

/// The state of a special point as a point of the branch.
fn between(
    problem: &ContactProblem,
    a: &Point,
    b: &Point,
    one: &SymmetryBreaking,
) -> Option<Point> {
    let mut observables = vec![0.0; a.observables.len()];
    problem.observe(&one.u, &problem.parameters_at(one.z0), &mut observables).ok()?;
    let at = |x: f64, y: f64| x + one.share * (y - x);
    Some(Point {
        s: at(a.s, b.s),
        p: one.z0,
        u: one.u.clone(),
        dp_ds: at(a.dp_ds, b.dp_ds),
        // between two points of one count it is theirs
        unstable: a.unstable.filter(|_| a.unstable == b.unstable),
        certified: a.certified && b.certified && a.unstable == b.unstable,
        eigenvalues: Vec::new(),
        observables,
        event: None,
    })
}
