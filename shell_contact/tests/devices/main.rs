//! Loading devices: cycles, jumps, folds, Maxwell points.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

#[path = "../support/mod.rs"]
mod support;

mod cycles;
mod jumps;
mod limits;
mod maxwell;
mod meetings;
mod under;

use continuation::{Branch, Settings};
use shell_contact::device::{
    Cycle, CyclePoint, CycleSettings, Jump, Loading, RelaxationSettings, loaded_start, travel,
};
use shell_contact::{ContactProblem, Device, Law, LoadedProblem, trace_contact};
use std::ops::ControlFlow;
use support::contact;

fn fig16(elements: usize) -> ContactProblem {
    let law = Law::MooneyRivlin { b: 1.0 };
    contact(elements, law, [2.7e-3, 3.0, 2e-2, 1.0 / 30.0, 0.0, 1.07])
}

fn fig12(elements: usize) -> ContactProblem {
    contact(elements, Law::Hooke, [3e-5, 3e-3, 2e-3, 1.0 / 30.0, 0.0, 1.07])
}

fn settings(start: f64, end: f64, max_step: f64) -> CycleSettings {
    let trace = Settings { max_step: Some(max_step), ..Settings::default() };
    CycleSettings { start, end, trace, relaxation: RelaxationSettings::default() }
}

fn go<P: Loading>(problem: &P, x: &[f64], settings: &CycleSettings) -> Cycle {
    travel(problem, x, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// A cycle in a rigid grip.
fn gripped(problem: &ContactProblem, start: f64, end: f64) -> Cycle {
    go(problem, &problem.initial_state(), &settings(start, end, 0.02))
}

/// A cycle under another device.
fn held(problem: &ContactProblem, device: Device, start: f64, end: f64) -> Cycle {
    let loaded = LoadedProblem::new(problem, device).unwrap();
    let x = loaded_start(&loaded, start).unwrap();
    // the parameter counts in the length of a step
    let step = 0.02_f64.max(0.01 * (end - start).abs());
    go(&loaded, &x, &settings(start, end, step))
}

fn grip_branch(problem: &ContactProblem, start: f64, end: f64) -> Branch {
    let settings = Settings { target: Some(end), max_step: Some(0.02), ..Settings::default() };
    trace_contact(problem, start, settings, &mut |_| ControlFlow::Continue(())).unwrap().branch
}

/// The states before and after a jump.
fn ends<'c>(cycle: &'c Cycle, jump: &Jump) -> (&'c CyclePoint, &'c CyclePoint) {
    (&cycle.points[jump.before.unwrap()], &cycle.points[jump.after.unwrap()])
}

#[track_caller]
fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} and {b} differ by {:e}", a - b);
}
