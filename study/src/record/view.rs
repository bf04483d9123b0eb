//! What pictures are drawn from: plain numbers. NaN makes a gap.

use std::ops::Range;

/// What a state is unstable to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Stability {
    /// Nothing that was examined.
    #[default]
    Stable,
    /// Modes without the symmetries of the state, and no others.
    Asymmetric,
    /// Modes with its symmetries.
    Unstable,
}

impl Stability {
    /// From whether modes with the symmetries of the state are unstable, and whether others are.
    pub fn of(unstable: bool, asymmetric: bool) -> Stability {
        match (unstable, asymmetric) {
            (true, _) => Stability::Unstable,
            (false, true) => Stability::Asymmetric,
            (false, false) => Stability::Stable,
        }
    }
}

/// Which modes were examined for stability.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Examined {
    /// All that the problem has.
    #[default]
    All,
    /// Of a shell, axisymmetric mirror images.
    Axisymmetric,
    /// Of a shell, those and the axisymmetric ones that are none.
    AxisymmetricBothParities,
    /// Of a shell, those and the others.
    AxisymmetricAndOthers,
}

impl Examined {
    /// What may be said of a state that is not unstable.
    pub fn stable(self) -> &'static str {
        match self {
            Examined::All | Examined::AxisymmetricAndOthers => "stable",
            _ => "stable to axisymmetric modes",
        }
    }
}

/// A curve along a branch.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// What it shows, for the legend and for its colour.
    pub label: String,
    /// Abscissae, in order along the branch.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
    /// Whether the state is unstable to modes with its own symmetries; missing entries count as
    /// stable.
    pub unstable: Vec<bool>,
    /// Whether it is unstable to modes without them; missing entries count as stable.
    pub asymmetric: Vec<bool>,
    /// What both know.
    pub examined: Examined,
    /// Special points on it.
    pub marks: Vec<Mark>,
}

/// A special point on a curve.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mark {
    /// Kind, as in the table of special points.
    pub kind: String,
    /// Abscissa.
    pub x: f64,
    /// Ordinate.
    pub y: f64,
}

/// A deformed meridian: the upper half of the cross-section, from pole to equator, of which the
/// lower is the mirror image; or with a plate below, all of it from pole to pole.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shape {
    /// What it is, for the legend.
    pub label: String,
    /// Distances from the axis, in R0.
    pub sigma: Vec<f64>,
    /// Heights above the equator, in R0.
    pub z: Vec<f64>,
    /// Height of the plate, in R0; NaN without one.
    pub plate: f64,
    /// Height of the lower plate of a shell that is not its own mirror image.
    pub plate_below: Option<f64>,
    /// Whether the state is stable.
    pub stability: Stability,
}

/// A quantity along a deformed meridian.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Profile {
    /// What state it belongs to, for the legend; the colour goes with its place in the list, the
    /// same as that of the [`Shape`] at the same place.
    pub label: String,
    /// Distances from the axis, in R0.
    pub sigma: Vec<f64>,
    /// The quantity.
    pub value: Vec<f64>,
    /// Whether the state is stable.
    pub stability: Stability,
}

/// What the pictures of a cycle show.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CyclePictures {
    /// Title.
    pub title: String,
    /// The complete branch, force over plate distance.
    pub complete: Curve,
    /// The way in, with gaps at jumps.
    pub approach: Curve,
    /// The way out, likewise.
    pub retract: Curve,
    /// Ends of the jumps.
    pub jumps: Vec<((f64, f64), (f64, f64))>,
    /// For each jump a title and its shapes, before and after.
    pub shapes: Vec<(String, Vec<Shape>)>,
}

/// Whether a number can be drawn.
pub fn drawable(value: f64) -> bool {
    value.abs() < 1e100
}

/// A stretch of a curve of one stability, without gaps: indices of its points.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stretch {
    /// Its points.
    pub points: Range<usize>,
    /// Which.
    pub stability: Stability,
}

impl Curve {
    /// Number of points that have both coordinates.
    fn len(&self) -> usize {
        self.x.len().min(self.y.len())
    }

    /// What the state at a point is unstable to.
    fn stability(&self, at: usize) -> Stability {
        let holds = |flags: &[bool]| flags.get(at).copied().unwrap_or(false);
        Stability::of(holds(&self.unstable), holds(&self.asymmetric))
    }

    /// Whether any stretch that can be drawn has this stability.
    pub fn has(&self, stability: Stability) -> bool {
        self.stretches().iter().any(|stretch| stretch.stability == stability)
    }

    /// Whether any point that can be drawn is unstable.
    pub fn has_unstable(&self) -> bool {
        self.has(Stability::Unstable) || self.has(Stability::Asymmetric)
    }

    /// The stretches of the curve. Neighbours of different stability share the point between
    /// them.
    pub fn stretches(&self) -> Vec<Stretch> {
        let good = |at: usize| drawable(self.x[at]) && drawable(self.y[at]);
        let mut stretches: Vec<Stretch> = Vec::new();
        let mut at = 0;
        while at < self.len() {
            if !good(at) {
                at += 1;
                continue;
            }
            let end = (at..self.len()).find(|&i| !good(i)).unwrap_or(self.len());
            let mut start = at;
            for i in at + 1..end.saturating_sub(1) {
                let stability = self.segment(i - 1);
                if self.segment(i) != stability {
                    stretches.push(Stretch { points: start..i + 1, stability });
                    start = i;
                }
            }
            let stability = if end - at > 1 { self.segment(end - 2) } else { self.stability(at) };
            stretches.push(Stretch { points: start..end, stability });
            at = end;
        }
        stretches
    }

    /// The stability of the segment after a point. Where its ends differ, a special point is
    /// the end at which stability changes, and the segment goes with the other; without one it
    /// goes with its first end.
    fn segment(&self, at: usize) -> Stability {
        let (first, second) = (self.stability(at), self.stability(at + 1));
        if first == second {
            return first;
        }
        let marked =
            |i: usize| self.marks.iter().any(|mark| mark.x == self.x[i] && mark.y == self.y[i]);
        if marked(at) && !marked(at + 1) { second } else { first }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(y: &[f64], unstable: &[bool]) -> Curve {
        Curve {
            x: (0..y.len()).map(|i| i as f64).collect(),
            y: y.to_vec(),
            unstable: unstable.to_vec(),
            ..Curve::default()
        }
    }

    fn spans(curve: &Curve) -> Vec<(usize, usize, bool)> {
        let unstable = |s: &Stretch| s.stability == Stability::Unstable;
        let stretches = curve.stretches();
        stretches.iter().map(|s| (s.points.start, s.points.end, unstable(s))).collect()
    }

    #[test]
    fn what_is_unstable_without_symmetry_only_is_a_stretch_of_its_own() {
        let (f, t) = (false, true);
        let mut c = curve(&[0.0; 6], &[f, f, f, f, t, t]);
        c.asymmetric = vec![f, f, t, t, t, t];
        // the loss of symmetry at 2 and the fold at 4
        c.marks = [2.0, 4.0].map(|x| Mark { kind: "any".into(), x, y: 0.0 }).to_vec();
        let found: Vec<_> = c.stretches().into_iter().map(|s| (s.points, s.stability)).collect();
        let (stable, broken) = (Stability::Stable, Stability::Asymmetric);
        assert_eq!(found, [(0..3, stable), (2..5, broken), (4..6, Stability::Unstable)]);
        assert!(c.has(broken) && c.has_unstable());
    }

    #[test]
    fn neighbouring_stretches_share_their_boundary() {
        let (f, t) = (false, true);
        let c = curve(&[0.0; 6], &[f, f, t, t, f, f]);
        assert_eq!(spans(&c), [(0, 3, f), (2, 5, t), (4, 6, f)]);
    }

    #[test]
    fn a_marked_point_is_where_stability_changes() {
        let (f, t) = (false, true);
        // the fold at 1 counts as stable, that at 4 as unstable
        let mut c = curve(&[0.0; 6], &[f, f, t, t, t, f]);
        c.marks = [1.0, 4.0].map(|x| Mark { kind: "fold".into(), x, y: 0.0 }).to_vec();
        assert_eq!(spans(&c), [(0, 2, f), (1, 5, t), (4, 6, f)]);
    }

    #[test]
    fn gaps_and_short_data_are_harmless() {
        assert!(spans(&curve(&[], &[])).is_empty());
        assert_eq!(spans(&curve(&[1.0], &[true])), [(0, 1, true)]);
        let gap = curve(&[1.0, f64::NAN, 1.0, 1.0, f64::INFINITY], &[]);
        assert_eq!(spans(&gap), [(0, 1, false), (2, 4, false)]);
        assert!(!gap.has_unstable());
    }
}
