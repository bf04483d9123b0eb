//! Small cycles born at a Hopf point, those of twice the period at a period doubling, and those that cross
//! at a branch point.
//!
//! A small multiple `ε` of the critical mode is added to what bifurcates, and Newton's method solves for
//! the cycle whose part along the mode is `ε`: the parameter and the period are unknowns, so that it does
//! not matter to which side the new cycles lie, nor whether they are stable. The amplitude is chosen by
//! how far the first correction goes: far enough from the singular point, near enough to converge.

use super::collocation::CycleProblem;
use super::cycle::{Cycle, CycleError};
use super::mesh::uniform;
use super::settings::CycleSettings;
use super::trace::CycleBranch;
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Event, EventKind};
use crate::problem::{ParamId, Problem};
use crate::settings::{Counting, Settings};
use crate::step::{Constraint, Core, Precision, Refusal, State, Weights, dot};

/// First amplitude, relative to the size of the equilibrium, or of the cycle that doubles.
const FIRST: f64 = 0.02;
/// First correction, in amplitudes, above which the amplitude is reduced, and below which it may grow.
const CORRECTION: [f64; 2] = [0.01, 0.2];
/// Factor between amplitudes that are tried, and the largest number of them.
const FACTOR: f64 = 3.0;
/// Distance of the parameter from the special point, in its scale, beyond which the amplitude does not grow:
/// nothing is to be passed over on the way to the first cycle.
const PASSED: f64 = 0.05;
const MOST: usize = 60;

/// A cycle from which a branch leaves a special point.
#[derive(Debug, Clone, PartialEq)]
pub struct SmallCycle {
    /// The cycle.
    pub cycle: Cycle,
    /// Whether the parameter increases along the branch, away from the special point; where it does not
    /// change to rounding this is arbitrary.
    pub increasing: bool,
}

impl SmallCycle {
    /// A small cycle near a Hopf point of a branch of equilibria.
    ///
    /// # Errors
    /// When the event is no Hopf point of a branch of this problem, has no eigenvector, or no small
    /// cycle is found.
    pub fn at_hopf<P: Problem + ?Sized>(
        problem: &P,
        branch: &Branch,
        event: &Event,
        settings: &CycleSettings,
    ) -> Result<Self, CycleError> {
        Self::of_hopf(&problem, branch, event, settings)
    }

    /// [`Self::at_hopf`] of a problem of unknown type.
    pub(crate) fn of_hopf(
        problem: &DynProblem<'_>,
        branch: &Branch,
        event: &Event,
        settings: &CycleSettings,
    ) -> Result<Self, CycleError> {
        settings.validate()?;
        if event.kind != EventKind::Hopf {
            return Err(CycleError::Kind { found: event.kind.clone(), wanted: EventKind::Hopf });
        }
        let (which, p) = place(problem, branch, event)?;
        let at = branch.points.get(event.point).ok_or(foreign("it has no such point"))?;
        let n = problem.dim();
        if at.u.len() != n {
            return Err(foreign("the dimensions differ"));
        }
        let mode = event.eigenvectors.first().filter(|v| v.re.len() == n && v.im.len() == n);
        let mode = mode.ok_or(CycleError::NoEigenvector)?;
        let form = event.hopf().ok_or(CycleError::NoEigenvector)?;
        let nodes = settings.intervals * settings.degree;
        let (mut values, mut direction) = (Vec::new(), Vec::new());
        for node in 0..nodes {
            let (sin, cos) = (std::f64::consts::TAU * node as f64 / nodes as f64).sin_cos();
            values.extend_from_slice(&at.u);
            direction.extend((0..n).map(|i| mode.re[i] * cos - mode.im[i] * sin));
        }
        let base = Cycle {
            mesh: uniform(settings.intervals),
            degree: settings.degree,
            values,
            period: std::f64::consts::TAU / form.frequency,
            parameters: p,
        };
        let mut y = vec![0.0; n];
        problem.metric(&at.u, &mut y);
        let size = dot(&at.u, &y).max(0.0).sqrt();
        leave(problem, which, &base, direction, if size > 0.0 { size } else { 1.0 }, settings)
    }

    /// A cycle of about twice the period near a period doubling of a branch of cycles.
    ///
    /// # Errors
    /// When the event is no period doubling of a branch of this problem, or no such cycle is found.
    pub fn at_doubling<P: Problem + ?Sized>(
        problem: &P,
        cycles: &CycleBranch,
        event: &Event,
        settings: &CycleSettings,
    ) -> Result<Self, CycleError> {
        Self::of_doubling(&problem, cycles, event, settings)
    }

    /// [`Self::at_doubling`] of a problem of unknown type.
    pub(crate) fn of_doubling(
        problem: &DynProblem<'_>,
        cycles: &CycleBranch,
        event: &Event,
        settings: &CycleSettings,
    ) -> Result<Self, CycleError> {
        settings.validate()?;
        let wanted = EventKind::PeriodDoubling;
        if event.kind != wanted {
            return Err(CycleError::Kind { found: event.kind.clone(), wanted });
        }
        let (which, p) = place(problem, &cycles.branch, event)?;
        let single = cycles.cycles.get(event.point).ok_or(foreign("it has no such point"))?;
        let single = Cycle { parameters: p, ..single.cycle.clone() };
        let (base, direction) = twice(problem, &single)?;
        leave(problem, which, &base, direction, single.amplitude(), settings)
    }

    /// A cycle on a branch that crosses at a branch point of cycles, along the direction number `index` of
    /// [`Crossing::leaving`](crate::Crossing::leaving), or against it.
    ///
    /// # Errors
    /// When the event is no branch point of a branch of this problem, it has no such direction, the
    /// direction changes the parameter alone, or no cycle is found along it.
    pub fn at_branch_point<P: Problem + ?Sized>(
        problem: &P,
        cycles: &CycleBranch,
        event: &Event,
        index: usize,
        forward: bool,
        settings: &CycleSettings,
    ) -> Result<Self, CycleError> {
        Self::of_branch_point(&problem, cycles, event, index, forward, settings)
    }

    /// [`Self::at_branch_point`] of a problem of unknown type.
    pub(crate) fn of_branch_point(
        problem: &DynProblem<'_>,
        cycles: &CycleBranch,
        event: &Event,
        index: usize,
        forward: bool,
        settings: &CycleSettings,
    ) -> Result<Self, CycleError> {
        settings.validate()?;
        let wanted = EventKind::BranchPoint;
        if event.kind != wanted {
            return Err(CycleError::Kind { found: event.kind.clone(), wanted });
        }
        let (which, p) = place(problem, &cycles.branch, event)?;
        let at = cycles.cycles.get(event.point).ok_or(foreign("it has no such point"))?;
        let base = Cycle { parameters: p, ..at.cycle.clone() };
        let leaving = event.crossing().and_then(|crossing| crossing.leaving.get(index));
        let leaving = leaving.ok_or(foreign("the event has no such direction"))?;
        if leaving.du.len() != base.values.len() + 1 {
            return Err(foreign("the dimensions differ"));
        }
        let sign = if forward { 1.0 } else { -1.0 };
        let direction = leaving.du[..base.values.len()].iter().map(|d| sign * d).collect();
        leave(problem, which, &base, direction, base.amplitude(), settings)
    }
}

/// A cycle run through twice, and the direction in which those of twice the period leave it where a
/// multiplier is −1.
pub(super) fn twice(
    problem: &DynProblem<'_>,
    single: &Cycle,
) -> Result<(Cycle, Vec<f64>), CycleError> {
    let equations = CycleProblem::of(problem, single)?;
    let x = equations.unknowns(single);
    let mode = equations.flip(&x, &single.parameters)?.ok_or(CycleError::NoEigenvector)?;
    let mut mesh: Vec<f64> = single.mesh.iter().map(|t| 0.5 * t).collect();
    mesh.extend(single.mesh.iter().skip(1).map(|t| 0.5 + 0.5 * t));
    let mut values = single.values.clone();
    values.extend_from_slice(&single.values);
    let mut direction = mode.clone();
    direction.extend(mode.iter().map(|w| -w));
    Ok((Cycle { mesh, values, period: 2.0 * single.period, ..single.clone() }, direction))
}

fn foreign(what: &'static str) -> CycleError {
    CycleError::Foreign { what }
}

/// The continued parameter and all values at the event.
fn place(
    problem: &DynProblem<'_>,
    branch: &Branch,
    event: &Event,
) -> Result<(ParamId, Vec<f64>), CycleError> {
    let all = problem.parameters();
    let which = all.iter().position(|q| q.name == branch.parameter);
    let which = which.ok_or(foreign("it has no such parameter"))?;
    if branch.parameters.len() != all.len() {
        return Err(foreign("the numbers of parameters differ"));
    }
    let mut p = branch.parameters.clone();
    p[which] = event.p;
    Ok((ParamId(which), p))
}

/// The cycle that is `base` plus a small multiple of `direction`, corrected.
fn leave(
    problem: &DynProblem<'_>,
    which: ParamId,
    base: &Cycle,
    direction: Vec<f64>,
    size: f64,
    settings: &CycleSettings,
) -> Result<SmallCycle, CycleError> {
    let (cycle, ..) = depart(problem, which, base, direction, size)?;
    let increasing = cycle.parameters[which.0] >= base.parameters[which.0];
    // adapting the mesh at a fixed parameter is not worth a failure
    let cycle = cycle.adapted(problem, settings).unwrap_or(cycle);
    Ok(SmallCycle { cycle, increasing })
}

/// The cycle that is `base` plus a small multiple of `direction`, corrected; the multiple, and the
/// direction of length 1 in the metric of the equations.
pub(super) fn depart(
    problem: &DynProblem<'_>,
    which: ParamId,
    base: &Cycle,
    mut direction: Vec<f64>,
    size: f64,
) -> Result<(Cycle, f64, Vec<f64>), CycleError> {
    let mut epsilon = FIRST * size;
    let (mut best, mut shrinking) = (None, false);
    let mut refusal = Refusal::Singular;
    // of length 1 in the metric, which any orbit of the same mesh gives
    let equations = CycleProblem::of(problem, &shifted(base, epsilon, &direction))?;
    let mut y = vec![0.0; equations.dim()];
    direction.push(0.0);
    equations.metric(&direction, &mut y);
    let norm = dot(&direction, &y).max(0.0).sqrt();
    direction.pop();
    if !(norm > 0.0 && norm.is_finite()) {
        return Err(CycleError::Constant);
    }
    direction.iter_mut().for_each(|d| *d /= norm);
    for _ in 0..MOST {
        match correct(problem, which, base, &direction, epsilon) {
            Ok((cycle, first)) => {
                let distance = (cycle.parameters[which.0] - base.parameters[which.0]).abs();
                let far = first > CORRECTION[1];
                if !far || best.is_none() {
                    best = Some((cycle, epsilon));
                }
                if !far && (shrinking || first > CORRECTION[0]) {
                    break;
                }
                let scale = problem.parameters()[which.0].scale.abs();
                // the parameter varies as the square of the amplitude
                if !far && FACTOR * FACTOR * distance > PASSED * scale {
                    break;
                }
                shrinking |= far;
                epsilon *= if far { 1.0 / FACTOR } else { FACTOR };
            }
            Err(Attempt::Cycle(error)) => return Err(error),
            Err(Attempt::Refused(error)) => {
                if best.is_some() {
                    break;
                }
                (refusal, shrinking) = (error, true);
                epsilon /= FACTOR;
            }
        }
    }
    let Some((cycle, epsilon)) = best else {
        return Err(CycleError::NoSmallCycle { amplitude: epsilon, refusal });
    };
    Ok((cycle, epsilon, direction))
}

fn shifted(base: &Cycle, by: f64, direction: &[f64]) -> Cycle {
    let values = base.values.iter().zip(direction).map(|(u, d)| u + by * d).collect();
    Cycle { values, ..base.clone() }
}

/// Why there is no cycle at an amplitude.
pub(super) enum Attempt {
    /// No equations.
    Cycle(CycleError),
    /// The corrector refused it.
    Refused(Refusal),
}

/// The cycle at the distance `epsilon` along the direction, and how far the first correction went.
pub(super) fn correct(
    problem: &DynProblem<'_>,
    which: ParamId,
    base: &Cycle,
    direction: &[f64],
    epsilon: f64,
) -> Result<(Cycle, f64), Attempt> {
    let start = shifted(base, epsilon, direction);
    let equations = &CycleProblem::of(problem, &start).map_err(Attempt::Cycle)?;
    let weights =
        Weights { unknowns: epsilon, parameter: problem.parameters()[which.0].scale.abs() };
    let settings = Settings { counting: Counting::Few, ..Settings::default() };
    let mut core = Core::new(equations, which, &base.parameters, weights, &settings);
    let mut from = State::new(equations.dim(), equations.observables().len());
    from.u.copy_from_slice(&equations.unknowns(base));
    from.p = base.parameters[which.0];
    let end = direction.len();
    from.tu[..end].iter_mut().zip(direction).for_each(|(t, d)| *t = epsilon * d);
    equations.metric(&from.tu, &mut from.mtu);
    from.length = epsilon;
    let mut x = from.clone();
    x.u.iter_mut().zip(&from.tu).for_each(|(u, t)| *u += t);
    let corrected = core.correct(Constraint::Plane(&from, 1.0), &mut x, Precision::Event);
    let corrected = corrected.map_err(Attempt::Refused)?;
    let mut p = base.parameters.clone();
    p[which.0] = x.p;
    Ok((equations.cycle(&x.u, &p), corrected.first))
}
