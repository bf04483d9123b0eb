//! Modes with waves around the axis about the states of a branch that are not their own mirror images.

use super::Progress;
use crate::case::{ResolvedCase, StabilityCase};
use crate::output::{Cell, StabilityRecord};
use crate::pictures::Examined;
use continuation::{Branch, Point};
use shell_contact::modes::{WholeModes, WholeScan};
use shell_contact::two_plates::TwoPlatesProblem;
use std::ops::ControlFlow;

/// Counts for each point, as far as they were asked for.
#[derive(Default)]
pub(super) struct Waves {
    scans: Vec<WholeScan>,
    points: usize,
}

impl Waves {
    /// Counts along a branch; where the counts change is not located.
    pub(super) fn of(
        case: &ResolvedCase,
        problem: &TwoPlatesProblem,
        branch: &Branch,
        observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Waves {
        let StabilityCase::Full { max_n } = case.stability else { return Waves::default() };
        let (points, events) = (branch.points.len(), branch.events.len());
        let mut modes = WholeModes::new(problem.mesh());
        let mut scans = Vec::with_capacity(points);
        for point in &branch.points {
            let p = problem.parameters_at(point.p);
            // a branch of admissible states: from one that is refused on nothing is known
            if modes.assemble(problem, &point.u, &p).is_err() {
                break;
            }
            scans.push(modes.scan(max_n));
            if observer(Progress { points, events, parameter: point.p }).is_break() {
                break;
            }
        }
        Waves { scans, points }
    }

    /// Cells of a point, in the columns of [`super::stability::Stability::NAMES`]; modes that break a
    /// mirror symmetry are none where there is no such symmetry.
    pub(super) fn cells(&self, index: usize, point: &Point) -> [Cell; 4] {
        let Some(scan) = self.scans.get(index) else {
            return [Cell::Empty, Cell::Empty, Cell::Empty, Cell::Empty];
        };
        let word = match point.unstable {
            Some(0) if scan.modes == 0 && scan.certain && point.certified => "yes",
            Some(0) if scan.modes == 0 => "unknown",
            Some(_) => "no",
            None if scan.modes > 0 => "no",
            None => "unknown",
        };
        [Cell::Empty, scan.modes.into(), scan.first_n.into(), word.into()]
    }

    /// Whether modes with waves are unstable, for each point.
    pub(super) fn unstable(&self) -> Vec<bool> {
        self.scans.iter().map(|scan| scan.modes > 0).collect()
    }

    /// Which modes were examined.
    pub(super) fn examined(&self) -> Examined {
        match self.is_full() {
            true => Examined::AxisymmetricAndOthers,
            false => Examined::AxisymmetricBothParities,
        }
    }

    fn is_full(&self) -> bool {
        !self.scans.is_empty()
    }

    /// What was looked at.
    pub(super) fn record(&self) -> StabilityRecord {
        let complete = self.scans.len() == self.points;
        // of every number of waves, as nothing tells which of its modes turned
        let changes = self.scans.windows(2).map(|pair| {
            let count = |scan: &WholeScan, n: usize| scan.by_wave.get(n).map_or(0, |c| c.negative);
            let waves = pair[0].n_max.max(pair[1].n_max);
            (0..waves).filter(|n| count(&pair[0], *n) != count(&pair[1], *n)).count()
        });
        StabilityRecord {
            full: self.is_full(),
            both_parities: true,
            max_n: self.scans.iter().map(|scan| scan.n_max).max(),
            certain: self.is_full().then(|| complete && self.scans.iter().all(|s| s.certain)),
            not_located: changes.sum(),
        }
    }
}
