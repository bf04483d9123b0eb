//! A trace in the middle of its way, as data: to go on later exactly as if it had not stopped.

use super::Tracer;
use super::switching::Departure;
use crate::branch::{Doubt, Event, Point, Statistics, Stop};
use crate::step::{State, StepSize, Weights};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Everything that a tracer knows besides its problem and settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Snapshot {
    weights: Weights,
    statistics: Statistics,
    counted: usize,
    magnitude: Vec<f64>,
    size: StepSize,
    start: State,
    previous: State,
    previous_h: f64,
    #[serde(default)]
    past: f64,
    current: State,
    left_start: bool,
    departure: Option<Departure>,
    crossing: Option<f64>,
    anchor: State,
    anchor_s: f64,
    #[serde(default)]
    expected: Option<Weights>,
    #[serde(default)]
    first: bool,
    #[serde(default)]
    separation: f64,
    s: f64,
    running_unstable: Option<usize>,
    queue: VecDeque<Point>,
    emitted: usize,
    events: Vec<Event>,
    #[serde(default)]
    doubts: Vec<Doubt>,
    stop: Option<Stop>,
}

impl Tracer<'_> {
    /// The state of the trace.
    pub(crate) fn snapshot(&self) -> Snapshot {
        Snapshot {
            weights: self.core.weights,
            statistics: self.core.statistics,
            counted: self.core.counted(),
            magnitude: self.detector.magnitudes().to_vec(),
            size: self.size,
            start: self.start.clone(),
            previous: self.previous.clone(),
            previous_h: self.previous_h,
            past: self.past,
            current: self.current.clone(),
            left_start: self.left_start,
            departure: self.departure.clone(),
            crossing: self.crossing,
            anchor: self.anchor.clone(),
            anchor_s: self.anchor_s,
            expected: self.expected,
            first: self.first,
            separation: self.separation,
            s: self.s,
            running_unstable: self.running_unstable,
            queue: self.queue.clone(),
            emitted: self.emitted,
            events: self.events.clone(),
            doubts: self.doubts.clone(),
            stop: self.stop.clone(),
        }
    }

    /// Whether a snapshot has the sizes of this trace.
    pub(crate) fn fits(&self, from: &Snapshot) -> bool {
        let states = [&from.start, &from.previous, &from.current, &from.anchor];
        let like = |x: &State| {
            let (n, m) = (self.start.u.len(), self.start.values.len());
            [x.u.len(), x.tu.len(), x.mtu.len()] == [n; 3]
                && [x.values.len(), x.slopes.len()] == [m; 2]
        };
        states.into_iter().all(like)
            && from.magnitude.len() == self.start.values.len()
            && from.queue.iter().all(|point| point.u.len() == self.start.u.len())
    }

    /// Goes on from a snapshot of a trace with the same beginning and settings.
    pub(crate) fn restore(&mut self, from: Snapshot) {
        self.core.weights = from.weights;
        self.core.statistics = from.statistics;
        self.core.set_counted(from.counted);
        self.detector.set_magnitudes(from.magnitude);
        self.size = from.size;
        self.start = from.start;
        self.previous = from.previous;
        self.previous_h = from.previous_h;
        self.past = from.past;
        self.trial = from.current.clone();
        self.work = from.current.clone();
        self.current = from.current;
        self.left_start = from.left_start;
        self.departure = from.departure;
        self.crossing = from.crossing;
        self.anchor = from.anchor;
        self.anchor_s = from.anchor_s;
        self.expected = from.expected;
        self.first = from.first;
        self.separation = from.separation;
        self.s = from.s;
        self.running_unstable = from.running_unstable;
        self.queue = from.queue;
        self.emitted = from.emitted;
        self.events = from.events;
        self.doubts = from.doubts;
        self.stop = from.stop;
    }
}
