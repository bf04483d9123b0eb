//! Errors of points between two at which the finer solution was sought, on the same mesh.
//!
//! On one mesh errors vary slowly from point to point. Where those on both sides agree, twice the larger ones are
//! the errors between; where they do not, or a count would not be certain with them, the point is solved again itself.

use super::collocation::CycleProblem;
use super::floquet::Multiplier;
use super::point::CyclePoint;
use super::trace::Run;

/// Points in a row without a finer solution of their own, at most.
const MOST: usize = 2;
/// Factor within which errors on both sides agree, but for rounding.
const AGREE: f64 = 8.0;
/// Factor by which the larger of both is exceeded between.
const WIDER: f64 = 2.0;
/// Errors below which two agree, whatever their ratio.
const ROUNDING: f64 = 1e-12;

/// What waits on one mesh.
#[derive(Debug, Default)]
pub(super) struct Between {
    /// The latest point with errors of its own.
    solved: Option<usize>,
    /// Points since then, which have none yet.
    waiting: Vec<usize>,
}

impl Between {
    /// Whether the next point must be solved again itself.
    pub(super) fn is_full(&self) -> bool {
        self.solved.is_none() || self.waiting.len() >= MOST
    }
}

impl<'a> Run<'a, '_> {
    /// Notes the latest point, with errors of its own or without, and gives those before it theirs.
    pub(super) fn note(&mut self, equations: &CycleProblem<'a>, p: &[f64], solved: bool) {
        let at = self.points.len() - 1;
        if !solved {
            self.between.waiting.push(at);
            return;
        }
        let waiting = std::mem::take(&mut self.between.waiting);
        let before = self.between.solved;
        for i in waiting {
            let found = before.and_then(|before| self.interpolated(before, i, at));
            match found {
                Some((cycle, moved)) => self.replace(i, cycle, Some(moved)),
                None => self.solve_again(equations, i, p),
            }
        }
        // an orbit without errors says nothing of its neighbours
        self.between.solved = self.cycles[at].error.map(|_| at);
    }

    /// Solves again what still waits where a mesh is left.
    pub(super) fn settle(&mut self, equations: &CycleProblem<'a>, p: &[f64]) {
        for i in std::mem::take(&mut self.between).waiting {
            self.solve_again(equations, i, p);
        }
    }

    fn replace(&mut self, i: usize, cycle: CyclePoint, moved: Option<f64>) {
        (self.points[i].unstable, self.points[i].certified) = (cycle.unstable, cycle.certified);
        self.cycles[i] = cycle;
        self.moved[i] = moved;
    }

    fn solve_again(&mut self, equations: &CycleProblem<'a>, i: usize, p: &[f64]) {
        let mut p = p.to_vec();
        p[self.which.0] = self.points[i].p;
        let (u, dp_ds) = (std::mem::take(&mut self.points[i].u), self.points[i].dp_ds);
        let fine = self.finer(equations, (&u, &p, dp_ds), false);
        let mut cycle = self.cycles[i].clone();
        cycle.estimate(equations, &u, fine.as_ref(), self.which);
        self.points[i].u = u;
        let moved = fine.filter(|_| cycle.error.is_some()).map(|fine| fine.moved);
        self.replace(i, cycle, moved);
    }

    /// The point `i` with the errors of `a` and `b` on both sides; `None` where they say too little.
    fn interpolated(&self, a: usize, i: usize, b: usize) -> Option<(CyclePoint, f64)> {
        // an error at the same parameter grows where the branch is steep
        let [steep, here, also] = [a, i, b].map(|k| self.points[k].dp_ds.abs());
        let (left, right) = (&self.cycles[a], &self.cycles[b]);
        if here < 0.5 * steep.max(also) || !(left.certified && right.certified) {
            return None;
        }
        let mut cycle = self.cycles[i].clone();
        let between = |x: Option<f64>, y: Option<f64>| wider(x?, y?);
        cycle.error = Some(between(left.error, right.error)?);
        cycle.period_error = Some(between(left.period_error, right.period_error)?);
        cycle.parameter_error = Some(between(left.parameter_error, right.parameter_error)?);
        let trivial = cycle.trivial_error?;
        if trivial > AGREE * left.trivial_error?.max(right.trivial_error?).max(ROUNDING) {
            return None;
        }
        for multiplier in &mut cycle.multipliers {
            let [x, y] = [left, right].map(|side| nearest(&side.multipliers, multiplier));
            multiplier.error = Some(wider(x?, y?)? + trivial);
        }
        cycle.judge();
        let same = cycle.unstable == left.unstable && cycle.unstable == right.unstable;
        let moved = between(self.moved[a], self.moved[b])?;
        (same && cycle.certified).then_some((cycle, moved))
    }
}

/// The error between two, if they agree.
fn wider(x: f64, y: f64) -> Option<f64> {
    let (less, more) = (x.min(y), x.max(y));
    (more <= AGREE * less.max(ROUNDING)).then_some(WIDER * more)
}

/// The error of the multiplier that is nearest to this one.
fn nearest(all: &[Multiplier], to: &Multiplier) -> Option<f64> {
    let near = all.iter().min_by(|a, b| a.distance(to).total_cmp(&b.distance(to)));
    near.and_then(|found| found.error)
}
