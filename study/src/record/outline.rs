//! A meridian with few points: as many as it takes to draw it.

/// Tolerances of the first attempt: of places, in units of the figure; of pressures, in their range.
const PLACE: f64 = 1e-4;
const PRESSURE: f64 = 1e-3;

/// A meridian, and the pressure on it if there is one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outline {
    /// Distances from the axis.
    pub sigma: Vec<f64>,
    /// Heights above the equator.
    pub z: Vec<f64>,
    /// Pressure on it; empty without one.
    pub pressure: Vec<f64>,
}

/// The state at a point: an axisymmetric shell between two plates or rings, its own mirror image or from pole
/// to pole.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct State {
    /// The point of the curve.
    pub point: usize,
    /// Height of the upper plate, or of the plane of the upper ring.
    pub plate: f64,
    /// Height of the lower plate, of a shell from pole to pole.
    pub plate_below: Option<f64>,
    /// The meridian, from the pole to the equator or to the other pole.
    pub outline: Outline,
}

impl Outline {
    /// The same with at most `most ≥ 2` of its points, ends included. Points are left out where a
    /// straight line does for the shape and for the pressure (Ramer, Douglas and Peucker); where too
    /// many remain, a coarser line does.
    pub fn thinned(&self, most: usize) -> Self {
        let range = |values: &[f64]| {
            let finite = values.iter().filter(|value| value.is_finite());
            let (low, high) =
                finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
            if high > low { high - low } else { 1.0 }
        };
        let pressure = range(&self.pressure);
        let mut coarse = 1.0;
        loop {
            let kept = self.kept(coarse * PLACE, coarse * PRESSURE * pressure);
            if kept.len() <= most.max(2) {
                let of = |values: &[f64]| kept.iter().map(|&i| values[i]).collect();
                let (sigma, z) = (of(&self.sigma), of(&self.z));
                let pressure =
                    if self.pressure.is_empty() { Vec::new() } else { of(&self.pressure) };
                return Outline { sigma, z, pressure };
            }
            coarse *= 1.5;
        }
    }

    fn len(&self) -> usize {
        let places = self.sigma.len().min(self.z.len());
        if self.pressure.is_empty() { places } else { places.min(self.pressure.len()) }
    }

    /// Indices of the points without which a straight line would be off by more than a tolerance.
    fn kept(&self, place: f64, pressure: f64) -> Vec<usize> {
        let Some(last) = self.len().checked_sub(1) else { return Vec::new() };
        let mut keep = vec![false; last + 1];
        (keep[0], keep[last]) = (true, true);
        let mut open = vec![(0, last)];
        while let Some((from, to)) = open.pop() {
            let worst = (from + 1..to)
                .map(|at| (self.off(from, at, to, place, pressure), at))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((off, at)) = worst
                && off > 1.0
            {
                keep[at] = true;
                open.extend([(from, at), (at, to)]);
            }
        }
        (0..=last).filter(|&at| keep[at]).collect()
    }

    /// How far a point is off the line between two others, in tolerances.
    fn off(&self, from: usize, at: usize, to: usize, place: f64, pressure: f64) -> f64 {
        let (dx, dy) = (self.sigma[to] - self.sigma[from], self.z[to] - self.z[from]);
        let (x, y) = (self.sigma[at] - self.sigma[from], self.z[at] - self.z[from]);
        let length = dx.hypot(dy);
        let across = if length > 0.0 { (x * dy - y * dx).abs() / length } else { x.hypot(y) };
        let across = across / place;
        if self.pressure.is_empty() {
            return across;
        }
        // the pressure is drawn over sigma, or its place along the line where that stands still
        let part = if length > 0.0 {
            ((x * dx + y * dy) / (length * length)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let line = self.pressure[from] + part * (self.pressure[to] - self.pressure[from]);
        let off = (self.pressure[at] - line).abs() / pressure;
        across.max(if off.is_nan() { 0.0 } else { off })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// A quarter of a circle with a narrow peak of pressure.
    fn circle() -> Outline {
        let angles: Vec<f64> = (0..=800).map(|i| FRAC_PI_2 * f64::from(i) / 800.0).collect();
        Outline {
            sigma: angles.iter().map(|a| a.sin()).collect(),
            z: angles.iter().map(|a| a.cos()).collect(),
            pressure: angles.iter().map(|a| (-((a - 0.4) / 0.01).powi(2)).exp()).collect(),
        }
    }

    #[test]
    fn few_points_draw_a_circle_and_a_peak() {
        let full = circle();
        let thin = full.thinned(100);
        assert!((20..=100).contains(&thin.sigma.len()), "{}", thin.sigma.len());
        assert_eq!((thin.sigma[0], thin.z[0]), (0.0, 1.0));
        assert_eq!(thin.sigma.last(), full.sigma.last());
        let peak = thin.pressure.iter().copied().fold(0.0, f64::max);
        assert!(peak > 0.99, "{peak}");
        // chords stay near the circle
        for pair in 1..thin.sigma.len() {
            let middle = [&thin.sigma, &thin.z].map(|v| 0.5 * (v[pair - 1] + v[pair]));
            assert!((middle[0].hypot(middle[1]) - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn a_bound_is_kept_and_short_data_are_harmless() {
        assert!(circle().thinned(12).sigma.len() <= 12);
        assert_eq!(Outline::default().thinned(10), Outline::default());
        let line =
            Outline { sigma: vec![0.0, 0.5, 1.0], z: vec![1.0; 3], pressure: vec![f64::NAN; 3] };
        assert_eq!(line.thinned(10).sigma, [0.0, 1.0]);
    }

    #[test]
    fn a_meridian_needs_no_pressure() {
        let bare = Outline { pressure: Vec::new(), ..circle() };
        let thin = bare.thinned(100);
        assert!((10..=100).contains(&thin.sigma.len()), "{}", thin.sigma.len());
        assert!(thin.pressure.is_empty());
        assert_eq!(thin.sigma.last(), bare.sigma.last());
    }
}
