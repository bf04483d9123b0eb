//! The table `[stability]`: which modes are counted along a contact branch.

use super::StabilityCase;
use super::error::Complaint;
use super::keys::MAX_N;
use super::reader::{Reader, Section};
use crate::closest::closest;

pub(super) fn stability(reader: &Reader, section: Section<'_>) -> Option<StabilityCase> {
    let StabilityCase::Full { mut max_n } = StabilityCase::default() else {
        return Some(StabilityCase::Axisymmetric);
    };
    if section.get("max_n").is_some() {
        let (least, most) = MAX_N.bounds();
        max_n = reader.count(section, MAX_N.name, least, most)?;
    }
    let full = StabilityCase::Full { max_n };
    let Some(node) = section.get("scan") else { return Some(full) };
    match reader.text(section, "scan")? {
        word if word == StabilityCase::NAMES[0] => Some(full),
        word if word == StabilityCase::NAMES[1] => Some(StabilityCase::Axisymmetric),
        word => {
            let suggestion = closest(word, StabilityCase::NAMES).map(ToString::to_string);
            let allowed = StabilityCase::NAMES.iter().map(ToString::to_string).collect();
            reader.refuse(section, "scan", node, Complaint::UnknownWord { allowed, suggestion });
            None
        }
    }
}
