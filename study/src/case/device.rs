//! The loading device of a contact case, the table `[device]`.

use super::error::Complaint;
use super::keys::STIFFNESS;
use super::reader::{Reader, Section};
use crate::closest::closest;

/// What holds the plates.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum DeviceCase {
    /// The plate distance is prescribed.
    #[default]
    Grip,
    /// The force is prescribed.
    DeadLoad,
    /// The base of a spring behind each plate is prescribed.
    Cantilever {
        /// `k_c` per plate, in `sqrt(chi k_b)/R0`.
        stiffness: f64,
    },
}

impl DeviceCase {
    /// The names that a case file may use.
    pub(super) const NAMES: [&str; 3] = ["grip", "dead-load", "cantilever"];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            DeviceCase::Grip => Self::NAMES[0],
            DeviceCase::DeadLoad => Self::NAMES[1],
            DeviceCase::Cantilever { .. } => Self::NAMES[2],
        }
    }

    /// Stiffness of a cantilever.
    pub fn stiffness(self) -> Option<f64> {
        match self {
            DeviceCase::Cantilever { stiffness } => Some(stiffness),
            _ => None,
        }
    }
}

/// The device of a section whose keys are all known; a grip if it is absent.
pub(super) fn device(reader: &Reader, section: Section<'_>) -> Option<DeviceCase> {
    if !section.exists() {
        return Some(DeviceCase::Grip);
    }
    let Some(node) = section.get("kind") else {
        reader.missing(section, "kind", format!("give one of {}", DeviceCase::NAMES.join(", ")));
        return None;
    };
    let kind = reader.text(section, "kind")?;
    let stiffness = reader.number(section, STIFFNESS.name, STIFFNESS.range());
    let given = section.get("stiffness");
    let device = match kind {
        "grip" => DeviceCase::Grip,
        "dead-load" => DeviceCase::DeadLoad,
        "cantilever" => {
            if given.is_none() {
                let hint = "a cantilever needs its stiffness per plate, in sqrt(chi k_b)/R0";
                reader.missing(section, "stiffness", hint);
            }
            return Some(DeviceCase::Cantilever { stiffness: stiffness? });
        }
        _ => {
            let suggestion = closest(kind, DeviceCase::NAMES).map(ToString::to_string);
            let allowed = DeviceCase::NAMES.iter().map(ToString::to_string).collect();
            reader.refuse(section, "kind", node, Complaint::UnknownWord { allowed, suggestion });
            return None;
        }
    };
    if let Some(node) = given {
        let why = Complaint::Conflict(format!("a {kind} has none; only a cantilever has"));
        reader.refuse(section, "stiffness", node, why);
        return None;
    }
    Some(device)
}
