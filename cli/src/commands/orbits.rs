//! `arclen orbits`: the periodic orbits that leave the Hopf points of a branch.

use super::Done;
use super::progress::Observer;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::OrbitsArguments;
use pictures::results;
use std::path::Path;
use study::record::diagram_summary;
use study::run::run_orbits;

/// Follow the periodic orbits of a case.
pub(super) fn orbits(arguments: &OrbitsArguments, listen: &Listen<'_>) -> Done {
    let output = &arguments.output;
    let case = super::loaded(&arguments.case, &arguments.overrides(), output.quiet)?.case;
    let inputs = arguments.case.inputs();
    let folder = output.folder(&case.name, &results::orbits_names(), &inputs)?;
    let observer = Observer::new(None, output.quiet, listen);
    let outcome = run_orbits(&case, arguments.hopf, &mut |at| observer.update_diagram(at));
    observer.finish();
    let result = outcome.map_err(|error| super::refuse(&error.advised()))?;
    let made = results::orbits(&case, &result, output.wanted(folder.as_ref(), false));
    let summary = |written: Option<&Path>| diagram_summary(&case, &result, written);
    output.deliver(folder.as_ref(), made, &inputs, summary, result.followed)
}
