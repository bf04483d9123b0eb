//! Where a branch of cycles ends: at an equilibrium, at cycles of half the period, near a homoclinic orbit,
//! or where it began.

use super::collocation::CycleProblem;
use super::observed::observe;
use super::trace::Run;
use crate::branch::{Event, EventKind, Point, Stop, StopReason};
use crate::tracer::Tracer;

/// Cosine between the orbit's derivative and the reference's below which the orbit is that of the other
/// side of an equilibrium.
const OPPOSITE: f64 = -0.5;
/// Amplitude, relative to the largest of the branch, at which shrinking cycles are taken to vanish, and
/// the same where the trace cannot go on.
const VANISHED: [f64; 2] = [0.01, 0.2];
/// Change of the parameter, relative to its range, while the period grows by a factor e, below which the
/// parameter has come to rest.
const RESTS: f64 = 1e-6;
/// Relative difference of periods and extrema of the same cycle on two meshes.
const SAME: f64 = 1e-6;

impl<'a> Run<'a, '_> {
    /// The end of the trace where doubled cycles come back to those of half their period: beyond that
    /// point the branch is the same again, half a period later.
    pub(super) fn halved(
        &self,
        equations: &CycleProblem<'a>,
        point: &Point,
        event: &Event,
    ) -> Option<Stop> {
        if !matches!(event.kind, EventKind::BranchPoint | EventKind::Fold) {
            return None;
        }
        let mut p = vec![0.0; self.problem.parameters().len()];
        p[self.which.0] = point.p;
        let halfway = equations.cycle(&point.u, &p).halfway();
        let before = self.cycles.iter().map(|c| c.cycle.halfway()).fold(0.0, f64::max);
        let name = &self.problem.parameters()[self.which.0].name;
        (halfway < VANISHED[0] * before).then(|| Stop {
            reason: StopReason::PeriodHalved,
            detail: format!(
                "the cycles come back to those of half their period at {name} = {:.10}",
                point.p
            ),
        })
    }

    /// The end of the trace where the cycles have shrunk to an equilibrium.
    pub(super) fn vanished(
        &self,
        equations: &CycleProblem<'a>,
        point: &Point,
        tracer: &Tracer<'_>,
    ) -> Option<Stop> {
        let mut p = vec![0.0; self.problem.parameters().len()];
        p[self.which.0] = point.p;
        let amplitude = equations.cycle(&point.u, &p).amplitude();
        let name = &self.problem.parameters()[self.which.0].name;
        let singular = point
            .event
            .and_then(|e| tracer.events().get(e))
            .is_some_and(|event| event.kind == EventKind::BranchPoint);
        let before = self.cycles.last()?.cycle.amplitude();
        if singular && amplitude < VANISHED[0] * self.largest {
            let detail = format!("the cycles shrink to an equilibrium at {name} = {:.10}", point.p);
            return Some(Stop { reason: StopReason::CyclesVanish, detail });
        }
        // beyond the equilibrium the orbit is half a period behind
        let shrinks = match &self.cycles[..] {
            [.., a, b] => b.cycle.amplitude() < a.cycle.amplitude(),
            _ => false,
        };
        let beyond = shrinks && equations.alignment(&point.u) < OPPOSITE;
        if beyond || amplitude < VANISHED[0] * self.largest && amplitude < before {
            return Some(self.vanishing());
        }
        None
    }

    /// What to say of cycles that vanish.
    fn vanishing(&self) -> Stop {
        let name = &self.problem.parameters()[self.which.0].name;
        let mut detail = "the cycles shrink to an equilibrium".to_owned();
        if let [.., a, b] = &self.cycles[..] {
            // the parameter varies as the square of the amplitude
            let (x, y) = (a.cycle.amplitude().powi(2), b.cycle.amplitude().powi(2));
            let [p, q] = [a, b].map(|c| c.cycle.parameters[self.which.0]);
            let at = q - (p - q) * y / (x - y);
            if at.is_finite() {
                detail = format!("{detail}, by extrapolation near {name} = {at:.6}");
            }
        }
        Stop { reason: StopReason::CyclesVanish, detail }
    }

    /// A trace that cannot go on where the cycles are about to vanish.
    pub(super) fn near_vanishing(&self, stop: Stop) -> Stop {
        let stuck = matches!(stop.reason, StopReason::StepTooSmall | StopReason::BranchesTooClose);
        let [.., a, b] = &self.cycles[..] else { return stop };
        let (x, y) = (a.cycle.amplitude(), b.cycle.amplitude());
        if !(stuck && y < x && y < VANISHED[1] * self.largest) {
            return stop;
        }
        let vanishing = self.vanishing();
        Stop { detail: format!("{}; {}", vanishing.detail, stop.detail), ..vanishing }
    }

    /// The end of the trace where the period grows without bound.
    pub(super) fn unbounded(&self) -> Option<Stop> {
        let [.., a, b] = &self.cycles[..] else { return None };
        let [t, u] = [a, b].map(|c| c.cycle.period);
        let [p, q] = [a, b].map(|c| c.cycle.parameters[self.which.0]);
        let growing = u > t && u > self.cycle_settings.period_growth * self.shortest;
        let rate = (q - p).abs() / (u / t).ln();
        if !(growing && rate < RESTS * self.range) {
            return None;
        }
        let name = &self.problem.parameters()[self.which.0].name;
        let detail = format!(
            "the period is {u:.6} and grows without bound while {name} comes to rest near {q:.8}, where it has \
             changed by {:.1e} since the period was {t:.6}: the cycles approach a homoclinic or heteroclinic \
             orbit, to which they are not followed",
            (q - p).abs()
        );
        Some(Stop { reason: StopReason::PeriodUnbounded, detail })
    }

    /// The end of the trace where the branch has come back to its start in the same direction: at the
    /// start's parameter the cycle is the first one.
    pub(super) fn closed(&self) -> Option<Stop> {
        let (Some(first), [.., a, b]) = (self.points.first(), &self.points[..]) else {
            return None;
        };
        let passes = (a.p - first.p) * (b.p - first.p) <= 0.0 && a.p != b.p;
        if self.points.len() < 5 || !passes || first.dp_ds * b.dp_ds <= 0.0 {
            return None;
        }
        let mut cycle = self.cycles.last()?.cycle.clone();
        cycle.parameters[self.which.0] = first.p;
        let again = cycle.solved(self.problem).ok()?;
        let observed = observe(self.problem, &again).ok()?;
        let old = &self.cycles.first()?.cycle;
        let same = |x: f64, y: f64, size: f64| (x - y).abs() <= SAME * size;
        let size = old.amplitude()
            + first.observables.iter().skip(1).fold(0.0, |m: f64, x| m.max(x.abs()));
        let is_same = same(again.period, old.period, old.period)
            && observed
                .iter()
                .zip(first.observables.iter().skip(1))
                .all(|(x, y)| same(*x, *y, size));
        let detail = "the branch is a closed loop".to_owned();
        is_same.then_some(Stop { reason: StopReason::ClosedLoop, detail })
    }
}
