//! Maps of the shell from pole to pole: half the distance of its plates, or the base of a spring, and one
//! of its other parameters, by plate where the film has it.

use super::contact::{bare, limits, refusal, share_mut};
use super::curves::curves;
use super::{Attempt, MapError, Second, Task};
use crate::case::TwoPlatesCase;
use crate::run::two_plates::{BetweenPlates, WithPlates, follow, visit};
use crate::run::{Observer, RunError};

/// The keys that are parameters of the problem: of the whole shell, then of its plates.
const KEYS: [&str; 10] = [
    "bending",
    "pressure",
    "surface_tension",
    "gas_exponent",
    "poisson",
    "b",
    "plate.top.adhesion",
    "plate.top.film",
    "plate.bottom.adhesion",
    "plate.bottom.film",
];

/// What the problem calls a key.
fn name(key: &str) -> &str {
    match key {
        "plate.top.adhesion" => "adhesion_top",
        "plate.top.film" => "film_top",
        "plate.bottom.adhesion" => "adhesion_bottom",
        "plate.bottom.film" => "film_bottom",
        other => other,
    }
}

/// Where the value of a parameter is kept; of a plate only if it is there, `b` only with a law that has it.
fn value_mut<'c>(plates: &'c mut TwoPlatesCase, name: &str) -> Option<&'c mut f64> {
    let [top, bottom] = &mut plates.plates;
    Some(match name {
        "bending" => &mut plates.bending,
        "pressure" => &mut plates.pressure,
        "surface_tension" => &mut plates.surface_tension,
        "gas_exponent" => &mut plates.gas_exponent,
        "poisson" => &mut plates.shell.poisson,
        "b" => return share_mut(&mut plates.shell),
        "adhesion_top" => &mut top.as_mut()?.adhesion,
        "film_top" => &mut top.as_mut()?.film,
        "adhesion_bottom" => &mut bottom.as_mut()?.adhesion,
        "film_bottom" => &mut bottom.as_mut()?.film,
        _ => return None,
    })
}

/// The second parameter that a key names.
pub(in crate::run) fn second(plates: &TwoPlatesCase, key: &str) -> Result<Second, MapError> {
    let given = name(bare(key));
    let law = plates.shell.law;
    if let Some(value) = value_mut(&mut plates.clone(), given) {
        let (usual, limits) = limits(law, given);
        return Ok(Second { key: given.to_owned(), value: *value, usual, limits });
    }
    let known = |key: &&str| value_mut(&mut plates.clone(), name(key)).is_some();
    let allowed = KEYS.into_iter().filter(known).collect();
    Err(refusal((key, bare(key)), plates.parameter(), law, "the shell between two plates", allowed))
}

/// The base branch with the second parameter `at` a value, and its curves.
pub(in crate::run) fn attempt(
    task: &Task<'_>,
    plates: &TwoPlatesCase,
    at: f64,
    observer: &mut Observer<'_>,
) -> Result<Attempt, MapError> {
    let mut plates = plates.clone();
    if let Some(value) = value_mut(&mut plates, &task.key) {
        *value = at;
    }
    Ok(visit(task.case, &plates, OfPlates { task, observer })??)
}

struct OfPlates<'t, 'c, 'o> {
    task: &'t Task<'c>,
    observer: &'t mut Observer<'o>,
}

impl WithPlates for OfPlates<'_, '_, '_> {
    type Output = Result<Attempt, RunError>;

    fn with<P: BetweenPlates>(self, problem: &P, x: &[f64], p: &[f64]) -> Self::Output {
        let OfPlates { task, observer } = self;
        let (base, _) = follow(task.case, problem, (x, p), None, observer)?;
        let base = base.branch;
        let (found, refused) = curves(problem, &base, task, observer);
        Ok(Attempt {
            parameter: base.parameter,
            stopped: base.stopped,
            newton_iterations: base.statistics.newton_iterations,
            found,
            refused,
        })
    }
}
