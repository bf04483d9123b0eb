//! A tense bubble is a drop between plates.

use crate::contact;
use continuation::{EventKind, Settings, StopReason, Tracer, Watch};
use shell_contact::Mesh;
use shell_contact::asymptotics::Drop;
use std::ops::ControlFlow;

/// Surface tension much above the shell's stiffness, ambient pressure much above both, so that the
/// volume stays. The film's height under the pressure of the drop is `(4W0δ_A⁴/Δp)^(1/5)`: with
/// `W0 ~ δ_A²` the force is approached like `δ_A^(6/5)`.
#[test]
fn tense_bubble_approaches_the_drop_as_film_and_adhesion_vanish() {
    let known = [(0.95, 0.12009), (0.9, 0.29691), (0.8, 0.81770), (0.7, 1.64732), (0.5, 5.31762)];
    let (tension, bending) = (1e3_f64, 0.1_f64);
    let runs = [0.04, 0.02, 0.01, 0.005].map(|film| {
        let adhesion = 0.1 * tension * film * film;
        let groups = [bending, 1e3 * tension, adhesion, film, tension, 1.07];
        let problem = contact(Mesh::uniform(300).unwrap(), 0.5, groups);
        let watches = known.map(|(z0, _)| Watch::parameter(z0));
        // pressure and tension leave fewer digits to the soft tangential motion
        let settings = Settings { target: Some(0.49), tolerance: 1e-9, ..Settings::default() };
        let (u, p) = (problem.initial_state(), problem.parameters_at(1.0 + 3.0 * film));
        let branch = Tracer::new(&problem, "z0", &u, &p, settings)
            .and_then(|t| t.watching(&watches))
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
        known.map(|(z0, force)| {
            let landed = |e: &&continuation::Event| (e.p - z0).abs() < 1e-12;
            let at = branch.events_of(&EventKind::Target).find(landed).unwrap().point;
            let q = &branch.points[at];
            let got = q.observables[0] * bending.sqrt() / tension;
            // against the drop that touches where the film leaves off
            let touching = Drop::between_plates(q.observables[1]).force();
            (got / force - 1.0, got / touching - 1.0)
        })
    });
    let factor = 2.0_f64.powf(1.2);
    for (k, (z0, force)) in known.into_iter().enumerate() {
        assert!((Drop::between_plates(z0).force() - force).abs() < 6e-6);
        let errors = [0, 1, 2, 3].map(|run| runs[run][k].0);
        let touching = [0, 1, 2, 3].map(|run| runs[run][k].1);
        let orders = [0, 1, 2].map(|m| (errors[m] / errors[m + 1]).log2());
        let limit = (factor * errors[3] - errors[2]) / (factor - 1.0);
        println!("{z0}: {errors:.4?}, orders {orders:.2?}, limit {limit:.1e}; {touching:.4?}");
        assert!(orders.iter().all(|o| (1.1..1.3).contains(o)), "{z0}: {orders:?}");
        assert!(limit.abs() < 3e-3, "{z0}: {limit}");
        assert!(touching[3] < 0.01 && touching.windows(2).all(|t| t[1] < 0.7 * t[0]));
    }
}
