//! The shell between two plates, as a mirror image of itself.

use super::{Family, Wanted};
use crate::case::{ContactCase, ResolvedCase, StabilityCase};
use crate::record::{CycleResult, DiagramResult, Outline, Symmetry, TraceResult};
use crate::run::diagram::{
    DiagramObserver, DiagramProgress, NOT_EXAMINED, Presented, Work, result, with_asymmetric,
};
use crate::run::map::{Attempt, MapError, Second, Task, contact as map};
use crate::run::stability::Stability;
use crate::run::{Observer, RunError, asymmetric, contact, cycle, states};
use continuation::diagram::DiagramError;
use continuation::{Problem, Settings};
use problems::Setup;
use shell_contact::{ContactBranch, force_watches};
use std::time::Instant;

impl Family for ContactCase {
    fn name(&self) -> &str {
        "contact"
    }

    fn trace(
        &self,
        case: &ResolvedCase,
        wanted: Wanted,
        observer: &mut Observer<'_>,
    ) -> Result<TraceResult, RunError> {
        match wanted {
            Wanted::Nothing => contact::run_plain(case, self, observer),
            Wanted::Pictures => contact::run(case, self, observer),
            Wanted::States => contact::run_reported(case, self, observer),
        }
    }

    fn diagram(
        &self,
        case: &ResolvedCase,
        work: Work<'_>,
        observer: &mut DiagramObserver<'_>,
    ) -> Result<DiagramResult, RunError> {
        let reported = work.reported;
        let problem = contact::problem(case, self)?;
        let start = case.path.start;
        let setup = Setup {
            parameter: "z0".into(),
            u: problem.initial_state(),
            p: problem.parameters_at(start).to_vec(),
            settings: Settings::default(),
            watches: force_watches().to_vec(),
        };
        let explored =
            work.explore(case, contact::path(case), &mut *observer).run(&problem, &setup);
        let (diagram, seconds) = explored.map_err(|error| match error {
            DiagramError::Trace(detail) => contact::no_start(case, detail),
            error => RunError::Diagram { case: case.name.clone(), error },
        })?;
        let scanning = Instant::now();
        let mut zero = None;
        let points = diagram.branches.iter().map(|one| one.branch.points.len()).sum();
        let mut waiting = diagram.branches.len();
        let done = diagram.branches.len();
        let depths: Vec<usize> = diagram.branches.iter().map(|one| one.depth).collect();
        let mut symmetric = asymmetric::Symmetric::default();
        let mut waves = 0;
        let axes = ("plate distance z₀/R₀", "force F/√(χ k_b)");
        let mut explored = result(case, diagram, seconds, axes, &mut |branch| {
            let mut traced = ContactBranch::new(branch, zero);
            zero = traced.zero_force;
            waiting -= 1;
            let scan = &mut |branch| {
                observer(DiagramProgress { branches: done - waiting, waiting, branch })
            };
            let stability = Stability::of(case, &problem, &mut traced, scan);
            let id = done - 1 - waiting;
            let forks = stability.forks(&traced.branch);
            symmetric.add(id, depths[id], &traced.branch, &forks);
            waves += stability.waves();
            let (mut trace, curve) = contact::on_diagram(case, &problem, &traced, &stability);
            if reported {
                trace.pictures.states = states::of_contact(&problem, &traced.branch, points);
            }
            Presented { trace, curve, stability }
        });
        if !explored.branches.is_empty() && explored.stopped_because != "interrupted" {
            for one in &mut explored.branches {
                one.symmetry = Some(Symmetry::Mirror);
            }
            match case.stability {
                StabilityCase::Full { .. } => {
                    let found = asymmetric::follow(case, self, zero, symmetric, observer)?;
                    with_asymmetric(&mut explored, found, waves);
                }
                StabilityCase::Axisymmetric => {
                    explored.stopped_detail += NOT_EXAMINED;
                }
            }
        }
        let seconds = explored.seconds + scanning.elapsed().as_secs_f64();
        Ok(DiagramResult { seconds, ..explored })
    }

    fn cycle(
        &self,
        case: &ResolvedCase,
        reported: bool,
        observer: &mut Observer<'_>,
    ) -> Result<CycleResult, RunError> {
        cycle::half(case, self, reported, observer)
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
        let problem = contact::shell(case, self)?;
        // under a device the plate's distance is the last unknown
        let plate = u.get(problem.dim()).copied().unwrap_or(parameter);
        Ok(states::meridian_between_plates(&problem, u, plate))
    }

    fn film(&self) -> Option<f64> {
        Some(self.groups.film)
    }
}
