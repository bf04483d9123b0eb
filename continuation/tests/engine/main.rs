//! The engine's tests, one module for each kind of failure or capability, in one program: what they have in
//! common is compiled once.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod aborted;
mod avoided_crossings;
mod both_ways;
mod branch_access;
mod branches;
mod certainty;
mod close_hopf_points;
mod closed_curves;
mod codim2;
mod counted;
mod cycles;
mod deflation;
mod diagram;
mod differences;
mod disconnected;
mod domains;
mod domes;
mod dynamics;
mod estimates;
mod factors_used_again;
mod fine_scales;
mod flat_folds;
mod infinite_eigenvalues;
mod invariance;
mod malformed;
mod many_modes;
mod multiple;
mod near;
mod polynomial;
mod random;
mod random_polynomials;
mod reported;
mod scaled;
mod separate_hessian;
mod shared;
mod singular_problems;
mod skipped_pairs;
mod starts;
mod step_lengths;
mod storages;
mod symmetric_observables;
mod tolerances;
mod unbounded;
mod uncertain_counts;
mod watches;
mod wrong_derivatives;
