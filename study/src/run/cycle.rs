//! A cycle: the complete branch, the path once to and fro, and what it dissipates.

use super::contact::{SAMPLES, follow, loaded_path, not_held, path, result, row, shell};
use super::stability::Stability as Scanned;
use super::two_plates::{self, BetweenPlates, WithPlates};
use super::{Observer, RunError, listen, ways};
use crate::case::{ContactCase, ResolvedCase, StabilityCase, TwoPlatesCase};
use crate::record::view::{Curve, CyclePictures, Examined, Mark, Shape};
use crate::record::{
    CycleResult, FoldRecord, JumpRecord, MaxwellRecord, PathModes, PathRow, ReportedCycle,
    StretchRecord, Table,
};
use continuation::{EventKind, Problem, Settings};
use shell_contact::device::{
    Balance, Cycle, CyclePoint, CycleSettings, Direction, Loading, RelaxationSettings, balance,
    free_start, travel,
};
use shell_contact::modes::{AsymmetricModes, WholeModes};
use shell_contact::two_plates::stable_start;
use shell_contact::{ContactBranch, Device, LoadedProblem};
use std::time::Instant;

/// A cycle of mirror images.
pub(super) fn half(
    case: &ResolvedCase,
    contact: &ContactCase,
    reported: bool,
    observer: &mut Observer<'_>,
) -> Result<CycleResult, RunError> {
    let clock = Instant::now();
    let problem = shell(case, contact)?;
    let device = contact.device;
    let (traced, maxwell) = follow(case, device, &problem, observer)?;
    let first = &traced.branch.points[0];
    let cycle = if device == Device::Grip {
        let x = match first.unstable {
            Some(0) => first.u.clone(),
            _ => free_start(&problem, case.path.start).map_err(|e| not_held(case, e))?,
        };
        go(case, &problem, &x, path(case), observer)
    } else {
        let loaded = LoadedProblem::new(&problem, device).map_err(|e| not_held(case, e.into()))?;
        go(case, &loaded, &first.u, loaded_path(case), observer)
    }?;
    let mut modes = AsymmetricModes::new(problem.mesh());
    let mut counted = |point: &CyclePoint| {
        let StabilityCase::Full { max_n } = case.stability else { return None };
        let u = point.u.get(..problem.dim())?;
        modes.assemble(&problem, u, &problem.parameters_at(point.z0)).ok()?;
        let scan = modes.scan(max_n);
        Some(PathModes {
            antisymmetric: Some(scan.antisymmetric),
            modes: scan.modes,
            first_n: scan.first_n,
            n_max: scan.n_max,
            certain: scan.certain,
        })
    };
    let shape = |point: &CyclePoint| {
        let parameters = problem.parameters_at(point.z0);
        let profile = problem.profile(&point.u[..problem.dim()], &parameters, SAMPLES).ok()?;
        Some(Shape { sigma: profile.sigma, z: profile.z, plate: point.z0, ..Shape::default() })
    };
    let travelled = Travelled {
        case,
        device: contact.device,
        parameter: device.parameter_name(),
        both_parities: false,
        // a path whose states are all admissible has its work
        balance: balance(&problem, &cycle).ok(),
        reported: if reported {
            ways::reported(&problem, &traced, &cycle)
        } else {
            ReportedCycle::default()
        },
        branch: result(case, &traced, 0.0).table,
        traced: &traced,
        cycle: &cycle,
        maxwell,
    };
    Ok(travelled.result(clock, &mut counted, &shape))
}

/// A cycle from pole to pole.
pub(super) struct Travel<'t, 'o> {
    pub(super) case: &'t ResolvedCase,
    pub(super) plates: &'t TwoPlatesCase,
    pub(super) reported: bool,
    pub(super) observer: &'t mut Observer<'o>,
}

impl WithPlates for Travel<'_, '_> {
    type Output = Result<CycleResult, RunError>;

    fn with<P: BetweenPlates>(self, problem: &P, x: &[f64], p: &[f64]) -> Self::Output {
        let Travel { case, plates, reported, observer } = self;
        let clock = Instant::now();
        let name = &problem.parameters()[0].name;
        let settings = two_plates::settings(case, name);
        let (traced, _) = two_plates::follow(case, problem, (x, p), None, observer)?;
        let start = stable_start(problem, x, case.path.start)
            .map_err(|detail| not_held(case, detail.into()))?;
        let cycle = go(case, problem, &start, settings, observer)?;
        let mut modes = WholeModes::new(problem.half_mesh());
        let mut counted = |point: &CyclePoint| {
            let StabilityCase::Full { max_n } = case.stability else { return None };
            let p = problem.parameters_at(point.parameter);
            problem.assemble_modes(&point.u, &p, &mut modes).ok()?;
            let scan = modes.scan(max_n);
            Some(PathModes {
                antisymmetric: None,
                modes: scan.modes,
                first_n: scan.first_n,
                n_max: scan.n_max,
                certain: scan.certain,
            })
        };
        let shape = |point: &CyclePoint| {
            let p = problem.parameters_at(point.parameter);
            let profile = problem.meridian(&point.u, &p).ok()?;
            let [above, below] = problem.heights(&point.u, &p).ok()?;
            Some(Shape {
                sigma: profile.sigma,
                z: profile.z,
                plate: above,
                plate_below: Some(below),
                ..Shape::default()
            })
        };
        let stiffness = plates.plates[0].and_then(|plate| plate.stiffness);
        let travelled = Travelled {
            case,
            device: stiffness.map_or(Device::Grip, |k| Device::Cantilever { stiffness: k }),
            parameter: problem.device().parameter_name(),
            both_parities: true,
            balance: balance(problem, &cycle).ok(),
            reported: if reported {
                ways::between_plates(problem, &traced, &cycle)
            } else {
                ReportedCycle::default()
            },
            branch: two_plates::result(case, &traced, &Scanned::default(), 0.0).table,
            traced: &traced,
            cycle: &cycle,
            maxwell: Vec::new(),
        };
        Ok(travelled.result(clock, &mut counted, &shape))
    }
}

/// A cycle with what was found beside it.
struct Travelled<'t> {
    case: &'t ResolvedCase,
    device: Device,
    parameter: &'static str,
    both_parities: bool,
    balance: Option<Balance>,
    reported: ReportedCycle,
    branch: Table,
    traced: &'t ContactBranch,
    cycle: &'t Cycle,
    maxwell: Vec<MaxwellRecord>,
}

impl Travelled<'_> {
    fn result(
        self,
        clock: Instant,
        counted: &mut dyn FnMut(&CyclePoint) -> Option<PathModes>,
        shape: &dyn Fn(&CyclePoint) -> Option<Shape>,
    ) -> CycleResult {
        let Travelled { case, traced, cycle, balance, mut reported, .. } = self;
        let branch = &traced.branch;
        let row = |(step, point): (usize, &CyclePoint)| path_row(step, point, counted(point));
        let points: Vec<PathRow> = cycle.points.iter().enumerate().map(row).collect();
        ways::count(&mut reported, cycle, &points);
        let examined = match (case.stability, self.both_parities) {
            (StabilityCase::Full { .. }, _) => Examined::AxisymmetricAndOthers,
            (_, true) => Examined::AxisymmetricBothParities,
            (_, false) => Examined::Axisymmetric,
        };
        let pull_off = cycle.pull_off().map(|point| (point.z0, point.force));
        let (mut stopped, mut detail) = (cycle.stopped.reason, cycle.stopped.detail.clone());
        if stopped.is_complete() && !branch.stopped.reason.is_complete() {
            stopped = branch.stopped.reason;
            detail = format!("the complete branch is not: {}", branch.stopped.detail);
        }
        CycleResult {
            case: case.name.clone(),
            device: self.device,
            parameter: self.parameter,
            path: (case.path.start, case.path.end),
            both_parities: self.both_parities,
            jumps: cycle.jumps.iter().map(|jump| jump_record(cycle, jump)).collect(),
            pull_off,
            dissipated: cycle.dissipated(),
            loop_area: balance.and_then(|b| b.loop_area),
            area_error: balance.map(|b| b.error_estimate),
            work: balance.map(|b| (b.approach, b.retract)),
            closed: cycle.closed,
            folds: folds(traced),
            unstable: unstable(traced),
            maxwell: self.maxwell,
            stopped_because: stopped,
            stopped_detail: detail,
            newton_iterations: cycle.newton_iterations + branch.statistics.newton_iterations,
            seconds: clock.elapsed().as_secs_f64(),
            pictures: pictures(&case.name, traced, (cycle, &points), examined, shape),
            reported,
            branch: self.branch,
            points,
        }
    }
}

fn go<P: Loading>(
    case: &ResolvedCase,
    problem: &P,
    x: &[f64],
    trace: Settings,
    observer: &mut Observer<'_>,
) -> Result<Cycle, RunError> {
    let (start, end) = (case.path.start, case.path.end);
    let settings = CycleSettings { start, end, trace, relaxation: RelaxationSettings::default() };
    travel(problem, x, &settings, &mut listen(observer)).map_err(|detail| RunError::Cycle {
        case: case.name.clone(),
        start,
        detail,
    })
}

fn path_row(step: usize, point: &CyclePoint, modes: Option<PathModes>) -> PathRow {
    PathRow {
        direction: point.direction.name(),
        step,
        z0: point.z0,
        force: point.force,
        energy_total: point.energy,
        parameter: point.parameter,
        event: point.event.clone().unwrap_or_default(),
        modes,
    }
}

fn jump_record(cycle: &Cycle, jump: &shell_contact::device::Jump) -> JumpRecord {
    let (before, after) = ends(cycle, jump);
    JumpRecord {
        direction: jump.direction.name(),
        parameter: jump.parameter,
        z0_before: before.map(|p| p.z0),
        z0_after: after.map(|p| p.z0),
        force_before: before.map(|p| p.force),
        force_after: after.map(|p| p.force),
        energy_before: before.map(|p| p.energy),
        energy_after: after.map(|p| p.energy),
        dissipated: jump.dissipated,
        steps: jump.steps,
    }
}

/// The states before and after a jump.
fn ends<'c>(
    cycle: &'c Cycle,
    jump: &shell_contact::device::Jump,
) -> (Option<&'c CyclePoint>, Option<&'c CyclePoint>) {
    let at = |index: Option<usize>| index.and_then(|k| cycle.points.get(k));
    (at(jump.before), at(jump.after))
}

/// Where the device's parameter turns back on the complete branch.
fn folds(traced: &ContactBranch) -> Vec<FoldRecord> {
    let branch = &traced.branch;
    let fold = |event: &continuation::Event| {
        let at = row(traced, event.point, &branch.points[event.point]);
        FoldRecord {
            parameter: event.p,
            z0: at.z0,
            force: at.force,
            unstable_before: event.unstable_before,
            unstable_after: event.unstable_after,
            error_estimate: event.error_estimate,
        }
    };
    branch.events_of(&EventKind::Fold).map(fold).collect()
}

/// The stretches of the complete branch that are unstable under the device.
fn unstable(traced: &ContactBranch) -> Vec<StretchRecord> {
    let branch = &traced.branch;
    let mut stretches: Vec<StretchRecord> = Vec::new();
    let mut last = None;
    for (index, point) in branch.points.iter().enumerate() {
        let modes = point.unstable.filter(|modes| *modes > 0);
        if let Some(modes) = modes {
            let at = row(traced, index, point);
            match stretches.last_mut() {
                Some(stretch) if last == Some(modes) => {
                    stretch.points += 1;
                    (stretch.z0.1, stretch.force.1) = (at.z0, at.force);
                }
                _ => stretches.push(StretchRecord {
                    modes,
                    points: 1,
                    z0: (at.z0, at.z0),
                    force: (at.force, at.force),
                }),
            }
        }
        last = modes;
    }
    stretches
}

fn pictures(
    title: &str,
    traced: &ContactBranch,
    (cycle, path): (&Cycle, &[PathRow]),
    examined: Examined,
    shape: &dyn Fn(&CyclePoint) -> Option<Shape>,
) -> CyclePictures {
    let branch = &traced.branch;
    let labelled = |label: &str| Curve { label: label.to_owned(), examined, ..Curve::default() };
    let mut complete = labelled("complete branch");
    for (index, point) in branch.points.iter().enumerate() {
        let at = row(traced, index, point);
        complete.x.push(at.z0);
        complete.y.push(at.force);
        complete.unstable.push(point.unstable.is_some_and(|n| n > 0));
    }
    for event in branch.events_of(&EventKind::Fold) {
        let (x, y) = (complete.x[event.point], complete.y[event.point]);
        complete.marks.push(Mark { kind: "fold".to_owned(), x, y });
    }
    let way = |direction: Direction| {
        let mut curve = labelled(direction.name());
        for (k, point) in cycle.points.iter().enumerate() {
            if cycle.jumps.iter().any(|jump| jump.after == Some(k)) {
                // jumps are arrows, not lines
                curve.x.push(f64::NAN);
                curve.y.push(f64::NAN);
                curve.asymmetric.push(false);
            }
            if point.direction == direction {
                curve.x.push(point.z0);
                curve.y.push(point.force);
                curve.asymmetric.push(path[k].modes.is_some_and(|modes| modes.is_unstable()));
            }
        }
        curve
    };
    let mut pictures = CyclePictures {
        title: title.to_owned(),
        complete,
        approach: way(Direction::Approach),
        retract: way(Direction::Retract),
        jumps: Vec::new(),
        shapes: Vec::new(),
    };
    for (number, jump) in cycle.jumps.iter().enumerate() {
        let (before, after) = ends(cycle, jump);
        if let (Some(a), Some(b)) = (before, after) {
            pictures.jumps.push(((a.z0, a.force), (b.z0, b.force)));
        }
        let of = |point: Option<&CyclePoint>, when: &str| {
            let point = point?;
            let label =
                format!("{when}: F/√(χk_{{b}}) = {:.3}, z₀/R₀ = {:.3}", point.force, point.z0);
            Some(Shape { label, ..shape(point)? })
        };
        let pair = [of(before, "before"), of(after, "after")];
        let label = format!("{title}, jump {}: {}", number + 1, jump.direction.name());
        pictures.shapes.push((label, pair.into_iter().flatten().collect()));
    }
    pictures
}
