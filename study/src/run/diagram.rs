//! Whole diagrams, of every kind of problem.

use super::asymmetric;
use super::stability::Stability;
use super::two_plates::{BetweenPlates, WithPlates};
use crate::case::ResolvedCase;
use crate::record::view::{Curve, Mark};
use crate::record::{BranchOrigin, BranchRecord, DiagramResult, NearRecord, TraceResult};
use continuation::diagram::{
    Diagram, DiagramBranch, DiagramError, DiagramSettings, DiagramStop, Explorer, Origin, Search,
    Unfinished,
};
use continuation::{Branch, NearKind, Problem, Settings, StopReason};
use problems::{Setup, Visitor};
use shell_contact::force_watches;
use std::ops::ControlFlow;
use std::time::Instant;

/// How far a diagram has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagramProgress {
    /// Branches that are finished.
    pub branches: usize,
    /// Branches that are known to wait.
    pub waiting: usize,
    /// The branch that is traced at the moment.
    pub branch: super::Progress,
}

/// Told of every point; may stop the exploration.
pub type DiagramObserver<'o> = dyn FnMut(DiagramProgress) -> ControlFlow<()> + 'o;

/// What was computed of a diagram before.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Saved {
    /// The branches that are finished.
    pub finished: Vec<DiagramBranch>,
    /// The one that is not.
    pub unfinished: Option<Unfinished>,
    /// Time spent.
    pub seconds: f64,
}

/// Keeps what is computed, so that nothing is lost if the program is killed.
pub trait Keep {
    /// A branch is finished; `seconds` is the time spent so far.
    fn branch(&mut self, branch: &DiagramBranch, seconds: f64);
    /// Whether it is time to keep a branch that is not finished.
    fn is_due(&self) -> bool;
    /// The branch that is not finished, after so many that are.
    fn unfinished(&mut self, after: usize, branch: &Unfinished, seconds: f64);
}

/// Keeps nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct KeepNothing;

impl Keep for KeepNothing {
    fn branch(&mut self, _: &DiagramBranch, _: f64) {}

    fn is_due(&self) -> bool {
        false
    }

    fn unfinished(&mut self, _: usize, _: &Unfinished, _: f64) {}
}

/// A diagram that is about to be explored.
pub(super) struct Exploration<'e, 'o> {
    pub(super) settings: DiagramSettings,
    saved: Saved,
    keep: &'e mut dyn Keep,
    observer: &'e mut DiagramObserver<'o>,
    clock: Instant,
}

impl Exploration<'_, '_> {
    pub(super) fn run<P: Problem>(
        self,
        problem: &P,
        setup: &Setup,
    ) -> Result<(Diagram, f64), DiagramError> {
        let Exploration { settings, saved, keep, observer, clock } = self;
        let (name, u, p) = (&setup.parameter, &setup.u, &setup.p);
        let explorer = Explorer::new(problem, name, u, p, settings, &setup.watches)?;
        let mut explorer = explorer.resume(saved.finished, saved.unfinished)?;
        let seconds = || saved.seconds + clock.elapsed().as_secs_f64();
        loop {
            let traced = explorer.next_branch(&mut |at| {
                let wish = observer(DiagramProgress {
                    branches: at.branches,
                    waiting: at.waiting,
                    branch: super::Progress {
                        points: at.at.points,
                        events: at.at.events,
                        parameter: at.at.p,
                    },
                });
                if (wish.is_break() || keep.is_due())
                    && let Some(unfinished) = at.unfinished()
                {
                    keep.unfinished(at.branches, &unfinished, seconds());
                }
                wish
            })?;
            match traced {
                Some(one) if interrupted(&one.branch) => {}
                Some(one) => keep.branch(one, seconds()),
                None => return Ok((explorer.finish(), seconds())),
            }
        }
    }
}

fn interrupted(branch: &Branch) -> bool {
    let mut ends = branch.began.iter().chain([&branch.stopped]);
    ends.any(|stop| stop.reason == StopReason::Interrupted)
}

impl Visitor for Exploration<'_, '_> {
    type Output = Result<(Diagram, f64), DiagramError>;

    fn visit<P: Problem>(mut self, problem: &P, setup: Setup) -> Self::Output {
        // as the entry says how its branch starts and ends, unless the case bounds it otherwise
        let domain = self.settings.trace.domain;
        let target = setup.settings.target.filter(|_| domain.is_none());
        self.settings.trace = Settings { domain, target, ..setup.settings.clone() };
        self.run(problem, &setup)
    }
}

impl WithPlates for Exploration<'_, '_> {
    type Output = Result<(Diagram, f64), DiagramError>;

    fn with<P: BetweenPlates>(self, problem: &P, x: &[f64], p: &[f64]) -> Self::Output {
        let setup = Setup {
            parameter: problem.parameters()[0].name.clone(),
            u: x.to_vec(),
            p: p.to_vec(),
            settings: Settings::default(),
            watches: force_watches().to_vec(),
        };
        self.run(problem, &setup)
    }
}

/// How a diagram is computed.
pub(super) struct Work<'e> {
    /// What was computed of it before.
    saved: Saved,
    keep: &'e mut dyn Keep,
    /// Whether the states along the branches are wanted, for a report.
    pub(super) reported: bool,
    clock: Instant,
}

impl<'e> Work<'e> {
    /// Work that begins now.
    pub(super) fn new(saved: Saved, keep: &'e mut dyn Keep, reported: bool) -> Self {
        Work { saved, keep, reported, clock: Instant::now() }
    }

    /// The exploration of a case whose branches are traced with these settings.
    pub(super) fn explore<'w, 'o>(
        self,
        case: &ResolvedCase,
        trace: Settings,
        observer: &'w mut DiagramObserver<'o>,
    ) -> Exploration<'w, 'o>
    where
        'e: 'w,
    {
        let within = case.diagram.within;
        let target = trace.target.filter(|_| within.is_none());
        let settings = DiagramSettings {
            trace: Settings { target, domain: within, ..trace },
            depth: case.diagram.depth,
            max_branches: case.diagram.max_branches,
            search: case.diagram.search.then(Search::default),
        };
        let Work { saved, keep, clock, .. } = self;
        Exploration { settings, saved, keep, observer, clock }
    }
}

/// An observable over the parameter.
pub(super) fn curve(branch: &Branch, observable: &str) -> Curve {
    let k = branch.observables.iter().position(|name| name == observable);
    let value = |at: usize| k.map_or(f64::NAN, |k| branch.points[at].observables[k]);
    let points = &branch.points;
    Curve {
        label: observable.to_owned(),
        x: points.iter().map(|point| point.p).collect(),
        y: (0..points.len()).map(value).collect(),
        unstable: points.iter().map(|point| point.unstable.is_some_and(|n| n > 0)).collect(),
        marks: branch
            .events
            .iter()
            .map(|event| Mark { kind: event.kind.to_string(), x: event.p, y: value(event.point) })
            .collect(),
        ..Curve::default()
    }
}

/// A branch as plain numbers.
pub(super) struct Presented {
    pub(super) trace: TraceResult,
    pub(super) curve: Curve,
    /// Knows the new numbers of special points, if there are more of them now.
    pub(super) stability: Stability,
}

/// A diagram as plain numbers.
pub(super) fn result(
    case: &ResolvedCase,
    diagram: Diagram,
    seconds: f64,
    (x, y): (&str, &str),
    present: &mut dyn FnMut(Branch) -> Presented,
) -> DiagramResult {
    let statistics = diagram.statistics();
    let (stopped_because, stopped_detail) = ending(&diagram);
    let parameter =
        diagram.branches.first().map(|one| one.branch.parameter.clone()).unwrap_or_default();
    let mut scans = Vec::new();
    let branches = diagram.branches.into_iter().map(|one| {
        let began = one.branch.began.as_ref().map(|stop| stop.reason);
        let near = one.near.iter().map(|near| {
            let kind = match near.kind {
                NearKind::BranchPoint => "branch-point",
                _ => "folds",
            };
            NearRecord { kind, parameter: near.p, gap: near.gap }
        });
        let near = near.collect();
        let Presented { trace, curve, stability } = present(one.branch);
        scans.push((one.id, stability));
        let from = match one.origin {
            Origin::Switch { branch, event, .. } => BranchOrigin::Switch { branch, event },
            Origin::Deflation { branch, parameter, .. } => {
                BranchOrigin::Deflation { branch, parameter }
            }
            _ => BranchOrigin::Start,
        };
        BranchRecord {
            id: one.id,
            from,
            depth: one.depth,
            symmetry: None,
            began_because: began,
            near,
            trace,
            curve,
            orbits: None,
        }
    });
    let mut branches: Vec<BranchRecord> = branches.collect();
    let renumbered = |branch: usize, event: usize| {
        let scan = scans.iter().find(|(id, _)| *id == branch);
        scan.map_or(event, |(_, stability)| stability.renumbered(event))
    };
    for one in &mut branches {
        if let BranchOrigin::Switch { branch, event } = &mut one.from {
            *event = renumbered(*branch, *event);
        }
    }
    let mut joints = diagram.joints;
    for (branch, event) in joints.iter_mut().flat_map(|joint| &mut joint.passed) {
        *event = renumbered(*branch, *event);
    }
    DiagramResult {
        case: case.name.clone(),
        parameter,
        branches,
        joints,
        followed: stopped_because == "complete",
        stopped_because,
        stopped_detail,
        newton_iterations: statistics.newton_iterations,
        seconds,
        axes: (x.to_owned(), y.to_owned()),
        cycles: None,
    }
}

/// What `scan = "axisymmetric"` leaves out.
pub(super) const NOT_EXAMINED: &str = "; modes without the symmetries of a branch were not examined, and no branch \
                            without mirror symmetry was followed";

/// Adds the branches without mirror symmetry, and says what is known and not followed: `waves` special
/// points lead to states that are not axisymmetric.
pub(super) fn with_asymmetric(
    diagram: &mut DiagramResult,
    found: asymmetric::Asymmetric,
    waves: usize,
) {
    let waves = waves + found.waves;
    let points = |n: usize| if n == 1 { "one point".to_owned() } else { format!("{n} points") };
    let mut detail = String::new();
    if found.left_out > 0 {
        detail += &format!(
            "; at {} where mirror symmetry is lost no branch was followed",
            points(found.left_out)
        );
    }
    if found.further > 0 {
        detail += &format!(
            "; what leaves branches without mirror symmetry at {} is not followed",
            points(found.further)
        );
    }
    match found.unfinished {
        0 => {}
        1 => detail += "; one branch without mirror symmetry ended early; see its own",
        n => detail += &format!("; {n} branches without mirror symmetry ended early; see theirs"),
    }
    if found.full {
        detail += "; the limit of branches was reached";
    }
    diagram.followed &= detail.is_empty() && !found.interrupted;
    if waves > 0 {
        detail += &format!(
            "; states with waves around the axis, which leave at {}, are not followed",
            points(waves)
        );
    }
    diagram.stopped_detail += &detail;
    if found.interrupted {
        diagram.stopped_because = "interrupted";
        diagram.stopped_detail = "among the branches without mirror symmetry".to_owned();
    } else if !detail.is_empty() && diagram.stopped_because == "complete" {
        diagram.stopped_because = "incomplete";
    }
    diagram.newton_iterations += found.newton_iterations;
    diagram.branches.extend(found.branches);
    diagram.joints.extend(found.joints);
}

/// Why a diagram ended, in a word and a sentence.
fn ending(diagram: &Diagram) -> (&'static str, String) {
    let open: usize = diagram.joints.iter().map(|joint| joint.open).sum();
    match diagram.stopped {
        DiagramStop::MaxBranches => (
            "max-branches",
            format!("the limit of {} branches was reached", diagram.branches.len()),
        ),
        DiagramStop::Interrupted => ("interrupted", String::new()),
        _ => {
            let unfinished = diagram.branches.iter().filter(|one| !one.branch.is_complete());
            let count = unfinished.clone().count();
            let detail = match (count, open) {
                (0, 0) => "every branch was followed to its end".to_owned(),
                (0, 1) => "one half branch leaves the deepest ones: see diagram.depth".to_owned(),
                (0, _) => format!("{open} half branches leave the deepest ones: see diagram.depth"),
                (1, _) => "one branch ended early; see its own".to_owned(),
                _ => format!("{count} branches ended early; see theirs"),
            };
            let doubtful = |one: &&DiagramBranch| !one.branch.is_certain();
            let doubtful = diagram.branches.iter().filter(doubtful).count();
            let doubt = match doubtful {
                0 => String::new(),
                1 => "; the counts of unstable modes of one branch are not certain".to_owned(),
                _ => {
                    format!("; the counts of unstable modes of {doubtful} branches are not certain")
                }
            };
            let open: usize = diagram.branches.iter().map(DiagramBranch::unresolved).sum();
            let unresolved = match open {
                0 => String::new(),
                1 => "; at one branch point it is not known which branches leave".to_owned(),
                _ => format!("; at {open} branch points it is not known which branches leave"),
            };
            let word = if diagram.is_complete() { "complete" } else { "incomplete" };
            (word, detail + &doubt + &unresolved)
        }
    }
}
