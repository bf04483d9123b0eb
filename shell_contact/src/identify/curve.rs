//! A measured or computed curve, and its local slope.

use super::IdentifyError;

/// Fewest points in compression.
const FEWEST: usize = 12;
/// Points of the resampled curve, evenly spaced in the logarithm of the deformation.
const SAMPLES: usize = 240;
/// Least deformation of the resampled curve, as a share of the largest.
const LEAST: f64 = 1.0 / 300.0;
/// Half width of the window of a local slope, in samples: ten per cent of the deformation.
const WINDOW: usize = 4;

/// What the deformation of a curve is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// Plate against equator, `Δ` of Eq. (19).
    OnePole,
    /// The approach of two plates, `2Δ`, as an instrument reads it.
    BothPlates,
}

/// The compressive part of a force-deformation curve.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceCurve {
    pub(super) deformation: Vec<f64>,
    pub(super) force: Vec<f64>,
    pub(super) slope: Vec<f64>,
}

impl ForceCurve {
    /// The curve through the points (`deformation[i]`, `force[i]`), deformation counted from zero
    /// force and increasing; points with a force or deformation below zero are left out.
    ///
    /// # Errors
    /// When the points make no such curve.
    pub fn new(
        deformation: &[f64],
        force: &[f64],
        reading: Reading,
    ) -> Result<ForceCurve, IdentifyError> {
        if deformation.len() != force.len() {
            return Err(IdentifyError::Lengths {
                deformations: deformation.len(),
                forces: force.len(),
            });
        }
        let share = match reading {
            Reading::OnePole => 1.0,
            Reading::BothPlates => 0.5,
        };
        let mut points: Vec<(f64, f64)> = Vec::new();
        let mut last = f64::NEG_INFINITY;
        for (at, (&d, &f)) in deformation.iter().zip(force).enumerate() {
            if !(d.is_finite() && f.is_finite() && d > last) {
                return Err(IdentifyError::Point { at, deformation: d, force: f });
            }
            last = d;
            if d > 0.0 && f > 0.0 {
                points.push((share * d, f));
            }
        }
        if points.len() < FEWEST {
            return Err(IdentifyError::TooFewPoints { found: points.len(), needed: FEWEST });
        }
        Ok(ForceCurve::resampled(&points))
    }

    fn resampled(points: &[(f64, f64)]) -> ForceCurve {
        let last = points[points.len() - 1].0;
        let first = points[0].0.max(LEAST * last);
        let ratio = (last / first).ln() / (SAMPLES - 1) as f64;
        let deformation: Vec<f64> =
            (0..SAMPLES).map(|i| (first * (ratio * i as f64).exp()).min(last)).collect();
        let force: Vec<f64> = deformation.iter().map(|&d| interpolate(points, d)).collect();
        let slope = (0..SAMPLES)
            .map(|i| {
                let window = i.saturating_sub(WINDOW)..(i + WINDOW + 1).min(SAMPLES);
                line(&deformation[window.clone()], &force[window]).1
            })
            .collect();
        ForceCurve { deformation, force, slope }
    }

    /// Power with which the force grows at sample `i`.
    pub(super) fn power(&self, i: usize) -> f64 {
        self.slope[i] * self.deformation[i] / self.force[i]
    }

    /// The samples with deformations from `low` to `high`.
    pub(super) fn between(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let start = self.deformation.partition_point(|&d| d < low);
        let end = self.deformation.partition_point(|&d| d <= high);
        start..end.max(start)
    }
}

fn interpolate(points: &[(f64, f64)], d: f64) -> f64 {
    let after = points.partition_point(|p| p.0 < d).clamp(1, points.len() - 1);
    let ((d0, f0), (d1, f1)) = (points[after - 1], points[after]);
    f0 + (f1 - f0) * (d - d0) / (d1 - d0)
}

/// Least-squares line: value at zero and slope.
pub(super) fn line(x: &[f64], y: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sxy: f64 = x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum();
    let sxx: f64 = x.iter().map(|x| (x - mx) * (x - mx)).sum();
    (my - sxy / sxx * mx, sxy / sxx)
}

/// Least-squares factor `c` of `y = c x`, and the largest misfit over the largest `y`.
pub(super) fn factor(x: &[f64], y: &[f64]) -> (f64, f64) {
    let sxy: f64 = x.iter().zip(y).map(|(x, y)| x * y).sum();
    let sxx: f64 = x.iter().map(|x| x * x).sum();
    let c = sxy / sxx;
    (c, misfit(x.iter().map(|x| c * x), y))
}

/// Largest deviation over the largest `y`.
pub(super) fn misfit(fitted: impl Iterator<Item = f64>, y: &[f64]) -> f64 {
    let largest = y.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
    fitted.zip(y).fold(0.0_f64, |m, (f, y)| m.max((f - y).abs())) / largest
}
