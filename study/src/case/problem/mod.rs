//! The kinds of problem that a case may be of: what each is called, and who reads and writes it.
//!
//! A kind has a file here, with its case, its keys, its reading and its writing; what is computed with
//! it is in [`crate::run`].

pub(super) mod ring_load;
mod two_plates;

pub use ring_load::RingLoadCase;
pub use two_plates::{PlateCase, TwoPlatesCase};

use super::resolve::Resolver;
use super::write::{self, Lines};
use super::{CatalogueCase, CatalogueEntry, ContactCase, MeshCase, PathCase};

/// What is solved.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ProblemCase {
    /// A coated microbubble between two plates; the parameter is the plate distance `z0`.
    Contact(ContactCase),
    /// The same from pole to pole, between plates of their own.
    TwoPlates(TwoPlatesCase),
    /// A shell under a ring load; the parameter is the contact angle `alpha` in degrees.
    RingLoad(RingLoadCase),
    /// A problem of the catalogue, by name.
    Catalogue(CatalogueCase),
}

/// What reading a case gives: its problem and its path.
type Read = (Option<ProblemCase>, Option<PathCase>);

/// Reads the case of a problem.
type Reads = fn(&mut Resolver<'_>) -> Read;

/// The problems that are no entries of the catalogue, and how they are read.
pub(super) const BUILT_IN: [(&str, Reads); 3] = [
    (CONTACT, |resolver| resolver.contact()),
    (TWO_PLATES, |resolver| resolver.two_plates()),
    (RING_LOAD, |resolver| resolver.ring_load()),
];
const CONTACT: &str = "contact";
const TWO_PLATES: &str = "two-plates";
const RING_LOAD: &str = "ring-load";

impl ProblemCase {
    /// The word of `problem` in a case file, or the name of a problem of the catalogue.
    pub fn name(&self) -> &str {
        match self {
            ProblemCase::Contact(_) => CONTACT,
            ProblemCase::TwoPlates(_) => TWO_PLATES,
            ProblemCase::RingLoad(_) => RING_LOAD,
            ProblemCase::Catalogue(case) => &case.name,
        }
    }

    /// The name of the continued parameter.
    pub fn parameter(&self, catalogue: &[CatalogueEntry]) -> String {
        match self {
            ProblemCase::Contact(_) => "z0".to_owned(),
            ProblemCase::TwoPlates(plates) => plates.parameter().to_owned(),
            ProblemCase::RingLoad(_) => "alpha".to_owned(),
            ProblemCase::Catalogue(problem) => {
                let entry = catalogue.iter().find(|entry| entry.name == problem.name);
                entry.map_or_else(|| "p".to_owned(), |entry| entry.parameter.clone())
            }
        }
    }

    /// The mesh along the meridian of a shell.
    pub fn mesh(&self) -> Option<&MeshCase> {
        match self {
            ProblemCase::Contact(contact) => Some(&contact.mesh),
            ProblemCase::TwoPlates(plates) => Some(&plates.mesh),
            ProblemCase::RingLoad(ring) => Some(&ring.mesh),
            ProblemCase::Catalogue(_) => None,
        }
    }

    /// The same, to be changed.
    pub fn mesh_mut(&mut self) -> Option<&mut MeshCase> {
        match self {
            ProblemCase::Contact(contact) => Some(&mut contact.mesh),
            ProblemCase::TwoPlates(plates) => Some(&mut plates.mesh),
            ProblemCase::RingLoad(ring) => Some(&mut ring.mesh),
            ProblemCase::Catalogue(_) => None,
        }
    }

    /// Whether its parameters were given in physical units.
    pub fn is_physical(&self) -> bool {
        match self {
            ProblemCase::Contact(contact) => contact.physical.is_some(),
            ProblemCase::TwoPlates(plates) => plates.physical.is_some(),
            ProblemCase::RingLoad(ring) => ring.physical.is_some(),
            ProblemCase::Catalogue(_) => false,
        }
    }

    /// Whether modes around the axis are counted.
    pub fn has_modes(&self) -> bool {
        matches!(self, ProblemCase::Contact(_) | ProblemCase::TwoPlates(_))
    }

    pub(super) fn write(&self, out: &mut Lines) {
        match self {
            ProblemCase::Contact(case) => write::contact(out, case),
            ProblemCase::TwoPlates(case) => two_plates::write(out, case),
            ProblemCase::RingLoad(case) => ring_load::write(out, case),
            ProblemCase::Catalogue(case) => write::catalogue(out, case),
        }
    }
}
