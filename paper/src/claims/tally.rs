//! How the statements of a source come out.

use super::{Claim, Source, Verdict};

/// Numbers of statements; one that was measured in several ways counts once.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    agree: usize,
    disagree: usize,
    /// Agree measured in one way and disagree in another.
    split: usize,
    undecided: usize,
}

impl Tally {
    /// The statements of one source.
    pub(crate) fn of(claims: &[Claim], source: Source) -> Tally {
        let same = |a: &Claim, b: &Claim| (a.figure, &a.statement) == (b.figure, &b.statement);
        let mut tally = Tally::default();
        for (k, first) in claims.iter().enumerate().filter(|(_, claim)| claim.source == source) {
            if claims[..k].iter().any(|earlier| same(earlier, first)) {
                continue;
            }
            let ways = || claims[k..].iter().filter(|claim| same(claim, first));
            let any = |verdict| ways().any(|claim| claim.verdict == verdict);
            let count = match (any(Verdict::Agrees), any(Verdict::Disagrees)) {
                (true, true) => &mut tally.split,
                (true, false) => &mut tally.agree,
                (false, true) => &mut tally.disagree,
                (false, false) => &mut tally.undecided,
            };
            *count += 1;
        }
        tally
    }

    /// Whether there is any.
    pub(crate) fn is_empty(self) -> bool {
        self == Tally::default()
    }
}

impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Tally { agree, disagree, split, undecided } = self;
        write!(
            f,
            "{agree} agree, {disagree} disagree, {split} depend on how they are measured, \
             {undecided} cannot be decided"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::Row;
    use super::super::tolerance::POWER;
    use super::*;

    #[test]
    fn a_statement_counts_once() {
        let row = |statement| Row::new(18, statement, "", "");
        let claims = [
            row("cubic").near(POWER, 3.0, Some(2.5)),
            row("cubic").near(POWER, 3.0, Some(2.7)),
            row("linear").near(POWER, 1.0, Some(1.5)),
            row("two folds").exactly(2.0, Some(2.0)),
            row("drawn").ours().open(Some(1.0)),
        ];
        let text = Tally::of(&claims, Source::Paper).to_string();
        let counts = "1 agree, 1 disagree, 1 depend on how they are measured, 0 cannot be decided";
        assert_eq!(text, counts);
        let ours = Tally::of(&claims, Source::Ours);
        assert!(!ours.is_empty() && ours.to_string().ends_with("1 cannot be decided"));
        assert!(Tally::of(&claims[..4], Source::Ours).is_empty());
    }
}
