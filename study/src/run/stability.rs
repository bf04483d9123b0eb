//! What is unstable along a contact branch beyond the modes that the branch counts itself.

use super::{Observer, Progress};
use crate::case::{ResolvedCase, StabilityCase};
use crate::record::view::Examined;
use crate::record::{Cell, ModeRecord, ShapeRecord, StabilityRecord};
use continuation::{Branch, Event, EventKind, Point, StopReason};
use shell_contact::device::Loading;
use shell_contact::modes::{
    ModeShape, Parity, Scan, ScanSettings, Scanned, SymmetryBreaking, WholeShell, scan_branch,
    scan_whole_branch,
};
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
    /// Their amplitudes.
    shapes: Vec<ModeShape>,
    /// The new number of each special point that the branch had.
    renumbered: Vec<usize>,
    missed: usize,
    full: bool,
    /// Whether the branch itself counts the axisymmetric modes of both parities.
    whole: bool,
    /// Whether it was interrupted.
    partial: bool,
}

/// The word for the parity of a mode.
fn parity(parity: Option<Parity>) -> &'static str {
    parity.map_or("none", Parity::name)
}

impl Stability {
    /// Names of its columns.
    pub(super) const NAMES: [&str; 4] =
        ["unstable_antisymmetric", "unstable_modes", "first_n", "stable"];

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
                ..Stability::default()
            };
        }
        insert(problem, branch, scanned)
    }

    /// How a case wants modes without the symmetries of the branch to be counted, if it does.
    pub(super) fn scan(case: &ResolvedCase) -> Option<ScanSettings> {
        match case.stability {
            StabilityCase::Full { max_n } => {
                Some(ScanSettings { max_n, ..ScanSettings::default() })
            }
            StabilityCase::Axisymmetric => None,
        }
    }

    /// A branch of mirror images from pole to pole, of which the modes with waves have been counted on
    /// half the shell.
    pub(super) fn of_symmetric<P: WholeShell>(
        case: &ResolvedCase,
        problem: &P,
        traced: &mut ContactBranch,
        waves: Scanned,
    ) -> Stability {
        let none = Stability { whole: true, ..Stability::default() };
        let stopped = traced.branch.stopped.reason;
        if case.stability == StabilityCase::Axisymmetric || stopped == StopReason::Interrupted {
            return none;
        }
        Stability { whole: true, ..insert(problem, &mut traced.branch, waves) }
    }

    /// The same of a branch from pole to pole, in its own parameter; its axisymmetric modes of both
    /// parities it counts itself.
    pub(super) fn of_whole<P: WholeShell>(
        case: &ResolvedCase,
        problem: &P,
        traced: &mut ContactBranch,
        observer: &mut Observer<'_>,
    ) -> Stability {
        let none = Stability { whole: true, ..Stability::default() };
        let StabilityCase::Full { max_n } = case.stability else { return none };
        let branch = &mut traced.branch;
        if branch.stopped.reason == StopReason::Interrupted {
            return none;
        }
        let settings = ScanSettings { max_n, ..ScanSettings::default() };
        let (points, events) = (branch.points.len(), branch.events.len());
        let parameter = branch.points.last().map_or(f64::NAN, |point| point.p);
        let go_on = &mut |_| observer(Progress { points, events, parameter });
        let Ok(scanned) = scan_whole_branch(problem, branch, &settings, go_on) else {
            return none;
        };
        Stability { whole: true, ..insert(problem, branch, scanned) }
    }

    /// Names of the columns.
    pub(super) fn titles(&self) -> Vec<String> {
        if self.full { Self::NAMES.map(str::to_owned).to_vec() } else { Vec::new() }
    }

    /// Cells of a point.
    pub(super) fn cells(&self, index: usize, point: &Point) -> Vec<Cell> {
        let Some(scan) = self.scans.get(index) else { return Vec::new() };
        let word = match self.is_unstable(index, point) {
            true => "no",
            false if scan.certain && point.certified && point.unstable.is_some() => "yes",
            false => "unknown",
        };
        let antisymmetric = if self.whole { Cell::Empty } else { scan.antisymmetric.into() };
        vec![antisymmetric, scan.modes.into(), scan.first_n.into(), word.into()]
    }

    /// Whether anything that was counted is unstable.
    pub(super) fn is_unstable(&self, index: usize, point: &Point) -> bool {
        self.is_asymmetric(index) || point.unstable.is_some_and(|n| n > 0)
    }

    /// Whether modes without the symmetries of the branch are unstable.
    pub(super) fn is_asymmetric(&self, index: usize) -> bool {
        self.scans.get(index).is_some_and(|s| s.antisymmetric + s.modes > 0)
    }

    /// Which modes were examined.
    pub(super) fn examined(&self) -> Examined {
        match (self.full, self.whole) {
            (true, _) => Examined::AxisymmetricAndOthers,
            (false, true) => Examined::AxisymmetricBothParities,
            (false, false) => Examined::Axisymmetric,
        }
    }

    /// Whether a special point is drawn: of those at which symmetry is lost, the ones where the
    /// first such mode becomes unstable or the last one stable again.
    pub(super) fn is_drawn(&self, event: &Event) -> bool {
        let at = event.point;
        event.kind != EventKind::Named(KIND.to_owned())
            || at == 0
            || self.is_asymmetric(at - 1) != self.is_asymmetric(at + 1)
    }

    /// The number that a special point of the branch has now.
    pub(super) fn renumbered(&self, event: usize) -> usize {
        self.renumbered.get(event).copied().unwrap_or(event)
    }

    /// The mode of the branch's special point number `event`.
    pub(super) fn mode(&self, branch: &Branch, event: usize) -> Option<ModeRecord> {
        let own = |e: &&Event| e.kind == EventKind::Named(KIND.to_owned());
        own(&branch.events.get(event)?).then_some(())?;
        self.modes.get(branch.events[..event].iter().filter(own).count()).copied()
    }

    /// The modes of the branch's special points with their amplitudes.
    pub(super) fn shapes(&self, branch: &Branch) -> Vec<ShapeRecord> {
        let breaking = (0..branch.events.len()).filter(|k| self.mode(branch, *k).is_some());
        let records = breaking.zip(self.modes.iter().zip(&self.shapes));
        records
            .map(|(event, (mode, shape))| ShapeRecord {
                event,
                n: mode.n,
                parity: mode.parity,
                s: shape.s.clone(),
                amplitudes: [&shape.u, &shape.v, &shape.w].map(Clone::clone),
            })
            .collect()
    }

    /// The special points at which the mirror symmetry is lost or regained.
    pub(super) fn forks(&self, branch: &Branch) -> Vec<usize> {
        let is_fork = |event: &usize| self.mode(branch, *event).is_some_and(|mode| mode.n == 0);
        (0..branch.events.len()).filter(is_fork).collect()
    }

    /// Number of special points at which modes with waves around the axis turn.
    pub(super) fn waves(&self) -> usize {
        self.modes.iter().filter(|mode| mode.n > 0).count()
    }

    /// Number of changes of counts that were not located.
    pub(super) fn missed(&self) -> usize {
        self.missed
    }

    /// What was looked at.
    pub(super) fn record(&self) -> StabilityRecord {
        let largest = self.scans.iter().map(|scan| scan.n_max).max();
        StabilityRecord {
            full: self.full,
            both_parities: self.whole,
            max_n: largest.filter(|_| self.full),
            certain: self.full.then(|| !self.partial && self.scans.iter().all(|s| s.certain)),
            not_located: self.missed,
        }
    }
}

fn insert<P: Loading>(problem: &P, branch: &mut Branch, scanned: Scanned) -> Stability {
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
            out.shapes.push(one.mode_shape.clone());
            out.modes.push(ModeRecord {
                n: one.n,
                parity: parity(one.parity),
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
    let own = branch.events.drain(..).enumerate().map(|(k, event)| (Some(k), event));
    let mut events: Vec<_> = own.chain(marks.into_iter().map(|event| (None, event))).collect();
    events.sort_by_key(|(_, event)| event.point);
    out.renumbered = vec![0; events.iter().filter(|(old, _)| old.is_some()).count()];
    for (new, (old, event)) in events.into_iter().enumerate() {
        if let Some(old) = old {
            out.renumbered[old] = new;
        }
        branch.events.push(event);
    }
    for (k, event) in branch.events.iter().enumerate() {
        if let Some(point) = branch.points.get_mut(event.point) {
            point.event = Some(k);
        }
    }
    out
}

/// The state of a special point as a point of the branch.
fn between<P: Loading>(problem: &P, a: &Point, b: &Point, one: &SymmetryBreaking) -> Option<Point> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use continuation::Settings;
    use shell_contact::{Dimensionless, Law, Mesh, Shell, trace_contact};
    use std::ops::ControlFlow;

    #[test]
    fn special_points_keep_their_names_among_those_that_are_put_in() {
        let groups = Dimensionless {
            bending: 3e-5,
            pressure: 3e-3,
            adhesion: 2e-3,
            film: 1.0 / 30.0,
            surface_tension: 0.0,
            gas_exponent: 1.07,
        };
        let shell = Shell { law: Law::Hooke, poisson: 0.5 };
        let problem = ContactProblem::new(&shell, &groups, Mesh::uniform(50).unwrap()).unwrap();
        let settings = Settings { target: Some(0.815), ..Settings::default() };
        let go_on = ControlFlow::Continue(());
        let mut branch = trace_contact(&problem, 1.15, settings, &mut |_| go_on).unwrap().branch;
        let old = branch.events.clone();
        let scanned =
            scan_branch(&problem, &branch, &ScanSettings::default(), &mut |_| go_on).unwrap();
        let found = scanned.events.len();
        let stability = insert(&problem, &mut branch, scanned);
        assert!(old.len() > 4 && found > 10, "{} {found}", old.len());
        assert_eq!(branch.events.len(), old.len() + found);
        assert_eq!(stability.scans.len(), branch.points.len());
        for (k, event) in old.iter().enumerate() {
            let now = &branch.events[stability.renumbered(k)];
            assert_eq!((&now.kind, now.p), (&event.kind, event.p));
        }
        for (k, event) in branch.events.iter().enumerate() {
            assert_eq!(branch.points[event.point].event, Some(k));
            let own = event.kind == EventKind::Named(KIND.to_owned());
            assert_eq!(stability.mode(&branch, k).is_some(), own);
        }
        // of the losses of symmetry those are drawn where stability against them begins or ends
        let drawn = branch
            .events
            .iter()
            .filter(|e| e.kind == EventKind::Named(KIND.to_owned()) && stability.is_drawn(e));
        let places: Vec<f64> = drawn.map(|e| (e.p * 1e3).round()).collect();
        assert_eq!(places, [1030.0, 819.0, 873.0, 870.0]);
    }
}
