//! `map.json`: curves of special points in two parameters and the special points on them; and the
//! same for people.

use super::number::rounded;
use super::physical::{BENDING, Laboratory, in_unit, spoken};
use super::result::Table;
use super::summary::{aligned, count};
use crate::case::ResolvedCase;
use continuation::{Stop, StopReason};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::fmt::Write as _;
use std::path::Path;

/// How near, relative to the range of the map, two special points of a kind are one.
const SAME: f64 = 1e-6;

/// Everything a map hands over.
#[derive(Debug, Clone, PartialEq)]
pub struct MapResult {
    /// Name of the case.
    pub case: String,
    /// Name of the first parameter.
    pub parameter: String,
    /// Name of the second one.
    pub key: String,
    /// Range of the second one.
    pub range: (f64, f64),
    /// The curves.
    pub curves: Vec<MapCurve>,
    /// The special points on them, each once.
    pub points: Vec<MapPoint>,
    /// Why the work ended: the first reason that is no completion, of the base branch or a curve.
    pub stopped_because: StopReason,
    /// The same in a sentence; may be empty.
    pub stopped_detail: String,
    /// What deserves to be said though it is not wrong.
    pub notes: Vec<String>,
    /// Jacobian assemblies.
    pub newton_iterations: usize,
    /// From the resolved case to the last point.
    pub seconds: f64,
}

/// A curve of special points.
#[derive(Debug, Clone, PartialEq)]
pub struct MapCurve {
    /// Kind of the special points: `fold`, `hopf`, `branch-point`.
    pub kind: String,
    /// Name of its file.
    pub csv: String,
    /// Its points.
    pub table: Table,
    /// Values of the second parameter.
    pub second: Vec<f64>,
    /// Values of the first one.
    pub first: Vec<f64>,
    /// Why it ends at its first point.
    pub began: Stop,
    /// Why it ends at its last point.
    pub stopped: Stop,
}

/// A special point on a curve.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MapPoint {
    /// Its kind: `cusp`, `bogdanov-takens`, …
    pub kind: String,
    /// The curves on which it was found.
    pub curves: Vec<usize>,
    /// First parameter.
    pub first: f64,
    /// Second parameter.
    pub second: f64,
    /// Observables by name; `force` of a contact case is one of them.
    pub observables: Vec<(String, f64)>,
    /// Unstable modes beside the critical ones, before.
    pub unstable_before: Option<usize>,
    /// And after.
    pub unstable_after: Option<usize>,
    /// Largest component of the residual.
    pub residual: f64,
    /// Estimated error of the location, where it is known: of a cusp of cycles it is not.
    pub error_estimate: Option<f64>,
}

impl MapPoint {
    /// Whether another point is the same one, met along another curve.
    pub fn is_same_as(&self, other: &MapPoint, (low, high): (f64, f64)) -> bool {
        let near = |a: f64, b: f64, size: f64| (a - b).abs() <= SAME * size;
        self.kind == other.kind
            && near(self.second, other.second, high - low)
            && near(self.first, other.first, self.first.abs().max(other.first.abs()))
    }

    fn force(&self) -> Option<f64> {
        self.observables.iter().find(|(name, _)| name == "force").map(|(_, value)| *value)
    }
}

/// The JSON, indented, with a newline at the end. Special points of a case in physical units have their numbers
/// in those too.
///
/// # Errors
/// What the writer reports; memory does not fail, so none is expected.
pub fn map_json(case: &ResolvedCase, result: &MapResult) -> Result<String, serde_json::Error> {
    let mut text = serde_json::to_string_pretty(&Document(result, laboratory(case, result)))?;
    text.push('\n');
    Ok(text)
}

struct Document<'a>(&'a MapResult, Option<(Laboratory, &'a Table)>);

impl Serialize for Document<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Document(result, laboratory) = self;
        let laboratory = laboratory.as_ref().map(|(laboratory, table)| (laboratory, *table));
        let curves: Vec<CurveOf<'_>> = result.curves.iter().map(CurveOf).collect();
        let points: Vec<PointOf<'_>> =
            result.points.iter().map(|point| PointOf { point, result, laboratory }).collect();
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("case", &result.case)?;
        map.serialize_entry("parameter", &result.parameter)?;
        map.serialize_entry("over", &result.key)?;
        map.serialize_entry("from", &result.range.0)?;
        map.serialize_entry("to", &result.range.1)?;
        map.serialize_entry("curves", &curves)?;
        map.serialize_entry("points", &points)?;
        map.serialize_entry("stopped_because", &result.stopped_because.to_string())?;
        map.serialize_entry("stopped_detail", &result.stopped_detail)?;
        map.serialize_entry("notes", &result.notes)?;
        map.serialize_entry("newton_iterations", &result.newton_iterations)?;
        map.serialize_entry("seconds", &result.seconds)?;
        map.end()
    }
}

struct CurveOf<'a>(&'a MapCurve);

impl Serialize for CurveOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let curve = self.0;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("kind", &curve.kind)?;
        map.serialize_entry("csv", &curve.csv)?;
        map.serialize_entry("points", &curve.table.rows().len())?;
        map.serialize_entry("began_because", &curve.began.reason.to_string())?;
        map.serialize_entry("began_detail", &curve.began.detail)?;
        map.serialize_entry("stopped_because", &curve.stopped.reason.to_string())?;
        map.serialize_entry("stopped_detail", &curve.stopped.detail)?;
        map.end()
    }
}

struct PointOf<'a> {
    point: &'a MapPoint,
    result: &'a MapResult,
    laboratory: Option<(&'a Laboratory, &'a Table)>,
}

impl Serialize for PointOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let PointOf { point, result, laboratory } = self;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("kind", &point.kind)?;
        map.serialize_entry(&result.parameter, &point.first)?;
        map.serialize_entry(&result.key, &point.second)?;
        if let Some(force) = point.force() {
            map.serialize_entry("force", &force)?;
        }
        map.serialize_entry("unstable_before", &point.unstable_before)?;
        map.serialize_entry("unstable_after", &point.unstable_after)?;
        map.serialize_entry("residual", &point.residual)?;
        map.serialize_entry("error_estimate", &point.error_estimate)?;
        map.serialize_entry("curves", &point.curves)?;
        let observables: serde_json::Map<String, serde_json::Value> =
            point.observables.iter().map(|(name, value)| (name.clone(), (*value).into())).collect();
        if !observables.is_empty() {
            map.serialize_entry("observables", &observables)?;
        }
        if let Some((laboratory, table)) = laboratory {
            let known = numbers(point, result, laboratory).into_iter();
            let physical: serde_json::Map<String, serde_json::Value> = known
                .filter_map(|(name, value)| {
                    let (unit, factor) = laboratory.convert(table.unit(name))?;
                    Some((in_unit(name, unit), (factor * value?).into()))
                })
                .collect();
            map.serialize_entry("physical", &physical)?;
        }
        map.end()
    }
}

/// The summary; `folder` is where the files went, if they went anywhere.
pub fn map_summary(case: &ResolvedCase, result: &MapResult, folder: Option<&Path>) -> String {
    let mut out = String::new();
    for note in &result.notes {
        let _ = writeln!(out, "note: {note}");
    }
    let mut rows = vec![
        ["curve", "points", result.parameter.as_str(), result.key.as_str(), "ends"]
            .map(str::to_string)
            .to_vec(),
    ];
    for curve in &result.curves {
        let span = |values: &[f64]| {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            format!("{} … {}", rounded(low), rounded(high))
        };
        rows.push(vec![
            curve.kind.clone(),
            curve.table.rows().len().to_string(),
            span(&curve.first),
            span(&curve.second),
            format!("{}, {}", curve.began.reason, curve.stopped.reason),
        ]);
    }
    if !result.curves.is_empty() {
        out.push_str(&aligned(&rows));
        out.push('\n');
    }
    if result.points.is_empty() {
        out.push_str("no special points of two parameters\n");
    } else {
        let mut rows = vec![
            ["special point", &result.parameter, &result.key, "error"].map(str::to_string).to_vec(),
        ];
        rows.extend(result.points.iter().map(|point| {
            let error = point.error_estimate;
            let error = error.map_or_else(|| "–".to_string(), |error| format!("{error:.0e}"));
            vec![point.kind.clone(), rounded(point.first), rounded(point.second), error]
        }));
        out.push_str(&aligned(&rows));
        out.push_str(&physically(case, result));
    }
    out.push('\n');
    let _ = write!(out, "{}: stopped at {}", result.case, result.stopped_because);
    if !result.stopped_detail.is_empty() {
        let _ = write!(out, " ({})", result.stopped_detail);
    }
    let points: usize = result.curves.iter().map(|curve| curve.table.rows().len()).sum();
    let (newton, seconds) = (result.newton_iterations, result.seconds);
    let _ = writeln!(
        out,
        "; {}, {points} points, {newton} Newton iterations, {seconds:.2} s",
        count(result.curves.len(), "curve", "curves")
    );
    if let Some(folder) = folder {
        let _ = writeln!(out, "written to {}", folder.display());
    }
    out
}

/// The units of a case that is in physical ones, and a curve whose columns say what has which.
fn laboratory<'r>(case: &ResolvedCase, result: &'r MapResult) -> Option<(Laboratory, &'r Table)> {
    let tables: Vec<&Table> = result.curves.iter().map(|curve| &curve.table).collect();
    Some((Laboratory::of(case, &tables)?, *tables.first()?))
}

/// Both parameters and the force of a special point, in the case's units, with their names.
fn numbers<'r>(
    point: &MapPoint,
    result: &'r MapResult,
    laboratory: &Laboratory,
) -> [(&'r str, Option<f64>); 3] {
    let unit = match &result.key[..] {
        BENDING => laboratory.scales.force_unit_with(point.second),
        _ => 1.0,
    };
    [
        (&result.parameter, Some(point.first)),
        (&result.key, Some(point.second)),
        ("force", point.force().map(|force| unit * force)),
    ]
}

/// The special points in physical units.
fn physically(case: &ResolvedCase, result: &MapResult) -> String {
    let Some((laboratory, table)) = laboratory(case, result) else { return String::new() };
    let unit = |name: &str| laboratory.convert(table.unit(name));
    let mut rows = vec![vec!["in physical units".to_owned()]];
    for point in &result.points {
        let known = numbers(point, result, &laboratory);
        let known: Vec<_> = known
            .into_iter()
            .filter_map(|(name, value)| Some((name, unit(name)?, value?)))
            .collect();
        if rows.len() == 1 {
            let titles =
                known.iter().map(|(name, (unit, _), _)| format!("{name} [{}]", spoken(unit)));
            rows[0].extend(titles);
        }
        let mut row = vec![point.kind.clone()];
        row.extend(known.iter().map(|(_, (_, factor), value)| rounded(factor * value)));
        row.resize(rows[0].len(), "–".to_owned());
        rows.push(row);
    }
    format!("\n{}", aligned(&rows))
}
