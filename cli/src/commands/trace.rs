//! `arclen trace`: follow a branch, write what was found.

use super::Done;
use super::progress::Observer;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::TraceArguments;
use pictures::results;
use study::record::summary;
use study::run::{run_trace, run_trace_reported};

/// Trace a case.
pub(super) fn trace(arguments: &TraceArguments, listen: &Listen<'_>) -> Done {
    let TraceArguments { case: which, output, report } = arguments;
    let case = super::loaded(which, &which.with_looks(output), output.quiet)?.case;
    let inputs = which.inputs();
    let folder = output.folder(&case.name, &results::trace_names(), &inputs)?;
    let mut observer = Observer::new(Some(case.path), output.quiet, listen);
    let run = if *report { run_trace_reported } else { run_trace };
    let outcome = run(&case, &mut |progress| observer.update(progress));
    observer.finish();
    let result = outcome.map_err(|error| super::refuse(&error.advised()))?;
    let made = results::trace(&case, &result, output.wanted(folder.as_ref(), *report));
    let complete = result.stopped_because.is_complete();
    let words = |written: Option<&std::path::Path>| summary(&case, &result, written);
    output.deliver(folder.as_ref(), made, &inputs, words, complete)
}
