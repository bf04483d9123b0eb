//! `arclen figure`: the figures of the reference paper, and its claims.

use super::delivery::Made;
use super::progress::Observer;
use crate::Listen;
use crate::arguments::FigureArguments;
use crate::exit::Exit;
use crate::terminal;
use paper::{self, Computed, FigureError};
use std::path::Path;

const JSON: &str = "figures.json";

/// Compute figures.
pub(super) fn figure(arguments: &FigureArguments, listen: &Listen<'_>) -> Exit {
    let planned = paper::numbers(&arguments.numbers)
        .and_then(|numbers| paper::plan(&numbers, &arguments.overrides()));
    let plan = match planned {
        Ok(plan) => plan,
        Err(error) => return refuse(&error),
    };
    let look = match super::look(&arguments.output) {
        Ok(look) => look,
        Err(exit) => return exit,
    };
    let folder = match arguments.output.folder("figures", &[JSON, "index.html", "claims.json"], &[])
    {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let observer = Observer::new(None, arguments.output.quiet, listen);
    let outcome = plan.compute(&observer.stop(), &mut |at| {
        observer.say(format!("{} of {} curves", at.done, at.all));
    });
    let computed = match outcome {
        Ok(computed) => computed,
        Err(error) => {
            observer.finish();
            return refuse(&error);
        }
    };
    let mut made = Made::json(JSON, paper::json(&computed));
    if folder.is_some() {
        observer.say("drawing".to_owned());
        let look = Some(&look).filter(|_| !arguments.output.no_pictures);
        made.files(paper::files(&computed, look));
    }
    observer.finish();
    let complete = computed.early.is_empty();
    arguments.output.deliver(folder.as_ref(), made, &[], |at| summary(&computed, at), complete)
}

fn refuse(error: &FigureError) -> Exit {
    terminal::error(error);
    Exit::BadInput
}

fn summary(computed: &Computed, written: Option<&Path>) -> String {
    let mut text = paper::summary(computed);
    if let Some(path) = written {
        text += &format!("results in {}\n", path.display());
    }
    text
}
