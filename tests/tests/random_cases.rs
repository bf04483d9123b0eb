//! Thousands of random cases, most of them unreasonable: an answer or a typed error, never a
//! panic, and never a point that is not a number.

use continuation::{Settings, Tracer, Watch};
use proptest::prelude::*;
use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell};

fn law() -> impl Strategy<Value = Law> {
    prop_oneof![
        Just(Law::Hooke),
        (-0.2..1.2_f64).prop_map(|b| Law::MooneyRivlin { b }),
        Just(Law::Skalak),
    ]
}

fn number(low: f64, high: f64) -> impl Strategy<Value = f64> {
    // mostly log-uniform, now and then hostile
    prop_oneof![
        20 => (low.ln()..high.ln()).prop_map(f64::exp),
        1 => Just(0.0),
        1 => Just(-1.0),
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(1e300),
    ]
}

prop_compose! {
    fn groups()(
        bending in number(1e-7, 1.0),
        pressure in number(1e-5, 1e3),
        adhesion in number(1e-8, 1.0),
        film in number(1e-4, 0.5),
        surface_tension in prop_oneof![Just(0.0), number(1e-3, 10.0)],
        gas_exponent in prop_oneof![Just(1.0), Just(0.0), 0.0..3.0_f64],
    ) -> Dimensionless {
        Dimensionless { bending, pressure, adhesion, film, surface_tension, gas_exponent }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_panic_and_no_nan(
        law in law(),
        poisson in -1.1..1.1_f64,
        groups in groups(),
        elements in 6_usize..24,
        start in prop_oneof![4 => 1.01..1.6_f64, 1 => 0.0..1.0_f64],
        end in prop_oneof![4 => 0.3..1.0_f64, 1 => -1.0..2.0_f64],
        max_step in prop_oneof![Just(None), (1e-3..0.3_f64).prop_map(Some)],
    ) {
        let shell = Shell { law, poisson };
        let Ok(mesh) = Mesh::uniform(elements) else { return Ok(()) };
        let Ok(problem) = ContactProblem::new(&shell, &groups, mesh) else { return Ok(()) };
        let settings =
            Settings { target: Some(end), max_step, max_points: 30, ..Settings::default() };
        let (u, p) = (problem.initial_state(), problem.parameters_at(start));
        let watches = [Watch::zero("force"), Watch::extremum("force")];
        let tracer = Tracer::new(&problem, "z0", &u, &p, settings)
            .and_then(|tracer| tracer.watching(&watches));
        let Ok(mut tracer) = tracer else { return Ok(()) };
        for point in tracer.by_ref() {
            prop_assert!(point.p.is_finite() && point.u.iter().all(|x| x.is_finite()));
            prop_assert!(point.observables[..10].iter().all(|x| x.is_finite()), "{:?}", point.observables);
        }
        prop_assert!(tracer.stopped().is_some());
    }
}
