//! The benchmark's ring load (Eq. 27): its flat and its buckled branch, for Fig. 4.
//!
//! The flat branch is followed from small contact angles. The buckled one is not connected with it:
//! beyond the bifurcation the bulge, mirrored in the flat state that a moment at the ring holds, is
//! close to a dimple, from which the branch is followed both ways.

use super::curve::Traced;
use continuation::{Branch, NewtonSettings, Settings, Tracer, Watch, both_ways, newton};
use shell_contact::ring_load::{DEFAULT_GRADING, RingGroups, RingLoadProblem, RingProfile};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// Contact angles between which branches are followed, in radians.
const ANGLES: (f64, f64) = (0.02, 0.44);
/// Contact angles before and beyond the bifurcation, which lies near 0.15.
const BEFORE: f64 = 0.1;
const BEYOND: f64 = 0.2;
/// A moment, in `k_b`, that holds the cap flat from one to the other.
const MOMENT: f64 = -3.0;
/// How far on the other side of the flat state Newton's method starts, in depths of the bulge.
const SHARES: [f64; 4] = [0.6, 0.5, 0.8, 1.1];
const MOMENT_AT: usize = shell_contact::ring_load::parameter::MOMENT.0;
/// A pole this far above the ring, in thicknesses, is where the plate is: the flat branch ends.
const ABOVE: f64 = 0.05;
/// Samples along a meridian.
const SAMPLES: usize = 801;
/// Longest step, an arclength: longer ones hop over the gap of 0.003 between the branches.
const STEP: f64 = 0.0005;

/// A branch of the ring load.
#[derive(Debug, Clone)]
pub(crate) struct RingBranch {
    /// For the legend.
    pub label: &'static str,
    /// Its points.
    pub points: Vec<RingPoint>,
    /// Meridians of stable states that were asked for.
    pub shapes: Vec<RingProfile>,
}

/// A point of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RingPoint {
    /// Contact angle in degrees.
    pub alpha: f64,
    /// Deflection of the ring, in `h`.
    pub deflection: f64,
    /// `10⁶F/(2πEhR0)`.
    pub force: f64,
    /// Energy of the whole shell, in `χR0²`.
    pub energy: f64,
    /// Height of the pole above the ring, in `h`; negative in a dimple.
    pub pole: f64,
    /// Whether it is unstable at fixed height of the ring.
    pub unstable: bool,
}

/// Flat and buckled branch of the shell of a contact case, with the meridians at deflections `wanted`,
/// in `h`; what cannot be followed is left out.
pub(super) fn branches(traced: &Traced, wanted: &[f64], stop: &AtomicBool) -> Vec<RingBranch> {
    let g = traced.problem.groups();
    let groups =
        RingGroups { bending: g.bending, pressure: g.pressure, gas_exponent: g.gas_exponent };
    let elements = traced.problem.mesh().elements();
    let problem = RingLoadProblem::new(traced.problem.shell(), &groups, elements, DEFAULT_GRADING);
    let Ok(problem) = problem else { return Vec::new() };
    let found = [
        ("ring load, flat", flat(&problem, stop)),
        ("ring load, buckled", buckled(&problem, stop)),
    ];
    found
        .into_iter()
        .filter_map(|(label, branch)| {
            let branch = branch?;
            let points = points(&branch);
            let shape = |d: &f64| shape(&problem, &branch, &points, *d);
            let shapes = wanted.iter().filter_map(shape).collect();
            Some(RingBranch { label, points, shapes })
        })
        .collect()
}

/// Meridian of the stable state at a deflection, between the points about it.
fn shape(
    problem: &RingLoadProblem,
    branch: &Branch,
    points: &[RingPoint],
    deflection: f64,
) -> Option<RingProfile> {
    let at = points.windows(2).position(|pair| {
        let crosses = (pair[0].deflection - deflection) * (pair[1].deflection - deflection) <= 0.0;
        crosses && pair.iter().all(|q| !q.unstable)
    })?;
    let share =
        (deflection - points[at].deflection) / (points[at + 1].deflection - points[at].deflection);
    let (a, b) = (&branch.points[at], &branch.points[at + 1]);
    let u: Vec<f64> = a.u.iter().zip(&b.u).map(|(a, b)| a + share * (b - a)).collect();
    let p = problem.parameters_at(a.p + share * (b.p - a.p));
    problem.profile(&u, &p, SAMPLES).ok()
}

fn go_on(stop: &AtomicBool) -> ControlFlow<()> {
    if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

fn flat(problem: &RingLoadProblem, stop: &AtomicBool) -> Option<Branch> {
    let settings = Settings {
        domain: Some(ANGLES),
        increasing: Some(true),
        max_step: Some(STEP),
        ..Settings::default()
    };
    let (u, p) = (problem.initial_state(), problem.parameters_at(ANGLES.0));
    let above = Watch::stop_at("pole_over_h", ABOVE);
    let tracer = Tracer::new(problem, "alpha", &u, &p, settings).ok()?.watching(&[above]).ok()?;
    Some(tracer.run(&mut |_| go_on(stop)))
}

fn buckled(problem: &RingLoadProblem, stop: &AtomicBool) -> Option<Branch> {
    let moment = MOMENT * problem.groups().bending;
    let lead = |u: &[f64], p: &[f64], parameter, target| {
        let settings = Settings { target: Some(target), ..Settings::default() };
        let tracer = Tracer::new(problem, parameter, u, p, settings).ok()?;
        Some(tracer.run(&mut |_| go_on(stop)).points.last()?.u.clone())
    };
    let with = |alpha, moment| {
        let mut p = problem.parameters_at(alpha);
        p[MOMENT_AT] = moment;
        p
    };
    let u = lead(&problem.initial_state(), &with(BEFORE, 0.0), "moment", moment)?;
    let flat = lead(&u, &with(BEFORE, moment), "alpha", BEYOND)?;
    let p = problem.parameters_at(BEYOND);
    let mut bulge = problem.initial_state();
    newton(problem, &mut bulge, &p, &NewtonSettings::default()).ok()?;
    let dimple = SHARES.into_iter().find_map(|share| {
        let mirrored = flat.iter().zip(&bulge).map(|(flat, bulge)| flat + share * (flat - bulge));
        let mut u: Vec<f64> = mirrored.collect();
        newton(problem, &mut u, &p, &NewtonSettings::default()).ok()?;
        let pole = problem.observation(&u, &p).ok()?.pole_over_h;
        (pole < -ABOVE).then_some(u)
    })?;
    let settings = Settings { domain: Some(ANGLES), max_step: Some(STEP), ..Settings::default() };
    both_ways(problem, "alpha", &dimple, &p, settings, &[], &mut |_| go_on(stop)).ok()
}

fn points(branch: &Branch) -> Vec<RingPoint> {
    let at = |name: &str| branch.observables.iter().position(|known| known == name);
    let columns = ["deflection_over_h", "force", "energy_total", "pole_over_h"].map(at);
    branch
        .points
        .iter()
        .map(|q| {
            let [deflection, force, energy, pole] =
                columns.map(|k| k.map_or(f64::NAN, |k| q.observables[k]));
            let unstable = q.unstable.is_some_and(|n| n > 0);
            RingPoint { alpha: q.p.to_degrees(), deflection, force, energy, pole, unstable }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shell_contact::{Law, Shell};

    /// R0/h = 100, ν = 0.3: the buckled branch begins at a fold at 8.789° and F = 112.39.
    #[test]
    fn both_branches_of_the_benchmark_are_found() {
        let groups = RingGroups { bending: 1e-4 / 10.92, pressure: 0.0, gas_exponent: 0.0 };
        let shell = Shell { law: Law::Hooke, poisson: 0.3 };
        let problem = RingLoadProblem::new(&shell, &groups, 100, DEFAULT_GRADING).unwrap();
        let stop = AtomicBool::new(false);
        let flat = points(&flat(&problem, &stop).unwrap());
        assert!(flat.iter().all(|q| !q.unstable || q.pole > 0.0));
        let near = |points: &[RingPoint], alpha: f64| {
            let at = points
                .iter()
                .min_by(|a, b| (a.alpha - alpha).abs().total_cmp(&(b.alpha - alpha).abs()));
            at.unwrap().force
        };
        assert!((near(&flat, 7.0) / 79.17 - 1.0).abs() < 0.02);
        let branch = buckled(&problem, &stop).unwrap();
        let buckled = points(&branch);
        let least = buckled.iter().min_by(|a, b| a.alpha.total_cmp(&b.alpha)).unwrap();
        assert!((least.alpha - 8.789).abs() < 0.02, "{least:?}");
        let deep = buckled.iter().max_by(|a, b| (-a.pole).total_cmp(&-b.pole)).unwrap();
        assert!(deep.pole < -9.0 && !deep.unstable, "{deep:?}");

        // the dimple of 4 h: the rim is 4 h below the undeformed pole, the pole below the rim
        let shape = shape(&problem, &branch, &buckled, 4.0).unwrap();
        let highest = shape.z.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert!((highest - 0.96).abs() < 1e-3, "{highest}");
        assert!(shape.z[0] < 0.94, "{}", shape.z[0]);
    }
}
