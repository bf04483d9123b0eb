//! Maps of problems of the catalogue.

use super::curves::{Found, curves, may_go_on};
use super::{Attempt, MapError, Task, cycles};
use crate::case::CatalogueCase;
use crate::closest::closest;
use crate::run::{Observer, RunError, listen, settings};
use continuation::{Branch, Problem, StopReason, TraceError, Tracer};
use problems::{Entry, Request, Setup, Visitor};

/// The value of a parameter in the case, and its plain name.
pub(in crate::run) fn value(problem: &CatalogueCase, key: &str) -> Result<(f64, String), MapError> {
    let name = key.strip_prefix("parameters.").unwrap_or(key);
    let allowed: Vec<String> = problem.parameters.keys().cloned().collect();
    if let Some(value) = problem.parameters.get(name) {
        return Ok((*value, name.to_string()));
    }
    let (key, of) = (key.to_string(), problem.name.clone());
    let own = problems::find(&problem.name).map_or("", |entry| entry.parameter);
    if allowed.is_empty() {
        return Err(MapError::OneParameter { key, problem: of, parameter: own.to_string() });
    }
    if name == own {
        return Err(MapError::SameParameter { key, allowed });
    }
    let suggestion = closest(name, allowed.iter().map(String::as_str)).map(str::to_string);
    Err(MapError::UnknownKey { key, problem: of, allowed, suggestion })
}

fn request(task: &Task<'_>, problem: &CatalogueCase, entry: &Entry, at: f64) -> Request {
    let value = |constant: &problems::Constant| match constant.name {
        name if name == task.key => at,
        name => problem.parameters.get(name).copied().unwrap_or(constant.default),
    };
    Request {
        start: task.case.path.start,
        parameters: entry.parameters.iter().map(value).collect(),
        elements: problem.elements.unwrap_or(entry.request().elements),
        settings: settings(&task.case.path),
    }
}

/// Why there is no base branch.
enum Refused {
    /// The problem holds that constant fixed; what it can vary besides the path's parameter.
    Key(Vec<String>),
    Trace(TraceError),
}

impl From<TraceError> for Refused {
    fn from(error: TraceError) -> Self {
        Refused::Trace(error)
    }
}

struct Map<'t, 'o, 'm> {
    task: &'t Task<'t>,
    /// Value of the second parameter.
    at: f64,
    observer: &'o mut Observer<'m>,
}

impl Visitor for Map<'_, '_, '_> {
    type Output = Result<(Branch, Vec<Found>, Vec<String>), Refused>;

    fn visit<P: Problem>(self, problem: &P, setup: Setup) -> Self::Output {
        let known: Vec<&str> = problem.parameters().iter().map(|q| &q.name[..]).collect();
        if !known.contains(&self.task.key.as_str()) {
            let others = known.into_iter().filter(|name| *name != setup.parameter);
            return Err(Refused::Key(others.map(str::to_string).collect()));
        }
        let tracer = Tracer::new(problem, &setup.parameter, &setup.u, &setup.p, setup.settings)?;
        let base = tracer.watching(&setup.watches)?.run(&mut listen(self.observer));
        let (mut found, mut refused) = curves(problem, &base, self.task, self.observer);
        let stopped = base.stopped.reason == StopReason::Interrupted
            || found.last().is_some_and(|found| !may_go_on(found));
        if self.task.case.diagram.cycles && !stopped {
            let more = cycles::curves(problem, &base, (self.task, self.at), self.observer);
            found.extend(more.0);
            refused.extend(more.1);
        }
        Ok((base, found, refused))
    }
}

/// The base branch with the second parameter `at` a value, and its curves.
pub(in crate::run) fn attempt(
    task: &Task<'_>,
    problem: &CatalogueCase,
    at: f64,
    observer: &mut Observer<'_>,
) -> Result<Attempt, MapError> {
    let case = &task.case.name;
    let entry = problems::find(&problem.name).ok_or_else(|| RunError::NotAvailable {
        case: case.clone(),
        problem: problem.name.clone(),
    })?;
    let wrong = |error| match error {
        Refused::Key(allowed) => MapError::UnknownKey {
            key: task.key.clone(),
            problem: problem.name.clone(),
            allowed,
            suggestion: None,
        },
        Refused::Trace(detail) => MapError::Run(RunError::NoStart {
            case: case.clone(),
            start: task.case.path.start,
            detail,
            remedy: "choose another start or other parameters",
        }),
    };
    let outcome = entry.visit(&request(task, problem, entry, at), Map { task, at, observer });
    let outcome = outcome.map_err(|error| RunError::Problem { case: case.clone(), error })?;
    let (base, found, refused) = outcome.map_err(wrong)?;
    Ok(Attempt {
        parameter: base.parameter,
        stopped: base.stopped,
        newton_iterations: base.statistics.newton_iterations,
        found,
        refused,
    })
}
