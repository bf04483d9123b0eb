//! Where descents begin: what the curve shows without a model, and a grid of shells that fit it roughly.
//!
//! A dimensionless branch of a shell is traced once; how far it must be stretched in force (`√(χ k_b)`) and
//! shifted (contact point, baseline) to lie on the data is a fit of four numbers that needs no further
//! branch.

use super::buckling::led_elements;
use super::objective::Objective;
use crate::attend::Stage;
use crate::data::{Curve, Direction, Segment};
use crate::parameters::{Key, Parameters};

/// Bending stiffnesses `k̂_b` of the grid: from `h/R0` = 0.005 to 0.3.
const BENDING: [f64; 6] = [3e-6, 2e-5, 1e-4, 6e-4, 3e-3, 1.2e-2];
/// Film lengths `δ̂_A` of the grid.
const FILM: [f64; 3] = [0.008, 0.02, 0.045];

/// Starts that are laid on the data a second time.
pub(super) const AGAIN: usize = 9;

/// What a curve shows without a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Baseline at the farthest sample, N.
    pub offset: f64,
    /// Its slope by approach, N/m.
    pub tilt: f64,
    /// Height where the force rises through zero on the way in (or begins to rise), m.
    pub onset: f64,
    /// Most attractive force, as a positive number, N; 0 if it is within the noise.
    pub pull_off: f64,
    /// Stiffness of the bubble after the onset, one pole against the other, the lever's taken away, N/m.
    pub stiffness: f64,
    /// Largest force, N.
    pub largest: f64,
    /// Samples in contact.
    pub in_contact: usize,
    /// Samples of baseline.
    pub baseline: usize,
}

/// Share of the approach's travel that is taken for baseline at first.
const FAR: f64 = 0.2;

/// Looks at a curve with noise `noise` under a lever of stiffness `lever`.
pub fn look(curve: &Curve, noise: f64, lever: f64) -> Option<Look> {
    let first = curve.segments.first()?;
    let span = curve.farthest() - curve.nearest();
    let far = curve.farthest();
    // approach if there is one: what comes back may still stick
    let main = curve.segments.iter().find(|s| s.direction == Direction::Approach).unwrap_or(first);
    let mut points: Vec<(f64, f64)> =
        main.height.iter().zip(&main.force).map(|(h, f)| (far - h, *f)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let count = points.iter().take_while(|p| p.0 < FAR * span).count().max(4).min(points.len());
    let (offset, tilt) = line(&points[..count]);
    let level: Vec<(f64, f64)> = points.iter().map(|(x, f)| (*x, f - offset - tilt * x)).collect();
    let largest = level.iter().fold(0.0_f64, |m, p| m.max(p.1));
    let threshold = (5.0 * noise).max(0.01 * largest);
    // from the deepest sample outwards: the last one that is clearly in compression
    let above = level.iter().rev().take_while(|p| p.1 > threshold).count();
    let edge = level.len() - above;
    let inside = &level[edge..];
    if inside.len() < 3 {
        return None;
    }
    let rise: Vec<(f64, f64)> =
        inside.iter().take_while(|p| p.1 < 0.3 * largest).copied().collect();
    let rise = if rise.len() >= 3 { rise } else { inside[..3.max(inside.len() / 4)].to_vec() };
    let (at_zero, slope) = line(&rise);
    let onset = if slope > 0.0 { -at_zero / slope } else { inside[0].0 };
    let seen = slope.max(1e-3 * lever).min(0.95 * lever);
    let attraction = |s: &Segment| {
        s.height
            .iter()
            .zip(&s.force)
            .map(|(h, f)| f - offset - tilt * (far - h))
            .fold(0.0_f64, f64::min)
    };
    let deepest = curve.segments.iter().map(attraction).fold(0.0_f64, f64::min);
    Some(Look {
        offset,
        tilt,
        onset: far - onset,
        pull_off: if -deepest > 5.0 * noise { -deepest } else { 0.0 },
        stiffness: 1.0 / (1.0 / seen - 1.0 / lever),
        largest,
        in_contact: inside.len(),
        baseline: level.len() - inside.len(),
    })
}

/// Least-squares line: value at zero and slope.
fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let (mut sxx, mut sxy) = (0.0, 0.0);
    for (x, y) in points {
        sxx += (x - mx) * (x - mx);
        sxy += (x - mx) * (y - my);
    }
    let slope = if sxx > 0.0 { sxy / sxx } else { 0.0 };
    (my - slope * mx, slope)
}

/// A start.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// Its parameters.
    pub parameters: Parameters,
    /// Cost there, of the thinned curve.
    pub cost: f64,
}

/// The grid, each point laid on the data as well as it goes, the best first. `known` are those shells that
/// the laboratory gives itself.
pub fn grid(objective: &Objective<'_>, look: &Look) -> Vec<Start> {
    let p = objective.base;
    let free = |key: Key| objective.free.contains(&key);
    let radius = p[Key::Radius];
    let contacts = f64::from(objective.model.contacts);
    // both poles in series: F = 8 √(χk_b)/R0 Δ, Eq. (32)
    let scale = look.stiffness * contacts * radius / 8.0;
    let given = |key: Key| p[key].is_finite().then_some(p[key]);
    let bending: Vec<f64> = match (given(Key::Chi), given(Key::Bending)) {
        (Some(chi), Some(k)) => vec![k / (chi * radius * radius)],
        _ => BENDING.to_vec(),
    };
    let films: Vec<f64> = match given(Key::Film) {
        Some(film) => vec![film],
        None => FILM.iter().map(|f| f * radius).collect(),
    };
    let mut starts = Vec::new();
    let total = bending.len() * films.len();
    for (row, b) in bending.into_iter().enumerate() {
        for (column, &film) in films.iter().enumerate() {
            objective.attended.tell(Stage::Starts, row * films.len() + column, total);
            if objective.attended.is_stopped() {
                break;
            }
            let mut p = p;
            // k̂_b = k_b/(χR0²) and S² = χ k_b
            let root = b.sqrt() * radius;
            if free(Key::Chi) || !p[Key::Chi].is_finite() {
                p[Key::Chi] = given(Key::Chi).unwrap_or(scale / root);
            }
            if free(Key::Bending) || !p[Key::Bending].is_finite() {
                p[Key::Bending] = given(Key::Bending).unwrap_or(scale * root);
            }
            p[Key::Film] = film;
            if !p[Key::Adhesion].is_finite() {
                // Derjaguin: the pull-off is 2π R0 w0; nothing seen: a tenth of what would be
                let seen = if look.pull_off > 0.0 { look.pull_off } else { objective.noise };
                p[Key::Adhesion] = seen / (2.0 * std::f64::consts::PI * radius) * 1.15;
            }
            (p[Key::Offset], p[Key::Tilt]) = (look.offset, look.tilt);
            // at zero force the plates are about two film lengths more than 2 R0 apart
            p[Key::Contact] = look.onset - contacts * film;
            if let Some(start) = lay(objective, p) {
                starts.push(start);
            }
        }
    }
    starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    // the branch of one shell serves until the force scale has moved by half: once more, where it may matter
    for start in starts.iter_mut().take(AGAIN) {
        if let Some(again) =
            lay(objective, start.parameters).filter(|again| again.cost < start.cost)
        {
            *start = again;
        }
    }
    starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    starts
}

/// A grid of shells that buckle.
#[derive(Debug)]
pub(super) struct Buckling {
    /// Bending stiffnesses `k̂_b`.
    bending: &'static [f64],
    /// Adhesion, of the stretching modulus.
    adhesion: &'static [f64],
    /// Film lengths `δ̂_A`.
    film: &'static [f64],
}

/// A first grid, and one that lies between its points.
pub(super) const BUCKLING: [Buckling; 2] = [
    Buckling {
        bending: &[1e-5, 4e-5, 1.6e-4],
        adhesion: &[6e-4, 1.5e-3, 4e-3, 1e-2],
        film: &[0.025, 0.045],
    },
    Buckling {
        bending: &[1e-5, 2e-5, 3e-5, 5.5e-5],
        adhesion: &[9e-4, 1.5e-3, 2.7e-3, 4.5e-3],
        film: &[0.02, 0.032, 0.045],
    },
];
/// Pull-off force of hard shells in `2π R0 w0`, of which it is 0.90 to 0.95.
const PULL_OFF: f64 = 0.93;

/// A grid for shells that buckle, the best first. Jumps hide the slope of the first contact, and the scale of the
/// force is not read off it: the pull-off says the adhesion, and each share of it in the stretching modulus is a
/// shell of its own scale, which stays.
pub(super) fn buckling_grid(
    objective: &mut Objective<'_>,
    look: &Look,
    grid: &Buckling,
) -> Vec<Start> {
    let base = objective.base;
    let radius = base[Key::Radius];
    let contacts = f64::from(objective.model.contacts);
    let given = |key: Key| (!objective.free.contains(&key)).then_some(base[key]);
    let pull = look.pull_off / (2.0 * std::f64::consts::PI * PULL_OFF * radius);
    let adhesion = given(Key::Adhesion).unwrap_or(pull);
    let moduli: Vec<f64> = match given(Key::Chi) {
        Some(chi) => vec![chi],
        None => grid.adhesion.iter().map(|share| adhesion / share).collect(),
    };
    let films: Vec<f64> = match given(Key::Film) {
        Some(film) => vec![film],
        None => grid.film.iter().map(|film| film * radius).collect(),
    };
    let mut shells = Vec::new();
    for &chi in &moduli {
        match given(Key::Bending) {
            Some(bending) => shells.push((chi, bending)),
            None => {
                let all = grid.bending.iter().map(|b| (chi, b * chi * radius * radius));
                shells.extend(all);
            }
        }
    }
    let mut starts = Vec::new();
    for (row, &(chi, bending)) in shells.iter().enumerate() {
        for (column, &film) in films.iter().enumerate() {
            let done = row * films.len() + column;
            objective.attended.tell(Stage::Starts, done, shells.len() * films.len());
            if objective.attended.is_stopped() {
                break;
            }
            let mut p = base;
            (p[Key::Chi], p[Key::Bending]) = (chi, bending);
            (p[Key::Adhesion], p[Key::Film]) = (adhesion, film);
            (p[Key::Offset], p[Key::Tilt]) = (look.offset, look.tilt);
            p[Key::Contact] = look.onset - contacts * film;
            objective.model.effort.elements = led_elements(&p);
            starts.extend(lay(objective, p));
        }
    }
    starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    starts
}

/// Stretches and shifts a branch to lie on the data; only shifts it where jumps lead.
fn lay(objective: &Objective<'_>, mut p: Parameters) -> Option<Start> {
    let keys = [Key::Chi, Key::Contact, Key::Offset, Key::Tilt];
    let attended = objective.attended;
    let (branch, _) = objective.model.branch_attended(objective.curve, &p, &[], attended).ok()?;
    let mut own = objective.clone();
    own.free = keys.to_vec();
    own.priors.clear();
    own.derived.clear();
    own.bounds = vec![(f64::NEG_INFINITY, f64::INFINITY); keys.len()];
    own.robust = true;
    let stretches = objective.guide.is_none();
    let free = (0..keys.len()).filter(|&k| objective.free.contains(&keys[k]));
    let free: Vec<usize> = free.filter(|&k| stretches || keys[k] != Key::Chi).collect();
    let mut damping = 1e-2;
    let evaluate = |p: &Parameters| Some(own.of_data(&branch.stretched(p)?, p));
    let mut at = evaluate(&p)?;
    for _ in 0..25 {
        let m = free.len();
        let mut matrix = nalgebra::DMatrix::zeros(m, m);
        let mut rhs = nalgebra::DVector::zeros(m);
        for (i, &a) in free.iter().enumerate() {
            for (j, &b) in free.iter().enumerate() {
                matrix[(i, j)] = at.normal[(a, b)];
            }
            matrix[(i, i)] *= 1.0 + damping;
            rhs[i] = -at.gradient[a];
        }
        let Some(step) = matrix.lu().solve(&rhs) else { break };
        let mut next = p;
        for (i, &a) in free.iter().enumerate() {
            match keys[a] {
                // the scale of the force: both moduli alike, so that the shell's shape stays
                Key::Chi => {
                    // the derivative by ln χ is half of that by ln S where the shape stays
                    let factor = (0.5 * step[i]).clamp(-0.5, 0.5).exp();
                    next[Key::Chi] *= factor;
                    next[Key::Bending] *= factor;
                    next[Key::Adhesion] *= factor;
                }
                key => next[key] += step[i],
            }
        }
        match evaluate(&next) {
            Some(tried) if tried.cost < at.cost => {
                let gain = at.cost - tried.cost;
                (p, at) = (next, tried);
                damping *= 0.2;
                if gain < 1e-3 * at.cost {
                    break;
                }
            }
            _ => damping *= 6.0,
        }
        if damping > 1e6 {
            break;
        }
    }
    Some(Start { parameters: p, cost: at.cost })
}
