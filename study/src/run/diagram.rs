//! Whole diagrams, of every kind of problem.

use super::stability::Stability;
use super::two_plates::{BetweenPlates, WithPlates};
use super::{RunError, asymmetric, contact, general, ring_load, states, two_plates};
use crate::case::{ProblemCase, ResolvedCase, StabilityCase};
use crate::record::view::{Curve, Mark};
use crate::record::{BranchRecord, DiagramResult, From, NearRecord, Symmetry, TraceResult};
use continuation::diagram::{
    Diagram, DiagramBranch, DiagramError, DiagramSettings, DiagramStop, Explorer, Origin, Search,
    Unfinished,
};
use continuation::{Branch, NearKind, Problem, Settings, StopReason};
use problems::{Setup, Visitor};
use shell_contact::{ContactBranch, force_watches};
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

struct Exploration<'e, 'o> {
    settings: DiagramSettings,
    saved: Saved,
    keep: &'e mut dyn Keep,
    observer: &'e mut DiagramObserver<'o>,
    clock: Instant,
}

impl Exploration<'_, '_> {
    fn run<P: Problem>(self, problem: &P, setup: &Setup) -> Result<(Diagram, f64), DiagramError> {
        let Exploration { settings, saved, keep, observer, clock } = self;
        let (name, u, p) = (setup.parameter, &setup.u, &setup.p);
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
            parameter: problem.parameters()[0].name,
            u: x.to_vec(),
            p: p.to_vec(),
            settings: Settings::default(),
            watches: force_watches().to_vec(),
        };
        self.run(problem, &setup)
    }
}

/// Explore the diagram of a case, from what was kept of it; `reported` also takes the states along
/// the branches, for a report.
///
/// # Errors
/// When there is no result at all, or what was kept is of another diagram.
pub fn run_diagram(
    case: &ResolvedCase,
    reported: bool,
    saved: Saved,
    keep: &mut dyn Keep,
    observer: &mut DiagramObserver<'_>,
) -> Result<DiagramResult, RunError> {
    let clock = Instant::now();
    let explore = |trace: Settings, keep, observer| {
        let within = case.diagram.within;
        let target = trace.target.filter(|_| within.is_none());
        let settings = DiagramSettings {
            trace: Settings { target, domain: within, ..trace },
            depth: case.diagram.depth,
            max_branches: case.diagram.max_branches,
            search: case.diagram.search.then(Search::default),
        };
        Exploration { settings, saved, keep, observer, clock }
    };
    match &case.problem {
        ProblemCase::Contact(contact) => {
            let problem = contact::problem(case, contact)?;
            let start = case.path.start;
            let setup = Setup {
                parameter: "z0",
                u: problem.initial_state(),
                p: problem.parameters_at(start).to_vec(),
                settings: Settings::default(),
                watches: force_watches().to_vec(),
            };
            let explored = explore(contact::path(case), keep, &mut *observer).run(&problem, &setup);
            let (diagram, seconds) = explored.map_err(|error| match error {
                DiagramError::Trace(detail) => contact::no_start(case, detail),
                error => RunError::Diagram { case: case.name.clone(), error },
            })?;
            let scanning = Instant::now();
            let mut zero = None;
            let points = diagram.branches.iter().map(|one| one.branch.points.len()).sum();
            let mut waiting = diagram.branches.len();
            let done = diagram.branches.len();
            let depths: Vec<usize> = diagram.branches.iter().map(|one| one.depth).collect();
            let mut symmetric = asymmetric::Symmetric::default();
            let mut waves = 0;
            let axes = ("plate distance z₀/R₀", "force F/√(χ k_b)");
            let mut explored = result(case, diagram, seconds, axes, &mut |branch| {
                let mut traced = ContactBranch::new(branch, zero);
                zero = traced.zero_force;
                waiting -= 1;
                let scan = &mut |branch| {
                    observer(DiagramProgress { branches: done - waiting, waiting, branch })
                };
                let stability = Stability::of(case, &problem, &mut traced, scan);
                let id = done - 1 - waiting;
                let forks = stability.forks(&traced.branch);
                symmetric.add(id, depths[id], &traced.branch, &forks);
                waves += stability.waves();
                let (mut trace, curve) = contact::on_diagram(case, &problem, &traced, &stability);
                if reported {
                    trace.pictures.states = states::of_contact(&problem, &traced.branch, points);
                }
                Presented { trace, curve, stability }
            });
            if !explored.branches.is_empty() && explored.stopped_because != "interrupted" {
                for one in &mut explored.branches {
                    one.symmetry = Some(Symmetry::Mirror);
                }
                match case.stability {
                    StabilityCase::Full { .. } => {
                        let found = asymmetric::follow(case, contact, zero, symmetric, observer)?;
                        with_asymmetric(&mut explored, found, waves);
                    }
                    StabilityCase::Axisymmetric => {
                        explored.stopped_detail += NOT_EXAMINED;
                    }
                }
            }
            let seconds = explored.seconds + scanning.elapsed().as_secs_f64();
            Ok(DiagramResult { seconds, ..explored })
        }
        ProblemCase::TwoPlates(plates) => {
            let name = plates.parameter();
            let exploration = explore(two_plates::settings(case, name), keep, &mut *observer);
            let explored = two_plates::visit(case, plates, exploration)?;
            let (diagram, seconds) = explored.map_err(|error| match error {
                DiagramError::Trace(detail) => contact::no_start(case, detail),
                error => RunError::Diagram { case: case.name.clone(), error },
            })?;
            let scanning = Instant::now();
            let mut explored = two_plates::visit(
                case,
                plates,
                OfTwoPlates { case, diagram, seconds, name, observer },
            )?;
            explored.seconds += scanning.elapsed().as_secs_f64();
            Ok(explored)
        }
        ProblemCase::RingLoad(ring) => {
            let ring_load::Start { problem, u, p } = ring_load::start(case, ring)?;
            let setup = Setup {
                parameter: "alpha",
                u,
                p,
                settings: Settings::default(),
                watches: ring_load::watches(),
            };
            let mut in_degrees = |at: DiagramProgress| {
                let parameter = at.branch.parameter.to_degrees();
                observer(DiagramProgress {
                    branch: super::Progress { parameter, ..at.branch },
                    ..at
                })
            };
            let mut exploration = explore(ring_load::path(&case.path), keep, &mut in_degrees);
            let domain = &mut exploration.settings.trace.domain;
            *domain = domain.map(|(low, high)| (low.to_radians(), high.to_radians()));
            let explored = exploration.run(&problem, &setup);
            let (diagram, seconds) = explored.map_err(|error| match error {
                DiagramError::Trace(detail) => ring_load::no_start(case, detail),
                error => RunError::Diagram { case: case.name.clone(), error },
            })?;
            let diagram = ring_load::diagram_in_degrees(diagram);
            let points = diagram.branches.iter().map(|one| one.branch.points.len()).sum();
            Ok(result(case, diagram, seconds, ring_load::AXES, &mut |branch| {
                let curve = ring_load::curve(&branch);
                let mut result = ring_load::result(case, &branch, 0.0);
                if reported {
                    result.pictures.states = states::of_ring_load(&problem, &branch, points);
                }
                Presented { trace: result, curve, stability: Stability::default() }
            }))
        }
        ProblemCase::Catalogue(problem) => {
            let (entry, request) = general::request(case, problem)?;
            let explored = entry
                .visit(&request, explore(request.settings.clone(), keep, observer))
                .map_err(|error| general::refused(case, error))?;
            let (diagram, seconds) = explored.map_err(|error| match error {
                DiagramError::Trace(detail) => general::no_start(case, detail),
                error => RunError::Diagram { case: case.name.clone(), error },
            })?;
            let shown = diagram.branches.first().and_then(|one| one.branch.observables.first());
            let shown = shown.cloned().unwrap_or_default();
            let axes = (entry.parameter, &shown[..]);
            Ok(result(case, diagram, seconds, axes, &mut |branch| {
                let curve = curve(&branch, &shown);
                let trace = general::result(case, &branch, 0.0);
                Presented { trace, curve, stability: Stability::default() }
            }))
        }
    }
}

/// The branches of a diagram between two plates, as plain numbers with their modes.
struct OfTwoPlates<'o, 'c> {
    case: &'c ResolvedCase,
    diagram: Diagram,
    seconds: f64,
    name: &'static str,
    observer: &'o mut DiagramObserver<'c>,
}

impl WithPlates for OfTwoPlates<'_, '_> {
    type Output = DiagramResult;

    fn with<P: BetweenPlates>(self, problem: &P, _: &[f64], _: &[f64]) -> DiagramResult {
        let OfTwoPlates { case, diagram, seconds, name, observer } = self;
        let x = if name == "z0" { "half the plate distance z₀/R₀" } else { name };
        let (mut zero, mut waves, mut done) = (None, 0, 0);
        let mut waiting = diagram.branches.len();
        let axes = (x, "force F/√(χ k_b)");
        let mut explored = result(case, diagram, seconds, axes, &mut |branch| {
            let mut traced = ContactBranch::new(branch, zero);
            zero = traced.zero_force;
            (done, waiting) = (done + 1, waiting - 1);
            let stability = Stability::of_whole(case, problem, &mut traced, &mut |branch| {
                observer(DiagramProgress { branches: done, waiting, branch })
            });
            waves += stability.waves() + stability.missed();
            let (trace, curve) = two_plates::on_diagram(case, &traced, &stability);
            Presented { trace, curve, stability }
        });
        with_asymmetric(&mut explored, asymmetric::Asymmetric::default(), waves);
        explored
    }
}

/// An observable over the parameter.
fn curve(branch: &Branch, observable: &str) -> Curve {
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
struct Presented {
    trace: TraceResult,
    curve: Curve,
    /// Knows the new numbers of special points, if there are more of them now.
    stability: Stability,
}

/// A diagram as plain numbers.
fn result(
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
            Origin::Switch { branch, event, .. } => From::Switch { branch, event },
            Origin::Deflation { branch, parameter, .. } => From::Deflation { branch, parameter },
            _ => From::Start,
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
        }
    });
    let mut branches: Vec<BranchRecord> = branches.collect();
    let renumbered = |branch: usize, event: usize| {
        let scan = scans.iter().find(|(id, _)| *id == branch);
        scan.map_or(event, |(_, stability)| stability.renumbered(event))
    };
    for one in &mut branches {
        if let From::Switch { branch, event } = &mut one.from {
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
    }
}

/// What `scan = "axisymmetric"` leaves out.
const NOT_EXAMINED: &str = "; modes without the symmetries of a branch were not examined, and no branch \
                            without mirror symmetry was followed";

/// Adds the branches without mirror symmetry, and says what is known and not followed: `waves` special
/// points lead to states that are not axisymmetric.
fn with_asymmetric(diagram: &mut DiagramResult, found: asymmetric::Asymmetric, waves: usize) {
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
