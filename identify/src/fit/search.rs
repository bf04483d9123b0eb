//! Descents from the starts of the grid, on a coarse mesh and the thinned curve: as many as the curve needs.
//!
//! | what is seen | what follows |
//! |---|---|
//! | after [`PROBE`] evaluations a start costs more than [`BEHIND`] times the best | it goes no farther |
//! | two starts of different bending stiffness end in one minimum that describes the curve | no further starts |
//! | a descent is unfinished, and not [`FAR_BEHIND`] times dearer than one that describes the curve | it goes on |
//! | no minimum of the first round describes the curve | one with the noise taken for a [`TEMPERED`] of the largest force, and on from its ends with its own |
//! | the force jumps under compression | first of all a round that the jumps lead ([`buckling`]) |
//! | it jumps at rest | that round comes second |
//!
//! A curve of little noise on which the force jumps has narrow valleys: farther off than a hundred standard
//! deviations nothing says on which stretch a sample lies. Noise that is taken for more widens them.

use super::descent::{CAREFUL, Limits, Minimum, descend, descend_from};
use super::guide::Guide;
use super::objective::Objective;
use super::starts::{AGAIN, Look, Start, grid};
use super::{COARSE, FEWEST_STARTS, GRID_WORK, ROUGH_WORK, buckling, elements};
use crate::attend::Stage;
use crate::parameters::Key;
use nalgebra::DVector;

/// Starts of a round.
pub(super) const DESCENTS: usize = 6;
/// Least noise of the second round, as a share of the largest force.
pub(super) const TEMPERED: f64 = 0.01;
/// Evaluations after which starts are compared.
const PROBE: usize = 4;
/// Evaluations of those that are not far behind then.
const FIRST: usize = 5;
/// Evaluations of the better half to its end.
const SECOND: usize = 24;
/// How many times as much as the best a start may cost after the first evaluations.
const BEHIND: f64 = 20.0;
/// The same of a descent that goes on to its end, beside a minimum that describes the curve.
const FAR_BEHIND: f64 = 10.0;
/// `χ²/dof` up to which a minimum describes the curve.
const GOOD: f64 = 2.0;
/// Distance of two descents in standard deviations of the thinned curve within which their end is one.
const SAME: f64 = 2.0;
/// Ratio of bending stiffnesses from which on starts are different ones.
const APART: f64 = 2.0;

/// What the descents found.
pub(super) struct Found {
    /// Their ends, the best first.
    pub(super) minima: Vec<Minimum>,
    /// Starts that were compared.
    pub(super) starts: usize,
    /// Evaluations of the model.
    pub(super) evaluations: usize,
}

/// A way of searching.
#[derive(Debug, Clone, Copy)]
enum Round<'a> {
    /// Led by jumps.
    Led(&'a Guide),
    /// From a grid of shells of all kinds.
    Grid,
    /// The same with more noise.
    Tempered,
}

/// The rounds for a curve with these jumps, in their order.
fn rounds<'a>(guide: Option<&'a Guide>, look: &Look) -> Vec<Round<'a>> {
    match guide {
        None => vec![Round::Grid, Round::Tempered],
        Some(guide) if guide.is_of_buckling(look) => vec![Round::Led(guide), Round::Grid],
        Some(guide) => vec![Round::Grid, Round::Led(guide), Round::Tempered],
    }
}

/// From starts to minima, in rounds until one describes the curve; `look` is what the curve shows without a model,
/// and `guide` its jumps.
pub(super) fn search(thin: &mut Objective<'_>, look: &Look, guide: Option<&Guide>) -> Found {
    let (attended, noise) = (thin.attended, thin.noise);
    let rounds = rounds(guide, look);
    let mut all = Found { minima: Vec::new(), starts: 0, evaluations: 0 };
    for (done, round) in rounds.iter().enumerate() {
        let part = Part { first: done * 2 * DESCENTS, of: rounds.len() * 2 * DESCENTS };
        if done > 0 {
            // progress never falls
            thin.attended.listener = None;
        }
        let found = match round {
            Round::Led(guide) => buckling::search(thin, look, guide, part),
            Round::Grid => {
                let starts = usual_grid(thin, look);
                thin.attended = attended;
                descents(thin, &starts, part)
            }
            Round::Tempered => tempered(thin, look, part, noise.max(TEMPERED * look.largest)),
        };
        thin.attended = attended;
        all.starts = all.starts.max(found.starts);
        all.evaluations += found.evaluations;
        all.minima.extend(found.minima);
        all.minima.sort_by(|a, b| a.at.cost.total_cmp(&b.at.cost));
        let good = all.minima.first().is_some_and(|best| is_good(thin, best));
        if good || attended.is_stopped() {
            break;
        }
    }
    all
}

/// Which pieces of the search a round is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    first: usize,
    of: usize,
}

impl Part {
    /// Tells that `done` of the `2 DESCENTS` pieces of the round are done.
    pub(super) fn tell(self, thin: &Objective<'_>, done: usize) {
        thin.attended.tell(Stage::Descents, self.first + done.min(2 * DESCENTS), self.of);
    }
}

fn usual_grid(thin: &mut Objective<'_>, look: &Look) -> Vec<Start> {
    thin.model.effort.work = GRID_WORK;
    let mut starts = grid(thin, look);
    thin.model.effort.work = ROUGH_WORK;
    if starts.len() < FEWEST_STARTS && !thin.attended.is_stopped() {
        starts = grid(thin, look);
    }
    starts
}

/// The round with more noise, if there is less.
fn tempered(thin: &mut Objective<'_>, look: &Look, part: Part, tempered: f64) -> Found {
    let noise = thin.noise;
    if tempered <= noise {
        return Found { minima: Vec::new(), starts: 0, evaluations: 0 };
    }
    thin.noise = tempered;
    let starts = usual_grid(thin, look);
    let mut found = descents(thin, &starts, part);
    thin.noise = noise;
    let mut minima = Vec::new();
    for end in found.minima {
        set_mesh(thin, &end.x);
        if let Some(minimum) = descend(thin, &end.x, None, limits(SECOND)) {
            found.evaluations += minimum.evaluations;
            minima.push(minimum);
        }
    }
    Found { minima, ..found }
}

/// From the best starts: all a little, the better half to its end.
fn descents(thin: &mut Objective<'_>, all: &[Start], part: Part) -> Found {
    let starts = &all[..all.len().min(DESCENTS)];
    let mut evaluations = all.len() + all.len().min(AGAIN);
    let mut minima: Vec<(f64, Minimum)> = Vec::new();
    let mut enough = false;
    for (done, start) in in_turns(starts).into_iter().enumerate() {
        part.tell(thin, done);
        let x = thin.place(&start.parameters);
        set_mesh(thin, &x);
        let Some(probe) = descend(thin, &x, None, limits(PROBE)) else { continue };
        evaluations += probe.evaluations;
        let best = minima.iter().map(|(_, m)| m.at.cost).fold(f64::INFINITY, f64::min);
        let found = match probe.converged || probe.at.cost > BEHIND * best {
            true => probe,
            false => go_on(thin, probe, FIRST, &mut evaluations),
        };
        minima.push((stiffness(start), found));
        if is_enough(thin, &minima) {
            enough = true;
            break;
        }
    }
    minima.sort_by(|a, b| a.1.at.cost.total_cmp(&b.1.at.cost));
    let mut minima: Vec<Minimum> = minima.into_iter().map(|(_, minimum)| minimum).collect();
    minima.truncate(if enough { 1 } else { DESCENTS / 2 });
    let mut best = f64::INFINITY;
    for (done, minimum) in minima.iter_mut().enumerate() {
        part.tell(thin, DESCENTS + 2 * done);
        if !minimum.converged && minimum.at.cost <= FAR_BEHIND * best {
            // on the mesh of where it is now: costs of another mesh are not comparable
            set_mesh(thin, &minimum.x);
            if let Some(found) = descend(thin, &minimum.x, None, limits(SECOND)) {
                evaluations += found.evaluations;
                *minimum = found;
            }
        }
        if is_good(thin, minimum) {
            best = best.min(minimum.at.cost);
        }
    }
    minima.sort_by(|a, b| a.at.cost.total_cmp(&b.at.cost));
    Found { minima, starts: all.len(), evaluations }
}

/// Starts of different stiffness in turns, the best of each first: so two of them soon agree.
fn in_turns(starts: &[Start]) -> Vec<&Start> {
    let mut turns: Vec<(usize, &Start)> = Vec::new();
    for start in starts {
        let alike = |other: &&(usize, &Start)| {
            (stiffness(other.1) / stiffness(start)).ln().abs() < APART.ln()
        };
        turns.push((turns.iter().filter(alike).count(), start));
    }
    // stable: the order of cost stays within a turn
    turns.sort_by_key(|(turn, _)| *turn);
    turns.into_iter().map(|(_, start)| start).collect()
}

/// Numbers of a coarse mesh have an error of some tenths in the cost, and three tenths of the thinned curve are about
/// a standard deviation of the whole one: the rest is the polish's.
pub(super) fn limits(evaluations: usize) -> Limits {
    Limits { evaluations, tolerance: 0.3, damping: CAREFUL }
}

pub(super) fn set_mesh(thin: &mut Objective<'_>, x: &DVector<f64>) {
    thin.model.effort.elements = elements(&thin.parameters(x), COARSE, 1.0);
}

/// The descent goes on from where it is.
fn go_on(thin: &Objective<'_>, minimum: Minimum, most: usize, evaluations: &mut usize) -> Minimum {
    let found = descend_from(thin, minimum.x, minimum.at, None, limits(most));
    *evaluations += found.evaluations;
    found
}

/// `k_b/χ` of a start.
fn stiffness(start: &Start) -> f64 {
    start.parameters[Key::Bending] / start.parameters[Key::Chi]
}

/// Whether a minimum describes the curve.
pub(super) fn is_good(thin: &Objective<'_>, minimum: &Minimum) -> bool {
    let dof = thin.count().saturating_sub(thin.free.len()).max(1);
    minimum.at.cost <= GOOD * dof as f64
}

/// Whether two different starts have ended in one minimum that describes the curve.
fn is_enough(thin: &Objective<'_>, minima: &[(f64, Minimum)]) -> bool {
    let Some(((last_stiffness, last), others)) = minima.split_last() else { return false };
    is_good(thin, last)
        && others.iter().any(|(stiffness, other)| {
            let d: DVector<f64> = &last.x - &other.x;
            let distance = d.dot(&(&last.at.normal * &d)).max(0.0).sqrt();
            let apart = (stiffness / last_stiffness).ln().abs() > APART.ln();
            apart && is_good(thin, other) && distance < SAME
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::guide::Seen;

    #[test]
    fn rounds_row_by_row() {
        let look = Look {
            offset: 2.0,
            tilt: 0.0,
            onset: 0.0,
            pull_off: 1.0,
            stiffness: 1.0,
            largest: 10.0,
            in_contact: 100,
            baseline: 100,
        };
        let guide = |before: f64| {
            let jumps = vec![Seen { segment: 0, height: 0.0, before, change: -3.0 }];
            Guide { jumps, slack: 1.0, loose: false }
        };
        let (pressed, resting) = (guide(4.0), guide(2.5));
        for (guide, names) in [
            (None, "Grid Tempered"),
            (Some(&pressed), "Led Grid"),
            (Some(&resting), "Grid Led Tempered"),
        ] {
            let rounds = rounds(guide, &look);
            let name = |round: &Round<'_>| match round {
                Round::Led(_) => "Led",
                Round::Grid => "Grid",
                Round::Tempered => "Tempered",
            };
            assert_eq!(rounds.iter().map(name).collect::<Vec<_>>().join(" "), names);
        }
    }
}
