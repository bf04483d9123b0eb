//! Files of sweeps.

use super::Results;
use crate::{PHASE, draw_phase};
use std::io;
use study::case::PictureCase;
use study::record::{SweepResult, sweep_json};
use study::store::{Folder, Kept, phase_csv, write_curves, write_events};
use study::sweep::Plan;

const JSON: &str = "sweep.json";
const CURVES: &str = "curves.csv";
const EVENTS: &str = "events.csv";
const CLASSES: &str = "phase.csv";

/// Names of the files that a sweep may leave, with a `*` for a number, and of the cases that it keeps.
pub const SWEEP_NAMES: [&str; 7] =
    [JSON, CURVES, EVENTS, CLASSES, PHASE, "cases/plan.json", "cases/case-*.cbor"];

/// What a sweep leaves: the JSON alone without a folder. Its long tables are written at once; pictures need a
/// look.
pub fn sweep(
    plan: &Plan,
    kept: &[Kept],
    result: &SweepResult,
    folder: Option<&Folder>,
    look: Option<&PictureCase>,
) -> Results {
    let mut made = Results::new(JSON, sweep_json(result));
    let Some(folder) = folder else { return made };
    let other = |error| io::Error::other(error);
    let curves = folder.stream(CURVES, |out| write_curves(plan, kept, out).map_err(other));
    made.done(CURVES, curves);
    let events = folder.stream(EVENTS, |out| write_events(plan, kept, out).map_err(other));
    made.done(EVENTS, events);
    let phases = kept.iter().any(|case| case.record.phase.is_some());
    if phases && plan.plane().is_some() {
        made.attempt(CLASSES, phase_csv(plan, kept));
        if let Some(look) = look {
            made.attempt(PHASE, draw_phase(result, look));
        }
    }
    made
}
