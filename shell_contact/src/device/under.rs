//! A branch traced under a grip, as another device sees it: numbers of unstable modes, and folds.

use super::walker::{Place, Walker};
use super::{Device, DeviceError, LoadedProblem};
use crate::contact::ContactProblem;
use continuation::{Branch, EvalError, Matrix, Problem};

/// A fold of a device, on the branch traced under a grip.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceFold {
    /// Index of the point of the branch after which it lies.
    pub after: usize,
    /// The shell.
    pub u: Vec<f64>,
    /// The plate's height.
    pub z0: f64,
    /// The force.
    pub force: f64,
    /// The device's own parameter.
    pub parameter: f64,
    /// Unstable modes under the device before, along the branch; `None` if unknown.
    pub unstable_before: Option<usize>,
    /// And after.
    pub unstable_after: Option<usize>,
    /// Estimated error of the place along the branch, in `R0`.
    pub error_estimate: f64,
}

/// Why a branch could not be read under a device.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnderError {
    /// The device is impossible.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A state of the branch has no value: it belongs to another problem.
    #[error("a point of the branch is no state of this problem: {0}")]
    Evaluation(#[from] EvalError),
    /// No state between two points of the branch could be computed.
    #[error("no state between points {after} and {} of the branch was found", .after + 1)]
    NotFound {
        /// The first of the two.
        after: usize,
    },
}

/// Numbers of unstable modes under a device at the points of a branch traced under a grip: negative
/// eigenvalues of the Hessian bordered with the plate's height. `None` where the inertia is unknown.
///
/// # Errors
/// When the branch is not one of this problem.
pub fn unstable_modes(
    contact: &ContactProblem,
    branch: &Branch,
    device: Device,
) -> Result<Vec<Option<usize>>, UnderError> {
    if device == Device::Grip {
        return Ok(branch.points.iter().map(|point| point.unstable).collect());
    }
    let loaded = LoadedProblem::new(contact, device)?;
    let mut hessian = loaded.new_jacobian();
    let p = loaded.parameters_at(0.0);
    let count = |point: &continuation::Point| {
        loaded.jacobian(&loaded.state(&point.u, point.p), &p, &mut hessian)?;
        let floor = f64::EPSILON * hessian.norm();
        Ok(hessian.factor(floor).inertia.map(|(negative, _)| negative))
    };
    branch.points.iter().map(count).collect()
}

/// The folds of a device on a branch traced under a grip: where its parameter turns back along the
/// branch, `dF/dz0 = 0` under a dead load, `= k_c` on a cantilever, infinite in a grip. Bracketed
/// between points, then located as a root of the parameter's slope along the branch, every trial
/// being a state of the branch.
///
/// # Errors
/// When the branch is not one of this problem.
pub fn folds(
    contact: &ContactProblem,
    branch: &Branch,
    device: Device,
) -> Result<Vec<DeviceFold>, UnderError> {
    let counts = unstable_modes(contact, branch, device)?;
    let places: Vec<Place> =
        branch.points.iter().map(|point| Place { u: point.u.clone(), z0: point.p }).collect();
    let mut search = Search { walker: Walker::new(contact), device };
    let mut folds = Vec::new();
    for after in 0..places.len().saturating_sub(1) {
        let (a, b) = (&places[after], &places[after + 1]);
        if search.walker.look_from_to(a, b) == 0.0 {
            continue;
        }
        if (search.slope(a)? < 0.0) != (search.slope(b)? < 0.0) {
            let (place, error) = search.locate(a, b).ok_or(UnderError::NotFound { after })?;
            let force = search.walker.force(&place)?;
            let parameter = device.parameter(place.z0, force);
            folds.push(DeviceFold {
                after,
                u: place.u,
                z0: place.z0,
                force,
                parameter,
                unstable_before: counts[..=after].iter().rev().flatten().next().copied(),
                unstable_after: counts[after + 1..].iter().flatten().next().copied(),
                error_estimate: error,
            });
        }
    }
    Ok(refined_counts(folds, &counts))
}

/// Counts at points that are folds themselves are rounding: the counts around a fold are those of
/// points that are none.
fn refined_counts(mut folds: Vec<DeviceFold>, counts: &[Option<usize>]) -> Vec<DeviceFold> {
    for k in 0..folds.len() {
        let (Some(before), Some(after)) = (folds[k].unstable_before, folds[k].unstable_after)
        else {
            continue;
        };
        if before == after {
            let at = folds[k].after;
            let earlier = at.checked_sub(1).and_then(|at| counts[at]);
            let later = counts.get(at + 2).copied().flatten();
            if later.is_some_and(|later| later != before) {
                folds[k].unstable_after = later;
            } else if earlier.is_some_and(|earlier| earlier != after) {
                folds[k].unstable_before = earlier;
            }
        }
    }
    folds
}

struct Search<'c> {
    walker: Walker<'c, ContactProblem>,
    device: Device,
}

/// Most halvings of a bracket.
const MOST: usize = 60;
/// Brackets shorter than this, in `R0`, are not shortened.
const NARROW: f64 = 1e-14;

impl Search<'_> {
    /// Slope of the device's parameter along the branch.
    fn slope(&mut self, at: &Place) -> Result<f64, EvalError> {
        let t = self.walker.tangent(at)?;
        Ok(match self.device {
            Device::Grip => t.dz0,
            Device::DeadLoad => t.dforce,
            // without a division, so that a soft spring is a dead load and a stiff one a grip
            Device::Cantilever { stiffness } => stiffness * t.dz0 - t.dforce,
        })
    }

    /// Ridders' method in the distance from `a` towards `b`.
    fn locate(&mut self, a: &Place, b: &Place) -> Option<(Place, f64)> {
        let length = self.walker.look_from_to(a, b);
        let (mut low, mut high) = (0.0, length * length);
        let (mut at_low, mut at_high) = (self.slope(a).ok()?, self.slope(b).ok()?);
        let mut best = b.clone();
        let mut last = f64::INFINITY;
        for _ in 0..MOST {
            if at_high == 0.0 {
                return Some((best, NARROW));
            }
            let middle = 0.5 * (low + high);
            let at_middle = self.at(a, b, length, middle)?;
            let value = self.slope(&at_middle).ok()?;
            let root = (value * value - at_low * at_high).sqrt();
            if value == 0.0 || root == 0.0 {
                return Some((at_middle, NARROW));
            }
            let shift = (middle - low) * value / root * (at_low - at_high).signum();
            let place = self.at(a, b, length, middle + shift)?;
            let at_place = self.slope(&place).ok()?;
            let here = middle + shift;
            let moved = (here - last).abs() / length;
            last = here;
            best = place;
            if moved < NARROW || at_place == 0.0 || (high - low) / length < NARROW {
                return Some((best, moved.max(NARROW)));
            }
            // the shortest bracket among the four places
            let mut known = [(low, at_low), (middle, value), (here, at_place), (high, at_high)];
            known.sort_by(|x, y| x.0.total_cmp(&y.0));
            for pair in known.windows(2) {
                if pair[0].1 * pair[1].1 < 0.0 {
                    [(low, at_low), (high, at_high)] = [pair[0], pair[1]];
                    break;
                }
            }
            if moved < 1e-12 {
                return Some((best, moved));
            }
        }
        Some((best, (high - low) / length))
    }

    /// The state of the branch at a share of the way, which is a product of lengths.
    fn at(&mut self, a: &Place, b: &Place, length: f64, distance: f64) -> Option<Place> {
        let share = distance / (length * length);
        let mix = |a: f64, b: f64| a + share * (b - a);
        let mut place = Place {
            u: a.u.iter().zip(&b.u).map(|(a, b)| mix(*a, *b)).collect(),
            z0: mix(a.z0, b.z0),
        };
        self.walker.correct(a, distance, &mut place)?;
        Some(place)
    }
}
