//! Statements of the paper against what was computed.
//!
//! The paper's values are quoted; ours are measured on the branches; the verdict follows from both
//! by the tolerance that stands in the row.

mod benchmark;
mod hard;
mod measure;
mod soft;

use super::curve::Traced;
use super::page::short;
use super::ring::RingBranch;
use serde::Serialize;

/// What the numbers say of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Verdict {
    /// The computed value is within the tolerance.
    Agrees,
    /// It is not.
    Disagrees,
    /// The paper does not say enough, or the computation did not get there.
    CannotBeDecided,
}

/// A statement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Claim {
    /// The figure it is about.
    pub(crate) figure: u32,
    /// What the paper says.
    pub(crate) statement: String,
    /// Its value; none where it gives no number.
    pub(crate) paper: Option<f64>,
    /// The computed one; none where the computation did not get there.
    pub(crate) ours: Option<f64>,
    /// What is measured, and its unit.
    pub(crate) measured: String,
    /// How far apart they may be: the verdict follows from it.
    pub(crate) tolerance: String,
    /// The verdict.
    pub(crate) verdict: Verdict,
    /// Why.
    pub(crate) why: String,
}

/// A statement about one figure, in the making.
struct Row<'s> {
    figure: u32,
    statement: &'s str,
    measured: &'s str,
    why: &'s str,
}

impl Row<'_> {
    /// A value of the paper, to a share of itself.
    fn near(self, paper: f64, ours: Option<f64>, share: f64) -> Claim {
        let good = ours.map(|x| (x - paper).abs() <= share * paper.abs());
        let tolerance = format!("±{} %", short(100.0 * share));
        self.claim(Some(paper), ours, tolerance, good)
    }

    /// A value of the paper, to an amount.
    fn within(self, paper: f64, ours: Option<f64>, amount: f64) -> Claim {
        let good = ours.map(|x| (x - paper).abs() <= amount);
        self.claim(Some(paper), ours, format!("±{}", short(amount)), good)
    }

    /// A bound that follows from the statement.
    fn above(self, bound: f64, ours: Option<f64>) -> Claim {
        self.claim(None, ours, format!("above {}", short(bound)), ours.map(|x| x > bound))
    }

    /// A bound that follows from the statement.
    fn below(self, bound: f64, ours: Option<f64>) -> Claim {
        self.claim(None, ours, format!("below {}", short(bound)), ours.map(|x| x < bound))
    }

    /// A range that follows from the statement.
    fn between(self, low: f64, high: f64, ours: Option<f64>) -> Claim {
        let good = ours.map(|x| (low..=high).contains(&x));
        self.claim(None, ours, format!("from {} to {}", short(low), short(high)), good)
    }

    /// A number that the paper shows but does not say.
    fn open(self, ours: Option<f64>) -> Claim {
        self.claim(None, ours, "none".to_owned(), None)
    }

    fn claim(
        self,
        paper: Option<f64>,
        ours: Option<f64>,
        tolerance: String,
        good: Option<bool>,
    ) -> Claim {
        let verdict = match good {
            Some(true) => Verdict::Agrees,
            Some(false) => Verdict::Disagrees,
            None => Verdict::CannotBeDecided,
        };
        Claim {
            figure: self.figure,
            statement: self.statement.to_owned(),
            paper,
            ours,
            measured: self.measured.to_owned(),
            tolerance,
            verdict,
            why: self.why.to_owned(),
        }
    }
}

/// The branches of one figure.
struct Branches<'t>(u32, &'t [Traced]);

impl<'t> Branches<'t> {
    fn get(&self, name: &str) -> Option<&'t Traced> {
        self.1.iter().find(|t| t.figure == self.0 && t.name == name)
    }
}

/// All statements about the figures whose branches these are.
pub(super) fn of(traced: &[Traced], rings: &[RingBranch]) -> Vec<Claim> {
    let mut claims = Vec::new();
    if traced.iter().any(|t| t.figure == 4) {
        claims.extend(benchmark::ring_load(&Branches(4, traced), rings));
    }
    for (figure, of) in [
        (5, hard::measured_shells as fn(&Branches<'_>) -> Vec<Claim>),
        (6, hard::weak_adhesion),
        (7, soft::lipid),
        (9, soft::estimates),
        (10, hard::bending),
        (11, hard::adhesion),
        (12, hard::strong_adhesion),
        (13, hard::thick_shell),
        (14, soft::bending),
        (15, soft::adhesion),
        (16, soft::stronger_adhesion),
        (17, soft::strongest_adhesion),
        (18, soft::surface_tension),
        (19, soft::weak_tension),
        (20, soft::strong_tension),
    ] {
        if traced.iter().any(|t| t.figure == figure) {
            claims.extend(of(&Branches(figure, traced)));
        }
    }
    claims
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_from_the_tolerance() {
        let row = || Row { figure: 1, statement: "", measured: "", why: "" };
        let verdict = |claim: Claim| claim.verdict;
        assert_eq!(verdict(row().near(8.0, Some(8.7), 0.1)), Verdict::Agrees);
        assert_eq!(verdict(row().near(8.0, Some(8.9), 0.1)), Verdict::Disagrees);
        assert_eq!(verdict(row().near(8.0, Some(f64::NAN), 0.1)), Verdict::Disagrees);
        assert_eq!(verdict(row().within(0.03, Some(0.0269), 0.005)), Verdict::Agrees);
        assert_eq!(verdict(row().above(1.0, None)), Verdict::CannotBeDecided);
        assert_eq!(verdict(row().below(1.0, Some(0.5))), Verdict::Agrees);
        assert_eq!(verdict(row().between(0.0, 1.0, Some(2.0))), Verdict::Disagrees);
        assert_eq!(verdict(row().open(Some(2.0))), Verdict::CannotBeDecided);
    }
}
