//! Periodic orbits against exact ones, against an independent integrator, and against textbooks.
#![allow(clippy::unwrap_used)]

mod curves;
mod embedded;
mod exact;
mod explore;
mod invariance;
mod starts;
pub(crate) mod systems;
mod textbook;

use continuation::cycles::{Cycle, CycleBranch, CycleSettings, trace};
use continuation::{Problem, Progress, Settings};
use std::ops::ControlFlow;

/// The branch of cycles through `start`, by default settings.
fn follow<P: Problem>(problem: &P, name: &str, start: &Cycle, settings: Settings) -> CycleBranch {
    follow_by(problem, name, start, settings, &CycleSettings::default())
}

fn follow_by<P: Problem>(
    problem: &P,
    name: &str,
    start: &Cycle,
    settings: Settings,
    cycles: &CycleSettings,
) -> CycleBranch {
    let observer = &mut |_: &Progress| ControlFlow::Continue(());
    trace(problem, name, start, &settings, cycles, &[], observer).unwrap()
}

/// Every point says at most as little of its errors as is true: `what` is known to be `exact`.
fn assert_within(what: f64, exact: f64, error: f64, most: f64, text: &str) {
    assert!(
        (what - exact).abs() <= error,
        "{text}: {what} {exact}, off {:e}, said {error:e}",
        what - exact
    );
    assert!(error <= most, "{text}: the estimate {error:e} is no better than {most:e}");
}
