//! Formulas for limits of the model: what a computed curve must approach, and where.
//!
//! Dimensionless as everywhere: lengths in `R0`, forces in `√(χk_b)`, one pole's deformation. Each
//! says its domain of validity; each is tested against the computed state in its limit.
//!
//! | regime | force | here |
//! |---|---|---|
//! | flat cap (Reissner) | `∝ d̂` | [`REISSNER_SLOPE`], [`point_load_slope`] |
//! | knee | | [`knee_deformation`], [`knee_force`] |
//! | dimple (Pogorelov) | `∝ d̂^½` | [`plate_pogorelov_force`], [`point_pogorelov_force`] |
//! | gas | `∝ d̂³` | [`cubic_force`], [`incompressible_force`], [`compressible_force`] |
//! | capillary | | [`Drop`] |
//! | membrane, pressure alone | | [`inflation_pressure`], [`buckling_pressure`] |
//! | adhesion | | [`contact_curvature`], [`derjaguin_pull_off`] |

mod adhesion;
mod dimple;
mod drop;
mod flat_cap;
mod gas;
mod pressure;

pub use adhesion::{contact_curvature, derjaguin_pull_off};
pub use dimple::{
    knee_deformation, knee_force, plate_pogorelov_force, point_pogorelov_force,
    printed_pogorelov_force,
};
pub use drop::Drop;
pub use flat_cap::{REISSNER_SLOPE, point_load_slope};
pub use gas::{CUBIC_SHARE, compressible_force, cubic_force, incompressible_force};
pub use pressure::{buckling_pressure, inflation_pressure};
