//! Random shells of all laws at half, usual and double longest step: the same special points and the
//! same end, or a stop that says why. An error where a claim fails.
//!
//! `cargo bench -p arclen-tests --bench random_shells -- 1000` for a thousand shells (some 20 minutes);
//! without a number, forty.
#![allow(clippy::print_stdout, missing_docs)]

use continuation::{Branch, Event, EventKind, Settings, StopReason};
use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell, trace_contact};
use std::ops::ControlFlow;
use std::process::ExitCode;

/// Elements of a mesh.
const ELEMENTS: usize = 300;
/// Longest steps: half the usual one, the usual one, twice that.
const STEPS: [f64; 3] = [0.005, 0.01, 0.02];
/// Error of a place beside what is estimated.
const PLACE: f64 = 1e-9;
/// Part of the comparisons, by resolved branches, that may differ where a branch says that it is in doubt.
const DOUBTFUL: f64 = 0.02;
/// Part of the resolved branches that may end early.
const EARLY: f64 = 0.05;

struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
    fn power(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }
}

/// A shell, and where its branch ends.
fn member(index: u64) -> (Shell, Dimensionless, f64) {
    let mut random = Random(0x5eed ^ index.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    for _ in 0..4 {
        random.next();
    }
    let law = match index % 3 {
        0 => Law::Hooke,
        1 => Law::MooneyRivlin { b: random.next() },
        _ => Law::Skalak,
    };
    let poisson = if index % 3 == 1 { 0.5 } else { random.between(0.2, 0.5) };
    let groups = Dimensionless {
        bending: random.power(1e-7, 1e-1),
        pressure: random.power(1e-4, 1e-1),
        adhesion: random.power(1e-5, 1e-1),
        film: random.power(2e-3, 0.2),
        surface_tension: if random.next() < 0.5 { 0.0 } else { random.between(0.0, 2.0) },
        gas_exponent: 1.07,
    };
    (Shell { law, poisson }, groups, random.between(0.6, 0.9))
}

/// A traced branch, and whether the mesh resolves it; `None` where there is no solution at the start.
fn traced(shell: &Shell, groups: &Dimensionless, end: f64, step: f64) -> Option<(Branch, bool)> {
    let problem = ContactProblem::new(shell, groups, Mesh::uniform(ELEMENTS).ok()?).ok()?;
    let settings = Settings {
        target: Some(end),
        max_step: Some(step),
        domain: Some((f64::NEG_INFINITY, 3.0)),
        max_points: 5000,
        ..Settings::default()
    };
    // a film that attracts strongly reaches far
    let start = 1.1 + 6.0 * groups.film;
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    let branch = [start, 1.6, 2.5]
        .into_iter()
        .find_map(|start| trace_contact(&problem, start, settings.clone(), go_on).ok())?
        .branch;
    let enough = branch.points.iter().all(|point| {
        let p = problem.parameters_at(point.p);
        problem.resolution(&point.u, &p).is_ok_and(|one| one.is_enough())
    });
    Some((branch, enough))
}

/// Whether a branch was followed to its end.
fn is_whole(branch: &Branch) -> bool {
    matches!(
        branch.stopped.reason,
        StopReason::Target | StopReason::Domain | StopReason::ClosedLoop
    )
}

/// Special points but for extrema of the force beside the pull-off, which may coincide with folds.
fn own(branch: &Branch) -> Vec<&Event> {
    let marks = |kind: &EventKind| {
        matches!(kind, EventKind::Fold | EventKind::BranchPoint | EventKind::StabilityChange)
            || ["zero-force", "pull-off"].contains(&kind.to_string().as_str())
    };
    branch.events.iter().filter(|event| marks(&event.kind)).collect()
}

/// The first thing in which two branches differ; of one that stops early, up to there.
fn difference(a: &Branch, b: &Branch) -> Option<String> {
    let (left, right) = (own(a), own(b));
    let whole = is_whole(a) && is_whole(b);
    if whole && left.len() != right.len() {
        return Some(format!("{} special points and {}", left.len(), right.len()));
    }
    for (x, y) in left.iter().zip(&right) {
        let apart = (x.p - y.p).abs() > PLACE + 3.0 * (x.error_estimate + y.error_estimate);
        let counts = (x.unstable_before, x.unstable_after) != (y.unstable_before, y.unstable_after);
        if x.kind != y.kind || apart || counts {
            return Some(format!("{} at {} and {} at {}", x.kind, x.p, y.kind, y.p));
        }
    }
    let ends = (a.points.last()?, b.points.last()?);
    (whole && ends.0.unstable != ends.1.unstable).then(|| "another count at the end".to_owned())
}

fn main() -> ExitCode {
    let number = std::env::args().find_map(|word| word.parse::<u64>().ok()).unwrap_or(40);
    let (mut resolved, mut coarse, mut nowhere, mut early) = (0, 0, 0, 0);
    let (mut wrong, mut doubtful) = (0, 0);
    for index in 0..number {
        let (shell, groups, end) = member(index);
        let all = STEPS.map(|step| traced(&shell, &groups, end, step));
        let [Some(half), Some(usual), Some(double)] = &all else {
            nowhere += 1;
            println!("{index}: no solution at the start");
            continue;
        };
        if !(half.1 && usual.1 && double.1) {
            coarse += 1;
            continue;
        }
        resolved += 1;
        if !is_whole(&usual.0) {
            early += 1;
            println!("{index}: {:?}: {}", usual.0.stopped.reason, usual.0.stopped.detail);
        }
        for (other, step) in [(half, STEPS[0]), (double, STEPS[2])] {
            let Some(what) = difference(&other.0, &usual.0) else { continue };
            // what a doubt says of is no claim
            let claims = other.0.is_certain() && usual.0.is_certain();
            *if claims { &mut wrong } else { &mut doubtful } += 1;
            let word = if claims { "" } else { ", with doubts" };
            println!("{index}, step {step}{word}: {what} ({shell:?}, {groups:?}, to {end})");
        }
    }
    println!(
        "{number} shells: {resolved} resolved, of which {early} end early and {wrong} comparisons \
         differ, {doubtful} more with doubts; {coarse} on too coarse a mesh; {nowhere} without a start"
    );
    let many = doubtful as f64 > DOUBTFUL * resolved as f64;
    if wrong > 0 || many || early as f64 > EARLY * resolved as f64 || nowhere > 0 {
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
