//! Short names of special points, as charts write them beside the point.

use super::chart::Frame;
use super::path::Place;
use super::text::{self, Style};
use std::collections::BTreeMap;
use study::record::view::Mark;

/// Most names on a chart: where there are more, they would hide it.
const MOST: usize = 14;

/// How important a kind is: what lies on top where marks meet.
pub(super) fn rank(kind: &str) -> u8 {
    match letters(kind) {
        "" => 0,
        "max" | "min" => 1,
        "ZF" | "PO" => 2,
        _ => 3,
    }
}

/// The letters of a kind; empty for kinds of which there are too many to be named.
pub(super) fn letters(kind: &str) -> &'static str {
    match kind {
        "fold" => "LP",
        "branch-point" => "BP",
        "hopf" => "HB",
        "zero-force" => "ZF",
        "pull-off" => "PO",
        "knee" => "K",
        "contact" => "C",
        "cusp" => "CP",
        "bogdanov-takens" => "BT",
        "generalised-hopf" => "GH",
        "zero-hopf" => "ZH",
        "double-hopf" => "HH",
        "period-doubling" => "PD",
        "neimark-sacker" => "NS",
        "cycle-fold" => "LPC",
        "cycle-cusp" => "CPC",
        other if other.ends_with("-maximum") => "max",
        other if other.ends_with("-minimum") => "min",
        _ => "",
    }
}

/// Short names of special points in order along a branch: `LP1`, `LP2`, `PO`. One that is alone of its kind
/// has no number.
pub fn labels<'k>(kinds: impl Iterator<Item = &'k str> + Clone) -> Vec<String> {
    let mut all: BTreeMap<&str, usize> = BTreeMap::new();
    for kind in kinds.clone() {
        *all.entry(letters(kind)).or_default() += 1;
    }
    let mut so_far: BTreeMap<&str, usize> = BTreeMap::new();
    let name = |kind: &str| {
        let letters = letters(kind);
        let number = so_far.entry(letters).or_default();
        *number += 1;
        match all.get(letters) {
            _ if letters.is_empty() => String::new(),
            Some(1) => letters.to_owned(),
            _ => format!("{letters}{number}"),
        }
    };
    kinds.map(name).collect()
}

/// Left, top, right, bottom.
type Box4 = [f64; 4];

fn meet(a: &Box4, b: &Box4) -> bool {
    a[0] < b[2] && a[2] > b[0] && a[1] < b[3] && a[3] > b[1]
}

/// Names beside their points.
#[derive(Debug, Default)]
pub(super) struct Names(Vec<(String, [f64; 2], f64)>);

impl Names {
    /// Places for the names of marks: near them, inside the frame, clear of lines and of each other as far
    /// as there is room.
    pub(super) fn beside(
        marks: &[(&Mark, Place)],
        names: Vec<String>,
        lines: &[Vec<Place>],
        frame: Frame,
        size: f64,
    ) -> Names {
        if names.iter().filter(|name| !name.is_empty()).count() > MOST {
            return Names::default();
        }
        let mut taken: Vec<Box4> =
            marks.iter().map(|(_, (x, y))| [x - 7.0, y - 7.0, x + 7.0, y + 7.0]).collect();
        let mut order: Vec<usize> = (0..marks.len()).filter(|at| !names[*at].is_empty()).collect();
        order.sort_by_key(|at| std::cmp::Reverse(rank(&marks[*at].0.kind)));
        let inside = [frame.left + 2.0, frame.top + 2.0, frame.right - 2.0, frame.bottom - 2.0];
        let mut out = Names::default();
        for at in order {
            let (x, y) = marks[at].1;
            let (wide, high) = (text::width(&names[at], size) + 2.0, size);
            let cost = |b: &Box4, away: f64| {
                let others = taken.iter().filter(|other| meet(b, other)).count() as f64;
                let outside =
                    b[0] < inside[0] || b[1] < inside[1] || b[2] > inside[2] || b[3] > inside[3];
                let crossed: f64 = lines.iter().map(|line| crossed(line, b)).sum();
                away / 12.0 + 25.0 * others + crossed + if outside { 200.0 } else { 0.0 }
            };
            let mut best: Option<(f64, Box4)> = None;
            for away in [9.0, 17.0, 27.0] {
                for turn in 0..16 {
                    let angle =
                        f64::from(turn) * std::f64::consts::PI / 8.0 - 0.25 * std::f64::consts::PI;
                    let middle = (
                        x + angle.cos() * (away + 0.5 * wide),
                        y + angle.sin() * (away + 0.5 * high),
                    );
                    let b = [
                        middle.0 - 0.5 * wide,
                        middle.1 - 0.5 * high,
                        middle.0 + 0.5 * wide,
                        middle.1 + 0.5 * high,
                    ];
                    let cost = cost(&b, away);
                    if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                        best = Some((cost, b));
                    }
                }
            }
            if let Some((_, b)) = best {
                taken.push(b);
                out.0.push((names[at].clone(), [0.5 * (b[0] + b[2]), b[3] - 2.0], size));
            }
        }
        out
    }

    /// Writes them.
    pub(super) fn draw(&self, svg: &mut String) {
        for (name, at, size) in &self.0 {
            let style = Style::small().sized(*size).anchored("middle").bold().with_rim();
            text::put(svg, name, *at, &style);
        }
    }
}

/// How much of a line lies in a box, in pixels over the size of a letter.
fn crossed(line: &[Place], b: &Box4) -> f64 {
    let inside = |(x, y): Place| x > b[0] && x < b[2] && y > b[1] && y < b[3];
    let mut sum = 0.0;
    for pair in line.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let [low, high] =
            [[from.0.min(to.0), from.1.min(to.1)], [from.0.max(to.0), from.1.max(to.1)]];
        if low[0] > b[2] || high[0] < b[0] || low[1] > b[3] || high[1] < b[1] {
            continue;
        }
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let steps = (length / 2.0).ceil().clamp(1.0, 500.0);
        for step in 0..steps as usize {
            let t = (step as f64 + 0.5) / steps;
            if inside((from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1))) {
                sum += length / steps / 4.0;
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_alone_has_no_number() {
        let kinds = ["fold", "pull-off", "symmetry-breaking", "fold", "force-minimum"];
        assert_eq!(labels(kinds.into_iter()), ["LP1", "PO", "", "LP2", "min"]);
        assert!(labels(std::iter::empty()).is_empty());
    }
}
