//! The shell from pole to pole: against the half model where it is its own mirror image, and
//! against the independent solver where it is not.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use continuation::diagram::{Diagram, DiagramSettings, Explorer};
use continuation::linalg::Matrix;
use continuation::{
    Branch, EventKind, NewtonSettings, Point, Problem, Progress, Settings, Shape, StopReason,
    Tracer, Watch, both_ways, newton,
};
use shell_contact::half::HalfMeridian;
use shell_contact::modes::{AsymmetricModes, Parity, ScanSettings, WholeModes, scan_branch};
use shell_contact::quadrature::gauss_legendre;
use shell_contact::two_plates::{
    ForkError, Half, Plate, Side, Support, SupportedProblem, TwoPlatesGroups, TwoPlatesProblem,
    follow_asymmetric, leave_symmetry, next_unconnected, spring_pairs,
};
use shell_contact::{ContactProblem, Law, trace_contact};
use std::ops::ControlFlow;
use support::{contact, walk};

const FILM: f64 = 1.0 / 30.0;
const FIG12: [f64; 6] = [3e-5, 3e-3, 2e-3, FILM, 0.0, 1.07];
const FIG16: [f64; 6] = [2.7e-3, 3.0, 2e-2, FILM, 0.0, 1.07];
const MOONEY: Law = Law::MooneyRivlin { b: 1.0 };

fn whole(half: &ContactProblem) -> TwoPlatesProblem {
    let groups = TwoPlatesGroups::equal(half.groups());
    TwoPlatesProblem::new(half.shell(), &groups, half.mesh().clone()).unwrap()
}

fn negatives<P: Problem>(problem: &P, u: &[f64], p: &[f64]) -> usize {
    let mut j = problem.new_jacobian();
    problem.jacobian(u, p, &mut j).unwrap();
    let floor = f64::EPSILON * j.norm();
    j.factor(floor).inertia.unwrap().0
}

fn near(got: f64, want: f64, tolerance: f64) {
    assert!((got - want).abs() <= tolerance, "{got} is not {want} to {tolerance:e}");
}

/// States along the whole branch of Fig. 12: forces, volume, energies and pressure are those of
/// the half model, the residual vanishes as it does there, and the negative eigenvalues are the
/// symmetric and the antisymmetric ones together.
#[test]
fn mirror_symmetric_states_are_those_of_the_half_model() {
    let half = contact(100, Law::Hooke, FIG12);
    let whole = whole(&half);
    let mut modes = AsymmetricModes::new(half.mesh());
    let (mut visited, mut seen) = (0, [0; 3]);
    walk(&half, 1.15, 0.7, |_, point| {
        visited += 1;
        if visited % 5 > 0 {
            return;
        }
        let (p, q) = (half.parameters_at(point.z0), whole.parameters_at(point.z0));
        let u = whole.joined(&point.u, &point.u, 0.0);
        let mut r = vec![0.0; whole.dim()];
        whole.residual(&u, &q, &mut r).unwrap();
        assert!(r.iter().all(|r| r.abs() < 1e-12), "not an equilibrium at {}", point.z0);
        let one = half.observation(&point.u, &p).unwrap();
        let two = whole.observation(&u, &q).unwrap();
        let pairs = one.to_array().into_iter().zip(two.whole.to_array());
        for (one, two) in pairs.filter(|(one, _)| one.is_finite()) {
            near(two, one, 1e-12 * one.abs().max(1.0));
        }
        near(two.force_bottom, one.force, 1e-12 * one.force.abs().max(1.0));
        assert_eq!(two.contact_radius_bottom.is_nan(), one.contact_radius.is_nan());
        near(two.shift, 0.0, 1e-15);
        near(two.pole_top, one.pole_height, 1e-13);
        near(two.pole_bottom, one.pole_height, 1e-13);
        modes.assemble(&half, &point.u, &p).unwrap();
        let odd = modes.count(0, Parity::Antisymmetric);
        let even = negatives(&half, &point.u, &p);
        let all = negatives(&whole, &u, &q);
        assert!(odd.certain);
        assert_eq!(all, even + odd.negative, "at {}", point.z0);
        seen[all] += 1;
    });
    // none, one and two: stable, one kind unstable, and both
    assert!(seen.iter().all(|count| *count > 0), "{seen:?}");
}

/// A state of the independent solver; lengths in `R0`, `poles` and `shift` above and below the
/// mid-plane, `poles` at the first Gauss point.
struct Reference {
    z0: f64,
    force: f64,
    energy: f64,
    volume: f64,
    gas: f64,
    poles: [f64; 2],
    shift: f64,
}

/// Height of a half at its first Gauss point, towards its plate.
fn first_height(problem: &TwoPlatesProblem, u: &[f64], side: Side) -> f64 {
    let mesh = problem.mesh();
    let first = gauss_legendre(mesh.gauss_points())[0].0 * mesh.knots().at(1);
    Half::new(mesh, side).place(u, first).z[0]
}

/// Against what the independent solver has on the same mesh, to its own accuracy.
fn agrees(problem: &TwoPlatesProblem, u: &[f64], want: &Reference) {
    let seen = problem.observation(u, &problem.parameters_at(want.z0)).unwrap();
    let whole = &seen.whole;
    for (got, want) in [
        (whole.force, want.force),
        (seen.force_bottom, want.force),
        (whole.energy_total, want.energy),
        (whole.volume, want.volume),
        (whole.gas_pressure, want.gas),
        (first_height(problem, u, Side::Top), want.poles[0]),
        (first_height(problem, u, Side::Bottom), want.poles[1]),
    ] {
        near(got, want, 1e-9);
    }
    // known between the Gauss points beside the equator: less than its meshes differ by
    near(seen.shift, want.shift, 1e-8);
    // no force is lost between the plates
    near(whole.force, seen.force_bottom, 1e-11 * whole.force.abs().max(1.0));
}

/// The state at the first parameter of `p` on the branch that comes from the state near `x` with
/// that at 1.15.
fn approach<P: Problem>(problem: &P, x: &mut [f64], p: &[f64]) {
    let mut start = p.to_vec();
    start[0] = 1.15;
    let settings = Settings { target: Some(p[0]), max_step: Some(0.01), ..Settings::default() };
    let name = &problem.parameters()[0].name;
    let tracer = Tracer::new(problem, name, x, &start, settings).unwrap();
    let branch = tracer.run(&mut |_| ControlFlow::Continue(()));
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
    x.copy_from_slice(&branch.points.last().unwrap().u);
}

/// The branch of a half between the plates at `start` and at `end`.
fn symmetric_branch(half: &ContactProblem, start: f64, end: f64) -> Branch {
    let settings = Settings { target: Some(end), max_step: Some(0.01), ..Settings::default() };
    let go_on = &mut |_: &Progress| ControlFlow::Continue(());
    trace_contact(half, start, settings, go_on).unwrap().branch
}

/// The asymmetric state at `z0` with a force in `forces` that is found from two springs.
fn from_pair(half: &ContactProblem, z0: f64, forces: [f64; 2]) -> Vec<f64> {
    let whole = whole(half);
    let pairs = spring_pairs(&whole, &symmetric_branch(half, 1.75, 0.7), z0);
    let mut fit = pairs.iter().filter(|pair| (forces[0]..=forces[1]).contains(&pair.force));
    let pair = fit.next().expect("two states of equal force");
    assert!(fit.next().is_none(), "one pair between these forces");
    let mut u = pair.u.clone();
    newton(&whole, &mut u, &whole.parameters_at(z0), &NewtonSettings::default()).unwrap();
    // good to a few percent as it stands
    let seen = whole.observation(&u, &whole.parameters_at(z0)).unwrap();
    near(seen.whole.force, pair.force, 0.05 * pair.force.abs().max(0.1));
    u
}

/// The diagram from the symmetric state at 1.15 to `end`, with a point wherever `z0` is `landing`.
fn diagram(whole: &TwoPlatesProblem, end: f64, landing: f64) -> Diagram {
    let trace = Settings { target: Some(end), max_step: Some(0.01), ..Settings::default() };
    let settings = DiagramSettings { trace, depth: 1, search: None, ..DiagramSettings::default() };
    let (u, p) = (whole.initial_state(), whole.parameters_at(1.15));
    let watches = [Watch::extremum("force"), Watch::Parameter { value: landing }];
    let explorer = Explorer::new(whole, "z0", &u, &p, settings, &watches).unwrap();
    explorer.run(&mut |_| ControlFlow::Continue(())).unwrap()
}

/// The stable state at `z0` on a branch of the diagram that lost its symmetry.
fn from_fork(whole: &TwoPlatesProblem, end: f64, z0: f64) -> Vec<f64> {
    let diagram = diagram(whole, end, z0);
    let mut points = diagram.branches[1..].iter().flat_map(|one| &one.branch.points);
    let at = |q: &&Point| q.p == z0 && q.unstable == Some(0);
    points.find(at).expect("a stable state").u.clone()
}

#[test]
fn asymmetric_states_are_those_of_the_independent_solver() {
    let fig12 = [
        Reference {
            z0: 0.8,
            force: 1.177567875971022,
            energy: -0.0025683745137407834,
            volume: 3.784513796445028,
            gas: 0.00334414628957307,
            poles: [0.5475995049284692, 0.6855079464969902],
            shift: 0.04608020249066823,
        },
        Reference {
            z0: 0.8,
            force: 1.1775676106077972,
            energy: -0.0025683753585788605,
            volume: 3.7845139058766866,
            gas: 0.0033441461861060543,
            poles: [0.5475994931392985, 0.6855076932444215],
            shift: 0.04608016464740905,
        },
    ];
    let fig16 = [
        Reference {
            z0: 1.07,
            force: -1.4255377194823804,
            energy: -0.013789899758244534,
            volume: 4.198477035733025,
            gas: 2.9925944064270116,
            poles: [1.037498565153207, 1.041461177758971],
            shift: 0.03897083899732439,
        },
        Reference {
            z0: 1.07,
            force: -1.4255377268000038,
            energy: -0.013789899823475529,
            volume: 4.198477035739802,
            gas: 2.9925944064218424,
            poles: [1.037498544483225, 1.0414612301721713],
            shift: 0.03897083830343595,
        },
    ];
    // on one plate alone: the other is far away
    let one_plate = [
        Reference {
            z0: 1.2,
            force: -0.013187761238197648,
            energy: -0.020534431829751957,
            volume: 4.171715536063119,
            gas: 3.013140284343887,
            poles: [1.1667661105032487, 0.6076198562262056],
            shift: 0.39717035608069967,
        },
        Reference {
            z0: 1.2,
            force: -0.013187761155801114,
            energy: -0.020534431998474056,
            volume: 4.17171553580383,
            gas: 3.013140284544276,
            poles: [1.1667661118755837, 0.6076199674228321],
            shift: 0.39717034384574273,
        },
    ];
    // by a fork of the symmetric branch, or where no fork leads by two springs
    let cases = [
        (Law::Hooke, FIG12, fig12, Some(0.79)),
        (MOONEY, FIG16, fig16, Some(1.05)),
        (MOONEY, FIG16, one_plate, None),
    ];
    for (law, d, references, end) in cases {
        for (elements, want) in [200, 400].into_iter().zip(&references) {
            let half = contact(elements, law, d);
            let whole = whole(&half);
            let mut u = match end {
                Some(end) => from_fork(&whole, end, want.z0),
                None => from_pair(&half, want.z0, [-0.05, 0.0]),
            };
            // which plate is which does not matter: the mirror image is a state too
            if (first_height(&whole, &u, Side::Top) - want.poles[0]).abs() > 1e-4 {
                u = whole.reflected(&u);
            }
            agrees(&whole, &u, want);
            assert_eq!(negatives(&whole, &u, &whole.parameters_at(want.z0)), 0);
        }
    }
}

/// One plate alone, the equator held: the force is that of the state in which the other plate is
/// out of reach, and the multiplier carries it.
#[test]
fn one_plate_pulls_against_a_held_equator() {
    let half = contact(100, MOONEY, FIG16);
    let groups = TwoPlatesGroups {
        bottom: Plate { adhesion: 0.0, film: FILM },
        ..TwoPlatesGroups::equal(half.groups())
    };
    let shell = TwoPlatesProblem::new(half.shell(), &groups, half.mesh().clone()).unwrap();
    let held = Support { held: true, ..Support::default() };
    let problem = SupportedProblem::new(&shell, held).unwrap();
    let (mut x, p) = (problem.state(&shell.initial_state(), 0.0), problem.parameters_at(1.06));
    approach(&problem, &mut x, &p);
    let (seen, z0) = problem.observation(&x, &p).unwrap();
    assert_eq!((z0, seen.force_bottom), (1.06, 0.0));
    near(seen.shift, 0.0, 1e-13);
    let unit = 2.0 * std::f64::consts::PI / 2.7e-3_f64.sqrt();
    near(unit * x[shell.dim()], seen.whole.force, 1e-9);
    assert!(seen.whole.force < -0.5, "{}", seen.whole.force);
    // one negative eigenvalue is the multiplier's
    assert_eq!(negatives(&problem, &x, &p), 1);
    assert_eq!(problem.multipliers(), 1);
}

/// A cantilever above a rigid plate: `base = z_t − F/k_c`, and a stiff one is a rigid plate.
#[test]
fn a_cantilever_gives_way_by_its_force() {
    let half = contact(100, Law::Hooke, FIG12);
    let shell = whole(&half);
    let softer = |stiffness: f64, base: f64| {
        let support = Support { spring: Some(stiffness), ..Support::default() };
        let problem = SupportedProblem::new(&shell, support).unwrap();
        let (mut x, p) = (problem.state(&shell.initial_state(), base), problem.parameters_at(base));
        approach(&problem, &mut x, &p);
        let (seen, z0) = problem.observation(&x, &p).unwrap();
        near(2.0 * z0, 2.0 * base + seen.whole.force / stiffness, 1e-11);
        near(seen.whole.force, seen.force_bottom, 1e-9);
        // the shell does not see what holds its plates
        let mut u = x[..shell.dim()].to_vec();
        let lift = z0 - x[shell.dim()];
        let n = half.mesh().elements();
        for k in 0..=2 * n {
            u[if k == 2 * n { 2 * k - 1 } else { 2 * k }] += lift;
        }
        let q = shell.parameters_at(z0);
        newton(&shell, &mut u, &q, &NewtonSettings::default()).unwrap();
        near(shell.observation(&u, &q).unwrap().whole.force, seen.whole.force, 1e-9);
        seen.whole.force
    };
    let mut rigid = shell.initial_state();
    let q = shell.parameters_at(1.05);
    approach(&shell, &mut rigid, &q);
    let rigid = shell.observation(&rigid, &q).unwrap().whole.force;
    assert!((softer(1e6, 1.05) - rigid).abs() < 1e-4 * rigid.abs());
    assert!((softer(20.0, 1.05) - rigid).abs() > 1e-2 * rigid.abs());
}

/// Fig. 12 from pole to pole: every loss of symmetry of the half model is a pitchfork here, at the
/// place that the half model's antisymmetric modes have, and every branch that leaves one ends at
/// another or at a bound.
#[test]
fn forks_are_where_antisymmetric_modes_turn() {
    let half = contact(200, Law::Hooke, FIG12);
    let whole = whole(&half);
    let diagram = diagram(&whole, 0.7, 0.8);
    let trunk = &diagram.branches[0].branch;
    let forks: Vec<f64> = trunk.events_of(&EventKind::BranchPoint).map(|event| event.p).collect();
    let symmetric = symmetric_branch(&half, 1.15, 0.7);
    let go_on = &mut |_| ControlFlow::Continue(());
    let scanned = scan_branch(&half, &symmetric, &ScanSettings::default(), go_on).unwrap();
    let turns = scanned.events.iter().filter(|event| event.n == 0);
    let turns: Vec<f64> = turns.map(|event| event.z0).collect();
    // the independent solver's, on 200 elements
    assert_eq!((forks.len(), turns.len()), (5, 5));
    for (fork, turn) in forks.iter().zip(&turns) {
        near(*fork, *turn, 1e-9);
    }
    // of all but the one beside the fold, nearer than differences tell, the form is known
    let shapes = trunk.events_of(&EventKind::BranchPoint).filter_map(|e| e.crossing());
    let shapes: Vec<Shape> = shapes.map(|crossing| crossing.shape).collect();
    assert_eq!(shapes, [Shape::Pitchfork; 4]);
    for one in &diagram.branches[1..] {
        let reason = one.branch.stopped.reason;
        let ends = [StopReason::Domain, StopReason::ClosedLoop, StopReason::Retraced];
        assert!(ends.contains(&reason), "{}: {:?}", one.id, one.branch.stopped);
        // equal forces on both plates all along
        let bottom = one.branch.observables.iter().position(|o| o == "force_bottom").unwrap();
        for point in &one.branch.points {
            near(point.observables[0], point.observables[bottom], 1e-8);
        }
    }
    // the pair of folds beyond the upper fork, and of counts
    let loops =
        diagram.branches.iter().find(|one| one.branch.stopped.reason == StopReason::ClosedLoop);
    let folds: Vec<f64> = loops.unwrap().branch.events_of(&EventKind::Fold).map(|e| e.p).collect();
    assert_eq!(folds.len(), 4);
    assert!(
        folds.iter().all(|p| (p - 0.8228).abs() < 1e-4 || (p - 0.7633).abs() < 1e-4),
        "{folds:?}"
    );
}

/// Flat above and buckled below: no fork of the symmetric branch leads there, two springs do.
#[test]
fn branches_that_no_fork_leads_to_are_found_by_two_springs() {
    let half = contact(100, Law::Hooke, FIG12);
    let whole = whole(&half);
    let symmetric = symmetric_branch(&half, 1.15, 0.65);
    let diagram = diagram(&whole, 0.65, 0.8);
    let known: Vec<&Branch> = diagram.branches.iter().map(|one| &one.branch).collect();
    let at = [0.83, 0.82, 0.81, 0.79, 0.76, 0.72, 0.68];
    let found = next_unconnected(&whole, &symmetric, &known, &at).expect("a state of its own");
    let settings =
        Settings { domain: Some((0.65, 1.15)), max_step: Some(0.01), ..Settings::default() };
    let go_on = &mut |_: &Progress| ControlFlow::Continue(());
    let p = whole.parameters_at(found.z0);
    let branch = both_ways(&whole, "z0", &found.u, &p, settings, &[], go_on).unwrap();
    // part of it is stable, one dimple much deeper than the other, and it is not found again
    let [top, bottom] =
        ["pole_top", "pole_bottom"].map(|o| branch.observables.iter().position(|name| name == o));
    let differ = |q: &&Point| {
        let poles = [top, bottom].map(|k| q.observables[k.unwrap()]);
        q.unstable == Some(0) && (poles[0] - poles[1]).abs() > 0.1
    };
    assert!(branch.points.iter().filter(differ).count() > 5);
    let known: Vec<&Branch> = known.into_iter().chain([&branch]).collect();
    let next = next_unconnected(&whole, &symmetric, &known, &[found.z0]);
    assert!(next.is_none_or(|next| (next.plates[0] - found.plates[0]).abs() > 1e-6));
}

/// Forks of the symmetric branch are left in the half model's terms; the one beside the fold, where
/// flat and buckled shapes nearly cross, is reached from two springs. Each branch ends at another fork
/// or at a bound, and none runs into its own mirror image.
#[test]
fn every_fork_is_left_or_reached() {
    let half = contact(100, Law::Hooke, FIG12);
    let whole = whole(&half);
    let mut symmetric = symmetric_branch(&half, 1.15, 0.7);
    let go_on = &mut |_| ControlFlow::Continue(());
    let scanned = scan_branch(&half, &symmetric, &ScanSettings::default(), go_on).unwrap();
    let settings =
        Settings { domain: Some((0.7, 1.15)), max_step: Some(0.01), ..Settings::default() };
    let watches = [Watch::extremum("force")];
    let (mut left, mut sharp) = (Vec::new(), Vec::new());
    for fork in scanned.events.iter().rev().filter(|event| event.n == 0) {
        let at = fork.after_point + 1;
        let state = Point { u: fork.u.clone(), p: fork.z0, ..symmetric.points[at].clone() };
        symmetric.points.insert(at, state);
        let go_on = &mut |_: &Progress| ControlFlow::Continue(());
        let (settings, unstable) = (settings.clone(), Some(0));
        match leave_symmetry(&whole, &symmetric, at, unstable, settings, &watches, go_on) {
            Ok(branch) => left.push((fork.z0, branch)),
            Err(error) => {
                assert_eq!(error, ForkError::TooSharp);
                sharp.push(fork.z0);
            }
        }
    }
    assert_eq!((left.len(), sharp.len()), (4, 1));
    for (z0, branch) in &left {
        let [first, last] = [&branch.points[0], &branch.points[branch.points.len() - 1]];
        assert_eq!((first.p, first.unstable), (*z0, Some(0)));
        match branch.stopped.reason {
            // the loop between the two deep forks, from either
            StopReason::Retraced => {
                let other = if *z0 < 0.8 { 0.821_817 } else { 0.777_923 };
                near(last.p, other, 1e-6);
            }
            StopReason::Domain => assert!(last.p == 0.7 || last.p == 1.15),
            reason => panic!("{z0}: {reason}"),
        }
    }
    let known: Vec<&Branch> = left.iter().map(|(_, branch)| branch).collect();
    let found = next_unconnected(&whole, &symmetric, &known, &[sharp[0] + 1e-3]).unwrap();
    let go_on = &mut |_: &Progress| ControlFlow::Continue(());
    let branch = follow_asymmetric(&whole, &found.u, found.z0, settings, &watches, go_on).unwrap();
    // from the bound, where one pole is flat and the other buckled, to the sharp fork
    let [first, last] = [&branch.points[0], &branch.points[branch.points.len() - 1]];
    let reasons = (branch.began.as_ref().unwrap().reason, branch.stopped.reason);
    let (bound, end) = match reasons {
        (StopReason::Domain, StopReason::Retraced) => (first, last),
        (StopReason::Retraced, StopReason::Domain) => (last, first),
        other => panic!("{other:?}"),
    };
    assert_eq!((bound.p, bound.unstable), (0.7, Some(0)));
    near(end.p, sharp[0], 1e-6);
    let folds: Vec<f64> = branch.events_of(&EventKind::Fold).map(|event| event.p).collect();
    assert_eq!(folds.len(), 1);
    near(folds[0], 0.874_23, 1e-4);
    // one image only: the upper plate is the same one's all along
    let shift = branch.observables.iter().position(|name| name == "shift").unwrap();
    let side = bound.observables[shift].signum();
    assert!(branch.points.iter().all(|point| point.observables[shift] * side > -1e-6));
    assert!(branch.points.windows(2).all(|pair| pair[0].s < pair[1].s) && first.s == 0.0);
    for event in &branch.events {
        assert_eq!(branch.points[event.point].p, event.p);
    }
}

/// A point at which no antisymmetric mode turns leads nowhere; nor does one that is not there.
#[test]
fn what_is_no_fork_is_refused() {
    let half = contact(60, Law::Hooke, FIG12);
    let whole = whole(&half);
    let symmetric = symmetric_branch(&half, 1.15, 0.95);
    let leave = |at: usize| {
        let settings =
            Settings { domain: Some((0.9, 1.15)), max_step: Some(0.01), ..Settings::default() };
        let go_on = &mut |_: &Progress| ControlFlow::Continue(());
        leave_symmetry(&whole, &symmetric, at, None, settings, &[], go_on)
    };
    assert_eq!(leave(symmetric.points.len()), Err(ForkError::NoPoint));
    let last = symmetric.points.len() - 1;
    assert!(leave(last).is_err(), "{:?}", leave(last).map(|branch| branch.points.len()));
}

/// About mirror images the whole meridian has the modes of both parities, for every number of waves.
#[test]
fn modes_of_mirror_images_are_those_of_both_parities() {
    for (law, d, start) in [(Law::Hooke, FIG12, 1.15), (MOONEY, FIG16, 1.3)] {
        let half = contact(60, law, d);
        let whole = whole(&half);
        let (mut halves, mut modes) =
            (AsymmetricModes::new(half.mesh()), WholeModes::new(half.mesh()));
        let mut seen = 0;
        for point in symmetric_branch(&half, start, 0.7).points.iter().step_by(5) {
            halves.assemble(&half, &point.u, &half.parameters_at(point.p)).unwrap();
            let u = whole.joined(&point.u, &point.u, 0.0);
            modes.assemble(&whole, &u, &whole.parameters_at(point.p)).unwrap();
            near(modes.wave_bound(), halves.wave_bound(), 1e-9);
            let (one, two) = (halves.scan(40), modes.scan(40));
            assert_eq!((one.n_max, one.first_n, one.modes), (two.n_max, two.first_n, two.modes));
            assert_eq!(one.certain, two.certain, "at {}", point.p);
            for (one, two) in one.by_wave.iter().zip(&two.by_wave) {
                assert_eq!(one[0].negative + one[1].negative, two.negative, "at {}", point.p);
            }
            seen += two.modes;
        }
        // the hard shell loses its circular shape, the soft one never
        assert_eq!(seen > 20, law == Law::Hooke, "{seen}");
    }
}

/// Modes with waves about asymmetric states, against the independent solver; a mirror image has as
/// many.
#[test]
fn modes_of_asymmetric_states_are_those_of_the_independent_solver() {
    let half = contact(200, Law::Hooke, FIG12);
    let whole = whole(&half);
    let mut modes = WholeModes::new(half.mesh());
    for (z0, known) in [
        (0.815, [2, 2, 2, 1, 1, 1, 1, 1, 0]),
        (0.8, [2, 2, 2, 1, 1, 1, 1, 1, 0]),
        (0.79, [2, 2, 2, 2, 1, 1, 1, 1, 1]),
    ] {
        let u = from_fork(&whole, 0.775, z0);
        for u in [whole.reflected(&u), u] {
            modes.assemble(&whole, &u, &whole.parameters_at(z0)).unwrap();
            let scan = modes.scan(40);
            let counts: Vec<usize> = scan.by_wave.iter().map(|count| count.negative).collect();
            assert_eq!(counts[1..10], known, "at {z0}: {counts:?}");
            assert!(
                scan.certain
                    && scan.first_n == Some(counts.iter().position(|n| *n > 0).unwrap() + 1)
            );
            assert_eq!(scan.modes, counts.iter().sum::<usize>());
        }
    }
}
