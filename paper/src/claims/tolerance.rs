//! How far apart a statement and a number may be: one tolerance for each kind of statement.

use crate::number::short;

/// A kind of statement with its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Kind {
    /// What it is about, in the words of the table.
    pub(super) name: &'static str,
    pub(super) tolerance: Tolerance,
}

/// What a number is allowed to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Tolerance {
    /// To a share of the paper's value.
    Share(f64),
    /// Within a factor, either way.
    Factor(f64),
    /// At least.
    Above(f64),
    /// At most.
    Below(f64),
}

const fn share(name: &'static str, share: f64) -> Kind {
    Kind { name, tolerance: Tolerance::Share(share) }
}

/// Coordinates of a limit point. The coarsest that the paper prints, 0.03, is good to 17 %.
pub(super) const LIMIT_POINT: Kind = share("limit point", 0.17);
/// Reissner's slope.
pub(super) const SLOPE: Kind = share("slope", 0.1);
/// A law that is said to describe a curve, or to give back what went into it.
pub(super) const LAW: Kind = share("law", 0.2);
/// A power that is stated.
pub(super) const POWER: Kind = share("power", 0.15);
/// A power that is "almost" so: twice as wide, and still linear and quadratic are apart.
pub(super) const ALMOST: Kind = share("almost a power", 0.3);
/// A place that is "around" or "roughly" a value.
pub(super) const ROUGHLY: Kind = share("roughly", 0.15);
/// What is said to be the same, or not to differ.
pub(super) const SAME: Kind = share("the same", 0.1);
/// "On the order of", "of the same order": the nearest power of ten is the same.
pub(super) const ORDER: Kind =
    Kind { name: "order", tolerance: Tolerance::Factor(3.162_277_660_168_379_5) };
/// What is said to be different.
pub(super) const DIFFERENT: Kind = Kind { name: "different", tolerance: Tolerance::Above(1.1) };
/// What is said to be significantly or much larger.
pub(super) const MUCH: Kind = Kind { name: "much larger", tolerance: Tolerance::Above(2.0) };
/// A flat contact region: the pole below the highest point, in `R0`.
pub(super) const FLAT: Kind = Kind { name: "flat", tolerance: Tolerance::Below(0.01) };
/// A load that vanishes: its share of the largest pressure.
pub(super) const VANISHES: Kind = Kind { name: "vanishes", tolerance: Tolerance::Below(0.2) };

impl Tolerance {
    /// Whether `ours` is allowed, `paper` being the value it is held against.
    pub(super) fn allows(self, paper: f64, ours: f64) -> bool {
        match self {
            Tolerance::Share(share) => (ours - paper).abs() <= share * paper.abs(),
            Tolerance::Factor(factor) => {
                let ratio = ours / paper;
                (1.0 / factor..=factor).contains(&ratio)
            }
            Tolerance::Above(bound) => ours > bound,
            Tolerance::Below(bound) => ours < bound,
        }
    }
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.tolerance {
            Tolerance::Share(share) => write!(f, "±{} %", short(100.0 * share))?,
            Tolerance::Factor(factor) => write!(f, "within a factor of {factor:.2}")?,
            Tolerance::Above(bound) => write!(f, "above {}", short(bound))?,
            Tolerance::Below(bound) => write!(f, "below {}", short(bound))?,
        }
        write!(f, " ({})", self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_allowed_up_to_the_tolerance() {
        let allows = |kind: Kind, paper, ours| kind.tolerance.allows(paper, ours);
        assert!(allows(SLOPE, 8.0, 8.79) && !allows(SLOPE, 8.0, 8.81));
        assert!(allows(ORDER, 2.5, 0.8) && allows(ORDER, 2.5, 7.9));
        assert!(!allows(ORDER, 2.5, 0.78) && !allows(ORDER, 2.5, 8.0));
        assert!(allows(MUCH, 1.0, 2.1) && !allows(MUCH, 1.0, 2.0));
        assert!(allows(FLAT, 0.0, 0.009) && !allows(FLAT, 0.0, 0.01));
        assert!(!allows(SLOPE, 8.0, f64::NAN) && !allows(ORDER, 8.0, f64::NAN));
        assert_eq!(LIMIT_POINT.to_string(), "±17 % (limit point)");
    }

    /// An "almost" that is linear and quadratic at once would say nothing.
    #[test]
    fn almost_linear_is_not_almost_quadratic() {
        for power in [0.0, 0.5, 1.0, 1.25, 1.35, 1.5, 2.0, 2.6, 3.0] {
            let is = |n| ALMOST.tolerance.allows(n, power);
            assert!(!(is(1.0) && is(2.0)), "{power}");
        }
    }
}
