//! How a case of a sweep went, and its special points as a table.

use crate::record::phase::Phase;
use crate::record::{Cell, StabilityRecord, Table, TraceResult};
use serde::{Deserialize, Serialize};
use std::fmt;

/// How a case ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Traced as far as it was asked to be.
    Finished,
    /// A part of the branch is there.
    StoppedEarly,
    /// Nothing is there.
    Failed,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Status::Finished => "finished",
            Status::StoppedEarly => "stopped-early",
            Status::Failed => "failed",
        })
    }
}

/// How a case of a sweep went.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseRecord {
    /// Its number.
    pub case: usize,
    /// How it ended.
    pub status: Status,
    /// Why it failed or stopped early, in words.
    pub reason: Option<String>,
    /// Why its branch ended, in a word.
    pub stopped_because: Option<String>,
    /// Number of points.
    pub points: usize,
    /// Number of special points.
    pub special_points: usize,
    /// Whether all numbers of unstable modes are certain.
    pub certified: Option<bool>,
    /// Jacobian assemblies.
    pub newton_iterations: usize,
    /// Time from the resolved case to the last point and event.
    pub seconds: f64,
    /// What the shell does, for contact cases.
    pub phase: Option<Phase>,
    /// Which modes were counted; `None` where that has no meaning.
    #[serde(default)]
    pub stability: Option<StabilityRecord>,
    /// Where a mode without the symmetries of the branch first becomes unstable, if such were counted.
    #[serde(default)]
    pub first_loss: Option<LossRecord>,
}

/// A special point at which a mode without the symmetries of its branch becomes unstable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LossRecord {
    /// Waves around the axis.
    pub n: usize,
    /// `symmetric` or `antisymmetric` about the equator, or `none`.
    pub parity: String,
    /// The continued parameter.
    pub parameter: Option<f64>,
    /// Force on one plate.
    pub force: Option<f64>,
    /// How far the plates have come since the force was zero.
    pub deformation: Option<f64>,
}

impl LossRecord {
    /// The first one along a branch; what is unstable from the start on is none.
    pub fn first_of(result: &TraceResult) -> Option<LossRecord> {
        result.events.iter().find_map(|event| {
            let mode = event.mode.filter(|mode| mode.after > mode.before)?;
            Some(LossRecord {
                n: mode.n,
                parity: mode.parity.to_owned(),
                parameter: event.parameter,
                force: event.force,
                deformation: event.deformation,
            })
        })
    }
}

impl CaseRecord {
    /// The record of a case of which there is nothing but a reason.
    pub fn failed(case: usize, reason: String) -> Self {
        CaseRecord {
            case,
            status: Status::Failed,
            reason: Some(reason),
            stopped_because: None,
            points: 0,
            special_points: 0,
            certified: None,
            newton_iterations: 0,
            seconds: 0.0,
            phase: None,
            stability: None,
            first_loss: None,
        }
    }
}

/// The special points of a trace, in order along the branch, with the names of `events.json`.
pub fn events_table(result: &TraceResult) -> Table {
    let contact = result.events.iter().all(|event| event.observables.is_empty());
    let names: Vec<&str> = if contact {
        vec!["force", "deformation", "energy_total"]
    } else {
        let first = result.events.first();
        first.iter().flat_map(|event| event.observables.iter().map(|(name, _)| &**name)).collect()
    };
    // of a shell between plates of its own `shift` is the only observable
    let plates: &[&str] = match result.stability {
        Some(_) if !contact => &["force", "deformation", "energy_total"],
        _ => &[],
    };
    let scanned = result.stability.is_some_and(|stability| stability.full);
    let modes: &[&str] =
        if scanned { &["n", "parity", "modes_before", "modes_after"] } else { &[] };
    let columns: Vec<&str> = ["kind", &result.parameter]
        .into_iter()
        .chain(names.iter().copied())
        .chain([
            "unstable_before",
            "unstable_after",
            "residual",
            "error_estimate",
            "type",
            "criticality",
            "multiplicity",
            "branches",
            "curvature",
            "frequency",
            "lyapunov",
            "lyapunov_error",
        ])
        .chain(plates.iter().copied())
        .chain(modes.iter().copied())
        .collect();
    let mut table = Table::with_columns(&columns);
    for event in &result.events {
        let mut row: Vec<Cell> = vec![event.kind.as_str().into(), event.parameter.into()];
        if contact {
            row.extend([event.force, event.deformation, event.energy_total].map(Cell::from));
        } else {
            row.extend(names.iter().map(|name| {
                let own = event.observables.iter().find(|(own, _)| own == name);
                own.map(|(_, value)| *value).into()
            }));
        }
        let form = &event.form;
        row.extend([
            event.unstable_before.into(),
            event.unstable_after.into(),
            event.residual.into(),
            event.error_estimate.into(),
            form.kind.unwrap_or("").into(),
            form.criticality.unwrap_or("").into(),
            form.multiplicity.into(),
            form.branches.into(),
            form.curvature.into(),
            form.frequency.into(),
            form.lyapunov.into(),
            form.lyapunov_error.into(),
        ]);
        if !plates.is_empty() {
            row.extend([event.force, event.deformation, event.energy_total].map(Cell::from));
        }
        if let (true, Some(mode)) = (scanned, event.mode) {
            row.extend([mode.n.into(), mode.parity.into()]);
            row.extend([mode.before, mode.after].map(Cell::from));
        }
        table.push(row);
    }
    table
}
