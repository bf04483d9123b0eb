//! The problems of the catalogue, as case files know them.

use super::{CatalogueEntry, CatalogueParameter, ElementRange};
use problems::{Constant, Entry};

/// All problems of the catalogue.
pub fn catalogue() -> Vec<CatalogueEntry> {
    problems::catalogue().iter().copied().map(entry).collect()
}

fn entry(entry: &Entry) -> CatalogueEntry {
    CatalogueEntry {
        name: entry.name.to_owned(),
        summary: entry.summary.to_owned(),
        parameter: entry.parameter.to_owned(),
        axes: entry
            .axes
            .iter()
            .map(|(name, words)| ((*name).to_owned(), (*words).to_owned()))
            .collect(),
        start: entry.start,
        end: entry.end,
        start_allowed: entry.start_allowed,
        parameters: entry.parameters.iter().map(parameter).collect(),
        elements: entry.elements.map(|elements| ElementRange {
            default: elements.default,
            least: elements.least,
            most: elements.most,
        }),
    }
}

fn parameter(constant: &Constant) -> CatalogueParameter {
    CatalogueParameter {
        name: constant.name.to_owned(),
        default: constant.default,
        allowed: constant.allowed,
    }
}
