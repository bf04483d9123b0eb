//! One trace at a time. While something is moved, a coarse one that looks at axisymmetric modes only; then one
//! with the case's own elements; at rest, the case itself, whose look at all modes takes longest.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use study::case::{
    CatalogueEntry, Device, LoadError, LoadedCase, Override, ProblemCase, ResolvedCase,
    StabilityCase, load_text,
};
use study::record::{Outline, State, TraceResult};
use study::run::{
    Observer, RunError, contact_branch, contact_result, run_trace, run_trace_reported,
};

/// Elements while something is moved, if the case has more.
const COARSE: usize = 100;
/// The same where a branch with so many takes too long to be drawn fifteen times a second.
const COARSEST: usize = 60;
/// Too long, and short enough to go back to more.
const SLOW: Duration = Duration::from_millis(45);
const QUICK: Duration = Duration::from_millis(15);
/// The longest a coarse trace may take: what it has until then is shown.
const LONGEST: Duration = Duration::from_secs(1);
/// Samples along the meridian of the one state that is shown while something is moved.
const SAMPLES: usize = 401;
/// Points that are left of them.
const OUTLINE: usize = 160;

/// The word for where a value was given, in messages.
const GIVEN: &str = "page";

/// How exactly a branch is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Quality {
    /// While something is moved; with the state that far along the branch.
    Moving {
        /// Sum of the changes of the parameter up to there.
        along: f64,
    },
    /// With the case's own elements, and with the same state; no look at other modes yet.
    Settling {
        /// As above.
        along: f64,
    },
    /// As the case says.
    Rest,
}

/// A traced branch.
#[derive(Debug, Clone)]
pub(crate) struct Traced {
    /// The case that was traced.
    pub(crate) case: ResolvedCase,
    /// Remarks for people.
    pub(crate) notes: Vec<String>,
    /// What came out.
    pub(crate) result: TraceResult,
    /// Whether it ended for lack of time.
    pub(crate) cut: bool,
    /// From the request to the branch.
    pub(crate) took: Duration,
}

/// Why there is no branch.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Refused {
    /// Something is wrong with the case.
    #[error(transparent)]
    Case(#[from] LoadError),
    /// It has no branch.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// What comes of a request.
pub(crate) type Outcome = Result<Option<Arc<Traced>>, Refused>;

/// The case as it was given, and what is being traced.
#[derive(Debug)]
pub(crate) struct Bench {
    word: String,
    case: ResolvedCase,
    text: String,
    catalogue: Vec<CatalogueEntry>,
    working: Mutex<()>,
    /// Elements while something is moved.
    coarse: AtomicUsize,
    /// Requests that came while something is moved, and wait.
    waiting: AtomicUsize,
    /// The last branch at rest, with the values that it was asked for by.
    last: Mutex<Option<(Vec<String>, Arc<Traced>)>>,
    stop: Arc<AtomicBool>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // what is behind the lock is whole after every statement
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Bench {
    /// For a case that people call `word`.
    pub(crate) fn new(
        word: String,
        case: ResolvedCase,
        catalogue: Vec<CatalogueEntry>,
        stop: Arc<AtomicBool>,
    ) -> Bench {
        Bench {
            word,
            text: case.to_toml(),
            case,
            catalogue,
            working: Mutex::new(()),
            coarse: AtomicUsize::new(COARSE),
            waiting: AtomicUsize::new(0),
            last: Mutex::new(None),
            stop,
        }
    }

    /// The case as it was given.
    pub(crate) fn case(&self) -> &ResolvedCase {
        &self.case
    }

    /// The problems of the catalogue.
    pub(crate) fn catalogue(&self) -> &[CatalogueEntry] {
        &self.catalogue
    }

    /// The case with values replaced, checked.
    pub(crate) fn load(&self, set: &[String]) -> Result<LoadedCase, LoadError> {
        let overrides: Vec<Override> =
            set.iter().map(|text| Override::given_by(GIVEN, text)).collect();
        load_text(&self.word, &self.case.name, &self.text, &overrides, &self.catalogue)
    }

    /// Traces the case with values replaced; `None` if a request that cannot wait ended it.
    pub(crate) fn trace(&self, set: &[String], quality: Quality) -> Outcome {
        let clock = Instant::now();
        match quality {
            Quality::Moving { along } => {
                self.waiting.fetch_add(1, Ordering::SeqCst);
                let _turn = locked(&self.working);
                self.waiting.fetch_sub(1, Ordering::SeqCst);
                self.plain(set, along, true, clock)
            }
            Quality::Settling { along } => {
                let _turn = locked(&self.working);
                self.plain(set, along, false, clock)
            }
            Quality::Rest => {
                let _turn = locked(&self.working);
                self.rest(set, clock)
            }
        }
    }

    /// Whether somebody moves something, or the program ends.
    fn is_awaited(&self) -> bool {
        self.waiting.load(Ordering::SeqCst) > 0 || self.stop.load(Ordering::Relaxed)
    }

    /// Without a look at modes that break symmetries, and with one state.
    fn plain(&self, set: &[String], along: f64, coarse: bool, clock: Instant) -> Outcome {
        let LoadedCase { mut case, notes, .. } = self.load(set)?;
        case.stability = StabilityCase::Axisymmetric;
        if coarse {
            coarsen(&mut case, self.coarse.load(Ordering::Relaxed));
        }
        let begun = Instant::now();
        let (mut cut, mut ended) = (false, false);
        let observer: &mut Observer<'_> = &mut |_| {
            cut = coarse && clock.elapsed() > LONGEST;
            ended = !coarse && self.is_awaited();
            if cut || ended || self.stop.load(Ordering::Relaxed) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let result = match &case.problem {
            ProblemCase::Contact(contact) if contact.device == Device::Grip => {
                let (problem, traced) = contact_branch(&case, contact, observer)?;
                let mut result = contact_result(&case, &traced, begun.elapsed().as_secs_f64());
                let points = &traced.branch.points;
                let at = nearest(points.iter().map(|point| point.p), along);
                if let Some(point) = points.get(at) {
                    let parameters = problem.parameters_at(point.p);
                    if let Ok(profile) = problem.profile(&point.u, &parameters, SAMPLES) {
                        let (sigma, z) = (profile.sigma, profile.z);
                        let outline = Outline { sigma, z, pressure: profile.disjoining_pressure };
                        let outline = outline.thinned(OUTLINE);
                        result.pictures.states =
                            vec![State { point: at, plate: point.p, plate_below: None, outline }];
                    }
                }
                result
            }
            _ => run_trace(&case, observer)?,
        };
        if ended {
            return Ok(None);
        }
        if coarse && begun.elapsed() > SLOW {
            self.coarse.store(COARSEST, Ordering::Relaxed);
        } else if coarse && begun.elapsed() < QUICK {
            self.coarse.store(COARSE, Ordering::Relaxed);
        }
        let took = clock.elapsed();
        Ok(Some(Arc::new(Traced { case, notes, result, cut, took })))
    }

    fn rest(&self, set: &[String], clock: Instant) -> Outcome {
        if let Some((own, traced)) = locked(&self.last).as_ref()
            && own == set
        {
            return Ok(Some(Arc::clone(traced)));
        }
        let LoadedCase { case, notes, .. } = self.load(set)?;
        let mut ended = false;
        let observer: &mut Observer<'_> = &mut |_| {
            ended = self.is_awaited();
            if ended { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let result = run_trace_reported(&case, observer)?;
        if ended {
            return Ok(None);
        }
        let took = clock.elapsed();
        let traced = Arc::new(Traced { case, notes, result, cut: false, took });
        *locked(&self.last) = Some((set.to_vec(), Arc::clone(&traced)));
        Ok(Some(traced))
    }
}

/// The point that far along a branch.
fn nearest(parameters: impl Iterator<Item = f64>, along: f64) -> usize {
    let (mut so_far, mut before, mut best) = (0.0, None, (f64::INFINITY, 0));
    for (at, parameter) in parameters.enumerate() {
        so_far += (parameter - before.unwrap_or(parameter)).abs();
        before = Some(parameter);
        if (so_far - along).abs() < best.0 {
            best = ((so_far - along).abs(), at);
        }
    }
    best.1
}

/// Whether there is something to see between what moves and what rests.
pub(crate) fn settles(case: &ResolvedCase) -> bool {
    let elements = case.problem.mesh().map_or(0, |mesh| mesh.elements);
    case.problem.has_modes() && elements > COARSE && case.stability != StabilityCase::Axisymmetric
}

/// Fewer elements.
fn coarsen(case: &mut ResolvedCase, most: usize) {
    case.path.eigenvalues = 0;
    // that of a problem of the catalogue is part of it
    if let Some(mesh) = case.problem.mesh_mut() {
        mesh.elements = mesh.elements.min(most);
        mesh.tolerance = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use study::case::{catalogue, load};

    fn bench(case: &str, overrides: &[&str]) -> Bench {
        let catalogue = catalogue();
        let overrides: Vec<Override> = overrides.iter().copied().map(Override::new).collect();
        let case = load(case.as_ref(), &overrides, &catalogue).unwrap().case;
        Bench::new("it".to_owned(), case, catalogue, Arc::default())
    }

    fn set(texts: &[&str]) -> Vec<String> {
        texts.iter().map(ToString::to_string).collect()
    }

    fn elements(case: &ResolvedCase) -> usize {
        let ProblemCase::Contact(contact) = &case.problem else { return 0 };
        contact.mesh.elements
    }

    #[test]
    fn what_moves_is_coarse_and_what_rests_is_the_case() {
        let bench = bench("fig12", &["mesh.elements=120", "path.end=0.95"]);
        let adhesion = set(&["dimensionless.adhesion=3e-3"]);
        let moving = bench.trace(&adhesion, Quality::Moving { along: 0.1 }).unwrap().unwrap();
        let record = moving.result.stability.unwrap();
        assert!(!record.full, "nothing but axisymmetric modes was looked at");
        assert!(!moving.result.table.columns().contains(&"stable".to_owned()));
        let [state] = moving.result.pictures.states.as_slice() else { panic!("one state") };
        assert!((state.plate - 1.05).abs() < 0.01, "{}", state.plate);
        let settling = bench.trace(&adhesion, Quality::Settling { along: 0.1 }).unwrap().unwrap();
        assert!(!settling.result.stability.unwrap().full);
        assert_eq!(settling.result.pictures.states.len(), 1);
        assert_eq!([&moving, &settling].map(|one| elements(&one.case)), [100, 120]);
        assert!(settles(bench.case()));
        let rest = bench.trace(&adhesion, Quality::Rest).unwrap().unwrap();
        assert!(rest.result.stability.unwrap().full);
        assert_eq!(rest.result.pictures.states.len(), rest.result.points);
        let alone = load(
            "fig12".as_ref(),
            &["mesh.elements=120", "path.end=0.95", "dimensionless.adhesion=3e-3"]
                .map(Override::new),
            &[],
        );
        let alone = run_trace(&alone.unwrap().case, &mut |_| ControlFlow::Continue(())).unwrap();
        let csv = |result: &TraceResult| study::record::branch_csv(&result.table).unwrap();
        assert!(csv(&rest.result) == csv(&alone), "as the program traces it");
    }

    #[test]
    fn what_is_wrong_with_a_value_is_said_in_the_program_s_words() {
        let bench = bench("fig12", &[]);
        let error = bench.trace(&set(&["dimensionless.film=-1"]), Quality::Rest).unwrap_err();
        assert_eq!(
            error.to_string(),
            "it, page: dimensionless.film = -1: must be positive and finite"
        );
    }

    #[test]
    fn a_moving_request_ends_one_at_rest() {
        let bench = bench("fig12", &["mesh.elements=2000"]);
        let rest = std::thread::scope(|scope| {
            let rest = scope.spawn(|| bench.trace(&[], Quality::Rest));
            // until it works
            while bench.working.try_lock().is_ok() {
                std::thread::yield_now();
            }
            let moving = bench.trace(&[], Quality::Moving { along: 0.0 }).unwrap();
            assert!(moving.is_some());
            rest.join().unwrap()
        });
        assert!(rest.unwrap().is_none());
    }

    #[test]
    fn along_a_branch_that_turns_back_is_further_than_its_end() {
        let way = [1.0, 0.8, 0.9, 0.7];
        assert_eq!(
            [0.0, 0.21, 0.29, 9.0].map(|along| nearest(way.into_iter(), along)),
            [0, 1, 2, 3]
        );
        assert_eq!(nearest(std::iter::empty(), 0.0), 0);
    }
}
