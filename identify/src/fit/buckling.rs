//! The search where a curve shows that the shell buckles: starts of hard adhesive shells, led by the jumps.
//!
//! The noise is taken for a hundredth of the largest force at first and for its own at last, and the jumps lead until
//! then ([`super::guide`]):
//!
//! | what is seen | what follows |
//! |---|---|
//! | after [`PROBE`] evaluations a start costs more than [`FAR_BEHIND`] times the best | it goes no farther |
//! | a descent ends within [`NEAR`] | the noise shrinks, in [`STEPS`] |
//! | the end does not describe the curve | the next start |
//! | no start of the first grid leads there | a second grid between its points, the radius kept as it was seen, samples that may be off in travel too |
//!
//! Starts part from the truth where the branch of the shells between them does not lead to the buckled stretch: it
//! passes on to unstable states instead, and the stretch lies on a branch of its own.

use super::descent::{Minimum, descend, descend_from};
use super::guide::Guide;
use super::objective::Objective;
use super::search::{Found, Part, TEMPERED, is_good, limits};
use super::starts::{BUCKLING, Buckling, Look, buckling_grid};
use super::{COARSE, COARSE_ERROR, elements};
use crate::parameters::{Key, Parameters};

/// Starts of a grid that are tried at most.
const STARTS: usize = 8;
/// How many times as much as the best of them a start may cost: one without its jumps costs more.
const START_BEHIND: f64 = 6.0;
/// Most work for a branch; those of shells that buckle turn back and forth.
const LED_WORK: f64 = 1900.0;
/// Evaluations after which starts are compared.
const PROBE: usize = 6;
/// Evaluations of those that are not far behind then.
const FIRST: usize = 24;
/// How many times as much as the best they may cost.
const FAR_BEHIND: f64 = 20.0;
/// Cost up to which an end under the first noise is worth to go on from: half a standard deviation each.
const NEAR: f64 = 0.25;
/// Noise (in that of the beginning) and `σ_X` (in its own) on the way to the end, and most evaluations.
const STEPS: [(f64, f64, usize); 2] = [(0.1, 0.2, 20), (0.02, 0.04, 20)];
/// Evaluations without jumps that lead.
const LAST: usize = 24;

/// Searches where the shell buckles. No minimum is found where no start ends in what describes the curve.
pub(super) fn search(thin: &mut Objective<'_>, look: &Look, guide: &Guide, part: Part) -> Found {
    let (noise, effort, attended) = (thin.noise, thin.model.effort, thin.attended);
    let mut all = Found { minima: Vec::new(), starts: 0, evaluations: 0 };
    for (pass, grid) in BUCKLING.iter().enumerate() {
        let guide = Guide { loose: pass > 0, ..guide.clone() };
        let found = descents(thin, look, &guide, grid, part);
        (thin.noise, thin.model.effort, thin.guide) = (noise, effort, None);
        all.starts += found.starts;
        all.evaluations += found.evaluations;
        all.minima = found.minima;
        if !all.minima.is_empty() || attended.is_stopped() {
            break;
        }
        // progress never falls
        thin.attended.listener = None;
    }
    all
}

fn descents(
    thin: &mut Objective<'_>,
    look: &Look,
    guide: &Guide,
    grid: &Buckling,
    part: Part,
) -> Found {
    let noise = thin.noise;
    let tempered = noise.max(TEMPERED * look.largest);
    soften(thin, tempered, Some(guide.clone()));
    thin.model.effort.work = LED_WORK;
    let starts = buckling_grid(thin, look, grid);
    let mut found = Found { minima: Vec::new(), starts: starts.len(), evaluations: starts.len() };
    let mut best = f64::INFINITY;
    let mut led = if guide.loose { without_radius(thin) } else { thin.clone() };
    for (done, start) in starts.iter().take(STARTS).enumerate() {
        part.tell(thin, done);
        if thin.attended.is_stopped() || start.cost > START_BEHIND * starts[0].cost {
            break;
        }
        let x = led.place(&start.parameters);
        led.model.effort.elements = led_elements(&start.parameters);
        let Some(probe) = descend(&led, &x, None, limits(PROBE)) else { continue };
        found.evaluations += probe.evaluations;
        let mut end = probe;
        if !end.converged && end.at.cost < FAR_BEHIND * best {
            end = descend_from(&led, end.x, end.at, None, limits(FIRST));
            found.evaluations += end.evaluations;
        }
        best = best.min(end.at.cost);
        if end.at.cost > NEAR * thin.count() as f64 {
            continue;
        }
        let from = led.parameters(&end.x);
        found.minima = sharpen(thin, (tempered, noise), guide, &from, &mut found.evaluations);
        if !found.minima.is_empty() {
            break;
        }
    }
    found
}

/// On to the noise of the data; nothing where the end does not describe them.
fn sharpen(
    thin: &mut Objective<'_>,
    (tempered, noise): (f64, f64),
    guide: &Guide,
    from: &Parameters,
    evaluations: &mut usize,
) -> Vec<Minimum> {
    let mut x = thin.place(from);
    let steps = STEPS.map(|(share, tight, most)| {
        let guide = Guide { slack: tight * guide.slack, ..guide.clone() };
        (noise.max(share * tempered), Some(guide), most)
    });
    let mut last = None;
    for (noise, guide, most) in steps.into_iter().chain([(noise, None, LAST)]) {
        soften(thin, noise, guide);
        thin.model.effort.elements = led_elements(&thin.parameters(&x));
        let Some(found) = descend(thin, &x, None, limits(most)) else { return Vec::new() };
        *evaluations += found.evaluations;
        x = found.x.clone();
        last = Some(found);
    }
    last.filter(|found| is_good(thin, found)).into_iter().collect()
}

/// The problem with the radius as it was seen, where it was: shells of twice its size have jumps in the same places.
fn without_radius<'a>(thin: &Objective<'a>) -> Objective<'a> {
    let mut led = thin.clone();
    let Some(prior) = thin.priors.iter().find(|prior| prior.key == Key::Radius) else { return led };
    if let Some(at) = led.free.iter().position(|key| *key == Key::Radius) {
        led.free.remove(at);
        led.bounds.remove(at);
        led.base[Key::Radius] = prior.value;
    }
    led
}

/// Elements of a film length, as a share of the meridian of the radius 1.
const PER_FILM: f64 = 2.8;

/// Elements of a coarse mesh that resolves the film: one that does not has a fold at every node.
pub(super) fn led_elements(p: &Parameters) -> usize {
    let of_film = PER_FILM * p[Key::Radius] / p[Key::Film];
    elements(p, COARSE, 1.0).max(of_film.min(COARSE.1) as usize)
}

/// Takes the noise for `noise`; what a branch may be off by is measured by it.
fn soften(thin: &mut Objective<'_>, noise: f64, guide: Option<Guide>) {
    thin.noise = noise;
    thin.model.effort.force_error = COARSE_ERROR * noise;
    thin.guide = guide;
}
