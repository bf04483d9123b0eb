//! The edge of the contact area, and the force that pulls it apart.

use std::f64::consts::PI;

/// Jump of the meridional curvature at the edge of the contact area as the film length vanishes
/// (Seifert and Lipowsky, Phys. Rev. A 42, 4768, 1990): the curvature just outside a flat contact.
pub fn contact_curvature(adhesion: f64, bending: f64) -> f64 {
    (2.0 * adhesion / bending).sqrt()
}

/// Derjaguin's pull-off force in the units of `F̂`: `−2πR0w0/√(χk_b)`.
///
/// Domain: a shell so stiff that it stays a sphere, `w0 ≪ k_b^¾δ_A^½` or so, under a thin film:
/// a rigid sphere under the potential of Eq. (13a) differs by terms of order `(δ_A/R0)²`.
pub fn derjaguin_pull_off(adhesion: f64, bending: f64) -> f64 {
    -2.0 * PI * adhesion / bending.sqrt()
}
