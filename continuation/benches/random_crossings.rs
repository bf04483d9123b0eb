//! A thousand random problems whose crossings are known, in every storage: every crossing is found, none
//! invented, counts are right or said to be uncertain. `cargo bench -p arclen-continuation --bench random_crossings`.
//!
//! Not timed: it ends with an error at the first that fails. The tests run sixty of them.
#![allow(dead_code, clippy::unwrap_used, clippy::print_stdout, reason = "shared with the tests")]

#[path = "../tests/engine/uncertain_counts/crossings.rs"]
mod crossings;
#[path = "../tests/engine/random/mod.rs"]
mod random;

const PROBLEMS: usize = 1000;

fn main() {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for first in 0..threads {
            scope.spawn(move || crossings::random_problems((first..PROBLEMS).step_by(threads)));
        }
    });
    println!("{PROBLEMS} random problems: every crossing found, none invented");
}
