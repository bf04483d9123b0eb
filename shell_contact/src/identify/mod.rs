//! First estimates of a shell's stiffness from one force-deformation curve.
//!
//! Two regimes of a curve give two moduli: the slope of the flat cap and the square-root law of the
//! dimple, or the knee between them, for hard shells (Fig. 9(a)); the slope and the cubic upturn for
//! soft ones (Fig. 9(b)). [`Formulas::Printed`] are Eqs. (32), (33), (39) and (40) as the paper has
//! them; [`Formulas::Corrected`] are those of [`crate::asymptotics`] that hold between plates.
//!
//! How good they are, on computed curves (found over true):
//!
//! | shell | formulas | `χ` | `h` |
//! |---|---|---|---|
//! | hard, thin film | printed, slope and dimple | 0.25 | 3.9 |
//! | hard, thin film | corrected, knee and dimple | 0.86 | 1.05 |
//! | hard, film of two thicknesses (Fig. 6) | printed, slope and dimple | 0.12 | 6.3 |
//! | hard, film of two thicknesses (Fig. 6) | corrected, knee and dimple | 1.14 | 0.90 |
//! | soft (Fig. 7) | printed, slope and upturn | 0.47 | 1.7 |
//! | soft (Fig. 7) | corrected, slope and upturn | 0.88 | 0.98 |
//! | soft, thin film (Fig. 9(b)) | corrected, slope and upturn | 0.61 | 1.5 |
//!
//! ```
//! use shell_contact::identify::{Combination, ForceCurve, Formulas, Known, Reading, estimate};
//!
//! // a curve that bends over: linear up to 50 nm, then a square root (N, m)
//! let d: Vec<f64> = (1..=200).map(|i| 1e-9 * f64::from(i)).collect();
//! let f: Vec<f64> = d.iter().map(|d| 0.06 * if *d < 5e-8 { *d } else { (5e-8 * d).sqrt() }).collect();
//! let curve = ForceCurve::new(&d, &f, Reading::OnePole)?;
//! let known = Known { radius: 7.9e-6, poisson: 0.33, pressure: 101_325.0, gas_exponent: 1.07 };
//! let shell = estimate(&curve, &known, Combination::KneeDimple, Formulas::Corrected)?;
//! assert!((10e-9..100e-9).contains(&shell.thickness));
//! # Ok::<(), shell_contact::identify::IdentifyError>(())
//! ```
//!
//! Units are the caller's, as long as they are consistent (SI, or lengths in `R0`).

mod curve;
mod fit;

pub use curve::{ForceCurve, Reading};
pub use fit::{Combination, Estimate, Formulas, Known, Part, Regime, estimate};

/// Why a curve gives no estimate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// Deformations and forces are not as many.
    #[error("{deformations} deformations but {forces} forces")]
    Lengths {
        /// Number of deformations.
        deformations: usize,
        /// Number of forces.
        forces: usize,
    },
    /// Too few points in compression.
    #[error("{found} points in compression; at least {needed} are needed")]
    TooFewPoints {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A number that is not finite, or a deformation that does not increase.
    #[error(
        "point {at}: deformation {deformation}, force {force}: the deformation must increase from point to point, and both be finite"
    )]
    Point {
        /// Index of the point.
        at: usize,
        /// Its deformation.
        deformation: f64,
        /// Its force.
        force: f64,
    },
    /// A known quantity outside what it can be.
    #[error("{key} = {value}: must be {allowed}")]
    Known {
        /// Its name.
        key: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The slope never falls to half of its largest value: no dimple formed.
    #[error(
        "no knee: the slope falls to {share:.2} of its largest value, a knee needs 0.5; the shell stays flat or the curve ends too early"
    )]
    NoKnee {
        /// Least share of the largest slope after it.
        share: f64,
    },
    /// The curve ends too soon after the knee, or does not follow a square root there.
    #[error(
        "no dimple regime: after the knee the curve reaches {reach:.2} times its deformation with power {power:.2}; 1.5 times and a power below 0.95 are needed"
    )]
    NoDimple {
        /// Last deformation over that of the knee.
        reach: f64,
        /// Power of the deformation with which the force grows.
        power: f64,
    },
    /// The force does not grow faster than linearly.
    #[error(
        "no upturn: the force ends with the power {power:.2} of the deformation; 1.5 is needed"
    )]
    NoUpturn {
        /// Power of the deformation at the end.
        power: f64,
    },
    /// The formulas have no solution for these numbers.
    #[error("no shell has this curve by these formulas: {why}")]
    NoSolution {
        /// What is impossible.
        why: &'static str,
    },
}
