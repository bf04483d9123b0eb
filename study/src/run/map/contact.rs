//! Maps of the contact problem: the plate distance and one of its other parameters.

use super::curves::curves;
use super::{Attempt, Limits, MapError, Second, Task};
use crate::case::keys::{FRACTION, NOT_NEGATIVE, POISSON_RATIOS, POISSON_SKALAK};
use crate::case::{ContactCase, Law, Shell};
use crate::closest::closest;
use crate::run::contact::{no_start, problem};
use crate::run::{Observer, listen, settings};
use shell_contact::trace_contact;

/// The keys that are parameters of the problem, in the order in which case files have them.
const KEYS: [&str; 8] =
    ["bending", "pressure", "adhesion", "film", "surface_tension", "gas_exponent", "poisson", "b"];
/// Poisson's ratios up to which a map goes unless it is told: the equations are singular at -1 and 1.
const RATIOS: f64 = 0.99;

/// Where the value of a key is kept; `b` only with a law that has it.
fn value_mut<'c>(contact: &'c mut ContactCase, key: &str) -> Option<&'c mut f64> {
    let groups = &mut contact.groups;
    Some(match key {
        "bending" => &mut groups.bending,
        "pressure" => &mut groups.pressure,
        "adhesion" => &mut groups.adhesion,
        "film" => &mut groups.film,
        "surface_tension" => &mut groups.surface_tension,
        "gas_exponent" => &mut groups.gas_exponent,
        "poisson" => &mut contact.shell.poisson,
        "b" => return share_mut(&mut contact.shell),
        _ => return None,
    })
}

/// The share `b`, of a law that has it.
pub(super) fn share_mut(shell: &mut Shell) -> Option<&mut f64> {
    match &mut shell.law {
        Law::MooneyRivlin { b } => Some(b),
        Law::Hooke | Law::Skalak => None,
    }
}

/// The name of a key without its table, if that is the one in which it stands.
pub(super) fn bare(key: &str) -> &str {
    let table =
        |name: &str| if matches!(name, "poisson" | "b") { "shell" } else { "dimensionless" };
    match key.split_once('.') {
        Some((given, name)) if given == table(name) => name,
        _ => key,
    }
}

/// The refusal of `b` with a law that has none.
fn without_share(law: Law, key: String, allowed: Vec<String>) -> MapError {
    let problem = format!("a shell of the law {law}");
    MapError::UnknownKey { key, problem, allowed, suggestion: None }
}

/// The size that a parameter usually has, and where it ends, for those that have an end above zero.
pub(super) fn limits(law: Law, key: &str) -> (Option<f64>, Option<Limits>) {
    let within = |usual, low, high, allowed| (Some(usual), Some(Limits { low, high, allowed }));
    match (key, law) {
        ("gas_exponent", _) => within(1.4, 0.0, f64::INFINITY, NOT_NEGATIVE),
        // Skalak's C is not negative
        ("poisson", Law::Skalak) => within(0.5, 0.0, RATIOS, POISSON_SKALAK),
        ("poisson", _) => within(0.5, -RATIOS, 0.5, POISSON_RATIOS),
        ("b", _) => within(1.0, 0.0, 1.0, FRACTION),
        _ => (None, None),
    }
}

/// The second parameter that a key names.
pub(in crate::run) fn second(contact: &ContactCase, key: &str) -> Result<Second, MapError> {
    let name = bare(key);
    let law = contact.shell.law;
    if let Some(value) = value_mut(&mut contact.clone(), name) {
        let (usual, limits) = limits(law, name);
        return Ok(Second { key: name.to_string(), value: *value, usual, limits });
    }
    let known = |name: &&str| value_mut(&mut contact.clone(), name).is_some();
    let allowed = KEYS.into_iter().filter(known).collect();
    Err(refusal((key, name), "z0", law, "the contact problem", allowed))
}

/// Why a key, as it was given and by its bare name, is no second parameter beside the problem's `own` one.
pub(super) fn refusal(
    (key, name): (&str, &str),
    own: &str,
    law: Law,
    problem: &str,
    allowed: Vec<&str>,
) -> MapError {
    let suggestion = closest(name, allowed.iter().copied()).map(str::to_owned);
    let allowed = allowed.into_iter().map(str::to_owned).collect();
    let key = key.to_owned();
    match name {
        name if name == own => MapError::SameParameter { key, allowed },
        "b" => without_share(law, key, allowed),
        _ => MapError::UnknownKey { key, problem: problem.to_owned(), allowed, suggestion },
    }
}

/// The base branch with the second parameter `at` a value, and its curves.
pub(in crate::run) fn attempt(
    task: &Task<'_>,
    contact: &ContactCase,
    at: f64,
    observer: &mut Observer<'_>,
) -> Result<Attempt, MapError> {
    let mut contact = contact.clone();
    if let Some(value) = value_mut(&mut contact, &task.key) {
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
