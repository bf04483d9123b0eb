//! The end of a Hopf curve.
//!
//! Where `ω → 0` the curve's equations become singular: Hopf points end at a Bogdanov-Takens point,
//! which lies on a curve of folds. State and parameters are even functions of `ω`, so that the last
//! points extrapolate to it with an error `O(ω⁴)`; from there it is found on the fold curve, where
//! it is a simple zero of `wᵀMv`.

use super::fold::FoldCurve;
use super::hopf::HopfCurve;
use super::trace::Curve;
use crate::branch::{Event, EventKind, Point, Stop, StopReason};
use crate::problem::Problem;
use crate::settings::Settings;
use std::ops::ControlFlow;

/// How much farther than extrapolated the point may be.
const FARTHEST: f64 = 5.0;
/// Ratio of the frequencies at the two points from which it is extrapolated, at least.
const APART: f64 = 1.2;
/// How far along the fold curve it is sought, in distances by which the last point is off.
const SEARCH: f64 = 30.0;

/// Replaces the ends of a Hopf curve at the small frequency `level` by the Bogdanov-Takens points
/// beyond them.
pub(super) fn finish(hopf: &HopfCurve<'_>, curve: &mut Curve, level: f64) {
    for first in [true, false] {
        let end = if first { &curve.first_end } else { &curve.branch.stopped };
        let n = hopf.base.problem.dim();
        let points = &curve.branch.points;
        let at = if first { 0 } else { points.len().saturating_sub(1) };
        let Some(point) = points.get(at) else { continue };
        let low = (point.u[n + 1] / level - 1.0).abs() < 1e-6;
        if end.reason != StopReason::Target || !low {
            continue;
        }
        // it is no event that the frequency is small
        if let Some(event) = point.event {
            curve.forget(event);
        }
        let found = search(hopf, curve, at, first);
        let takens = found.is_some();
        if let Some((point, event)) = found {
            append(curve, first, point, event);
        }
        let detail = if takens {
            "the curve ends at a Bogdanov-Takens point".to_owned()
        } else {
            "the frequency vanishes; no Bogdanov-Takens point was found there".to_owned()
        };
        let reason = if takens { StopReason::Target } else { StopReason::StepTooSmall };
        let end = if first { &mut curve.first_end } else { &mut curve.branch.stopped };
        *end = Stop { reason, detail };
    }
}

/// The Bogdanov-Takens point beyond the curve's end, as a point and an event.
fn search(hopf: &HopfCurve<'_>, curve: &Curve, at: usize, first: bool) -> Option<(Point, Event)> {
    let points = &curve.branch.points;
    let n = hopf.base.problem.dim();
    let end = &points[at];
    // far enough from the end for the difference to say something
    let apart = |point: &&Point| point.u[n + 1] > APART * end.u[n + 1];
    let inner =
        if first { points[1..].iter().find(apart) } else { points[..at].iter().rev().find(apart) };
    let inner = inner?;
    let squares = (end.u[n + 1].powi(2), inner.u[n + 1].powi(2));
    let weight = squares.0 / (squares.1 - squares.0);
    if !(weight > 0.0 && weight < 10.0) {
        return None;
    }
    let beyond = |a: f64, b: f64| a + weight * (a - b);
    let u: Vec<f64> = end.u[..=n].iter().zip(&inner.u).map(|(a, b)| beyond(*a, *b)).collect();
    let q = beyond(end.p, inner.p);

    let base = &hopf.base;
    let mut p = base.p.clone();
    (p[base.first.0], p[base.second.0]) = (u[n], q);
    let base = base.from(u[..n].to_vec(), p);
    let scale = base.scales.second;
    let off = (q - end.p).abs().max(1e-6 * scale);
    let folds = FoldCurve::new(base).ok()?;
    let domain = Some((q - SEARCH * off, q + SEARCH * off));
    let settings = Settings { domain, max_points: 300, ..Settings::default() };
    let found = folds.trace(&settings, &[], &mut |_| ControlFlow::Continue(())).ok()?;
    let distance = |x: &[f64], q_x: f64| {
        let d: Vec<f64> = x[..=n].iter().zip(&u).map(|(a, b)| a - b).collect();
        let mut m = vec![0.0; n + 1];
        folds.metric(&d, &mut m);
        let along = crate::step::dot(&d, &m).max(0.0).sqrt() / hopf.base.scales.unknowns;
        along.hypot((q_x - q) / scale)
    };
    let takens = found.branch.events_of(&EventKind::BogdanovTakens);
    let nearest = takens
        .map(|event| (distance(&found.branch.points[event.point].u, event.p), event))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let (off, event) = nearest?;
    if off > FARTHEST * distance(&end.u, end.p) {
        return None;
    }
    let at = &found.branch.points[event.point];
    let mut state = at.u.clone();
    state.push(0.0);
    let mut observables = end.observables.clone();
    let own = hopf.base.problem.observables().len();
    observables[0] = at.u[n];
    observables[1] = 0.0;
    observables[2..2 + own].copy_from_slice(&at.observables[1..1 + own]);
    observables[2 + own] = f64::NAN;
    let point = Point { p: at.p, u: state, observables, event: None, ..end.clone() };
    Some((point, Event { kind: EventKind::BogdanovTakens, ..event.clone() }))
}

fn append(curve: &mut Curve, first: bool, mut point: Point, mut event: Event) {
    let (points, events) = (&mut curve.branch.points, &mut curve.branch.events);
    let Some(end) = (if first { points.first() } else { points.last() }) else { return };
    // the last piece, by the chord
    let chord = point.u.iter().zip(&end.u).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let s = end.s;
    (event.unstable_before, event.unstable_after) = (end.unstable, end.unstable);
    if first {
        points.iter_mut().for_each(|point| point.s += chord);
        for point in points.iter_mut() {
            point.event = point.event.map(|e| e + 1);
        }
        events.iter_mut().for_each(|event| event.point += 1);
        (point.s, point.event, event.point) = (0.0, Some(0), 0);
        points.insert(0, point);
        events.insert(0, event);
    } else {
        (point.s, point.event, event.point) = (s + chord, Some(events.len()), points.len());
        points.push(point);
        events.push(event);
    }
}
