//! Branch points at which branches of a diagram meet, and the rays that begin there.

use super::Joint;
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Crossing, Direction, Event};
use crate::step::dot;

/// Two branch points nearer than this, relative to the ranges, are the same.
const SAME: f64 = 1e-6;
/// Least cosine between a branch's tangent and a ray that it takes.
const ALONG: f64 = 0.9;

/// Half of a branch, as it leaves a joint.
#[derive(Debug, Clone)]
pub(super) struct Ray {
    /// Tangent away from the joint.
    du: Vec<f64>,
    dp: f64,
    /// Where `dp` is 0, which way the parameter goes.
    bend: f64,
    /// Which of [`Crossing::leaving`] of the event where the joint was found, and whether along it;
    /// `None` for the branch that was traced there.
    pub(super) leaving: Option<(usize, bool)>,
    /// Whether a branch comes or goes along it.
    pub(super) taken: bool,
    /// Whether it waits to be followed.
    pub(super) waits: bool,
}

/// A branch point.
#[derive(Debug, Clone)]
pub(super) struct Node {
    u: Vec<f64>,
    p: f64,
    error: f64,
    /// Range of the unknowns here: the amplitude at which branches bend.
    unknowns: f64,
    pub(super) rays: Vec<Ray>,
    /// Where it was found: a branch and its event.
    pub(super) found: (usize, usize),
    passed: Vec<(usize, usize)>,
    begun: Vec<usize>,
}

/// All branch points of a diagram.
#[derive(Debug, Clone)]
pub(super) struct Joints {
    pub(super) nodes: Vec<Node>,
    /// Range of the parameter.
    range: f64,
}

fn length(problem: &DynProblem<'_>, x: &[f64]) -> f64 {
    let mut y = vec![0.0; x.len()];
    problem.metric(x, &mut y);
    dot(x, &y).max(0.0).sqrt()
}

fn apart(problem: &DynProblem<'_>, a: &[f64], b: &[f64]) -> f64 {
    let d: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    length(problem, &d)
}

impl Joints {
    pub(super) fn new(range: f64) -> Self {
        Joints { nodes: Vec::new(), range }
    }

    /// The joint at this branch point, if it is known.
    pub(super) fn find(
        &self,
        problem: &DynProblem<'_>,
        u: &[f64],
        p: f64,
        error: f64,
    ) -> Option<usize> {
        self.nodes.iter().position(|node| {
            let blur = 10.0 * (error + node.error);
            (node.p - p).abs() <= SAME * self.range + blur
                && apart(problem, &node.u, u) <= SAME * node.unknowns + blur
        })
    }

    /// The ray of `node` that leaves it along `sign` times this direction.
    pub(super) fn ray(
        &self,
        problem: &DynProblem<'_>,
        node: usize,
        (du, dp): (&[f64], f64),
        sign: f64,
    ) -> Option<usize> {
        let node = &self.nodes[node];
        let (w, range) = (node.unknowns, self.range);
        let mut mdu = vec![0.0; du.len()];
        problem.metric(du, &mut mdu);
        let norm = (dot(&mdu, du) / (w * w) + dp * dp / (range * range)).sqrt();
        let cosine = |ray: &Ray| {
            let own = length(problem, &ray.du) / w;
            let own = own.hypot(ray.dp / range);
            let inner = dot(&mdu, &ray.du) / (w * w) + dp * ray.dp / (range * range);
            sign * inner / (norm * own)
        };
        let all = node.rays.iter().map(cosine).enumerate();
        let best = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (best.1 > ALONG).then_some(best.0)
    }

    /// Learns that event `event` of branch `id`, a branch point, is passed; `ends` says that the
    /// branch ends there. The joint's index.
    pub(super) fn pass(
        &mut self,
        problem: &DynProblem<'_>,
        id: usize,
        branch: &Branch,
        event: usize,
        crossing: &Crossing,
        ends: bool,
    ) -> usize {
        let one = &branch.events[event];
        let point = &branch.points[one.point];
        let node = match self.find(problem, &point.u, one.p, one.error_estimate) {
            Some(node) => node,
            None => self.create(problem, id, branch, event, crossing),
        };
        let traced = (&crossing.traced.du[..], crossing.traced.dp);
        for sign in if ends { &[-1.0][..] } else { &[-1.0, 1.0] } {
            if let Some(ray) = self.ray(problem, node, traced, *sign) {
                self.nodes[node].rays[ray].taken = true;
            }
        }
        self.nodes[node].passed.push((id, event));
        node
    }

    fn create(
        &mut self,
        problem: &DynProblem<'_>,
        id: usize,
        branch: &Branch,
        event: usize,
        crossing: &Crossing,
    ) -> usize {
        let one: &Event = &branch.events[event];
        let point = &branch.points[one.point];
        let reach = |d: &Direction| d.amplitude * length(problem, &d.du);
        let amplitude = crossing.leaving.iter().map(reach).fold(0.0, f64::max);
        let excursion =
            branch.points.iter().map(|q| apart(problem, &q.u, &point.u)).fold(0.0, f64::max);
        let unknowns = [amplitude, excursion].into_iter().find(|x| x.is_finite() && *x > 0.0);
        let ray = |d: &Direction, leaving: Option<usize>, forward: bool| {
            let sign = if forward { 1.0 } else { -1.0 };
            Ray {
                du: d.du.iter().map(|x| sign * x).collect(),
                dp: sign * d.dp,
                bend: d.bend,
                leaving: leaving.map(|k| (k, forward)),
                taken: false,
                waits: false,
            }
        };
        let both = |d: &Direction, leaving| [true, false].map(|forward| ray(d, leaving, forward));
        let mut rays = both(&crossing.traced, None).to_vec();
        for (k, direction) in crossing.leaving.iter().enumerate() {
            rays.extend(both(direction, Some(k)));
        }
        self.nodes.push(Node {
            u: point.u.clone(),
            p: one.p,
            error: one.error_estimate,
            unknowns: unknowns.unwrap_or(1.0),
            rays,
            found: (id, event),
            passed: Vec::new(),
            begun: Vec::new(),
        });
        self.nodes.len() - 1
    }

    /// Learns that branch `id` begins along a ray; `closed` says that it comes back to its
    /// beginning.
    pub(super) fn begin(
        &mut self,
        problem: &DynProblem<'_>,
        id: usize,
        (node, ray): (usize, usize),
        closed: bool,
    ) {
        self.nodes[node].begun.push(id);
        self.nodes[node].rays[ray].taken = true;
        if closed {
            let Ray { du, dp, .. } = self.nodes[node].rays[ray].clone();
            if let Some(back) = self.ray(problem, node, (&du, dp), -1.0) {
                self.nodes[node].rays[back].taken = true;
            }
        }
    }

    /// Whether a ray leaves the domain where it begins.
    pub(super) fn leads_out(&self, node: usize, ray: usize, (lo, hi): (f64, f64)) -> bool {
        let node = &self.nodes[node];
        let Ray { dp, bend, .. } = node.rays[ray];
        let way = if dp == 0.0 { bend } else { dp };
        let near = SAME * self.range + 10.0 * node.error;
        (node.p - lo <= near && way < 0.0) || (hi - node.p <= near && way > 0.0)
    }

    /// What is known of the joints, for the reader.
    pub(super) fn report(&self) -> Vec<Joint> {
        let report = |node: &Node| Joint {
            passed: node.passed.clone(),
            begun: node.begun.clone(),
            open: node.rays.iter().filter(|ray| !ray.taken).count(),
        };
        self.nodes.iter().map(report).collect()
    }
}
