//! The table `[stability]`: which modes are counted along a contact branch.

use super::StabilityCase;
use super::error::Complaint;
use super::reader::{Reader, Section};
use crate::closest::closest;

/// Its keys.
pub(super) const KEYS: &[&str] = &["scan", "max_n"];
/// What `max_n` may be: the bound of wave numbers is 22 at most in the shells studied.
const WAVE_NUMBERS: (i64, i64) = (4, 1000);

pub(super) fn stability(reader: &Reader, section: Section<'_>) -> Option<StabilityCase> {
    let StabilityCase::Full { mut max_n } = StabilityCase::default() else {
        return Some(StabilityCase::Axisymmetric);
    };
    if section.get("max_n").is_some() {
        max_n = reader.count(section, "max_n", WAVE_NUMBERS.0, WAVE_NUMBERS.1)?;
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
