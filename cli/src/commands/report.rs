//! `report.html`: what a command found, as a page to look at.

use crate::output::{ContactRow, TraceResult};
use report::{Chart, Curve, Mark, Report};

/// Name of the file.
pub(super) const REPORT: &str = "report.html";

const FORCE: &str = "force F/√(χ k_b)";
const ENERGIES: [(&str, &str); 6] = [
    ("energy_total", "total"),
    ("energy_stretching", "stretching"),
    ("energy_bending", "bending"),
    ("energy_film", "film"),
    ("energy_gas", "gas"),
    ("energy_surface", "surface"),
];
/// Observables of other problems that have a chart each.
const CHARTS: usize = 4;

/// The page for branches with their names; `subtitle` is a line below the title. Branches of the
/// contact problem are drawn as force curves; where they have states, these are shown.
///
/// # Errors
/// What the writer of JSON reports; memory does not fail, so none is expected.
pub(super) fn report(
    title: &str,
    subtitle: &str,
    branches: &[(String, &TraceResult)],
) -> Result<String, serde_json::Error> {
    let first = branches.first().map(|(_, branch)| *branch);
    let charts = first.map_or_else(Vec::new, |first| {
        if is_contact(first) { contact_charts(branches) } else { general_charts(first) }
    });
    let report = Report {
        title: title.to_owned(),
        subtitle: subtitle.to_owned(),
        charts,
        curves: branches.iter().map(|(label, branch)| curve(label, branch)).collect(),
    };
    report.html()
}

fn is_contact(branch: &TraceResult) -> bool {
    branch.table.columns().starts_with(&ContactRow::COLUMNS.map(str::to_owned))
}

fn pair(name: &str, label: &str) -> (String, String) {
    (name.to_owned(), label.to_owned())
}

/// Force against deformation, unless the force never vanishes, and plate distance; energies.
fn contact_charts(branches: &[(String, &TraceResult)]) -> Vec<Chart> {
    let chart = |title: &str, x: &(String, String), y: &str, columns: Vec<(String, String)>| {
        Chart { title: title.to_owned(), x: x.clone(), y: y.to_owned(), columns }
    };
    let force = || vec![pair("force", "force")];
    let deformation = pair("deformation", "deformation Δ/R₀");
    let distance = pair("z0", "plate distance z₀/R₀");
    let energies = || ENERGIES.map(|(name, label)| pair(name, label)).to_vec();
    let counted = branches
        .iter()
        .any(|(_, branch)| branch.table.numbers("deformation").iter().any(|d| d.is_finite()));
    let mut charts = Vec::new();
    if counted {
        charts.push(chart("Force against deformation", &deformation, FORCE, force()));
    }
    charts.push(chart("Force against plate distance", &distance, FORCE, force()));
    let x = if counted { &deformation } else { &distance };
    charts.push(chart("Energies", x, "energy U/(χ R₀²)", energies()));
    charts
}

/// Observables against the parameter.
fn general_charts(branch: &TraceResult) -> Vec<Chart> {
    let parameter = &branch.parameter;
    observables(branch)
        .take(CHARTS)
        .map(|name| Chart {
            title: format!("{name} against {parameter}"),
            x: pair(parameter, parameter),
            y: name.clone(),
            columns: vec![pair(name, name)],
        })
        .collect()
}

/// The columns between the parameter and the number of unstable modes.
fn observables(branch: &TraceResult) -> impl Iterator<Item = &String> {
    branch.table.columns().iter().skip(2).take_while(|name| *name != "unstable")
}

fn curve(label: &str, branch: &TraceResult) -> Curve {
    let table = &branch.table;
    let shown =
        |name: &&String| !matches!(name.as_str(), "point" | "unstable" | "event" | "certified");
    let marks = branch.marked_points().map(|(point, kind)| Mark { point, kind: kind.to_owned() });
    Curve {
        label: label.to_owned(),
        columns: table
            .columns()
            .iter()
            .filter(shown)
            .map(|name| (name.clone(), table.numbers(name)))
            .collect(),
        unstable: table
            .numbers("unstable")
            .iter()
            .map(|n| if n.is_finite() { *n as i32 } else { -1 })
            .collect(),
        marks: marks.collect(),
        states: branch.pictures.states.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::example;

    /// The data of a page.
    fn data(page: &str) -> serde_json::Value {
        let start = page.find("id=\"data\">").unwrap() + 10;
        let end = start + page[start..].find("</script>").unwrap();
        serde_json::from_str(&page[start..end]).unwrap()
    }

    #[test]
    fn a_contact_branch_has_its_force_curves_and_its_special_points() {
        let result = example();
        let data = data(&report("fig12", "why", &[("branch".to_owned(), &result)]).unwrap());
        assert_eq!((&data["title"], &data["subtitle"]), (&"fig12".into(), &"why".into()));
        let titles: Vec<_> =
            data["charts"].as_array().unwrap().iter().map(|c| &c["title"]).collect();
        assert_eq!(titles.last().unwrap().as_str(), Some("Energies"));
        let curve = &data["curves"][0];
        assert_eq!(curve["unstable"].as_array().unwrap().len(), result.table.rows().len());
        for (name, values) in curve["columns"].as_object().unwrap() {
            assert_eq!(values.as_array().unwrap().len(), result.table.rows().len(), "{name}");
        }
        let kinds = result.table.rows().iter().filter(|row| row[15] != crate::output::Cell::Empty);
        assert_eq!(curve["marks"].as_array().unwrap().len(), kinds.count());
    }
}
