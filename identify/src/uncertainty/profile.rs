//! Profile likelihood: the least cost with one combination of the coordinates held.
//!
//! Both ways from the minimum until the cost has grown by 4.5, or the combination has moved by a factor of
//! [`FAR`]; then the interval is open.

use super::Quantity;
use crate::fit::descent::{BOLD, Held, Limits, Minimum, descend};
use crate::fit::objective::Objective;
use nalgebra::DVector;

/// Factor beyond which an interval counts as open.
pub const FAR: f64 = 30.0;
/// Most points on each side.
const POINTS: usize = 9;
/// Evaluations for each of them.
const LIMITS: Limits = Limits { evaluations: 12, tolerance: 0.01, damping: BOLD };
/// Growth of the cost that ends a side: beyond 1.96².
const ENOUGH: f64 = 4.5;

/// A point of a profile.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ProfilePoint {
    /// Offset of the quantity's coordinate from the estimate.
    pub offset: f64,
    /// Growth of the cost.
    pub growth: f64,
}

/// A profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Of what.
    pub quantity: Quantity,
    /// Its points by offset, that of the estimate included.
    pub points: Vec<ProfilePoint>,
    /// Offsets where the cost has grown by 1; `None` where it never does.
    pub interval68: [Option<f64>; 2],
    /// Offsets where it has grown by 3.84.
    pub interval95: [Option<f64>; 2],
    /// A place with a clearly lower cost than the minimum, if one was met.
    pub better: Option<DVector<f64>>,
    /// Evaluations of the model.
    pub evaluations: usize,
}

/// Follows the profile of a quantity about a minimum of `objective`; `sd` is its standard deviation as the
/// parabola has it.
pub fn profile(
    objective: &Objective<'_>,
    minimum: &Minimum,
    quantity: Quantity,
    sd: f64,
) -> Option<Profile> {
    let along = quantity.along(&objective.free)?;
    let centre = along.dot(&minimum.x);
    let logarithmic = quantity.is_logarithmic();
    // along the ridge of the parabola: x moves by C a/(aᵀ C a) with the combination
    let ridge = minimum.at.normal.clone().lu().solve(&along).and_then(|ridge| {
        let width = along.dot(&ridge);
        (width > 0.0 && width.is_finite()).then(|| ridge / width)
    });
    let sd = if sd.is_finite() && sd > 0.0 { sd } else { 0.3 };
    let sd = if logarithmic { sd.clamp(1e-5, 0.5) } else { sd };
    let mut points = vec![ProfilePoint { offset: 0.0, growth: 0.0 }];
    let (mut better, mut evaluations) = (None, 0);
    for sign in [-1.0, 1.0] {
        let mut x = minimum.x.clone();
        let mut offset = 0.0;
        let mut step = sd;
        for _ in 0..POINTS {
            let next = offset + sign * step;
            if logarithmic && next.abs() > FAR.ln() {
                break;
            }
            let held = Held { along: along.clone(), value: centre + next };
            // along the ridge as far as the last points tell
            let guess = match &ridge {
                _ if offset != 0.0 => &minimum.x + (&x - &minimum.x) * (next / offset),
                Some(ridge) => &minimum.x + ridge * next,
                None => x.clone(),
            };
            let found = descend(objective, &guess, Some(&held), LIMITS)
                .or_else(|| descend(objective, &x, Some(&held), LIMITS));
            let Some(found) = found else {
                step *= 0.5;
                continue;
            };
            evaluations += found.evaluations;
            if (along.dot(&found.x) - held.value).abs() > 1e-3 * step.max(1e-9) {
                // a bound keeps it from there
                step *= 0.5;
                continue;
            }
            let growth = found.at.cost - minimum.at.cost;
            if growth < -0.5 {
                better = Some(found.x);
                break;
            }
            offset = next;
            x = found.x;
            points.push(ProfilePoint { offset, growth: growth.max(0.0) });
            if growth > ENOUGH {
                break;
            }
            // towards a growth of 1, then of 4.5
            let root = growth.max(1e-4).sqrt();
            let aim = if root < 0.9 { 1.05 } else { 2.15 };
            let reach = (aim / root).clamp(1.2, 3.0) * offset.abs() - offset.abs();
            step = reach.max(0.3 * sd);
        }
    }
    points.sort_by(|a, b| a.offset.total_cmp(&b.offset));
    let crossing = |sign: f64, level: f64| {
        let side: Vec<&ProfilePoint> = match sign < 0.0 {
            true => points.iter().rev().filter(|p| p.offset <= 0.0).collect(),
            false => points.iter().filter(|p| p.offset >= 0.0).collect(),
        };
        let level = level.sqrt();
        side.windows(2).find(|w| w[1].growth.sqrt() >= level).map(|w| {
            let (a, b) = (w[0].growth.sqrt(), w[1].growth.sqrt());
            w[0].offset + (w[1].offset - w[0].offset) * (level - a) / (b - a)
        })
    };
    let interval = |level: f64| [crossing(-1.0, level), crossing(1.0, level)];
    let (interval68, interval95) = (interval(1.0), interval(3.841_459));
    Some(Profile { quantity, points, interval68, interval95, better, evaluations })
}
