//! Maps: curves of special points in the continued parameter and a second one, `KEY`.
//!
//! The base branch is traced at the case's own value of `KEY`; every fold, Hopf point and branch
//! point on it starts a curve, unless a curve that is known already passes through it. Without any
//! fold or Hopf point there, `KEY` is searched over its range, coarsely first.

pub(super) mod catalogue;
pub(super) mod contact;
mod curves;
mod cycles;
mod range;
pub(super) mod ring_load;
pub(super) mod two_plates;

use super::{Observer, RunError};
use crate::case::ResolvedCase;
use crate::case::keys::Range;
use crate::record::{MapCurve, MapPoint, MapResult};
use continuation::{Stop, StopReason};
use curves::Found;
use std::time::Instant;

/// Smallest parts into which the range of `KEY` is divided when it is searched.
const PARTS: usize = 16;

/// Why there is no map at all. Curves that stop early are a result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The base branch cannot be traced.
    #[error(transparent)]
    Run(#[from] RunError),
    /// No parameter of that name can vary.
    #[error("{key}: {problem} has no such parameter{}; allowed here: {}",
        .suggestion.as_ref().map(|s| format!(" (did you mean {s}?)")).unwrap_or_default(),
        .allowed.join(", "))]
    UnknownKey {
        /// What was asked for.
        key: String,
        /// The problem.
        problem: String,
        /// What there is.
        allowed: Vec<String>,
        /// The nearest of them.
        suggestion: Option<String>,
    },
    /// The problem has one parameter only.
    #[error("{key}: {problem} has no parameter besides {parameter}, so there is no map of it")]
    OneParameter {
        /// What was asked for.
        key: String,
        /// The problem.
        problem: String,
        /// Its only parameter.
        parameter: String,
    },
    /// The parameter of the branch itself.
    #[error("{key}: {key} is the parameter of the branch; allowed here: {}", .allowed.join(", "))]
    SameParameter {
        /// It.
        key: String,
        /// What there is besides.
        allowed: Vec<String>,
    },
    /// Zero has no tenth and no tenfold.
    #[error("{key} = {value}: give the range of the map, map.from and map.to, around it")]
    NoRange {
        /// The second parameter.
        key: String,
        /// Its value in the case.
        value: f64,
    },
    /// Bounds of which one is nothing beside the other.
    #[error(
        "{key} = {value:e}: must be zero, or of a size of at least {least:.1e}, 1e-12 of {other}"
    )]
    TooWide {
        /// The bound's key.
        key: &'static str,
        /// The key of the other one.
        other: &'static str,
        /// Its value.
        value: f64,
        /// The least that is allowed.
        least: f64,
    },
    /// A bound that the second parameter may not have.
    #[error("{bound} = {value}: {key} must be {allowed}")]
    Bound {
        /// The bound's key.
        bound: &'static str,
        /// Its value.
        value: f64,
        /// The second parameter.
        key: String,
        /// What it may be, in words.
        allowed: &'static str,
    },
    /// The case lies outside its own map.
    #[error("{key} = {value} of the case is not between map.from = {} and map.to = {}", .range.0, .range.1)]
    Outside {
        /// The second parameter.
        key: String,
        /// Its value in the case.
        value: f64,
        /// The range.
        range: (f64, f64),
    },
}

/// What is asked for, checked.
pub(super) struct Task<'a> {
    pub(super) case: &'a ResolvedCase,
    /// The second parameter, its value in the case and its range.
    key: String,
    value: f64,
    range: (f64, f64),
}

/// One base branch and the curves that begin on it.
pub(super) struct Attempt {
    parameter: String,
    stopped: Stop,
    newton_iterations: usize,
    found: Vec<Found>,
    refused: Vec<String>,
}

/// A second parameter: its plain name, its value in the case, and a size that it usually has where
/// that value is zero.
pub(super) struct Second {
    pub(super) key: String,
    pub(super) value: f64,
    pub(super) usual: Option<f64>,
    pub(super) limits: Option<Limits>,
}

/// Where a parameter ends.
pub(super) struct Limits {
    /// A map goes as far unless it is told.
    pub(super) low: f64,
    pub(super) high: f64,
    /// What it may be told.
    pub(super) allowed: Range,
}

/// The base branch with the second parameter at a value, and its curves.
pub(super) type Attempts<'a> =
    dyn Fn(&Task<'_>, f64, &mut Observer<'_>) -> Result<Attempt, MapError> + 'a;

/// Maps a case: curves from the special points of its base branch, or, if there are none, of the first
/// branch that has any in a search over the range.
pub(super) fn map(
    case: &ResolvedCase,
    second: Second,
    attempts: &Attempts<'_>,
    observer: &mut Observer<'_>,
) -> Result<MapResult, MapError> {
    let clock = Instant::now();
    let range = range::bounds(&second, case.map)?;
    let Second { key, value, .. } = second;
    let task = Task { case, key, value, range };
    let attempt = |at: f64, observer: &mut Observer<'_>| attempts(&task, at, observer);
    let mut best = attempt(value, observer)?;
    let (mut at, mut spent) = (value, best.newton_iterations);
    let interrupted = |a: &Attempt| a.stopped.reason == StopReason::Interrupted;
    if best.found.is_empty() && !interrupted(&best) {
        for other in range::search(range, PARTS) {
            // no base branch at this value is no reason to give up the others
            let Ok(next) = attempt(other, observer) else { continue };
            spent += next.newton_iterations;
            if !next.found.is_empty() || interrupted(&next) {
                (best, at) = (next, other);
                break;
            }
        }
    }
    let mut result = result(&task, best, at);
    result.newton_iterations += spent;
    result.seconds = clock.elapsed().as_secs_f64();
    Ok(result)
}

fn result(task: &Task<'_>, attempt: Attempt, at: f64) -> MapResult {
    let mut notes = attempt.refused;
    let (low, high) = task.range;
    let key = &task.key;
    if attempt.found.is_empty() && attempt.stopped.reason.is_complete() {
        notes.push(format!("no fold and no Hopf point found for {key} from {low} to {high}"));
    } else if at != task.value {
        notes.push(format!("no special point at {key} = {}; curves begin at {at}", task.value));
    }
    let ends = attempt.found.iter().flat_map(|found| [&found.began, &found.stopped]);
    let early = ends.chain([&attempt.stopped]).find(|stop| !stop.reason.is_complete());
    let stop = early.unwrap_or(&attempt.stopped).clone();
    let (mut curves, mut points): (Vec<MapCurve>, Vec<MapPoint>) = Default::default();
    let mut newton_iterations = 0;
    for found in attempt.found {
        let number = curves.iter().filter(|curve| curve.kind == found.kind).count();
        newton_iterations += found.newton_iterations;
        for point in found.points {
            match points.iter_mut().find(|known| known.is_same_as(&point, task.range)) {
                Some(known) => known.curves.push(curves.len()),
                None => points.push(MapPoint { curves: vec![curves.len()], ..point }),
            }
        }
        curves.push(MapCurve {
            csv: format!("{}-{number}.csv", found.kind),
            kind: found.kind,
            table: found.table,
            second: found.second,
            first: found.first,
            began: found.began,
            stopped: found.stopped,
        });
    }
    MapResult {
        case: task.case.name.clone(),
        parameter: attempt.parameter,
        key: task.key.clone(),
        range: task.range,
        curves,
        points,
        stopped_because: stop.reason,
        stopped_detail: stop.detail,
        notes,
        newton_iterations,
        seconds: 0.0,
    }
}
