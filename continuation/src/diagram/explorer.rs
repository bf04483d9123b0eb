//! The exploration: which ray is followed next, and what a traced branch adds.

use super::follow::{Listener, follow};
use super::joints::Joints;
use super::settings::DiagramSettings;
use super::{
    Diagram, DiagramBranch, DiagramError, DiagramProgress, DiagramStop, Origin, Unfinished,
};
use crate::any_problem::DynProblem;
use crate::branch::{Branch, EventKind, Statistics, Stop, StopReason};
use crate::deflation::{DeflationReport, OffBranch, off_branches};
use crate::events::Watch;
use crate::near::{self, NearBifurcation};
use crate::problem::Problem;

use crate::settings::Settings;
use crate::tracer::{Progress, TraceError, Tracer, both};
use std::collections::VecDeque;
use std::ops::ControlFlow;

/// What is to be followed.
#[derive(Debug, Clone, PartialEq)]
enum Task {
    Start,
    Ray {
        node: usize,
        ray: usize,
        depth: usize,
    },
    /// A solution on no known branch.
    Off {
        u: Vec<f64>,
        p: Vec<f64>,
        parameter: f64,
        branch: usize,
        near: usize,
    },
}

/// So many branches are sought beside one near-bifurcation.
const MANY: usize = 8;

/// Told of every point; may stop the exploration.
pub(super) type Observer<'o> = dyn FnMut(&DiagramProgress<'_>) -> ControlFlow<()> + 'o;

/// Explores a diagram branch by branch.
pub struct Explorer<'a> {
    problem: &'a DynProblem<'a>,
    parameter: String,
    start: (Vec<f64>, Vec<f64>),
    settings: DiagramSettings,
    watches: Vec<Watch>,
    branches: Vec<DiagramBranch>,
    joints: Joints,
    // known as soon as the first branch is
    domain: Option<(f64, f64)>,
    queue: VecDeque<Task>,
    // the next near-bifurcation beside which to search: a branch and a number
    searched: (usize, usize),
    unfinished: Option<Unfinished>,
    stopped: Option<DiagramStop>,
}

impl<'a> Explorer<'a> {
    /// Prepares the diagram of the branch through the solution near `u`, in the named parameter.
    /// `u`, `p` and `parameter` are those of [`Tracer::new`]; `watches` hold on every branch.
    ///
    /// # Errors
    /// When the settings or the start are unusable, or nothing bounds the first branch.
    pub fn new<P: Problem>(
        problem: &'a P,
        parameter: &str,
        u: &[f64],
        p: &[f64],
        settings: DiagramSettings,
        watches: &[Watch],
    ) -> Result<Self, DiagramError> {
        Self::of(problem, parameter, u, p, settings, watches)
    }

    fn of(
        problem: &'a DynProblem<'a>,
        parameter: &str,
        u: &[f64],
        p: &[f64],
        settings: DiagramSettings,
        watches: &[Watch],
    ) -> Result<Self, DiagramError> {
        settings.validate()?;
        let ends = |watch: &Watch| matches!(watch, Watch::Value { stop: true, .. });
        let bounded = settings.trace.target.is_some() || settings.trace.domain.is_some();
        if !bounded && !watches.iter().any(ends) {
            return Err(DiagramError::Unbounded);
        }
        // what is wrong with the start shows here
        Tracer::of(problem, parameter, u, p, settings.trace.clone())?.watching(watches)?;
        Ok(Explorer {
            problem,
            parameter: parameter.to_owned(),
            start: (u.to_vec(), p.to_vec()),
            settings,
            watches: watches.to_vec(),
            branches: Vec::new(),
            joints: Joints::new(1.0),
            domain: None,
            queue: VecDeque::from([Task::Start]),
            searched: (0, 0),
            unfinished: None,
            stopped: None,
        })
    }

    /// Goes on after branches that were traced before, in another process for example: the first
    /// ones of [`Diagram::branches`] of the same problem with the same settings. `unfinished`, if it is
    /// there, is the one that followed them; it is traced on from where it stands.
    ///
    /// # Errors
    /// When the branches cannot be those of this diagram.
    pub fn resume(
        mut self,
        finished: Vec<DiagramBranch>,
        unfinished: Option<Unfinished>,
    ) -> Result<Self, DiagramError> {
        for (k, one) in finished.into_iter().enumerate() {
            let foreign = |what| DiagramError::Foreign { branch: k, what };
            if one.branch.parameter != self.parameter {
                return Err(foreign("it was traced in another parameter"));
            }
            if one.branch.points.iter().any(|point| point.u.len() != self.problem.dim()) {
                return Err(foreign("it has another number of unknowns"));
            }
            let task = match (self.pop(), one.origin) {
                // what was found need not be sought again
                (None, Origin::Deflation { branch, near, parameter }) => {
                    if self.branches.get(branch).is_none_or(|b| near >= b.near.len()) {
                        return Err(foreign("it was found beside a branch that is not there"));
                    }
                    self.searched = (branch, near);
                    Task::Off { u: Vec::new(), p: Vec::new(), parameter, branch, near }
                }
                (None, _) => return Err(foreign("there is nothing left to be followed")),
                (Some(task), _) => task,
            };
            if self.origin(&task) != one.origin {
                return Err(foreign("another branch comes next"));
            }
            self.add(task, one.branch, one.near);
        }
        self.unfinished = unfinished;
        Ok(self)
    }

    /// The branches so far.
    pub fn branches(&self) -> &[DiagramBranch] {
        &self.branches
    }

    /// Traces one more branch; `None` when the exploration has ended. A branch that the observer
    /// interrupts is the last one, and holds what was traced of it.
    ///
    /// # Errors
    /// When the first branch cannot be traced.
    pub fn next_branch(
        &mut self,
        observer: &mut Observer<'_>,
    ) -> Result<Option<&DiagramBranch>, DiagramError> {
        if self.stopped.is_some() {
            return Ok(None);
        }
        let (task, branch) = loop {
            let branches = self.branches.len();
            let next = match self.pop() {
                None => self.search(&mut |p| {
                    let at = Progress { points: 0, events: 0, p, s: 0.0 };
                    let (origin, part) = (Origin::Start, None);
                    observer(&DiagramProgress { branches, waiting: 0, at, origin, part })
                }),
                some => some,
            };
            let Some(task) = next else {
                self.stopped = self.stopped.or(Some(DiagramStop::Complete));
                return Ok(None);
            };
            if self.branches.len() >= self.settings.max_branches {
                self.stopped = Some(DiagramStop::MaxBranches);
                return Ok(None);
            }
            let waiting = self.waiting();
            let origin = self.origin(&task);
            let unfinished = self.unfinished.take().filter(|one| one.origin == origin);
            let traced = self.trace(&task, unfinished, &mut |at, part| {
                observer(&DiagramProgress { branches, waiting, at: *at, origin, part })
            });
            match (traced, &task) {
                (Ok(branch), _) => break (task, branch),
                // a solution without a tangent: another place will show the branch, if there is one
                (Err(_), Task::Off { branch, near, .. }) => self.searched = (*branch, near + 1),
                (Err(error), _) => return Err(error),
            }
        };
        let interrupted = |stop: &Stop| stop.reason == StopReason::Interrupted;
        if interrupted(&branch.stopped) || branch.began.as_ref().is_some_and(interrupted) {
            self.stopped = Some(DiagramStop::Interrupted);
        }
        let near = if self.stopped.is_none() { self.near(&branch) } else { Vec::new() };
        self.add(task, branch, near);
        Ok(self.branches.last())
    }

    /// Explores to the end.
    ///
    /// # Errors
    /// When the first branch cannot be traced.
    pub fn run(mut self, observer: &mut Observer<'_>) -> Result<Diagram, DiagramError> {
        while self.next_branch(observer)?.is_some() {}
        Ok(self.finish())
    }

    /// The diagram as far as it has come.
    pub fn finish(self) -> Diagram {
        Diagram {
            joints: self.joints.report(),
            branches: self.branches,
            stopped: self.stopped.unwrap_or(DiagramStop::Interrupted),
        }
    }

    /// Rays that wait, as far as is known.
    fn waiting(&self) -> usize {
        self.queue.iter().filter(|task| self.is_open(task)).count()
    }

    fn is_open(&self, task: &Task) -> bool {
        match *task {
            Task::Start | Task::Off { .. } => true,
            Task::Ray { node, ray, .. } => !self.joints.nodes[node].rays[ray].taken,
        }
    }

    fn pop(&mut self) -> Option<Task> {
        loop {
            let task = self.queue.pop_front()?;
            if self.is_open(&task) {
                return Some(task);
            }
        }
    }

    fn origin(&self, task: &Task) -> Origin {
        match *task {
            Task::Start => Origin::Start,
            Task::Ray { node, ray, .. } => {
                let node = &self.joints.nodes[node];
                let (branch, event) = node.found;
                let (direction, forward) = node.rays[ray].leaving.unwrap_or((0, true));
                Origin::Switch { branch, event, direction, forward }
            }
            Task::Off { parameter, branch, near, .. } => {
                Origin::Deflation { branch, near, parameter }
            }
        }
    }

    /// The near-bifurcations of a branch.
    fn near(&self, branch: &Branch) -> Vec<NearBifurcation> {
        let Some(search) = &self.settings.search else { return Vec::new() };
        // a branch that was traced is one of this problem, with a value at every point
        near::beside(self.problem, branch, search.near).unwrap_or_default()
    }

    /// A solution beside the next near-bifurcation that is on no known branch. Beside each the
    /// search goes on until there is no further one. `observer` is told where it searches, and may
    /// stop it.
    fn search(&mut self, observer: &mut dyn FnMut(f64) -> ControlFlow<()>) -> Option<Task> {
        let search = self.settings.search.clone()?;
        let known: Vec<&Branch> = self.branches.iter().map(|one| &one.branch).collect();
        loop {
            let (branch, near) = self.searched;
            let one = self.branches.get(branch)?;
            if near >= one.near.len() || one.depth >= self.settings.depth {
                self.searched = (branch + 1, 0);
                continue;
            }
            let beside = std::slice::from_ref(&one.near[near]);
            let (mut stopped, p) = (false, beside[0].p);
            let mut hear = |_: &DeflationReport| {
                let wish = observer(p);
                stopped |= wish.is_break();
                wish
            };
            let (problem, settings) = (self.problem, &search.deflation);
            let found = off_branches(problem, &known, beside, &[], settings, &mut hear);
            if stopped {
                self.stopped = Some(DiagramStop::Interrupted);
                return None;
            }
            let which = self.problem.parameters().iter().position(|q| q.name == self.parameter)?;
            let inside = |p: f64| self.domain.is_none_or(|(lo, hi)| (lo..=hi).contains(&p));
            let first = found.unwrap_or_default().into_iter().find(|off| inside(off.p[which]));
            match first {
                Some(OffBranch { u, p, .. }) => {
                    return Some(Task::Off { parameter: p[which], u, p, branch, near });
                }
                None => self.searched = (branch, near + 1),
            }
        }
    }

    fn trace(
        &self,
        task: &Task,
        unfinished: Option<Unfinished>,
        observer: &mut Listener<'_>,
    ) -> Result<Branch, DiagramError> {
        let part = unfinished.map(|one| one.part);
        let (problem, watches) = (self.problem, &self.watches[..]);
        let settings = self.settings.trace.clone();
        if let Task::Off { u, p, .. } = task {
            let (name, settings) = (&self.parameter, self.within(settings));
            let mut hear = |at: &Progress| observer(at, None);
            return Ok(both(problem, name, (u, p), settings, watches, &mut hear)?);
        }
        let Origin::Switch { branch, event, direction, forward } = self.origin(task) else {
            let (u, p) = &self.start;
            if settings.target.is_none() && settings.domain.is_some() {
                let name = &self.parameter;
                let mut hear = |at: &Progress| observer(at, None);
                return Ok(both(problem, name, (u, p), settings, watches, &mut hear)?);
            }
            let tracer = Tracer::of(problem, &self.parameter, u, p, settings)?.watching(watches)?;
            return Ok(follow(problem, tracer, part, &self.joints, observer));
        };
        let settings = self.within(settings);
        let from = &self.branches[branch].branch;
        let event = &from.events[event];
        let leaving = |crossing: &crate::branch::Crossing| {
            let direction = &crossing.leaving[direction];
            Tracer::off(problem, from, event, direction, forward, settings)?.watching(watches)
        };
        let foreign = TraceError::Foreign { what: "the event is no branch point" };
        Ok(match event.crossing().ok_or(foreign).and_then(leaving) {
            Ok(tracer) => follow(problem, tracer, part, &self.joints, observer),
            // a branch that cannot be begun is reported as one of a single point
            Err(error) => {
                let mut point = from.points[event.point].clone();
                (point.s, point.event) = (0.0, None);
                let detail = error.to_string();
                Branch {
                    parameter: from.parameter.clone(),
                    parameters: from.parameters.clone(),
                    observables: from.observables.clone(),
                    points: vec![point],
                    events: Vec::new(),
                    doubts: Vec::new(),
                    stopped: Stop { reason: StopReason::StepTooSmall, detail },
                    began: None,
                    statistics: Statistics::default(),
                }
            }
        })
    }

    /// Settings of a branch other than the first.
    fn within(&self, settings: Settings) -> Settings {
        Settings { target: None, increasing: None, domain: self.domain, ..settings }
    }

    /// Takes account of a traced branch.
    fn add(&mut self, task: Task, branch: Branch, near: Vec<NearBifurcation>) {
        let id = self.branches.len();
        let origin = self.origin(&task);
        let depth = match task {
            Task::Start => {
                let (lo, hi) = self.settings.trace.domain.unwrap_or_else(|| hull(&branch));
                self.domain = Some((lo, hi)).filter(|(lo, hi)| lo < hi);
                let width = if (hi - lo).is_finite() { hi - lo } else { hull_width(&branch) };
                self.joints = Joints::new(if width > 0.0 { width } else { 1.0 });
                0
            }
            Task::Ray { node, ray, depth } => {
                let closed = branch.stopped.reason == StopReason::ClosedLoop;
                self.joints.begin(self.problem, id, (node, ray), closed);
                depth
            }
            Task::Off { branch: beside, near, .. } => {
                let same = |origin: &Origin| {
                    matches!(origin, Origin::Deflation { branch: b, near: n, .. }
                        if (*b, *n) == (beside, near))
                };
                let others = self.branches.iter().filter(|one| same(&one.origin)).count();
                if branch.points.len() < 3 || others >= MANY {
                    self.searched = (beside, near + 1);
                }
                self.branches[beside].depth + 1
            }
        };
        for (k, event) in branch.events.iter().enumerate() {
            let Some(crossing) = event.crossing() else { continue };
            if event.kind != EventKind::BranchPoint {
                continue;
            }
            let last = event.point + 1 == branch.points.len();
            let ends = last && branch.stopped.reason == StopReason::Retraced;
            let node = self.joints.pass(self.problem, id, &branch, k, crossing, ends);
            if depth < self.settings.depth {
                self.enqueue(node, depth + 1);
            }
        }
        self.branches.push(DiagramBranch { id, origin, depth, branch, near });
    }

    fn enqueue(&mut self, node: usize, depth: usize) {
        for ray in 0..self.joints.nodes[node].rays.len() {
            let out = self.domain.is_some_and(|domain| self.joints.leads_out(node, ray, domain));
            let one = &mut self.joints.nodes[node].rays[ray];
            if !one.taken && !one.waits && !out && one.leaving.is_some() {
                one.waits = true;
                self.queue.push_back(Task::Ray { node, ray, depth });
            }
        }
    }
}

/// The interval of the parameter that a branch covers.
fn hull(branch: &Branch) -> (f64, f64) {
    let values = branch.points.iter().map(|point| point.p);
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

fn hull_width(branch: &Branch) -> f64 {
    let (lo, hi) = hull(branch);
    hi - lo
}
