//! The matrices and the bordered solver against dense factorisations and eigenvalues of faer.
#![allow(clippy::unwrap_used)]

mod arch;
mod bordered;
mod lanczos;
mod matrices;
mod spectra;
mod support;
