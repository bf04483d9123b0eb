//! A coated microbubble between two plates: shell mechanics, film, gas, and their equilibria.
//!
//! Lytra and Pelekasis (Phys. Fluids 30, 2018), re-derived from the total potential energy; the
//! modules name the equations and where the printed ones are not followed.
//!
//! ```
//! use continuation::Problem;
//! use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell};
//!
//! let shell = Shell { law: Law::Hooke, poisson: 0.5 };
//! let groups = Dimensionless {
//!     bending: 3e-5,
//!     pressure: 3e-3,
//!     adhesion: 2e-6,
//!     film: 1.0 / 30.0,
//!     surface_tension: 0.0,
//!     gas_exponent: 1.07,
//! };
//! let problem = ContactProblem::new(&shell, &groups, Mesh::uniform(100)?)?;
//! let (u, p) = (problem.initial_state(), problem.parameters_at(1.06));
//! let mut residual = vec![0.0; problem.dim()];
//! assert!(problem.residual(&u, &p, &mut residual).is_ok()); // only the film pulls
//! # Ok::<(), shell_contact::ParameterError>(())
//! ```

pub mod asymptotics;
pub mod bending;
#[cfg(test)]
mod certify;
pub mod contact;
pub mod density;
pub mod device;
pub mod discretisation;

#[cfg(test)]
mod dual;
pub mod energy;
pub mod film;
pub mod forward;
pub mod gas;
pub mod half;
pub mod identify;
pub mod landmarks;
pub mod membrane;
pub mod meridian;
pub mod modes;
pub mod observables;
pub mod params;
mod plate;
pub mod quadrature;
pub mod resolution;
pub mod ring_load;
pub mod scalar;
pub mod spline;
pub mod trace;
pub mod two_plates;
pub mod weak_form;

pub use contact::ContactProblem;
pub use device::{Device, LoadedProblem};
pub use meridian::Mesh;
pub use observables::{Observation, Profile};
pub use params::{
    Dimensionless, Law, LawName, ParameterError, Physical, Scales, Shell, Stiffness,
    default_gas_exponent,
};
pub use resolution::Resolution;
pub use ring_load::{RingGroups, RingLoadProblem};
pub use trace::{ContactBranch, force_watches, trace_contact};
