//! The shell under a ring load. Its angle is in radians in the solver, in degrees outside.

use super::{Family, Wanted};
use crate::case::{ResolvedCase, RingLoadCase};
use crate::record::{DiagramResult, Outline, TraceResult};
use crate::run::diagram::{DiagramObserver, DiagramProgress, Presented, Work, result};
use crate::run::map::{Attempt, MapError, Second, Task, ring_load as map};
use crate::run::stability::Stability;
use crate::run::{Observer, Progress, RunError, ring_load, states};
use continuation::Settings;
use continuation::diagram::DiagramError;
use problems::Setup;

impl Family for RingLoadCase {
    fn name(&self) -> &str {
        "ring-load"
    }

    fn trace(
        &self,
        case: &ResolvedCase,
        wanted: Wanted,
        observer: &mut Observer<'_>,
    ) -> Result<TraceResult, RunError> {
        ring_load::run(case, self, wanted == Wanted::States, observer)
    }

    fn diagram(
        &self,
        case: &ResolvedCase,
        work: Work<'_>,
        observer: &mut DiagramObserver<'_>,
    ) -> Result<DiagramResult, RunError> {
        let reported = work.reported;
        let ring_load::Start { problem, u, p } = ring_load::start(case, self)?;
        let setup = Setup {
            parameter: "alpha".into(),
            u,
            p,
            settings: Settings::default(),
            watches: ring_load::watches(),
        };
        let mut in_degrees = |at: DiagramProgress| {
            let parameter = at.branch.parameter.to_degrees();
            observer(DiagramProgress { branch: Progress { parameter, ..at.branch }, ..at })
        };
        let mut exploration = work.explore(case, ring_load::path(&case.path), &mut in_degrees);
        let domain = &mut exploration.settings.trace.domain;
        *domain = domain.map(|(low, high)| (low.to_radians(), high.to_radians()));
        let explored = exploration.run(&problem, &setup);
        let (diagram, seconds) = explored.map_err(|error| match error {
            DiagramError::Trace(detail) => ring_load::no_start(case, detail),
            error => RunError::Diagram { case: case.name.clone(), error },
        })?;
        let diagram = ring_load::diagram_in_degrees(diagram);
        let points = diagram.branches.iter().map(|one| one.branch.points.len()).sum();
        Ok(result(case, diagram, seconds, ring_load::AXES, &mut |branch| {
            let curve = ring_load::curve(&branch);
            let mut result = ring_load::result(case, &branch, 0.0);
            result.resolution = ring_load::resolved(self, &problem, &branch).record();
            if reported {
                result.pictures.states = states::of_ring_load(&problem, &branch, points);
            }
            Presented { trace: result, curve, stability: Stability::default() }
        }))
    }

    fn second_parameter(&self, _: &ResolvedCase, key: &str) -> Result<Second, MapError> {
        map::second(self, key)
    }

    fn attempt(
        &self,
        task: &Task<'_>,
        at: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Attempt, MapError> {
        map::attempt(task, self, at, observer)
    }

    fn meridian(
        &self,
        case: &ResolvedCase,
        u: &[f64],
        parameter: f64,
    ) -> Result<Option<Outline>, RunError> {
        let ring_load::Start { problem, .. } = ring_load::start(case, self)?;
        Ok(states::meridian_in_ring(&problem, u, parameter))
    }
}
