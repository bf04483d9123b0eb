//! From manifests and branches to panels.

use super::curve::{State, Traced};
use super::laws::force;
use super::manifest::{Abscissa, Law, Manifest, Ordinate, PanelSpec, Part, Show};
use super::ring::{RingBranch, RingPoint};
use super::windows;
use pictures::{Ink, Panel, PanelLine, Pen};
use std::f64::consts::TAU;
use study::record::view::Curve;

/// Samples along the meridian.
const SAMPLES: usize = 1601;
/// Samples of a law.
const LAW: usize = 300;
/// Places in the list of states that have colours of their own.
const COLORS: usize = 7;

/// A state that panels show: curve, deformation on the panel's axis, pass.
type Key = (String, f64, i32);

/// The panels of a figure.
pub(super) fn panels(manifest: &Manifest, traced: &[&Traced], rings: &[RingBranch]) -> Vec<Panel> {
    let mut keys: Vec<Key> = Vec::new();
    for panel in &manifest.panels {
        for key in keys_of(panel) {
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
    }
    let mut labels: Vec<&str> = Vec::new();
    for curve in &manifest.curves {
        if !labels.contains(&&*curve.label) {
            labels.push(&curve.label);
        }
    }
    let draw = |spec: &PanelSpec| {
        // equal labels have equal colours in all panels
        let place = |t: &Traced| labels.iter().position(|label| *label == t.label).unwrap_or(0);
        let curves: Vec<(usize, &Traced)> = spec
            .curves
            .iter()
            .filter_map(|name| traced.iter().find(|t| t.name == *name))
            .map(|t| (place(t), *t))
            .collect();
        let mut panel = match spec.show {
            Show::Force => forces(spec, &curves),
            Show::Energies => energies(spec, &curves),
            Show::Shapes => shapes(spec, &states(spec, &curves, &keys)),
            Show::Pressure => pressure(spec, &states(spec, &curves, &keys)),
            Show::Windows => windows::panel(spec, &curves, x_title(spec.x)),
        };
        if spec.ring_load {
            match spec.show {
                Show::Shapes => panel.lines.extend(rings.iter().flat_map(ring_shapes)),
                _ => panel
                    .lines
                    .extend(rings.iter().enumerate().map(|(i, ring)| ring_line(spec, ring, i))),
            }
        }
        panel.title = match &*spec.letter {
            "" => spec.title.clone(),
            letter => format!("({letter}) {}", spec.title),
        };
        panel.x_range = spec.x_range.or(panel.x_range);
        panel.y_range = spec.y_range.or(panel.y_range);
        panel
    };
    manifest.panels.iter().map(draw).collect()
}

/// States that complete branches do not reach, in words.
pub(super) fn not_reached(manifest: &Manifest, traced: &[&Traced]) -> Vec<String> {
    let mut missing = Vec::new();
    for panel in &manifest.panels {
        for (name, x, pass) in keys_of(panel) {
            let Some(traced) = traced.iter().find(|t| t.name == name) else { continue };
            let complete = traced.branch.branch.is_complete();
            if complete && traced.state(traced.deformation(panel.x, x), pass).is_none() {
                missing.push(format!(
                    "figure {}({}), curve {name}: no state at {x}",
                    manifest.number, panel.letter
                ));
            }
        }
    }
    missing
}

fn keys_of(panel: &PanelSpec) -> Vec<Key> {
    let mut keys = Vec::new();
    for name in &panel.curves {
        for (i, d) in panel.states.iter().enumerate() {
            keys.push((name.clone(), *d, panel.passes.get(i).copied().unwrap_or(1)));
        }
    }
    keys
}

/// Title of the horizontal axis.
fn x_title(axis: Abscissa) -> String {
    match axis {
        Abscissa::Deformation => "deformation Δ/R_{0}",
        Abscissa::Nm => "deformation of one pole Δ (nm)",
        Abscissa::ApproachUm => "approach of the plates 2Δ (μm)",
        Abscissa::Thicknesses => "deformation Δ/h",
        Abscissa::Distance => "plate distance z_{0}/R_{0}",
    }
    .to_owned()
}

fn y_title(axis: Ordinate) -> String {
    match axis {
        Ordinate::Reduced => "force F/(χ k_{b})^{1/2}",
        Ordinate::NanoNewton => "force F (nN)",
        Ordinate::Benchmark => "force 10^{6} F/(2π E h R_{0})",
    }
    .to_owned()
}

/// A quantity of every point of a branch.
fn along(traced: &Traced, x: Abscissa, y: &dyn Fn(usize) -> f64) -> Curve {
    let points = &traced.branch.branch.points;
    Curve {
        label: String::new(),
        x: points.iter().map(|q| traced.abscissa(x, q.p)).collect(),
        y: (0..points.len()).map(y).collect(),
        unstable: points.iter().map(|q| q.unstable.is_some_and(|n| n > 0)).collect(),
        ..Curve::default()
    }
}

fn forces(spec: &PanelSpec, curves: &[(usize, &Traced)]) -> Panel {
    let mut lines = Vec::new();
    let several = curves.len() > 1;
    for (at, traced) in curves {
        let force = |i| traced.ordinate(spec.y, traced.observable(i, "force"));
        lines.push(PanelLine {
            label: traced.label.clone(),
            ink: if several { Ink::Place(*at) } else { Ink::Quantity("force") },
            pen: Pen::Data,
            right: false,
            curve: along(traced, spec.x, &force),
        });
    }
    if let Some((_, traced)) = curves.first() {
        let x = lines.iter().flat_map(|line| line.curve.x.iter().copied());
        let highest = x.filter(|x| x.is_finite()).fold(f64::NEG_INFINITY, f64::max);
        let end = spec.x_range.map_or(highest, |[_, high]| high);
        lines.extend(spec.laws.iter().map(|law| law_line(*law, spec, traced, end, several)));
    }
    Panel { x: x_title(spec.x), y: y_title(spec.y), lines, ..Panel::default() }
}

/// A branch of the ring load; its colour follows those of the films.
fn ring_line(spec: &PanelSpec, ring: &RingBranch, at: usize) -> PanelLine {
    let y = |q: &RingPoint| if spec.show == Show::Energies { q.energy } else { q.force };
    PanelLine {
        label: ring.label.to_owned(),
        ink: Ink::Place(2 + at),
        pen: Pen::Data,
        right: false,
        curve: Curve {
            x: ring.points.iter().map(|q| q.deflection).collect(),
            y: ring.points.iter().map(y).collect(),
            unstable: ring.points.iter().map(|q| q.unstable).collect(),
            ..Curve::default()
        },
    }
}

/// Meridians under the ring load, to lie over those between plates.
fn ring_shapes(ring: &RingBranch) -> impl Iterator<Item = PanelLine> {
    ring.shapes.iter().map(|shape| PanelLine {
        label: "ring load".to_owned(),
        ink: Ink::Place(0),
        pen: Pen::Law,
        right: false,
        curve: Curve {
            x: mirrored(&shape.sigma, |s| -s),
            y: mirrored(&shape.z, |z| z),
            ..Curve::default()
        },
    })
}

/// From the left equator over the pole to the right one.
fn mirrored(half: &[f64], left: fn(f64) -> f64) -> Vec<f64> {
    half.iter().rev().map(|at| left(*at)).chain(half.iter().skip(1).copied()).collect()
}

fn law_line(law: Law, spec: &PanelSpec, traced: &Traced, end: f64, several: bool) -> PanelLine {
    let x: Vec<f64> = (0..=LAW).map(|i| end * i as f64 / LAW as f64).collect();
    let y = x.iter().map(|x| {
        traced.ordinate(spec.y, force(law, &traced.problem, traced.deformation(spec.x, *x)))
    });
    let (label, place) = match law {
        Law::Reissner => ("Reissner, (32)", 0),
        Law::PrintedPogorelov => ("Pogorelov, (33)", 1),
        Law::PlatePogorelov => ("Pogorelov, plates", 2),
        Law::Cubic => ("cubic, (39) in full", 3),
        Law::LinearAndCubicShare => ("(32) + 0.37 × (39)", 4),
    };
    PanelLine {
        label: label.to_owned(),
        ink: if several { Ink::Faint } else { Ink::Law(place) },
        pen: Pen::Law,
        right: false,
        curve: Curve { y: y.collect(), x, ..Curve::default() },
    }
}

fn energies(spec: &PanelSpec, curves: &[(usize, &Traced)]) -> Panel {
    const ALL: [Part; 5] = [Part::Total, Part::Stretching, Part::Bending, Part::Film, Part::Gas];
    let mut lines = Vec::new();
    let several = curves.len() > 1;
    for (at, traced) in curves {
        let tense = traced.problem.groups().surface_tension > 0.0 && spec.right.is_none();
        let parts: Vec<Part> = if spec.parts.is_empty() {
            ALL.into_iter().chain(tense.then_some(Part::Surface)).collect()
        } else {
            spec.parts.clone()
        };
        let sides = parts.iter().map(|part| (*part, false));
        for (part, right) in sides.chain(spec.right.map(|part| (part, true))) {
            let name = format!("energy_{}", part.name());
            let value = |i| traced.observable(i, &name);
            let label = if several || spec.ring_load {
                traced.label.clone()
            } else {
                part.name().to_owned()
            };
            lines.push(PanelLine {
                label: if right { format!("{label} (right axis)") } else { label },
                ink: if several { Ink::Place(*at) } else { Ink::Quantity(part.name()) },
                pen: Pen::Data,
                right,
                curve: along(traced, spec.x, &value),
            });
        }
    }
    Panel {
        x: x_title(spec.x),
        y: "energy W/(χ R_{0}^{2})".to_owned(),
        right: spec.right.map(|part| format!("{} energy W/(χ R_{{0}}^{{2}})", part.name())),
        lines,
        ..Panel::default()
    }
}

/// A state with its colour and its label.
struct Shown<'t> {
    traced: &'t Traced,
    state: State,
    place: usize,
    label: String,
}

fn states<'t>(spec: &PanelSpec, curves: &[(usize, &'t Traced)], keys: &[Key]) -> Vec<Shown<'t>> {
    let mut shown = Vec::new();
    for (at, (name, x, pass)) in keys_of(spec).into_iter().enumerate() {
        let Some((_, traced)) = curves.iter().find(|(_, t)| t.name == name) else { continue };
        let Some(state) = traced.state(traced.deformation(spec.x, x), pass) else { continue };
        let everywhere = keys.iter().position(|key| *key == (name.clone(), x, pass));
        let place = if keys.len() <= COLORS { everywhere.unwrap_or(at) } else { at };
        let mut label = match spec.x {
            Abscissa::Deformation => format!("Δ/R_{{0}} = {x}"),
            Abscissa::Nm => format!("Δ = {x} nm"),
            Abscissa::ApproachUm => format!("2Δ = {x} μm"),
            Abscissa::Thicknesses => format!("Δ/h = {x}"),
            Abscissa::Distance => format!("z_{{0}}/R_{{0}} = {x}"),
        };
        label = label.replace('-', "−");
        if pass > 1 {
            label += ", buckled";
        }
        shown.push(Shown { traced, state, place, label });
    }
    shown
}

fn shapes(spec: &PanelSpec, shown: &[Shown<'_>]) -> Panel {
    let circle = (0..=300).map(|i| TAU * f64::from(i) / 300.0);
    let mut lines = vec![PanelLine {
        label: String::new(),
        ink: Ink::Faint,
        pen: Pen::Thin,
        right: false,
        curve: Curve {
            x: circle.clone().map(f64::cos).collect(),
            y: circle.map(f64::sin).collect(),
            ..Curve::default()
        },
    }];
    let mut wide = 1.0_f64;
    for Shown { traced, state, place, label } in shown {
        let Some(profile) = traced.profile(state, SAMPLES) else { continue };
        wide = profile.sigma.iter().fold(wide, |w, s| w.max(*s));
        let (x, y) = (mirrored(&profile.sigma, |s| -s), mirrored(&profile.z, |z| z));
        let unstable = vec![state.unstable; x.len()];
        let line = |label: &str, pen, curve| PanelLine {
            label: label.to_owned(),
            ink: Ink::Place(*place),
            pen,
            right: false,
            curve,
        };
        lines.push(line(label, Pen::Data, Curve { x, y, unstable, ..Curve::default() }));
        let plate = Curve { x: vec![-9.0, 9.0], y: vec![state.z0; 2], ..Curve::default() };
        lines.push(line("", Pen::Thin, plate));
    }
    let reach = 1.08 * wide;
    Panel {
        x: "σ/R_{0}".to_owned(),
        y: "z/R_{0}".to_owned(),
        lines,
        x_range: Some([-reach, reach]),
        y_range: Some([0.0, 1.14]),
        // a detail is stretched
        proportional: spec.y_range.is_none(),
        ..Panel::default()
    }
}

fn pressure(_: &PanelSpec, shown: &[Shown<'_>]) -> Panel {
    let mut lines = Vec::new();
    for Shown { traced, state, place, label } in shown {
        let Some(profile) = traced.profile(state, SAMPLES) else { continue };
        lines.push(PanelLine {
            label: label.clone(),
            ink: Ink::Place(*place),
            pen: Pen::Data,
            right: false,
            curve: Curve {
                unstable: vec![state.unstable; profile.sigma.len()],
                x: profile.sigma,
                y: profile.disjoining_pressure,
                ..Curve::default()
            },
        });
    }
    Panel {
        x: "distance from the axis σ/R_{0}".to_owned(),
        y: "disjoining pressure Π δ_{A}/w_{0}".to_owned(),
        lines,
        ..Panel::default()
    }
}
