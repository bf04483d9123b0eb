//! `arclen figure`: the figures of the reference paper, and its claims.

use super::Done;
use super::progress::Observer;
use crate::Listen;
use crate::arguments::FigureArguments;
use paper::{self, Computed};
use pictures::results::Results;
use std::path::Path;

const JSON: &str = "figures.json";

/// Compute figures.
pub(super) fn figure(arguments: &FigureArguments, listen: &Listen<'_>) -> Done {
    let plan = paper::numbers(&arguments.numbers)
        .and_then(|numbers| paper::plan(&numbers, &arguments.overrides()))
        .map_err(|error| super::refuse(&error))?;
    let look = super::look(&arguments.output)?;
    let names = [JSON, "index.html", "claims.json"];
    let folder = arguments.output.folder("figures", &names, &[])?;
    let observer = Observer::new(None, arguments.output.quiet, listen);
    let outcome = plan.compute(&observer.stop(), &mut |at| {
        observer.say(format!("{} of {} curves", at.done, at.all));
    });
    let computed = outcome.map_err(|error| {
        observer.finish();
        super::refuse(&error)
    })?;
    let mut made = Results::new(JSON, paper::json(&computed));
    if folder.is_some() {
        observer.say("drawing".to_owned());
        let look = Some(&look).filter(|_| !arguments.output.no_pictures);
        made.files(paper::files(&computed, look));
    }
    observer.finish();
    let complete = computed.early.is_empty();
    arguments.output.deliver(folder.as_ref(), made, &[], |at| summary(&computed, at), complete)
}

fn summary(computed: &Computed, written: Option<&Path>) -> String {
    let mut text = paper::summary(computed);
    if let Some(path) = written {
        text += &format!("results in {}\n", path.display());
    }
    text
}
