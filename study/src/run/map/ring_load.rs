//! Maps of the ring-loaded shell: the contact angle and a moment at the ring, or a number of the case.

use super::contact::{bare, limits, refusal, share_mut};
use super::curves::{Found, curves};
use super::{Attempt, MapError, Second, Task};
use crate::case::{PathCase, ResolvedCase, RingLoadCase};
use crate::run::ring_load::{Start, in_degrees, no_start, path, start, watches};
use crate::run::{Observer, listen};
use continuation::Tracer;

const MOMENT: &str = "moment";
/// Range of the moment about zero, in units of the bending stiffness.
const USUAL_MOMENT: f64 = 0.5;
/// What can vary besides the angle.
const KEYS: [&str; 6] = [MOMENT, "bending", "pressure", "gas_exponent", "poisson", "b"];

/// Where the value of a key of the case is kept; `b` only with a law that has it.
fn value_mut<'r>(ring: &'r mut RingLoadCase, key: &str) -> Option<&'r mut f64> {
    Some(match key {
        "bending" => &mut ring.groups.bending,
        "pressure" => &mut ring.groups.pressure,
        "gas_exponent" => &mut ring.groups.gas_exponent,
        "poisson" => &mut ring.shell.poisson,
        "b" => return share_mut(&mut ring.shell),
        _ => return None,
    })
}

/// The second parameter that a key names.
pub(in crate::run) fn second(ring: &RingLoadCase, key: &str) -> Result<Second, MapError> {
    let name = bare(key);
    if name == MOMENT {
        let usual = Some(USUAL_MOMENT * ring.groups.bending);
        return Ok(Second { key: MOMENT.to_owned(), value: 0.0, usual, limits: None });
    }
    let law = ring.shell.law;
    if let Some(value) = value_mut(&mut ring.clone(), name) {
        let (usual, limits) = limits(law, name);
        return Ok(Second { key: name.to_owned(), value: *value, usual, limits });
    }
    let known = |name: &&str| *name == MOMENT || value_mut(&mut ring.clone(), name).is_some();
    let allowed = KEYS.into_iter().filter(known).collect();
    Err(refusal((key, name), "alpha", law, "the ring-load problem", allowed))
}

/// The base branch with the second parameter `at` a value, and its curves.
pub(in crate::run) fn attempt(
    task: &Task<'_>,
    ring: &RingLoadCase,
    at: f64,
    observer: &mut Observer<'_>,
) -> Result<Attempt, MapError> {
    let mut ring = ring.clone();
    if let Some(value) = value_mut(&mut ring, &task.key) {
        *value = at;
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
