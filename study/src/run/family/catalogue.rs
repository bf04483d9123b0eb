//! Problems of the catalogue.

use super::{Family, Wanted};
use crate::case::{CatalogueCase, ResolvedCase};
use crate::record::{DiagramResult, TraceResult};
use crate::run::diagram::{DiagramObserver, Presented, Work, curve, result};
use crate::run::map::{Attempt, MapError, Second, Task, catalogue as map};
use crate::run::stability::Stability;
use crate::run::{Observer, RunError, general};
use continuation::diagram::DiagramError;

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
        let (entry, request) = general::request(case, self)?;
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
        Ok(result(case, diagram, seconds, axes, &mut |branch| {
            let curve = curve(&branch, &shown);
            let trace = general::result(case, &branch, 0.0);
            Presented { trace, curve, stability: Stability::default() }
        }))
    }

    fn second_parameter(&self, _: &ResolvedCase, key: &str) -> Result<Second, MapError> {
        let (value, key) = map::value(self, key)?;
        Ok(Second { key, value, usual: None })
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
