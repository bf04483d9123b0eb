//! Cycles, jumps, folds of devices and Maxwell points.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod support;

use continuation::{Branch, EventKind, Settings, StopReason};
use shell_contact::device::{
    CycleSettings, Direction, LoadedProblem, Loading, RelaxationSettings, balance, free_start,
    loaded_start, maxwell_points, travel, under,
};
use shell_contact::{ContactProblem, Device, Law, trace_contact};
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

fn cycle<P: Loading>(
    problem: &P,
    x: &[f64],
    settings: &CycleSettings,
) -> shell_contact::device::Cycle {
    travel(problem, x, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn grip_branch(problem: &ContactProblem, start: f64, end: f64) -> Branch {
    let settings = Settings { target: Some(end), max_step: Some(0.01), ..Settings::default() };
    trace_contact(problem, start, settings, &mut |_| ControlFlow::Continue(())).unwrap().branch
}

#[test]
fn explore() {
    for (name, problem, start, end) in
        [("fig16", fig16(400), 1.3, 0.55), ("fig12", fig12(400), 1.15, 0.65)]
    {
        let t = std::time::Instant::now();
        let u = free_start(&problem, start).unwrap();
        let c = cycle(&problem, &u, &settings(start, end, 0.01));
        println!(
            "{name}: {:?} closed {} points {} in {:?}",
            c.stopped,
            c.closed,
            c.points.len(),
            t.elapsed()
        );
        for j in &c.jumps {
            let (a, b) = (&c.points[j.before.unwrap()], j.after.map(|k| &c.points[k]));
            println!(
                "  {:?} at {:.12} F {:.9} -> {:?} steps {} diss {:?}",
                j.direction,
                j.parameter,
                a.force,
                b.map(|b| b.force),
                j.steps,
                j.dissipated
            );
        }
        let t = std::time::Instant::now();
        let w = balance(&problem, &c).unwrap();
        println!("  {w:?} dissipated {:?} in {:?}", c.dissipated(), t.elapsed());
        println!("  pull off {:?}", c.pull_off().map(|p| (p.z0, p.force)));
        let t = std::time::Instant::now();
        let branch = grip_branch(&problem, start, end);
        println!("  branch {:?}", t.elapsed());
        let folds: Vec<f64> = branch.events_of(&EventKind::Fold).map(|e| e.p).collect();
        println!("  folds {folds:?}");
        let t = std::time::Instant::now();
        for m in maxwell_points(&problem, &branch) {
            println!(
                "  maxwell {:.12} E {} F {:?} unstable {:?} err {:e}",
                m.parameter, m.potential, m.force, m.unstable, m.error_estimate
            );
        }
        println!("  maxwell {:?}", t.elapsed());
        for device in [
            Device::DeadLoad,
            Device::Cantilever { stiffness: 20.0 },
            Device::Cantilever { stiffness: 200.0 },
        ] {
            let t = std::time::Instant::now();
            println!("  {device:?}");
            for f in under::folds(&problem, &branch, device).unwrap() {
                println!(
                    "    fold z0 {:.10} F {:.10} p {:.10} unstable {:?} {:?} err {:e}",
                    f.z0,
                    f.force,
                    f.parameter,
                    f.unstable_before,
                    f.unstable_after,
                    f.error_estimate
                );
            }
            let loaded = LoadedProblem::new(&problem, device).unwrap();
            let (start, end) = match device {
                Device::DeadLoad => (-1.0, 5.0),
                _ => (start, end),
            };
            let x = match loaded_start(&loaded, start) {
                Ok(x) => x,
                Err(e) => {
                    println!("    {e}");
                    continue;
                }
            };
            println!("    start at z0 {} {:?}", x[x.len() - 1], t.elapsed());
            let c = cycle(
                &loaded,
                &x,
                &settings(start, end, if device == Device::DeadLoad { 0.06 } else { 0.01 }),
            );
            println!(
                "    {:?} closed {} points {} {:?}",
                c.stopped,
                c.closed,
                c.points.len(),
                t.elapsed()
            );
            for j in &c.jumps {
                let (a, b) = (&c.points[j.before.unwrap()], j.after.map(|k| &c.points[k]));
                println!(
                    "    {:?} at {:.12} z {:.9} F {:.9} -> {:?} steps {} diss {:?}",
                    j.direction,
                    j.parameter,
                    a.z0,
                    a.force,
                    b.map(|b| (b.z0, b.force)),
                    j.steps,
                    j.dissipated
                );
            }
            let w = balance(&problem, &c).unwrap();
            println!("    {w:?} dissipated {:?}", c.dissipated());
        }
    }
}
