//! The table of special points that people see at the end of a trace.

use super::number::rounded;
use super::physical::{Laboratory, spoken};
use super::result::TraceResult;
use crate::case::ResolvedCase;
use std::fmt::Write as _;
use std::path::Path;

/// The summary; `folder` is where the files went, if they went anywhere. A case in physical units has its
/// special points once more in those.
pub fn summary(case: &ResolvedCase, result: &TraceResult, folder: Option<&Path>) -> String {
    let mut out = String::new();
    if result.events.is_empty() {
        out.push_str("no special points\n");
    } else {
        out.push_str(&aligned(&event_rows(result)));
        if let Some(rows) = physical_rows(case, result) {
            out.push('\n');
            out.push_str(&aligned(&rows));
        }
    }
    if let Some(stability) = &result.stability {
        out.push_str(&stability.text());
    }
    if let Some(resolution) = &result.resolution {
        out.push_str(&resolution.text());
    }
    out.push('\n');
    let _ = write!(out, "{}: stopped at {}", result.case, result.stopped_because);
    if !result.stopped_detail.is_empty() {
        let _ = write!(out, " ({})", result.stopped_detail);
    }
    let _ = writeln!(
        out,
        "; {} points, {} Newton iterations, {:.2} s",
        result.points, result.newton_iterations, result.seconds
    );
    if let Some(folder) = folder {
        let _ = writeln!(out, "written to {}", folder.display());
    }
    out
}

/// One row per special point under a row of titles; columns without a single value are left out.
fn event_rows(result: &TraceResult) -> Vec<Vec<String>> {
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_string(), rounded);
    let modes = |value: Option<usize>| value.map_or_else(|| "–".to_string(), |n| n.to_string());
    let mut titles: Vec<String> =
        ["special point", result.parameter.as_str(), "deformation", "force", "energy_total"]
            .map(str::to_string)
            .to_vec();
    let observables: Vec<&String> = result
        .events
        .iter()
        .max_by_key(|event| event.observables.len())
        .map(|event| event.observables.iter().map(|(name, _)| name).collect())
        .unwrap_or_default();
    titles.extend(observables.iter().map(ToString::to_string));
    titles.push("unstable".to_string());
    let mut rows = vec![titles];
    for event in &result.events {
        let mut row = vec![
            event.kind.clone(),
            number(event.parameter),
            number(event.deformation),
            number(event.force),
            number(event.energy_total),
        ];
        row.extend(observables.iter().map(|name| {
            let found = event.observables.iter().find(|(own, _)| own == *name);
            number(found.map(|(_, value)| *value))
        }));
        row.push(match (event.unstable_before, event.unstable_after) {
            _ if event.mode.is_some() => event.mode.map_or_else(String::new, |mode| {
                let (n, parity) = (mode.n, mode.parity);
                format!("n = {n} {parity}: {} → {}", mode.before, mode.after)
            }),
            (None, None) => "–".to_string(),
            (before, after) if before == after => modes(before),
            (before, after) => format!("{} → {}", modes(before), modes(after)),
        });
        rows.push(row);
    }
    let columns = rows[0].len();
    let used: Vec<bool> =
        (0..columns).map(|j| j < 2 || rows[1..].iter().any(|row| row[j] != "–")).collect();
    rows.iter()
        .map(|row| row.iter().zip(&used).filter(|(_, u)| **u).map(|(c, _)| c.clone()).collect())
        .collect()
}

/// The special points in physical units; without those at which only asymmetric modes change, which are many.
fn physical_rows(case: &ResolvedCase, result: &TraceResult) -> Option<Vec<Vec<String>>> {
    let laboratory = Laboratory::of(case, &[&result.table])?;
    let table = &result.table;
    let parameter = result.parameter.as_str();
    let mut names = vec![parameter, "z0", "deformation", "force", "energy_total"];
    names.dedup();
    let columns: Vec<(&str, &'static str, f64)> = names
        .into_iter()
        .enumerate()
        .filter(|(at, name)| *at == 0 || *name != parameter)
        .filter_map(|(_, name)| {
            let (unit, factor) = laboratory.convert(table.unit(name))?;
            Some((name, unit, factor))
        })
        .collect();
    let mut titles = vec!["in physical units".to_owned()];
    titles.extend(columns.iter().map(|(name, unit, _)| format!("{name} [{}]", spoken(unit))));
    let mut rows = vec![titles];
    for event in result.events.iter().filter(|event| event.mode.is_none()) {
        let mut row = vec![event.kind.clone()];
        row.extend(columns.iter().map(|(name, _, factor)| {
            let value = match *name {
                own if own == parameter => event.parameter,
                "z0" => event.z0,
                "deformation" => event.deformation,
                "force" => event.force,
                _ => event.energy_total,
            };
            value.map_or_else(|| "–".to_owned(), |value| rounded(factor * value))
        }));
        rows.push(row);
    }
    (rows.len() > 1).then_some(rows)
}

/// A number and its noun.
pub(crate) fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// Columns of equal width: words to the left, numbers to the right.
pub(crate) fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |j: usize| rows.iter().map(|row| row[j].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut out = String::new();
    for row in rows {
        let mut line = String::new();
        for (j, (cell, width)) in row.iter().zip(&widths).enumerate() {
            let _ = match j {
                0 => write!(line, "{cell:<width$}"),
                _ => write!(line, "  {cell:>width$}"),
            };
        }
        out.push_str(line.trim_end());
        out.push('\n');
    }
    out
}
