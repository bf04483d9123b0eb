//! The shell from pole to pole between plates of their own.

use super::{Family, Wanted};
use crate::case::{ResolvedCase, TwoPlatesCase};
use crate::record::{CycleResult, DiagramResult, Outline, TraceResult};
use crate::run::diagram::{
    DiagramObserver, DiagramProgress, Presented, Work, result, with_asymmetric,
};
use crate::run::map::{Attempt, MapError, Second, Task, two_plates as map};
use crate::run::stability::Stability;
use crate::run::two_plates::{BetweenPlates, WithPlates};
use crate::run::{Observer, RunError, asymmetric, contact, cycle, two_plates};
use continuation::diagram::{Diagram, DiagramError};
use shell_contact::ContactBranch;
use std::time::Instant;

impl Family for TwoPlatesCase {
    fn name(&self) -> &str {
        "two-plates"
    }

    fn trace(
        &self,
        case: &ResolvedCase,
        wanted: Wanted,
        observer: &mut Observer<'_>,
    ) -> Result<TraceResult, RunError> {
        two_plates::run(case, self, wanted, observer)
    }

    fn diagram(
        &self,
        case: &ResolvedCase,
        work: Work<'_>,
        observer: &mut DiagramObserver<'_>,
    ) -> Result<DiagramResult, RunError> {
        let name = self.parameter();
        let exploration = work.explore(case, two_plates::settings(case, name), &mut *observer);
        let explored = two_plates::visit(case, self, exploration)?;
        let (diagram, seconds) = explored.map_err(|error| match error {
            DiagramError::Trace(detail) => contact::no_start(case, detail),
            error => RunError::Diagram { case: case.name.clone(), error },
        })?;
        let scanning = Instant::now();
        let mut explored =
            two_plates::visit(case, self, OfTwoPlates { case, diagram, seconds, name, observer })?;
        explored.seconds += scanning.elapsed().as_secs_f64();
        Ok(explored)
    }

    fn cycle(
        &self,
        case: &ResolvedCase,
        reported: bool,
        observer: &mut Observer<'_>,
    ) -> Result<CycleResult, RunError> {
        let travel = cycle::Travel { case, plates: self, reported, observer };
        two_plates::visit(case, self, travel)?
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
        two_plates::visit(case, self, Meridian { u, parameter })
    }
}

/// The meridian of a state, from pole to pole.
struct Meridian<'m> {
    u: &'m [f64],
    parameter: f64,
}

impl WithPlates for Meridian<'_> {
    type Output = Option<Outline>;

    fn with<P: BetweenPlates>(self, problem: &P, _: &[f64], p: &[f64]) -> Option<Outline> {
        let mut p = p.to_vec();
        *p.first_mut()? = self.parameter;
        if self.u.len() != problem.dim() {
            return None;
        }
        let found = problem.meridian(self.u, &p).ok()?;
        Some(Outline { sigma: found.sigma, z: found.z, pressure: found.disjoining_pressure })
    }
}

/// The branches of a diagram between two plates, as plain numbers with their modes.
struct OfTwoPlates<'o, 'c> {
    case: &'c ResolvedCase,
    diagram: Diagram,
    seconds: f64,
    name: &'static str,
    observer: &'o mut DiagramObserver<'c>,
}

impl WithPlates for OfTwoPlates<'_, '_> {
    type Output = DiagramResult;

    fn with<P: BetweenPlates>(self, problem: &P, _: &[f64], _: &[f64]) -> DiagramResult {
        let OfTwoPlates { case, diagram, seconds, name, observer } = self;
        let x = if name == "z0" { "half the plate distance z₀/R₀" } else { name };
        let (mut zero, mut waves, mut done) = (None, 0, 0);
        let mut waiting = diagram.branches.len();
        let axes = (x, "force F/√(χ k_b)");
        let mut explored = result(case, diagram, seconds, axes, &mut |branch| {
            let mut traced = ContactBranch::new(branch, zero);
            zero = traced.zero_force;
            (done, waiting) = (done + 1, waiting - 1);
            let stability = Stability::of_whole(case, problem, &mut traced, &mut |branch| {
                observer(DiagramProgress { branches: done, waiting, branch })
            });
            waves += stability.waves() + stability.missed();
            let (trace, curve) = two_plates::on_diagram(case, problem, &traced, &stability);
            Presented { trace, curve, stability }
        });
        with_asymmetric(&mut explored, asymmetric::Asymmetric::default(), waves);
        explored
    }
}
