//! Measured curves: samples by segment, in SI units, and the noise of their force.

pub mod jpk;
pub mod read;
mod table;

pub use read::read;
pub use shell_contact::device::Direction;
pub use table::Layout;

/// A part of a curve, in the order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Which way.
    pub direction: Direction,
    /// Height of the piezo, m: it falls on approach.
    pub height: Vec<f64>,
    /// Force that the deflection says, N: positive in compression.
    pub force: Vec<f64>,
}

/// A measured curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// What messages call it.
    pub name: String,
    /// Its segments, in the order of time.
    pub segments: Vec<Segment>,
    /// Stiffness of the lever that the file states, N/m.
    pub spring_constant: Option<f64>,
    /// What deserves to be said though it is not wrong.
    pub notes: Vec<String>,
}

impl Curve {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.segments.iter().map(|s| s.force.len()).sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Largest height, where the baseline is read.
    pub fn farthest(&self) -> f64 {
        self.heights().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Least height.
    pub fn nearest(&self) -> f64 {
        self.heights().fold(f64::INFINITY, f64::min)
    }

    fn heights(&self) -> impl Iterator<Item = f64> {
        self.segments.iter().flat_map(|s| s.height.iter().copied())
    }

    /// Standard deviation of the force's noise, N ([`noise`]); the median of the segments'.
    pub fn noise(&self) -> f64 {
        let mut each: Vec<f64> = self.segments.iter().filter_map(|s| noise(&s.force)).collect();
        median(&mut each).unwrap_or(f64::NAN)
    }

    /// Every `stride`-th sample.
    #[must_use]
    pub fn thinned(&self, stride: usize) -> Curve {
        let every = |x: &[f64]| x.iter().copied().step_by(stride.max(1)).collect();
        let segments = self.segments.iter().map(|s| Segment {
            direction: s.direction,
            height: every(&s.height),
            force: every(&s.force),
        });
        Curve { segments: segments.collect(), ..self.clone() }
    }
}

/// Standard deviation of white noise on a smooth signal, from third differences: those of a signal that is
/// a parabola over four samples vanish, those of noise have the variance `20 σ²`. By their median, which
/// jumps and outliers do not move (`0.6745 σ` is the median of `|x|`). `None` below eight samples.
pub fn noise(force: &[f64]) -> Option<f64> {
    if force.len() < 8 {
        return None;
    }
    let mut third: Vec<f64> =
        force.windows(4).map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs()).collect();
    median(&mut third).map(|m| m / (0.674_49 * 20.0_f64.sqrt()))
}

/// The median; reorders `x`.
pub fn median(x: &mut [f64]) -> Option<f64> {
    if x.is_empty() {
        return None;
    }
    x.sort_by(f64::total_cmp);
    let middle = x.len() / 2;
    Some(if x.len().is_multiple_of(2) { 0.5 * (x[middle - 1] + x[middle]) } else { x[middle] })
}
