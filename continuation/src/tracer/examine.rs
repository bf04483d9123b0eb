//! Looks at the derivatives now and then.

use super::Tracer;
use crate::branch::Doubt;

/// Accepted steps after which the derivatives are looked at.
const EARLY: usize = 3;
/// Assemblies of a correction that are many, and how many such corrections ask for another look.
pub(super) const LABORIOUS: usize = 5;
pub(super) const MANY: usize = 6;

impl Tracer<'_> {
    /// Whether the derivatives were looked at, or will not be.
    pub(super) fn is_examined(&self) -> bool {
        self.examined || self.core.statistics.accepted >= EARLY
    }

    /// Looks once at the derivatives early on, and once more where corrections are laborious.
    pub(super) fn examine_derivatives(&mut self) {
        let early = self.core.statistics.accepted == EARLY && !self.examined;
        let late = self.laborious == MANY;
        if !(early || late) || self.core.problem.special_points().is_some() {
            return;
        }
        self.laborious += usize::from(late);
        let (core, current) = (&mut self.core, &self.current);
        if let Some(wrong) = core.wrong_derivative(current) {
            self.laborious = MANY + 1;
            let (from, to) = (self.start.p, current.p);
            let reason = format!("{wrong}: nothing on this branch is certain");
            self.doubts.push(Doubt { from, to, reason });
        }
    }
}
