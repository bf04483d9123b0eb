//! `diagram.json`: the branches of a diagram, how they hang together, and the table for people.

use super::events::{EventOf, ResolutionOf, StabilityOf};
use super::number::rounded;
use super::orbits::{CyclesRecord, OrbitsRecord};
use super::physical::{Laboratory, spoken};
use super::result::{ResolutionRecord, StabilityRecord, Table, TraceResult};
use super::summary::{aligned, count};
use super::view::Curve;
use crate::case::ResolvedCase;
use continuation::StopReason;
use continuation::diagram::Joint;
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use std::fmt::Write as _;
use std::path::Path;

/// Where a branch begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BranchOrigin {
    /// At the start of the case.
    Start,
    /// At a special point of another branch.
    Switch {
        /// The other branch.
        branch: usize,
        /// Its event.
        event: usize,
    },
    /// At a solution found by deflation.
    Deflation {
        /// The branch beside which it was found.
        branch: usize,
        /// The parameter's value there.
        parameter: f64,
    },
    /// At a state found from two states of a symmetric branch in series.
    Springs {
        /// The symmetric branch.
        branch: usize,
        /// The parameter's value there.
        parameter: f64,
    },
}

impl Serialize for BranchOrigin {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            BranchOrigin::Start => serializer.serialize_none(),
            BranchOrigin::Switch { branch, event } => {
                let mut map = serializer.serialize_map(Some(2))?;
                map.serialize_entry("branch", branch)?;
                map.serialize_entry("event", event)?;
                map.end()
            }
            BranchOrigin::Deflation { branch, parameter } => {
                let mut map = serializer.serialize_map(Some(3))?;
                map.serialize_entry("branch", branch)?;
                map.serialize_entry("deflation", &true)?;
                map.serialize_entry("parameter", parameter)?;
                map.end()
            }
            BranchOrigin::Springs { branch, parameter } => {
                let mut map = serializer.serialize_map(Some(3))?;
                map.serialize_entry("branch", branch)?;
                map.serialize_entry("springs", &true)?;
                map.serialize_entry("parameter", parameter)?;
                map.end()
            }
        }
    }
}

/// A bifurcation that a small change would make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearRecord {
    /// `branch-point`, or `folds` that nearly meet.
    pub kind: &'static str,
    /// Where.
    pub parameter: f64,
    /// How near, relative.
    pub gap: f64,
}

/// What the states of a branch look like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// They are their own mirror images about the equator.
    Mirror,
    /// They are not: the mirror image of the branch is another one, with the same numbers.
    Asymmetric,
}

impl Symmetry {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Symmetry::Mirror => "symmetric about the equator",
            Symmetry::Asymmetric => "asymmetric about the equator",
        }
    }
}

/// A branch of a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchRecord {
    /// Its number.
    pub id: usize,
    /// Where it begins.
    pub from: BranchOrigin,
    /// How many branch points lie between it and the first.
    pub depth: usize,
    /// What its states look like, where a diagram has several kinds.
    pub symmetry: Option<Symmetry>,
    /// Why it ends at its first point, if that is an end.
    pub began_because: Option<StopReason>,
    /// Its near-bifurcations.
    pub near: Vec<NearRecord>,
    /// The branch itself.
    pub trace: TraceResult,
    /// What is drawn of it; of cycles the maximum and the minimum.
    pub curve: Curve,
    /// Of a branch of periodic orbits, what it has beyond its points.
    pub orbits: Option<OrbitsRecord>,
}

impl BranchRecord {
    /// The file with its points.
    pub fn csv(&self) -> String {
        let kind = if self.is_asymmetric() { "-asymmetric" } else { "" };
        format!("branch-{}{kind}.csv", self.id)
    }

    /// The file with some of its cycles over time.
    pub fn orbit_csv(&self) -> String {
        format!("orbit-{}.csv", self.id)
    }

    /// Whether its states are not their own mirror images.
    pub fn is_asymmetric(&self) -> bool {
        self.symmetry == Some(Symmetry::Asymmetric)
    }
}

/// Everything that the exploration of a diagram hands over.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagramResult {
    /// Name of the case.
    pub case: String,
    /// Name of the continued parameter.
    pub parameter: String,
    /// The branches.
    pub branches: Vec<BranchRecord>,
    /// The branch points that join them.
    pub joints: Vec<Joint>,
    /// Why it ended, in a word.
    pub stopped_because: &'static str,
    /// The same in a sentence; may be empty.
    pub stopped_detail: String,
    /// Whether all that can be followed was followed to its end.
    pub followed: bool,
    /// Jacobian assemblies.
    pub newton_iterations: usize,
    /// Time spent on branches, in all runs.
    pub seconds: f64,
    /// Labels of the picture's axes.
    pub axes: (String, String),
    /// What was done about periodic orbits; `None` where there are no Hopf points.
    pub cycles: Option<CyclesRecord>,
}

impl DiagramResult {
    /// Whether there is anything to draw.
    pub fn has_curves(&self) -> bool {
        let mut values = self.branches.iter().flat_map(|one| &one.curve.y);
        values.any(|y| y.is_finite())
    }

    fn points(&self) -> usize {
        self.branches.iter().map(|one| one.trace.points).sum()
    }

    /// What the stability of all branches was examined for, those without mirror symmetry left out;
    /// `None` where that has no meaning.
    fn stability(&self) -> Option<StabilityRecord> {
        let own = self.branches.iter().filter(|one| !one.is_asymmetric());
        let records = own.filter_map(|one| one.trace.stability);
        records.reduce(|all, one| all.and(&one))
    }

    /// The title of its picture.
    pub fn title(&self) -> String {
        self.resolution().map_or_else(|| self.case.clone(), |record| record.titled(&self.case))
    }

    /// How well the elements resolve the branch where they do worst; `None` where that was not examined.
    fn resolution(&self) -> Option<ResolutionRecord> {
        let records = self.branches.iter().filter_map(|one| one.trace.resolution);
        records.reduce(|all, one| all.and(&one))
    }

    /// Whether all numbers of unstable modes are certain; `None` where there are none.
    fn certified(&self) -> Option<bool> {
        self.branches.iter().filter_map(|one| one.trace.certified).reduce(|a, b| a && b)
    }
}

/// The JSON, indented, with a newline at the end; NaN and infinities are null. Special points of a case in
/// physical units have their numbers in those too.
///
/// # Errors
/// What the writer reports; memory does not fail, so none is expected.
pub fn diagram_json(
    case: &ResolvedCase,
    result: &DiagramResult,
) -> Result<String, serde_json::Error> {
    let tables: Vec<&Table> = result.branches.iter().map(|one| &one.trace.table).collect();
    let laboratory = Laboratory::of(case, &tables);
    let mut text = serde_json::to_string_pretty(&Document(result, laboratory.as_ref()))?;
    text.push('\n');
    Ok(text)
}

struct Document<'a>(&'a DiagramResult, Option<&'a Laboratory>);

impl Serialize for Document<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Document(result, laboratory) = self;
        let of = |one| BranchOf(one, *laboratory);
        let branches: Vec<BranchOf<'_>> = result.branches.iter().map(of).collect();
        let joints: Vec<JointOf<'_>> = result.joints.iter().map(JointOf).collect();
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("case", &result.case)?;
        map.serialize_entry("parameter", &result.parameter)?;
        map.serialize_entry("branches", &branches)?;
        map.serialize_entry("joints", &joints)?;
        map.serialize_entry("stopped_because", result.stopped_because)?;
        map.serialize_entry("stopped_detail", &result.stopped_detail)?;
        if let Some(cycles) = &result.cycles {
            map.serialize_entry("cycles", cycles)?;
        }
        map.serialize_entry("points", &result.points())?;
        map.serialize_entry("certified", &result.certified())?;
        if let Some(stability) = &result.stability() {
            map.serialize_entry("stability", &StabilityOf(stability))?;
        }
        if let Some(resolution) = &result.resolution() {
            map.serialize_entry("resolution", &ResolutionOf(resolution))?;
        }
        map.serialize_entry("newton_iterations", &result.newton_iterations)?;
        map.serialize_entry("seconds", &result.seconds)?;
        map.end()
    }
}

struct BranchOf<'a>(&'a BranchRecord, Option<&'a Laboratory>);

impl Serialize for BranchOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let BranchRecord { id, from, depth, symmetry, began_because, near, trace, .. } = self.0;
        let parameter = &trace.parameter;
        let laboratory = self.1.map(|laboratory| (laboratory, &trace.table));
        let events: Vec<EventOf<'_>> =
            trace.events.iter().map(|event| EventOf { event, parameter, laboratory }).collect();
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("id", id)?;
        map.serialize_entry("from", from)?;
        if self.0.orbits.is_some() {
            map.serialize_entry("kind", "cycles")?;
        }
        map.serialize_entry("depth", depth)?;
        if let Some(symmetry) = symmetry {
            map.serialize_entry("symmetry", symmetry.name())?;
        }
        map.serialize_entry("csv", &self.0.csv())?;
        if let Some(orbits) = &self.0.orbits {
            map.serialize_entry("orbits_csv", &self.0.orbit_csv())?;
            if let Some((branch, event)) = orbits.vanishes_at {
                map.serialize_entry("vanishes_at", &BranchOrigin::Switch { branch, event })?;
            }
        }
        map.serialize_entry("events", &events)?;
        if !near.is_empty() {
            let near: Vec<NearOf<'_>> =
                near.iter().map(|near| NearOf { near, parameter }).collect();
            map.serialize_entry("near_bifurcations", &near)?;
        }
        if let Some(reason) = began_because {
            map.serialize_entry("began_because", &reason.to_string())?;
        }
        map.serialize_entry("stopped_because", &trace.stopped_because.to_string())?;
        map.serialize_entry("stopped_detail", &trace.stopped_detail)?;
        map.serialize_entry("points", &trace.points)?;
        map.serialize_entry("certified", &trace.certified)?;
        if let Some(stability) = &trace.stability {
            map.serialize_entry("stability", &StabilityOf(stability))?;
        }
        map.serialize_entry("newton_iterations", &trace.newton_iterations)?;
        map.end()
    }
}

struct NearOf<'a> {
    near: &'a NearRecord,
    parameter: &'a str,
}

impl Serialize for NearOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3))?;
        map.serialize_entry("kind", self.near.kind)?;
        map.serialize_entry(self.parameter, &self.near.parameter)?;
        map.serialize_entry("gap", &self.near.gap)?;
        map.end()
    }
}

struct JointOf<'a>(&'a Joint);

impl Serialize for JointOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let passed = self.0.passed.iter();
        let passed: Vec<BranchOrigin> =
            passed.map(|&(branch, event)| BranchOrigin::Switch { branch, event }).collect();
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("passed", &passed)?;
        map.serialize_entry("begun", &self.0.begun)?;
        map.serialize_entry("open", &self.0.open)?;
        map.end()
    }
}

/// The table for people; `folder` is where the files went, if they went anywhere.
pub fn diagram_summary(
    case: &ResolvedCase,
    result: &DiagramResult,
    folder: Option<&Path>,
) -> String {
    let titles = ["branch", "from", "points", result.parameter.as_str(), "special points", "ends"];
    let mut rows = vec![titles.map(str::to_owned).to_vec()];
    for one in &result.branches {
        let from = match one.from {
            BranchOrigin::Start => "start".to_owned(),
            BranchOrigin::Switch { branch, event } => format!("{branch}, event {event}"),
            BranchOrigin::Deflation { branch, .. } => format!("beside {branch}"),
            BranchOrigin::Springs { branch, .. } => format!("two states of {branch}"),
        };
        let (low, high) = range(&one.curve.x);
        let mut ends = one.trace.stopped_because.to_string();
        if let Some(began) = one.began_because {
            ends = format!("{began}, {ends}");
        }
        rows.push(vec![
            match &one.orbits {
                Some(_) => format!("{} cycles", one.id),
                None if one.is_asymmetric() => format!("{} asymmetric", one.id),
                None => one.id.to_string(),
            },
            from,
            one.trace.points.to_string(),
            format!("{low} to {high}"),
            kinds(&one.trace),
            ends,
        ]);
    }
    let mut out = aligned(&rows);
    out.push_str(&physically(case, result));
    if let Some(stability) = result.stability() {
        out.push_str(&stability.text());
    }
    if let Some(resolution) = result.resolution() {
        out.push_str(&resolution.text());
    }
    let others = result.branches.iter().filter(|one| one.is_asymmetric());
    let others = others.filter_map(|one| one.trace.stability).reduce(|all, one| all.and(&one));
    if let Some(stability) = others {
        let text = stability.text();
        let _ = write!(out, "asymmetric about the equator, one of each mirror pair: {text}");
    }
    out.push('\n');
    out.push_str(&nearly(result));
    let _ = write!(out, "{}: {}", result.case, result.stopped_because);
    if !result.stopped_detail.is_empty() {
        let _ = write!(out, " ({})", result.stopped_detail);
    }
    let _ = writeln!(
        out,
        "; {}, {}, {} points, {} Newton iterations, {:.2} s",
        count(result.branches.len(), "branch", "branches"),
        count(result.joints.len(), "joint", "joints"),
        result.points(),
        result.newton_iterations,
        result.seconds
    );
    if let Some(folder) = folder {
        let _ = writeln!(out, "written to {}", folder.display());
    }
    out
}

/// How far each branch goes, and with which forces, in the units of a case that is in physical ones.
fn physically(case: &ResolvedCase, result: &DiagramResult) -> String {
    let tables: Vec<&Table> = result.branches.iter().map(|one| &one.trace.table).collect();
    let Some(laboratory) = Laboratory::of(case, &tables) else { return String::new() };
    let names = ["z0", "deformation", "force", "energy_total"];
    let known = |name: &&str| tables.first().is_some_and(|t| !t.numbers(name).is_empty());
    let columns: Vec<(&str, &str, f64)> = names
        .iter()
        .filter(|name| known(name))
        .filter_map(|name| {
            let (unit, factor) = laboratory.convert(tables.first()?.unit(name))?;
            Some((*name, unit, factor))
        })
        .collect();
    let mut rows = vec![vec!["in physical units".to_owned()]];
    rows[0].extend(columns.iter().map(|(name, unit, _)| format!("{name} [{}]", spoken(unit))));
    for one in &result.branches {
        let mut row = vec![one.id.to_string()];
        row.extend(columns.iter().map(|(name, _, factor)| {
            let finite = one.trace.table.numbers(name).into_iter().filter(|x| x.is_finite());
            let values: Vec<f64> = finite.map(|x| factor * x).collect();
            if values.is_empty() {
                return "–".to_owned();
            }
            let (low, high) = range(&values);
            format!("{low} to {high}")
        }));
        rows.push(row);
    }
    format!("\n{}", aligned(&rows))
}

/// What nearly happens on the branches, a line each; empty where there is nothing.
fn nearly(result: &DiagramResult) -> String {
    let mut out = String::new();
    for (one, near) in result.branches.iter().flat_map(|one| one.near.iter().map(move |n| (one, n)))
    {
        let what = match near.kind {
            "folds" => "two folds that nearly meet",
            _ => "nearly a branch point, kept apart by an imperfection,",
        };
        let at = rounded(near.parameter);
        let gap = format!("{:.0e}", near.gap);
        let _ =
            writeln!(out, "branch {}: {what} at {} = {at} (gap {gap})", one.id, result.parameter);
    }
    if !out.is_empty() {
        out.push('\n');
    }
    out
}

fn range(values: &[f64]) -> (String, String) {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (rounded(low), rounded(high))
}

/// How many special points of which kinds.
fn kinds(trace: &TraceResult) -> String {
    let mut found: Vec<(&str, usize)> = Vec::new();
    for event in &trace.events {
        match found.iter_mut().find(|(kind, _)| *kind == event.kind) {
            Some((_, n)) => *n += 1,
            None => found.push((&event.kind, 1)),
        }
    }
    let words = found.iter().map(|(kind, n)| format!("{n} {kind}"));
    let words = words.collect::<Vec<_>>().join(", ");
    if words.is_empty() { "–".to_owned() } else { words }
}
