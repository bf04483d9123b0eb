//! `arclen fit`: from measured curves to the shell's properties.

use super::Done;
use super::progress::FitWatch;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::{FitArguments, SegmentsWanted, set};
use crate::exit::Exit;
use crate::terminal;
use identify::data::Direction;
use identify::{Attended, LawName, Profiles};
use pictures::results::{self, FITS_NAMES};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use study::case::{Override, PictureCase, catalogue, load};
use study::fit::files::summary;
use study::fit::lab::{self, Lab, Wishes};
use study::fit::plan::{PLAN, planned};
use study::fit::{Failure, Fault, Laws, Outcome, Source, fit_file, profiles, sources};

/// Fit the curves.
pub(super) fn fit(arguments: &FitArguments, listen: &Listen<'_>) -> Done {
    let (lab, laws, profiles) = prepare(arguments).map_err(|message| super::refuse(&message))?;
    let wishes = wishes(arguments);
    if let Some(case) = &arguments.plan {
        return plan(arguments, case, &lab, wishes);
    }
    let look = super::look(&arguments.output)?;
    let sources = sources(&arguments.curves, &lab);
    let task = Task { arguments, lab: &lab, laws, wishes, profiles: &profiles, look: &look };
    match sources.as_slice() {
        [one] => single(&task, one, listen),
        several => batch(&task, several, listen),
    }
}

/// What every curve is fitted with.
struct Task<'a> {
    arguments: &'a FitArguments,
    lab: &'a Lab,
    laws: Laws,
    wishes: Wishes<'a>,
    profiles: &'a Profiles,
    look: &'a PictureCase,
}

impl Task<'_> {
    fn fit(&self, source: &Source, attended: Attended<'_>) -> Result<Outcome, Failure> {
        fit_file(source, self.lab, self.laws, self.wishes, self.profiles, attended)
    }
}

/// What a measurement of a case would identify.
fn plan(arguments: &FitArguments, case: &PathBuf, lab: &Lab, wishes: Wishes<'_>) -> Done {
    let loaded = load(case, &[], &catalogue()).map_err(|error| super::refuse(&error.advised()))?;
    let inputs: Vec<PathBuf> = std::iter::once(case).chain(&arguments.known).cloned().collect();
    let folder = arguments.output.folder(&loaded.case.name, &[PLAN], &inputs)?;
    let plan =
        planned(&loaded.case, lab, wishes).map_err(|error| super::refuse(&error.advised()))?;
    let words = |_: Option<&Path>| plan.summary();
    arguments.output.deliver(folder.as_ref(), results::plan(&plan), &inputs, words, true)
}

fn wishes(arguments: &FitArguments) -> Wishes<'_> {
    Wishes {
        fix: &arguments.fix,
        free: &arguments.free,
        prior: &arguments.prior,
        only: match arguments.segments {
            SegmentsWanted::Both => None,
            SegmentsWanted::Approach => Some(Direction::Approach),
            SegmentsWanted::Retract => Some(Direction::Retract),
        },
        range: arguments.range.as_deref(),
        robust: arguments.robust,
    }
}

fn prepare(arguments: &FitArguments) -> Result<(Lab, Laws, Profiles), String> {
    let overrides: Vec<Override> = set(&arguments.set).collect();
    let lab = lab::load(arguments.known.as_deref(), "--known", &overrides)
        .map_err(|error| error.advised())?;
    let laws = match arguments.law.as_deref() {
        None => Laws::Known,
        Some("all") => Laws::All,
        Some(name) => match LawName::of(name) {
            Some(law) => Laws::One(law),
            None => {
                let known = LawName::ALL.map(LawName::name).join(", ");
                return Err(format!("--law {name}: must be one of {known}, all"));
            }
        },
    };
    let profiles = profiles(arguments.profile.as_deref()).map_err(|error| error.advised())?;
    Ok((lab, laws, profiles))
}

fn inputs(arguments: &FitArguments) -> Vec<PathBuf> {
    arguments.curves.iter().chain(&arguments.known).cloned().collect()
}

fn single(task: &Task<'_>, source: &Source, listen: &Listen<'_>) -> Done {
    let FitArguments { output, report, .. } = task.arguments;
    let inputs = inputs(task.arguments);
    let folder = output.folder(&source.stem(), &results::fit_names(), &inputs)?;
    let watch = FitWatch::new(1, output.quiet, listen);
    let listener = |progress| watch.update(progress);
    let attended = Attended { stop: Some(watch.stop()), listener: Some(&listener) };
    let found = task.fit(source, attended);
    watch.finish();
    let outcome = match found {
        Ok(outcome) => outcome,
        Err(failure) if failure.fault() == Fault::Input => {
            return Err(super::refuse(&failure.advised()));
        }
        Err(failure) => {
            let message = failure.advised();
            terminal::error(&message);
            let made = results::no_fit(source, &message);
            return output.deliver(folder.as_ref(), made, &inputs, |_| String::new(), false);
        }
    };
    let made = results::fit(&outcome, task.look, output.wanted(folder.as_ref(), *report));
    let words = |written: Option<&Path>| {
        let place = written.map_or(String::new(), |p| format!("written to {}\n", p.display()));
        summary(&outcome) + &place
    };
    let complete = outcome.best.report.is_good();
    output.deliver(folder.as_ref(), made, &inputs, words, complete)
}

fn batch(task: &Task<'_>, sources: &[Source], listen: &Listen<'_>) -> Done {
    let FitArguments { output, report, jobs, .. } = task.arguments;
    let inputs = inputs(task.arguments);
    let folder = output.folder("fits", &FITS_NAMES, &inputs)?;
    let watch = FitWatch::new(sources.len(), output.quiet, listen);
    let attended = Attended { stop: Some(watch.stop()), listener: None };
    let one = |source: &Source| {
        let outcome = task.fit(source, attended);
        watch.done();
        outcome
    };
    let all = || sources.par_iter().map(one).collect::<Vec<_>>();
    let jobs = jobs.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| super::refuse(&format!("--jobs {jobs}: {error}")))?;
    let outcomes: Vec<Result<Outcome, Failure>> = pool.install(all);
    watch.finish();
    for failure in outcomes.iter().filter_map(|outcome| outcome.as_ref().err()) {
        if failure.fault() != Fault::Stopped {
            terminal::error(&failure.advised());
        }
    }
    if outcomes.iter().all(|o| o.as_ref().is_err_and(|f| f.fault() == Fault::Input)) {
        return Err(Exit::BadInput);
    }
    let outcomes: Vec<Result<Outcome, String>> =
        outcomes.into_iter().map(|outcome| outcome.map_err(|failure| failure.advised())).collect();
    let made =
        results::fits(sources, &outcomes, task.look, output.wanted(folder.as_ref(), *report));
    let good = |o: &Result<Outcome, String>| o.as_ref().is_ok_and(|o| o.best.report.is_good());
    let complete = outcomes.iter().all(good);
    let (fitted, total) = (outcomes.iter().filter(|o| o.is_ok()).count(), outcomes.len());
    let words = |written: Option<&Path>| {
        let place = written.map_or(String::new(), |p| format!(", written to {}", p.display()));
        format!("{fitted} of {total} curves fitted{place}\n")
    };
    output.deliver(folder.as_ref(), made, &inputs, words, complete)
}
