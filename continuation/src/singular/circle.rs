//! Branches at a double point that the cubic terms do not tell apart, as with the symmetry of a
//! polygon of five corners or more: there the cubic form is that of a circle, and the branches are
//! separated by terms of the order of the polygon.
//!
//! Instead of further terms of the series the reduced equations themselves are evaluated, at a finite
//! amplitude: for the direction `ξ(θ)` in the kernel the complement and the place `y₀` along the traced
//! branch solve all equations but one (Lyapunov-Schmidt, on the frame of the singular point), and what
//! remains is the tangential part `g(θ)`, whose zeros are the branches. Its harmonics say whether it is
//! more than rounding. All is asked again at another amplitude, and must be the same.

use super::kernel::Frame;
use super::probe::{Extended, Probe};
use super::roots::Forms;
use crate::problem::EvalError;
use crate::step::dot;
use std::f64::consts::TAU;

/// Directions looked at; harmonics up to a quarter of them are believed.
const SAMPLES: usize = 64;
/// Amplitudes, in natural ones, and their ratio.
const LEAST: f64 = 0.02;
const RATIO: f64 = 1.5;
const MOST: f64 = 1.0;
/// Where the equations have no solution at an amplitude before two agree, smaller ones are tried: from
/// this part of it, down to the least.
const SMALLER: f64 = 0.2;
const SMALLEST: f64 = 1e-4;
/// The strongest harmonic is that much above those that no polygon makes.
const CLEAR: f64 = 300.0;
/// Relative to the radial part, what a continuous symmetry leaves at an amplitude where anything shows.
const NOTHING: f64 = 1e-10;
/// Amplitude up to which branches are followed by their reduced equations: the farther, the better they
/// are told apart; much farther the parameter has moved by more than one step.
const APART: f64 = 0.1;
/// An amplitude at which polygons show, if there is one.
const LARGE: f64 = 0.3;
/// Directions of more than two modes that are looked at.
const DIRECTIONS: usize = 6;
/// Steps of the reduced equations' chord method, below which shrinking no more is rounding.
const ROUNDING: f64 = 1e-8;
/// Directions of the same branch at two amplitudes, as a part of the distance to the next one.
const SAME: f64 = 0.1;

/// What is known of the directions.
pub(super) enum Separated {
    /// These branches, one of each opposite pair where both are there.
    Branches(Vec<Ray>),
    /// All directions are alike: one of a circle of branches stands for all.
    Circle,
    /// Not at the amplitudes at which the reduced equations could be solved.
    Unknown,
}

/// A branch of the reduced equations.
pub(super) struct Ray {
    pub(super) angle: f64,
    /// Its amplitude, in natural ones, and the state there, relative to the singular point.
    pub(super) amplitude: f64,
    pub(super) offset: Extended,
}

/// The reduced equations of a double point.
pub(super) struct Reduced<'f, 'p, 'a> {
    pub(super) probe: &'p mut Probe<'a>,
    pub(super) frame: &'f mut Frame,
    pub(super) z: &'f Extended,
    /// The traced branch's tangent, and the vectors across it, in natural amplitudes.
    pub(super) along: &'f Extended,
    pub(super) across: &'f [Extended],
    /// `a_j(ξ)`: what the traced branch does to them.
    pub(super) linear: &'f Forms,
}

/// A solution of all reduced equations but the tangential one.
struct Solved {
    tangential: f64,
    offset: Extended,
}

impl Reduced<'_, '_, '_> {
    /// The branches.
    pub(super) fn separate(&mut self) -> Separated {
        if self.across.len() == 2 { self.separate_two() } else { self.separate_more() }
    }

    /// Of more than two modes only whether all directions are alike.
    fn separate_more(&mut self) -> Separated {
        for seed in 1..=DIRECTIONS {
            let arbitrary = |i| super::arbitrary(seed, i);
            let mut xi: Vec<f64> = (0..self.across.len()).map(arbitrary).collect();
            let norm = dot(&xi, &xi).sqrt();
            xi.iter_mut().for_each(|x| *x /= norm);
            match self.solve(&xi, LARGE) {
                Ok(at) if at.tangential.abs() < NOTHING * LARGE * LARGE => {}
                _ => return Separated::Unknown,
            }
        }
        Separated::Circle
    }

    fn separate_two(&mut self) -> Separated {
        let mut largest = 0.0_f64;
        let mut tangential = f64::INFINITY;
        let mut before: Option<Vec<Ray>> = None;
        let mut confirmed = false;
        let mut amplitude = LEAST;
        let mut beyond = f64::INFINITY;
        while amplitude <= MOST && amplitude < beyond {
            let Ok(samples) = self.samples(amplitude) else {
                // natural amplitudes are known to a factor of some
                if confirmed || amplitude <= SMALLEST {
                    break;
                }
                (before, beyond) = (None, amplitude);
                amplitude *= SMALLER;
                continue;
            };
            let spectrum = harmonics(&samples);
            let (signal, floor) = strength(&spectrum);
            let size = amplitude * amplitude;
            (largest, tangential) = (amplitude, signal / size);
            let rays = if signal > CLEAR * floor && signal > NOTHING * size {
                self.rays(&samples, amplitude)
            } else {
                None
            };
            confirmed = match (&before, &rays) {
                (Some(before), Some(rays)) => alike(before, rays),
                _ => false,
            };
            before = rays;
            if confirmed && amplitude > APART {
                break;
            }
            amplitude *= RATIO;
        }
        // where the equations of a larger amplitude have no such solution, the last two still agree
        if let (true, Some(rays)) = (confirmed, before) {
            return Separated::Branches(paired(rays));
        }
        if largest >= LARGE && tangential < NOTHING {
            Separated::Circle
        } else {
            Separated::Unknown
        }
    }

    fn samples(&mut self, amplitude: f64) -> Result<Vec<f64>, Option<EvalError>> {
        (0..SAMPLES)
            .map(|k| self.towards(TAU * k as f64 / SAMPLES as f64, amplitude).map(|s| s.tangential))
            .collect()
    }

    /// Where the tangential part vanishes.
    fn rays(&mut self, samples: &[f64], amplitude: f64) -> Option<Vec<Ray>> {
        let mut rays = Vec::new();
        let width = TAU / SAMPLES as f64;
        for k in 0..SAMPLES {
            let (mut a, mut fa) = (k as f64 * width, samples[k]);
            let (mut b, mut fb) = (a + width, samples[(k + 1) % SAMPLES]);
            if fa == 0.0 || fa * fb < 0.0 {
                // regula falsi (Illinois)
                for _ in 0..40 {
                    let angle = if fa == 0.0 { a } else { b - fb * (b - a) / (fb - fa) };
                    let at = self.towards(angle, amplitude).ok()?;
                    if at.tangential == 0.0 || (b - a).abs() < 1e-12 || fa == 0.0 {
                        (a, fa) = (angle, 0.0);
                        break;
                    }
                    if at.tangential * fb < 0.0 {
                        (a, fa) = (b, fb);
                    } else {
                        fa *= 0.5;
                    }
                    (b, fb) = (angle, at.tangential);
                    if (b - a).abs() < 1e-9 || fb.abs() < 1e-13 * samples[k].abs() {
                        break;
                    }
                }
                let angle = if fa == 0.0 { a } else { b };
                let offset = self.towards(angle, amplitude).ok()?.offset;
                rays.push(Ray { angle: angle.rem_euclid(TAU), amplitude, offset });
            }
        }
        rays.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        (!rays.is_empty()).then_some(rays)
    }

    fn towards(&mut self, angle: f64, amplitude: f64) -> Result<Solved, Option<EvalError>> {
        let (sin, cos) = angle.sin_cos();
        self.solve(&[cos, sin], amplitude)
    }

    /// Solves all but the tangential equations, by a chord method on the frame at the singular point.
    fn solve(&mut self, xi: &[f64], amplitude: f64) -> Result<Solved, Option<EvalError>> {
        let (a, _) = self.linear.at(xi);
        let square = dot(&a, &a);
        let mut offset = Extended::zero(self.z.u.len());
        for (x, v) in xi.iter().zip(self.across) {
            offset.add(amplitude * x, v);
        }
        let mut least = f64::INFINITY;
        let mut idle = 0;
        let mut tangential = f64::NAN;
        for iteration in 0..60 {
            let mut z = self.z.clone();
            z.add(1.0, &offset);
            let residual = self.probe.residual_at(&z).map_err(Some)?;
            let minus: Vec<f64> = residual.iter().map(|r| -r).collect();
            let (step, beta) = self.frame.solve(self.probe, &minus);
            let radial = dot(&beta, &a) / (amplitude * square);
            tangential = match (&a[..], &beta[..]) {
                ([a0, a1], [b0, b1]) => (b1 * a0 - b0 * a1) / (amplitude * square),
                _ => {
                    let across = beta.iter().zip(&a).map(|(b, a)| b / amplitude - radial * a);
                    across.map(|x| x * x).sum::<f64>().sqrt() / square.sqrt()
                }
            };
            offset.add(1.0, &step);
            offset.add(radial, self.along);
            let length = self.probe.norm(&step).max(radial.abs());
            if !length.is_finite() || (iteration > 3 && length > ROUNDING && length > 2.0 * least) {
                return Err(None);
            }
            // small steps that shrink no more are the residual's rounding over the amplitude; what it
            // does to the tangential part shows in the harmonics that no polygon makes
            idle = if length > 0.5 * least { idle + 1 } else { 0 };
            least = least.min(length);
            if length < 1e-15 || (least < ROUNDING && idle >= 3) {
                return Ok(Solved { tangential, offset });
            }
        }
        if least < 1e-9 { Ok(Solved { tangential, offset }) } else { Err(None) }
    }
}

/// Amplitudes of the harmonics 0 to half the number of samples.
fn harmonics(samples: &[f64]) -> Vec<f64> {
    let n = samples.len();
    (0..=n / 2)
        .map(|m| {
            let sum = samples.iter().enumerate().fold((0.0, 0.0), |(re, im), (k, g)| {
                let (sin, cos) = (TAU * (m * k % n) as f64 / n as f64).sin_cos();
                (re + g * cos, im + g * sin)
            });
            2.0 * sum.0.hypot(sum.1) / n as f64
        })
        .collect()
}

/// The strongest harmonic of the lower half, and the strongest of the upper, which is rounding.
fn strength(spectrum: &[f64]) -> (f64, f64) {
    let half = spectrum.len() / 2;
    let largest = |part: &[f64]| part.iter().fold(0.0, |m: f64, a| m.max(*a));
    (largest(&spectrum[..half]), largest(&spectrum[half..]))
}

/// Whether both amplitudes have the same branches.
fn alike(a: &[Ray], b: &[Ray]) -> bool {
    let apart = TAU / a.len() as f64;
    let near = |a: &Ray| b.iter().any(|b| distance(a.angle, b.angle) < SAME * apart);
    a.len() == b.len() && a.iter().all(near)
}

fn distance(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(TAU);
    d.min(TAU - d)
}

/// One of each opposite pair.
fn paired(rays: Vec<Ray>) -> Vec<Ray> {
    let apart = SAME * TAU / rays.len() as f64;
    let mut kept: Vec<Ray> = Vec::new();
    for ray in rays {
        let opposite = ray.angle + 0.5 * TAU;
        if !kept.iter().any(|other| distance(other.angle, opposite) < apart) {
            kept.push(ray);
        }
    }
    kept
}
