//! How often 95 % intervals hold the truth: a hundred curves of each of two shells.
//! `cargo bench -p arclen-identify --bench coverage`.
//!
//! Not timed: it prints what is inside, and each interval that misses, and ends with an error if one quantity is
//! held too seldom or too often, or if a grid of starts ends in another minimum than a start at the truth.
#![allow(dead_code, clippy::unwrap_used, clippy::print_stdout, reason = "shared with the tests")]

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/specimen.rs"]
mod specimen;

use specimen::{KEYS, Specimen, apart, hard, soft};

/// Of honest intervals 95 ± 2.2 of a hundred hold the truth (binomial).
fn cover(specimen: &Specimen) {
    let inside = specimen.count(0..100);
    for (key, inside) in KEYS.into_iter().zip(inside) {
        println!("{:?}: {key} {inside}/100", specimen.law);
    }
    for (key, inside) in KEYS.into_iter().zip(inside) {
        assert!((90..=98).contains(&inside), "{key}: {inside} of 100");
    }
}

/// The same minimum, not a second one. Where the cost is as flat as its own numerical error, which differs with the
/// mesh, the two ends can be a third of a standard deviation apart.
fn same_minimum(specimen: &Specimen) {
    let apart: Vec<f64> = (0..10).map(|seed| apart(specimen, seed)).collect();
    assert!(apart.iter().all(|apart| *apart < 0.5), "{:?}: {apart:?}", specimen.law);
}

fn main() {
    std::thread::scope(|scope| {
        for specimen in [hard(), soft()] {
            scope.spawn(move || {
                cover(&specimen);
                same_minimum(&specimen);
            });
        }
    });
}
