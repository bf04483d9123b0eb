//! The edge of the contact area as the film becomes thin.

use crate::{contact, trace};
use continuation::{EventKind, Settings, StopReason, Tracer, Watch};
use shell_contact::Mesh;
use shell_contact::asymptotics::{contact_curvature, derjaguin_pull_off};
use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;

/// Uniform but for short elements about `centre`.
fn refined_about(centre: f64, elements: usize) -> Mesh {
    let density = |s: f64| 1.0 + 12.0 / (1.0 + ((s - centre) / 0.12).powi(4));
    let cells = 20_000;
    let at = |i: usize| i as f64 / cells as f64 * FRAC_PI_2;
    let total: f64 = (0..cells).map(|i| density(at(i))).sum();
    let (mut knots, mut sum) = (vec![0.0], 0.0);
    for i in 0..cells {
        sum += density(at(i)) / total;
        if sum * elements as f64 >= knots.len() as f64 && knots.len() < elements {
            knots.push(at(i + 1));
        }
    }
    knots.push(FRAC_PI_2);
    Mesh::from_knots(&knots).unwrap()
}

/// `½k_b K² = W0 λ_s λ_φ` per undeformed area at the edge of a flat contact, so the curvature
/// jumps by `√(2W0/k_b) √(λ_φ/λ_s)`: approached like the square root of the film length.
#[test]
fn curvature_at_the_contact_edge_approaches_that_of_seifert_and_lipowsky() {
    let (bending, adhesion) = (2.7e-4, 2e-3);
    let expected = contact_curvature(adhesion, bending);
    let thickest = 0.02;
    let groups = [bending, 3.0, adhesion, thickest, 0.0, 1.07];
    let problem = contact(refined_about(0.46, 700), 0.5, groups);
    let branch = trace(&problem, 1.0 + 9.0 * thickest, 0.9, None, &[]);
    let films = [0.01, 0.005, 0.0025, 0.00125, 0.000625, 0.0003125];
    let settings = Settings { target: Some(0.0003), ..Settings::default() };
    let p = problem.parameters_at(0.9);
    let watches = films.map(Watch::parameter);
    let branch = Tracer::new(&problem, "film", &branch.points.last().unwrap().u, &p, settings)
        .and_then(|t| t.watching(&watches))
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
    let gaps = films.map(|film| {
        let q = branch.points.iter().find(|q| (q.p - film).abs() < 1e-13).unwrap();
        let curvature = (1..6000).fold(0.0_f64, |most, i| {
            let s = f64::from(i) * 1.5 / 6000.0;
            let x = problem.mesh().place(&q.u, s);
            let a = x.s[1].hypot(x.z[1]);
            let along = (x.z[1] * x.s[2] - x.s[1] * x.z[2]) / a.powi(3);
            let stretch_phi = x.s[0] / s.sin();
            most.max(along * (a / stretch_phi).sqrt())
        });
        1.0 - curvature / expected
    });
    let orders: Vec<f64> = gaps.windows(2).map(|g| (g[0] / g[1]).log2()).collect();
    let root = 0.5_f64.sqrt();
    let limit = (gaps[5] - root * gaps[4]) / (1.0 - root);
    println!("short by {gaps:.4?}, orders {orders:.3?}, limit {limit:.1e}");
    assert!(gaps[5] < 0.03 && (orders[4] - 0.5).abs() < 0.03 && limit.abs() < 2e-3);
}

/// Pull-off of a stiff shell: a rigid sphere's `2π[w(z0 − 1) − w(z0)]`, which is Derjaguin's
/// `−2πR0w0` for a thin film; approached in proportion to the adhesion.
#[test]
fn pull_off_of_a_stiff_shell_is_derjaguins() {
    let (bending, film) = (3e-5_f64, 1.0 / 30.0);
    let rigid = {
        let w = |height: f64| {
            let r = (film / height) * (film / height);
            r * r - 2.0 * r
        };
        (0..2000)
            .map(|i| 0.9 * film + 1e-4 * film * f64::from(i))
            .fold(0.0_f64, |m, gap| m.min(w(gap) - w(1.0 + gap)))
    };
    assert!((rigid + 1.0).abs() < 2.5 * film * film);
    let errors = [2e-6, 1e-6, 5e-7, 2.5e-7].map(|adhesion| {
        let problem =
            contact(Mesh::uniform(200).unwrap(), 0.5, [bending, 3e-3, adhesion, film, 0.0, 1.07]);
        let branch = trace(&problem, 1.3, 1.0, None, &[Watch::extremum("force")]);
        let minimum = EventKind::Minimum("force".to_owned());
        assert_eq!(branch.events_of(&minimum).count(), 1);
        let at = branch.events_of(&minimum).next().unwrap().point;
        let force = branch.points[at].observables[0];
        -force / derjaguin_pull_off(adhesion, bending) - rigid
    });
    let orders = [0, 1, 2].map(|k| (errors[k] / errors[k + 1]).log2());
    println!("rigid {rigid:.6}, off by {errors:?}, orders {orders:.3?}");
    assert!(errors[0].abs() < 0.01 && (orders[2] - 1.0).abs() < 0.05, "{errors:?} {orders:?}");
}
