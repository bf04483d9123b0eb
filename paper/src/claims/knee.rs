//! Where a force curve bends down: the end of the linear regime.
//!
//! Points of a branch lie up to a third of a thickness apart, a tenth of the way to the knee, and
//! chords between them put it that much too far. The states about it are therefore solved for.

use super::measure::{compression, force};
use crate::curve::Traced;
use shell_contact::asymptotics::REISSNER_SLOPE;

/// Steps to the knee between which slopes are taken.
const STEPS: f64 = 100.0;
/// The stretch on which they are, in parts of the way to the knee that the points of the branch
/// show: it holds the steepest place before the knee, and what the points miss it by.
const STRETCH: (f64, f64) = (0.5, 1.3);

/// The knee of a curve, by three readings of "the end of the linear regime".
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Knee {
    /// Deformation where the slope has fallen to half of the largest one before.
    pub(super) half: f64,
    /// Reduced force there.
    pub(super) force: f64,
    /// Deformation where the curve `F̂(d̂)` is curved most strongly.
    pub(super) sharpest: f64,
    /// Deformation where the slope has come down to Reissner's; none if it never was above.
    pub(super) reissner: Option<f64>,
}

/// The knee, if the curve has one.
pub(super) fn knee(traced: &Traced) -> Option<Knee> {
    let coarse = halved(&slopes(&compression(traced)))?.0;
    let step = coarse / STEPS;
    let (from, to) = ((STRETCH.0 * STEPS) as u32, (STRETCH.1 * STEPS) as u32);
    let solved: Option<Vec<(f64, f64)>> =
        (from..=to).map(|k| f64::from(k) * step).map(|d| Some((d, force(traced, d)?))).collect();
    let slopes = slopes(&solved?);
    let (half, steepest) = halved(&slopes)?;
    let curvature = |pair: &[(f64, f64)]| {
        let slope = 0.5 * (pair[0].1 + pair[1].1);
        (pair[1].1 - pair[0].1) / (1.0 + slope * slope).powf(1.5)
    };
    let sharpest = slopes.windows(2).min_by(|a, b| curvature(a).total_cmp(&curvature(b)))?;
    let sharpest = 0.5 * (sharpest[0].0 + sharpest[1].0);
    let reissner = falls_to(&slopes[steepest..], REISSNER_SLOPE);
    Some(Knee { half, force: force(traced, half)?, sharpest, reissner })
}

/// Slopes of chords, each in the middle of its own.
fn slopes(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let chord = |pair: &[(f64, f64)]| {
        let ((d0, f0), (d1, f1)) = (pair[0], pair[1]);
        (0.5 * (d0 + d1), (f1 - f0) / (d1 - d0))
    };
    points.windows(2).map(chord).collect()
}

/// Where the slope has fallen to half of the largest one before, and the place of that in the list.
fn halved(slopes: &[(f64, f64)]) -> Option<(f64, usize)> {
    let mut steepest = 0;
    for (k, (_, slope)) in slopes.iter().enumerate() {
        if *slope > slopes[steepest].1 {
            steepest = k;
        }
        if *slope < 0.5 * slopes[steepest].1 {
            return Some((falls_to(&slopes[steepest..], 0.5 * slopes[steepest].1)?, steepest));
        }
    }
    None
}

/// Where slopes that begin above a level come down to it.
fn falls_to(slopes: &[(f64, f64)], level: f64) -> Option<f64> {
    let pair = slopes.windows(2).find(|pair| pair[0].1 >= level && pair[1].1 < level)?;
    let share = (pair[0].1 - level) / (pair[0].1 - pair[1].1);
    Some(pair[0].0 + share * (pair[1].0 - pair[0].0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_fall_between_their_places() {
        let points = [(0.0, 0.0), (1.0, 6.0), (2.0, 16.0), (3.0, 22.0), (4.0, 24.0)];
        let slopes = slopes(&points);
        assert_eq!(slopes, [(0.5, 6.0), (1.5, 10.0), (2.5, 6.0), (3.5, 2.0)]);
        // the largest slope is 10: half of it lies a quarter of the way from 6 to 2
        assert_eq!(halved(&slopes), Some((2.75, 1)));
        assert_eq!(falls_to(&slopes[1..], 8.0), Some(2.0));
        assert_eq!(falls_to(&slopes[1..], 11.0), None);
        assert_eq!(halved(&slopes[..3]), None);
    }
}
