//! How often 95 % intervals hold the truth: two hundred curves of each of two shells. And how many random shells that
//! buckle are found from generic starts.
//! `cargo bench -p arclen-identify --bench coverage`, with another number of seeds `-- 20`. One thread.
//!
//! Not timed: it prints what is inside, and each interval that misses, and ends with an error if one quantity is
//! held too seldom or too often, or if a grid of starts ends in another minimum than a start at the truth.
#![allow(dead_code, clippy::unwrap_used, clippy::print_stdout, reason = "shared with the tests")]

#[path = "../tests/common/buckling.rs"]
mod buckling;
#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/specimen.rs"]
mod specimen;

use buckling::draw;
use specimen::{KEYS, Specimen, apart, hard, soft};

/// The shares of the seeds, in percent, in which an interval may hold the truth: of honest ones 95 ± 1.5 do
/// (binomial, 200 seeds).
const HONEST: std::ops::RangeInclusive<f64> = 90.0..=98.0;
/// Seeds with which the grid is compared with a start at the truth.
const COMPARED: u64 = 10;
/// Standard deviations that lie between their ends at most: the same minimum, not a second one. Where the cost is as
/// flat as its own numerical error, which differs with the mesh, two ends can be a third of one apart.
const SAME: f64 = 0.5;

/// What is wrong with the intervals of a specimen.
fn faults(specimen: &Specimen, seeds: u64) -> Vec<String> {
    let mut faults = Vec::new();
    for (key, inside) in KEYS.into_iter().zip(specimen.count(0..seeds)) {
        let percent = 100.0 * inside as f64 / seeds as f64;
        let line = format!("{:?}: {key} {inside} of {seeds}: {percent:.1} %", specimen.law);
        println!("{line}");
        if !HONEST.contains(&percent) {
            faults.push(line);
        }
    }
    for seed in 0..COMPARED.min(seeds) {
        let apart = apart(specimen, seed);
        if apart >= SAME {
            faults.push(format!("{:?} {seed}: the grid ends {apart} sd off", specimen.law));
        }
    }
    faults
}

/// Share of the shells that buckle, in percent, that generic starts find at least.
const FOUND: usize = 70;

/// What is wrong with the search where shells buckle: of as many seeds about a quarter are such shells.
fn missed(seeds: u64) -> Vec<String> {
    let drawn = (0..seeds).filter_map(|seed| Some((seed, draw(seed)?)));
    let found: Vec<bool> = drawn.map(|(seed, shell)| shell.is_found(seed)).collect();
    let hits = found.iter().filter(|found| **found).count();
    let line = format!("{hits} of {} shells that buckle are found", found.len());
    println!("{line}");
    if 100 * hits < FOUND * found.len() { vec![line] } else { Vec::new() }
}

fn main() {
    let seeds = std::env::args().skip(1).find_map(|word| word.parse().ok()).unwrap_or(200);
    let mut all = Vec::new();
    for specimen in [hard(), soft()] {
        let start = std::time::Instant::now();
        all.extend(faults(&specimen, seeds));
        println!("{:?}: {:.0} s", specimen.law, start.elapsed().as_secs_f64());
    }
    all.extend(missed(seeds));
    assert!(all.is_empty(), "{all:#?}");
}
