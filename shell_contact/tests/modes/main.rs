//! Modes that are not axisymmetric or not mirror images: exact spectra, and onsets along branches
//! against an independent solver.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../support/mod.rs"]
mod support;

mod along;
mod flicker;
mod onsets;
mod spectra;
