//! Case files: what they may say, what is wrong with them, and what they resolve to.
//!
//! A case goes through four steps: `source` finds its text (a file, a shipped case, a problem of
//! the catalogue), `document` parses it and lays the overrides over it, `resolve` checks every
//! key and fills in defaults, and `write` says the result as a case file again.

mod alternatives;
mod catalogue;
mod device;
pub(crate) mod document;
pub(crate) mod error;
mod film;
mod headline;
mod key;
pub mod keys;
pub(crate) mod name;
mod path;
mod physical;
pub(crate) mod picture;
mod problem;
pub(crate) mod reader;
pub(crate) mod resolve;
pub(crate) mod source;
mod stability;
mod values;
mod write;

#[cfg(test)]
mod tests;

pub use alternatives::{Needs, alternatives, needs};
pub use catalogue::catalogue;
pub use document::{Origin, Override, shown};
pub use error::{CaseError, Complaint, LoadError};
pub use film::PASSED_OVER;
pub use headline::headline;
pub use name::plain_name;
pub use path::{PathEnd, PathQuantity, PhysicalPath};
pub use physical::{PhysicalCase, PhysicalPlate, PhysicalShell, Stiffness};
pub use picture::{AxisCase, AxisScale, Parts, PictureCase, picture_of};
pub use problem::{PlateCase, ProblemCase, RingLoadCase, TwoPlatesCase};
pub use source::{SHIPPED, SWEEPS, find, load, load_text, parse};

pub use shell_contact::film::Film;
pub use shell_contact::{Device, Dimensionless, Law, LawName, Shell, landmarks::Wanted};
use std::collections::BTreeMap;

/// A case with every default filled in and every value checked.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedCase {
    /// Name of the case: of its file, or as it says itself.
    pub name: String,
    /// What is solved.
    pub problem: ProblemCase,
    /// Which part of the branch is traced.
    pub path: PathCase,
    /// How far its diagram is explored.
    pub diagram: DiagramCase,
    /// Bounds of the second parameter of a map.
    pub map: MapCase,
    /// What is counted as unstable along the branches of a shell between plates.
    pub stability: StabilityCase,
    /// How its pictures look.
    pub picture: PictureCase,
}

/// Which unstable modes of a contact state are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StabilityCase {
    /// Those that are axisymmetric and mirror images about the equator.
    Axisymmetric,
    /// All but torsion.
    Full {
        /// Most waves around the axis.
        max_n: usize,
    },
}

impl StabilityCase {
    /// The names that a case file may use.
    pub const NAMES: [&'static str; 2] = ["full", "axisymmetric"];
}

impl Default for StabilityCase {
    fn default() -> Self {
        StabilityCase::Full { max_n: 40 }
    }
}

/// A microbubble between two plates.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactCase {
    /// The shell's material.
    pub shell: Shell,
    /// The dimensionless groups, always present.
    pub groups: Dimensionless,
    /// The potential of the film.
    pub potential: Film,
    /// The physical parameters the groups came from, if the case gave those.
    pub physical: Option<Box<PhysicalCase>>,
    /// The mesh.
    pub mesh: MeshCase,
    /// What holds the plates.
    pub device: Device,
    /// Special points that are looked for besides those of every branch.
    pub events: Wanted,
}

/// A problem of the catalogue.
#[derive(Debug, Clone, PartialEq)]
pub struct CatalogueCase {
    /// Its name.
    pub name: String,
    /// Its parameters by name, the continued one not among them.
    pub parameters: BTreeMap<String, f64>,
    /// Number of elements, for problems that have a mesh.
    pub elements: Option<usize>,
}

/// The mesh along the meridian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshCase {
    /// Number of elements.
    pub elements: usize,
    /// Longest element over shortest, shrinking towards the pole; uniform without it.
    pub grading: Option<f64>,
    /// Error of the mesh to stay below, in `√(χk_b)`; the elements are chosen for it, and those above are not used.
    pub tolerance: Option<f64>,
}

/// Which part of the branch is traced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathCase {
    /// Where the continued parameter starts.
    pub start: f64,
    /// Where it ends.
    pub end: f64,
    /// Longest step, as arclength in the problem's metric; the tracer's default without it.
    pub max_step: Option<f64>,
    /// Shortest step, likewise.
    pub min_step: Option<f64>,
    /// Largest number of points.
    pub max_points: usize,
    /// Number of eigenvalues to compute at every point.
    pub eigenvalues: usize,
}

/// How far a diagram is explored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagramCase {
    /// Most branch points between a branch and the first one.
    pub depth: usize,
    /// Most branches.
    pub max_branches: usize,
    /// Bounds of the parameter, in which the first branch is followed both ways; without them it
    /// goes from the path's start to its end, and the others stay where it has been.
    pub within: Option<(f64, f64)>,
    /// Whether disconnected branches are sought beside near-bifurcations.
    pub search: bool,
    /// Whether the periodic orbits that leave Hopf points are followed.
    pub cycles: bool,
    /// Most period doublings and branch points between a branch of cycles and its Hopf point.
    pub cycle_depth: usize,
}

impl Default for DiagramCase {
    fn default() -> Self {
        DiagramCase {
            depth: 2,
            max_branches: 1000,
            within: None,
            search: true,
            cycles: false,
            cycle_depth: 1,
        }
    }
}

/// Bounds of the second parameter of a map; the command has defaults.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MapCase {
    /// The lower one.
    pub from: Option<f64>,
    /// The upper one.
    pub to: Option<f64>,
}

/// What the command line needs to know about a problem of the catalogue.
#[derive(Debug, Clone, PartialEq)]
pub struct CatalogueEntry {
    /// Its name on the command line and in case files.
    pub name: String,
    /// One line for people.
    pub summary: String,
    /// Name of the continued parameter.
    pub parameter: String,
    /// The parameter and the observables, by name, with what axes of pictures call them.
    pub axes: Vec<(String, String)>,
    /// Where the continued parameter starts by default.
    pub start: f64,
    /// Where it ends by default.
    pub end: f64,
    /// Where the continued parameter may start.
    pub start_allowed: problems::Allowed,
    /// The other parameters.
    pub parameters: Vec<CatalogueParameter>,
    /// Number of elements, for problems that have a mesh.
    pub elements: Option<ElementRange>,
}

/// A parameter of a problem of the catalogue.
#[derive(Debug, Clone, PartialEq)]
pub struct CatalogueParameter {
    /// Its name.
    pub name: String,
    /// Its default.
    pub default: f64,
    /// What it may be.
    pub allowed: problems::Allowed,
}

/// How many elements a mesh may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElementRange {
    /// The default.
    pub default: usize,
    /// The smallest.
    pub least: usize,
    /// The largest.
    pub most: usize,
}

/// A case, and what deserves to be said about it though it is not wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedCase {
    /// The case.
    pub case: ResolvedCase,
    /// Remarks for people.
    pub notes: Vec<String>,
    /// Whether its text has a table `[stability]`, or all of that is a default.
    pub says_stability: bool,
}
