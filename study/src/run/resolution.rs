//! Whether the elements resolve the film and the shell along a contact branch.

use crate::record::{Cell, ResolutionRecord};
use shell_contact::resolution::{FEWEST_PER_FILM_LENGTH, FEWEST_PER_WAVELENGTH};
use shell_contact::{ContactBranch, ContactProblem, Resolution};

/// Elements per length of the solution, at every point.
pub(super) struct Resolved {
    each: Vec<Option<Resolution>>,
    record: Option<ResolutionRecord>,
}

impl Resolved {
    /// Looks at every point of a branch of `problem`.
    pub(super) fn of(problem: &ContactProblem, traced: &ContactBranch) -> Resolved {
        let branch = &traced.branch;
        let unknowns = problem.mesh().unknowns();
        let height = branch.observables.iter().position(|name| name == "z0");
        let at = |point: &continuation::Point| match height {
            Some(k) => point.observables[k],
            None => point.p,
        };
        let each: Vec<Option<Resolution>> = branch
            .points
            .iter()
            .map(|point| {
                let parameters = problem.parameters_at(at(point));
                problem.resolution(&point.u[..unknowns], &parameters).ok()
            })
            .collect();
        let all = branch.points.iter().zip(&each).filter_map(|(point, one)| Some((point, (*one)?)));
        let worst = all.max_by(|a, b| a.1.factor().total_cmp(&b.1.factor()));
        let record = worst.map(|(point, worst)| ResolutionRecord {
            per_film_length: worst.per_film_length,
            per_wavelength: worst.per_wavelength,
            needed: [FEWEST_PER_FILM_LENGTH, FEWEST_PER_WAVELENGTH],
            z0: at(point),
            enough: worst.is_enough(),
            elements: problem.mesh().elements(),
            wanted: (worst.factor() * problem.mesh().elements() as f64).ceil() as usize,
        });
        Resolved { each, record }
    }

    /// Name of the column.
    pub(super) fn title(&self) -> String {
        "elements_per_film_length".to_owned()
    }

    /// Its cell at a point.
    pub(super) fn cell(&self, index: usize) -> Cell {
        let known = self.each.get(index).copied().flatten();
        let number = known.map(|one| one.per_film_length).filter(|n| n.is_finite());
        number.map_or(Cell::Empty, Cell::from)
    }

    /// The worst of all points.
    pub(super) fn record(&self) -> Option<ResolutionRecord> {
        self.record
    }

    /// A title that says it.
    pub(super) fn titled(&self, title: &str) -> String {
        self.record.map_or_else(|| title.to_owned(), |record| record.titled(title))
    }
}
