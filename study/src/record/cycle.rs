//! `cycle.json` and `cycle.csv`: the path travelled, its jumps and what they dissipate; and the same
//! for people.

use super::column::PLATES;
use super::events::maxwell_of;
use super::number::rounded;
use super::outline::State;
use super::physical::{Laboratory, spoken};
use super::result::{Cell, MaxwellRecord, Table};
use super::summary::{aligned, count};
use super::view::CyclePictures;
use crate::case::{Device, ResolvedCase};
use continuation::StopReason;
use serde::Serialize;
use serde_json::json;
use std::fmt::Write as _;
use std::path::Path;

/// Everything a cycle hands over.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleResult {
    /// Name of the case.
    pub case: String,
    /// The device.
    pub device: Device,
    /// Name of its parameter.
    pub parameter: &'static str,
    /// Where the parameter starts, and where it turns.
    pub path: (f64, f64),
    /// The path.
    pub points: Vec<PathRow>,
    /// The complete branch.
    pub branch: Table,
    /// Whether the path follows axisymmetric modes of both parities, not mirror images only.
    pub both_parities: bool,
    /// The jumps, in order.
    pub jumps: Vec<JumpRecord>,
    /// Plate distance and force of the most attractive force on the way out.
    pub pull_off: Option<(f64, f64)>,
    /// Energy dissipated by all jumps.
    pub dissipated: Option<f64>,
    /// Work done on the whole loop.
    pub loop_area: Option<f64>,
    /// Estimated error of the work.
    pub area_error: Option<f64>,
    /// Work done on the way in and out.
    pub work: Option<(f64, f64)>,
    /// Whether the path came back to its first state.
    pub closed: bool,
    /// The folds of the complete branch.
    pub folds: Vec<FoldRecord>,
    /// Its unstable stretches.
    pub unstable: Vec<StretchRecord>,
    /// Its Maxwell points.
    pub maxwell: Vec<MaxwellRecord>,
    /// Why the work ended.
    pub stopped_because: StopReason,
    /// The same in a sentence; may be empty.
    pub stopped_detail: String,
    /// Jacobian assemblies.
    pub newton_iterations: usize,
    /// From the resolved case to the last point.
    pub seconds: f64,
    /// What the pictures show.
    pub pictures: CyclePictures,
    /// What a report shows, if one was asked for.
    pub reported: ReportedCycle,
}

/// Parities of axisymmetric modes.
const PARITIES: [&str; 2] = ["symmetric", "antisymmetric"];

/// What a report of a cycle shows besides the complete branch.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReportedCycle {
    /// The ways, in the order in which they were gone.
    pub ways: Vec<Way>,
    /// States along the complete branch.
    pub branch: Vec<State>,
}

/// One way of a cycle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Way {
    /// `approach` or `retract`.
    pub label: &'static str,
    /// Its points, in the columns of a branch.
    pub table: Table,
    /// Rows to which the state before them jumped.
    pub jumps: Vec<usize>,
    /// States along it.
    pub states: Vec<State>,
}

/// A state on the path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathRow {
    /// `approach` or `retract`.
    pub direction: &'static str,
    /// Number of the state, from zero.
    pub step: usize,
    /// Plate distance.
    pub z0: f64,
    /// Force.
    pub force: f64,
    /// Energy of the whole shell.
    pub energy_total: f64,
    /// The device's parameter.
    pub parameter: f64,
    /// Kind of special point; `jump` for the state after one.
    pub event: String,
    /// What else it is unstable to, if that was counted.
    pub modes: Option<PathModes>,
}

/// Unstable modes of a state on the path beside those at whose loss the path jumps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathModes {
    /// Axisymmetric modes that break the mirror symmetry; `None` where the path follows those too.
    pub antisymmetric: Option<usize>,
    /// Modes with waves around the axis, pairs counted once.
    pub modes: usize,
    /// The fewest waves of them.
    pub first_n: Option<usize>,
    /// The most waves examined.
    pub n_max: usize,
    /// Whether the counts are certain.
    pub certain: bool,
}

impl PathModes {
    /// Whether any mode that was counted is unstable.
    pub fn is_unstable(&self) -> bool {
        self.modes > 0 || self.antisymmetric.is_some_and(|n| n > 0)
    }

    /// Whether the state is stable to everything that was counted.
    fn word(&self) -> &'static str {
        match (self.is_unstable(), self.certain) {
            (true, _) => "no",
            (false, true) => "yes",
            (false, false) => "unknown",
        }
    }

    /// Its cells of the columns [`MODES`].
    pub(crate) fn cells(&self) -> [Cell; 4] {
        let antisymmetric = self.antisymmetric.map_or(Cell::Empty, Into::into);
        [antisymmetric, self.modes.into(), self.first_n.into(), self.word().into()]
    }

    /// The mode in words.
    fn kind(&self) -> String {
        match (self.antisymmetric, self.first_n) {
            (Some(n), _) if n > 0 => "without mirror symmetry".to_owned(),
            (_, Some(n)) => format!("n = {n}"),
            _ => String::new(),
        }
    }
}

/// A jump; `None` is a plate that is far away.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JumpRecord {
    /// `approach` or `retract`.
    pub direction: &'static str,
    /// The device's parameter.
    pub parameter: f64,
    /// Plate distance before.
    pub z0_before: Option<f64>,
    /// And after.
    pub z0_after: Option<f64>,
    /// Force before.
    pub force_before: Option<f64>,
    /// And after.
    pub force_after: Option<f64>,
    /// Energy of the whole shell before.
    pub energy_before: Option<f64>,
    /// And after.
    pub energy_after: Option<f64>,
    /// Energy dissipated.
    pub dissipated: Option<f64>,
    /// Steps of the motion.
    pub steps: usize,
}

/// A fold of the complete branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FoldRecord {
    /// The device's parameter.
    pub parameter: f64,
    /// Plate distance.
    pub z0: f64,
    /// Force.
    pub force: f64,
    /// Unstable modes before.
    pub unstable_before: Option<usize>,
    /// And after.
    pub unstable_after: Option<usize>,
    /// Estimated error of the location.
    pub error_estimate: f64,
}

/// An unstable stretch of the complete branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StretchRecord {
    /// Unstable modes.
    pub modes: usize,
    /// Number of points.
    pub points: usize,
    /// Plate distances of the first and last one.
    pub z0: (f64, f64),
    /// Forces there.
    pub force: (f64, f64),
}

impl CycleResult {
    /// Whether every state's modes were counted for certain; `None` where none were.
    fn certain(&self) -> Option<bool> {
        let counted = self.points.iter().any(|row| row.modes.is_some());
        let certain = |row: &PathRow| row.modes.is_some_and(|modes| modes.certain);
        counted.then(|| self.points.iter().all(certain))
    }

    /// States of the path that are unstable to modes that it does not follow.
    fn unstable_states(&self) -> impl Iterator<Item = (&PathRow, PathModes)> {
        let rows = self.points.iter().filter_map(|row| Some((row, row.modes?)));
        rows.filter(|(_, modes)| modes.is_unstable())
    }

    /// To which modes the path is stable.
    fn stability(&self) -> serde_json::Value {
        let parities = if self.both_parities { &PARITIES[..] } else { &PARITIES[..1] };
        let certain = self.certain();
        let n_max = self.points.iter().filter_map(|row| Some(row.modes?.n_max)).max();
        let unstable = certain.map(|_| self.unstable_states().count());
        json!({
            "followed": { "n": 0, "parities": parities },
            "scan": if certain.is_some() { "full" } else { "axisymmetric" },
            "max_n": n_max,
            "certain": certain,
            "unstable_states": unstable,
        })
    }

    /// The same in sentences.
    fn stability_text(&self) -> String {
        let parities = if self.both_parities { "with and without" } else { "with" };
        let mut text = format!(
            "stability: of the path against axisymmetric modes {parities} mirror symmetry; "
        );
        let mut unstable = self.unstable_states();
        text += &match (self.certain(), unstable.next()) {
            (None, _) => "other modes were not counted".to_owned(),
            (Some(_), Some((row, modes))) => {
                let (way, kind) = (row.direction, modes.kind());
                let number = match unstable.count() {
                    0 => "one state is".to_owned(),
                    more => format!("{} states are", more + 1),
                };
                let (name, at) = (self.parameter, rounded(row.parameter));
                format!("{number} unstable to others, first on {way} at {name} = {at} ({kind})")
            }
            (Some(true), None) => "no other one is unstable, torsion left out".to_owned(),
            (Some(false), None) => "of others it is not certain at every state".to_owned(),
        };
        text + "\n"
    }

    /// Difference of loop area and dissipated energy, relative to the larger; without jumps, the loop
    /// area relative to the work on one way.
    fn imbalance(&self) -> Option<f64> {
        let (area, dissipated) = (self.loop_area?, self.dissipated?);
        let scale = match self.jumps.is_empty() {
            true => self.work.map_or(0.0, |(a, b)| a.abs().max(b.abs())),
            false => area.abs().max(dissipated.abs()),
        };
        (scale > 0.0).then(|| (area - dissipated).abs() / scale)
    }
}

/// The JSON, indented, with a newline at the end.
///
/// # Errors
/// What the writer reports; memory does not fail, so none is expected.
pub fn cycle_json(result: &CycleResult) -> Result<String, serde_json::Error> {
    let pull_off = result.pull_off.map(|(z0, force)| json!({ "z0": z0, "force": force }));
    let work = result.work.map(|(a, b)| json!({ "approach": a, "retract": b }));
    let document = Document {
        case: &result.case,
        device: result.device.name(),
        stiffness: result.device.stiffness(),
        parameter: result.parameter,
        start: result.path.0,
        end: result.path.1,
        jumps: &result.jumps,
        pull_off,
        dissipated_total: result.dissipated,
        loop_area: result.loop_area,
        loop_area_error: result.area_error,
        imbalance: result.imbalance(),
        work,
        closed: result.closed,
        folds: &result.folds,
        unstable: &result.unstable,
        maxwell: maxwell_of(&result.maxwell),
        stability: result.stability(),
        stopped_because: result.stopped_because.to_string(),
        stopped_detail: &result.stopped_detail,
        points: result.points.len(),
        branch_points: result.branch.rows().len(),
        newton_iterations: result.newton_iterations,
        seconds: result.seconds,
    };
    let mut text = serde_json::to_string_pretty(&document)?;
    text.push('\n');
    Ok(text)
}

#[derive(Serialize)]
struct Document<'a> {
    case: &'a str,
    device: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    stiffness: Option<f64>,
    parameter: &'a str,
    start: f64,
    end: f64,
    jumps: &'a [JumpRecord],
    pull_off: Option<serde_json::Value>,
    dissipated_total: Option<f64>,
    loop_area: Option<f64>,
    loop_area_error: Option<f64>,
    imbalance: Option<f64>,
    work: Option<serde_json::Value>,
    closed: bool,
    folds: &'a [FoldRecord],
    unstable: &'a [StretchRecord],
    maxwell: Vec<super::events::MaxwellOf<'a>>,
    stability: serde_json::Value,
    stopped_because: String,
    stopped_detail: &'a str,
    points: usize,
    branch_points: usize,
    newton_iterations: usize,
    seconds: f64,
}

/// Columns of what a state is unstable to.
pub(crate) const MODES: [&str; 4] =
    ["unstable_antisymmetric", "unstable_modes", "first_n", "stable"];

/// The path as a table.
pub fn cycle_table(result: &CycleResult) -> Table {
    let mut columns = vec!["direction", "step", "z0", "force", "energy_total"];
    if result.parameter == "base" {
        columns.push(result.parameter);
    }
    columns.push("event");
    let counted = result.points.iter().any(|row| row.modes.is_some());
    if counted {
        columns.extend(MODES);
    }
    let mut table = Table::with_columns(&columns).described(PLATES);
    for row in &result.points {
        let mut cells: Vec<Cell> = vec![
            row.direction.into(),
            row.step.into(),
            row.z0.into(),
            row.force.into(),
            row.energy_total.into(),
        ];
        if result.parameter == "base" {
            cells.push(row.parameter.into());
        }
        cells.push(row.event.as_str().into());
        if let (true, Some(modes)) = (counted, row.modes) {
            cells.extend(modes.cells());
        }
        cells.resize(columns.len(), Cell::Empty);
        table.push(cells);
    }
    table
}

/// Lengths, forces and energies of a cycle in physical units.
struct Physically {
    length: (String, f64),
    force: (String, f64),
    energy: (String, f64),
}

impl Physically {
    /// `None` for a case that is dimensionless.
    fn of(case: &ResolvedCase, result: &CycleResult) -> Option<Self> {
        let laboratory = Laboratory::of(case, &[&result.branch])?;
        let unit = |unit: &str| {
            laboratory
                .convert(unit)
                .map(|(unit, factor)| (spoken(unit), factor))
                .unwrap_or_default()
        };
        Some(Physically {
            length: unit("R0"),
            force: unit("sqrt(chi k_b)"),
            energy: unit("chi R0^2"),
        })
    }

    /// The jumps once more.
    fn jumps(&self, jumps: &[JumpRecord]) -> String {
        let named = |name: &str, unit: &str| format!("{name} [{unit}]");
        let number = |value: Option<f64>, factor: f64| {
            value.map_or_else(|| "–".to_string(), |value| rounded(factor * value))
        };
        let (length, force, energy) = (&self.length, &self.force, &self.energy);
        let mut rows = vec![vec![
            "in physical units".to_owned(),
            named("z0 before", &length.0),
            named("z0 after", &length.0),
            named("force before", &force.0),
            named("force after", &force.0),
            named("dissipated", &energy.0),
        ]];
        rows.extend(jumps.iter().map(|jump| {
            vec![
                jump.direction.to_owned(),
                number(jump.z0_before, length.1),
                number(jump.z0_after, length.1),
                number(jump.force_before, force.1),
                number(jump.force_after, force.1),
                number(jump.dissipated, energy.1),
            ]
        }));
        aligned(&rows)
    }

    /// A place of the path in brackets.
    fn place(&self, (z0, force): (f64, f64)) -> String {
        let (f, z) = (rounded(self.force.1 * force), rounded(self.length.1 * z0));
        format!(" ({f} {} at {z} {})", self.force.0, self.length.0)
    }
}

/// The summary; `folder` is where the files went, if they went anywhere.
pub fn cycle_summary(case: &ResolvedCase, result: &CycleResult, folder: Option<&Path>) -> String {
    let mut out = String::new();
    let name = result.parameter;
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_string(), rounded);
    if result.jumps.is_empty() {
        out.push_str("no jumps: the way out is the way in, and nothing is dissipated\n");
    } else {
        let titles =
            ["jump", name, "z0 before", "z0 after", "force before", "force after", "dissipated"];
        let mut rows = vec![titles.map(str::to_string).to_vec()];
        for jump in &result.jumps {
            rows.push(vec![
                jump.direction.to_string(),
                rounded(jump.parameter),
                number(jump.z0_before),
                number(jump.z0_after),
                number(jump.force_before),
                number(jump.force_after),
                number(jump.dissipated),
            ]);
        }
        out.push_str(&aligned(&rows));
    }
    let physical = Physically::of(case, result);
    if let Some(physical) = physical.as_ref().filter(|_| !result.jumps.is_empty()) {
        let _ = write!(out, "\n{}", physical.jumps(&result.jumps));
    }
    out.push('\n');
    if let Some((z0, force)) = result.pull_off {
        let place = physical.map(|physical| physical.place((z0, force))).unwrap_or_default();
        let _ = writeln!(out, "pull-off: force {} at z0 = {}{place}", rounded(force), rounded(z0));
    }
    if let (Some(dissipated), Some(area)) = (result.dissipated, result.loop_area)
        && let Some(imbalance) = result.imbalance()
        && !result.jumps.is_empty()
    {
        let _ = writeln!(
            out,
            "dissipated {}, area of the loop {} (they differ by {imbalance:.0e})",
            rounded(dissipated),
            rounded(area)
        );
    } else if let Some(dissipated) = result.dissipated.filter(|_| !result.jumps.is_empty()) {
        let _ = writeln!(out, "dissipated {}; the loop is not closed", rounded(dissipated));
    }
    if let Some((approach, retract)) = result.work {
        let (a, b) = (rounded(approach), rounded(retract));
        let _ = writeln!(out, "work of the plates: approach {a}, retract {b}");
    }
    for point in result.maxwell.iter().filter(|point| point.unstable == [Some(0); 2]) {
        let [a, b] = if name == "force" { point.z0 } else { point.force }.map(rounded);
        let other = if name == "force" { "z0" } else { "force" };
        let at = rounded(point.value);
        let _ =
            writeln!(out, "equal energies (Maxwell point) at {name} = {at}: {other} {a} and {b}");
    }
    out.push_str(&result.stability_text());
    let _ = write!(out, "{}: stopped at {}", result.case, result.stopped_because);
    if !result.stopped_detail.is_empty() {
        let _ = write!(out, " ({})", result.stopped_detail);
    }
    let _ = writeln!(
        out,
        "; {}, {} points, {} Newton iterations, {:.2} s",
        count(result.jumps.len(), "jump", "jumps"),
        result.points.len(),
        result.newton_iterations,
        result.seconds
    );
    if let Some(folder) = folder {
        let _ = writeln!(out, "written to {}", folder.display());
    }
    out
}
