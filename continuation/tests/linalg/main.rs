//! The matrices and the bordered solver against dense factorisations and eigenvalues of faer.
#![allow(clippy::unwrap_used)]

mod arch;
mod arnoldi;
mod arrow;
mod bordered;
mod half_plane;
mod lanczos;
mod matrices;
mod sparse;
mod spectra;
mod support;
