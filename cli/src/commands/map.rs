//! `arclen map`: curves of special points in two parameters.

use super::Done;
use super::progress::Observer;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::MapArguments;
use pictures::results;
use study::record::map_summary;
use study::run::run_map;

/// Map a case.
pub(super) fn map(arguments: &MapArguments, listen: &Listen<'_>) -> Done {
    let MapArguments { case: which, output, over } = arguments;
    let case = super::loaded(which, &which.with_looks(output), output.quiet)?.case;
    let inputs = which.inputs();
    let folder = output.folder(&case.name, &results::map_names(), &inputs)?;
    let mut observer = Observer::new(Some(case.path), output.quiet, listen);
    let outcome = run_map(&case, over, &mut |progress| observer.update(progress));
    observer.finish();
    let result = outcome.map_err(|error| super::refuse(&error.advised()))?;
    let made = results::map(&case, &result, output.wanted(folder.as_ref(), false));
    let complete = result.stopped_because.is_complete();
    let summary = |written: Option<&std::path::Path>| map_summary(&case, &result, written);
    output.deliver(folder.as_ref(), made, &inputs, summary, complete)
}
