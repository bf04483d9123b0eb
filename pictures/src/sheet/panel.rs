//! One panel: axes, lines, legend.

use super::{Panel, PanelLine, Pen};
use crate::axis::Axis;
use crate::look::Look;
use crate::palette::{FAINT, GRID, hex};
use crate::text::{self, Style};
use std::fmt::Write;
use study::record::view::{Stability, drawable};

const PLOT: [f64; 2] = [400.0, 290.0];
const TOP: f64 = 30.0;
const BOTTOM: f64 = 56.0;
const ROW: f64 = 20.0;
const SAMPLE: f64 = 30.0;
const TICK: f64 = 5.0;
const INK: &str = "#1e1e1e";

/// A panel with its axes and its size.
pub(super) struct Layout<'p> {
    panel: &'p Panel,
    at: usize,
    x: Axis,
    y: Axis,
    right: Option<Axis>,
    left_room: f64,
    right_room: f64,
    look: Look,
    pub(super) plot: [f64; 2],
    pub(super) width: f64,
    pub(super) height: f64,
}

impl<'p> Layout<'p> {
    pub(super) fn of(panel: &'p Panel, at: usize, look: Look) -> Layout<'p> {
        let k = look.letters;
        let main: Vec<&PanelLine> = panel.lines.iter().filter(|l| !l.right).collect();
        let beside: Vec<&PanelLine> = panel.lines.iter().filter(|l| l.right).collect();
        let x = axis(&panel.x, panel.x_range, panel.lines.iter().flat_map(|l| l.curve.x.clone()));
        let inside = (x.low * x.unit, x.high * x.unit);
        let y = axis(&panel.y, panel.y_range, heights(&main, inside));
        let right = panel.right.as_ref().map(|title| axis(title, None, heights(&beside, inside)));
        let mut plot = [look.size.0.unwrap_or(PLOT[0]), look.size.1.unwrap_or(PLOT[1])];
        if panel.proportional {
            plot[1] = plot[0] * (y.high - y.low) * y.unit / ((x.high - x.low) * x.unit);
        }
        let labels = |axis: &Axis| {
            axis.ticks.iter().fold(0.0_f64, |w, t| w.max(text::width(&axis.label(*t), 13.0 * k)))
        };
        let left_room = 12.0 + 28.0 * k + labels(&y);
        let right_room = right.as_ref().map_or(0.0, |axis| 12.0 + 24.0 * k + labels(axis));
        let legend = entries(panel, look)
            .map(|(label, _)| text::width(label, 13.0 * k) + SAMPLE + 10.0)
            .fold(0.0, f64::max);
        let title = text::width(&panel.title, 15.0 * k) * 1.08;
        let width = (left_room + plot[0] + right_room + 12.0 + legend).max(title);
        let rows = entries(panel, look).count() as f64 * ROW * k;
        let height = k * TOP + (plot[1] + k * BOTTOM).max(rows);
        let sizes = (look.ticks(plot[0], true).min(7), look.ticks(plot[1], false).min(6));
        let usual = look.size == (None, None) && k == 1.0;
        let (x, y) = if usual { (x, y) } else { (x.ticked(sizes.0), y.ticked(sizes.1)) };
        let right = right.map(|axis| if usual { axis } else { axis.ticked(sizes.1) });
        Layout { panel, at, x, y, right, left_room, right_room, look, plot, width, height }
    }

    /// Makes it as high as its neighbour; one with a unit as long on both axes shows more of its vertical one.
    pub(super) fn heighten(&mut self, height: f64) {
        if height > self.plot[1] {
            if self.panel.proportional {
                let y = &self.y;
                let more = (y.high - y.low) * (height / self.plot[1] - 1.0);
                let high = y.value(y.high + more);
                self.y = Axis::exactly(&self.panel.y, y.value(y.low), high, 7);
            }
            self.height += height - self.plot[1];
            self.plot[1] = height;
        }
    }

    pub(super) fn draw(&self, out: &mut String, left: f64, top: f64) {
        let _ = writeln!(out, "<g transform=\"translate({left:.1} {top:.1})\">");
        let k = self.look.letters;
        let bold = Style { bold: true, ..Style::small().sized(15.0 * k) };
        text::put(out, &self.panel.title, [0.0, 1.0 + 15.0 * k], &bold);
        let _ = writeln!(out, "<g transform=\"translate({:.1} {:.1})\">", self.left_room, k * TOP);
        self.axes(out);
        let [w, h] = self.plot;
        let clip = format!("frame-{}-{:.0}-{:.0}", self.at, left, top);
        let _ = writeln!(
            out,
            "<clipPath id=\"{clip}\"><rect x=\"-1\" y=\"-1\" width=\"{:.1}\" height=\"{:.1}\"/></clipPath>\n\
             <g clip-path=\"url(#{clip})\">",
            w + 2.0,
            h + 2.0
        );
        for line in &self.panel.lines {
            self.line(out, line);
        }
        out.push_str("</g>\n");
        let _ = writeln!(
            out,
            "<rect width=\"{w:.1}\" height=\"{h:.1}\" stroke=\"{INK}\" stroke-width=\"1\"/>"
        );
        self.legend(out);
        out.push_str("</g>\n</g>\n");
    }

    fn x_of(&self, value: f64) -> f64 {
        self.plot[0] * (value / self.x.unit - self.x.low) / (self.x.high - self.x.low)
    }

    fn y_of(&self, axis: &Axis, value: f64) -> f64 {
        self.plot[1] * (axis.high - value / axis.unit) / (axis.high - axis.low)
    }

    fn axes(&self, out: &mut String) {
        let [w, h] = self.plot;
        let mut rule = |a: [f64; 2], b: [f64; 2], color: &str| {
            let _ = writeln!(
                out,
                "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"{color}\"/>",
                a[0], a[1], b[0], b[1]
            );
        };
        let grid = hex(GRID);
        let with_grid = self.look.parts.grid;
        for tick in &self.x.ticks {
            let at = self.x_of(tick * self.x.unit);
            if with_grid {
                rule([at, 0.0], [at, h], &grid);
            }
            rule([at, h], [at, h + TICK], INK);
        }
        for tick in &self.y.ticks {
            let at = self.y_of(&self.y, tick * self.y.unit);
            if with_grid {
                rule([0.0, at], [w, at], &grid);
            }
            rule([-TICK, at], [0.0, at], INK);
        }
        if self.y.has_zero() {
            let at = self.y_of(&self.y, 0.0);
            rule([0.0, at], [w, at], &hex(FAINT));
        }
        if let Some(axis) = &self.right {
            for tick in &axis.ticks {
                let at = self.y_of(axis, tick * axis.unit);
                rule([w, at], [w + TICK, at], INK);
            }
        }
        let k = self.look.letters;
        let small = Style::small().sized(13.0 * k);
        for tick in &self.x.ticks {
            let at = self.x_of(tick * self.x.unit);
            text::put(
                out,
                &self.x.label(*tick),
                [at, h + 6.0 + 13.0 * k],
                &small.anchored("middle"),
            );
        }
        for tick in &self.y.ticks {
            let at = self.y_of(&self.y, tick * self.y.unit) + 4.5 * k;
            text::put(out, &self.y.label(*tick), [-8.0, at], &small.anchored("end"));
        }
        let title = small.sized(15.0 * k).anchored("middle");
        let upright = Style { upright: true, ..title };
        text::put(out, &self.x.title, [w / 2.0, h + 42.0 * k], &title);
        text::put(out, &self.y.title, [1.0 + 15.0 * k - self.left_room, h / 2.0], &upright);
        if let Some(axis) = &self.right {
            for tick in &axis.ticks {
                let at = self.y_of(axis, tick * axis.unit) + 4.5;
                text::put(out, &axis.label(*tick), [w + 8.0, at], &small);
            }
            text::put(out, &axis.title, [w + self.right_room - 6.0, h / 2.0], &upright);
        }
    }

    fn line(&self, out: &mut String, line: &PanelLine) {
        let axis = match &self.right {
            Some(axis) if line.right => axis,
            _ => &self.y,
        };
        for stretch in line.curve.stretches() {
            let dashed = stretch.stability != Stability::Stable;
            if dashed && line.pen == Pen::Data && !self.look.parts.unstable {
                continue;
            }
            let points = line.pen == Pen::Points;
            let mut path = String::new();
            let mut last = [f64::NAN; 2];
            for i in stretch.points {
                // far outside the frame nothing is seen, and writers of numbers stumble
                let at = [
                    self.x_of(line.curve.x[i]).clamp(-1e4, 1e4),
                    self.y_of(axis, line.curve.y[i]).clamp(-1e4, 1e4),
                ];
                if (at[0] - last[0]).hypot(at[1] - last[1]) < 0.3 {
                    continue;
                }
                last = at;
                // a line without length has round ends: a dot
                if points {
                    let _ = write!(path, "M{:.2} {:.2}h0", at[0], at[1]);
                    continue;
                }
                let letter = if path.is_empty() { 'M' } else { 'L' };
                let _ = write!(path, "{letter}{:.2} {:.2}", at[0], at[1]);
            }
            let _ = writeln!(out, "<path d=\"{path}\" {}/>", stroke(line, dashed, self.look.line));
        }
    }

    fn legend(&self, out: &mut String) {
        let left = self.plot[0] + self.right_room + 12.0;
        let mut y = 8.0;
        let k = self.look.letters;
        for (label, sample) in entries(self.panel, self.look) {
            let attributes = match sample {
                Some(line) => {
                    stroke(line, line.pen == Pen::Data && unstable_only(line), self.look.line)
                }
                None => {
                    format!("stroke=\"{}\" stroke-width=\"2\" stroke-dasharray=\"7 4\"", hex(FAINT))
                }
            };
            let _ = writeln!(out, "<path d=\"M{left:.1} {y:.1}h{SAMPLE}\" {attributes}/>");
            let style = Style::small().sized(13.0 * k);
            text::put(out, label, [left + SAMPLE + 8.0, y + 4.5 * k], &style);
            y += ROW * k;
        }
    }
}

/// Labels, each once, with the line that is their sample; none for the note on dashes.
fn entries<'p>(
    panel: &'p Panel,
    look: Look,
) -> impl Iterator<Item = (&'p str, Option<&'p PanelLine>)> + use<'p> {
    let first = |(i, l): &(usize, &PanelLine)| panel.lines[..*i].iter().all(|k| k.label != l.label);
    let lines = panel.lines.iter().enumerate().filter(first).map(|(_, l)| l);
    let lines = lines.filter(|l| !l.label.is_empty());
    let inside = |range: Option<[f64; 2]>, at: f64| range.is_none_or(|[a, b]| a <= at && at <= b);
    let seen = |l: &PanelLine| {
        let curve = &l.curve;
        let points = curve.unstable.iter().zip(curve.x.iter().zip(&curve.y));
        points
            .filter(|(unstable, _)| **unstable)
            .any(|(_, (x, y))| inside(panel.x_range, *x) && inside(panel.y_range, *y))
    };
    let dashes = panel.lines.iter().any(|l| l.pen == Pen::Data && seen(l));
    let lines = lines.map(|l| (l.label.as_str(), Some(l)));
    let dashes = dashes && look.parts.unstable;
    let all = lines.chain(dashes.then_some((panel.dashed.unwrap_or("unstable"), None)));
    all.filter(move |_| look.parts.legend)
}

fn unstable_only(line: &PanelLine) -> bool {
    let stretches = line.curve.stretches();
    !stretches.is_empty() && stretches.iter().all(|s| s.stability != Stability::Stable)
}

fn stroke(line: &PanelLine, dashed: bool, scale: f64) -> String {
    let color = hex(line.ink.color());
    match (line.pen, dashed) {
        (Pen::Data, false) => format!("stroke=\"{color}\" stroke-width=\"{}\"", 2.0 * scale),
        (Pen::Data, true) => {
            let width = 2.0 * scale;
            format!("stroke=\"{color}\" stroke-width=\"{width}\" stroke-dasharray=\"7 4\"")
        }
        (Pen::Law, _) => format!(
            "stroke=\"{color}\" stroke-width=\"1.8\" stroke-dasharray=\"0.1 4\" stroke-linecap=\"round\""
        ),
        (Pen::Thin, _) => format!("stroke=\"{color}\" stroke-width=\"0.8\""),
        (Pen::Points, _) => {
            format!("stroke=\"{color}\" stroke-width=\"6\" stroke-linecap=\"round\"")
        }
    }
}

fn axis(title: &str, range: Option<[f64; 2]>, values: impl Iterator<Item = f64>) -> Axis {
    match range {
        Some([low, high]) if low < high => Axis::exactly(title, low, high, 7),
        _ => Axis::of(title, values, 6),
    }
}

/// Ordinates of data inside a range of abscissae; those of laws where there is nothing else.
fn heights(lines: &[&PanelLine], (low, high): (f64, f64)) -> impl Iterator<Item = f64> + use<> {
    let of = |pen: &dyn Fn(Pen) -> bool| -> Vec<f64> {
        let chosen = lines.iter().filter(|line| pen(line.pen));
        chosen
            .flat_map(|line| line.curve.x.iter().zip(&line.curve.y))
            .filter(|(x, y)| **x >= low && **x <= high && drawable(**y))
            .map(|(_, y)| *y)
            .collect()
    };
    let data = of(&|pen| pen != Pen::Law);
    let chosen = if data.is_empty() { of(&|_| true) } else { data };
    chosen.into_iter()
}
