//! `arclen fit`: from measured curves to the shell's properties.

use super::delivery::Made;
use super::progress::FitWatch;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::{FitArguments, SegmentsWanted, set};
use crate::exit::Exit;
use crate::terminal;
use identify::data::Direction;
use identify::{Attended, LawName, Profiles};
use pictures::REPORT;
use pictures::fit::{self as drawing, Drawn, draw_fit, fit_report};
use rayon::prelude::*;
use serde_json::json;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use study::case::{Override, PictureCase, catalogue, load, plain_name};
use study::fit::files::{self as tables, FIT, FitsRow, TABLES, fit_json, fits_csv, summary};
use study::fit::lab::{self, Lab, Wishes};
use study::fit::plan::{PLAN, planned};
use study::fit::{Failure, Laws, Outcome, Source, fit_file, profiles, sources};

const FITS: &str = "fits.csv";
const BATCH: &str = "fits.json";

/// Fit the curves.
pub(super) fn fit(arguments: &FitArguments, listen: &Listen<'_>) -> Exit {
    let prepared = prepare(arguments);
    let (lab, laws, profiles) = match prepared {
        Ok(prepared) => prepared,
        Err(message) => return refuse(&message),
    };
    let wishes = wishes(arguments);
    if let Some(case) = &arguments.plan {
        return plan(arguments, case, &lab, wishes);
    }
    let look = match super::look(&arguments.output) {
        Ok(look) => look,
        Err(exit) => return exit,
    };
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
fn plan(arguments: &FitArguments, case: &PathBuf, lab: &Lab, wishes: Wishes<'_>) -> Exit {
    let loaded = match load(case, &[], &catalogue()) {
        Ok(loaded) => loaded,
        Err(error) => return refuse(&error.advised()),
    };
    let inputs: Vec<PathBuf> = std::iter::once(case).chain(&arguments.known).cloned().collect();
    let folder = match arguments.output.folder(&loaded.case.name, &[PLAN], &inputs) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    match planned(&loaded.case, lab, wishes) {
        Err(message) => refuse(&message),
        Ok(plan) => {
            let made = Made::json(PLAN, plan.json());
            let words = |_: Option<&Path>| plan.summary();
            arguments.output.deliver(folder.as_ref(), made, &inputs, words, true)
        }
    }
}

fn refuse(message: &dyn std::fmt::Display) -> Exit {
    terminal::error(message);
    Exit::BadInput
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
    let lab = lab::load(arguments.known.as_deref(), &overrides).map_err(|error| error.advised())?;
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
    Ok((lab, laws, profiles(arguments.profile.as_deref())?))
}

fn inputs(arguments: &FitArguments) -> Vec<PathBuf> {
    arguments.curves.iter().chain(&arguments.known).cloned().collect()
}

/// All files but the JSON.
fn files(
    outcome: &Outcome,
    drawn: Drawn,
    look: &PictureCase,
) -> Result<Vec<(String, Vec<u8>)>, String> {
    let tables = tables::files(outcome).map_err(|error| error.to_string())?;
    let pictures = draw_fit(outcome, drawn, look).map_err(|error| error.to_string())?;
    Ok([tables, pictures].concat())
}

/// `usual`, unless no pictures are wanted.
fn drawn(arguments: &FitArguments, usual: Drawn) -> Drawn {
    if arguments.output.no_pictures { Drawn::Nothing } else { usual }
}

fn stem(source: &Source) -> String {
    let name = plain_name(&source.path.file_stem().unwrap_or_default().to_string_lossy());
    source.number.map_or(name.clone(), |number| format!("{name}-{number}"))
}

fn single(task: &Task<'_>, source: &Source, listen: &Listen<'_>) -> Exit {
    let arguments = task.arguments;
    let inputs = inputs(arguments);
    let names: Vec<&str> = [FIT, REPORT].into_iter().chain(TABLES).chain(drawing::NAMES).collect();
    let folder = match arguments.output.folder(&stem(source), &names, &inputs) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let watch = FitWatch::new(1, arguments.output.quiet, listen);
    let listener = |progress| watch.update(progress);
    let attended = Attended { stop: Some(watch.stop()), listener: Some(&listener) };
    let found = task.fit(source, attended);
    watch.finish();
    let outcome = match found {
        Ok(outcome) => outcome,
        Err(Failure::Input(message)) => return refuse(&message),
        Err(Failure::NotFound(message) | Failure::Stopped(message)) => {
            terminal::error(&message);
            let text = json!({ "curve": source.label(), "error": message });
            let made = Made::json::<serde_json::Error>(FIT, Ok(format!("{text:#}\n")));
            let words = |_: Option<&Path>| String::new();
            return arguments.output.deliver(folder.as_ref(), made, &inputs, words, false);
        }
    };
    let mut made = Made::json(FIT, fit_json(&outcome));
    if folder.is_some() {
        made.files(files(&outcome, drawn(arguments, Drawn::SvgAndPng), task.look));
        if arguments.report {
            made.attempt(REPORT, Ok::<_, String>(fit_report(&outcome, task.look)));
        }
    }
    let complete = outcome.best.report.is_good();
    arguments.output.deliver(
        folder.as_ref(),
        made,
        &inputs,
        |written| {
            let mut text = summary(&outcome);
            if let Some(path) = written {
                text.push_str(&format!("written to {}\n", path.display()));
            }
            text
        },
        complete,
    )
}

fn batch(task: &Task<'_>, sources: &[Source], listen: &Listen<'_>) -> Exit {
    let arguments = task.arguments;
    let inputs = inputs(arguments);
    let folder = match arguments.output.folder("fits", &[BATCH, FITS], &inputs) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let watch = FitWatch::new(sources.len(), arguments.output.quiet, listen);
    let attended = Attended { stop: Some(watch.stop()), listener: None };
    let one = |source: &Source| {
        let outcome = task.fit(source, attended);
        watch.done();
        outcome
    };
    let all = || sources.par_iter().map(one).collect::<Vec<_>>();
    let jobs = arguments.jobs.map_or(0, usize::from);
    let outcomes: Vec<Result<Outcome, Failure>> =
        match rayon::ThreadPoolBuilder::new().num_threads(jobs).build() {
            Ok(pool) => pool.install(all),
            Err(error) => return refuse(&format!("--jobs {jobs}: {error}")),
        };
    watch.finish();
    if outcomes.iter().all(|o| matches!(o, Err(Failure::Input(_)))) {
        for outcome in outcomes {
            if let Err(failure) = outcome {
                terminal::error(&failure.message());
            }
        }
        return Exit::BadInput;
    }
    let (mut rows, mut listed, mut contents) = (Vec::new(), Vec::new(), Vec::new());
    let mut names: BTreeSet<String> = BTreeSet::new();
    let mut complete = true;
    for (source, outcome) in sources.iter().zip(&outcomes) {
        let curve = source.label();
        match outcome {
            Ok(outcome) => {
                let name = unique(&mut names, stem(source));
                let report = &outcome.best.report;
                complete &= report.is_good();
                rows.push(FitsRow::of(report, &name));
                listed.push(json!({ "curve": curve, "folder": name, "good": report.is_good() }));
                let json = fit_json(outcome).map(|text| (FIT.to_owned(), text.into_bytes()));
                let own =
                    files(outcome, drawn(arguments, Drawn::Svg), task.look).map(|mut files| {
                        if arguments.report {
                            files.push((
                                REPORT.to_owned(),
                                fit_report(outcome, task.look).into_bytes(),
                            ));
                        }
                        files
                    });
                match (json, own) {
                    (Ok(json), Ok(own)) => contents.extend(
                        std::iter::once(json)
                            .chain(own)
                            .map(|(file, bytes)| (format!("{name}/{file}"), bytes)),
                    ),
                    (json, own) => {
                        let json = json.err().map(|e| e.to_string());
                        let own = own.err().map(|e| e.to_string());
                        terminal::error(&json.or(own).unwrap_or_default());
                    }
                }
            }
            Err(failure) => {
                complete = false;
                if !matches!(failure, Failure::Stopped(_)) {
                    terminal::error(&failure.message());
                }
                rows.push(FitsRow::failed(&curve, failure.message()));
                listed.push(json!({ "curve": curve, "error": failure.message() }));
            }
        }
    }
    let text = json!({ "fits": listed });
    let mut made = Made::json::<serde_json::Error>(BATCH, Ok(format!("{text:#}\n")));
    if folder.is_some() {
        made.attempt(FITS, fits_csv(&rows));
        for (name, bytes) in contents {
            made.file(name, bytes);
        }
    }
    let fitted = outcomes.iter().filter(|o| o.is_ok()).count();
    let total = outcomes.len();
    arguments.output.deliver(
        folder.as_ref(),
        made,
        &inputs,
        |written| {
            let place = written.map_or(String::new(), |p| format!(", written to {}", p.display()));
            format!("{fitted} of {total} curves fitted{place}\n")
        },
        complete,
    )
}

/// A name that is not taken yet.
fn unique(taken: &mut BTreeSet<String>, name: String) -> String {
    let mut candidate = name.clone();
    let mut k = 2;
    while !taken.insert(candidate.clone()) {
        candidate = format!("{name}-{k}");
        k += 1;
    }
    candidate
}
