//! The loading device of a contact case, the table `[device]`.

use super::error::Complaint;
use super::keys::{POSITIVE, STIFFNESS};
use super::path::Scale;
use super::reader::{Reader, Section};
use crate::closest::closest;
use crate::units::{Dimension, Quantity};
use shell_contact::Device;

/// The device of a section whose keys are all known; a grip if it is absent. A stiffness in quotes is that of one
/// lever on the whole bubble, and is handed back as it was given.
pub(super) fn device(
    reader: &Reader,
    section: Section<'_>,
    scale: Scale,
) -> Option<(Device, Option<Quantity>)> {
    if !section.exists() {
        return Some((Device::Grip, None));
    }
    let Some(node) = section.get("kind") else {
        reader.missing(section, "kind", format!("give one of {}", Device::NAMES.join(", ")));
        return None;
    };
    let kind = reader.text(section, "kind")?;
    let given = section.get("stiffness");
    let (stiffness, lever) = match given {
        Some(node) if node.is_quantity() => lever(reader, section, scale).unzip(),
        _ => (reader.number(section, STIFFNESS.name, STIFFNESS.range()), None),
    };
    let device = match kind {
        "grip" => Device::Grip,
        "dead-load" => Device::DeadLoad,
        "cantilever" => {
            if given.is_none() {
                let hint = "a cantilever needs its stiffness per plate, in sqrt(chi k_b)/R0; or, with \
                            [physical], that of one lever on the whole bubble, such as \"0.08 N/m\"";
                reader.missing(section, "stiffness", hint);
            }
            return Some((Device::Cantilever { stiffness: stiffness? }, lever));
        }
        _ => {
            let suggestion = closest(kind, Device::NAMES).map(ToString::to_string);
            let allowed = Device::NAMES.iter().map(ToString::to_string).collect();
            reader.refuse(section, "kind", node, Complaint::UnknownWord { allowed, suggestion });
            return None;
        }
    };
    if let Some(node) = given {
        let why = Complaint::Conflict(format!("a {kind} has none; only a cantilever has"));
        reader.refuse(section, "stiffness", node, why);
        return None;
    }
    Some((device, None))
}

/// Two springs of `2 K`, one behind each plate, give way as one lever of stiffness `K` does:
/// `k_c = 2 K R0/sqrt(chi k_b)`.
fn lever(reader: &Reader, section: Section<'_>, scale: Scale) -> Option<(f64, Quantity)> {
    let node = section.get(STIFFNESS.name)?;
    let given = reader.quantity(section, STIFFNESS.name, Dimension::Tension, POSITIVE)?;
    match scale {
        Scale::Known { radius, force } => {
            let stiffness = 2.0 * given.si * radius / force;
            if STIFFNESS.range().contains(stiffness) {
                return Some((stiffness, given));
            }
            let why = format!(
                "this lever makes the dimensionless stiffness {stiffness:?}, which must be {}; check the units",
                STIFFNESS.range().words
            );
            reader.refuse(section, STIFFNESS.name, node, Complaint::Conflict(why));
        }
        Scale::Unknown => {}
        Scale::None => {
            let why = "a stiffness with a unit needs the shell in physical units, in a table [physical]; with \
                       [dimensionless] give 2 K R0/sqrt(chi k_b), a number"
                .to_owned();
            reader.refuse(section, STIFFNESS.name, node, Complaint::Conflict(why));
        }
    }
    None
}
