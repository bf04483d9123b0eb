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

/// A case whose pictures look as these keys say.
fn looking(keys: &[&str]) -> ResolvedCase {
    let overrides: Vec<study::case::Override> =
        keys.iter().map(|key| study::case::Override::new(format!("picture.{key}"))).collect();
    study::case::load("fig12".as_ref(), &overrides, &[]).unwrap().case
}

fn drawn(keys: &[&str], name: &str) -> String {
    let files = draw_all(&looking(keys), &two_folds()).unwrap();
    let (_, svg) = files.into_iter().find(|(own, _)| own == name).unwrap();
    String::from_utf8(svg).unwrap()
}

#[test]
fn sizes_letters_and_parts_are_those_of_the_case() {
    let usual = drawn(&[], NAMES[1]);
    let plot = "width=\"620.0\" height=\"440.0\"/></clipPath>";
    assert!(usual.contains(plot) && usual.contains("font-size=\"14\""));
    let small = drawn(&["width=300", "height=200", "font_size=7", "line_width=1"], NAMES[1]);
    assert!(small.contains("width=\"300.0\" height=\"200.0\"/></clipPath>"), "{small}");
    assert!(small.contains("font-size=\"7\"") && !small.contains("font-size=\"14\""));
    assert!(small.contains("stroke-width=\"1\"") && !small.contains("stroke-width=\"2\""));
    for (key, there) in [
        ("title=false", "Hooke"),
        ("legend=false", ">pull-off (PO)<"),
        ("grid=false", "#e4e4e4"),
        ("marks=false", ">pull-off (PO)<"),
        ("names=false", ">LP1<"),
        ("unstable=false", "stroke-dasharray=\"7 5\""),
    ] {
        assert!(usual.contains(there), "{there}");
        assert!(!drawn(&[key, "inset=false"], NAMES[1]).contains(there), "{key}");
    }
    // the shape of a shell keeps its proportions
    let (wide, narrow) = (drawn(&[], NAMES[2]), drawn(&["width=240"], NAMES[2]));
    assert!(wide.contains("width=\"480.0\"") && narrow.contains("width=\"240.0\""));
}

#[test]
fn axes_of_the_main_picture_are_those_of_the_case() {
    let keys = ["x_from=0.8", "x_to=0.9", "y_from=-1", "y_to=3"];
    let svg = drawn(&keys, NAMES[1]);
    assert!(svg.contains(">0.80<") && svg.contains(">0.90<") && !svg.contains(">1.0<"), "{svg}");
    assert!(!svg.contains(">pull-off (PO)<"), "it is not in that part");
    // others stay as they are
    assert_eq!(drawn(&keys, NAMES[0]), drawn(&[], NAMES[0]));
    let logarithmic = drawn(&["y_scale=logarithmic", "y_from=0.1"], NAMES[1]);
    assert!(logarithmic.contains(">0.1<") && logarithmic.contains(">0.2<"), "{logarithmic}");
    assert!(!logarithmic.contains("NaN"));
}

#[test]
fn what_is_too_near_to_be_seen_is_enlarged_beside_the_chart() {
    // a hairpin whose sides are two pixels apart
    let n = 60;
    let side = |k: i32| f64::from(k) / f64::from(n);
    let (mut x, mut y): (Vec<f64>, Vec<f64>) = (0..=n).map(|k| (side(k), side(k))).unzip();
    for k in (0..n).rev() {
        x.push(side(k));
        y.push(side(k) - 0.004 * (1.0 - side(k)));
    }
    let unstable: Vec<bool> = (0..x.len()).map(|k| k > n as usize).collect();
    let mark = Mark { kind: "fold".into(), x: 1.0, y: 1.0 };
    let near = Mark { kind: "fold".into(), x: 0.995, y: 0.995 };
    let curve = Curve { x, y, unstable, marks: vec![mark, near], ..Curve::default() };
    let pictures = Pictures { force_distance: Some(curve.clone()), ..Pictures::default() };
    let svg = |keys: &[&str]| {
        String::from_utf8(draw_all(&looking(keys), &pictures).unwrap()[0].1.clone()).unwrap()
    };
    let both = svg(&[]);
    assert!(both.contains(">detail a<") && both.contains(">detail b<"), "{both}");
    assert!(!svg(&["inset=false"]).contains(">detail"));
    // sides that are far apart need none
    let mut apart = curve;
    for (y, unstable) in apart.y.iter_mut().zip(&apart.unstable) {
        *y -= if *unstable { 0.3 } else { 0.0 };
    }
    apart.marks.truncate(1);
    let pictures = Pictures { force_distance: Some(apart), ..Pictures::default() };
    let files = draw_all(&looking(&[]), &pictures).unwrap();
    assert!(!String::from_utf8_lossy(&files[0].1).contains(">detail"));
}

#[test]
fn two_columns_are_a_picture_of_their_own() {
    let keys =
        ["mesh.elements=40", "path.end=1.0", "stability.scan=axisymmetric", "picture.y=volume"];
    let keys = keys.map(study::case::Override::new);
    let case = study::case::load("polymer".as_ref(), &keys, &[]).unwrap().case;
    let go = &mut |_| std::ops::ControlFlow::Continue(());
    let result = study::run::run_trace(&case, go).unwrap();
    let files = draw_columns(&case, &result).unwrap();
    assert_eq!(files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), COLUMNS);
    let text = |at: usize| String::from_utf8(files[at].1.clone()).unwrap();
    assert!(text(0).contains("volume [R") && text(0).contains("plate distance z"), "{}", text(0));
    assert!(text(1).contains("volume [µm") && text(1).contains("[nm]"), "{}", text(1));
    assert!(draw_columns(&fig12(), &result).unwrap().is_empty());
}
