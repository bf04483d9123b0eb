//! A branch as JSON for the page: columns rounded to single precision, which is more than a screen shows.

use crate::trace::Traced;
use serde::Serialize;
use std::collections::BTreeMap;
use study::case::{PASSED_OVER, ProblemCase};
use study::record::{EventRecord, PhysicalUnits, Scales, State, Table, TraceResult};

/// What is known of the stability of the state at a point; the page draws each in its own way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Known {
    /// Every kind of mode was counted with certainty, and none is unstable.
    Stable,
    /// Some kinds of mode were counted with certainty, and none of these is unstable.
    StableToSome,
    /// Modes with the symmetries of the state are unstable.
    Unstable,
    /// Others are, and no mode with its symmetries.
    Asymmetric,
    /// It was not counted, or not with certainty.
    Unknown,
}

/// A special point on the page.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Special<'a> {
    point: usize,
    kind: &'a str,
    /// Short name beside the point; empty for one that has only a mark.
    label: String,
    before: Option<usize>,
    after: Option<usize>,
    /// Waves and parity of a mode without the branch's symmetries.
    #[serde(skip_serializing_if = "Option::is_none")]
    mode: Option<String>,
}

/// A state along the branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Shown {
    point: usize,
    plate: Option<f32>,
    sigma: Vec<f32>,
    z: Vec<f32>,
    pressure: Vec<f32>,
}

/// A column of the table.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct About<'a> {
    label: &'a str,
    unit: &'a str,
    /// Unit of the laboratory, and what the numbers are to be multiplied with; of a physical case.
    #[serde(skip_serializing_if = "Option::is_none")]
    physical: Option<(&'static str, f64)>,
}

#[derive(Debug, Serialize)]
struct Branch<'a> {
    /// Law, groups and potential, or what the problem is; `_{…}` and `^{…}` set small.
    about_case: String,
    parameter: &'a str,
    elements: Option<usize>,
    columns: BTreeMap<&'a str, Vec<Option<f32>>>,
    about: BTreeMap<&'a str, About<'a>>,
    /// Of the pressure in states.
    #[serde(skip_serializing_if = "Option::is_none")]
    film: Option<(&'static str, f64)>,
    stability: Vec<Known>,
    /// What solid lines mean.
    examined: &'static str,
    /// Whether every kind of mode was looked at.
    full: bool,
    special: Vec<Special<'a>>,
    states: Vec<Shown>,
    stopped: String,
    complete: bool,
    warning: Option<String>,
    notes: Vec<&'a String>,
    /// Milliseconds from the request to the branch.
    took: f64,
}

/// The JSON of a branch; `units` are those in which a physical case is shown, which a first branch chooses.
///
/// # Errors
/// What the writer of JSON reports.
pub(crate) fn branch(
    traced: &Traced,
    units: &mut Option<PhysicalUnits>,
) -> Result<String, serde_json::Error> {
    let Traced { case, result, notes, cut, took } = traced;
    let table = &result.table;
    let scales = Scales::of(case);
    let physical = scales.map(|scales| {
        let units = *units.get_or_insert_with(|| PhysicalUnits::for_table(&scales, table));
        move |unit: &str| units.of(&scales, unit)
    });
    let convert = |unit: &str| physical.as_ref().and_then(|of| of(unit));
    let numbers = |name: &&String| {
        !matches!(name.as_str(), "point" | "event" | "certified" | "stable" | "admissible")
    };
    let names = || table.columns().iter().filter(numbers);
    let (examined, full) = examined(case, result);
    let elements = match &case.problem {
        ProblemCase::Catalogue(problem) => problem.elements,
        // a tolerance chooses them
        shell => {
            let traced = result.resolution.map(|record| record.elements);
            traced.or_else(|| shell.mesh().map(|mesh| mesh.elements))
        }
    };
    let mut stopped = result.stopped_because.to_string();
    if *cut {
        stopped = "interrupted: it takes too long while something is moved".to_owned();
    } else if !result.stopped_detail.is_empty() {
        stopped += &format!(" ({})", result.stopped_detail);
    }
    // what a person chooses on the page needs no remark there
    let notes: Vec<&String> = notes.iter().filter(|note| !note.contains(PASSED_OVER)).collect();
    let document = Branch {
        about_case: pictures::titled("", case).trim().to_owned(),
        parameter: &result.parameter,
        elements,
        columns: names().map(|name| (name.as_str(), column(&table.numbers(name)))).collect(),
        about: names()
            .map(|name| {
                let (label, unit) = (table.label(name), table.unit(name));
                (name.as_str(), About { label, unit, physical: convert(unit) })
            })
            .collect(),
        film: convert("w0/delta_A"),
        stability: stability(table, full),
        examined,
        full,
        special: special(table, &result.events),
        states: result.pictures.states.iter().map(shown).collect(),
        stopped,
        complete: result.stopped_because.is_complete(),
        warning: result.resolution.filter(|record| !record.enough).map(|record| {
            format!(
                "not resolved with {} elements: folds and forces may be those of the mesh; take {} or more",
                record.elements, record.wanted
            )
        }),
        notes,
        took: 1e3 * took.as_secs_f64(),
    };
    serde_json::to_string(&document)
}

fn column(values: &[f64]) -> Vec<Option<f32>> {
    values.iter().map(|value| value.is_finite().then_some(*value as f32)).collect()
}

fn shown(state: &State) -> Shown {
    let of = |values: &[f64]| values.iter().map(|value| *value as f32).collect();
    let outline = &state.outline;
    Shown {
        point: state.point,
        plate: state.plate.is_finite().then_some(state.plate as f32),
        sigma: of(&outline.sigma),
        z: of(&outline.z),
        pressure: of(&outline.pressure),
    }
}

/// What a state may be called that is not unstable, and whether every kind of mode was looked at.
fn examined(case: &study::case::ResolvedCase, result: &TraceResult) -> (&'static str, bool) {
    match (&case.problem, result.stability) {
        (ProblemCase::Catalogue(_), _) => ("stable", true),
        (ProblemCase::RingLoad(_), _) => {
            ("stable to axisymmetric modes at a fixed ring height; others not examined", false)
        }
        (_, Some(record)) if record.full => ("stable (torsion not examined)", true),
        (_, Some(record)) if record.both_parities => {
            ("stable to axisymmetric modes; modes cos nφ not examined", false)
        }
        _ => ("stable to axisymmetric mirror images; other modes not examined", false),
    }
}

/// What is known at each point. `full`: the table tells of all kinds of mode, in `stable` where it has that.
fn stability(table: &Table, full: bool) -> Vec<Known> {
    let own = table.numbers("unstable");
    let mut others = vec![0.0; own.len()];
    for name in ["unstable_antisymmetric", "unstable_modes"] {
        others.iter_mut().zip(table.numbers(name)).for_each(|(sum, n)| *sum += n.max(0.0));
    }
    let certified: BTreeMap<usize, &str> = table.words("certified").collect();
    let word: BTreeMap<usize, &str> = table.words("stable").collect();
    let scanned = table.columns().iter().any(|name| name == "stable");
    let known = |at: usize| {
        if own[at] > 0.0 {
            return Known::Unstable;
        }
        if others[at] > 0.0 {
            return Known::Asymmetric;
        }
        let uncertain = own[at].is_nan() || certified.get(&at) == Some(&"no");
        match (scanned, word.get(&at)) {
            (true, Some(&"yes")) if !uncertain => Known::Stable,
            (true, _) => Known::Unknown,
            (false, _) if uncertain => Known::Unknown,
            (false, _) if full => Known::Stable,
            (false, _) => Known::StableToSome,
        }
    };
    (0..own.len()).map(known).collect()
}

fn special<'a>(table: &'a Table, events: &'a [EventRecord]) -> Vec<Special<'a>> {
    let kinds: Vec<&str> = table.words("event").map(|(_, kind)| kind).collect();
    let labels = pictures::labels(kinds.iter().copied());
    let found = table.words("event").zip(labels).enumerate();
    found
        .map(|(k, ((point, kind), label))| {
            let event = events.get(k).filter(|event| event.kind == kind);
            let mode = event.and_then(|event| event.mode);
            let counts = |own: Option<usize>, of_mode: Option<usize>| {
                if mode.is_some() { of_mode } else { own }
            };
            Special {
                point,
                kind,
                label,
                before: counts(event.and_then(|e| e.unstable_before), mode.map(|m| m.before)),
                after: counts(event.and_then(|e| e.unstable_after), mode.map(|m| m.after)),
                mode: mode.map(|mode| format!("n = {} {}", mode.n, mode.parity)),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(titles: &[&str], rows: &[&[Option<&str>]]) -> Table {
        let mut table = Table::with_columns(titles);
        for row in rows {
            let cell = |cell: &Option<&str>| match cell {
                Some(text) => text.parse::<usize>().map_or((*text).into(), Into::into),
                None => study::record::Cell::Empty,
            };
            table.push(row.iter().map(cell).collect());
        }
        table
    }

    #[test]
    fn only_what_was_scanned_with_certainty_is_stable() {
        let titles = ["unstable", "unstable_antisymmetric", "unstable_modes", "stable"];
        let scanned = table(
            &titles,
            &[
                &[Some("0"), Some("0"), Some("0"), Some("yes")],
                &[Some("0"), Some("0"), Some("0"), Some("unknown")],
                &[Some("0"), Some("0"), Some("0"), None],
                &[Some("0"), Some("0"), Some("2"), Some("no")],
                &[Some("0"), Some("1"), Some("0"), Some("no")],
                &[Some("1"), Some("0"), Some("0"), Some("no")],
                &[None, Some("0"), Some("0"), Some("yes")],
            ],
        );
        use Known::{Asymmetric, Stable, StableToSome, Unknown, Unstable};
        assert_eq!(
            stability(&scanned, true),
            [Stable, Unknown, Unknown, Asymmetric, Asymmetric, Unstable, Unknown]
        );
        let own = table(
            &["unstable", "certified"],
            &[
                &[Some("0"), Some("yes")],
                &[Some("0"), Some("no")],
                &[Some("1"), Some("no")],
                &[None, None],
            ],
        );
        assert_eq!(stability(&own, true), [Stable, Unknown, Unstable, Unknown]);
        assert_eq!(stability(&own, false), [StableToSome, Unknown, Unstable, Unknown]);
    }
}
