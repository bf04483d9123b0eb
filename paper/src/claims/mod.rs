//! Statements of the paper against what was computed.
//!
//! The paper's values are quoted; ours are measured on the branches; the verdict follows from both
//! by the tolerance that stands in the row, one for each kind of statement. Where the paper does not
//! say how a number is to be taken, each way is a row of its own, and the window stands in it.
//! Statements that the paper does not make are marked as [`Source::Ours`].

mod benchmark;
mod hard;
mod knee;
mod measure;
mod soft;
mod stability;
mod tally;
mod tolerance;

pub(super) use tally::Tally;

use super::curve::Traced;
use super::number::short;
use super::ring::RingBranch;
use serde::Serialize;
use tolerance::Kind;

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

/// Who makes a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Source {
    /// A sentence of the paper.
    Paper,
    /// No sentence of the paper: what its figures show, or what was found on the way.
    Ours,
}

/// A statement, and one way to measure it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Claim {
    /// The figure it is about.
    pub figure: u32,
    /// Who says it.
    pub source: Source,
    /// What is said.
    pub statement: String,
    /// Its value; none where it gives no number.
    pub paper: Option<f64>,
    /// The computed one; none where the computation did not get there.
    pub ours: Option<f64>,
    /// What is measured, and its unit.
    pub measured: String,
    /// How far apart they may be: the verdict follows from it.
    pub tolerance: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Why.
    pub why: String,
}

/// A statement about one figure, in the making.
struct Row<'s> {
    figure: u32,
    source: Source,
    statement: &'s str,
    measured: &'s str,
    why: &'s str,
}

impl<'s> Row<'s> {
    /// A sentence of the paper, what is measured of it, and what the number means.
    fn new(figure: u32, statement: &'s str, measured: &'s str, why: &'s str) -> Row<'s> {
        Row { figure, source: Source::Paper, statement, measured, why }
    }

    /// No sentence of the paper says so.
    fn ours(self) -> Row<'s> {
        Row { source: Source::Ours, ..self }
    }

    /// A value of the paper, to the tolerance of its kind.
    fn near(self, kind: Kind, paper: f64, ours: Option<f64>) -> Claim {
        let good = ours.map(|x| kind.tolerance.allows(paper, x));
        self.claim(Some(paper), ours, kind.to_string(), good)
    }

    /// One of several powers, to the tolerance of its kind.
    fn one_of(self, kind: Kind, powers: &[f64], ours: Option<f64>) -> Claim {
        let good = ours.map(|x| powers.iter().any(|power| kind.tolerance.allows(*power, x)));
        let words: Vec<String> = powers.iter().map(|power| short(*power)).collect();
        self.claim(None, ours, format!("{kind} of {}", words.join(" or of ")), good)
    }

    /// A word of the paper that bounds the number, to the tolerance of its kind.
    fn bounded(self, kind: Kind, ours: Option<f64>) -> Claim {
        let good = ours.map(|x| kind.tolerance.allows(1.0, x));
        self.claim(None, ours, kind.to_string(), good)
    }

    /// A number that is counted.
    fn exactly(self, paper: f64, ours: Option<f64>) -> Claim {
        self.claim(Some(paper), ours, "exactly".to_owned(), ours.map(|x| x == paper))
    }

    /// A bound that follows from the statement.
    fn above(self, bound: f64, ours: Option<f64>) -> Claim {
        self.claim(None, ours, format!("above {}", short(bound)), ours.map(|x| x > bound))
    }

    /// A bound that follows from the statement.
    fn below(self, bound: f64, ours: Option<f64>) -> Claim {
        self.claim(None, ours, format!("below {}", short(bound)), ours.map(|x| x < bound))
    }

    /// A number that is shown but not said.
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
            source: self.source,
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
    use super::tolerance::{ALMOST, FLAT, SLOPE};
    use super::*;

    #[test]
    fn verdicts_follow_from_the_tolerance() {
        let row = || Row::new(1, "", "", "");
        let verdict = |claim: Claim| claim.verdict;
        assert_eq!(verdict(row().near(SLOPE, 8.0, Some(8.7))), Verdict::Agrees);
        assert_eq!(verdict(row().near(SLOPE, 8.0, Some(8.9))), Verdict::Disagrees);
        assert_eq!(verdict(row().near(SLOPE, 8.0, Some(f64::NAN))), Verdict::Disagrees);
        assert_eq!(verdict(row().one_of(ALMOST, &[1.0, 2.0], Some(1.45))), Verdict::Agrees);
        assert_eq!(verdict(row().one_of(ALMOST, &[1.0, 2.0], Some(1.35))), Verdict::Disagrees);
        assert_eq!(verdict(row().bounded(FLAT, Some(0.02))), Verdict::Disagrees);
        assert_eq!(verdict(row().exactly(2.0, Some(2.0))), Verdict::Agrees);
        assert_eq!(verdict(row().above(1.0, None)), Verdict::CannotBeDecided);
        assert_eq!(verdict(row().below(1.0, Some(0.5))), Verdict::Agrees);
        assert_eq!(verdict(row().open(Some(2.0))), Verdict::CannotBeDecided);
        assert_eq!(row().ours().open(None).source, Source::Ours);
    }
}
