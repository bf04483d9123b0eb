//! What can be moved on the page: the numbers and words of a case, from the table of keys of `study`.

use serde::Serialize;
use study::case::keys::{Kind, TABLES, WITH_PHYSICAL};
use study::case::{CatalogueEntry, ProblemCase, ResolvedCase, alternatives, needs};

/// How far a slider goes from the value of the case, as a factor, where its range has no end.
const FAR: f64 = 100.0;
/// Where a logarithmic slider that may be zero begins, for a value that is zero.
const SMALL: f64 = 1e-4;

/// How a slider is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Division {
    /// Equal steps.
    Linear,
    /// Equal factors.
    Logarithmic,
    /// Zero, then equal factors.
    LogarithmicFromZero,
    /// Whole numbers.
    Whole,
    /// No slider, a number to be typed.
    Typed,
}

/// One thing that can be moved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Control {
    /// Its key in a case file, with its table.
    pub(crate) key: String,
    /// Its name for people.
    pub(crate) label: String,
    /// What it is.
    pub(crate) help: String,
    /// What it may be, in words.
    pub(crate) range: String,
    /// The unit that its numbers have; that of a quantity is part of its value.
    pub(crate) unit: String,
    /// Whether its value is a quantity with its unit.
    pub(crate) quantity: bool,
    /// Words to choose from; empty for a number.
    pub(crate) words: Vec<String>,
    /// Its value in the case, or one to begin with.
    pub(crate) value: String,
    /// The key and the word of another control without which this one has no meaning.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) needs: Option<(String, &'static str)>,
    /// Whether the case has a value of its own.
    pub(crate) own: bool,
    /// How its slider is divided.
    pub(crate) division: Division,
    /// Ends of its slider.
    pub(crate) ends: [f64; 2],
}

/// The controls of a case.
pub(crate) fn controls(case: &ResolvedCase, catalogue: &[CatalogueEntry]) -> Vec<Control> {
    let resolved: toml::Table = toml::from_str(&case.to_toml()).unwrap_or_default();
    let name = case.problem.name();
    if let ProblemCase::Catalogue(_) = &case.problem {
        let entry = catalogue.iter().find(|entry| entry.name == name);
        return entry.map_or_else(Vec::new, |entry| of_catalogue(&resolved, entry));
    }
    let physical = case.problem.is_physical();
    let groups = if physical { "physical" } else { "dimensionless" };
    let tables = [groups, "plate.top", "plate.bottom", "shell", "device", "path"];
    let others = alternatives(case);
    let mut found = Vec::new();
    for table in tables {
        let own = TABLES.iter().filter(|keys| keys.table == table);
        let own = own.filter(|keys| {
            let own = |problem: &str| match problem.strip_suffix(WITH_PHYSICAL) {
                Some(own) => physical && own == name,
                // plates have other keys beside [physical]
                None => problem == name && !(physical && table.starts_with("plate.")),
            };
            keys.problems == "all" || keys.problems.split(", ").any(own)
        });
        for key in own.flat_map(|keys| keys.keys) {
            let path = format!("{table}.{}", key.name);
            // a law or a potential may be exchanged for one that has this key
            let own = at(&resolved, &path).cloned();
            let has_own = own.is_some();
            let other =
                || others.iter().find(|(key, _)| *key == path).map(|(_, text)| value_of(text));
            let Some(value) = own.or_else(other) else { continue };
            // another device would need keys that the case does not have
            let fixed =
                matches!(path.as_str(), "device.kind" | "plate.top.device" | "plate.bottom.device");
            let offered = table != "path" || matches!(key.name, "start" | "end");
            if offered && !fixed {
                let made = control(&path, key, &value);
                found.extend(made.map(|made| Control {
                    needs: needs(table, key.name),
                    own: has_own || key.name == "potential",
                    ..made
                }));
            }
        }
    }
    found
}

/// A value as a case file has it: a number, or words.
fn value_of(text: &str) -> toml::Value {
    let number = text.parse().map(toml::Value::Float);
    number.unwrap_or_else(|_| toml::Value::String(text.to_owned()))
}

/// The value at a path of keys.
fn at<'t>(tree: &'t toml::Table, path: &str) -> Option<&'t toml::Value> {
    let (table, key) = path.rsplit_once('.')?;
    let mut inner = tree;
    for name in table.split('.') {
        inner = inner.get(name)?.as_table()?;
    }
    inner.get(key)
}

fn number(value: &toml::Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

fn control(path: &str, key: &study::case::keys::Key, value: &toml::Value) -> Option<Control> {
    let base = Control {
        key: path.to_owned(),
        label: label(path),
        help: key.help.to_owned(),
        range: String::new(),
        unit: key.unit.to_owned(),
        quantity: false,
        words: Vec::new(),
        value: String::new(),
        needs: None,
        own: true,
        division: Division::Typed,
        ends: [0.0, 1.0],
    };
    match key.kind {
        // an end of a path that was given with its unit
        Kind::Number(_) if value.is_str() => {
            let value = value.as_str()?.to_owned();
            Some(Control { unit: String::new(), value, quantity: true, ..base })
        }
        Kind::Number(range) => {
            let now = number(value)?;
            let pure = key.unit.is_empty();
            let (division, ends) = if path.starts_with("path.") {
                (Division::Typed, [now, now])
            } else {
                divided(now, &|x| range.contains(x), pure)
            };
            let range = range.words.to_owned();
            let unit = if path.starts_with("path.") { String::new() } else { base.unit.clone() };
            Some(Control { range, unit, value: now.to_string(), division, ends, ..base })
        }
        Kind::Quantity(_, range) => {
            let text = value.as_str()?;
            let (now, unit) = quantity(text)?;
            let (division, ends) = divided(now, &|x| range.contains(x), false);
            let (unit, value) = (unit.to_owned(), text.to_owned());
            let range = range.words.to_owned();
            Some(Control { range, unit, value, division, ends, quantity: true, ..base })
        }
        Kind::Word(words) => {
            let words = words.iter().map(ToString::to_string).collect();
            Some(Control { words, value: value.as_str()?.to_owned(), ..base })
        }
        _ => None,
    }
}

/// The longest number at the start of a text, and the rest.
fn quantity(text: &str) -> Option<(f64, &str)> {
    let ends = text.char_indices().map(|(at, _)| at).chain([text.len()]).rev();
    ends.filter_map(|end| Some((text[..end].trim().parse().ok()?, text[end..].trim()))).next()
}

fn of_catalogue(resolved: &toml::Table, entry: &CatalogueEntry) -> Vec<Control> {
    let base = |key: String, name: &str, help: String, range: String| Control {
        key,
        label: name.to_owned(),
        help,
        range,
        unit: String::new(),
        quantity: false,
        words: Vec::new(),
        value: String::new(),
        needs: None,
        own: true,
        division: Division::Typed,
        ends: [0.0, 1.0],
    };
    let mut found = Vec::new();
    for parameter in &entry.parameters {
        let key = format!("parameters.{}", parameter.name);
        let now = at(resolved, &key).and_then(number).unwrap_or(parameter.default);
        let (division, ends) = match parameter.allowed {
            problems::Allowed::Count(low, high) => (Division::Whole, [low as f64, high as f64]),
            allowed => divided(now, &|x| allowed.holds(x), true),
        };
        let help = format!("Parameter of {}", entry.name);
        let base = base(key, &parameter.name, help, parameter.allowed.to_string());
        found.push(Control { value: now.to_string(), division, ends, ..base });
    }
    for name in ["start", "end"] {
        let key = format!("path.{name}");
        let Some(now) = at(resolved, &key).and_then(number) else { continue };
        let help = format!("Where {} {name}s", entry.parameter);
        let base = base(key.clone(), &label(&key), help, "a finite number".to_owned());
        found.push(Control { value: now.to_string(), ends: [now, now], ..base });
    }
    found
}

/// How a slider through `now` is divided, and its ends: inside the range, which is asked, as it knows its
/// bounds only. What has a unit and no upper bound is divided by factors.
fn divided(now: f64, holds: &dyn Fn(f64) -> bool, pure: bool) -> (Division, [f64; 2]) {
    let size = now.abs().max(1.0);
    let open = |sign: f64| holds(sign * 1e12);
    match (open(-1.0), open(1.0)) {
        (false, true) if pure => {
            let low = edge(now, now - 2.0 * size, holds);
            (Division::Linear, [low, (2.0 * now).max(2.0)])
        }
        (false, true) if holds(0.0) && now == 0.0 => {
            (Division::LogarithmicFromZero, [SMALL, SMALL * FAR * FAR])
        }
        (false, true) if holds(0.0) => (Division::LogarithmicFromZero, [now / FAR, now * FAR]),
        (false, true) if now > 0.0 && holds(now / FAR) => {
            (Division::Logarithmic, [now / FAR, now * FAR])
        }
        (true, true) => (Division::Linear, [now - 2.0 * size, now + 2.0 * size]),
        (low, high) => {
            let low = if low { now - 2.0 * size } else { edge(now, -1e12, holds) };
            let high = if high { now + 2.0 * size } else { edge(now, 1e12, holds) };
            (Division::Linear, [low, high])
        }
    }
}

/// The end of a range between a value inside and one outside; a round number where one is near.
fn edge(inside: f64, outside: f64, holds: &dyn Fn(f64) -> bool) -> f64 {
    if holds(outside) {
        return outside;
    }
    let (mut good, mut bad) = (inside, outside);
    for _ in 0..200 {
        let middle = 0.5 * (good + bad);
        if holds(middle) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    let round = (good * 1e6).round() / 1e6;
    if holds(round) {
        return round;
    }
    // a bound that is not part of the range
    let step = if outside > inside { -0.01 } else { 0.01 };
    if holds(round + step) { round + step } else { good }
}

/// A key for people: its name without the table, the plate's kept.
fn label(path: &str) -> String {
    let parts: Vec<&str> = path.split('.').collect();
    let name = parts.last().copied().unwrap_or(path).replace('_', " ");
    match parts.as_slice() {
        ["plate", side, _] => format!("{name} ({side})"),
        ["shell", "poisson"] => "Poisson's ratio".to_owned(),
        ["shell", "b"] => "b (Mooney-Rivlin)".to_owned(),
        ["path", _] => format!("path {name}"),
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use study::case::{catalogue, load};

    fn of(case: &str) -> Vec<Control> {
        let catalogue = catalogue();
        controls(&load(case.as_ref(), &[], &catalogue).unwrap().case, &catalogue)
    }

    fn find<'c>(controls: &'c [Control], key: &str) -> &'c Control {
        controls.iter().find(|control| control.key == key).unwrap()
    }

    #[test]
    fn a_contact_case_has_its_groups_law_and_path() {
        let all = of("fig12");
        let keys: Vec<&str> = all.iter().map(|control| control.key.as_str()).collect();
        assert_eq!(
            keys,
            [
                "dimensionless.bending",
                "dimensionless.pressure",
                "dimensionless.adhesion",
                "dimensionless.film",
                "dimensionless.surface_tension",
                "dimensionless.gas_exponent",
                "dimensionless.potential",
                "dimensionless.debye",
                "shell.law",
                "shell.poisson",
                "shell.b",
                "path.start",
                "path.end",
            ]
        );
        let adhesion = find(&all, "dimensionless.adhesion");
        assert_eq!(adhesion.division, Division::Logarithmic);
        assert!((adhesion.ends[0] - 2e-5).abs() < 1e-12 && (adhesion.ends[1] - 0.2).abs() < 1e-12);
        assert_eq!(find(&all, "dimensionless.pressure").division, Division::LogarithmicFromZero);
        assert_eq!(find(&all, "dimensionless.gas_exponent").division, Division::Linear);
        let poisson = find(&all, "shell.poisson");
        assert_eq!((poisson.division, poisson.ends), (Division::Linear, [-0.99, 0.5]));
        assert_eq!(find(&all, "shell.law").words.len(), 3);
        assert_eq!(find(&all, "path.end").division, Division::Typed);
    }

    #[test]
    fn quantities_keep_the_unit_in_which_they_were_written() {
        let all = of("polymer");
        let film = find(&all, "physical.film");
        assert!(film.quantity);
        assert_eq!((film.unit.as_str(), film.value.as_str()), ("nm", "50 nm"));
        assert!((film.ends[0] - 0.5).abs() < 1e-12);
        assert_eq!(find(&all, "physical.adhesion").unit, "N/m");
        assert_eq!(quantity("3e-16 N m"), Some((3e-16, "N m")));
        assert_eq!(quantity("nm"), None);
    }

    /// What a page sends with a choice: the values that go with it.
    fn others_of(controls: &[Control], needs: &(String, &'static str)) -> Vec<String> {
        let with = controls.iter().filter(|one| one.needs.as_ref() == Some(needs) && !one.own);
        with.map(|one| match one.quantity {
            true => format!("{}=\"{}\"", one.key, one.value),
            false => format!("{}={}", one.key, one.value),
        })
        .collect()
    }

    #[test]
    fn the_potential_of_the_film_can_be_exchanged() {
        let catalogue = catalogue();
        for (case, word) in
            [("fig12", "dlvo"), ("polymer", "dlvo"), ("dlvo", "four-two"), ("two-plates", "dlvo")]
        {
            let all = of(case);
            let choice = all.iter().find(|control| control.key.ends_with("potential")).unwrap();
            assert_eq!(choice.words, ["four-two", "dlvo"], "{case}");
            let mut texts = vec![format!("{}={word}", choice.key)];
            texts.extend(others_of(&all, &(choice.key.clone(), word)));
            assert!(texts.len() > 1, "{case}: {texts:?}");
            let overrides: Vec<_> =
                texts.iter().map(|text| study::case::Override::new(text.as_str())).collect();
            let loaded = load(case.as_ref(), &overrides, &catalogue).unwrap().case;
            let before = load(case.as_ref(), &[], &catalogue).unwrap().case;
            assert_ne!(loaded.problem, before.problem, "{case}");
            if let (ProblemCase::Contact(a), ProblemCase::Contact(b)) =
                (&loaded.problem, &before.problem)
            {
                // the film begins as high and as deep as it was
                assert!((a.groups.film / b.groups.film - 1.0).abs() < 2e-3, "{case}");
                assert!((a.groups.adhesion / b.groups.adhesion - 1.0).abs() < 2e-2, "{case}");
            }
        }
    }

    #[test]
    fn every_slider_begins_and_ends_inside_its_range() {
        let catalogue = catalogue();
        let names = catalogue.iter().map(|entry| entry.name.as_str());
        for case in
            ["fig12", "polymer", "two-plates", "ring-load", "cantilever"].into_iter().chain(names)
        {
            for control in of(case).iter().filter(|control| control.words.is_empty()) {
                let [low, high] = control.ends;
                // whether surface forces make a film depends on all of them: the page says it
                if control.needs == Some(("physical.potential".to_owned(), "dlvo")) {
                    continue;
                }
                assert!(low <= high && low.is_finite() && high.is_finite(), "{case}: {control:?}");
                let ends = [low, high].map(|end| match control.quantity {
                    true => format!("{}=\"{end} {}\"", control.key, control.unit),
                    false => format!("{}={end}", control.key),
                });
                // two ends need not go together
                let law = control.needs.as_ref().map(|(key, word)| format!("{key}={word}"));
                let with: Vec<String> = control
                    .needs
                    .iter()
                    .flat_map(|needs| others_of(&of(case), needs))
                    .filter(|text| !text.starts_with(&format!("{}=", control.key)))
                    .collect();
                for end in &ends {
                    let overrides: Vec<_> = law
                        .iter()
                        .chain(&with)
                        .map(String::as_str)
                        .chain([end.as_str()])
                        .map(study::case::Override::new)
                        .collect();
                    let loaded = load(case.as_ref(), &overrides, &catalogue);
                    assert!(loaded.is_ok(), "{case}: {end}: {}", loaded.unwrap_err());
                }
            }
        }
    }
}
