//! `arclen sweep` and `arclen merge`: parameter studies, and the union of their shards.

use super::Done;
use super::progress::requests;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::{MergeArguments, OutputArguments, SweepArguments};
use crate::exit::Exit;
use crate::terminal;
use indicatif::{ProgressBar, ProgressStyle};
use pictures::results::{self, SWEEP_NAMES};
use std::path::PathBuf;
use study::case::{LoadError, Override, PictureCase, catalogue, load_text};
use study::record::{CaseRecord, SweepResult, sweep_summary};
use study::store::{Computed, Folder, Kept, Store, StoreError, compute, of_one_sweep};
use study::sweep::{Plan, Shard, Sweep, load};

/// Trace all cases of a sweep.
pub(super) fn sweep(arguments: &SweepArguments, listen: &Listen<'_>) -> Done {
    let output = &arguments.output;
    let sweep = load(&arguments.sweep, arguments.shard, &catalogue()).map_err(|e| refuse(&e))?;
    let place = format!("{}{}", sweep.plan.name, arguments.shard.suffix());
    let folder = output.folder(&place, &SWEEP_NAMES, &sweep.inputs)?;
    let look = look(&sweep.plan, output).map_err(|error| refuse(&error))?;
    let store = folder.as_ref().map(|folder| Store::check(folder.path(), &sweep.plan));
    let store = store.transpose().map_err(|error| refuse(&error))?;
    let kept = match &store {
        Some(store) if !arguments.restart => {
            let (kept, damaged) = store.load(&sweep.cases).map_err(|error| refuse(&error))?;
            super::report_damage(&damaged);
            kept
        }
        _ => Vec::new(),
    };
    if !kept.is_empty() && !output.quiet {
        let (done, all) = (kept.len(), sweep.cases.len());
        terminal::err(&format!("note: goes on after {done} of {all} cases\n"));
    }
    if let Some(store) = &store
        && let Err(error) = store.begin(!kept.is_empty())
    {
        terminal::error(&error);
        return Err(Exit::NotWritten);
    }
    let run = computed(arguments, listen, &sweep, store.as_ref(), kept)?;
    if let Some(error) = &run.failure {
        terminal::error(error);
    }
    let asked = sweep.cases.len();
    let result = SweepResult::new(&sweep.plan, asked, records(&run.kept), run.interrupted);
    let done =
        deliver(output, folder.as_ref(), (&sweep.plan, &look), &run.kept, &result, &sweep.inputs);
    if run.failure.is_some() { Err(Exit::NotWritten) } else { done }
}

/// Unite the shards of a sweep.
pub(super) fn merge(arguments: &MergeArguments) -> Done {
    let opened = arguments.folders.iter().map(|path| Ok((path.clone(), Store::open(path)?)));
    let stores: Result<Vec<(PathBuf, Store)>, StoreError> = opened.collect();
    let stores = stores.map_err(|error| refuse(&error))?;
    of_one_sweep(&stores).map_err(|error| refuse(&error))?;
    let Some((_, first)) = stores.first() else { return Err(Exit::BadInput) };
    let plan = Plan { shard: Shard::ALL, ..first.plan().clone() };
    let look = look(&plan, &arguments.output).map_err(|error| refuse(&error))?;
    let folder = arguments.output.folder(&plan.name, &SWEEP_NAMES, &[])?;
    let mut kept: Vec<Kept> = Vec::new();
    for (_, store) in &stores {
        let (all, damaged) = store.all().map_err(|error| refuse(&error))?;
        for path in damaged {
            let path = path.display();
            terminal::err(&format!(
                "warning: {path}: damaged, so its case is missing; start its sweep again\n"
            ));
        }
        kept.extend(all);
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
    super::refuse(&error.advised())
}

/// Computes the cases that are not kept yet, with a bar for those who watch.
fn computed(
    arguments: &SweepArguments,
    listen: &Listen<'_>,
    sweep: &Sweep,
    store: Option<&Store>,
    kept: Vec<Kept>,
) -> Result<Computed, Exit> {
    let stop = requests(listen);
    let bar = bar(arguments.output.quiet, sweep.cases.len(), kept.len());
    let told = |troubled: usize| {
        if let Some(bar) = &bar {
            if troubled > 0 {
                bar.set_message(format!("{troubled} failed or stopped early, "));
            }
            bar.inc(1);
        }
    };
    let jobs = arguments.jobs.map_or(0, usize::from);
    let computed = compute(sweep, store, kept, jobs, &stop, &told).map_err(|error| {
        super::refuse(&format!("--jobs {jobs}: the threads cannot be had: {error}"))
    })?;
    if let Some(bar) = &bar {
        bar.finish_and_clear();
    }
    if computed.lost > 0 {
        let (lost, all) = (computed.lost, sweep.cases.len());
        terminal::err(&format!(
            "warning: the files of {lost} of {all} cases were removed while this ran; the same \
             command computes them again\n"
        ));
    }
    Ok(computed)
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
) -> Done {
    let made =
        results::sweep(plan, kept, result, folder, Some(look).filter(|_| !output.no_pictures));
    let summary = |written: Option<&std::path::Path>| sweep_summary(result, written);
    output.deliver(folder, made, inputs, summary, result.is_complete())
}
