//! Counts along a traced branch, and where they change.
//!
//! Whatever holds the plates, the symmetric states of a shell lie on one curve in `(u, z0)`; the
//! modes looked for here do not feel the device. Every point of the branch is counted, and a count
//! that differs between neighbours is traced to the state where it changes (module `locate`).

use super::locate::{Chord, Class, HalfCounter, Locator, WholeCounter};
use super::{
    AsymmetricModes, ModeCount, ModeShape, Parity, Scan, WholeModes, WholeScan, WholeShell,
};
use crate::contact::ContactProblem;
use continuation::{Branch, EvalError, Problem};
use std::ops::ControlFlow;

/// How a branch is scanned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanSettings {
    /// The largest wave number that is examined.
    pub max_n: usize,
    /// Width in `z0` to which an onset is enclosed.
    pub tolerance: f64,
}

impl Default for ScanSettings {
    fn default() -> Self {
        ScanSettings { max_n: 40, tolerance: 1e-10 }
    }
}

/// A state at which a mode without the symmetries of the branch becomes unstable, or stable again.
#[derive(Debug, Clone, PartialEq)]
pub struct SymmetryBreaking {
    /// The branch's point before it; it lies between this one and the next.
    pub after_point: usize,
    /// Where between the two, from 0 to 1.
    pub share: f64,
    /// Plate distance; of a branch from pole to pole its own parameter.
    pub z0: f64,
    /// Unknowns of the problem.
    pub u: Vec<f64>,
    /// Waves around the axis.
    pub n: usize,
    /// Parity of the mode, if it has one: about a state from pole to pole it may have none.
    pub parity: Option<Parity>,
    /// Unstable modes of this class before, along the branch.
    pub modes_before: usize,
    /// And after.
    pub modes_after: usize,
    /// Width in `z0` of the interval at whose ends the counts differ.
    pub error_estimate: f64,
    /// Unknowns and plate distance at the other end of that interval.
    pub other_end: (Vec<f64>, f64),
    /// Eigenvalue of the mode at this state, zero but for the error.
    pub eigenvalue: f64,
    /// The mode.
    pub mode_shape: ModeShape,
}

/// A branch with what is unstable at each point beyond its own counts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scanned {
    /// One for each point of the branch that was reached.
    pub points: Vec<Scan>,
    /// Where a count changes, in order along the branch.
    pub events: Vec<SymmetryBreaking>,
    /// Changes between points that could not be enclosed: point before, `n`, parity.
    pub missed: Vec<(usize, usize, Parity)>,
}

/// Counts the unstable modes of every point of `branch` and locates the changes; `observer` is
/// told the number of points done and may end the work.
///
/// # Errors
/// When a point of the branch is no admissible state of the problem.
pub fn scan_branch(
    problem: &ContactProblem,
    branch: &Branch,
    settings: &ScanSettings,
    observer: &mut dyn FnMut(usize) -> ControlFlow<()>,
) -> Result<Scanned, EvalError> {
    let modes = AsymmetricModes::new(problem.mesh());
    let mut locator = Locator::new(HalfCounter { problem, modes });
    let mut scanned = Scanned::default();
    let height = branch.observables.iter().position(|name| name == "z0");
    let mut before: Option<(Vec<f64>, f64)> = None;
    for (index, point) in branch.points.iter().enumerate() {
        let z0 = height.map_or(point.p, |k| point.observables[k]);
        let u = &point.u[..problem.dim().min(point.u.len())];
        locator.counter.modes.assemble(problem, u, &problem.parameters_at(z0))?;
        let scan = locator.counter.modes.scan(settings.max_n);
        if let (Some((from, at)), Some(old)) = (&before, scanned.points.last()) {
            let changed: Vec<Class> = classes(old, &scan)
                .filter_map(|(n, parity)| {
                    let counts = [old, &scan].map(|scan| class(scan, n, parity).negative);
                    (counts[0] != counts[1]).then(|| Class::new(n, parity, counts))
                })
                .collect();
            if !changed.is_empty() {
                let chord = Chord::new(problem, [from, u], [*at, z0], index - 1);
                locator.locate(&chord, changed, settings, &mut scanned);
            }
        }
        before = Some((u.to_vec(), z0));
        scanned.points.push(scan);
        if observer(index + 1).is_break() {
            break;
        }
    }
    scanned.sort();
    Ok(scanned)
}

/// The same of a branch from pole to pole, in its own parameter. Axisymmetric modes are among those that
/// the branch counts itself: [`Scan::antisymmetric`] is zero, and of either parity together the counts
/// of waves stand with [`Parity::Symmetric`].
///
/// # Errors
/// When a point of the branch is no admissible state of the problem.
pub fn scan_whole_branch<P: WholeShell>(
    problem: &P,
    branch: &Branch,
    settings: &ScanSettings,
    observer: &mut dyn FnMut(usize) -> ControlFlow<()>,
) -> Result<Scanned, EvalError> {
    let modes = WholeModes::new(problem.half_mesh());
    let mut locator = Locator::new(WholeCounter { problem, modes });
    let mut scanned = Scanned::default();
    for (index, point) in branch.points.iter().enumerate() {
        let p = problem.parameters_at(point.p);
        problem.assemble_modes(&point.u, &p, &mut locator.counter.modes)?;
        let scan = Scan::of_whole(locator.counter.modes.scan(settings.max_n));
        let before = index.checked_sub(1).map(|k| &branch.points[k]);
        if let (Some(before), Some(old)) = (before, scanned.points.last()) {
            let waves = old.n_max.max(scan.n_max);
            let changed: Vec<Class> = (1..=waves)
                .filter_map(|n| {
                    let counts =
                        [old, &scan].map(|scan| class(scan, n, Parity::Symmetric).negative);
                    let differ = counts[0] != counts[1];
                    differ.then(|| Class::new(n, Parity::Symmetric, counts))
                })
                .collect();
            if !changed.is_empty() {
                let (ends, at) = ([&before.u[..], &point.u], [before.p, point.p]);
                let chord = Chord::new(problem, ends, at, index - 1);
                locator.locate(&chord, changed, settings, &mut scanned);
            }
        }
        scanned.points.push(scan);
        if observer(index + 1).is_break() {
            break;
        }
    }
    scanned.sort();
    scanned.forget_parities();
    Ok(scanned)
}

impl Scanned {
    /// Where two modes of as many waves turn within the error of their places, the mode found may be
    /// either's.
    fn forget_parities(&mut self) {
        for k in 1..self.events.len() {
            let (before, after) = self.events.split_at_mut(k);
            let b = &mut after[0];
            for a in before.iter_mut().filter(|a| a.n == b.n) {
                if (a.z0 - b.z0).abs() <= a.error_estimate + b.error_estimate {
                    (a.parity, b.parity) = (None, None);
                }
            }
        }
    }

    /// Events in order along the branch.
    fn sort(&mut self) {
        self.events.sort_by(|a, b| {
            (a.after_point, a.share).partial_cmp(&(b.after_point, b.share)).unwrap_or(a.n.cmp(&b.n))
        });
    }
}

impl Scan {
    fn of_whole(scan: WholeScan) -> Scan {
        let none = ModeCount { negative: 0, certain: true };
        Scan {
            antisymmetric: 0,
            antisymmetric_certain: true,
            modes: scan.modes,
            first_n: scan.first_n,
            n_max: scan.n_max,
            certain: scan.certain,
            by_wave: scan.by_wave.into_iter().map(|count| [count, none]).collect(),
        }
    }
}

/// All classes of two scans.
fn classes(a: &Scan, b: &Scan) -> impl Iterator<Item = (usize, Parity)> + use<> {
    let waves = a.n_max.max(b.n_max);
    let all = (1..=waves).flat_map(|n| Parity::BOTH.map(|parity| (n, parity)));
    std::iter::once((0, Parity::Antisymmetric)).chain(all)
}

/// The count of a class; beyond what was examined the bound says none.
fn class(scan: &Scan, n: usize, parity: Parity) -> ModeCount {
    if n == 0 {
        return ModeCount { negative: scan.antisymmetric, certain: scan.certain };
    }
    scan.count(n, parity).unwrap_or(ModeCount { negative: 0, certain: scan.certain })
}
