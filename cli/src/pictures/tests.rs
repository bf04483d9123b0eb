//! Pictures of made-up branches, sound and degenerate.

use super::*;
use crate::output::Pictures;

/// A force curve with two folds in the distance, as strong adhesion makes them.
pub(crate) fn two_folds() -> Pictures {
    let n = 400;
    let (mut x, mut y, mut unstable) = (vec![], vec![], vec![]);
    for i in 0..n {
        let t = i as f64 / (n - 1) as f64;
        let d = 0.32 * t + 0.035 * (2.0 * std::f64::consts::TAU * t).sin() * (1.0 - t);
        x.push(d - 0.01);
        y.push(4.0 * t - 1.2 * (-((t - 0.1) / 0.07f64).powi(2)).exp() + 1.1 * (11.0 * t).sin() * (1.0 - t));
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
    let force = Curve { label: "force".into(), x: x.clone(), y, unstable: unstable.clone(), marks };
    let mut distance = force.clone();
    distance.x.iter_mut().for_each(|x| *x = 1.02 - *x);
    distance.marks.iter_mut().for_each(|mark| mark.x = 1.02 - mark.x);
    let energies = [("total", 1.0), ("stretching", 0.5), ("bending", 0.2), ("film", -0.4), ("gas", 0.6), ("surface", 0.0)]
        .map(|(label, size)| Curve {
            label: label.into(),
            y: x.iter().map(|d| 1e-3 * size * d * (d + 0.1)).collect(),
            x: x.clone(),
            unstable: unstable.clone(),
            marks: vec![],
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
            Shape { label: format!("Δ/R₀ = {flat:.2}"), sigma, z, plate, unstable: *unstable }
        })
        .collect();
    let film_pressure = states
        .iter()
        .map(|(flat, _, unstable)| Profile {
            label: format!("Δ/R₀ = {flat:.2}"),
            sigma: (0..=200).map(|i| f64::from(i) / 200.0).collect(),
            value: (0..=200)
                .map(|i| f64::from(i) / 200.0 - 0.3 - flat)
                .map(|s| 2e-4 * (-(s / 0.05).powi(2)).exp() - 6e-5 * (-((s - 0.12) / 0.08).powi(2)).exp())
                .collect(),
            unstable: *unstable,
        })
        .collect();
    Pictures {
        title: "fig12".into(),
        diagram: Some(("μ".into(), "u at the centre".into(), Curve { label: String::new(), ..force.clone() })),
        force_deformation: Some(force),
        force_distance: Some(distance),
        shapes,
        film_pressure,
        energies,
    }
}

#[test]
fn a_branch_with_two_folds_makes_all_pictures() {
    let files = draw_all(&two_folds()).unwrap();
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
