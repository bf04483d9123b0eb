//! A fit as pictures: data with the model on top, residuals, profiles.

use super::smooth;
use crate::{Ink, Panel, PanelLine, Pen, Sheet};
use identify::record::{Report, Row};
use study::case::PictureCase;
use study::fit::Outcome;
use study::record::view::Curve;

/// Growth of the cost at the end of a 95 % interval.
const LEVEL: f64 = 3.841_459;

/// Force and residuals over the piezo's travel, in nN and nm.
pub(super) fn fit(outcome: &Outcome, look: &PictureCase) -> String {
    let (report, rows) = (&outcome.best.report, &outcome.best.rows);
    let farthest = rows.iter().map(|row| row.piezo).fold(f64::NEG_INFINITY, f64::max);
    let level = |row: &Row| report.baseline.offset + report.baseline.tilt * (farthest - row.piezo);
    let x = |row: &Row| 1e9 * (report.contact - row.piezo);
    let curve = |segment: &str, y: &dyn Fn(&Row) -> f64| {
        let mut curve = Curve::default();
        for row in rows.iter().filter(|row| row.segment == segment) {
            curve.x.push(x(row));
            curve.y.push(y(row));
        }
        curve
    };
    let measured = |row: &Row| 1e9 * (row.force - level(row));
    let model = |row: &Row| 1e9 * (row.model - level(row));
    let residual = |row: &Row| if row.used { 1e9 * row.residual } else { f64::NAN };
    let (mut data, mut force, mut rest) = (Vec::new(), Vec::new(), Vec::new());
    for (k, segment) in ["approach", "retract"].into_iter().enumerate() {
        if rows.iter().any(|row| row.segment == segment) {
            let ink = Ink::Place(1 + k);
            data.push(line("", Ink::Faint, Pen::Thin, curve(segment, &measured)));
            force.push(line(
                &format!("model, {segment}"),
                ink.clone(),
                Pen::Data,
                curve(segment, &model),
            ));
            rest.push(line(segment, ink, Pen::Thin, curve(segment, &residual)));
        }
    }
    if let Some(first) = data.first_mut() {
        first.label = "measured".to_owned();
    }
    // the model is drawn on top
    let force = [data, force].concat();
    let axis = "travel of the piezo beyond the contact point [nm]".to_owned();
    // attraction is small beside what presses: once more, by itself
    let pull = -1e9 * report.pull_off.modelled.min(report.pull_off.measured);
    let largest = rows.iter().map(measured).fold(0.0, f64::max);
    let near = (pull > 0.0 && largest > 6.0 * pull).then(|| {
        let reach = rows.iter().filter(|row| measured(row) < 3.0 * pull).map(x);
        let deepest = reach.fold(f64::NEG_INFINITY, f64::max);
        let first = rows.iter().map(x).fold(f64::INFINITY, f64::min);
        Panel {
            title: "Near contact".to_owned(),
            x: axis.clone(),
            y: "force [nN]".to_owned(),
            lines: force.clone(),
            x_range: (deepest > first).then_some([first, deepest]),
            y_range: Some([-1.3 * pull, 3.0 * pull]),
            ..Panel::default()
        }
    });
    let mut panels = vec![
        Panel {
            title: "Force".to_owned(),
            x: axis.clone(),
            y: "force [nN]".to_owned(),
            lines: force,
            ..Panel::default()
        },
        Panel {
            title: "Residuals".to_owned(),
            x: axis,
            y: "measured minus model [nN]".to_owned(),
            lines: rest,
            ..Panel::default()
        },
    ];
    panels.extend(near);
    let subtitle = format!(
        "{}; chi2/dof {:.3}; noise {:.3} nN; {}",
        report.law,
        report.quality.chi2_dof,
        1e9 * report.quality.noise,
        report.weakest_direction
    );
    Sheet { title: name(report), subtitle, panels }.svg(look)
}

fn name(report: &Report) -> String {
    let name = report.curve.rsplit(['/', '\\']).next().unwrap_or_default();
    format!("Fit of {name}")
}

/// Growth of the cost over each quantity whose profile was followed.
pub(super) fn profiles(report: &Report, look: &PictureCase) -> Option<String> {
    let panels: Vec<Panel> = report
        .profiles
        .iter()
        .map(|profile| {
            let unit = report.estimate(&profile.key).map_or("", |e| e.unit);
            let known = Curve {
                x: profile.values.clone(),
                y: profile.points.iter().map(|p| p.growth).collect(),
                ..Curve::default()
            };
            // the root with its sign rises throughout and is straight for a parabola
            let root: Vec<f64> =
                profile.points.iter().map(|p| p.growth.sqrt().copysign(p.offset)).collect();
            let (x, root) = smooth::through(&profile.values, &root);
            let growth = Curve { x, y: root.iter().map(|r| r * r).collect(), ..Curve::default() };
            let ends = [profile.values.first(), profile.values.last()];
            let level = Curve {
                x: ends.into_iter().flatten().copied().collect(),
                y: vec![LEVEL; 2],
                ..Curve::default()
            };
            Panel {
                title: profile.key.clone(),
                x: format!("{} [{unit}]", profile.key),
                y: "growth of chi2".to_owned(),
                lines: vec![
                    line("profile", Ink::Place(1), Pen::Data, growth),
                    line("", Ink::Place(1), Pen::Points, known),
                    line("95 %", Ink::Faint, Pen::Law, level),
                ],
                ..Panel::default()
            }
        })
        .collect();
    (!panels.is_empty()).then(|| {
        Sheet { title: name(report), subtitle: "profile likelihood".to_owned(), panels }.svg(look)
    })
}

fn line(label: &str, ink: Ink, pen: Pen, curve: Curve) -> PanelLine {
    PanelLine { label: label.to_owned(), ink, pen, right: false, curve }
}
