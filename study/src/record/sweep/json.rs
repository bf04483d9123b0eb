//! `sweep.json`: the cases of a sweep, their values, and how they went.

use super::record::{CaseRecord, LossRecord, Status};
use crate::record::events::StabilityOf;
use crate::sweep::{Plan, Setting};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

/// Everything that a sweep, or the union of its shards, hands over.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepResult {
    /// What varies.
    pub plan: Plan,
    /// The cases that are finished, in order.
    pub records: Vec<CaseRecord>,
    /// Number of cases that were to be computed.
    pub asked: usize,
    /// Whether somebody wanted it to end.
    pub interrupted: bool,
}

impl SweepResult {
    /// The result of a plan of which the cases of `records` are finished.
    pub fn new(plan: &Plan, asked: usize, records: Vec<CaseRecord>, interrupted: bool) -> Self {
        SweepResult { plan: plan.clone(), records, asked, interrupted }
    }

    /// Number of cases that ended in some way.
    pub fn number(&self, status: Status) -> usize {
        self.records.iter().filter(|record| record.status == status).count()
    }

    /// Number of cases of which nothing is known yet.
    pub fn waiting(&self) -> usize {
        self.asked.saturating_sub(self.records.len())
    }

    /// Whether every case was traced as far as it was asked to be.
    pub fn is_complete(&self) -> bool {
        self.number(Status::Finished) == self.asked
    }

    /// Why it ended, in a word.
    pub fn stopped_because(&self) -> &'static str {
        match (self.interrupted, self.is_complete()) {
            (true, _) => "interrupted",
            (false, true) => "complete",
            (false, false) => "incomplete",
        }
    }
}

/// The JSON, indented, with a newline at the end.
///
/// # Errors
/// What the writer reports; memory does not fail, so none is expected.
pub fn sweep_json(result: &SweepResult) -> Result<String, serde_json::Error> {
    let plan = &result.plan;
    let document = Document {
        sweep: &plan.name,
        parameter: &plan.parameter,
        shard: (!plan.shard.is_all()).then(|| plan.shard.to_string()),
        vary: plan
            .axes
            .iter()
            .map(|axis| Vary { key: &axis.key, zip: axis.zip.as_deref(), values: &axis.values })
            .collect(),
        cases: result
            .records
            .iter()
            .map(|record| Case {
                case: record.case,
                values: Values(plan, record.case),
                status: record.status,
                reason: record.reason.as_deref(),
                stopped_because: record.stopped_because.as_deref(),
                points: record.points,
                special_points: record.special_points,
                class: record.phase.map(|phase| phase.class.to_string()),
                stability: record.stability.as_ref().map(StabilityOf),
                first_loss: match record.stability {
                    Some(stability) if stability.full => {
                        Some(record.first_loss.as_ref().map(|loss| LossOf(&plan.parameter, loss)))
                    }
                    _ => None,
                },
                certified: record.certified,
                newton_iterations: record.newton_iterations,
                seconds: record.seconds,
            })
            .collect(),
        asked: result.asked,
        finished: result.number(Status::Finished),
        stopped_early: result.number(Status::StoppedEarly),
        failed: result.number(Status::Failed),
        waiting: result.waiting(),
        stopped_because: result.stopped_because(),
        newton_iterations: result.records.iter().map(|record| record.newton_iterations).sum(),
        seconds: result.records.iter().map(|record| record.seconds).sum(),
    };
    let mut text = serde_json::to_string_pretty(&document)?;
    text.push('\n');
    Ok(text)
}

#[derive(Serialize)]
struct Document<'a> {
    sweep: &'a str,
    parameter: &'a str,
    shard: Option<String>,
    vary: Vec<Vary<'a>>,
    cases: Vec<Case<'a>>,
    asked: usize,
    finished: usize,
    stopped_early: usize,
    failed: usize,
    waiting: usize,
    stopped_because: &'a str,
    newton_iterations: usize,
    seconds: f64,
}

#[derive(Serialize)]
struct Vary<'a> {
    key: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    zip: Option<&'a str>,
    values: &'a [Setting],
}

#[derive(Serialize)]
struct Case<'a> {
    case: usize,
    values: Values<'a>,
    status: Status,
    reason: Option<&'a str>,
    stopped_because: Option<&'a str>,
    points: usize,
    special_points: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    class: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stability: Option<StabilityOf<'a>>,
    /// Null where every mode was counted and none is lost.
    #[serde(skip_serializing_if = "Option::is_none")]
    first_loss: Option<Option<LossOf<'a>>>,
    certified: Option<bool>,
    newton_iterations: usize,
    seconds: f64,
}

/// A loss of symmetry with the name of its parameter.
struct LossOf<'a>(&'a str, &'a LossRecord);

impl Serialize for LossOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let LossOf(parameter, loss) = self;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry(parameter, &loss.parameter)?;
        map.serialize_entry("force", &loss.force)?;
        map.serialize_entry("deformation", &loss.deformation)?;
        map.serialize_entry("n", &loss.n)?;
        map.serialize_entry("parity", &loss.parity)?;
        map.end()
    }
}

/// The values of a case by their keys.
struct Values<'a>(&'a Plan, usize);

impl Serialize for Values<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Values(plan, case) = self;
        let mut map = serializer.serialize_map(Some(plan.axes.len()))?;
        for (axis, setting) in plan.axes.iter().zip(plan.settings(*case)) {
            map.serialize_entry(&axis.key, setting)?;
        }
        map.end()
    }
}
