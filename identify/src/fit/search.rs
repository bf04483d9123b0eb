//! Descents from the starts of the grid, on a coarse mesh and the thinned curve: as many as the curve needs.
//!
//! | what is seen | what follows |
//! |---|---|
//! | after [`PROBE`] evaluations a start costs more than [`BEHIND`] times the best | it goes no farther |
//! | two starts of different bending stiffness end in one minimum that describes the curve | no further starts |
//! | a descent is unfinished, and not [`FAR_BEHIND`] times dearer than one that describes the curve | it goes on |
//! | no minimum of the first round describes the curve | a second one with the noise taken for a [`TEMPERED`] of the largest force, and on from its ends with its own |
//!
//! A curve of little noise on which the force jumps has narrow valleys: farther off than a hundred standard
//! deviations nothing says on which stretch a sample lies. Noise that is taken for more widens them.

use super::descent::{CAREFUL, Limits, Minimum, descend, descend_from};
use super::objective::Objective;
use super::starts::{AGAIN, Look, Start, grid};
use super::{COARSE, elements};
use crate::attend::Stage;
use crate::parameters::Key;
use nalgebra::DVector;

/// Starts of a round.
const DESCENTS: usize = 6;
/// Rounds.
const ROUNDS: usize = 2;
/// Least noise of the second round, as a share of the largest force.
const TEMPERED: f64 = 0.01;
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
    /// Evaluations of the model.
    pub(super) evaluations: usize,
}

/// Descends from the starts, the best first; `look` is what the curve shows without a model.
pub(super) fn search(thin: &mut Objective<'_>, starts: &[Start], look: &Look) -> Found {
    let mut all = descents(thin, &starts[..starts.len().min(DESCENTS)], 0);
    let noise = thin.noise;
    let tempered = noise.max(TEMPERED * look.largest);
    let good = all.minima.first().is_some_and(|best| is_good(thin, best));
    if good || thin.attended.is_stopped() || tempered <= noise {
        return all;
    }
    thin.noise = tempered;
    let starts = grid(thin, look);
    let found = descents(thin, &starts[..starts.len().min(DESCENTS)], 1);
    thin.noise = noise;
    all.evaluations += starts.len() + starts.len().min(AGAIN) + found.evaluations;
    for end in found.minima {
        set_mesh(thin, &end.x);
        if let Some(minimum) = descend(thin, &end.x, None, limits(SECOND)) {
            all.evaluations += minimum.evaluations;
            all.minima.push(minimum);
        }
    }
    all.minima.sort_by(|a, b| a.at.cost.total_cmp(&b.at.cost));
    all
}

/// One round: all a little, the better half to its end.
fn descents(thin: &mut Objective<'_>, starts: &[Start], round: usize) -> Found {
    let (pieces, before) = (ROUNDS * 2 * DESCENTS, round * 2 * DESCENTS);
    let mut evaluations = 0;
    let mut minima: Vec<(f64, Minimum)> = Vec::new();
    let mut enough = false;
    for (done, start) in in_turns(starts).into_iter().enumerate() {
        thin.attended.tell(Stage::Descents, before + done, pieces);
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
        thin.attended.tell(Stage::Descents, before + DESCENTS + 2 * done, pieces);
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
    Found { minima, evaluations }
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
fn limits(evaluations: usize) -> Limits {
    Limits { evaluations, tolerance: 0.3, damping: CAREFUL }
}

fn set_mesh(thin: &mut Objective<'_>, x: &DVector<f64>) {
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
fn is_good(thin: &Objective<'_>, minimum: &Minimum) -> bool {
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
