//! Folds of higher order: `p − p₀ ~ s^k`, `k = 4, 6, …`, where dp/ds is so flat that rounding hides its
//! zero. The place is read from where dp/ds is large enough, on both sides: its root of order `k − 1` is
//! smooth there, and passes zero at the fold.

use super::locate::{bend, interpolate};
use crate::step::{Constraint, Core, Precision, Refusal, State};
use std::f64::consts::FRAC_1_SQRT_2;

/// The first distance from the fold, in terms of the step: the ends of one across a plateau are hardly
/// off it, and the branch is straight.
const FAR: f64 = 2.0;
/// How often the place is centred by the first distances.
const CENTRINGS: usize = 4;
/// Offset, as a part of the shortest distance, that is centred.
const CENTRED: f64 = 0.1;
/// How often the distance shrinks by `√2`.
const RUNGS: i32 = 40;
/// Distance of a measured order from an odd number that it may be, in so many successive measurements.
const NEAR: f64 = 0.35;
const SUCCESSIVE: usize = 3;

/// What the surroundings of a fold say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flat {
    /// `k`, even; `None` where it does not show, and the place is only bracketed.
    pub(crate) order: Option<usize>,
    /// Scaled distance from the step's first end.
    pub(crate) at: f64,
    /// Estimated error of it.
    pub(crate) error: f64,
}

/// dp/ds on both sides of the supposed fold, at equal distances.
#[derive(Debug, Clone, Copy)]
struct Rung {
    distance: f64,
    before: f64,
    after: f64,
}

impl Rung {
    fn size(&self) -> f64 {
        self.before.abs() + self.after.abs()
    }

    fn brackets(&self) -> bool {
        self.before * self.after < 0.0
    }

    /// Offset of the zero of a function that is a power `m` on both sides.
    fn offset(&self, m: f64) -> f64 {
        let root = |g: f64| g.abs().powf(1.0 / m);
        let (before, after) = (root(self.before), root(self.after));
        self.distance * (before - after) / (before + after)
    }
}

/// Order and place of the fold near `at` in the step of length `h` from `a` to `b`, where dp/ds is in
/// error by `missed`.
pub(crate) fn flat_fold(
    core: &mut Core<'_>,
    (a, b): (&State, &State),
    h: f64,
    (mut at, missed): (f64, f64),
    x: &mut State,
) -> Result<Flat, Refusal> {
    let bend = bend(core, a, b);
    let rounding = (4.0 * f64::EPSILON * core.weights.parameter).max(missed);
    let mut rung = |at: f64, distance: f64| {
        let mut slope = |at: f64| {
            interpolate(a, b, h, bend, at, x);
            core.correct(Constraint::Plane(a, at), x, Precision::Event).map(|_| x.tp)
        };
        Ok(Rung { distance, before: slope(at - distance)?, after: slope(at + distance)? })
    };
    // on a plateau the place itself is one of many; centred from far to near it is seen better and better
    let mut last: Option<Rung> = None;
    for k in 0..RUNGS {
        let Ok(now) = rung(at, FAR * h * FRAC_1_SQRT_2.powi(k)) else { continue };
        if !now.brackets() {
            break;
        }
        if let Some(last) = last.replace(now) {
            let order = 2.0 * (last.size() / now.size()).log2();
            if order < 0.5 {
                break;
            }
            at = (at + now.offset(order.max(1.0))).clamp(0.0, h);
        }
    }
    // it lies between slopes of opposite signs that are more than rounding, wherever that is
    let clear = |rung: &&Rung| rung.before.abs().min(rung.after.abs()) > rounding;
    let mut found = Flat { order: None, at, error: h };
    for _ in 0..CENTRINGS {
        let rungs = ladder(&mut rung, at, h, rounding)?;
        let Some((flat, offset)) = read(&rungs, at, missed) else {
            if found.order.is_none() {
                let nearest = rungs.iter().rev().find(clear).map(|rung| rung.distance);
                found = Flat { order: None, at, error: nearest.unwrap_or(h) };
            }
            break;
        };
        found = flat;
        let finest = rungs.last().map_or(0.0, |rung| rung.distance);
        if offset.abs() < CENTRED * finest || !(flat.at > 0.0 && flat.at < h) {
            break;
        }
        at = flat.at;
    }
    Ok(found)
}

/// Slopes at smaller and smaller distances from `at`, as long as they have opposite signs and are more
/// than `rounding`.
fn ladder(
    rung: &mut impl FnMut(f64, f64) -> Result<Rung, Refusal>,
    at: f64,
    h: f64,
    rounding: f64,
) -> Result<Vec<Rung>, Refusal> {
    let reach = at.min(h - at);
    let mut rungs: Vec<Rung> = Vec::new();
    for k in 0..RUNGS {
        let distance = FAR * h * FRAC_1_SQRT_2.powi(k);
        match rung(at, distance) {
            Ok(rung) if rung.brackets() && rung.size() > rounding => rungs.push(rung),
            Err(refusal) if distance < reach => return Err(refusal),
            _ if distance < reach => break,
            // beyond the step it may be another branch's
            _ => rungs.clear(),
        }
    }
    Ok(rungs)
}

/// Order and place from slopes around `at`, and the offset of the place.
fn read(rungs: &[Rung], at: f64, missed: f64) -> Option<(Flat, f64)> {
    let odd = |m: f64| {
        let k = m.round();
        ((m - k).abs() < NEAR && k >= 1.0 && k % 2.0 == 1.0).then_some(k as usize)
    };
    let measured: Vec<Option<usize>> = orders(rungs).map(odd).collect();
    let same = |k: &[Option<usize>]| k[0].is_some() && k.iter().all(|m| *m == k[0]);
    let finest = measured.windows(SUCCESSIVE).rposition(same)?;
    let m = measured[finest]?;
    // rounding makes dp/ds less flat on the way to the fold, never flatter
    if orders(rungs).skip(finest + SUCCESSIVE).any(|later| later > m as f64 + 1.0) {
        return None;
    }
    // the next term makes an error of second order in the distance, which halves
    let offsets: Vec<f64> = rungs.iter().map(|rung| rung.offset(m as f64)).collect();
    let places: Vec<f64> = offsets.windows(2).map(|w| 2.0 * w[1] - w[0]).collect();
    let change: Vec<f64> = places.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    // of an error of the slopes at the rung, which the extrapolation magnifies
    let blur = |k: usize| 8.0 * missed * rungs[k].distance / (m as f64 * rungs[k].size());
    // what passes zero by chance is larger beside it
    let around = |k: usize| &change[k.saturating_sub(1)..(k + 2).min(change.len())];
    let error = |k: usize| 2.0 * crate::linalg::max_abs(around(k)) + blur(k + 1);
    let best = (0..change.len()).min_by(|&i, &j| error(i).total_cmp(&error(j)))?;
    let (offset, error) = (places[best + 1], error(best).max(f64::EPSILON * (1.0 + at)));
    Some((Flat { order: Some(m + 1), at: at + offset, error }, offset))
}

/// The orders of dp/ds between successive rungs.
fn orders(rungs: &[Rung]) -> impl DoubleEndedIterator<Item = f64> + '_ {
    rungs.windows(2).map(|w| 2.0 * (w[0].size() / w[1].size()).log2())
}
