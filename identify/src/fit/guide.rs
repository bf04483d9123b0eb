//! Jumps that a curve shows, and a cost that leads a search towards them.
//!
//! Samples between a jump of the curve and that of the model are on stretches that do not reach them: no derivative
//! says how to move the fold there. Here the data's jumps say which stretch each sample belongs to, samples beyond
//! its ends cost what they are off there, and each pair of jumps adds a residual
//!
//! ```text
//! r = √w (X_fold − X_jump)/σ_X
//! ```
//!
//! whose derivative is exact: at a fold under the lever the travel does not change along the branch.

use super::starts::Look;
use crate::data::{Curve, Direction};
use crate::lever::{LeverBranch, LeverJump, Reading};
use crate::parameters::{Key, Parameters};

/// Least change of the force from one sample to the next, of the range of forces, that is a jump.
const LEAST: f64 = 0.03;
/// The same in standard deviations of the noise.
const CLEAR: f64 = 20.0;
/// How many times the changes beside it.
const SHARP: f64 = 2.5;

/// A jump in the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// In which segment.
    pub segment: usize,
    /// Height of the piezo between the samples before and after, m.
    pub height: f64,
    /// Force before, N.
    pub before: f64,
    /// By how much it changes, N.
    pub change: f64,
}

/// The jumps of a curve whose noise is known: where the lever gives way the force falls on approach and rises on
/// retract.
pub fn seen(curve: &Curve, noise: f64) -> Vec<Seen> {
    let all = || curve.segments.iter().flat_map(|s| s.force.iter().copied());
    let range = all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min);
    let least = (LEAST * range).max(CLEAR * noise);
    let mut found = Vec::new();
    for (segment, samples) in curve.segments.iter().enumerate() {
        let sign = match samples.direction {
            Direction::Approach => -1.0,
            Direction::Retract => 1.0,
        };
        let change: Vec<f64> = samples.force.windows(2).map(|w| sign * (w[1] - w[0])).collect();
        for (i, &own) in change.iter().enumerate() {
            let beside = [i.checked_sub(1), Some(i + 1)];
            let beside = beside.into_iter().flatten().filter_map(|k| change.get(k));
            let largest = beside.fold(0.0_f64, |m, x| m.max(x.abs()));
            if own > least && own > SHARP * largest {
                let height = 0.5 * (samples.height[i] + samples.height[i + 1]);
                found.push(Seen { segment, height, before: samples.force[i], change: sign * own });
            }
        }
    }
    found
}

/// Largest residual, in standard deviations, of a sample that its stretch does not reach.
pub(super) const UNREACHED: f64 = 15.0;
/// Share of the largest force from which on a shell that jumps buckles, and does not snap in.
const PRESSED: f64 = 0.1;
/// `w`: a fold that is off by `σ_X` weighs as much as this many samples.
const WEIGHT: f64 = 5.0;
/// The same where samples may be off by `σ_X` themselves.
const LOOSE_WEIGHT: f64 = 10.0;
/// Cost of a jump that has no counterpart, as if so many samples were off by its size.
const MISSING: f64 = 20.0;

/// `σ_X` of a travel beyond the onset.
const SLACK: f64 = 0.01;

/// What leads a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    /// The jumps of the data.
    pub jumps: Vec<Seen>,
    /// `σ_X`, m.
    pub slack: f64,
    /// Whether samples, too, may be off by `σ_X`.
    pub loose: bool,
}

/// Where a branch stands beside the data's jumps.
pub(super) struct Guided {
    /// The stretch of each sample.
    pub(super) way: Vec<usize>,
    /// Residuals of folds, with their derivatives by the coordinates of the keys.
    pub(super) folds: Vec<(f64, Vec<f64>)>,
    /// What jumps without counterparts cost.
    pub(super) cost: f64,
}

impl Guide {
    /// The jumps of a curve whose shell gives way on the way in; `None` where it does not. [`Look`] is what the curve
    /// shows without a model.
    pub(super) fn of(curve: &Curve, noise: f64, look: &Look) -> Option<Guide> {
        let jumps = seen(curve, noise);
        let slack = SLACK * (look.onset - curve.nearest()).max(0.0);
        let inwards = jumps.iter().any(|jump| jump.change < 0.0);
        (inwards && look.pull_off > 0.0 && slack > 0.0).then_some(Guide {
            jumps,
            slack,
            loose: false,
        })
    }

    /// Whether the shell gives way under compression: it buckles. A shell that snaps in may do so too, or be soft.
    pub(super) fn is_of_buckling(&self, look: &Look) -> bool {
        let pressed = |jump: &Seen| jump.before - look.offset > PRESSED * look.largest;
        self.jumps.iter().any(|jump| jump.change < 0.0 && pressed(jump))
    }

    /// One over the standard deviation of a sample where the force has the slope `slope` by travel. Beside a fold it is
    /// infinite, and what the travel is off by decides where that is allowed.
    pub(super) fn weight(&self, noise: f64, slope: f64) -> f64 {
        if self.loose { 1.0 / noise.hypot(slope * self.slack) } else { 1.0 / noise }
    }

    /// Pairs the jumps of a curve with those of a branch.
    pub(super) fn pair(
        &self,
        curve: &Curve,
        branch: &LeverBranch,
        p: &Parameters,
        keys: &[Key],
        noise: f64,
    ) -> Guided {
        let contact = p[Key::Contact];
        let deepest = contact - curve.nearest();
        let inwards = branch.jumps(Direction::Approach, 0, deepest);
        let last = inwards.last().map_or(0, |jump| jump.to);
        let outwards = branch.jumps(Direction::Retract, last, contact - curve.farthest());
        let mut guided =
            Guided { way: Vec::with_capacity(curve.len()), folds: Vec::new(), cost: 0.0 };
        for (segment, samples) in curve.segments.iter().enumerate() {
            let (start, modelled) = match samples.direction {
                Direction::Approach => (0, &inwards),
                Direction::Retract => (last, &outwards),
            };
            let seen: Vec<Seen> =
                self.jumps.iter().filter(|jump| jump.segment == segment).copied().collect();
            let pairs = pairs(&seen, modelled, branch);
            let all: f64 = seen.iter().map(|jump| jump.change.powi(2)).sum();
            let paired: f64 = pairs.iter().map(|(jump, _)| jump.change.powi(2)).sum();
            guided.cost += MISSING * (all - paired).max(0.0) / (noise * noise);
            for (seen, jump) in &pairs {
                let fold = branch.fold(jump.from, samples.direction, keys);
                let weight = if self.loose { LOOSE_WEIGHT } else { WEIGHT };
                let scale = weight.sqrt() / self.slack;
                let by_key = keys.iter().zip(&fold.1).map(|(key, by)| match key {
                    Key::Contact => -scale,
                    _ => scale * by,
                });
                guided.folds.push((scale * (fold.0 - contact + seen.height), by_key.collect()));
            }
            follow(
                samples.direction,
                &samples.height,
                contact,
                start,
                &pairs,
                branch,
                &mut guided.way,
            );
        }
        guided
    }
}

/// The largest jumps of both, in the order of time.
fn pairs(seen: &[Seen], modelled: &[LeverJump], branch: &LeverBranch) -> Vec<(Seen, LeverJump)> {
    let n = seen.len().min(modelled.len());
    let mut reading = Reading::default();
    let mut size = |jump: &LeverJump| {
        let mut force = |k: usize| {
            branch.read(&branch.stretches[k], jump.travel, &[], &mut reading);
            reading.force
        };
        (force(jump.to) - force(jump.from)).abs()
    };
    let largest = |sizes: Vec<f64>| -> Vec<usize> {
        let mut order: Vec<usize> = (0..sizes.len()).collect();
        order.sort_by(|a, b| sizes[*b].total_cmp(&sizes[*a]));
        order.truncate(n);
        order.sort_unstable();
        order
    };
    let own = largest(seen.iter().map(|jump| jump.change.abs()).collect());
    let other = largest(modelled.iter().map(&mut size).collect());
    own.into_iter().zip(other).map(|(a, b)| (seen[a], modelled[b])).collect()
}

/// The stretches of a segment's samples: from pair to pair where the data jump, between them where the model does.
fn follow(
    direction: Direction,
    height: &[f64],
    contact: f64,
    start: usize,
    pairs: &[(Seen, LeverJump)],
    branch: &LeverBranch,
    way: &mut Vec<usize>,
) {
    let (mut at, mut next) = (start, 0);
    for &height in height {
        let travel = contact - height;
        let passed = |seen: &Seen| match direction {
            Direction::Approach => height < seen.height,
            Direction::Retract => height > seen.height,
        };
        while pairs.get(next).is_some_and(|(seen, _)| passed(seen)) {
            at = pairs[next].1.to;
            next += 1;
        }
        let limit = pairs.get(next).map(|(_, jump)| jump.from);
        match direction {
            Direction::Approach => {
                let last = limit.unwrap_or(branch.stretches.len() - 1);
                while at < last && travel > branch.stretches[at].to {
                    at += 1;
                }
            }
            Direction::Retract => {
                let last = limit.unwrap_or(0);
                while at > last && travel < branch.stretches[at].from {
                    at -= 1;
                }
            }
        }
        way.push(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Segment;

    /// Forces on the way in, and on the way out.
    fn curve(inwards: &[f64], outwards: &[f64]) -> Curve {
        let height = |n: usize| (0..n).map(|i| -(i as f64)).collect::<Vec<f64>>();
        let segment =
            |direction, force: &[f64], height| Segment { direction, force: force.to_vec(), height };
        let back = height(outwards.len()).into_iter().rev().collect();
        let segments = vec![
            segment(Direction::Approach, inwards, height(inwards.len())),
            segment(Direction::Retract, outwards, back),
        ];
        Curve { segments, ..Curve::default() }
    }

    #[test]
    fn jumps_row_by_row() {
        let ramp = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        for (what, inwards, outwards, found) in [
            ("a ramp", &ramp[..], &[6.0, 5.0, 4.0, 3.0][..], vec![]),
            (
                "the cap gives way",
                &[4.0, 5.0, 6.0, 1.0, 2.0],
                &[2.0, 1.0, 0.5],
                vec![(0, -2.5, -5.0)],
            ),
            ("upwards on the way in", &[0.0, 0.1, 5.0, 5.1], &[5.0, 4.0], vec![]),
            ("it comes off", &[0.0, 1.0, 2.0], &[-1.0, -1.5, -2.0, 0.0, 0.0], vec![(1, -1.5, 2.0)]),
            ("a steep slope", &[0.0, 3.0, 6.0, 4.0, 2.0, 0.0], &[0.0, 0.0], vec![]),
            ("within a thirtieth of the range", &[0.0, 50.0, 100.0, 98.0, 98.0], &[98.0], vec![]),
        ] {
            let seen = seen(&curve(inwards, outwards), 1e-3);
            let seen: Vec<_> = seen.iter().map(|s| (s.segment, s.height, s.change)).collect();
            assert_eq!(seen, found, "{what}");
        }
        // the same in noise is none
        assert!(seen(&curve(&[4.0, 5.0, 6.0, 1.0, 2.0], &[2.0]), 0.5).is_empty());
    }
}
