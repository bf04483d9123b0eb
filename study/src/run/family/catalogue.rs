//! Problems of the catalogue.

use super::{Family, Wanted};
use crate::case::{CatalogueCase, DiagramCase, ResolvedCase};
use crate::record::{DiagramResult, TraceResult};
use crate::run::diagram::{DiagramObserver, KeepNothing, Presented, Saved, Work, curve, result};
use crate::run::map::{Attempt, MapError, Second, Task, catalogue as map};
use crate::run::stability::Stability;
use crate::run::{Observer, RunError, general, orbits};
use continuation::diagram::{DiagramError, DiagramStop};

impl Family for CatalogueCase {
    fn name(&self) -> &str {
        &self.name
    }

    fn trace(
        &self,
        case: &ResolvedCase,
        _: Wanted,
        observer: &mut Observer<'_>,
    ) -> Result<TraceResult, RunError> {
        general::run(case, self, observer)
    }

    fn diagram(
        &self,
        case: &ResolvedCase,
        work: Work<'_>,
        observer: &mut DiagramObserver<'_>,
    ) -> Result<DiagramResult, RunError> {
        explore(self, case, None, work, observer)
    }

    fn orbits(
        &self,
        case: &ResolvedCase,
        hopf: Option<usize>,
        observer: &mut DiagramObserver<'_>,
    ) -> Result<DiagramResult, RunError> {
        let with = DiagramCase { search: false, cycles: true, ..case.diagram };
        let case = ResolvedCase { diagram: with, ..case.clone() };
        let mut nothing = KeepNothing;
        let work = Work::new(Saved::default(), &mut nothing, false);
        explore(self, &case, hopf, work, observer)
    }

    fn second_parameter(&self, _: &ResolvedCase, key: &str) -> Result<Second, MapError> {
        let (value, key) = map::value(self, key)?;
        Ok(Second { key, value, usual: None, limits: None })
    }

    fn attempt(
        &self,
        task: &Task<'_>,
        at: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Attempt, MapError> {
        map::attempt(task, self, at, observer)
    }
}

/// Explores the diagram, with its cycles if the case asks for them: of one Hopf point, or of all.
fn explore(
    problem: &CatalogueCase,
    case: &ResolvedCase,
    hopf: Option<usize>,
    work: Work<'_>,
    observer: &mut DiagramObserver<'_>,
) -> Result<DiagramResult, RunError> {
    let (entry, request) = general::request(case, problem)?;
    let explored = entry
        .visit(&request, work.explore(case, request.settings.clone(), observer))
        .map_err(|error| general::refused(case, error))?;
    let (diagram, seconds) = explored.map_err(|error| match error {
        DiagramError::Trace(detail) => general::no_start(case, detail),
        error => RunError::Diagram { case: case.name.clone(), error },
    })?;
    let shown = diagram.branches.first().and_then(|one| one.branch.observables.first());
    let shown = shown.cloned().unwrap_or_default();
    let axes = (entry.parameter, &shown[..]);
    let found = orbits::hopf_points(&diagram);
    if let Some(wanted) = hopf.filter(|wanted| *wanted >= found) {
        return Err(RunError::NoHopfPoint { case: case.name.clone(), wanted, found });
    }
    let stopped = diagram.stopped == DiagramStop::Interrupted;
    let followed = if case.diagram.cycles && found > 0 && !stopped {
        let work = orbits::FollowCycles { case, diagram: &diagram, only: hopf, observer };
        let followed =
            entry.visit(&request, work).map_err(|error| general::refused(case, error))?;
        Some(followed.map_err(|error| orbits::refused(case, error))?)
    } else {
        None
    };
    let mut result = result(case, diagram, seconds, axes, &mut |branch| {
        let curve = curve(&branch, &shown);
        let trace = general::result(case, &branch, 0.0);
        Presented { trace, curve, stability: Stability::default() }
    });
    match followed {
        Some(followed) => orbits::add(case, &mut result, followed, &shown),
        None => orbits::leave_out(&mut result, found),
    }
    Ok(result)
}
