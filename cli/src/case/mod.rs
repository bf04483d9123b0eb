//! Case files: what they may say, what is wrong with them, and what they resolve to.
//!
//! A case goes through four rooms: [`source`] finds its text (a file, a shipped case, a problem of
//! the catalogue), [`document`] parses it and lays the overrides over it, [`resolve`] checks every
//! key and fills in defaults, and [`mod@write`] says the result as a case file again.

mod device;
pub(crate) mod document;
pub(crate) mod error;
pub(crate) mod name;
mod physical;
pub(crate) mod reader;
pub(crate) mod resolve;
pub(crate) mod source;
mod stability;
mod two_plates;
mod write;

#[cfg(test)]
mod tests;

pub(crate) use device::DeviceCase;
pub(crate) use document::Override;
pub(crate) use error::LoadError;
pub(crate) use physical::{PhysicalCase, Stiffness};
pub(crate) use source::{SHIPPED, SWEEPS, load, load_text};

use std::collections::BTreeMap;
use std::fmt;

/// A case with every default filled in and every value checked.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ResolvedCase {
    /// Name of the case: of its file, or as it says itself.
    pub(crate) name: String,
    /// What is solved.
    pub(crate) problem: ProblemCase,
    /// Which part of the branch is traced.
    pub(crate) path: PathCase,
    /// How far its diagram is explored.
    pub(crate) diagram: DiagramCase,
    /// Bounds of the second parameter of a map.
    pub(crate) map: MapCase,
    /// What a trace or a diagram of a contact case counts as unstable.
    pub(crate) stability: StabilityCase,
}

/// Which unstable modes of a contact state are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StabilityCase {
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
    pub(crate) const NAMES: [&'static str; 2] = ["full", "axisymmetric"];
}

impl Default for StabilityCase {
    fn default() -> Self {
        StabilityCase::Full { max_n: 40 }
    }
}

/// What is solved.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ProblemCase {
    /// A coated microbubble between two plates; the parameter is the plate distance `z0`.
    Contact(ContactCase),
    /// The same from pole to pole, between plates of their own.
    TwoPlates(TwoPlatesCase),
    /// A shell under a ring load; the parameter is the contact angle `alpha` in degrees.
    RingLoad(RingLoadCase),
    /// A problem of the catalogue, by name.
    Catalogue(CatalogueCase),
}

/// A microbubble between two plates.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ContactCase {
    /// The shell's material.
    pub(crate) shell: ShellCase,
    /// The dimensionless groups, always present.
    pub(crate) groups: Groups,
    /// The physical parameters the groups came from, if the case gave those.
    pub(crate) physical: Option<Box<PhysicalCase>>,
    /// The mesh.
    pub(crate) mesh: MeshCase,
    /// What holds the plates.
    pub(crate) device: DeviceCase,
}

/// A microbubble from pole to pole between two plates.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TwoPlatesCase {
    /// The shell's material.
    pub(crate) shell: ShellCase,
    /// `k_b / (chi R0²)`.
    pub(crate) bending: f64,
    /// `P_A R0 / chi`.
    pub(crate) pressure: f64,
    /// `gamma_BW / chi`.
    pub(crate) surface_tension: f64,
    /// The polytropic exponent of the gas.
    pub(crate) gas_exponent: f64,
    /// The upper plate and the lower; `None` for one that is not there.
    pub(crate) plates: [Option<PlateCase>; 2],
    /// Whether the equator is held in the mid-plane.
    pub(crate) held: bool,
    /// The mesh of either half.
    pub(crate) mesh: MeshCase,
}

impl TwoPlatesCase {
    /// Name of the continued parameter: half the distance of the plates, or the base of a spring.
    pub(crate) fn parameter(&self) -> &'static str {
        let [top, _] = self.plates;
        if top.is_some_and(|plate| plate.stiffness.is_some()) { "base" } else { "z0" }
    }
}

/// One of two plates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlateCase {
    /// `w0 / chi`.
    pub(crate) adhesion: f64,
    /// `delta_A / R0`.
    pub(crate) film: f64,
    /// `k_c` of the cantilever that it hangs on, in `sqrt(chi k_b)/R0`; rigid without one.
    pub(crate) stiffness: Option<f64>,
}

/// A shell under a ring load.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RingLoadCase {
    /// The shell's material.
    pub(crate) shell: ShellCase,
    /// `k_b / (chi R0²)`.
    pub(crate) bending: f64,
    /// `P_A R0 / chi`.
    pub(crate) pressure: f64,
    /// The polytropic exponent of the gas: 0 is constant pressure.
    pub(crate) gas_exponent: f64,
    /// The mesh.
    pub(crate) mesh: MeshCase,
}

/// A problem of the catalogue.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CatalogueCase {
    /// Its name.
    pub(crate) name: String,
    /// Its parameters by name, the continued one not among them.
    pub(crate) parameters: BTreeMap<String, f64>,
    /// Number of elements, for problems that have a mesh.
    pub(crate) elements: Option<usize>,
}

/// A shell's material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ShellCase {
    /// The law of the membrane.
    pub(crate) law: Law,
    /// Poisson's ratio.
    pub(crate) poisson: f64,
}

/// The law of the membrane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Law {
    /// Hooke's law.
    Hooke,
    /// Mooney-Rivlin, strain softening.
    MooneyRivlin {
        /// 0 is neo-Hookean, 1 the other end of the law.
        b: f64,
    },
    /// Skalak, strain hardening.
    Skalak,
}

impl Law {
    /// The names that a case file may use.
    pub(crate) const NAMES: [&'static str; 3] = ["hooke", "mooney-rivlin", "skalak"];
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Law::Hooke => Law::NAMES[0],
            Law::MooneyRivlin { .. } => Law::NAMES[1],
            Law::Skalak => Law::NAMES[2],
        })
    }
}

/// The dimensionless groups of the contact problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Groups {
    /// `k_b / (chi R0²)`.
    pub(crate) bending: f64,
    /// `P_A R0 / chi`.
    pub(crate) pressure: f64,
    /// `w0 / chi`.
    pub(crate) adhesion: f64,
    /// `delta_A / R0`.
    pub(crate) film: f64,
    /// `gamma_BW / chi`.
    pub(crate) surface_tension: f64,
    /// The polytropic exponent of the gas.
    pub(crate) gas_exponent: f64,
}

/// The mesh along the meridian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MeshCase {
    /// Number of elements.
    pub(crate) elements: usize,
    /// Longest element over shortest, shrinking towards the pole; uniform without it.
    pub(crate) grading: Option<f64>,
}

/// Which part of the branch is traced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PathCase {
    /// Where the continued parameter starts.
    pub(crate) start: f64,
    /// Where it ends.
    pub(crate) end: f64,
    /// Longest step, as arclength in the problem's metric; the tracer's default without it.
    pub(crate) max_step: Option<f64>,
    /// Shortest step, likewise.
    pub(crate) min_step: Option<f64>,
    /// Largest number of points.
    pub(crate) max_points: usize,
    /// Number of eigenvalues to compute at every point.
    pub(crate) eigenvalues: usize,
}

/// How far a diagram is explored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DiagramCase {
    /// Most branch points between a branch and the first one.
    pub(crate) depth: usize,
    /// Most branches.
    pub(crate) max_branches: usize,
    /// Bounds of the parameter, in which the first branch is followed both ways; without them it
    /// goes from the path's start to its end, and the others stay where it has been.
    pub(crate) within: Option<(f64, f64)>,
    /// Whether disconnected branches are sought beside near-bifurcations.
    pub(crate) search: bool,
}

impl Default for DiagramCase {
    fn default() -> Self {
        DiagramCase { depth: 2, max_branches: 1000, within: None, search: true }
    }
}

/// Bounds of the second parameter of a map; the command has defaults.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct MapCase {
    /// The lower one.
    pub(crate) from: Option<f64>,
    /// The upper one.
    pub(crate) to: Option<f64>,
}

/// What the command line needs to know about a problem of the catalogue.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CatalogueEntry {
    /// Its name on the command line and in case files.
    pub(crate) name: String,
    /// One line for people.
    pub(crate) summary: String,
    /// Name of the continued parameter.
    pub(crate) parameter: String,
    /// Where the continued parameter starts by default.
    pub(crate) start: f64,
    /// Where it ends by default.
    pub(crate) end: f64,
    /// Where the continued parameter may start.
    pub(crate) start_allowed: problems::Allowed,
    /// The other parameters.
    pub(crate) parameters: Vec<CatalogueParameter>,
    /// Number of elements, for problems that have a mesh.
    pub(crate) elements: Option<ElementRange>,
}

/// A parameter of a problem of the catalogue.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CatalogueParameter {
    /// Its name.
    pub(crate) name: String,
    /// Its default.
    pub(crate) default: f64,
    /// What it may be.
    pub(crate) allowed: problems::Allowed,
}

/// How many elements a mesh may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ElementRange {
    /// The default.
    pub(crate) default: usize,
    /// The smallest.
    pub(crate) least: usize,
    /// The largest.
    pub(crate) most: usize,
}

/// A case, and what deserves to be said about it though it is not wrong.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoadedCase {
    /// The case.
    pub(crate) case: ResolvedCase,
    /// Remarks for people.
    pub(crate) notes: Vec<String>,
}
