//! Maps of the ring-loaded shell: the contact angle and a moment at the ring, or a group.

use super::curves::{Found, curves};
use super::{Attempt, MapError, Task};
use crate::case::{PathCase, ResolvedCase, RingLoadCase};
use crate::closest::closest;
use crate::run::ring_load::{Start, in_degrees, no_start, path, start, watches};
use crate::run::{Observer, listen};
use continuation::Tracer;

pub(in crate::run) const MOMENT: &str = "moment";
/// Range of the moment about zero, in units of the bending stiffness.
pub(in crate::run) const USUAL_MOMENT: f64 = 0.5;
/// What can vary besides the angle.
const KEYS: [&str; 3] = [MOMENT, "bending", "pressure"];

/// The value of a parameter in the case, and its plain name.
pub(in crate::run) fn value(ring: &RingLoadCase, key: &str) -> Result<(f64, String), MapError> {
    let name = key.strip_prefix("dimensionless.").unwrap_or(key);
    let value = match name {
        MOMENT => 0.0,
        "bending" => ring.bending,
        "pressure" => ring.pressure,
        _ => {
            let (key, allowed) = (key.to_string(), KEYS.map(str::to_string).to_vec());
            if name == "alpha" {
                return Err(MapError::SameParameter { key, allowed });
            }
            let suggestion = closest(name, KEYS).map(str::to_string);
            let problem = "the ring-load problem".to_string();
            return Err(MapError::UnknownKey { key, problem, allowed, suggestion });
        }
    };
    Ok((value, name.to_string()))
}

/// The base branch with the second parameter `at` a value, and its curves.
pub(in crate::run) fn attempt(
    task: &Task<'_>,
    ring: &RingLoadCase,
    at: f64,
    observer: &mut Observer<'_>,
) -> Result<Attempt, MapError> {
    let mut ring = ring.clone();
    match task.key.as_str() {
        "bending" => ring.bending = at,
        "pressure" => ring.pressure = at,
        _ => {}
    }
    let Start { problem, u, mut p } = start(task.case, &ring)?;
    if task.key == MOMENT {
        p[shell_contact::ring_load::parameter::MOMENT.0] = at;
    }
    let mut observer = in_degrees(observer);
    let base = Tracer::new(&problem, "alpha", &u, &p, path(&task.case.path))
        .and_then(|tracer| tracer.watching(&watches()))
        .map(|tracer| tracer.run(&mut listen(&mut observer)))
        .map_err(|detail| no_start(task.case, detail))?;
    // the path's bounds in the problem's unit
    let PathCase { start: from, end, .. } = task.case.path;
    let radians = PathCase { start: from.to_radians(), end: end.to_radians(), ..task.case.path };
    let case = ResolvedCase { path: radians, ..task.case.clone() };
    let task = Task { case: &case, key: task.key.clone(), ..*task };
    let (mut found, refused) = curves(&problem, &base, &task, &mut observer);
    found.iter_mut().for_each(to_degrees);
    Ok(Attempt {
        parameter: base.parameter,
        stopped: base.stopped,
        newton_iterations: base.statistics.newton_iterations,
        found,
        refused,
    })
}

/// Turns a curve's angles into degrees.
fn to_degrees(found: &mut Found) {
    found.first.iter_mut().for_each(|x| *x = x.to_degrees());
    found.points.iter_mut().for_each(|point| point.first = point.first.to_degrees());
    found.table.convert("alpha", f64::to_degrees);
}
