//! Maps of the contact problem: the plate distance and one of the dimensionless groups.

use super::curves::curves;
use super::{Attempt, MapError, Task};
use crate::case::{ContactCase, Groups};
use crate::closest::closest;
use crate::run::contact::{no_start, problem};
use crate::run::{Observer, listen, settings};
use shell_contact::trace_contact;

/// The groups that are parameters of the problem, in the order in which case files have them.
const KEYS: [&str; 5] = ["bending", "pressure", "adhesion", "film", "surface_tension"];

fn group<'g>(groups: &'g mut Groups, key: &str) -> Option<&'g mut f64> {
    Some(match key {
        "bending" => &mut groups.bending,
        "pressure" => &mut groups.pressure,
        "adhesion" => &mut groups.adhesion,
        "film" => &mut groups.film,
        "surface_tension" => &mut groups.surface_tension,
        _ => return None,
    })
}

/// The value of a group in the case, and its plain name.
pub(in crate::run) fn value(contact: &ContactCase, key: &str) -> Result<(f64, String), MapError> {
    let name = key.strip_prefix("dimensionless.").unwrap_or(key);
    if let Some(value) = group(&mut contact.groups.clone(), name) {
        return Ok((*value, name.to_string()));
    }
    let allowed = KEYS.map(str::to_string).to_vec();
    if name == "z0" {
        return Err(MapError::SameParameter { key: key.to_string(), allowed });
    }
    let suggestion = closest(name, KEYS).map(str::to_string);
    let problem = "the contact problem".to_string();
    Err(MapError::UnknownKey { key: key.to_string(), problem, allowed, suggestion })
}

/// The base branch with the second parameter `at` a value, and its curves.
pub(in crate::run) fn attempt(
    task: &Task<'_>,
    contact: &ContactCase,
    at: f64,
    observer: &mut Observer<'_>,
) -> Result<Attempt, MapError> {
    let mut contact = contact.clone();
    if let Some(value) = group(&mut contact.groups, &task.key) {
        *value = at;
    }
    let start = task.case.path.start;
    let problem = problem(task.case, &contact)?;
    let path = settings(&task.case.path);
    let base = trace_contact(&problem, start, path, &mut listen(observer))
        .map_err(|detail| no_start(task.case, detail))?
        .branch;
    let (found, refused) = curves(&problem, &base, task, observer);
    Ok(Attempt {
        parameter: base.parameter,
        stopped: base.stopped,
        newton_iterations: base.statistics.newton_iterations,
        found,
        refused,
    })
}
