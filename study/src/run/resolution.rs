//! Whether the elements resolve the film and the shell along a contact branch.

use super::mesh_error::MeshErrors;
use crate::case::MeshCase;
use crate::record::{Cell, ResolutionRecord};
use continuation::{Branch, Point};
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
        let unknowns = problem.mesh().unknowns();
        let height = height(&traced.branch);
        let sites = problem.resolution_sites();
        let look = |point: &Point| {
            let parameters = problem.parameters_at(height(point));
            problem.resolution_at(&sites, &point.u[..unknowns], &parameters).ok()
        };
        let each = traced.branch.points.iter().map(look).collect();
        Resolved::along(&traced.branch, problem.mesh().elements(), ("z0", height), each)
    }

    /// What is known at `each` point of a branch; `place` is where it is, in the quantity `parameter`.
    pub(super) fn along(
        branch: &Branch,
        elements: usize,
        (parameter, place): (&'static str, impl Fn(&Point) -> f64),
        each: Vec<Option<Resolution>>,
    ) -> Resolved {
        let all = branch.points.iter().zip(&each).filter_map(|(point, one)| Some((point, (*one)?)));
        let worst = all.max_by(|a, b| a.1.factor().total_cmp(&b.1.factor()));
        let record = worst.map(|(point, worst)| ResolutionRecord {
            per_film_length: worst.per_film_length,
            per_wavelength: worst.per_wavelength,
            needed: [FEWEST_PER_FILM_LENGTH, FEWEST_PER_WAVELENGTH],
            at: place(point),
            parameter,
            enough: worst.is_enough(),
            elements,
            wanted: (worst.factor() * elements as f64).ceil() as usize,
            mesh_error: None,
            tolerance: None,
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

    /// The same with what is known of the mesh's errors, and what was asked for.
    pub(super) fn with(mut self, errors: &MeshErrors, mesh: &MeshCase) -> Resolved {
        if let Some(record) = &mut self.record {
            record.mesh_error = errors.record();
            record.tolerance = mesh.tolerance;
        }
        self
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

/// Half the distance of the plates at a point, which a device reports beside its own parameter.
pub(super) fn height(branch: &Branch) -> impl Fn(&Point) -> f64 + Copy + use<> {
    let at = branch.observables.iter().position(|name| name == "z0");
    move |point| at.map_or(point.p, |k| point.observables[k])
}
