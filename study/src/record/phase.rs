//! What a shell does when it is squeezed: the classes of a phase diagram, read off its curve.
//!
//! Four numbers decide. They are taken over the points from the first zero of the force on, where
//! the plate begins to push; `Δ` is the deformation, `F` the force in `√(χk_b)`.
//!
//! | number | meaning |
//! |---|---|
//! | `folds` | folds of the branch: limit points in the plate distance |
//! | `pole_film` | thickest film over the pole, `max (z0 − z(0)) / δ_A` |
//! | `stiffness` | largest tangent stiffness, `max dF/dΔ` |
//! | `softening` | smallest ratio of `dF/dΔ` to the largest before it |
//!
//! 1. *hysteresis*: `folds > 0`. A plate under control of its position jumps there, by snap-in and
//!    pull-off or by buckling, and comes back another way.
//! 2. *buckles*: no folds, and `pole_film > √(5/3)`: the pole has left the plate and a dimple forms.
//!    The film's attraction `−w_int'(δ)` is largest at `δ = √(5/3) δ_A`; a pole farther away than
//!    that is held by the shell, not by the film. The curve softens on the way; the *knee* is where
//!    `dF/dΔ` has first fallen to half of its largest value so far, if it does.
//! 3. *bypasses buckling*: the pole stays on the plate, and `stiffness > 16`, twice the slope of 8
//!    with which a thin shell begins (Reissner). A contact that stays flat while the gas, or
//!    adhesion, holds the shell up stiffens without bound; neither the film nor bending alone
//!    reaches twice that slope.
//! 4. *flat*: the pole stays on the plate, and the shell hardly stiffens.
//!
//! A branch that ended early is of a class only where the rest of it would change nothing: folds
//! are *hysteresis* whatever follows. Otherwise, and where the force never vanishes, it has none.

use crate::record::Table;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Film thickness, in `δ_A`, at which the film attracts most.
const HOLD: f64 = 1.290_994_448_735_805_6;
/// Twice Reissner's slope, in `√(χk_b)/R0`.
const STIFF: f64 = 16.0;
/// Differences over shorter ways than this, in `R0`, are no tangents.
const SHORTEST: f64 = 1e-6;

/// What a shell does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// Its contact stays flat, and the response nearly linear.
    Flat,
    /// A dimple forms.
    Buckles,
    /// Its contact stays flat, and the response stiffens.
    BypassesBuckling,
    /// It jumps, and comes back another way.
    Hysteresis,
    /// Not known.
    Unknown,
}

impl Class {
    /// All of them, in the order of a legend.
    pub const ALL: [Class; 5] =
        [Class::Flat, Class::Buckles, Class::BypassesBuckling, Class::Hysteresis, Class::Unknown];
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Class::Flat => "flat",
            Class::Buckles => "buckles",
            Class::BypassesBuckling => "bypasses-buckling",
            Class::Hysteresis => "hysteresis",
            Class::Unknown => "unknown",
        })
    }
}

/// A curve's class and the numbers that decide it; NaN or `None` where there is nothing to measure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Phase {
    /// The class.
    pub class: Class,
    /// Limit points in the plate distance.
    pub folds: usize,
    /// Thickest film over the pole, in `δ_A`.
    pub pole_film: Option<f64>,
    /// Largest tangent stiffness, in `√(χk_b)/R0`.
    pub stiffness: Option<f64>,
    /// Smallest ratio of the tangent stiffness to the largest before it.
    pub softening: Option<f64>,
    /// Deformation at which the stiffness has fallen to half of its largest value.
    pub knee: Option<f64>,
}

/// The phase of a contact branch: its points, the number of its folds, `δ_A/R0`, and whether it was
/// traced to its end.
pub fn classify(points: &Table, folds: usize, film: f64, complete: bool) -> Phase {
    let deformation = points.numbers("deformation");
    let force = points.numbers("force");
    let plate = points.numbers("z0");
    let pole = points.numbers("pole_height");
    // the first zero of the force is where the deformation is counted from
    let start = deformation.iter().position(|d| d.abs() < 1e-12).unwrap_or(deformation.len());
    let thickest = plate
        .iter()
        .zip(&pole)
        .skip(start)
        .map(|(plate, pole)| (plate - pole) / film)
        .reduce(f64::max);
    let (mut largest, mut softening, mut knee) = (None, None, None);
    let mut from = start;
    for to in start + 1..deformation.len() {
        let way = deformation[to] - deformation[from];
        if way.abs() < SHORTEST {
            continue;
        }
        let tangent = (force[to] - force[from]) / way;
        let most = largest.map_or(tangent, |so_far: f64| so_far.max(tangent));
        largest = Some(most);
        let ratio = if most > 0.0 { tangent / most } else { 1.0 };
        softening = Some(softening.map_or(ratio, |so_far: f64| so_far.min(ratio)));
        if knee.is_none() && ratio < 0.5 {
            knee = Some(deformation[from]);
        }
        from = to;
    }
    let class = match (thickest, largest) {
        _ if folds > 0 => Class::Hysteresis,
        (Some(film), Some(_)) if complete && film > HOLD => Class::Buckles,
        (Some(_), Some(stiffness)) if complete && stiffness > STIFF => Class::BypassesBuckling,
        (Some(_), Some(_)) if complete => Class::Flat,
        _ => Class::Unknown,
    };
    Phase { class, folds, pole_film: thickest, stiffness: largest, softening, knee }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::ContactRow;

    /// A branch whose plate starts at 1.1, where the force vanishes, with `force` and `gap`, the film
    /// over the pole in `δ_A`, as functions of the deformation.
    fn branch(force: impl Fn(f64) -> f64, gap: impl Fn(f64) -> f64) -> Table {
        let mut table = Table::contact();
        for point in 0..=40 {
            let deformation = 0.01 * f64::from(point);
            let z0 = 1.1 - deformation;
            let row = ContactRow {
                z0,
                deformation,
                force: force(deformation),
                pole_height: z0 - 0.1 * gap(deformation),
                ..ContactRow::default()
            };
            table.push(row.cells());
        }
        table
    }

    #[test]
    fn a_linear_response_on_the_plate_is_flat() {
        let phase = classify(&branch(|d| 8.0 * d, |_| 0.8), 0, 0.1, true);
        assert_eq!(phase.class, Class::Flat);
        assert!((phase.stiffness.unwrap() - 8.0).abs() < 1e-9);
        assert!((phase.softening.unwrap() - 1.0).abs() < 1e-9);
        assert_eq!(phase.knee, None);
    }

    #[test]
    fn a_pole_that_leaves_the_plate_buckles_and_has_its_knee() {
        let force = |d: f64| if d < 0.2 { 8.0 * d } else { 1.6 + 2.0 * (d - 0.2) };
        let phase = classify(&branch(force, |d| 0.8 + 5.0 * (d - 0.2).max(0.0)), 0, 0.1, true);
        assert_eq!(phase.class, Class::Buckles);
        assert!((phase.knee.unwrap() - 0.2).abs() < 1e-9, "{phase:?}");
        assert!((phase.softening.unwrap() - 0.25).abs() < 1e-9);
        assert!((phase.pole_film.unwrap() - 1.8).abs() < 1e-9);
        // a pole that the film still holds has not left
        let held = classify(&branch(force, |d| 0.8 + 2.0 * (d - 0.2).max(0.0)), 0, 0.1, true);
        assert_eq!(held.class, Class::Flat);
    }

    #[test]
    fn a_response_that_stiffens_on_the_plate_bypasses_buckling() {
        let phase = classify(&branch(|d| 8.0 * d + 30.0 * d * d, |_| 0.8), 0, 0.1, true);
        assert_eq!(phase.class, Class::BypassesBuckling);
    }

    #[test]
    fn folds_are_hysteresis_even_on_a_branch_that_ended_early() {
        let linear = branch(|d| 8.0 * d, |_| 0.8);
        assert_eq!(classify(&linear, 2, 0.1, true).class, Class::Hysteresis);
        assert_eq!(classify(&linear, 2, 0.1, false).class, Class::Hysteresis);
        assert_eq!(classify(&linear, 0, 0.1, false).class, Class::Unknown);
    }

    #[test]
    fn a_branch_that_never_meets_the_plate_has_no_class() {
        let mut table = Table::contact();
        let row = ContactRow { deformation: f64::NAN, z0: 1.2, ..ContactRow::default() };
        table.push(row.cells());
        let phase = classify(&table, 0, 0.1, true);
        assert_eq!((phase.class, phase.pole_film), (Class::Unknown, None));
        assert_eq!(classify(&Table::contact(), 0, 0.1, true).class, Class::Unknown);
    }
}
