//! How often 95 % intervals hold the truth, over noise, optical radii and calibrations of the lever that the
//! tests draw themselves. The intervals are those that `arclen fit` reports when nothing is asked for: of the
//! joint fit, from the profile where one is needed and from the covariance where not.
//!
//! The descents start at the truth; that a grid finds the same minimum, later, the last test sees to. A few seeds:
//! `benches/coverage.rs` has a hundred.
#![allow(dead_code, clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

mod common;
#[path = "common/specimen.rs"]
mod specimen;

use specimen::{apart, hard, soft};

/// Three seeds of each shell: it finds intervals that lie grossly, no more. Of an honest 95 % fewer than 24 of
/// 30 are rare, though the quantities of one fit are not independent.
#[test]
fn a_few_seeds_hold_the_truth() {
    for specimen in [hard(), soft()] {
        let inside = specimen.count(0..3);
        assert!(inside.iter().sum::<u64>() >= 24, "{:?}: {inside:?} of 3", specimen.law);
    }
}

/// A tenth of a standard deviation is what descents are made for.
#[test]
fn a_grid_finds_the_minimum_that_a_start_at_the_truth_does() {
    for specimen in [hard(), soft()] {
        let apart = apart(&specimen, 0);
        assert!(apart < 0.1, "{:?}: {apart} sd", specimen.law);
    }
}
