//! Pictures of made-up branches, sound and degenerate.

use super::*;
use study::record::Pictures;
use study::record::view::{Examined, Mark, Profile, Shape, Stability};

/// A case whose pictures look as usual.
fn fig12() -> ResolvedCase {
    study::case::load("fig12".as_ref(), &[], &[]).unwrap().case
}

/// A force curve with two folds in the distance, as strong adhesion makes them.
fn two_folds() -> Pictures {
    let n = 400;
    let (mut x, mut y, mut unstable) = (vec![], vec![], vec![]);
    for i in 0..n {
        let t = i as f64 / (n - 1) as f64;
        let d = 0.32 * t + 0.06 * (2.2 * std::f64::consts::TAU * t).sin() * (1.0 - t);
        x.push(d - 0.01);
        y.push(
            4.0 * t - 1.2 * (-((t - 0.1) / 0.07f64).powi(2)).exp()
                + 1.1 * (11.0 * t).sin() * (1.0 - t),
        );
        unstable.push(false);
    }
    for i in 1..n - 1 {
        unstable[i] = x[i + 1] < x[i];
    }
    let lowest = (0..n).min_by(|a, b| y[*a].total_cmp(&y[*b])).unwrap();
    let mut marks = vec![Mark { kind: "pull-off".into(), x: x[lowest], y: y[lowest] }];
    for i in 1..n {
        if y[i - 1] < 0.0 && y[i] >= 0.0 {
            marks.push(Mark { kind: "zero-force".into(), x: x[i], y: y[i] });
        }
        if unstable[i - 1] != unstable[i] {
            marks.push(Mark { kind: "fold".into(), x: x[i], y: y[i] });
        }
    }
    let force = Curve {
        label: "force".into(),
        x: x.clone(),
        y,
        unstable: unstable.clone(),
        marks,
        ..Curve::default()
    };
    let mut distance = force.clone();
    distance.x.iter_mut().for_each(|x| *x = 1.02 - *x);
    distance.marks.iter_mut().for_each(|mark| mark.x = 1.02 - mark.x);
    let energies = [
        ("total", 1.0),
        ("stretching", 0.5),
        ("bending", 0.2),
        ("film", -0.4),
        ("gas", 0.6),
        ("surface", 0.0),
    ]
    .map(|(label, size)| Curve {
        label: label.into(),
        y: x.iter().map(|d| 1e-3 * size * d * (d + 0.1)).collect(),
        x: x.clone(),
        unstable: unstable.clone(),
        ..Curve::default()
    })
    .to_vec();
    let states = [(0.0, 0.0, false), (0.08, 0.02, false), (0.16, 0.1, true), (0.3, 0.25, false)];
    let shapes = states
        .iter()
        .map(|(flat, dent, unstable)| {
            let angles = (0..=200).map(|i| f64::from(i) / 200.0 * std::f64::consts::FRAC_PI_2);
            let sigma: Vec<f64> = angles.clone().map(|s| s.sin() * (1.0 + 0.2 * flat)).collect();
            let z: Vec<f64> = angles
                .map(|s| s.cos().min(1.0 - flat) - dent * (-(s / 0.35).powi(2)).exp())
                .collect();
            let plate = 1.0 - flat + 0.04;
            Shape {
                label: format!("Δ/R₀ = {flat:.2}"),
                sigma,
                z,
                plate,
                plate_below: None,
                stability: Stability::of(*unstable, false),
            }
        })
        .collect();
    let film_pressure = states
        .iter()
        .map(|(flat, _, unstable)| Profile {
            label: format!("Δ/R₀ = {flat:.2}"),
            sigma: (0..=200).map(|i| f64::from(i) / 200.0).collect(),
            value: (0..=200)
                .map(|i| f64::from(i) / 200.0 - 0.3 - flat)
                .map(|s| {
                    2e-4 * (-(s / 0.05).powi(2)).exp() - 6e-5 * (-((s - 0.12) / 0.08).powi(2)).exp()
                })
                .collect(),
            stability: Stability::of(*unstable, false),
        })
        .collect();
    Pictures {
        title: "fig12".into(),
        diagram: Some((
            "μ".into(),
            "u at the centre".into(),
            Curve { label: String::new(), ..force.clone() },
        )),
        force_deformation: Some(force),
        force_distance: Some(distance),
        shapes,
        film_pressure,
        energies,
        states: Vec::new(),
    }
}

#[test]
fn a_branch_with_two_folds_makes_all_pictures() {
    let files = draw_all(&fig12(), &two_folds()).unwrap();
    assert_eq!(files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), NAMES);
    if let Some(folder) = std::env::var_os("ARCLEN_TEST_PICTURES") {
        for (name, svg) in &files {
            std::fs::write(std::path::Path::new(&folder).join(name), svg).unwrap();
        }
    }
    for (name, svg) in files {
        let svg = String::from_utf8(svg).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{name}");
        assert!(svg.contains("fig12") && !svg.contains("NaN"), "{name}");
    }
}

#[test]
fn degenerate_data_are_drawn_without_complaint() {
    let odd = [
        vec![],
        vec![f64::NAN],
        vec![0.0],
        vec![1.0; 5],
        vec![1.0, f64::NAN, 1.0, f64::INFINITY, -1e300],
        vec![1e-320, -1e-320, 0.0],
        vec![1e99, -1e99],
        vec![1.0, 1.0 + 1e-16, 1.0 - 1e-16],
    ];
    for x in &odd {
        for y in &odd {
            for unstable in [vec![], vec![true; 5], vec![true, false, true, false]] {
                let mark = Mark { kind: "fold".into(), x: f64::NAN, y: 0.0 };
                let curve = Curve {
                    label: String::new(),
                    x: x.clone(),
                    y: y.clone(),
                    unstable,
                    asymmetric: vec![false, true, true],
                    examined: Examined::Axisymmetric,
                    marks: vec![mark, Mark::default()],
                };
                let shape =
                    Shape { sigma: x.clone(), z: y.clone(), plate: f64::NAN, ..Shape::default() };
                let profile = Profile { sigma: x.clone(), value: y.clone(), ..Profile::default() };
                let pictures = Pictures {
                    title: "a < b & \u{7} c".into(),
                    force_deformation: Some(curve.clone()),
                    force_distance: Some(curve.clone()),
                    shapes: vec![shape],
                    film_pressure: vec![profile],
                    energies: vec![curve.clone(), curve.clone()],
                    diagram: Some((String::new(), String::new(), curve)),
                    states: Vec::new(),
                };
                for (name, svg) in draw_all(&fig12(), &pictures).unwrap() {
                    let svg = String::from_utf8(svg).unwrap();
                    assert!(!svg.contains("NaN") && !svg.contains('\u{7}'), "{name}");
                    assert!(svg.contains("a &lt; b &amp;"), "{name}");
                }
            }
        }
    }
    assert!(draw_all(&fig12(), &Pictures::default()).unwrap().is_empty());
}

#[test]
fn shapes_have_true_proportions() {
    let shape = Shape { sigma: vec![0.0, 1.0], z: vec![0.5, 0.0], plate: 0.5, ..Shape::default() };
    let files =
        draw_all(&fig12(), &Pictures { shapes: vec![shape], ..Pictures::default() }).unwrap();
    let svg = String::from_utf8(files[0].1.clone()).unwrap();
    // the last quarter drawn before the plates: two points, half as high as wide
    let points: Vec<Vec<f64>> = svg
        .split(" d=\"M")
        .skip(1)
        .map(|rest| {
            let list = rest.split('"').next().unwrap();
            list.split([' ', 'L']).filter_map(|n| n.parse().ok()).collect()
        })
        .collect();
    // axes are neither
    let diagonal = points
        .iter()
        .filter(|p| p.len() == 4 && p[0] != p[2] && p[1] != p[3])
        .max_by(|a, b| (a[0] - a[2]).abs().total_cmp(&(b[0] - b[2]).abs()))
        .expect("the meridian is a straight line");
    let ratio = (diagonal[3] - diagonal[1]) / (diagonal[2] - diagonal[0]);
    assert!((ratio.abs() - 0.5).abs() < 2e-3, "{ratio}");
}
