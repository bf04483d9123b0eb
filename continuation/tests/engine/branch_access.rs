//! What a user takes from a branch: columns, CSV, restarts, critical eigenvectors.

#![allow(clippy::unwrap_used)]

use continuation::samples::Cusp;
use continuation::{
    BoxedResidual, Branch, DenseProblem, Eigenvector, Event, EventKind, Settings, StopReason,
    TraceError, Tracer, Watch,
};
use std::io::ErrorKind;

fn cusp(target: f64) -> Branch {
    let settings = Settings { target: Some(target), ..Settings::default() };
    let tracer = Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings).unwrap();
    tracer.watching(&[Watch::zero("x")]).unwrap().run_quietly()
}

#[test]
fn columns_are_found_by_name() {
    let branch = cusp(2.0);
    let of = |name: &str| branch.column(name).unwrap();
    for (k, point) in branch.points.iter().enumerate() {
        assert_eq!((of("mu")[k], of("s")[k], of("dp_ds")[k]), (point.p, point.s, point.dp_ds));
        assert_eq!((of("x")[k], of("u[0]")[k]), (point.u[0], point.u[0]));
        assert_eq!(of("unstable")[k], point.unstable.unwrap() as f64);
        assert_eq!(of("certified")[k], f64::from(u8::from(point.certified)));
    }
    for name in ["", "lambda", "u", "u[1]", "u[-1]", "u[0", "u[]", "U[0]", "event"] {
        assert!(branch.column(name).is_none(), "{name}");
    }
    // names of the problem come first
    let named = DenseProblem::from_residual(1, &["s"], |u, p, r| r[0] = p[0] - u[0])
        .boxed()
        .observing("unstable", |u, _| 10.0 * u[0]);
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let branch = Tracer::new(&named, "s", &[0.0], &[0.0], settings).unwrap().run_quietly();
    assert_eq!(*branch.column("s").unwrap().last().unwrap(), 1.0);
    assert!((branch.column("unstable").unwrap().last().unwrap() - 10.0).abs() < 1e-9);
}

#[test]
fn csv_is_read_back_exactly() {
    let branch = cusp(2.0);
    let mut csv = Vec::new();
    branch.write_csv(&mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next().unwrap(), "point,s,mu,x,unstable,certified,event");
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), branch.points.len());
    for (k, (row, point)) in rows.iter().zip(&branch.points).enumerate() {
        let number = |at: usize| row[at].parse::<f64>().unwrap();
        assert_eq!(row[0], k.to_string());
        assert_eq!((number(1), number(2), number(3)), (point.s, point.p, point.observables[0]));
        assert_eq!(row[4], point.unstable.unwrap().to_string());
        let event = point.event.map_or(String::new(), |at| branch.events[at].kind.to_string());
        assert_eq!(row[6], event);
    }
    assert_eq!(rows.iter().filter(|row| row[6] == "fold").count(), 2);
    let mut csv = Vec::new();
    branch.write_columns(&mut csv, &["u[0]", "mu"]).unwrap();
    let text = String::from_utf8(csv).unwrap();
    assert!(text.starts_with("u[0],mu\n"), "{text}");
    assert_eq!(text.lines().count(), 1 + branch.points.len());
    let error = branch.write_columns(Vec::new(), &["mu", "nu"]).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::NotFound);
    assert!(error.to_string().contains("nu"));
    // words that hold what separates are quoted
    let odd = DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = p[0] - u[0])
        .boxed()
        .observing("a, \"b\"", |u, _| u[0]);
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let branch = Tracer::new(&odd, "p", &[0.0], &[0.0], settings).unwrap().run_quietly();
    let mut csv = Vec::new();
    branch.write_csv(&mut csv).unwrap();
    assert!(csv.starts_with(b"point,s,p,\"a, \"\"b\"\"\",unstable"));
}

#[test]
fn a_trace_goes_on_from_every_point() {
    let whole = cusp(2.0);
    let text = serde_json::to_string(&whole).unwrap();
    let saved: Branch = serde_json::from_str(&text).unwrap();
    assert_eq!(saved, whole);
    let last = whole.points.last().unwrap();
    for at in 0..whole.points.len() - 1 {
        let settings = Settings { target: Some(2.0), ..Settings::default() };
        let rest = Tracer::from_point(&Cusp, &saved, at, settings).unwrap().run_quietly();
        assert_eq!(rest.stopped.reason, StopReason::Target, "{at}");
        let end = rest.points.last().unwrap();
        assert!(end.p == 2.0 && (end.u[0] - last.u[0]).abs() < 1e-10, "{at}");
        let folds = |branch: &Branch, from: usize| {
            branch.events_of(&EventKind::Fold).filter(|event| event.point > from).count()
        };
        assert_eq!(folds(&rest, 0), folds(&whole, at), "from point {at}");
    }
    // farther than it went, from its end; and back, if so asked
    let go = |increasing, target| {
        let settings = Settings { target: Some(target), increasing, ..Settings::default() };
        let last = saved.points.len() - 1;
        Tracer::from_point(&Cusp, &saved, last, settings).unwrap().run_quietly()
    };
    assert_eq!(go(None, 3.0).points.last().unwrap().p, 3.0);
    assert_eq!(go(Some(false), -2.0).events_of(&EventKind::Fold).count(), 2);
    assert!(saved.restart_point(saved.points.len()).is_none());
    let settings = Settings::default;
    let beyond = Tracer::from_point(&Cusp, &saved, saved.points.len(), settings());
    assert!(matches!(beyond, Err(TraceError::Foreign { .. })));
    let other = DenseProblem::from_residual(1, &["q"], |u, p, r| r[0] = p[0] - u[0]).boxed();
    let foreign = Tracer::from_point(&other, &saved, 0, settings());
    assert!(matches!(foreign, Err(TraceError::Foreign { .. })));
}

/// An angle of no meaning, by which the unknowns are turned.
const TURN: f64 = 0.7;

/// `g(x, y, p)` in turned unknowns.
#[allow(clippy::type_complexity, reason = "a residual has this type")]
fn turned(
    g: impl Fn(f64, f64, f64) -> (f64, f64) + Send + Sync + 'static,
) -> DenseProblem<BoxedResidual> {
    let (c, s) = (TURN.cos(), TURN.sin());
    DenseProblem::from_residual(2, &["p"], move |u, p, r| {
        let (a, b) = g(c * u[0] + s * u[1], -s * u[0] + c * u[1], p[0]);
        (r[0], r[1]) = (c * a - s * b, s * a + c * b);
    })
    .boxed()
}

fn is_along(vector: &Eigenvector, (x, y): (f64, f64), tolerance: f64) {
    let (c, s) = (TURN.cos(), TURN.sin());
    let known = [c * x - s * y, s * x + c * y];
    let along: f64 = vector.re.iter().zip(known).map(|(a, b)| a * b).sum();
    let length: f64 = vector.re.iter().map(|a| a * a).sum();
    assert!((length - 1.0).abs() < 1e-12 && vector.im.is_empty(), "{vector:?}");
    assert!((along.abs() - 1.0).abs() < tolerance, "{vector:?} {known:?}");
}

fn only(branch: &Branch, kind: EventKind) -> &Event {
    let mut events = branch.events_of(&kind);
    let one = events.next().unwrap();
    assert!(events.next().is_none(), "{:?}", branch.events);
    one
}

#[test]
fn a_fold_has_its_null_vector() {
    let fold = turned(|x, y, p| (p - x * x + 0.3 * y, 0.5 * x - y));
    // y = x/2, p = x² − 0.15 x: the fold is at x = 0.075, with the null vector (1, 1/2)
    let settings =
        Settings { domain: Some((-1.0, 1.0)), increasing: Some(false), ..Settings::default() };
    let (c, s) = (TURN.cos(), TURN.sin());
    let (x, y) = (1.0, 0.5);
    let start = [c * x - s * y, s * x + c * y];
    let branch = Tracer::new(&fold, "p", &start, &[0.85], settings).unwrap().run_quietly();
    let event = only(&branch, EventKind::Fold);
    assert!((event.p + 0.075 * 0.075).abs() < 1e-10, "{}", event.p);
    let modes = event.critical_modes();
    assert_eq!((modes.len(), &modes), (1, &event.eigenvectors));
    let length = 1.25_f64.sqrt();
    is_along(&modes[0], (1.0 / length, 0.5 / length), 1e-9);
}

#[test]
fn branch_points_have_theirs() {
    let pitchfork = turned(|x, y, p| (p * x - x.powi(3), -y - x));
    let transcritical = turned(|x, y, p| (p * x - x * x, -y - x));
    let settings = || Settings { target: Some(0.5), ..Settings::default() };
    let length = 2.0_f64.sqrt();
    let along = (1.0 / length, -1.0 / length);
    let branch = Tracer::new(&pitchfork, "p", &[0.0; 2], &[-1.0], settings()).unwrap();
    let branch = branch.run_quietly();
    let modes = only(&branch, EventKind::BranchPoint).critical_modes();
    assert_eq!(modes.len(), 1);
    is_along(&modes[0], along, 1e-7);
    let branch = Tracer::new(&transcritical, "p", &[0.0; 2], &[-1.0], settings()).unwrap();
    let branch = branch.run_quietly();
    let event = only(&branch, EventKind::BranchPoint);
    assert!(event.eigenvectors.is_empty());
    is_along(&event.critical_modes()[0], along, 1e-7);
}

#[test]
fn a_hopf_point_has_its_complex_eigenvector() {
    // eigenvalues p ± 2i at the origin, in unknowns that are not orthogonal
    let hopf = turned(|x, y, p| {
        let cubic = x * x + y * y;
        (p * x - 4.0 * y - cubic * x, x + p * y - cubic * y)
    });
    let settings = Settings { target: Some(0.5), ..Settings::default() };
    let branch = Tracer::new(&hopf, "p", &[0.0; 2], &[-1.0], settings).unwrap().run_quietly();
    let event = only(&branch, EventKind::Hopf);
    assert!(event.p.abs() < 1e-10);
    let modes = event.critical_modes();
    assert_eq!(modes.len(), 1);
    let Eigenvector { re, im } = &modes[0];
    let length: f64 = re.iter().chain(im).map(|x| x * x).sum();
    assert!((length - 1.0).abs() < 1e-12);
    // A (a + ib) = 2i (a + ib), with A turned
    let (c, s) = (TURN.cos(), TURN.sin());
    let a = |v: &[f64]| {
        let (x, y) = (c * v[0] + s * v[1], -s * v[0] + c * v[1]);
        let (x, y) = (-4.0 * y, x);
        [c * x - s * y, s * x + c * y]
    };
    for k in 0..2 {
        assert!((a(re)[k] + 2.0 * im[k]).abs() < 1e-7 && (a(im)[k] - 2.0 * re[k]).abs() < 1e-7);
    }
}

#[test]
fn events_without_a_mode_stay_small_in_files() {
    let branch = cusp(2.0);
    let zero = branch.events.iter().find(|event| event.kind == EventKind::Zero("x".to_owned()));
    let text = serde_json::to_string(zero.unwrap()).unwrap();
    assert!(!text.contains("eigenvectors"), "{text}");
    let read: Event = serde_json::from_str(&text).unwrap();
    assert_eq!(&read, zero.unwrap());
    let fold = branch.events_of(&EventKind::Fold).next().unwrap();
    let text = serde_json::to_string(fold).unwrap();
    assert!(text.contains("\"eigenvectors\":[{\"re\":["), "{text}");
    assert!(!text.contains("\"im\""), "{text}");
}
