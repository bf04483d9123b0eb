//! What each picture shows.

use super::axis::Axis;
use super::chart::{Chart, Entry, Line, Stroke};
use super::detail::Sought;
use super::heading::fit;
use super::palette::{ASYMMETRIC, Color, FAINT, UNSTABLE, of_quantity, of_state};
use study::case::{AxisCase, AxisScale, PictureCase, shown};
use study::record::view::{Curve, Examined, Mark, Profile, Shape, Stability, drawable};

pub(super) const FORCE: &str = "force F/√(χk_{b})";
pub(super) const DISTANCE: &str = "plate distance z₀/R₀";
pub(super) const DEFORMATION: &str = "deformation Δ/R₀";
pub(super) const WIDE: (u32, u32) = (620, 440);

/// Components of the energy against deformation.
pub(super) fn energies(title: &str, curves: &[Curve]) -> Chart {
    chart(title, DEFORMATION, "energy U/(χ R₀²)", curves)
}

/// A quantity along a branch, with what an eye would miss beside it.
pub(super) fn along(title: &str, x: &str, y: &str, curve: &Curve) -> Chart {
    let chart = chart(title, x, y, std::slice::from_ref(curve));
    Chart { details: Sought::Hidden, ..chart }
}

/// What gives a branch of a diagram its colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Level {
    /// Branch points between it and the first branch.
    Depth(usize),
    /// States that are not their own mirror images.
    Asymmetric,
    /// Periodic orbits, with so many special points between them and the equilibria.
    Cycles(usize),
}

/// Branches of a diagram.
pub(super) fn branches(title: &str, x: &str, y: &str, curves: &[(Level, &Curve)]) -> Chart {
    let all: Vec<Curve> = curves.iter().map(|(_, curve)| (*curve).clone()).collect();
    let Chart { x, y, marks, legend, .. } = chart(title, x, y, &all);
    let markers = legend.into_iter().filter(|entry| matches!(entry, Entry::Marker { .. }));
    let mut lines = Vec::new();
    let mut entries = Vec::new();
    let mut levels: Vec<Level> = curves.iter().map(|(level, _)| *level).collect();
    levels.sort_unstable();
    levels.dedup();
    let steady = levels.iter().filter(|level| !matches!(level, Level::Cycles(_))).count();
    for level in &levels {
        let color = match level {
            Level::Depth(depth) => of_state(*depth),
            Level::Asymmetric => of_state(steady - 1),
            Level::Cycles(depth) => of_state(steady.max(1) + depth - 1),
        };
        let here = curves.iter().filter(|(own, _)| own == level);
        // the first branch on top
        let drawn = here.flat_map(|(_, curve)| curve_lines(curve, color, (&x, &y)));
        lines.splice(0..0, drawn);
        if levels.len() > 1 {
            let label = match level {
                Level::Depth(0) => "first branch".to_owned(),
                Level::Depth(depth) => format!("depth {depth}"),
                Level::Asymmetric => "asymmetric about the equator".to_owned(),
                Level::Cycles(1) => "cycles".to_owned(),
                Level::Cycles(depth) => format!("cycles, depth {}", depth - 1),
            };
            entries.push(Entry::Line { color, stroke: Stroke::Solid, label });
        }
    }
    lines.sort_by_key(|line| line.stroke != Stroke::Solid);
    entries.extend(stability_entries(&all, FAINT));
    entries.extend(markers);
    let details = Sought::Hidden;
    Chart { lines, marks, legend: entries, details, ..Chart::new(fit(title), x, y, WIDE) }
}

/// Disjoining pressure against distance from the axis.
pub(super) fn film_pressure(title: &str, profiles: &[Profile]) -> Chart {
    let titles = ["distance from the axis σ/R₀", "disjoining pressure Π δ_{A}/w₀"];
    pressure(title, titles, profiles)
}

/// The same with other axes.
pub(super) fn pressure(title: &str, [x, y]: [&str; 2], profiles: &[Profile]) -> Chart {
    let x = Axis::of(x, values(profiles, |p| &p.sigma), 7);
    let y = Axis::of(y, values(profiles, |p| &p.value), 7);
    let mut lines = Vec::new();
    let mut legend = Vec::new();
    for (at, profile) in profiles.iter().enumerate() {
        let curve = Curve {
            x: profile.sigma.clone(),
            y: profile.value.clone(),
            ..of_one_state(profile.stability, profile.sigma.len())
        };
        lines.extend(curve_lines(&curve, of_state(at), (&x, &y)));
        legend.push(state_entry(at, &profile.label, profile.stability));
    }
    Chart { lines, legend, ..Chart::new(fit(title), x, y, WIDE) }
}

/// Deformed shapes: whole cross-sections between their plates, in true proportions.
pub(super) fn shapes(title: &str, shapes: &[Shape], picture: &PictureCase) -> Chart {
    let plates = shapes.iter().map(|shape| shape.plate);
    let largest = |values: &mut dyn Iterator<Item = f64>| {
        values.filter(|v| drawable(*v)).fold(0.2, |a: f64, v| a.max(v.abs()))
    };
    let wide = 1.08 * largest(&mut values(shapes, |s| &s.sigma)).max(1.0);
    let high = 1.08 * largest(&mut values(shapes, |s| &s.z).chain(plates)).max(1.0);
    // one unit is as long on both axes, as long as both fit
    let most = (picture.width.unwrap_or(480) as f64, picture.height.unwrap_or(1200) as f64);
    let scale = (most.0 / wide).min(most.1 / high);
    let (width, height) = ((wide * scale).max(120.0), (high * scale).max(120.0));
    let (wide, high) = (width / scale, height / scale);
    let x = Axis::exactly("distance from the axis σ/R₀", -wide, wide, 6);
    let y = Axis::exactly("height z/R₀", -high, high, 6);
    let units = (x.unit, y.unit);
    let mut lines = vec![Line {
        points: (0..=200)
            .map(|i| f64::from(i) * std::f64::consts::TAU / 200.0)
            .map(|angle| (angle.cos() / units.0, angle.sin() / units.1))
            .collect(),
        color: FAINT,
        width: 1,
        stroke: Stroke::Dashed,
    }];
    let mut legend = Vec::new();
    for (at, shape) in shapes.iter().enumerate() {
        let color = of_state(at);
        let mirrored = shape.plate_below.is_none();
        let signs = [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
        for (right, up) in signs.into_iter().take(if mirrored { 4 } else { 2 }) {
            let curve = Curve {
                x: shape.sigma.iter().map(|sigma| right * sigma).collect(),
                y: shape.z.iter().map(|z| up * z).collect(),
                ..of_one_state(shape.stability, shape.sigma.len())
            };
            lines.extend(curve_lines(&curve, color, (&x, &y)));
        }
        let below = shape.plate_below.unwrap_or(-shape.plate);
        for plate in [shape.plate, below].into_iter().filter(|z| drawable(*z)) {
            let ends = [-0.97 * wide, 0.97 * wide];
            let points = ends.map(|end| (end / units.0, plate / units.1)).to_vec();
            lines.push(Line { points, color, width: 1, stroke: Stroke::Solid });
        }
        legend.push(state_entry(at, &shape.label, shape.stability));
    }
    let label = "at rest, without plates".to_string();
    legend.push(Entry::Line { color: FAINT, stroke: Stroke::Dashed, label });
    let size = (width as u32, height as u32);
    Chart { lines, legend, proportional: true, ..Chart::new(fit(title), x, y, size) }
}

/// Several curves over one axis.
pub(super) fn curves(title: &str, x: &str, y: &str, all: &[Curve]) -> Chart {
    chart(title, x, y, all)
}

/// Curves of special points in two parameters; the second one is logarithmic where it goes over a decade.
/// `own` is its value in the case.
pub(super) fn plane(
    title: &str,
    [x, y]: [&str; 2],
    curves: &[Curve],
    own: Option<f64>,
    picture: &PictureCase,
) -> Chart {
    let (low, high) = values(curves, |c| &c.x)
        .chain(own)
        .filter(|value| drawable(*value))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    // the case is shown too, where it lies beside all curves
    let beside = Axis::of(&shown(x), [low, high].into_iter(), 7);
    let ends = [beside.low, beside.high].map(|end| Some(beside.value(end)));
    let mut chart = chart(title, x, y, curves);
    let mut across = picture.x.clone();
    if across.scale == AxisScale::Automatic && low > 0.0 && high >= 10.0 * low {
        let to = across.to.or(Some(1.1 * high));
        across = AxisCase { scale: AxisScale::Logarithmic, to, ..across };
    }
    if across.scale != AxisScale::Logarithmic && (across.from, across.to) == (None, None) {
        [across.from, across.to] = ends;
    } else if across.from.is_none() {
        across.from = Some(0.9 * low).filter(|low| *low > 0.0);
    }
    let upright = AxisCase {
        from: picture.y.from.or(Some(chart.y.value(chart.y.low))),
        to: picture.y.to.or(Some(chart.y.value(chart.y.high))),
        ..picture.y.clone()
    };
    let upright = if upright.scale == AxisScale::Logarithmic { &picture.y } else { &upright };
    chart = chart.with_axes(&across, upright);
    let own = own.map(|value| chart.x.place(value));
    if let Some(at) = own.filter(|at| *at > chart.x.low && *at < chart.x.high) {
        let points = vec![(at, chart.y.low), (at, chart.y.high)];
        let (color, stroke) = (FAINT, Stroke::Dashed);
        chart.lines.insert(0, Line { points, color, width: 1, stroke });
        chart.legend.push(Entry::Line { color, stroke, label: "this case".to_owned() });
    }
    chart
}

/// A chart of curves along a branch, with their special points.
fn chart(title: &str, x: &str, y: &str, curves: &[Curve]) -> Chart {
    let marks = once(curves.iter().flat_map(|curve| curve.marks.clone()));
    let x = Axis::of(&shown(x), values(curves, |c| &c.x).chain(marks.iter().map(|m| m.x)), 7);
    let y = Axis::of(&shown(y), values(curves, |c| &c.y).chain(marks.iter().map(|m| m.y)), 7);
    let mut lines: Vec<Line> = curves
        .iter()
        .flat_map(|curve| curve_lines(curve, of_quantity(&curve.label), (&x, &y)))
        .collect();
    // what is unstable may run along what is stable
    lines.sort_by_key(|line| line.stroke != Stroke::Solid);
    if curves.len() == 1 {
        lines.iter_mut().for_each(|line| line.color = color_alone(line.stroke, line.color));
    }
    let mut legend: Vec<Entry> = Vec::new();
    let unstable = curves.iter().any(Curve::has_unstable);
    if let [curve] = curves {
        let color = of_quantity(&curve.label);
        let label = if unstable { curve.examined.stable() } else { &curve.label };
        if !label.is_empty() {
            legend.push(Entry::Line { color, stroke: Stroke::Solid, label: shown(label) });
        }
        legend.extend(stability_entries(curves, color));
    } else {
        for curve in curves {
            let (color, label) = (of_quantity(&curve.label), shown(&curve.label));
            legend.push(Entry::Line { color, stroke: Stroke::Solid, label });
        }
        legend.extend(stability_entries(curves, FAINT));
    }
    let mut kinds: Vec<String> = Vec::new();
    for mark in marks.iter().filter(|mark| drawable(mark.x) && drawable(mark.y)) {
        let kind = shown(&mark.kind);
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    legend.extend(kinds.into_iter().map(|kind| Entry::Marker { kind }));
    Chart { lines, marks, legend, ..Chart::new(fit(title), x, y, WIDE) }
}

/// Special points, each once: branches of a diagram share those at which they meet.
fn once(marks: impl Iterator<Item = Mark>) -> Vec<Mark> {
    let mut all: Vec<Mark> = Vec::new();
    for mark in marks {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-7 * a.abs().max(b.abs());
        let known =
            |own: &Mark| own.kind == mark.kind && near(own.x, mark.x) && near(own.y, mark.y);
        if !all.iter().any(known) {
            all.push(mark);
        }
    }
    all
}

/// The colour of a stretch of a curve that is alone.
fn color_alone(stroke: Stroke, color: Color) -> Color {
    match stroke {
        Stroke::Solid => color,
        Stroke::Dashed => UNSTABLE,
        Stroke::Dotted => ASYMMETRIC,
    }
}

/// The stretches of a curve as lines, in the units of the axes.
pub(super) fn curve_lines(curve: &Curve, color: Color, (x, y): (&Axis, &Axis)) -> Vec<Line> {
    curve
        .stretches()
        .into_iter()
        .map(|stretch| Line {
            points: stretch.points.map(|i| (x.place(curve.x[i]), y.place(curve.y[i]))).collect(),
            color,
            width: 2,
            stroke: Stroke::of(stretch.stability),
        })
        .collect()
}

/// A curve, but for its points, that shows one state.
pub(super) fn of_one_state(stability: Stability, points: usize) -> Curve {
    Curve {
        unstable: vec![stability == Stability::Unstable; points],
        asymmetric: vec![stability == Stability::Asymmetric; points],
        ..Curve::default()
    }
}

pub(super) fn state_entry(at: usize, label: &str, stability: Stability) -> Entry {
    let words = match stability {
        Stability::Stable => "",
        Stability::Asymmetric => ", unstable to asymmetric modes",
        Stability::Unstable => ", unstable",
    };
    let label = shown(label) + words;
    Entry::Line { color: of_state(at), stroke: Stroke::of(stability), label }
}

/// What lines that are not solid mean, where there are any, and what no line tells.
fn stability_entries(curves: &[Curve], color: Color) -> Vec<Entry> {
    let mut entries = Vec::new();
    // a single curve is its own sample
    if color == FAINT && curves.iter().any(Curve::has_unstable) {
        let label = examined(curves).stable().to_owned();
        entries.push(Entry::Line { color, stroke: Stroke::Solid, label });
    }
    entries.extend(unstable_entries(curves, color));
    entries
}

fn examined(curves: &[Curve]) -> Examined {
    curves.first().map(|curve| curve.examined).unwrap_or_default()
}

/// The same without the stable ones.
pub(super) fn unstable_entries(curves: &[Curve], color: Color) -> Vec<Entry> {
    let examined = examined(curves);
    let own = match examined {
        Examined::All => "unstable",
        _ => "unstable to axisymmetric modes",
    };
    let mut entries = Vec::new();
    let lines =
        [(Stability::Unstable, own), (Stability::Asymmetric, "unstable to asymmetric modes only")];
    for (stability, label) in lines {
        if curves.iter().any(|curve| curve.has(stability)) {
            let (stroke, label) = (Stroke::of(stability), label.to_owned());
            let color = if color == FAINT { color } else { color_alone(stroke, color) };
            entries.push(Entry::Line { color, stroke, label });
        }
    }
    let left_out = match examined {
        Examined::Axisymmetric => "asymmetric modes not examined",
        Examined::AxisymmetricBothParities => "modes cos nφ not examined",
        Examined::All | Examined::AxisymmetricAndOthers => return entries,
    };
    entries.push(Entry::Note { label: left_out.to_owned() });
    entries
}

/// All numbers of one field.
pub(super) fn values<'a, T>(
    items: &'a [T],
    field: impl Fn(&'a T) -> &'a Vec<f64> + 'a,
) -> impl Iterator<Item = f64> + 'a {
    items.iter().flat_map(move |item| field(item).iter().copied())
}
