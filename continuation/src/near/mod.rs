//! Near-bifurcations of a traced branch: imperfect branch points, and folds in pairs.
//!
//! Where an imperfection unfolds a branch point, the smallest singular value `σ(s)` of `[F_u F_p]`, zero
//! there otherwise, has a minimum along the branch. From the minimum Newton's method for
//! ```text
//! F(z) + B β = 0,    G(z) = 0
//! ```
//! (the bordered matrix of [`crate::guide::methods`]) meets the branch point of the perturbed
//! equations; `|β|` measures the imperfection, `√(|β| / |ψᵀF_zz|)` in natural amplitudes the gap.
//!
//! # Limits
//! Branch points with one critical mode, and folds. A dip between two points is not seen; where a branch
//! turns into another direction the tracer's steps are short enough.
//!
//! # References
//! - W. Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, SIAM, 2000, ch. 5.
//! - M. Golubitsky and D. G. Schaeffer, *Singularities and Groups in Bifurcation Theory* I, Springer,
//!   1985, ch. III (unfoldings).

mod settings;

pub use settings::NearSettings;

use crate::any_problem::DynProblem;
use crate::branch::{Branch, Direction, EventKind};
use crate::problem::{EvalError, ParamId, Problem};
use crate::settings::SettingsError;
use crate::singular::{Defect, Extended, Probe, find, max_abs};
use crate::step::{Weights, dot};
use serde::{Deserialize, Serialize};

/// Gaps below this, in natural amplitudes, are branch points.
const LEAST_GAP: f64 = 1e-6;
/// A minimum of the singular value counts if it rises by this factor on both sides.
const RISE: f64 = 1.1;
/// Points on either side of a minimum from which the bifurcation is sought besides.
const BESIDE: usize = 4;
/// How much larger the singular value may be there.
const DIP: f64 = 3.0;
/// Farthest that the branch may pass from the point where the bifurcation would be, in natural
/// amplitudes.
const FARTHEST: f64 = 0.7;
/// Points nearer to each other than this, in natural amplitudes, are the same.
const SAME: f64 = 1e-3;

/// What is nearly there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum NearKind {
    /// A branch point: an imperfection keeps the branches apart that would cross.
    BranchPoint,
    /// A cusp: two folds close together would vanish.
    Folds,
}

/// A bifurcation that a small change of the problem would make.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NearBifurcation {
    /// What is nearly there.
    pub kind: NearKind,
    /// Index of the branch's nearest point in [`Branch::points`].
    pub point: usize,
    /// Arclength of that point.
    pub s: f64,
    /// The parameter's value where the bifurcation would be.
    pub p: f64,
    /// The unknowns there; no solution, unless the gap is zero.
    pub u: Vec<f64>,
    /// How near: of a branch point the size of the gap in natural amplitudes, 1 being as far as the
    /// problem changes over the range of the parameter; of folds their distance in parts of the
    /// parameter's range.
    pub gap: f64,
    /// The way off the branch, of unit length in the problem's metric; either sign. Its
    /// `amplitude` is the multiple at which the nonlinearity matters; `bend` is 0.
    pub direction: Direction,
}

/// Why near-bifurcations cannot be sought.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NearError {
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A branch of another problem.
    #[error("the branch is not one of this problem: {what}")]
    Foreign {
        /// What does not fit.
        what: &'static str,
    },
    /// The problem has no value at a point of the branch.
    #[error("the problem has no value at point {point}: {cause}")]
    Evaluation {
        /// Index of the point.
        point: usize,
        /// Why.
        cause: EvalError,
    },
}

/// The near-bifurcations of a traced branch, in order along it.
///
/// A branch point that an imperfection unfolds leaves no sign change behind, but the smallest
/// singular value of `[F_u F_p]` dips where the branch passes it. From every dip Newton's method for
/// the branch point of `F + βb = 0` decides: `β` says how far the branches are kept apart. Two folds in
/// a row whose parameters differ little are reported too.
///
/// One assembly and one factorisation per point, after the trace, and up to fourteen iterations for
/// every dip. The branch must hold its points as they were traced: a dip between far points is not
/// seen.
///
/// ```
/// use continuation::{DenseProblem, NearSettings, Settings, Tracer, near_bifurcations};
/// use std::ops::ControlFlow;
///
/// // a pitchfork with an imperfection: the branch from below passes it without an event
/// let problem = DenseProblem::from_residual(1, &["p"], |x, p, r| {
///     r[0] = p[0] * x[0] - x[0].powi(3) + 1e-3;
/// });
/// let settings = Settings { target: Some(1.0), ..Settings::default() };
/// let branch = Tracer::new(&problem, "p", &[0.0], &[-1.0], settings)?
///     .run(&mut |_| ControlFlow::Continue(()));
/// assert!(branch.events.is_empty());
/// let near = near_bifurcations(&problem, &branch, NearSettings::default())?;
/// assert_eq!(near.len(), 1);
/// assert!(near[0].p.abs() < 1e-9 && near[0].gap < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a setting is out of range or the branch is not one of this problem.
pub fn near_bifurcations<P: Problem + ?Sized>(
    problem: &P,
    branch: &Branch,
    settings: NearSettings,
) -> Result<Vec<NearBifurcation>, NearError> {
    beside(&problem, branch, settings)
}

/// [`near_bifurcations`] of a problem of unknown type.
pub(crate) fn beside(
    problem: &DynProblem<'_>,
    branch: &Branch,
    settings: NearSettings,
) -> Result<Vec<NearBifurcation>, NearError> {
    settings.validate()?;
    let which = check(problem, branch)?;
    let weights = weights(problem, branch, which);
    let mut probe = Probe::new(problem, ParamId(which), &branch.parameters, weights);
    let mut found = dips(&mut probe, branch, settings.max_gap)?;
    found.extend(folds(&mut probe, branch, settings.max_fold_gap));
    found.sort_by(|a, b| a.s.total_cmp(&b.s));
    Ok(found)
}

/// The index of the branch's parameter.
fn check(problem: &DynProblem<'_>, branch: &Branch) -> Result<usize, NearError> {
    let foreign = |what| NearError::Foreign { what };
    let parameters = problem.parameters();
    let which = parameters
        .iter()
        .position(|q| q.name == branch.parameter)
        .ok_or(foreign("the problem has no such parameter"))?;
    if branch.parameters.len() != parameters.len() {
        return Err(foreign("its parameter vector has another length"));
    }
    if branch.points.iter().any(|point| point.u.len() != problem.dim()) {
        return Err(foreign("its states have another length"));
    }
    Ok(which)
}

/// The ranges of unknowns and parameter along the branch.
fn weights(problem: &DynProblem<'_>, branch: &Branch, which: usize) -> Weights {
    let p = || branch.points.iter().map(|point| point.p);
    let range = p().fold(f64::NEG_INFINITY, f64::max) - p().fold(f64::INFINITY, f64::min);
    let positive = |x: f64| (x.is_finite() && x > 0.0).then_some(x);
    let parameter = positive(range).unwrap_or_else(|| problem.parameters()[which].scale.abs());
    let mut y = vec![0.0; problem.dim()];
    let mut far = 0.0_f64;
    if let Some(first) = branch.points.first() {
        for point in &branch.points {
            let d: Vec<f64> = point.u.iter().zip(&first.u).map(|(a, b)| a - b).collect();
            problem.metric(&d, &mut y);
            far = far.max(dot(&d, &y).max(0.0).sqrt());
        }
    }
    let unknowns = match problem.unknown_scale(ParamId(which)) {
        Some(_) => parameter, // comparable as they are
        None => positive(far).unwrap_or(1.0),
    };
    Weights { unknowns, parameter }
}

fn state(branch: &Branch, k: usize) -> Extended {
    Extended { u: branch.points[k].u.clone(), p: branch.points[k].p }
}

fn difference(a: &Extended, b: &Extended) -> Extended {
    let mut d = a.clone();
    d.add(-1.0, b);
    d
}

/// Imperfect branch points, where the singular value has minima.
fn dips(
    probe: &mut Probe<'_>,
    branch: &Branch,
    max_gap: f64,
) -> Result<Vec<NearBifurcation>, NearError> {
    let count = branch.points.len();
    let mut defect = Defect::new(probe.dim());
    let mut values = Vec::with_capacity(count);
    let mut noises = Vec::with_capacity(count);
    for k in 0..count {
        let z = state(branch, k);
        let along =
            difference(&state(branch, (k + 1).min(count - 1)), &state(branch, k.max(1) - 1));
        let value = defect
            .at(probe, &z, &along)
            .map_err(|cause| NearError::Evaluation { point: k, cause })?;
        values.push(value);
        noises.push(max_abs(&probe.residual));
    }
    let sizes: Vec<f64> =
        values.iter().map(|v| v.as_ref().map_or(f64::NAN, |(size, _)| *size)).collect();
    let mut found: Vec<(Extended, NearBifurcation)> = Vec::new();
    for k in minima(&sizes) {
        let lo = k.saturating_sub(1);
        let crossed = |point: usize| {
            let event = branch.points[point].event.and_then(|e| branch.events.get(e));
            event.is_some_and(|e| e.kind == EventKind::BranchPoint)
        };
        if (lo..=(k + 1).min(count - 1)).any(crossed) {
            continue;
        }
        // Newton's method may miss it from the lowest point and meet it from one beside
        let met = around(&sizes, k).into_iter().find_map(|k| {
            let (_, tangent) = values[k].as_ref()?;
            let noise = 8.0 * (probe.dim() as f64).sqrt() * noises[k];
            imperfect(probe, &state(branch, k), tangent, noise, max_gap)
        });
        let Some((centre, near)) = met else { continue };
        let again = found.iter().position(|(other, _)| {
            let d = difference(other, &centre);
            probe.norm(&d) < SAME
        });
        let near = NearBifurcation { point: k, s: branch.points[k].s, ..near };
        match again {
            Some(j) if sizes[found[j].1.point] <= sizes[k] => {}
            Some(j) => found[j] = (centre, near),
            None => found.push((centre, near)),
        }
    }
    Ok(found.into_iter().map(|(_, near)| near).collect())
}

/// Indices of interior minima that rise on both sides.
fn minima(sizes: &[f64]) -> Vec<usize> {
    let lowest = |k: &usize| {
        let x = sizes[*k];
        let rises = |others: &mut dyn Iterator<Item = &f64>| {
            for y in others {
                if *y < x {
                    return false;
                }
                if *y > RISE * x {
                    return true;
                }
            }
            false
        };
        rises(&mut sizes[..*k].iter().rev()) && rises(&mut sizes[k + 1..].iter())
    };
    (0..sizes.len()).filter(lowest).collect()
}

/// The points in the dip about its lowest, that first.
fn around(sizes: &[f64], lowest: usize) -> Vec<usize> {
    let within = lowest.saturating_sub(BESIDE)..(lowest + BESIDE + 1).min(sizes.len());
    let mut points: Vec<usize> = within.filter(|&k| sizes[k] <= DIP * sizes[lowest]).collect();
    points.sort_by(|a, b| sizes[*a].total_cmp(&sizes[*b]));
    points
}

/// The branch point of which the branch at `z` is an unfolding, if it is one.
fn imperfect(
    probe: &mut Probe<'_>,
    z: &Extended,
    tangent: &Extended,
    noise: f64,
    max_gap: f64,
) -> Option<(Extended, NearBifurcation)> {
    let found = find(probe, z, tangent, 1, |_, _, _| false).ok()?;
    if !(found.gap > LEAST_GAP && found.gap <= max_gap && found.unfolding > noise) {
        return None;
    }
    // the branch passes it in the plane of the kernel, not farther than the gap explains
    let mut rest = difference(z, &found.z);
    let mut passed = [0.0; 2];
    for (i, v) in found.right.iter().enumerate() {
        let along = probe.covector(v).dot(&rest);
        rest.add(-along, v);
        passed[i] = along / found.amplitude[i];
    }
    let off = probe.norm(&rest) / found.amplitude[1].max(1.0);
    let distance = passed[0].hypot(passed[1]);
    if distance > FARTHEST || off > 0.5 * distance.max(found.gap) {
        return None;
    }
    let mut v = found.right[1].clone();
    let length = probe.length(&v);
    v.scale(1.0 / length);
    let amplitude = found.amplitude[1] * length;
    let direction = Direction { du: v.u, dp: v.p, bend: 0.0, amplitude, offset: None };
    let near = NearBifurcation {
        kind: NearKind::BranchPoint,
        point: 0,
        s: 0.0,
        p: found.z.p,
        u: found.z.u.clone(),
        gap: found.gap,
        direction,
    };
    Some((found.z, near))
}

/// Folds in a row, the parameters of which differ little.
fn folds(probe: &mut Probe<'_>, branch: &Branch, max_gap: f64) -> Vec<NearBifurcation> {
    let folds: Vec<_> = branch.events_of(&EventKind::Fold).collect();
    let range = probe.weights.parameter;
    let mut found = Vec::new();
    for pair in folds.windows(2) {
        let [a, b] = pair else { continue };
        let gap = (b.p - a.p).abs() / range;
        if gap > max_gap || b.point >= branch.points.len() {
            continue;
        }
        let (a, b) = (a.point, b.point);
        let mut centre = state(branch, a);
        let mut v = difference(&state(branch, b), &centre);
        centre.add(0.5, &v);
        let length = probe.length(&v);
        v.scale(1.0 / length);
        let nearest = (a..=b).min_by(|i, j| {
            let mut from = |k| {
                let d = difference(&state(branch, k), &centre);
                probe.norm(&d)
            };
            from(*i).total_cmp(&from(*j))
        });
        let point = nearest.unwrap_or(a);
        let direction = Direction { du: v.u, dp: v.p, bend: 0.0, amplitude: length, offset: None };
        found.push(NearBifurcation {
            kind: NearKind::Folds,
            point,
            s: branch.points[point].s,
            p: centre.p,
            u: centre.u,
            gap,
            direction,
        });
    }
    found
}
