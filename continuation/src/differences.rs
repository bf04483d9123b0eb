//! Derivatives of a residual by differences: steps that are judged where they are used.
//!
//! Central differences at `h`, `2h` and `4h`, extrapolated to order six. Whether `h` suits a function
//! is read from nothing but its values at these places: by how far the orders two, four and six are
//! apart, by whether the even polynomial through the places meets the value in the middle (an odd
//! difference alone does not see a peak between its places), and by the rounding of the function, which
//! is measured by moving all arguments by a unit in the last place. A ladder of steps, from that of
//! the variable's own magnitude up where rounding prevails and down where the function is not
//! resolved, ends at the first step that is good to [`ENOUGH`], or takes the best. Every component has
//! a step of its own, so that the columns of one colour are found together. Nothing is remembered.

use crate::problem::{EvalError, ParamId, Problem};

/// Where a rung evaluates, in steps.
const PLACES: [f64; 6] = [1.0, -1.0, 2.0, -2.0, 4.0, -4.0];
/// The first rung: its step is `2^FIRST` of the variable's magnitude. A pole one magnitude away is
/// then resolved to 1e-13.
const FIRST: i32 = -8;
/// The first jump between rungs; later ones are longer, up to the next bracket.
const JUMP: i32 = 3;
/// The rungs end here: a step is at least this power of two of the variable's magnitude, at most that.
const RUNGS: (i32, i32) = (-60, 60);
/// Two decades above the first rung, beyond which a function that is flat is not asked.
const FLAT: i32 = FIRST + 8;
/// Most rungs of one column or colour.
const MOST: usize = 24;
/// Estimated error, relative to the mean slope over the places, that ends the search.
const ENOUGH: f64 = 1e-11;
/// What does not fall as steps become shorter is rounding if it is below this part of the values.
const NOISE: f64 = 1e-4;
/// Disagreement, relative to the variation over the places, above which a step resolves nothing.
const UNRESOLVED: f64 = 0.02;
/// Truncation below which a function is smooth on the scale of a step, and slope in the middle from which
/// on it is straight there, relative to the mean slope.
const SMOOTH: f64 = 1e-6;
const STRAIGHT: f64 = 0.5;
/// A value smaller than this part of the largest unknown may be rounding.
const SMALL: f64 = 1e-4;
/// Errors of two rungs by which their values may differ.
const CONTRADICTION: f64 = 4.0;
/// Moves of all arguments by which rounding is measured.
const MOVES: usize = 3;
/// Longer moves, as parts of the unknowns, and how much shorter ones are compared; in irregular
/// places, since those of powers of two may share their rounding.
const WIGGLE: f64 = 1.0 / 67_108_864.0;
const SHORTER: f64 = 8.0;
const IRREGULAR: [f64; 3] = [1.0, -1.618, 2.731];

/// Unknowns below this may all be rounding; if they are not, shorter steps are found.
const VANISHES: f64 = 1e-10;

/// A rung of the ladder that is not known.
const UNKNOWN: i32 = i32::MAX;

/// The magnitudes of unknowns; `vanishing` where all are rounding, so that they have none.
pub(crate) fn magnitudes(u: &[f64], vanishing: f64, unit: &mut [f64]) {
    let largest = crate::linalg::max_abs(u);
    for (unit, u) in unit.iter_mut().zip(u) {
        *unit = if largest < VANISHES { vanishing } else { magnitude(*u, largest) };
    }
}

/// Whether a value is so small beside its unit that its last place says nothing.
fn is_small(value: f64, unit: f64) -> bool {
    value.abs() < VANISHES * unit
}

/// The magnitude of a variable, a power of two, by which its steps are measured: steps that are
/// powers of two themselves shift values exactly. `other` stands in for a value that may be rounding.
pub(crate) fn magnitude(value: f64, other: f64) -> f64 {
    let (own, other) = (value.abs(), other.abs());
    let size = if own >= SMALL * other { own } else { other };
    if size.is_finite() && size > 1e-40 { size.log2().round().exp2() } else { 1.0 }
}

/// Work space for the derivatives along one group of variables at a time.
pub(crate) struct Ladder {
    centre: Vec<f64>,
    /// Rounding error of a value, by row.
    noise: Vec<f64>,
    learnt: Vec<f64>,
    values: [Vec<f64>; 6],
    /// Magnitude of the variable that a row depends on; 0 if it depends on none of the group.
    pub(crate) unit: Vec<f64>,
    /// What was found, by row.
    pub(crate) derivative: Vec<f64>,
    /// Bound of its error, by row.
    pub(crate) error: Vec<f64>,
    size: Vec<f64>,
    /// Longest step so far on which rounding prevails, shortest one that does not resolve.
    low: Vec<i32>,
    high: Vec<i32>,
    /// The truncation on the latter.
    coarse: Vec<f64>,
    open: Vec<bool>,
    resolved: Vec<bool>,
}

/// What one rung says of one row.
struct Estimate {
    value: f64,
    rounding: f64,
    truncation: f64,
    /// Mean slope over the places.
    size: f64,
    /// Whether the places follow a polynomial at all.
    resolved: bool,
}

impl Ladder {
    pub(crate) fn new(n: usize) -> Self {
        let vector = || vec![0.0; n];
        Ladder {
            centre: vector(),
            noise: vector(),
            learnt: vector(),
            values: std::array::from_fn(|_| vector()),
            unit: vector(),
            derivative: vector(),
            error: vector(),
            size: vector(),
            low: vec![UNKNOWN; n],
            high: vec![UNKNOWN; n],
            coarse: vector(),
            open: vec![false; n],
            resolved: vec![false; n],
        }
    }

    /// Takes the value at `u` and `p` and its rounding errors, with `unit` the magnitudes of `u`. `place` and
    /// `values` are work space: copies of `u` and `p` before and after.
    pub(crate) fn look(
        &mut self,
        (u, p): (&[f64], &[f64]),
        (place, values): (&mut [f64], &mut [f64]),
        unit: &[f64],
        mut f: impl FnMut(&[f64], &[f64], &mut [f64]),
    ) {
        self.centre(|turn, r| {
            for (k, (place, u)) in place.iter_mut().zip(u).enumerate() {
                *place = moved(*u, k, turn);
            }
            for (k, (value, p)) in values.iter_mut().zip(p).enumerate() {
                *value = moved(*p, u.len() + k, turn);
            }
            f(place, values, r);
        });
        values.copy_from_slice(p);
        self.hidden(|multiple, r| {
            for (k, (place, u)) in place.iter_mut().zip(u).enumerate() {
                *place = u + multiple * sign(k, 1) * u;
            }
            f(place, values, r);
        });
        if u.iter().zip(unit).any(|(u, unit)| is_small(*u, *unit)) {
            self.small_arguments(|multiple, r| {
                for (k, ((place, u), unit)) in place.iter_mut().zip(u).zip(unit).enumerate() {
                    let small = is_small(*u, *unit);
                    *place = u + if small { multiple * sign(k, 1) * unit } else { 0.0 };
                }
                f(place, values, r);
            });
        }
        place.copy_from_slice(u);
    }

    /// The value in the middle and its rounding errors. `f` evaluates with all arguments moved by
    /// the signs of a move, in units of their last place; move 0 is the state itself.
    fn centre(&mut self, mut f: impl FnMut(usize, &mut [f64])) {
        f(0, &mut self.centre);
        self.noise.fill(0.0);
        for k in 1..=MOVES {
            let moved = &mut self.values[0];
            f(k, moved);
            for ((noise, a), b) in self.noise.iter_mut().zip(&self.centre).zip(moved.iter()) {
                let change = (a - b).abs();
                if change.is_finite() {
                    *noise = noise.max(change);
                }
            }
        }
        for (noise, value) in self.noise.iter_mut().zip(&self.centre) {
            *noise = 2.0 * *noise + f64::EPSILON * value.abs();
        }
    }

    /// Rounding errors of what lies between the arguments and the function: a displacement added to a
    /// place that is larger shows them only where it moves by more than its own last place. They are
    /// what is left of a straight line along a short way and is no less along a shorter one, as a bend
    /// would be. `f` evaluates at a multiple of the unknowns' magnitudes, with the signs of a move.
    fn hidden(&mut self, mut f: impl FnMut(f64, &mut [f64])) {
        let squares: f64 = IRREGULAR.iter().map(|t| t * t).sum();
        for way in [WIGGLE, WIGGLE / SHORTER] {
            for (place, value) in IRREGULAR.into_iter().zip(&mut self.values) {
                f(place * way, value);
            }
            for row in 0..self.noise.len() {
                let g = self.centre[row];
                let changes: [f64; 3] = std::array::from_fn(|k| self.values[k][row] - g);
                let slope = IRREGULAR.iter().zip(changes).map(|(t, c)| t * c).sum::<f64>();
                let off = |(t, c): (&f64, f64)| (c - t * slope / squares).abs();
                let off = IRREGULAR.iter().zip(changes).map(off).fold(0.0, f64::max);
                if way == WIGGLE {
                    self.learnt[row] = off;
                } else if off > self.learnt[row] / SHORTER && off.is_finite() {
                    self.noise[row] = self.noise[row].max(2.0 * off.max(self.learnt[row]));
                }
            }
        }
    }

    /// Rounding errors where some arguments are so small that moving them by their last place tells
    /// nothing: a displacement that is zero is added to a place that is not. Those of arguments of the
    /// size of their units are taken, in rows that are nearly straight over a part of these; of others
    /// the scale is not known. `f` evaluates with all of them moved by a multiple of their units, with
    /// the signs of the first move.
    fn small_arguments(&mut self, mut f: impl FnMut(f64, &mut [f64])) {
        let h = f64::from(FIRST).exp2();
        for (place, value) in PLACES.into_iter().zip(&mut self.values) {
            f(place * h, value);
        }
        for row in 0..self.noise.len() {
            let v: [f64; 6] = std::array::from_fn(|k| self.values[k][row]);
            let (g, noise) = (self.centre[row], self.noise[row]);
            if g.is_finite() && v.iter().all(|v| v.is_finite()) {
                let smooth = estimate(g, v, h, noise).filter(|found| {
                    let straight = found.value.abs() >= STRAIGHT * found.size;
                    found.resolved && straight && found.truncation <= SMOOTH * found.size
                });
                let slope = smooth.map_or(0.0, |found| found.value.abs());
                self.noise[row] = noise.max(f64::EPSILON * slope);
            }
        }
    }

    /// The value in the middle.
    pub(crate) fn value(&self) -> &[f64] {
        &self.centre
    }

    /// Derivatives of every row along its variable. `f` evaluates with all variables of the group
    /// moved by a multiple of their magnitudes; a row without a value is not finite.
    pub(crate) fn climb(&mut self, mut f: impl FnMut(f64, &mut [f64])) {
        for (k, open) in self.open.iter_mut().enumerate() {
            *open = self.unit[k] > 0.0;
            let unknown = if *open { f64::INFINITY } else { 0.0 };
            (self.derivative[k], self.error[k]) = (0.0, unknown);
            (self.low[k], self.high[k], self.resolved[k]) = (UNKNOWN, UNKNOWN, false);
            self.learnt[k] = self.noise[k];
        }
        let mut rung = FIRST;
        for count in 0..MOST {
            let multiple = f64::from(rung).exp2();
            for (place, value) in PLACES.into_iter().zip(&mut self.values) {
                f(place * multiple, value);
            }
            let mut flat = true;
            for row in 0..self.unit.len() {
                if self.unit[row] > 0.0 {
                    flat &= !self.judge(row, rung);
                }
            }
            if flat && count < 3 && rung + 4 <= FLAT {
                rung += 4;
                continue;
            }
            match self.next() {
                Some(next) => rung = next,
                None => break,
            }
        }
        // nowhere a value on either side
        for k in 0..self.unit.len() {
            if self.error[k] == f64::INFINITY {
                self.derivative[k] = f64::NAN;
            }
        }
    }

    /// Takes what a rung says of a row; whether it says that the row varies at all.
    fn judge(&mut self, row: usize, rung: i32) -> bool {
        let h = f64::from(rung).exp2() * self.unit[row];
        let v: [f64; 6] = std::array::from_fn(|k| self.values[k][row]);
        let g = self.centre[row];
        if g.is_finite() && v.iter().all(|v| *v == g) {
            // nothing to see: a derivative below the rounding of the value itself
            let error = self.noise[row].max(f64::EPSILON * g.abs()) / h;
            if self.resolved[row] && self.size[row] > 0.0 {
                // seen on a longer step: what is added to the argument absorbs this one
                self.low[row] =
                    if self.low[row] == UNKNOWN { rung } else { self.low[row].max(rung) };
                return true;
            }
            if error < self.error[row] {
                (self.derivative[row], self.error[row], self.size[row]) = (0.0, error, 0.0);
            }
            self.open[row] = false;
            return false;
        }
        // flat on a shorter step
        let unseen = self.error[row].is_finite() && self.size[row] == 0.0;
        self.open[row] |= unseen;
        let Some(found) = estimate(g, v, h, self.learnt[row]) else {
            // beyond the domain on both sides
            self.high[row] = self.high[row].min(rung);
            self.coarse[row] = f64::INFINITY;
            return true;
        };
        let Estimate { value, rounding, truncation, size, resolved } = found;
        let error = rounding + truncation;
        let shorter = self.high[row] != UNKNOWN && rung < self.high[row];
        // shorter steps that agree on another value than a longer one, beyond what both may miss
        let moved = (value - self.derivative[row]).abs();
        let both = resolved && self.resolved[row] && self.size[row] > 0.0;
        let contradicts = shorter && both && moved > CONTRADICTION * (error + self.error[row]);
        let grows =
            contradicts || shorter && truncation > rounding && truncation >= self.coarse[row];
        let noise = 0.5 * h * if contradicts { moved } else { truncation };
        let noisy = grows && noise <= NOISE * (g.abs() + 4.0 * h * size);
        let refuted = contradicts && noisy;
        // a longer step that did not see what is here is worth nothing
        let better = error < self.error[row] && (resolved || !self.resolved[row]) && !refuted;
        if better || unseen || grows && !noisy || resolved && !self.resolved[row] {
            (self.derivative[row], self.error[row], self.size[row]) = (value, error, size);
            self.resolved[row] = resolved;
        }
        // a derivative that nearly vanishes is measured by the slope near by, unless a shorter step
        // would be better
        let good = error <= ENOUGH * value.abs();
        let fair = error <= ENOUGH * size && truncation <= 10.0 * rounding;
        if resolved && (good || fair) && !refuted {
            self.open[row] = false;
        }
        if truncation <= rounding && !refuted {
            self.low[row] = if self.low[row] == UNKNOWN { rung } else { self.low[row].max(rung) };
            return true;
        }
        if noisy {
            // what grows as the step becomes shorter is rounding; steps of powers of two may share it
            self.learnt[row] = self.learnt[row].max(noise);
            self.low[row] = if self.low[row] == UNKNOWN { rung } else { self.low[row].max(rung) };
            let there = f64::from(self.high[row]).exp2() * self.unit[row];
            if 2.0 * noise / there >= 0.1 * self.coarse[row] {
                self.low[row] = self.high[row];
                self.high[row] = UNKNOWN;
            }
            return true;
        }
        if rung <= self.high[row] {
            (self.high[row], self.coarse[row]) = (rung, truncation);
        }
        true
    }

    /// The rung that the row with the worst derivative wants.
    fn next(&mut self) -> Option<i32> {
        let (mut worst, mut wanted) = (0.0, None);
        for row in 0..self.open.len() {
            if !self.open[row] {
                continue;
            }
            let (low, high) = (self.low[row], self.high[row]);
            let rung = match (low == UNKNOWN, high == UNKNOWN) {
                (false, true) => low + (low - FIRST).max(JUMP),
                (true, false) => high - (FIRST - high).max(JUMP),
                (false, false) if high - low > 2 => low + (high - low) / 2,
                _ => UNKNOWN,
            };
            if !(RUNGS.0..=RUNGS.1).contains(&rung) {
                self.open[row] = false;
                continue;
            }
            let relative = self.error[row] / self.size[row].max(self.derivative[row].abs());
            let relative = if relative.is_nan() { f64::INFINITY } else { relative };
            if wanted.is_none() || relative > worst {
                (worst, wanted) = (relative, Some(rung));
            }
        }
        wanted
    }
}

/// The derivative from the values at the places; `None` where neither side has all its values.
fn estimate(g: f64, v: [f64; 6], h: f64, noise: f64) -> Option<Estimate> {
    let far = f64::EPSILON * v.iter().fold(0.0, |m: f64, v| m.max((v - g).abs()));
    if !v.iter().all(|v| v.is_finite()) || !g.is_finite() {
        return one_sided(g, v, h, noise);
    }
    let slope = |k: usize| (v[k] - v[k + 1]) / (2.0 * PLACES[k] * h);
    let even = |k: usize| 0.5 * (v[k] + v[k + 1]);
    let second = slope(0);
    let fourth = (4.0 * slope(0) - slope(2)) / 3.0;
    let sixth = (64.0 * slope(0) - 20.0 * slope(2) + slope(4)) / 45.0;
    let middle = (64.0 * even(0) - 20.0 * even(2) + even(4)) / 45.0;
    let rounding = 2.0 * noise / h;
    let (a, b) = ((second - fourth).abs(), (fourth - sixth).abs());
    let b = (b - rounding).max(0.0);
    let missed = ((g - middle).abs() - 2.0 * noise).max(0.0);
    // for a pole at the distance L: b/a = 4 (h/L)², and the next order is 16 (h/L)² b; the even
    // part's remainder is L/h of it, and 16 (h/L)⁵ of the range
    let ratio = if a > 0.0 { (b / a).min(1.0) } else { 1.0 };
    let range = far / f64::EPSILON;
    let near = 0.5 * ratio.sqrt();
    let near =
        if missed > 0.0 { near.max(1.3 * (missed / (64.0 * range)).powf(0.2)) } else { near };
    let odd = b * (8.0 * ratio).min(1.0);
    let even = missed / h * (4.0 * near).min(1.0);
    // rounding of values far above the one in the middle is met on shorter steps, not on longer ones
    let truncation = odd.max(even) + 2.0 * far / h;
    let size = range / (4.0 * h);
    let resolved = b <= UNRESOLVED * size && missed <= UNRESOLVED * range;
    Some(Estimate { value: sixth, rounding, truncation, size, resolved })
}

/// At the edge of a domain: differences to the side that has values.
fn one_sided(g: f64, v: [f64; 6], h: f64, noise: f64) -> Option<Estimate> {
    let side = |s: usize| (g + v[s] + v[s + 2] + v[s + 4]).is_finite();
    let (first, sign) = if side(0) {
        (0, 1.0)
    } else if side(1) {
        (1, -1.0)
    } else {
        return None;
    };
    let slope = |k: usize| sign * (v[first + 2 * k] - g) / (h * f64::from(1_u8 << k));
    let (d1, d2, d4) = (slope(0), slope(1), slope(2));
    let second = 2.0 * d1 - d2;
    let third = (8.0 * d1 - 6.0 * d2 + d4) / 3.0;
    let size = d1.abs().max(d2.abs()).max(d4.abs());
    let rounding = 10.0 * noise / h + 16.0 * f64::EPSILON * size;
    // not known to be smooth: no order is trusted
    let truncation = (third - second).abs().max((second - d1).abs() * 0.5);
    let resolved = truncation <= UNRESOLVED * size;
    Some(Estimate { value: third, rounding, truncation, size, resolved })
}

/// The sign, 1, −1 or 0, by which an argument is moved to measure rounding.
fn sign(index: usize, turn: usize) -> f64 {
    // a multiplicative hash: no pattern in neighbours
    let mixed =
        (index as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(17 * turn as u32);
    if turn == 0 {
        0.0
    } else if mixed & 1 == 0 {
        1.0
    } else {
        -1.0
    }
}

/// `value` moved by a unit in the last place.
fn moved(value: f64, index: usize, turn: usize) -> f64 {
    value + sign(index, turn) * f64::EPSILON * value
}

/// `∂f/∂p` of any problem, from its residuals, and a bound of its error by row.
pub(crate) fn by_parameter<P: Problem + ?Sized>(
    problem: &P,
    u: &[f64],
    p: &[f64],
    which: ParamId,
    out: &mut [f64],
) -> Result<Vec<f64>, EvalError> {
    let unit = magnitude(p[which.0], problem.parameters()[which.0].scale);
    let residual = |u: &[f64], p: &[f64], r: &mut [f64]| problem.residual(u, p, r);
    let found = along(residual, (u, p), which, (&vec![0.0; u.len()], 1.0), unit, |_| true);
    out.copy_from_slice(&found.derivative);
    crate::problem::check_finite(out)?;
    Ok(found.error)
}

/// `∂f/∂u du + ∂f/∂p[which] dp`, from residuals where the parameter is `admitted`, with steps in `unit`.
pub(crate) fn along(
    residual: impl Fn(&[f64], &[f64], &mut [f64]) -> Result<(), EvalError>,
    (u, p): (&[f64], &[f64]),
    which: ParamId,
    (du, dp): (&[f64], f64),
    unit: f64,
    admitted: impl Fn(f64) -> bool,
) -> Ladder {
    let n = u.len();
    let mut ladder = Ladder::new(n);
    let (mut place, mut values) = (u.to_vec(), p.to_vec());
    let evaluate = |u: &[f64], p: &[f64], r: &mut [f64]| {
        if !admitted(p[which.0]) || residual(u, p, r).is_err() {
            r.fill(f64::NAN);
        }
    };
    let mut magnitude = vec![0.0; n];
    magnitudes(u, unit, &mut magnitude);
    ladder.look((u, p), (&mut place, &mut values), &magnitude, evaluate);
    ladder.unit.fill(unit);
    ladder.climb(|multiple, r| {
        let h = multiple * unit;
        for ((place, u), du) in place.iter_mut().zip(u).zip(du) {
            *place = u + h * du;
        }
        values[which.0] = p[which.0] + h * dp;
        evaluate(&place, &values, r);
    });
    ladder
}
