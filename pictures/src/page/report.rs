//! `report.html`: what a command found, as a page to look at.

use super::{Chart, Curve, Mark, Report, State, Units};
use crate::columns::named;
use crate::titled;
use study::case::ResolvedCase;
use study::record;
use study::record::{ContactRow, CycleResult, EventRecord, Laboratory, Table, TraceResult, spoken};
use study::run::RING_AXES;

/// Name of the file.
pub const REPORT: &str = "report.html";

const FORCE: &str = "force F/√(χ k_b)";
const ENERGIES: [(&str, &str); 6] = [
    ("energy_total", "total"),
    ("energy_stretching", "stretching"),
    ("energy_bending", "bending"),
    ("energy_film", "film"),
    ("energy_gas", "gas"),
    ("energy_surface", "surface"),
];
/// The column of words that are "true" or "false".
const FLAG: &str = "admissible";
/// Observables of other problems that have a chart each.
const CHARTS: usize = 4;

/// A curve of a page.
struct Line<'a> {
    label: &'a str,
    table: &'a Table,
    events: &'a [EventRecord],
    states: &'a [record::State],
    jumps: &'a [usize],
}

/// The page for branches of a case with their names; `subtitle` is a line below the title. Branches of the
/// contact problem are drawn as force curves; where they have states, these are shown. A case in physical units
/// is shown in those too.
///
/// # Errors
/// What the writer of JSON reports; memory does not fail, so none is expected.
pub fn report(
    case: &ResolvedCase,
    subtitle: &str,
    branches: &[(String, &TraceResult)],
) -> Result<String, serde_json::Error> {
    let lines: Vec<Line<'_>> = branches
        .iter()
        .map(|(label, branch)| Line {
            label,
            table: &branch.table,
            events: &branch.events,
            states: &branch.pictures.states,
            jumps: &[],
        })
        .collect();
    let parameter = branches.first().map_or("", |(_, branch)| &branch.parameter);
    let mut subtitle = subtitle.to_owned();
    if branches.iter().any(|(_, branch)| branch.stability.is_some_and(|s| !s.full)) {
        let separator = if subtitle.is_empty() { "" } else { "; " };
        subtitle += separator;
        subtitle += "stability against axisymmetric modes only";
    }
    page(case, &subtitle, parameter, &lines, 0)
}

/// The page for a cycle: both ways and the complete branch, of which the states are given.
///
/// # Errors
/// As [`report()`].
pub fn cycle_report(case: &ResolvedCase, cycle: &CycleResult) -> Result<String, serde_json::Error> {
    let ways = cycle.reported.ways.iter().map(|way| Line {
        label: way.label,
        table: &way.table,
        events: &[],
        states: &way.states,
        jumps: &way.jumps,
    });
    let complete = Line {
        label: "complete branch",
        table: &cycle.branch,
        events: &[],
        states: &cycle.reported.branch,
        jumps: &[],
    };
    let lines: Vec<Line<'_>> = [complete].into_iter().chain(ways).collect();
    let counted = cycle.points.iter().any(|row| row.modes.is_some());
    let which = if counted { " of the complete branch" } else { "" };
    let own = if cycle.both_parities { "axisymmetric modes" } else { "axisymmetric mirror images" };
    let separator = if cycle.stopped_detail.is_empty() { "" } else { "; " };
    let subtitle =
        format!("{}{separator}stability{which} against {own} only", cycle.stopped_detail);
    // the complete branch lies below the path
    page(case, &subtitle, cycle.parameter, &lines, 1)
}

fn page(
    case: &ResolvedCase,
    subtitle: &str,
    parameter: &str,
    lines: &[Line<'_>],
    selected: usize,
) -> Result<String, serde_json::Error> {
    let kind = lines.first().map(|line| Kind::of(line.table));
    let charts = match kind {
        Some(Kind::Contact) => contact_charts(lines),
        Some(Kind::RingLoad) => ring_charts(),
        Some(Kind::Other) => general_charts(case, parameter, lines),
        None => Vec::new(),
    };
    let tables: Vec<&Table> = lines.iter().map(|line| line.table).collect();
    let laboratory = Laboratory::of(case, &tables);
    let charts = charts
        .into_iter()
        .map(|chart| match (&laboratory, tables.first()) {
            (Some(laboratory), Some(table)) => physical(chart, laboratory, table),
            _ => chart,
        })
        .collect();
    let heading = titled("", case);
    let bounds = if kind == Some(Kind::RingLoad) { "planes of the rings" } else { "plates" };
    let report = Report {
        title: case.name.clone(),
        about: heading.trim().to_owned(),
        subtitle: subtitle.to_owned(),
        charts,
        curves: lines.iter().map(curve).collect(),
        selected,
        bounds: bounds.to_owned(),
        laboratory: laboratory.map(|laboratory| units(&laboratory, &tables)),
    };
    report.html()
}

/// A chart with the titles that its axes have in physical units.
fn physical(chart: Chart, laboratory: &Laboratory, table: &Table) -> Chart {
    let unit = |column: &str| laboratory.convert(table.unit(column)).map(|(unit, _)| spoken(unit));
    let y = chart.columns.first().and_then(|(column, _)| unit(column));
    let x = unit(&chart.x.0);
    let words = |title: &str| match title.split_once('/') {
        // what stands behind the stroke is the dimensionless unit, as is a power of ten before the symbol
        Some((words, _)) => words.replace("10⁶", ""),
        None => title.to_owned(),
    };
    let in_unit = |title: &str, unit: &Option<String>| match unit {
        Some(unit) => format!("{} [{unit}]", words(title)),
        None => title.to_owned(),
    };
    let titles =
        (x.is_some() || y.is_some()).then(|| (in_unit(&chart.x.1, &x), in_unit(&chart.y, &y)));
    Chart { physical: titles, ..chart }
}

/// The units of columns and shapes.
fn units(laboratory: &Laboratory, tables: &[&Table]) -> Units {
    let of = |unit: &str| {
        let (name, factor) = laboratory.convert(unit)?;
        Some((spoken(name), factor))
    };
    let columns = tables.iter().flat_map(|table| {
        let known = table.columns().iter();
        known.filter_map(|name| Some((name.clone(), of(table.unit(name))?))).collect::<Vec<_>>()
    });
    Units {
        columns: columns.collect(),
        length: of("R0").unwrap_or_default(),
        film: of("w0/delta_A").unwrap_or_else(|| ("w₀/δ_A".to_owned(), 1.0)),
    }
}

/// What a table tells of.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Contact,
    RingLoad,
    Other,
}

impl Kind {
    fn of(table: &Table) -> Self {
        let columns = table.columns();
        if columns.starts_with(&ContactRow::COLUMNS.map(str::to_owned)) {
            Kind::Contact
        } else if columns.iter().any(|name| name == "ring_height") {
            Kind::RingLoad
        } else {
            Kind::Other
        }
    }
}

fn state(state: &record::State) -> State {
    let record::Outline { sigma, z, pressure } = state.outline.clone();
    State { point: state.point, plate: state.plate, below: state.plate_below, sigma, z, pressure }
}

fn pair(name: &str, label: &str) -> (String, String) {
    (name.to_owned(), label.to_owned())
}

fn chart(title: &str, x: &(String, String), y: &str, columns: Vec<(String, String)>) -> Chart {
    let (title, y) = (title.to_owned(), y.to_owned());
    Chart { title, x: x.clone(), y, physical: None, columns }
}

fn force() -> Vec<(String, String)> {
    vec![pair("force", "force")]
}

/// Force against deformation, unless the force never vanishes, against plate distance, and against
/// the base of a cantilever; energies.
fn contact_charts(lines: &[Line<'_>]) -> Vec<Chart> {
    let deformation = pair("deformation", "deformation Δ/R₀");
    let distance = pair("z0", "plate distance z₀/R₀");
    let energies = || ENERGIES.map(|(name, label)| pair(name, label)).to_vec();
    let known =
        |name: &str| lines.iter().any(|l| l.table.numbers(name).iter().any(|x| x.is_finite()));
    let mut charts = Vec::new();
    if known("deformation") {
        charts.push(chart("Force against deformation", &deformation, FORCE, force()));
    }
    charts.push(chart("Force against plate distance", &distance, FORCE, force()));
    if known("base") {
        let base = pair("base", "base of the cantilever/R₀");
        charts.push(chart("Force against base", &base, FORCE, force()));
    }
    let x = if known("deformation") { &deformation } else { &distance };
    charts.push(chart("Energies", x, "energy U/(χ R₀²)", energies()));
    charts
}

/// Force against contact angle and deflection.
fn ring_charts() -> Vec<Chart> {
    let (angle, axis) = RING_AXES;
    let angle = pair("alpha", angle);
    let deflection = pair("deflection_over_h", "deflection of the ring/h");
    vec![
        chart("Force against contact angle", &angle, axis, force()),
        chart("Force against deflection", &deflection, axis, force()),
        chart("Energy", &angle, "energy U/(χ R₀²)", vec![pair("energy_total", "total")]),
    ]
}

/// Observables against the parameter.
fn general_charts(case: &ResolvedCase, parameter: &str, lines: &[Line<'_>]) -> Vec<Chart> {
    let x = pair(parameter, &named(case, parameter));
    let columns = lines.first().map_or(&[][..], |line| line.table.columns());
    // the columns between the parameter and the number of unstable modes
    let observables = columns.iter().skip(2).take_while(|name| *name != "unstable");
    observables
        .take(CHARTS)
        .map(|name| {
            let title = format!("{name} against {parameter}");
            chart(&title, &x, &named(case, name), vec![pair(name, name)])
        })
        .collect()
}

fn curve(line: &Line<'_>) -> Curve {
    let table = line.table;
    let shown = |name: &&String| {
        let elsewhere = matches!(name.as_str(), "point" | "unstable" | "event" | "certified");
        !elsewhere && *name != FLAG
    };
    let marks = table.words("event").enumerate().map(|(k, (point, kind))| {
        let event = line.events.get(k).filter(|event| event.kind == kind);
        // where symmetry is lost these do not change: the page takes what its neighbours have
        let unstable = event
            .filter(|event| event.mode.is_none())
            .map(|event| [event.unstable_before, event.unstable_after]);
        Mark { point, kind: kind.to_owned(), unstable }
    });
    let flag: Vec<bool> = table.words(FLAG).map(|(_, word)| word == "true").collect();
    // a flag that is not known everywhere is not shown
    let known = !flag.is_empty() && flag.len() == table.rows().len();
    Curve {
        label: line.label.to_owned(),
        columns: table
            .columns()
            .iter()
            .filter(shown)
            .map(|name| (name.clone(), table.numbers(name)))
            .collect(),
        unstable: unstable(table),
        marks: marks.collect(),
        flags: known.then(|| (FLAG.to_owned(), flag)).into_iter().collect(),
        jumps: line.jumps.to_vec(),
        states: line.states.iter().map(state).collect(),
    }
}

/// Unstable modes of every point, of all kinds that were counted; −1 where that is not known.
fn unstable(table: &Table) -> Vec<i32> {
    let mut total = table.numbers("unstable");
    for kind in ["unstable_antisymmetric", "unstable_modes"] {
        let own = table.numbers(kind);
        // an empty column is counted elsewhere: from pole to pole either parity is the branch's own
        if own.iter().any(|n| n.is_finite()) {
            total.iter_mut().zip(own).for_each(|(total, n)| *total += n);
        }
    }
    total.iter().map(|n| if n.is_finite() { *n as i32 } else { -1 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;
    use study::case::{Override, load};
    use study::run::run_trace;

    /// A short branch.
    fn example() -> TraceResult {
        let keys = ["mesh.elements=40", "path.end=0.85", "stability.scan=axisymmetric"];
        let overrides = keys.map(Override::new);
        let case = load("fig12".as_ref(), &overrides, &[]).unwrap().case;
        run_trace(&case, &mut |_| ControlFlow::Continue(())).unwrap()
    }

    fn case(name: &str) -> ResolvedCase {
        load(name.as_ref(), &[], &study::case::catalogue()).unwrap().case
    }

    #[test]
    fn a_case_in_physical_units_has_them_on_its_page() {
        let polymer = load(
            "polymer".as_ref(),
            &["mesh.elements=40", "path.end=1.0", "stability.scan=axisymmetric"].map(Override::new),
            &[],
        );
        let polymer = polymer.unwrap().case;
        let result = run_trace(&polymer, &mut |_| ControlFlow::Continue(())).unwrap();
        let page = report(&polymer, "", &[("branch".to_owned(), &result)]).unwrap();
        let data = data(&page);
        let (z0, factor) = (&data["laboratory"]["columns"]["z0"], 1500.0);
        assert_eq!(z0[0], "nm");
        assert!((z0[1].as_f64().unwrap() / factor - 1.0).abs() < 1e-12);
        assert!(data["laboratory"]["columns"].get("unstable").is_none());
        let titles = &data["charts"][0]["physical"];
        assert_eq!(
            (&titles[0], &titles[1]),
            (&"deformation Δ [nm]".into(), &"force F [nN]".into())
        );
        assert!(data["about"].as_str().unwrap().contains("R₀ = 1.5 µm"));
        let plain = report(&case("fig12"), "", &[("branch".to_owned(), &example())]).unwrap();
        assert!(!plain.contains("\"laboratory\":"));
    }

    /// The data of a page.
    fn data(page: &str) -> serde_json::Value {
        let start = page.find("id=\"data\">").unwrap() + 10;
        let end = start + page[start..].find("</script>").unwrap();
        serde_json::from_str(&page[start..end]).unwrap()
    }

    #[test]
    fn a_contact_branch_has_its_force_curves_and_its_special_points() {
        let result = TraceResult { stability: None, ..example() };
        let data = data(&report(&case("fig12"), "why", &[("branch".to_owned(), &result)]).unwrap());
        assert_eq!((&data["title"], &data["subtitle"]), (&"fig12".into(), &"why".into()));
        let titles: Vec<_> =
            data["charts"].as_array().unwrap().iter().map(|c| &c["title"]).collect();
        assert_eq!(titles.last().unwrap().as_str(), Some("Energies"));
        let curve = &data["curves"][0];
        assert_eq!(curve["unstable"].as_array().unwrap().len(), result.table.rows().len());
        for (name, values) in curve["columns"].as_object().unwrap() {
            assert_eq!(values.as_array().unwrap().len(), result.table.rows().len(), "{name}");
        }
        assert_eq!((&data["selected"], &data["bounds"]), (&0.into(), &"plates".into()));
        // what was left out is said
        let stability = study::record::StabilityRecord::default();
        let result = TraceResult { stability: Some(stability), ..result };
        let other = report(&case("fig12"), "why", &[("branch".to_owned(), &result)]).unwrap();
        assert!(other.contains("why; stability against axisymmetric modes only"));
        let kinds = result.table.rows().iter().filter(|row| row[15] != study::record::Cell::Empty);
        assert_eq!(curve["marks"].as_array().unwrap().len(), kinds.count());
    }
}
