//! Special points of the Jacobian: augmented Newton methods that meet them to rounding, and normal
//! forms that say what they are.
//!
//! Bracketing on the branch comes first (a sign or a count that changes within a step); what is
//! here turns the bracket into a point, or refuses: a change that no singular point on the branch
//! explains was a jump, and the step must be shorter.

mod circle;
mod defect;
mod deficient;
mod fold;
mod forms;
mod gap;
mod hopf;
mod kernel;
mod multiple;
mod plateau;
mod probe;
mod roots;
mod small;
mod start;

pub(crate) use defect::Defect;
pub(crate) use deficient::deficient_everywhere;
pub(crate) use fold::fold_form;
pub(crate) use hopf::{locate_hopf, lyapunov_coefficient};
pub(crate) use kernel::{arbitrary, find};
pub(crate) use probe::{Extended, Probe};
pub(crate) use start::{Begun, SAME_PARAMETER, branch_point_at};

use crate::branch::Crossing;
use crate::events::{bend, interpolate};
use crate::step::{Core, Refusal, State};
use kernel::Failure;

pub(crate) use crate::linalg::max_abs;

/// A gap, in natural amplitudes, above which a symmetry that makes a larger kernel is broken.
const MAX_GAP: f64 = 1e-6;
/// Distance from the interpolated branch, relative to the step, above which a point is not on it.
const MAX_OFF: f64 = 0.1;
/// Newton's method has left the step if it is that many of its latest corrections beyond.
const FAR: f64 = 4.0;
/// Least cosine between the branch's expected direction and one of the tangents.
const MIN_ALIGNMENT: f64 = 0.9;
/// Where in a step Newton's method starts, in turn, if nothing better is known.
pub(crate) const SEEDS: [f64; 3] = [0.5, 0.15, 0.85];

/// A branch point on the traced branch.
#[derive(Debug, Clone)]
pub(crate) struct Crossed {
    /// Scaled distance from the step's first end.
    pub(crate) at: f64,
    /// Estimated error, as a scaled length.
    pub(crate) error: f64,
    pub(crate) crossing: Crossing,
    pub(crate) state: State,
}

/// The step in which a branch point is sought.
#[derive(Clone, Copy)]
struct Segment<'s> {
    a: &'s State,
    b: &'s State,
    /// Scaled length.
    h: f64,
    /// Cosine between the tangents at both ends.
    bend: f64,
    /// Whether the step cannot become shorter, so that small gaps cannot be followed.
    final_say: bool,
}

/// Locates the branch point with a kernel of `k` dimensions between `a` and `b`, a scaled length
/// `h` apart, or the `k` simple ones that lie there close together. Newton's method starts at the
/// parts `seeds` of the step, in turn.
pub(crate) fn locate_branch_points(
    core: &mut Core<'_>,
    a: &State,
    b: &State,
    h: f64,
    k: usize,
    seeds: &[f64],
    final_say: bool,
) -> Result<Vec<Crossed>, Refusal> {
    let mut probe = core.probe();
    let segment = Segment { a, b, h, bend: bend(core, a, b), final_say };
    let mut refusal = Refusal::Orientation;
    let mut found = None;
    for &seed in seeds {
        let mut x = a.clone();
        interpolate(a, b, h, segment.bend, seed * h, &mut x);
        let z = Extended { u: x.u.clone(), p: x.p };
        match attempt(core, &mut probe, segment, &z, k, &mut x) {
            Ok(crossed) => found = Some(vec![crossed]),
            // from elsewhere it may leave the domain too: where the point lies is to be known first
            Err(Failure::Evaluation(error)) => {
                refusal = Refusal::Evaluation(error);
                if k == 1 {
                    break;
                }
            }
            Err(Failure::Close(gap)) => {
                refusal = Refusal::BranchesClose { gap };
                break;
            }
            Err(Failure::Apart(seeds)) if seeds.len() == k => {
                let one = |z: &Extended| attempt(core, &mut probe, segment, z, 1, &mut x).ok();
                found = distinct(seeds.iter().map_while(one).collect(), k);
            }
            Err(_) => {}
        }
        if found.is_some() {
            break;
        }
    }
    core.statistics.newton_iterations += probe.assemblies;
    found.ok_or(refusal)
}

/// The same of a simple one that is known to be near `state`, a state of the branch between `a` and `b`.
pub(crate) fn locate_branch_point_near(
    core: &mut Core<'_>,
    (a, b): (&State, &State),
    h: f64,
    state: &State,
    final_say: bool,
) -> Result<Crossed, Refusal> {
    let mut probe = core.probe();
    let segment = Segment { a, b, h, bend: bend(core, a, b), final_say };
    let z = Extended { u: state.u.clone(), p: state.p };
    let mut x = a.clone();
    let found = attempt(core, &mut probe, segment, &z, 1, &mut x);
    core.statistics.newton_iterations += probe.assemblies;
    found.map_err(|failure| match failure {
        Failure::Evaluation(error) => Refusal::Evaluation(error),
        Failure::Close(gap) => Refusal::BranchesClose { gap },
        _ => Refusal::Orientation,
    })
}

/// The points in order, if there are `k` different ones.
fn distinct(mut points: Vec<Crossed>, k: usize) -> Option<Vec<Crossed>> {
    points.sort_by(|a, b| a.at.total_cmp(&b.at));
    let apart = points.windows(2).all(|w| w[1].at - w[0].at > 10.0 * (w[0].error + w[1].error));
    (points.len() == k && apart).then_some(points)
}

/// Newton's method from `z`; the point found must be on the branch, within the step, and be crossed
/// along the branch.
fn attempt(
    core: &mut Core<'_>,
    probe: &mut Probe<'_>,
    segment: Segment<'_>,
    z: &Extended,
    k: usize,
    x: &mut State,
) -> Result<Crossed, Failure> {
    let Segment { a, b, h, bend, final_say } = segment;
    let along = |probe: &mut Probe<'_>, z: &Extended| {
        let mut d = z.clone();
        d.add(-1.0, &Extended { u: a.u.clone(), p: a.p });
        probe.covector(&Extended { u: a.tu.clone(), p: a.tp }).dot(&d)
    };
    let seed = along(probe, z).clamp(0.0, h);
    let tangent = tangent_at(probe, a, b, h, bend, seed);
    // what lies beyond both neighbours of the step says nothing of it
    let astray = |probe: &mut Probe<'_>, z: &Extended, radius: f64| {
        let at = along(probe, z);
        let beyond = (-h - at).max(at - 2.0 * h);
        beyond > FAR * radius
    };
    let mut found = kernel::find(probe, z, &tangent, k, astray)?;
    let mut gap = 0.0;
    if k > 1 {
        // a residual no larger than that of a converged state says nothing of a gap
        let residual = core.residual(a).map_err(Failure::Evaluation)?;
        if found.unfolding > 8.0 * (a.u.len() as f64).sqrt() * residual {
            gap = found.gap;
        }
        if gap > MAX_GAP || (gap > 0.0 && !final_say) {
            return Err(Failure::NoConvergence);
        }
    }
    // on this branch, within this step
    let from = |s: &State, z: &Extended| {
        let mut d = z.clone();
        d.add(-1.0, &Extended { u: s.u.clone(), p: s.p });
        d
    };
    let from_a = from(a, &found.z);
    let at = along(probe, &found.z);
    let apart = if k == 1 { gap::between_branches(probe, &found)? } else { 0.0 };
    if apart > 0.0 {
        let beside = (-h..=2.0 * h).contains(&at);
        interpolate(a, b, h, bend, at.clamp(0.0, h), x);
        let off = probe.norm(&from(x, &found.z));
        return Err(if beside && off <= 2.0 * h && apart.is_finite() {
            Failure::Close(apart * a.length)
        } else {
            Failure::NoConvergence
        });
    }
    if !(-1e-6 * h..=h * (1.0 + 1e-6)).contains(&at) {
        return Err(Failure::NoConvergence);
    }
    let at = at.clamp(0.0, h);
    interpolate(a, b, h, bend, at, x);
    let off = from(x, &found.z);
    if probe.norm(&off) > MAX_OFF * h {
        return Err(Failure::NoConvergence);
    }
    let expected = tangent_at(probe, a, b, h, bend, at);
    let analysed = if k == 1 {
        forms::simple(probe, &mut found, &expected)?
    } else {
        multiple::analyse(probe, &mut found, &expected)?
    };
    let Some(analysed) = analysed else { return Err(Failure::NoConvergence) };
    let (own, other) = analysed.alignment;
    if own < MIN_ALIGNMENT || other > own {
        return Err(Failure::NoConvergence);
    }
    // the same branch before and after
    let mut back = from(b, &found.z);
    back.scale(-1.0);
    for side in [from_a, back] {
        let distance = probe.norm(&side);
        if distance < 1e-3 * h {
            continue;
        }
        let cosine = |probe: &mut Probe<'_>, v: &Extended| {
            let norm = probe.norm(v) * distance;
            probe.covector(v).dot(&side).abs() / norm
        };
        let along = cosine(probe, &analysed.traced);
        let others = analysed.crossing.leaving.iter();
        let astray = others
            .map(|d| cosine(probe, &Extended { u: d.du.clone(), p: d.dp }))
            .fold(0.0, f64::max);
        if along < MIN_ALIGNMENT || astray >= along {
            return Err(Failure::NoConvergence);
        }
    }
    core.place(x, &found.z, &analysed.traced).map_err(Failure::Evaluation)?;
    x.certified = a.certified && b.certified;
    let error = found.correction.max(gap).max(found.resolution).max(f64::EPSILON);
    Ok(Crossed { at, error, crossing: analysed.crossing, state: x.clone() })
}

/// Direction of the interpolated branch at a distance `at`, of unit scaled length.
fn tangent_at(probe: &mut Probe<'_>, a: &State, b: &State, h: f64, bend: f64, at: f64) -> Extended {
    let t = at / h;
    // slopes of the Hermite basis
    let (g0, g1) = (6.0 * t * t - 6.0 * t, 6.0 * t - 6.0 * t * t);
    let (s0, s1) = (3.0 * t * t - 4.0 * t + 1.0, 3.0 * t * t - 2.0 * t);
    let mut d = Extended::zero(a.u.len());
    for (w, x) in [(g0 / h, a), (g1 / h, b)] {
        d.add(w, &Extended { u: x.u.clone(), p: x.p });
    }
    for (w, x) in [(s0, a), (s1 / bend, b)] {
        d.add(w, &Extended { u: x.tu.clone(), p: x.tp });
    }
    let norm = probe.norm(&d);
    d.scale(1.0 / norm);
    d
}
