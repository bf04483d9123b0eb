//! From the parts of a curve to the moduli.

use super::IdentifyError;
use super::curve::{ForceCurve, factor, line, misfit};
use crate::asymptotics::{
    CUBIC_SHARE, REISSNER_SLOPE, knee_deformation, knee_force, plate_pogorelov_force,
    point_load_slope, printed_pogorelov_force,
};
use crate::params::{Law, Shell};

/// What is known of the bubble beforehand, in the units of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Stress-free radius `R0`.
    pub radius: f64,
    /// Poisson ratio `ν`.
    pub poisson: f64,
    /// Ambient pressure `P_A`.
    pub pressure: f64,
    /// Gas exponent `γ`.
    pub gas_exponent: f64,
}

/// Which two parts of the curve are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Combination {
    /// Slope of the flat cap and square-root law of the dimple.
    SlopeDimple,
    /// Slope of the flat cap and deformation at the knee.
    SlopeKnee,
    /// Force at the knee and `d(F²)/dΔ` on the dimple: neither needs to know where the deformation
    /// counts from, which the thinning of a film hides.
    KneeDimple,
    /// Slope and cubic upturn, for soft shells.
    SlopeUpturn,
}

/// Which formulas.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Formulas {
    /// As printed: (32), (33) for a point load, (40) for an incompressible capsule, knee `2.5h`.
    Printed,
    /// For plates, finite `k_b` and a gas of finite stiffness.
    Corrected,
}

/// A regime of the curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regime {
    /// Flat cap, `F ∝ Δ`.
    Linear,
    /// Where the slope has fallen to half of its largest value.
    Knee,
    /// Dimple, `F ∝ Δ^½`.
    Dimple,
    /// Gas, `F ∝ Δ³`.
    Upturn,
}

/// A part of the curve that was used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// What it was taken for.
    pub regime: Regime,
    /// First deformation of one pole.
    pub from: f64,
    /// Last one.
    pub to: f64,
    /// What was read off: a slope `F/Δ`, the force at the knee, `F²/Δ` or its slope, `F/Δ³`.
    pub value: f64,
    /// Largest misfit over the largest force in the part (of `F²` on a dimple); 0 at a knee.
    pub misfit: f64,
}

/// Estimated moduli.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Stretching modulus `χ = E h`.
    pub chi: f64,
    /// Bending modulus `k_b`.
    pub bending: f64,
    /// Young's modulus of a homogeneous shell with these moduli.
    pub young: f64,
    /// Thickness of that shell.
    pub thickness: f64,
    /// The parts of the curve that were used.
    pub parts: Vec<Part>,
}

/// Estimates the moduli from two parts of the curve.
///
/// # Errors
/// When the curve does not show the regimes, or no shell has these numbers. There is no printed
/// formula for [`Combination::KneeDimple`]; the corrected one is used.
pub fn estimate(
    curve: &ForceCurve,
    known: &Known,
    combination: Combination,
    formulas: Formulas,
) -> Result<Estimate, IdentifyError> {
    known.check()?;
    // s = √(χk_b) and x = √(k_b/χ)/R0 = √k̂_b
    let r = known.radius;
    let (s, x, parts) = match combination {
        Combination::SlopeDimple => {
            let knee = Knee::of(curve)?;
            let slope = knee.linear(curve);
            let dimple = knee.dimple(curve, formulas)?;
            // F̂² = B √k̂_b d̂, so F²/Δ = B x s²/R0
            let b = square_law(known.poisson, formulas);
            // the plate's own slope at the knee, 10.3, would do for a thin film only
            let s = slope.value * r / REISSNER_SLOPE;
            let x = dimple.value * r / (b * s * s);
            (s, x, vec![slope, dimple])
        }
        Combination::SlopeKnee => {
            let knee = Knee::of(curve)?;
            let slope = knee.linear(curve);
            let at = knee.part.from / r;
            let (x, of_slope) = match formulas {
                Formulas::Printed => {
                    let thickness = at / 2.5;
                    let rest = 12.0 * (1.0 - known.poisson * known.poisson);
                    (thickness / rest.sqrt(), REISSNER_SLOPE)
                }
                // the chord to the knee is steeper than the first slope
                Formulas::Corrected => {
                    (at / knee_deformation(1.0), knee_force(1.0) / knee_deformation(1.0))
                }
            };
            let value = match formulas {
                Formulas::Printed => slope.value,
                Formulas::Corrected => knee.part.value / knee.part.from,
            };
            (value * r / of_slope, x, vec![slope, knee.part])
        }
        Combination::KneeDimple => {
            let knee = Knee::of(curve)?;
            let dimple = knee.dimple(curve, Formulas::Corrected)?;
            // F* = A x s and d(F²)/dΔ = B x s²/R0
            let b = square_law(known.poisson, Formulas::Corrected);
            let first = knee.part.value / knee_force(1.0);
            let s = dimple.value * r / b / first;
            (s, first / s, vec![knee.part, dimple])
        }
        Combination::SlopeUpturn => return soft(curve, known, formulas),
    };
    known.finish(s / (x * r), s * x * r, parts)
}

impl Known {
    fn check(&self) -> Result<(), IdentifyError> {
        let positive = |key, value: f64| {
            if value.is_finite() && value > 0.0 {
                Ok(())
            } else {
                Err(IdentifyError::Known { key, value, allowed: "positive" })
            }
        };
        positive("radius", self.radius)?;
        positive("pressure", self.pressure)?;
        positive("gas_exponent", self.gas_exponent)?;
        if self.poisson > -1.0 && self.poisson < 1.0 {
            Ok(())
        } else {
            let allowed = "greater than -1 and less than 1";
            Err(IdentifyError::Known { key: "poisson", value: self.poisson, allowed })
        }
    }

    fn finish(&self, chi: f64, bending: f64, parts: Vec<Part>) -> Result<Estimate, IdentifyError> {
        if !(chi > 0.0 && bending > 0.0 && chi.is_finite() && bending.is_finite()) {
            return Err(IdentifyError::NoSolution { why: "a modulus is not positive" });
        }
        let rest = 1.0 - self.poisson * self.poisson;
        let thickness = (12.0 * rest * bending / chi).sqrt();
        Ok(Estimate { chi, bending, young: chi / thickness, thickness, parts })
    }
}

/// `F̂²/(√k̂_b d̂)` of the square-root law.
fn square_law(poisson: f64, formulas: Formulas) -> f64 {
    let force = match formulas {
        Formulas::Printed => printed_pogorelov_force(poisson, 1.0, 1.0),
        Formulas::Corrected => plate_pogorelov_force(1.0, 1.0),
    };
    force * force
}

struct Knee {
    part: Part,
}

impl Knee {
    /// The first place where the slope has fallen to half of the largest one before it.
    fn of(curve: &ForceCurve) -> Result<Knee, IdentifyError> {
        let (mut largest, mut least) = (0.0_f64, 1.0_f64);
        for (i, &slope) in curve.slope.iter().enumerate() {
            if slope > largest {
                (largest, least) = (slope, 1.0);
            }
            least = least.min(slope / largest);
            if least <= 0.5 {
                let (d, f) = (curve.deformation[i], curve.force[i]);
                let part = Part { regime: Regime::Knee, from: d, to: d, value: f, misfit: 0.0 };
                return Ok(Knee { part });
            }
        }
        Err(IdentifyError::NoKnee { share: least })
    }

    /// `F = cΔ` up to short of the knee, which the window of a local slope blurs.
    fn linear(&self, curve: &ForceCurve) -> Part {
        linear(curve, 0.8 * self.part.from)
    }

    /// The square-root law beyond the knee, to twice its deformation: `F² = cΔ` as printed, a line
    /// otherwise, which does not depend on where the deformation counts from.
    fn dimple(&self, curve: &ForceCurve, formulas: Formulas) -> Result<Part, IdentifyError> {
        let at = self.part.from;
        let part = curve.between(1.1 * at, 2.2 * at);
        let d = &curve.deformation[part.clone()];
        let last = curve.deformation[curve.deformation.len() - 1];
        let middle = (part.start + part.end) / 2;
        let power = curve.power(middle.min(curve.deformation.len() - 1));
        if last < 1.5 * at || power.is_nan() || power > 0.95 {
            return Err(IdentifyError::NoDimple { reach: last / at, power });
        }
        let square: Vec<f64> = curve.force[part].iter().map(|f| f * f).collect();
        let (value, misfit) = match formulas {
            Formulas::Printed => factor(d, &square),
            Formulas::Corrected => {
                let (zero, slope) = line(d, &square);
                (slope, misfit(d.iter().map(|d| zero + slope * d), &square))
            }
        };
        let (from, to) = (d[0], d[d.len() - 1]);
        Ok(Part { regime: Regime::Dimple, from, to, value, misfit })
    }
}

fn linear(curve: &ForceCurve, to: f64) -> Part {
    let part = curve.between(0.0, to);
    let d = &curve.deformation[part.clone()];
    let (value, misfit) = factor(d, &curve.force[part]);
    Part { regime: Regime::Linear, from: 0.0, to, value, misfit }
}

/// `F = 8√(χk_b)Δ/R0` and `F ∝ χΔ³/R0²`.
fn soft(curve: &ForceCurve, known: &Known, formulas: Formulas) -> Result<Estimate, IdentifyError> {
    let end = curve.deformation.len() - 1;
    let power = curve.power(end);
    if power.is_nan() || power < 1.5 {
        return Err(IdentifyError::NoUpturn { power });
    }
    let (r, nu) = (known.radius, known.poisson);
    let (d, f) = (&curve.deformation, &curve.force);
    match formulas {
        Formulas::Printed => {
            // the straight part ends where the chord is a tenth steeper than at its flattest
            let chords: Vec<f64> = d.iter().zip(f).map(|(d, f)| f / d).collect();
            let flattest = (0..=end).min_by(|&i, &j| chords[i].total_cmp(&chords[j])).unwrap_or(0);
            let straight = (flattest..=end).find(|&i| chords[i] > 1.1 * chords[flattest]);
            let slope = linear(curve, d[straight.unwrap_or(end)]);
            let start = (0..=end).rfind(|&i| curve.power(i) < 1.5).unwrap_or(0);
            let cubes: Vec<f64> = d[start..].iter().map(|d| d.powi(3)).collect();
            let (value, misfit) = factor(&cubes, &f[start..]);
            let (from, to) = (d[start], d[end]);
            let upturn = Part { regime: Regime::Upturn, from, to, value, misfit };
            let chi = value * r * r / (4.0 * std::f64::consts::PI);
            let s = slope.value * r / REISSNER_SLOPE;
            known.finish(chi, s * s / chi, vec![slope, upturn])
        }
        Formulas::Corrected => {
            // F/Δ = a + cΔ² over the whole curve
            let squares: Vec<f64> = d.iter().map(|d| d * d).collect();
            let chords: Vec<f64> = d.iter().zip(f).map(|(d, f)| f / d).collect();
            let (a, c) = line(&squares, &chords);
            let misfit = misfit(d.iter().map(|d| a * d + c * d.powi(3)), f);
            if !(a > 0.0 && c > 0.0) {
                let why = "its linear or its cubic part is not positive";
                return Err(IdentifyError::NoSolution { why });
            }
            let (from, to) = (d[0], d[end]);
            let slope = Part { regime: Regime::Linear, from, to, value: a, misfit };
            let upturn = Part { regime: Regime::Upturn, from, to, value: c, misfit };
            // c R0² [2(1−ν) + 4χ/(3γP_A R0)] = 4π share χ
            let gas = 4.0 / (3.0 * known.gas_exponent * known.pressure * r);
            let stiff = c * r * r;
            let rest = 4.0 * std::f64::consts::PI * CUBIC_SHARE - stiff * gas;
            if rest <= 0.0 {
                let why = "the gas alone is softer than the upturn; the pressure may be too low";
                return Err(IdentifyError::NoSolution { why });
            }
            let chi = 2.0 * (1.0 - nu) * stiff / rest;
            // the slope depends a little on k_b itself
            let mut bending = (a * r / REISSNER_SLOPE).powi(2) / chi;
            for _ in 0..30 {
                let groups = bending / (chi * r * r);
                let shell = Shell { law: Law::Hooke, poisson: nu };
                let pressure = known.pressure * r / chi;
                let of = point_load_slope(&shell, groups, pressure, known.gas_exponent);
                bending = (a * r / of).powi(2) / chi;
                if !bending.is_finite() {
                    break;
                }
            }
            known.finish(chi, bending, vec![slope, upturn])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Reading;
    use super::*;
    use crate::asymptotics::cubic_force;

    const UNIT: Known = Known { radius: 1.0, poisson: 0.5, pressure: 3.0, gas_exponent: 1.07 };

    fn curve(f: impl Fn(f64) -> f64, to: f64) -> ForceCurve {
        let d: Vec<f64> = (1..=400).map(|i| to * f64::from(i) / 400.0).collect();
        let f: Vec<f64> = d.iter().map(|&d| f(d)).collect();
        ForceCurve::new(&d, &f, Reading::OnePole).unwrap()
    }

    fn near(value: f64, known: f64, share: f64) {
        assert!((value / known - 1.0).abs() < share, "{value} {known}");
    }

    /// Curves made of the formulas give back the moduli: the algebra.
    #[test]
    fn the_formulas_are_inverted() {
        // a hard shell, χ = 2, as if point loads obeyed the printed laws
        let (chi, k) = (2.0, 1e-6);
        let s = chi * f64::sqrt(k);
        let cross = (printed_pogorelov_force(0.5, k, 1.0) / 8.0).powi(2);
        let printed =
            |d: f64| s * if d < cross { 8.0 * d } else { printed_pogorelov_force(0.5, k, d) };
        let bent = curve(printed, 3.0 * cross);
        let e = estimate(&bent, &UNIT, Combination::SlopeDimple, Formulas::Printed).unwrap();
        near(e.chi, chi, 0.02);
        near(e.bending, chi * k, 0.03);
        near(e.thickness, (9.0 * k).sqrt(), 0.03);
        // a plate, with 3 √k_b of film in the deformation
        let (knee, shift) = (knee_deformation(k), 3.0 * k.sqrt());
        let plate = |d: f64| {
            let d = (d - shift).max(1e-3 * d);
            s * if d < knee {
                knee_force(k) * (d / knee).powf(1.3)
            } else {
                let square =
                    plate_pogorelov_force(k, d).powi(2) - plate_pogorelov_force(k, knee).powi(2);
                (knee_force(k).powi(2) + square).sqrt()
            }
        };
        let e = estimate(
            &curve(plate, 4.0 * knee),
            &UNIT,
            Combination::KneeDimple,
            Formulas::Corrected,
        );
        let e = e.unwrap();
        // the window of the local slope moves so sharp a knee by up to a tenth
        near(e.chi, chi, 0.2);
        near(e.bending, chi * k, 0.1);
        // a soft shell, χ = 0.7
        let (chi, k) = (0.7, 2.7e-3_f64);
        let shell = Shell { law: Law::Hooke, poisson: 0.5 };
        let slope = point_load_slope(&shell, k, 3.0 / chi, 1.07);
        let soft = |d: f64| {
            let cubic = CUBIC_SHARE * cubic_force(0.5, k, 3.0 / chi, 1.07, d);
            chi * k.sqrt() * (slope * d + cubic)
        };
        let e = estimate(&curve(soft, 0.4), &UNIT, Combination::SlopeUpturn, Formulas::Corrected);
        let e = e.unwrap();
        // chords of a cubic, between four hundred points
        near(e.chi, chi, 1e-4);
        near(e.bending, chi * k, 1e-3);
    }

    #[test]
    fn both_plates_read_twice_the_deformation() {
        let d: Vec<f64> = (1..=100).map(|i| 1e-3 * f64::from(i)).collect();
        let f: Vec<f64> = d.iter().map(|d| d + 1e3 * d.powi(3)).collect();
        let twice: Vec<f64> = d.iter().map(|d| 2.0 * d).collect();
        let get = |d: &[f64], reading| {
            let curve = ForceCurve::new(d, &f, reading).unwrap();
            estimate(
                &curve,
                &Known { pressure: 1e4, ..UNIT },
                Combination::SlopeUpturn,
                Formulas::Corrected,
            )
            .unwrap()
        };
        let (one, both) = (get(&d, Reading::OnePole), get(&twice, Reading::BothPlates));
        near(one.chi, both.chi, 1e-12);
    }

    #[test]
    fn curves_without_the_regime_say_so() {
        let hard = |c: &ForceCurve| estimate(c, &UNIT, Combination::SlopeDimple, Formulas::Printed);
        let soft =
            |c: &ForceCurve| estimate(c, &UNIT, Combination::SlopeUpturn, Formulas::Corrected);
        let straight = curve(|d| d, 1.0);
        assert!(matches!(hard(&straight), Err(IdentifyError::NoKnee { share }) if share > 0.9));
        assert!(matches!(soft(&straight), Err(IdentifyError::NoUpturn { power }) if power < 1.1));
        let short = curve(|d| d.min(0.5 + 0.3 * (d - 0.5)), 0.6);
        assert!(matches!(hard(&short), Err(IdentifyError::NoDimple { .. })));
        let flat = Known { pressure: 1e-6, ..UNIT };
        let upturned = curve(|d| d + 100.0 * d.powi(3), 1.0);
        let none = estimate(&upturned, &flat, Combination::SlopeUpturn, Formulas::Corrected);
        assert!(matches!(none, Err(IdentifyError::NoSolution { .. })));
        let bad = |d: &[f64], f: &[f64]| ForceCurve::new(d, f, Reading::OnePole).unwrap_err();
        assert!(matches!(bad(&[1.0], &[]), IdentifyError::Lengths { .. }));
        assert!(matches!(bad(&[1.0, 1.0], &[0.0, 1.0]), IdentifyError::Point { at: 1, .. }));
        assert!(matches!(bad(&[1.0], &[f64::NAN]), IdentifyError::Point { at: 0, .. }));
        assert!(matches!(bad(&[1.0], &[1.0]), IdentifyError::TooFewPoints { found: 1, .. }));
        let none = Known { radius: 0.0, ..UNIT };
        let none = estimate(&straight, &none, Combination::SlopeKnee, Formulas::Printed);
        assert!(matches!(none, Err(IdentifyError::Known { key: "radius", .. })));
    }
}
