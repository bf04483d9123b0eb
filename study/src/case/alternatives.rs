//! Keys that a case does not have, and would have if another of its words were chosen: for pages on which a
//! person chooses.

use super::{Law, LawName, ProblemCase, ResolvedCase, film};

/// A word that a key waits for: the key of the choice, and the word.
pub type Needs = (String, &'static str);

/// What a key needs to have a meaning, by the path of both in a case file; `None` for one that always has.
pub fn needs(table: &str, key: &str) -> Option<Needs> {
    match (table, key) {
        ("shell", "b") => Some(("shell.law".to_owned(), LawName::MooneyRivlin.name())),
        ("dimensionless" | "physical" | "plate.top" | "plate.bottom", key) => {
            film::owner(table, key).map(|word| (format!("{table}.potential"), word))
        }
        _ => None,
    }
}

/// Keys that a case does not have, with values to begin with: paths and values as `--set` takes them, without
/// the quotes.
pub fn alternatives(case: &ResolvedCase) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut add = |table: &str, keys: Vec<(&'static str, String)>| {
        found.extend(keys.into_iter().map(|(key, value)| (format!("{table}.{key}"), value)));
    };
    let law = match &case.problem {
        ProblemCase::Contact(contact) => {
            match &contact.physical {
                Some(physical) => add(
                    "physical",
                    film::others(
                        [&physical.adhesion, &physical.film].map(|q| q.si),
                        &physical.potential,
                    ),
                ),
                None => add("dimensionless", film::others_of_groups(&contact.potential)),
            }
            contact.shell.law
        }
        ProblemCase::TwoPlates(plates) => {
            let given = plates.plates.iter().zip(&plates.physical_plates);
            for (table, (plate, physical)) in ["plate.top", "plate.bottom"].into_iter().zip(given) {
                match (plate, physical) {
                    (Some(plate), Some(given)) => add(
                        table,
                        film::others(
                            [&given.adhesion, &given.film].map(|q| q.si),
                            &plate.potential,
                        ),
                    ),
                    (Some(plate), None) => add(table, film::others_of_groups(&plate.potential)),
                    (None, _) => {}
                }
            }
            plates.shell.law
        }
        ProblemCase::RingLoad(ring) => ring.shell.law,
        _ => return found,
    };
    if !matches!(law, Law::MooneyRivlin { .. }) {
        found.push(("shell.b".to_owned(), "0.5".to_owned()));
    }
    found
}
