//! Double-layer repulsion with van der Waals attraction (DLVO).
//!
//! Between two flat surfaces at the distance `h` in an electrolyte
//! ```text
//! w(h) = Z e^(−h/λ) − A/(12π h²)
//! ```
//! with Hamaker's constant `A`, the Debye length `λ` and the strength `Z` of the double layer; the
//! repulsion is that of weakly overlapping double layers, the attraction not retarded (Derjaguin and
//! Landau 1941, Verwey and Overbeek 1948; Israelachvili, *Intermolecular and Surface Forces*,
//! chapters 13 and 14).
//!
//! Far out the attraction wins, nearer the repulsion: `w` has a minimum, the *secondary* one. Its depth
//! `W0` and its height `δ_A` take the places of `A` and `Z`, as in the other potentials. With
//! `x = δ/δ_A` and `ρ = λ/δ_A`
//! ```text
//! w_int = W0/(1 − 2ρ) [2ρ e^((1 − x)/ρ) − x⁻²],
//! A = 12π W0 δ_A²/(1 − 2ρ),   Z = 2ρ W0 e^(1/ρ)/(1 − 2ρ)
//! ```
//! which is a minimum if `ρ < 1/3`; at `ρ = 1/3` it merges with the barrier before the plate.
//!
//! Nearer still, at `x_b < 3ρ`, where `(1 − x_b)/ρ = −3 ln x_b`, the repulsion is overcome. Below that
//! barrier `w → −∞`: the film breaks and the surfaces jump into molecular contact. That *primary*
//! minimum is bounded only by the size of atoms (0.2 nm, a thousandth of a film's length at most), which
//! neither a smooth shell nor the law `h⁻²` describes, and which no element resolves: a cutoff would
//! decide the numbers. So the model ends where the film does: heights `δ ≤ x_b δ_A` are refused
//! ([`super::Wall`]), above them `w ≥ −W0`, and a branch whose film breaks ends there and says so.
//! Beneath `ρ = 0.234` the barrier is higher than the film far away.

use super::{FilmJet, Potential};
use crate::params::ParameterError;
use crate::scalar::Scalar;
use std::f64::consts::PI;

/// The potential at a given `λ/δ_A`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dlvo {
    debye: f64,
    barrier: f64,
}

impl Dlvo {
    /// The least `λ/δ_A`: exponentials of its reciprocal stay far from the largest number.
    pub const LEAST: f64 = 0.01;
    /// What `λ/δ_A` may be.
    pub const ALLOWED: &'static str =
        "at least 0.01 and less than 1/3, where the minimum meets the barrier";

    /// Whether there is a potential at `λ/δ_A`.
    pub fn allows(debye: f64) -> bool {
        (Dlvo::LEAST..1.0 / 3.0).contains(&debye)
    }

    /// The potential with the Debye length `debye`, in film lengths.
    ///
    /// # Errors
    /// When it is outside [`Dlvo::ALLOWED`].
    pub fn new(debye: f64) -> Result<Dlvo, ParameterError> {
        if Dlvo::allows(debye) {
            return Ok(Dlvo { debye, barrier: barrier(debye) });
        }
        Err(ParameterError::OutOfRange {
            key: "debye",
            value: debye,
            allowed: Dlvo::ALLOWED,
            remedy: "lambda/delta_A, for example 0.1",
        })
    }

    /// The Debye length `λ/δ_A`.
    pub fn debye(&self) -> f64 {
        self.debye
    }

    /// Height of the barrier's top, in film lengths.
    pub fn barrier(&self) -> f64 {
        self.barrier
    }

    /// `W0/(1 − 2ρ)` of an adhesion, or its unit.
    fn scale(&self) -> f64 {
        1.0 / (1.0 - 2.0 * self.debye)
    }

    /// `e^((1 − x)/ρ)`.
    #[inline(always)]
    fn decay<T: Scalar>(&self, x: T) -> T {
        ((-x + 1.0) * (1.0 / self.debye)).exp()
    }
}

/// The root of `g(x) = (1 − x)/ρ + 3 ln x` below `3ρ`. `g` rises there and is concave: Newton's
/// iterates from where `g < 0` rise to the root.
fn barrier(debye: f64) -> f64 {
    let mut x = (-1.0 / (3.0 * debye)).exp();
    // the root is double at ρ = 1/3, where each step halves the error
    for _ in 0..200 {
        let next = x - ((1.0 - x) / debye + 3.0 * x.ln()) / (3.0 / x - 1.0 / debye);
        if !(next > x && next < 3.0 * debye) {
            break;
        }
        x = next;
    }
    x
}

impl Potential for Dlvo {
    #[inline(always)]
    fn energy<T: Scalar>(&self, delta: T, adhesion: T, length: T) -> T {
        let x = delta / length;
        let r = length / delta;
        adhesion * self.scale() * (self.decay(x) * (2.0 * self.debye) - r * r)
    }

    // not inlined: the exponential's calls would cost the other potential its vector instructions
    #[inline(never)]
    fn jet<T: Scalar>(&self, delta: T, adhesion: f64, length: f64) -> FilmJet<T> {
        let e = self.decay(delta * (1.0 / length));
        let r = delta.recip() * length;
        let rr = r * r;
        let a = adhesion * self.scale();
        FilmJet {
            w: (e * (2.0 * self.debye) - rr) * a,
            d1: (rr * r - e) * (2.0 * a / length),
            d2: (e * (2.0 / self.debye) - rr * rr * 6.0) * (a / (length * length)),
        }
    }

    #[inline(never)]
    fn by_adhesion<T: Scalar>(&self, delta: T, _adhesion: f64, length: f64) -> (T, T) {
        let jet = self.jet(delta, 1.0, length);
        (jet.w, jet.d1)
    }

    #[inline(never)]
    fn by_length<T: Scalar>(&self, delta: T, adhesion: f64, length: f64) -> (T, T) {
        if adhesion == 0.0 {
            // a plate that is not there, which may be infinitely far
            return (T::constant(0.0), T::constant(0.0));
        }
        let x = delta * (1.0 / length);
        let e = self.decay(x);
        let r = delta.recip() * length;
        let rr = r * r;
        let a = adhesion * self.scale();
        let slope = e * (-x * (1.0 / self.debye) + 1.0) * 2.0 + rr * r * 4.0;
        ((x * e - rr) * (2.0 * a / length), slope * (a / (length * length)))
    }

    fn least_height(&self) -> f64 {
        self.barrier
    }
}

/// `Z` in J/m² of two surfaces at the potential `surface_potential` (V) in a 1:1 electrolyte of water
/// at 25 °C with the Debye length `debye` (m): `32 ε (kT/e)² tanh²(eψ/4kT)/λ`. For two different
/// potentials the square is the product of both tanh.
pub fn double_layer_of_surface_potential(surface_potential: f64, debye: f64) -> f64 {
    /// Of water at 25 °C, F/m: 78.36 times that of vacuum.
    const PERMITTIVITY: f64 = 78.36 * 8.854_187_812_8e-12;
    /// `kT/e` at 25 °C, V.
    const THERMAL: f64 = 1.380_649e-23 * 298.15 / 1.602_176_634e-19;
    let tanh = (surface_potential / (4.0 * THERMAL)).tanh();
    32.0 * PERMITTIVITY * THERMAL * THERMAL * tanh * tanh / debye
}

/// What makes a potential of this kind, in SI units or any others that fit together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceForces {
    /// Hamaker's constant `A`, an energy.
    pub hamaker: f64,
    /// Strength `Z` of the double layer, an energy per area.
    pub double_layer: f64,
    /// The Debye length `λ`.
    pub debye: f64,
}

impl SurfaceForces {
    /// `27/e³`: attraction that is as strong leaves no minimum.
    pub const MOST: f64 = 27.0 * 0.049_787_068_367_863_944;

    /// `A/(6π Z λ²)`, the attraction in units of the repulsion.
    pub fn attraction(&self) -> f64 {
        self.hamaker / (6.0 * PI * self.double_layer * self.debye * self.debye)
    }

    /// What makes a well of this height and depth, with the Debye length `debye` in the units of the height.
    pub fn of_well(length: f64, depth: f64, debye: f64) -> SurfaceForces {
        let ratio = debye / length;
        let scale = depth / (1.0 - 2.0 * ratio);
        SurfaceForces {
            hamaker: 12.0 * PI * scale * length * length,
            double_layer: 2.0 * ratio * (1.0 / ratio).exp() * scale,
            debye,
        }
    }

    /// Height `δ_A` of the secondary minimum and its depth `W0`; `None` without one.
    pub fn well(&self) -> Option<(f64, f64)> {
        let q = self.attraction();
        if !(q > 0.0 && q < SurfaceForces::MOST) {
            return None;
        }
        // y³ e^(−y) = q beyond y = 3: k(y) = y − 3 ln y + ln q is convex and rises there, and Newton's
        // iterates from where k > 0 fall to the root
        let k = |y: f64| y - 3.0 * y.ln() + q.ln();
        let mut y = 4.0;
        while k(y) <= 0.0 {
            y *= 2.0;
        }
        for _ in 0..200 {
            let next = y - k(y) / (1.0 - 3.0 / y);
            if !(next < y && next > 3.0) {
                break;
            }
            y = next;
        }
        let length = y * self.debye;
        let depth = self.hamaker / (12.0 * PI * length * length) * (1.0 - 2.0 / y);
        Some((length, depth))
    }
}

#[cfg(test)]
mod tests {
    use super::super::check;
    use super::*;
    use crate::dual::close;

    const DEBYES: [f64; 5] = [0.02, 0.1, 0.2, 0.3, 0.333];

    #[test]
    fn derivatives_agree_with_dual_numbers() {
        for debye in [0.1, 0.2, 0.3] {
            let film = Dlvo::new(debye).unwrap();
            let least = film.barrier();
            check::derivatives(&film, &[least + 0.3 * (1.0 - least), 0.97, 1.0, 1.5, 12.0]);
        }
    }

    #[test]
    fn minimum_is_minus_the_adhesion_at_the_film_length() {
        for debye in DEBYES {
            check::well(&Dlvo::new(debye).unwrap());
        }
    }

    #[test]
    fn the_barrier_is_where_the_force_vanishes() {
        for debye in DEBYES {
            let film = Dlvo::new(debye).unwrap();
            let x = film.barrier();
            assert!(x > 0.0 && x < 3.0 * debye && x < 1.0, "{debye}: {x}");
            // both parts of the slope alike, in logarithms
            close((1.0 - x) / debye, -3.0 * x.ln(), 1e-11, 0.0);
            let force = |x: f64| -film.jet(x, 1.0, 1.0).d1;
            assert!(force(0.9 * x) < 0.0 && force(x + 0.2 * (1.0 - x)) > 0.0, "{debye}");
        }
        assert!(Dlvo::new(0.2).unwrap().jet(Dlvo::new(0.2).unwrap().barrier(), 1.0, 1.0).w > 0.0);
        let low = Dlvo::new(0.25).unwrap();
        assert!(low.jet(low.barrier(), 1.0, 1.0).w < 0.0);
    }

    #[test]
    fn a_debye_length_without_a_well_is_refused() {
        for bad in [f64::NAN, 0.0, -0.1, 0.009, 1.0 / 3.0, 0.5] {
            let error = Dlvo::new(bad).unwrap_err();
            assert_eq!(error.key(), "debye");
        }
    }

    /// The same function of the height from `A`, `Z` and `λ` as from `W0`, `δ_A` and `λ/δ_A`.
    #[test]
    fn surface_forces_make_the_potential() {
        let forces = SurfaceForces { hamaker: 5e-21, double_layer: 2e-3, debye: 5e-9 };
        let (length, depth) = forces.well().unwrap();
        assert!(length > 15e-9 && depth > 0.0);
        let film = Dlvo::new(forces.debye / length).unwrap();
        for x in [0.3, 0.7, 1.0, 1.8] {
            let h = x * length;
            let direct = forces.double_layer * (-h / forces.debye).exp()
                - forces.hamaker / (12.0 * PI * h * h);
            close(film.energy(h, depth, length), direct, 1e-11, 1e-12 * depth);
        }
        let again = SurfaceForces::of_well(length, depth, forces.debye);
        close(again.hamaker, forces.hamaker, 1e-12, 0.0);
        close(again.double_layer, forces.double_layer, 1e-11, 0.0);
        let strong = SurfaceForces { hamaker: 1.35 * 6.0 * PI * 2e-3 * 25e-18, ..forces };
        assert!(strong.attraction() > SurfaceForces::MOST && strong.well().is_none());
        let barely = SurfaceForces { hamaker: 1.344 * 6.0 * PI * 2e-3 * 25e-18, ..forces };
        close(barely.well().unwrap().0, 3.0 * 5e-9, 0.03, 0.0);
    }

    /// Israelachvili's constant for 1:1 electrolytes at 25 °C:
    /// `Z = (κ/2π) 9.22e-11 tanh²(ψ/103 mV)` J/m².
    #[test]
    fn strength_of_a_double_layer() {
        let z = double_layer_of_surface_potential(0.05, 10e-9);
        let book = 9.22e-11 / (2.0 * PI * 10e-9) * (50.0_f64 / 103.0).tanh().powi(2);
        close(z, book, 5e-3, 0.0);
        close(double_layer_of_surface_potential(-0.05, 10e-9), z, 1e-15, 0.0);
    }
}
