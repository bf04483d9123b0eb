//! `arclen sweep` and `arclen merge`: parameter studies, and the union of their shards.

use super::delivery::Made;
use super::progress::requests;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::{MergeArguments, OutputArguments, SweepArguments};
use crate::exit::Exit;
use crate::terminal;
use indicatif::{ProgressBar, ProgressStyle};
use std::io;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use study::case::{LoadError, Override, PictureCase, catalogue, load_text};
use study::record::{CaseRecord, Status, SweepResult, sweep_json, sweep_summary};
use study::run::{Outcome, run_sweep};
use study::store::{Folder, Kept, Store, StoreError, of_one_sweep};
use study::store::{phase_csv, write_curves, write_events};
use study::sweep::{Plan, Shard, Sweep, SweepCase, load};

const JSON: &str = "sweep.json";
const CURVES: &str = "curves.csv";
const EVENTS: &str = "events.csv";
const PHASE: &str = "phase.csv";
const NAMES: [&str; 7] =
    [JSON, CURVES, EVENTS, PHASE, pictures::PHASE, "cases/plan.json", "cases/case-*.cbor"];

/// Trace all cases of a sweep.
pub(super) fn sweep(arguments: &SweepArguments, listen: &Listen<'_>) -> Exit {
    let quiet = arguments.output.quiet;
    let sweep = match load(&arguments.sweep, arguments.shard, &catalogue()) {
        Ok(sweep) => sweep,
        Err(error) => return refuse(&error),
    };
    let place = format!("{}{}", sweep.plan.name, arguments.shard.suffix());
    let folder = match arguments.output.folder(&place, &NAMES, &sweep.inputs) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let look = match look(&sweep.plan, &arguments.output) {
        Ok(look) => look,
        Err(error) => return refuse(&error),
    };
    let store = folder.as_ref().map(|folder| Store::check(folder.path(), &sweep.plan)).transpose();
    let store = match store {
        Ok(store) => store,
        Err(error) => return refuse(&error),
    };
    let kept = match &store {
        Some(store) if !arguments.restart => match store.load(&sweep.cases) {
            Ok((kept, damaged)) => {
                super::report_damage(&damaged);
                kept
            }
            Err(error) => return refuse(&error),
        },
        _ => Vec::new(),
    };
    if !kept.is_empty() && !quiet {
        let (done, all) = (kept.len(), sweep.cases.len());
        terminal::err(&format!("note: goes on after {done} of {all} cases\n"));
    }
    if let Some(store) = &store
        && let Err(error) = store.begin(!kept.is_empty())
    {
        terminal::error(&error);
        return Exit::NotWritten;
    }
    let run = match compute(arguments, listen, &sweep, store.as_ref(), kept) {
        Ok(run) => run,
        Err(exit) => return exit,
    };
    if let Some(error) = &run.failure {
        terminal::error(error);
    }
    let asked = sweep.cases.len();
    let result = SweepResult::new(&sweep.plan, asked, records(&run.kept), run.interrupted);
    let output = &arguments.output;
    let exit =
        deliver(output, folder.as_ref(), (&sweep.plan, &look), &run.kept, &result, &sweep.inputs);
    if run.failure.is_some() { Exit::NotWritten } else { exit }
}

/// Unite the shards of a sweep.
pub(super) fn merge(arguments: &MergeArguments) -> Exit {
    let opened = arguments.folders.iter().map(|path| Ok((path.clone(), Store::open(path)?)));
    let stores = match opened.collect::<Result<Vec<(PathBuf, Store)>, StoreError>>() {
        Ok(stores) => stores,
        Err(error) => return refuse(&error),
    };
    if let Err(error) = of_one_sweep(&stores) {
        return refuse(&error);
    }
    let Some((_, first)) = stores.first() else { return Exit::BadInput };
    let plan = Plan { shard: Shard::ALL, ..first.plan().clone() };
    let look = match look(&plan, &arguments.output) {
        Ok(look) => look,
        Err(error) => return refuse(&error),
    };
    let folder = match arguments.output.folder(&plan.name, &NAMES, &[]) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let mut kept: Vec<Kept> = Vec::new();
    for (_, store) in &stores {
        match store.all() {
            Ok((all, damaged)) => {
                for path in damaged {
                    let path = path.display();
                    terminal::err(&format!(
                        "warning: {path}: damaged, so its case is missing; start its sweep again\n"
                    ));
                }
                kept.extend(all);
            }
            Err(error) => return refuse(&error),
        }
    }
    // a shard that was given twice counts once
    kept.sort_by_key(|case| case.record.case);
    kept.dedup_by_key(|case| case.record.case);
    let result = SweepResult::new(&plan, plan.count().unwrap_or(0), records(&kept), false);
    deliver(&arguments.output, folder.as_ref(), (&plan, &look), &kept, &result, &[])
}

/// How the phase diagram looks: as the sweep file says, and the options after it.
fn look(plan: &Plan, output: &OutputArguments) -> Result<PictureCase, LoadError> {
    let looks: Vec<Override> = output.looks().collect();
    let text = plan.base.join("\n");
    load_text(&plan.name, &plan.name, &text, &looks, &catalogue()).map(|loaded| loaded.case.picture)
}

fn records(kept: &[Kept]) -> Vec<CaseRecord> {
    kept.iter().map(|case| case.record.clone()).collect()
}

fn refuse(error: &dyn Advised) -> Exit {
    terminal::error(&error.advised());
    Exit::BadInput
}

/// What a run of a sweep leaves.
struct Run {
    kept: Vec<Kept>,
    interrupted: bool,
    /// The first case that could not be kept.
    failure: Option<StoreError>,
}

/// Computes the cases that are not kept yet.
fn compute(
    arguments: &SweepArguments,
    listen: &Listen<'_>,
    sweep: &Sweep,
    store: Option<&Store>,
    kept: Vec<Kept>,
) -> Result<Run, Exit> {
    let stop = requests(listen);
    let have: Vec<usize> = kept.iter().map(|case| case.record.case).collect();
    let to_do: Vec<&SweepCase> =
        sweep.cases.iter().filter(|case| have.binary_search(&case.index).is_err()).collect();
    let bar = bar(arguments.output.quiet, sweep.cases.len(), kept.len());
    let shared = Mutex::new(Run { kept, interrupted: false, failure: None });
    let done = |case: &SweepCase, outcome: Outcome| {
        let written = match store {
            Some(store) => store.keep(case, &outcome),
            None => Ok(Kept::in_memory(outcome.record)),
        };
        let mut run = shared.lock().unwrap_or_else(PoisonError::into_inner);
        match written {
            Ok(kept) => run.kept.push(kept),
            // what cannot be kept need not be computed
            Err(error) => {
                stop.store(true, std::sync::atomic::Ordering::SeqCst);
                run.failure.get_or_insert(error);
            }
        }
        if let Some(bar) = &bar {
            let troubled = run.kept.iter().filter(|k| k.record.status != Status::Finished).count();
            if troubled > 0 {
                bar.set_message(format!("{troubled} failed or stopped early, "));
            }
            bar.inc(1);
        }
    };
    let jobs = arguments.jobs.map_or(0, usize::from);
    if let Err(error) = run_sweep(&to_do, jobs, &stop, &done) {
        terminal::error(&format!("--jobs {jobs}: the threads cannot be had: {error}"));
        return Err(Exit::BadInput);
    }
    if let Some(bar) = &bar {
        bar.finish_and_clear();
    }
    let mut run = shared.into_inner().unwrap_or_else(PoisonError::into_inner);
    run.kept.sort_by_key(|case| case.record.case);
    let (there, lost): (Vec<Kept>, Vec<Kept>) = run.kept.drain(..).partition(Kept::is_there);
    run.kept = there;
    let stopped = run.kept.len() + lost.len() < sweep.cases.len();
    if !lost.is_empty() {
        let (lost, all) = (lost.len(), sweep.cases.len());
        terminal::err(&format!(
            "warning: the files of {lost} of {all} cases were removed while this ran; the same \
             command computes them again\n"
        ));
    }
    run.interrupted = run.failure.is_none() && stopped;
    Ok(run)
}

fn bar(quiet: bool, cases: usize, done: usize) -> Option<ProgressBar> {
    if quiet || !terminal::watched() {
        return None;
    }
    let bar = ProgressBar::new(cases as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{bar:32} {pos} of {len} cases, {msg}{eta} left")
    {
        bar.set_style(style);
    }
    bar.set_position(done as u64);
    bar.reset_eta();
    Some(bar)
}

/// Write files, JSON and summary.
fn deliver(
    output: &OutputArguments,
    folder: Option<&Folder>,
    (plan, look): (&Plan, &PictureCase),
    kept: &[Kept],
    result: &SweepResult,
    inputs: &[PathBuf],
) -> Exit {
    let mut made = Made::json(JSON, sweep_json(result));
    if let Some(folder) = folder {
        let other = |error| io::Error::other(error);
        made.done(
            CURVES,
            folder.stream(CURVES, |out| write_curves(plan, kept, out).map_err(other)),
        );
        made.done(
            EVENTS,
            folder.stream(EVENTS, |out| write_events(plan, kept, out).map_err(other)),
        );
        let phases = kept.iter().any(|case| case.record.phase.is_some());
        if phases && plan.plane().is_some() {
            made.attempt(PHASE, phase_csv(plan, kept));
            if !output.no_pictures {
                made.attempt(pictures::PHASE, pictures::draw_phase(result, look));
            }
        }
    }
    let summary = |written: Option<&std::path::Path>| sweep_summary(result, written);
    output.deliver(folder, made, inputs, summary, result.is_complete())
}
