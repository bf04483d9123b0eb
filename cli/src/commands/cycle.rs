//! `arclen cycle`: once to and fro, with the jumps between stable states.

use super::Done;
use super::progress::Observer;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::CycleArguments;
use pictures::results;
use study::record::cycle_summary;
use study::run::run_cycle;

/// Travel a case to and fro.
pub(super) fn cycle(arguments: &CycleArguments, listen: &Listen<'_>) -> Done {
    let CycleArguments { case: which, output, report } = arguments;
    let case = super::loaded(which, &which.with_looks(output), output.quiet)?.case;
    let inputs = which.inputs();
    let folder = output.folder(&case.name, &results::cycle_names(), &inputs)?;
    let mut observer = Observer::new(Some(case.path), output.quiet, listen);
    let outcome = run_cycle(&case, *report, &mut |progress| observer.update(progress));
    observer.finish();
    let result = outcome.map_err(|error| super::refuse(&error.advised()))?;
    let made = results::cycle(&case, &result, output.wanted(folder.as_ref(), *report));
    let complete = result.stopped_because.is_complete();
    let summary = |written: Option<&std::path::Path>| cycle_summary(&case, &result, written);
    output.deliver(folder.as_ref(), made, &inputs, summary, complete)
}
