//! Sensitivities that need no further solve, against differences of branches that are solved anew.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

mod common;

use common::{heights, parameters};
use identify::branch::{Effort, GROUPS, Group, Span, trace};
use identify::model::Model;
use identify::{Key, LawName, Parameters};

const EFFORT: Effort = Effort {
    elements: 60,
    points: 600,
    force_error: 1e-14,
    work: f64::INFINITY,
    max_angle: Effort::ANGLE,
};

/// The end of a branch at a plate height: force, and its sensitivities at that height.
fn end(law: LawName, p: &Parameters, z: f64) -> (f64, [f64; GROUPS]) {
    let span = Span { start: 1.2, end: z, enough: &|_, _| false, stop: &|| false };
    let branch = trace(law, p, &span, Effort { force_error: 1.0, ..EFFORT }, &Group::ALL).unwrap();
    let node = branch.nodes.last().unwrap();
    assert!((node.z - z).abs() < 1e-12);
    (node.force, node.by_group.map(|g| g / node.dz))
}

/// Parameters whose group `group` is moved by `h` and no other.
fn moved(p: &Parameters, group: Group, h: f64) -> Parameters {
    let mut q = *p;
    match group {
        Group::Bending => q[Key::Bending] *= h.exp(),
        Group::Pressure => q[Key::Pressure] *= h.exp(),
        Group::Adhesion => q[Key::Adhesion] *= h.exp(),
        Group::Film => q[Key::Film] *= h.exp(),
        Group::SurfaceTension => q[Key::SurfaceTension] += h * q[Key::Chi],
        Group::GasExponent => q[Key::GasExponent] += h,
        Group::Poisson => q[Key::Poisson] += h,
        Group::MooneyB => q[Key::MooneyB] += h,
    }
    q
}

#[test]
fn groups_agree_with_differences_of_solved_branches() {
    let soft = parameters([0.05, 4e-16, 4e-4, 40e-9, 1.5e-6, 0.06, 0.0]);
    let hard = parameters([30.0, 2e-15, 2e-4, 25e-9, 1.6e-6, 1.2, 0.0]);
    let cases = [
        (LawName::Hooke, hard, 0.97),
        (LawName::Hooke, hard, 1.01),
        (LawName::MooneyRivlin, soft, 0.8),
        (LawName::Skalak, soft, 0.9),
    ];
    for (law, mut p, z) in cases {
        p[Key::Poisson] = 0.4;
        p[Key::MooneyB] = 0.6;
        p[Key::SurfaceTension] = 0.01 * p[Key::Chi];
        let (force, by_group) = end(law, &p, z);
        for group in Group::ALL {
            let h = 2e-4;
            let at = |h: f64| end(law, &moved(&p, group, h), z).0;
            // fourth order
            let slope = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            let found = by_group[group as usize];
            let scale = slope.abs().max(force.abs() * 1e-2);
            assert!(
                (found - slope).abs() < 2e-6 * scale,
                "{law:?} at {z}: {group:?} {found} is {slope}"
            );
        }
    }
}

/// What an instrument reads at fixed piezo heights, by every coordinate.
#[test]
fn readings_agree_with_differences() {
    for (law, contacts) in [(LawName::MooneyRivlin, 2), (LawName::Hooke, 1)] {
        let mut p = parameters([0.3, 4e-16, 3e-4, 40e-9, 1.5e-6, 0.3, 10e-6]);
        p[Key::Offset] = 1e-10;
        p[Key::Tilt] = 1e-5;
        p[Key::Poisson] = 0.4;
        p[Key::MooneyB] = 0.6;
        p[Key::SurfaceTension] = 1e-3;
        let mut curve = heights(10.6e-6, 9.6e-6, 60);
        curve.segments.truncate(1);
        let model = Model { law, contacts, nominal_spring_constant: 0.28, effort: EFFORT };
        let read = |p: &Parameters, keys: &[Key]| {
            let (branch, _) = model.branch(&curve, p, keys).unwrap();
            assert_eq!(branch.stretches.len(), 1);
            model.predict(&curve, &branch, p, keys, 1.0)
        };
        let keys = Key::ALL;
        let found = read(&p, &keys);
        for (k, key) in keys.into_iter().enumerate() {
            let h = match key {
                Key::Contact => 1e-10,
                Key::Offset => 1e-11,
                Key::Tilt => 1e-6,
                Key::SurfaceTension => 1e-5,
                _ => 1e-4,
            };
            let at = |h: f64| {
                let mut q = p;
                q[key] = key.value(key.coordinate(p[key]) + h);
                read(&q, &[]).force
            };
            let (high, low) = (at(h), at(-h));
            let column: Vec<f64> =
                (0..high.len()).map(|i| found.by_key[i * keys.len() + k]).collect();
            let scale = column.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            for i in 0..high.len() {
                let slope = (high[i] - low[i]) / (2.0 * h);
                let off = (column[i] - slope).abs();
                assert!(
                    off <= 2e-3 * scale + 1e-13,
                    "{law:?} {key:?} at sample {i}: {} is {slope}, largest {scale}",
                    column[i]
                );
            }
        }
    }
}

/// Where a stretch ends under the lever, by every coordinate: of a shell that buckles, both ways.
#[test]
fn folds_agree_with_differences() {
    use identify::data::Direction::{Approach, Retract};
    let mut p = parameters([52.5, 3.646e-15, 0.105, 50e-9, 1.5e-6, 15.0, 6e-6]);
    p[Key::Poisson] = 0.4;
    p[Key::SurfaceTension] = 0.05;
    let curve = heights(8e-6, 5.1e-6, 60);
    let effort = Effort { elements: 100, force_error: 1e-11, ..EFFORT };
    let law = LawName::Hooke;
    let model = Model { law, contacts: 2, nominal_spring_constant: 15.0, effort };
    let keys: Vec<Key> = Key::ALL.into_iter().filter(|key| *key != Key::MooneyB).collect();
    let folds = |p: &Parameters| {
        let (branch, _) = model.branch(&curve, p, &keys).unwrap();
        let last = branch.stretches.len() - 1;
        let jumps = branch.jumps(Approach, 0, f64::INFINITY);
        assert_eq!(branch.jumps(Retract, last, f64::NEG_INFINITY).len(), jumps.len());
        assert_eq!((last, jumps.len()), (1, 1));
        [branch.fold(0, Approach, &keys), branch.fold(1, Retract, &keys)]
    };
    let found = folds(&p);
    for (k, key) in keys.iter().enumerate() {
        let h = if key.is_logarithmic() || *key == Key::GasExponent { 1e-3 } else { 1e-4 };
        let at = |h: f64| {
            let mut q = p;
            q[*key] = key.value(key.coordinate(p[*key]) + h);
            folds(&q)
        };
        // baseline and contact point are the reader's
        let own = !matches!(key, Key::Contact | Key::Offset | Key::Tilt);
        let (high, low) = if own { (at(h), at(-h)) } else { (found.clone(), found.clone()) };
        for end in 0..2 {
            let slope = (high[end].0 - low[end].0) / (2.0 * h);
            let off = (found[end].1[k] - slope).abs();
            assert!(
                off <= 5e-3 * slope.abs() + 1e-10,
                "{key:?} {end}: {:e} is {slope:e}",
                found[end].1[k]
            );
        }
    }
}
