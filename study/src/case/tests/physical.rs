//! Shells in physical units that are no contact cases: two plates, ring load.

use super::{read, says};
use crate::case::{ProblemCase, ResolvedCase, catalogue, load_text};
use crate::record::{Scales, physical_table};
use crate::run::{run_map, run_trace};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// Two plates; `R0` in um, `E` in GPa, `h` in nm, pressure in kPa, adhesions in mN/m, films in nm, a lever in N/m.
fn plates(numbers: [f64; 8], lever: Option<f64>, path: [&str; 2]) -> String {
    let [radius, young, thickness, pressure, w, d, w2, d2] = numbers;
    let device = lever.map_or_else(String::new, |stiffness| {
        format!("device = \"cantilever\"\nstiffness = \"{stiffness} N/m\"\n")
    });
    format!(
        "problem = \"two-plates\"\n[shell]\nlaw = \"hooke\"\npoisson = 0.4\n[physical]\nradius = \"{radius} um\"\n\
         young = \"{young} GPa\"\nthickness = \"{thickness} nm\"\npressure = \"{pressure} kPa\"\n\
         surface_tension = \"20 mN/m\"\n[plate.top]\nadhesion = \"{w} mN/m\"\nfilm = \"{d} nm\"\n{device}\
         [plate.bottom]\nadhesion = \"{w2} mN/m\"\nfilm = \"{d2} nm\"\n[mesh]\nelements = 24\n[path]\n\
         start = {}\nend = {}\nmax_points = 12\n",
        path[0], path[1]
    )
}

fn ring(radius: f64, young: f64, thickness: f64, pressure: f64) -> String {
    format!(
        "problem = \"ring-load\"\n[shell]\nlaw = \"hooke\"\npoisson = 0.3\n[physical]\nradius = \"{radius} um\"\n\
         young = \"{young} GPa\"\nthickness = \"{thickness} nm\"\npressure = \"{pressure} kPa\"\n\
         gas_exponent = 1.1\n[mesh]\nelements = 40\n[path]\nstart = 4.5\nend = 6\nmax_points = 8\n"
    )
}

/// The same case without its units: the groups that the written case has in its comments.
fn dimensionless(case: &ResolvedCase) -> String {
    let (shell, [start, end]) = match &case.problem {
        ProblemCase::TwoPlates(one) => (one.shell, [case.path.start, case.path.end]),
        ProblemCase::RingLoad(one) => (one.shell, [case.path.start, case.path.end]),
        other => panic!("{other:?}"),
    };
    let mut text = format!(
        "problem = \"{}\"\n[shell]\nlaw = \"hooke\"\npoisson = {:?}\n[path]\nstart = {start:?}\nend = {end:?}\n\
         max_points = {}\n[mesh]\nelements = {}\n",
        case.problem.name(),
        shell.poisson,
        case.path.max_points,
        case.problem.mesh().unwrap().elements,
    );
    match &case.problem {
        ProblemCase::TwoPlates(one) => {
            text += &format!(
                "[dimensionless]\nbending = {:?}\npressure = {:?}\nsurface_tension = {:?}\n",
                one.bending, one.pressure, one.surface_tension
            );
            for (side, plate) in ["top", "bottom"].into_iter().zip(one.plates) {
                let plate = plate.unwrap();
                text += &format!(
                    "[plate.{side}]\nadhesion = {:?}\nfilm = {:?}\n",
                    plate.adhesion, plate.film
                );
                if let Some(stiffness) = plate.stiffness {
                    text += &format!("device = \"cantilever\"\nstiffness = {stiffness:?}\n");
                }
            }
        }
        ProblemCase::RingLoad(one) => {
            text += &format!(
                "[dimensionless]\nbending = {:?}\npressure = {:?}\ngas_exponent = {:?}\n",
                one.groups.bending, one.groups.pressure, one.groups.gas_exponent
            );
        }
        other => panic!("{other:?}"),
    }
    text
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-12 * b.abs(), "{a:e} {b:e}");
}

/// Both cases give the same branch, and its physical columns are its own times the units.
fn agree(physical: &ResolvedCase, units: &[(&str, &str, f64)]) {
    let plain = read(&dimensionless(physical));
    assert!(!plain.problem.is_physical() && physical.problem.is_physical());
    assert_eq!(Scales::of(&plain), None);
    let trace = |case| run_trace(case, &mut |_| ControlFlow::Continue(())).unwrap();
    let (own, other) = (trace(physical), trace(&plain));
    assert!(own.table.rows().len() > 2);
    // by their text: what is not defined is NaN
    assert_eq!(format!("{:?}", own.table), format!("{:?}", other.table));
    let table = physical_table(physical, &own.table).unwrap();
    for (column, unit, size) in units {
        let name = table.columns().iter().find(|name| {
            name.strip_prefix(column)
                .is_some_and(|rest| rest.starts_with('_') && !rest[1..].contains('_'))
        });
        let name = name.unwrap_or_else(|| panic!("{column}: {:?}", table.columns()));
        let prefix =
            name[column.len() + 1..].strip_suffix(unit).unwrap_or_else(|| panic!("{name}"));
        let prefix = match prefix {
            "" => 1.0,
            "a" => 1e-18,
            "f" => 1e-15,
            "p" => 1e-12,
            "n" => 1e-9,
            "u" => 1e-6,
            "m" => 1e-3,
            "k" => 1e3,
            "M" => 1e6,
            "G" => 1e9,
            other => panic!("{other}"),
        };
        let of = if own.table.columns().iter().any(|one| one == column) {
            (*column).to_owned()
        } else {
            format!("{column}_over_h")
        };
        for (value, plain) in table.numbers(name).into_iter().zip(own.table.numbers(&of)) {
            if plain.is_finite() {
                close(value * prefix, plain * size);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn two_plates_in_physical_units_are_those_without(
        radius in 1.0..3.0_f64, young in 0.5..2.0_f64, ratio in 0.01..0.03_f64, pressure in 10.0..200.0_f64,
        films in prop::array::uniform2((0.02..0.2_f64, 0.02..0.04_f64)), lever in prop::option::of(0.1..1.0_f64),
    ) {
        let thickness = 1e3 * ratio * radius;
        // mN/m: a thousandth of chi, in N/m GPa nm
        let chi = young * thickness;
        let [(w, d), (w2, d2)] = films.map(|(w, d)| (w * chi, d * 1e3 * radius));
        let numbers = [radius, young, thickness, pressure, w, d, w2, d2];
        let case = read(&plates(numbers, lever, ["1.12", "1.1"]));
        let ProblemCase::TwoPlates(own) = &case.problem else { panic!() };
        let k_b = chi * (thickness * 1e-9).powi(2) / (12.0 * (1.0 - 0.4 * 0.4));
        let r = radius * 1e-6;
        close(own.bending, k_b / (chi * r * r));
        close(own.pressure, pressure * 1e3 * r / chi);
        close(own.surface_tension, 0.02 / chi);
        let [Some(top), Some(bottom)] = own.plates else { panic!() };
        close(top.adhesion, w * 1e-3 / chi);
        close(top.film, d * 1e-9 / r);
        close(bottom.adhesion, w2 * 1e-3 / chi);
        close(bottom.film, d2 * 1e-9 / r);
        let force = (chi * k_b).sqrt();
        if let Some(lever) = lever {
            close(top.stiffness.unwrap(), lever * r / force);
        }
        prop_assert_eq!(&read(&case.to_toml()), &case);
        // a soft lever, or a film that attracts strongly, may have no state to begin with
        prop_assume!(run_trace(&case, &mut |_| ControlFlow::Continue(())).is_ok());
        agree(&case, &[
            ("z0", "m", r), ("force", "N", force), ("force_bottom", "N", force), ("gas_pressure", "Pa", chi / r),
            ("energy_total", "J", chi * r * r), ("pole_top", "m", r), ("shift", "m", r),
        ]);
        // the films' pressures have one unit only where they have one
        prop_assert_eq!(Scales::of(&case).unwrap().film_pressure, None);
        let alike = read(&plates([radius, young, thickness, pressure, w, d, w, d], lever, ["1.12", "1.1"]));
        close(Scales::of(&alike).unwrap().film_pressure.unwrap(), 1e6 * w / d);
    }

    #[test]
    fn a_ring_load_in_physical_units_is_that_without(
        radius in 1.0..100.0_f64, young in 0.1..100.0_f64, ratio in 0.005..0.012_f64, pressure in 0.0..100.0_f64,
    ) {
        let thickness = 1e3 * ratio * radius;
        let case = read(&ring(radius, young, thickness, pressure));
        let ProblemCase::RingLoad(own) = &case.problem else { panic!() };
        let (chi, r, h) = (young * thickness, radius * 1e-6, thickness * 1e-9);
        close(own.groups.bending, h * h / (r * r * 12.0 * (1.0 - 0.3 * 0.3)));
        close(own.groups.pressure, pressure * 1e3 * r / chi);
        prop_assert_eq!(&read(&case.to_toml()), &case);
        agree(&case, &[
            ("deflection", "m", h), ("pole", "m", h), ("highest", "m", h), ("force", "N", 2e-6 * PI * chi * r),
            ("ring_height", "m", r), ("energy_total", "J", chi * r * r),
        ]);
    }
}

#[test]
fn ends_of_a_path_between_plates_may_have_units() {
    let numbers = [1.5, 2.1, 25.0, 101.0, 50.0, 50.0, 50.0, 50.0];
    let case = read(&plates(numbers, None, ["\"1.65 um\"", "\"1620 nm\""]));
    close(case.path.start, 1.1);
    close(case.path.end, 1.08);
    assert!(case.to_toml().contains("start = \"1.65 um\"") && !case.to_toml().contains("quantity"));
    assert_eq!(read(&case.to_toml()), case);
}

/// Either plate's film and what the curves have are in the laboratory's units.
#[test]
fn maps_between_plates_have_their_units() {
    let numbers = [1.5, 2.1, 25.0, 101.0, 50.0, 50.0, 50.0, 50.0];
    let text = plates(numbers, Some(1.2), ["1.15", "0.8"]).replace("max_points = 12\n", "");
    let case = read(&text);
    for (key, column, unit) in [
        ("plate.top.film", "film_top", "nm"),
        ("plate.bottom.adhesion", "adhesion_bottom", "mN_per_m"),
    ] {
        let map = run_map(&case, key, &mut |_| ControlFlow::Continue(())).unwrap();
        let own = &map.curves.first().unwrap().table;
        let scales = Scales::of(&case).unwrap();
        let (factor, name) = match unit {
            "nm" => (scales.length * 1e9, format!("{column}_nm")),
            _ => (scales.tension * 1e3, format!("{column}_mN_per_m")),
        };
        let table = physical_table(&case, own).unwrap();
        let columns = table.columns();
        assert!(columns.contains(&"force_nN".to_owned()), "{columns:?}");
        assert!(columns.iter().any(|one| one.starts_with("base_")), "{columns:?}");
        let values = table.numbers(&name);
        assert_eq!(values.len(), own.rows().len(), "{columns:?}");
        for (value, plain) in values.into_iter().zip(own.numbers(column)) {
            close(value, plain * factor);
        }
    }
}

/// Along a curve over the bending modulus the unit of the force is that of each point: a wall of that thickness has its fold
/// at the force that the map has there.
#[test]
fn forces_of_maps_over_bending_are_those_of_such_walls() {
    let wall = |thickness: f64| {
        format!(
            "problem = \"contact\"\n[shell]\nlaw = \"hooke\"\npoisson = 0.5\n[physical]\nradius = \"1.5 um\"\n\
             chi = \"52.5 N/m\"\nbending = \"{:?} N m\"\npressure = \"101 kPa\"\nadhesion = \"50 mN/m\"\n\
             film = \"50 nm\"\n[mesh]\nelements = 60\n[path]\nstart = 1.15\nend = 0.65\n",
            52.5 * (thickness * 1e-9).powi(2) / 9.0
        )
    };
    let case = read(&wall(25.0));
    let map = run_map(&case, "bending", &mut |_| ControlFlow::Continue(())).unwrap();
    let scales = Scales::of(&case).unwrap();
    let mut seen = 0;
    for curve in &map.curves {
        let own = curve.table.numbers("bending");
        let (z0, plain) = (curve.table.numbers("z0"), curve.table.numbers("force"));
        let physical = physical_table(&case, &curve.table).unwrap();
        let column = physical.columns().iter().position(|name| name.starts_with("force_")).unwrap();
        let name = physical.columns()[column].clone();
        let size = if name == "force_nN" { 1e-9 } else { 1e-6 };
        let forces = physical.numbers(&name);
        for k in (0..own.len()).step_by(40) {
            // k_b in N m, and the force of a shell that has it
            let bending = own[k] * scales.energy;
            close(forces[k] * size, plain[k] * (scales.tension * bending).sqrt());
            let thickness = (9.0 * bending / 52.5).sqrt() * 1e9;
            let trace =
                run_trace(&read(&wall(thickness)), &mut |_| ControlFlow::Continue(())).unwrap();
            let folds = trace.events.iter().filter(|event| event.kind == "fold");
            for fold in
                folds.filter(|fold| fold.parameter.is_some_and(|at| (at - z0[k]).abs() < 1e-6))
            {
                let si = fold.force.unwrap() * (52.5 * bending).sqrt();
                assert!(
                    (forces[k] * size - si).abs() < 1e-4 * si.abs(),
                    "{:e} {si:e}",
                    forces[k] * size
                );
                seen += 1;
            }
        }
    }
    assert!(seen >= 2, "{seen}");
}

#[test]
fn keys_without_a_meaning_in_physical_units_are_refused() {
    let numbers = [1.5, 2.1, 25.0, 101.0, 50.0, 50.0, 50.0, 50.0];
    let good = plates(numbers, Some(0.1), ["1.1", "1.08"]);
    let message = |text: &str| {
        let error = load_text("a.toml", "a", text, &[], &catalogue()).unwrap_err();
        error.to_string()
    };
    let both =
        good.replace("[physical]", "[dimensionless]\nbending = 1e-5\npressure = 0\n[physical]");
    says(&message(&both), &["both [dimensionless] and [physical]"]);
    let film = good.replace("[physical]\n", "[physical]\nadhesion = \"1 mN/m\"\n");
    says(&message(&film), &["physical.adhesion", "plate.top"]);
    let bare = good.replacen("adhesion = \"50 mN/m\"", "adhesion = 2e-3", 1);
    says(&message(&bare), &["plate.top.adhesion", "add the unit, in quotes"]);
    let tiny = good.replacen("adhesion = \"50 mN/m\"", "adhesion = \"0 mN/m\"", 1);
    says(&message(&tiny), &["plate.top.adhesion"]);
    let soft = good.replacen("stiffness = \"0.1 N/m\"", "stiffness = \"0.1 nm\"", 1);
    says(&message(&soft), &["plate.top.stiffness"]);
    let neither = good.replace("[physical]", "[dimensionless]");
    says(&message(&neither), &["dimensionless.radius", "physical"]);
    let ring = ring(1.5, 2.1, 25.0, 0.0);
    let tension = ring.replace("[mesh]", "surface_tension = \"1 mN/m\"\n[mesh]");
    says(&message(&tension), &["physical.surface_tension"]);
    says(&message(&ring.replace("start = 4.5", "start = \"1 um\"")), &["path.start"]);
    // dimensionless plates take no units
    let text = crate::case::SHIPPED.iter().find(|(name, _)| *name == "two-plates").unwrap().1;
    let device = "device = \"cantilever\"\nstiffness = \"0.1 N/m\"";
    says(
        &message(&text.replacen("device = \"grip\"", device, 1)),
        &["plate.top.stiffness", "[physical]"],
    );
    says(
        &message(&text.replace("start = 1.15", "start = \"1.7 um\"")),
        &["path.start", "[physical]"],
    );
}
