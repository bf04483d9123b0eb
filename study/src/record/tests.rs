//! Files and tables of a made-up branch.

use super::result::Cell;
use super::*;
use crate::case::ResolvedCase;
use continuation::StopReason;

fn example() -> TraceResult {
    let mut table = Table::contact();
    let row = ContactRow {
        z0: 1.15,
        deformation: f64::NAN,
        force: -1.0 / 3.0,
        unstable: Some(0),
        pole_height: 1.0,
        gas_pressure: 3e-3,
        volume: 4.188_790_204_786_391,
        energy_total: 1e-17,
        contact_radius: f64::NAN,
        ..ContactRow::default()
    };
    table.push(row.cells());
    let event = "fold".to_string();
    table.push(ContactRow { point: 1, z0: 0.9, unstable: None, event, ..row }.cells());
    TraceResult {
        case: "fig12".into(),
        parameter: "z0".into(),
        table,
        events: vec![
            EventRecord {
                kind: "fold".into(),
                parameter: Some(0.9),
                force: Some(2.698),
                energy_total: Some(f64::NAN),
                unstable_before: Some(0),
                unstable_after: Some(1),
                residual: Some(1e-14),
                ..EventRecord::default()
            },
            EventRecord { kind: "pull-off".into(), ..EventRecord::default() },
        ],
        maxwell: None,
        stability: None,
        resolution: None,
        stopped_because: StopReason::Target,
        stopped_detail: String::new(),
        points: 2,
        certified: Some(true),
        newton_iterations: 17,
        seconds: 0.25,
        shapes: Vec::new(),
        pictures: Pictures::default(),
    }
}

#[test]
fn the_table_has_the_contract_s_columns_and_full_precision() {
    let csv = String::from_utf8(branch_csv(&example().table).unwrap()).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(
        lines[0],
        "point,z0,deformation,force,unstable,pole_height,gas_pressure,volume,energy_total,\
         energy_stretching,energy_bending,energy_film,energy_gas,energy_surface,contact_radius,event"
    );
    assert_eq!(
        lines[1],
        "0,1.15,,-0.3333333333333333,0,1,0.003,4.188790204786391,1e-17,0,0,0,0,0,,"
    );
    assert!(lines[2].starts_with("1,0.9,,") && lines[2].ends_with(",fold"), "{}", lines[2]);
    assert_eq!(lines.len(), 3);
}

#[test]
fn every_number_reads_back_as_itself() {
    for value in
        [1.0 / 3.0, 1e-300, -2.5e-5, 9.9e-6, 1e16, 123_456_789.123_456_79, f64::MIN_POSITIVE]
    {
        let text = number::exact(value);
        assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{text}");
        assert!(text.len() < 26, "{text}");
    }
    assert_eq!(number::exact(f64::NAN), "");
    assert_eq!(number::exact(f64::INFINITY), "");
}

#[test]
fn rows_are_as_long_as_the_header() {
    let mut table = Table::general("mu", &["norm"]);
    assert_eq!(table.columns(), ["point", "mu", "norm", "unstable", "event"]);
    table.push(vec![Cell::Count(0)]);
    table.push(vec![Cell::Empty; 9]);
    assert!(table.rows().iter().all(|row| row.len() == 5));
}

#[test]
fn the_json_has_the_contract_s_names_and_nulls() {
    let json = events_json(&case("fig12"), &example()).unwrap();
    let read: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(read["case"], "fig12");
    assert_eq!(read["parameter"], "z0");
    assert_eq!(read["stopped_because"], "target");
    assert_eq!((read["points"].as_u64(), read["newton_iterations"].as_u64()), (Some(2), Some(17)));
    assert_eq!(read["seconds"], 0.25);
    let event = &read["events"][0];
    assert_eq!(event["kind"], "fold");
    assert_eq!(event["z0"], 0.9);
    assert_eq!(event["force"], 2.698);
    assert!(event["deformation"].is_null() && event["energy_total"].is_null());
    assert_eq!(
        (event["unstable_before"].as_u64(), event["unstable_after"].as_u64()),
        (Some(0), Some(1))
    );
    assert_eq!(event["residual"], 1e-14);
    let names: Vec<&str> = event.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(names.len(), 10, "{names:?}");
    assert_eq!(event["parameter"], "z0");
    assert!(read["events"][1]["z0"].is_null());
}

#[test]
fn other_problems_use_their_own_parameter_s_name() {
    let mut result = example();
    result.parameter = "lambda".into();
    result.events[0].observables = vec![("max".into(), 1.19), ("odd".into(), f64::NAN)];
    let json = events_json(&case("fig12"), &result).unwrap();
    let read: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(read["parameter"], "lambda");
    assert_eq!(read["events"][0]["lambda"], 0.9);
    assert!(read["events"][0].get("z0").is_none());
    assert_eq!(read["events"][0]["observables"]["max"], 1.19);
    assert!(read["events"][0]["observables"]["odd"].is_null());
}

#[test]
fn the_summary_lines_up() {
    let of = |name: &str| crate::case::load(name.as_ref(), &[], &[]).unwrap().case;
    let case = of("fig12");
    let text = summary(&case, &example(), Some(std::path::Path::new("out")));
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "special point        z0    force  unstable");
    assert_eq!(lines[1], "fold           0.900000  2.69800     0 → 1");
    assert_eq!(lines[2], "pull-off              –        –         –");
    assert_eq!(lines[4], "fig12: stopped at target; 2 points, 17 Newton iterations, 0.25 s");
    assert_eq!(lines[5], "written to out");
    let mut bare = example();
    bare.events.clear();
    assert!(summary(&case, &bare, None).starts_with("no special points\n"));
    // sqrt(chi k_b) is 9.55 nN there
    let text = summary(&of("polymer"), &example(), None);
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[4].starts_with("in physical units  z0 [nm]"), "{text}");
    assert!(lines[4].contains("force [pN]") || lines[4].contains("force [nN]"), "{text}");
    assert!(lines[5].starts_with("fold") && lines[5].contains("1350.00"), "{text}");
}

#[test]
fn axes_may_show_columns_that_there_are() {
    use crate::case::picture::{PLATES, RING};
    for (names, known) in [(&PLATES[..], super::column::PLATES), (RING, super::column::RING)] {
        for name in names {
            assert!(known.iter().any(|column| column.name == *name), "{name}");
        }
    }
    let columns = Table::contact().columns().to_vec();
    assert!(PLATES.iter().all(|name| columns.contains(&(*name).to_owned())));
}

fn case(name: &str) -> ResolvedCase {
    crate::case::load(name.as_ref(), &[], &[]).unwrap().case
}

#[test]
fn special_points_of_a_case_in_physical_units_have_those_too() {
    let json = events_json(&case("polymer"), &example()).unwrap();
    let read: serde_json::Value = serde_json::from_str(&json).unwrap();
    let physical = &read["events"][0]["physical"];
    // R0 = 1.5 um, E h^3/(12 (1 - nu^2)) = 2.1e9 1.5625e-23/9 J, chi = 52.5 N/m
    assert!((physical["z0_nm"].as_f64().unwrap() - 1350.0).abs() < 1e-9);
    let scale = f64::sqrt(52.5 * 2.1e9 * 1.5625e-23 / 9.0);
    let own = physical.as_object().unwrap().iter().find(|(name, _)| name.starts_with("force_"));
    let (name, force) = own.unwrap();
    let unit = match &name[6..] {
        "pN" => 1e-12,
        "nN" => 1e-9,
        other => panic!("{other}"),
    };
    assert!((force.as_f64().unwrap() * unit / (2.698 * scale) - 1.0).abs() < 1e-12);
    // what is not known has no unit either, and dimensionless cases have no such numbers
    assert!(!physical.as_object().unwrap().keys().any(|name| name.starts_with("deformation")));
    let plain = events_json(&case("fig12"), &example()).unwrap();
    assert!(!plain.contains("physical"));
}

#[test]
fn a_tolerance_is_met_at_every_place_that_is_known_or_unknown() {
    let error =
        |force, z0, extremum| Some(MeshErrorRecord { force, at: 0.9, z0, extremum, samples: 12 });
    let met = |tolerance, enough, mesh_error| {
        let record = ResolutionRecord {
            per_film_length: 2.0,
            per_wavelength: 20.0,
            needed: [1.0, 15.0],
            at: 0.9,
            parameter: "z0",
            enough,
            elements: 100,
            wanted: 90,
            mesh_error,
            tolerance,
        };
        record.meets_tolerance()
    };
    for (tolerance, enough, mesh_error, expected) in [
        (Some(1e-6), true, error(5e-7, None, None), Some(true)),
        (Some(1e-6), true, error(2e-6, None, None), Some(false)),
        (Some(1e-6), true, error(5e-7, Some(2e-6), None), Some(false)),
        (Some(1e-6), true, error(5e-7, Some(1e-9), Some(2e-6)), Some(false)),
        (Some(1e-6), true, None, None),
        (Some(1e-6), false, error(5e-7, None, None), None),
        (None, true, error(5e-7, None, None), None),
    ] {
        assert_eq!(met(tolerance, enough, mesh_error), expected, "{tolerance:?} {mesh_error:?}");
    }
}
