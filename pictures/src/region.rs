//! Where a map has several states: between folds.
//!
//! Two states meet at a fold and are on one side of it only. On a curve of folds this side is always the same hand,
//! left or right along the curve, even through a cusp, where the curve turns back. So along every line of one second
//! parameter each crossing adds two states or takes two away, beginning with the one state at the start of the path.
//! Which hand it is of each curve is found by trying: no number of states may fall below one.

type Point = (f64, f64);

/// Lines of one second parameter that are looked at.
const LINES: usize = 400;
/// What is open on fewer lines is a gap between curves.
const FEWEST: usize = 4;
/// Most curves of which all hands are tried; of more, one after the other is turned while that helps.
const CURVES: usize = 10;

/// A crossing of a line with a curve: where, by which curve, and whether the curve comes from the left.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    at: f64,
    curve: usize,
    rightwards: bool,
}

/// Outlines of the regions with several states, from left to right between `low` and `high`, on a path of the first
/// parameter from one value to another.
pub(super) fn several(
    curves: &[Vec<Point>],
    (low, high): (f64, f64),
    (start, end): (f64, f64),
) -> Vec<Vec<Point>> {
    if curves.is_empty() {
        return Vec::new();
    }
    let place = |k: usize| low + (k as f64 + 0.5) * (high - low) / LINES as f64;
    let lines: Vec<Vec<Crossing>> =
        (0..LINES).map(|k| crossings(curves, place(k), start > end)).collect();
    let Some(hands) = hands(curves.len(), &lines) else { return Vec::new() };
    let mut found: Vec<Vec<(f64, f64)>> =
        lines.iter().map(|line| intervals(line, &hands, end)).collect();
    close_gaps(&mut found, end);
    let half = 0.5 * (high - low) / LINES as f64;
    let mut open: Vec<(Vec<Point>, Vec<Point>)> = Vec::new();
    let mut done = Vec::new();
    let mut kinds: Vec<bool> = Vec::new();
    for (k, found) in found.into_iter().enumerate() {
        // an interval goes on where the line before had as many of the same kind
        let here: Vec<bool> = found.iter().map(|(_, to)| *to == end).collect();
        if here != kinds {
            done.append(&mut open);
            let begin = |(from, to): &(f64, f64)| {
                (vec![(place(k) - half, *from)], vec![(place(k) - half, *to)])
            };
            open = found.iter().map(begin).collect();
            kinds = here;
        }
        for ((from, to), sides) in found.into_iter().zip(&mut open) {
            sides.0.push((place(k), from));
            sides.1.push((place(k), to));
        }
    }
    done.append(&mut open);
    done.into_iter()
        .map(|(mut one, mut other)| {
            for side in [&mut one, &mut other] {
                if let Some((x, y)) = side.last().copied() {
                    side.push((x + half, y));
                }
            }
            one.into_iter().chain(other.into_iter().rev()).collect()
        })
        .collect()
}

/// Takes away what is open to the end on a few lines only: they pass between the ends of two curves.
fn close_gaps(lines: &mut [Vec<(f64, f64)>], end: f64) {
    let is_open = |line: &Vec<(f64, f64)>| line.iter().any(|(_, to)| *to == end);
    let mut from = 0;
    while from < lines.len() {
        let to = (from..lines.len()).find(|k| !is_open(&lines[*k])).unwrap_or(lines.len());
        if to - from < FEWEST {
            for line in &mut lines[from..to] {
                line.retain(|(_, to)| *to != end);
            }
        }
        from = to.max(from + 1);
    }
}

/// Where the line of one second parameter crosses the curves, from the start of the path on.
fn crossings(curves: &[Vec<Point>], x: f64, above: bool) -> Vec<Crossing> {
    let mut found = Vec::new();
    for (curve, points) in curves.iter().enumerate() {
        for pair in points.windows(2) {
            let ((ax, ay), (bx, by)) = (pair[0], pair[1]);
            // the ends of steps belong to one of them only
            if (ax < x) != (bx < x) {
                let at = ay + (x - ax) / (bx - ax) * (by - ay);
                found.push(Crossing { at, curve, rightwards: bx > ax });
            }
        }
    }
    let order = |a: &Crossing, b: &Crossing| a.at.total_cmp(&b.at);
    found.sort_by(|a, b| if above { order(b, a) } else { order(a, b) });
    found
}

/// Whether a crossing adds states: the curve has them on one hand.
fn adds(crossing: &Crossing, hands: &[bool]) -> bool {
    crossing.rightwards == hands[crossing.curve]
}

/// The hands by which no number of states falls below one, and most lines end with one state again. A line that
/// passes a cusp between its points may break either rule.
fn hands(curves: usize, lines: &[Vec<Crossing>]) -> Option<Vec<bool>> {
    let (wrong, hands) =
        if curves <= CURVES { best_of_all(curves, lines) } else { best_nearby(curves, lines) }?;
    (wrong <= lines.len() / 50).then_some(hands)
}

/// How often a choice lets a number of states fall below one, and what it is worth: less is better.
fn cost(hands: &[bool], lines: &[Vec<Crossing>]) -> (usize, usize) {
    let (mut wrong, mut open) = (0, 0);
    for line in lines {
        let mut pairs = 0_i32;
        for crossing in line {
            pairs += if adds(crossing, hands) { 1 } else { -1 };
            if pairs < 0 {
                wrong += 1;
            }
        }
        open += usize::from(pairs != 0);
    }
    (wrong, 3 * wrong + open)
}

fn best_of_all(curves: usize, lines: &[Vec<Crossing>]) -> Option<(usize, Vec<bool>)> {
    let choices = 0..1_usize << curves;
    let all = choices.map(|choice| (0..curves).map(|curve| choice >> curve & 1 == 1).collect());
    let rated = all.map(|hands: Vec<bool>| (cost(&hands, lines), hands));
    rated.min_by_key(|((_, cost), _)| *cost).map(|((wrong, _), hands)| (wrong, hands))
}

/// The best choice that turning one curve, or two, makes no better, from those that the first crossing of most
/// lines suggests: nothing is taken away before something has been added.
fn best_nearby(curves: usize, lines: &[Vec<Crossing>]) -> Option<(usize, Vec<bool>)> {
    let mut hands = vec![false; curves];
    for (curve, hand) in hands.iter_mut().enumerate() {
        let firsts = lines.iter().filter_map(|line| line.first().filter(|c| c.curve == curve));
        let (mut right, mut all) = (0, 0);
        for first in firsts {
            right += usize::from(first.rightwards);
            all += 1;
        }
        *hand = 2 * right > all;
    }
    let mut best = cost(&hands, lines);
    loop {
        let mut better: Option<((usize, usize), Vec<bool>)> = None;
        for a in 0..curves {
            for b in a..curves {
                let mut turned = hands.clone();
                turned[a] = !turned[a];
                if b != a {
                    turned[b] = !turned[b];
                }
                let own = cost(&turned, lines);
                if own.1 < better.as_ref().map_or(best.1, |(least, _)| least.1) {
                    better = Some((own, turned));
                }
            }
        }
        let Some((own, turned)) = better else { return Some((best.0, hands)) };
        (best, hands) = (own, turned);
    }
}

/// Where a line has several states, up to the end of the path where no fold closes it before.
fn intervals(line: &[Crossing], hands: &[bool], end: f64) -> Vec<(f64, f64)> {
    let mut out = Vec::new();
    let (mut pairs, mut from) = (0_i32, None);
    for crossing in line {
        let before = pairs;
        pairs = (pairs + if adds(crossing, hands) { 1 } else { -1 }).max(0);
        match (before, pairs) {
            (0, 1) => from = Some(crossing.at),
            (1, 0) => out.extend(from.take().map(|from| (from, crossing.at))),
            _ => {}
        }
    }
    out.extend(from.map(|from| (from, end)));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The folds `μ = ± 2 (λ/3)^(3/2)` of the cusp, from one end to the other.
    fn cusp() -> Vec<Point> {
        let half = |sign: f64| {
            move |k: usize| {
                let lambda = k as f64 / 100.0;
                (lambda, sign * 2.0 * (lambda / 3.0).powf(1.5))
            }
        };
        (1..=200).rev().map(half(-1.0)).chain((0..=200).map(half(1.0))).collect()
    }

    fn area(outline: &[Point]) -> f64 {
        let next = outline.iter().cycle().skip(1);
        let sum: f64 = outline.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum();
        0.5 * sum.abs()
    }

    #[test]
    fn a_cusp_has_several_states_inside() {
        // 4/3^(3/2) ∫ λ^(3/2)
        let exact = 4.0 / 3.0_f64.powf(1.5) * 0.4 * 2.0_f64.powf(2.5);
        let mut reversed = cusp();
        reversed.reverse();
        let (first, second) = cusp().split_at(201).to_owned_pair();
        for curves in [vec![cusp()], vec![reversed], vec![first, second]] {
            for (start, end) in [(9.0, -9.0), (-9.0, 9.0)] {
                let found = several(&curves, (-0.5, 2.0), (start, end));
                let sum: f64 = found.iter().map(|outline| area(outline)).sum();
                let number = curves.len();
                assert!((sum / exact - 1.0).abs() < 0.02, "{number} from {start}: {sum} {exact}");
            }
        }
    }

    trait Pair {
        fn to_owned_pair(self) -> (Vec<Point>, Vec<Point>);
    }

    impl Pair for (&[Point], &[Point]) {
        fn to_owned_pair(self) -> (Vec<Point>, Vec<Point>) {
            (self.0.to_vec(), self.1.to_vec())
        }
    }

    /// Twelve wedges beside each other, each of two curves: too many hands to try them all.
    #[test]
    fn many_curves_are_shaded_too() {
        let mut curves = Vec::new();
        for k in 0..12 {
            let at = 3.0 * k as f64;
            for sign in [-1.0, 1.0] {
                let half = (0..=50).map(|i| (at + i as f64 / 25.0, sign * i as f64 / 50.0));
                // some run to the left
                let half: Vec<Point> = if (k + usize::from(sign > 0.0)) % 3 == 0 {
                    half.rev().collect()
                } else {
                    half.collect()
                };
                curves.push(half);
            }
        }
        let found = several(&curves, (-0.5, 35.5), (5.0, -5.0));
        let sum: f64 = found.iter().map(|outline| area(outline)).sum();
        assert!((sum / 24.0 - 1.0).abs() < 0.05, "{sum}");
        assert_eq!(found.len(), 12);
    }

    #[test]
    fn beyond_a_fold_that_is_alone_there_are_several_states_to_the_end() {
        let line: Vec<Point> = (0..100).map(|k| (k as f64, 1.0)).collect();
        let found = several(&[line], (0.0, 99.0), (5.0, -1.0));
        assert!((area(&found[0]) / 198.0 - 1.0).abs() < 0.01, "{}", area(&found[0]));
        assert!(several(&[], (0.0, 1.0), (1.0, 0.0)).is_empty());
    }
}
