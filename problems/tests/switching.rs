//! Branches that leave the first one: the known points on them, and that they are other branches.

#![allow(clippy::unwrap_used)]

use continuation::{Branch, Criticality, Problem, Settings, Shape, Tracer};
use problems::{On, Setup, Visitor, catalogue, find};
use std::ops::ControlFlow;

/// The first branch and those that leave it, and those that leave them.
struct Explore {
    depth: usize,
    settings: Settings,
}

impl Visitor for Explore {
    type Output = Vec<Branch>;

    fn visit<P: Problem>(self, problem: &P, setup: Setup) -> Vec<Branch> {
        let run = |tracer: Tracer<'_>| tracer.run(&mut |_| ControlFlow::Continue(()));
        let Setup { parameter, u, p, settings, watches } = setup;
        let first = Tracer::new(problem, &parameter, &u, &p, settings).unwrap();
        let mut all = vec![run(first.watching(&watches).unwrap())];
        let mut done = 0;
        for _ in 0..self.depth {
            let known = all.len();
            let level: Vec<Branch> = all[done..].to_vec();
            for branch in level {
                for event in &branch.events {
                    let Some(crossing) = event.crossing() else { continue };
                    for direction in &crossing.leaving {
                        for forward in [true, false] {
                            let settings = self.settings.clone();
                            let tracer = Tracer::leaving(
                                problem, &branch, event, direction, forward, settings,
                            );
                            all.push(run(tracer.unwrap()));
                        }
                    }
                }
            }
            done = known;
        }
        all
    }
}

fn explore(name: &str, depth: usize, domain: (f64, f64), max_points: usize) -> Vec<Branch> {
    let entry = find(name).unwrap();
    let settings = Settings { domain: Some(domain), max_points, ..Settings::default() };
    entry.visit(&entry.request(), Explore { depth, settings }).unwrap()
}

#[test]
fn known_points_on_branches_that_leave_the_first_one() {
    for entry in catalogue() {
        let known: Vec<_> = entry.known.iter().filter(|k| k.on == On::AfterSwitching).collect();
        if known.is_empty() {
            continue;
        }
        let domain = (entry.start.min(entry.end), entry.start.max(entry.end));
        let all = explore(entry.name, 2, domain, 1000);
        for known in known {
            let mut events = all[1..].iter().flat_map(|b| &b.events);
            let met = events.any(|e| e.kind.to_string() == known.kind && known.agrees(e.p));
            assert!(met, "{}: {known:?}", entry.name);
        }
    }
}

/// From the asymmetric branch its own ends are pitchforks, not folds.
#[test]
fn pitchforks_met_from_the_side() {
    let all = explore("enz", 1, (0.0, 40.0), 1000);
    for side in &all[1..] {
        let crossings: Vec<_> = side.events.iter().filter_map(|e| e.crossing()).collect();
        assert_eq!(crossings.len(), 2, "{:?}", side.stopped);
        assert!(crossings.iter().all(|c| c.shape == Shape::Pitchfork && c.from_side));
        assert_eq!(side.events.len(), 6, "two folds on either half, two pitchforks");
    }
}

/// All branches at the double point: two along the axes, two along the diagonals, each both ways.
#[test]
fn four_branches_leave_the_double_point_of_the_square() {
    let all = explore("mittelmann", 1, (0.1, 0.4), 25);
    let trunk = &all[0];
    let double = trunk.events.iter().find_map(|e| e.crossing().filter(|c| c.multiplicity == 2));
    assert_eq!(double.unwrap().leaving.len(), 4);
    for side in &all[1..] {
        assert!(side.points.len() > 20, "{:?}", side.stopped);
        let last = &side.points.last().unwrap().u;
        let mean = last.iter().sum::<f64>() / last.len() as f64;
        let spread = last.iter().map(|u| (u - mean).abs()).fold(0.0, f64::max);
        assert!(spread > 0.05, "not the constant state: {spread}");
    }
    // no two are the same
    for (i, a) in all[1..].iter().enumerate() {
        for b in &all[1..=i] {
            let apart = |a: &Branch, b: &Branch| {
                let (a, b) = (&a.points[10].u, &b.points[10].u);
                a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
            };
            assert!(apart(a, b) > 1e-2);
        }
    }
}

/// The Swift-Hohenberg pattern bifurcates towards smaller λ where the cubic destabilises.
#[test]
fn pitchforks_open_to_the_side_that_the_cubic_terms_say() {
    let all = explore("swift-hohenberg", 1, (-1.0, 1.0), 30);
    for event in &all[0].events {
        let crossing = event.crossing().unwrap();
        assert_eq!(crossing.criticality, Some(Criticality::Subcritical));
        assert!(crossing.curvature < 0.0);
    }
    for side in &all[1..] {
        assert!(side.points[5].p < side.points[0].p, "{:?}", side.stopped);
    }
    let column = explore("euler-column", 1, (9.0, 11.0), 100);
    let crossing = column[0].events[0].crossing().unwrap();
    assert_eq!(crossing.criticality, Some(Criticality::Supercritical));
    // the elastica: λ/λ₁ = (2K(k)/π)², k = sin(α/2) of the end's rotation α
    let rotation = column[1].observables.iter().position(|o| o == "rotation").unwrap();
    let end = column[1].points.last().unwrap();
    let k = (0.5 * end.observables[rotation].abs()).sin();
    let (mut a, mut g) = (1.0_f64, (1.0 - k * k).sqrt());
    for _ in 0..8 {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    let load = (std::f64::consts::PI / a).powi(2); // K = π/(2 agm), λ = (2K)²
    assert!((end.p / load - 1.0).abs() < 1e-5, "{} {load}", end.p);
}
