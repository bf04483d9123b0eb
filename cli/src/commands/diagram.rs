//! `arclen diagram`: a branch and all that leave it.

use super::delivery::Made;
use super::progress::Observer;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::DiagramArguments;
use crate::exit::Exit;
use crate::terminal;
use continuation::diagram::{DiagramBranch, Unfinished};
use pictures::{REPORT, report};
use std::path::Path;
use study::case::{PictureCase, ResolvedCase};
use study::record::TraceResult;
use study::record::{DiagramResult, diagram_json, diagram_summary};
use study::run::{Keep, KeepNothing, Saved, run_diagram};
use study::store::{Checkpoint, Folder};

const DIAGRAM: &str = "diagram.json";
const CASE: &str = "case.toml";
const TABLES: &str = "branch-*.csv";

/// Explore the diagram of a case.
pub(super) fn diagram(arguments: &DiagramArguments, listen: &Listen<'_>) -> Exit {
    let overrides = arguments.overrides();
    let case = match super::loaded(&arguments.case, &overrides, arguments.output.quiet) {
        Ok(loaded) => loaded.case,
        Err(exit) => return exit,
    };
    let refuse = |error: &dyn Advised| {
        terminal::error(&error.advised());
        Exit::BadInput
    };
    let orbits = [pictures::PERIOD, super::orbits::TABLES];
    let names: Vec<&str> =
        [DIAGRAM, CASE, pictures::DIAGRAM, pictures::PHYSICAL_DIAGRAM, REPORT, TABLES]
            .into_iter()
            .chain(orbits)
            .chain(pictures::ORBITS)
            .chain(Checkpoint::NAMES)
            .collect();
    let folder = match arguments.output.folder(&case.name, &names, &arguments.case.inputs()) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    // another look of its pictures makes no other diagram
    let plain = ResolvedCase { picture: PictureCase::default(), ..case.clone() };
    let text = plain.to_toml();
    let checkpoint = folder.as_ref().map(|folder| Checkpoint::check(folder.path(), &text));
    let mut checkpoint = match checkpoint.transpose() {
        Ok(checkpoint) => checkpoint,
        Err(error) => return refuse(&error),
    };
    let saved = match &checkpoint {
        Some(checkpoint) if !arguments.restart => match checkpoint.load() {
            Ok((saved, damaged)) => {
                super::report_damage(&damaged);
                saved
            }
            Err(error) => return refuse(&error),
        },
        _ => Saved::default(),
    };
    let resumed = saved != Saved::default();
    if resumed && !arguments.output.quiet {
        let n = saved.finished.len();
        let part = saved.unfinished.as_ref().map_or(0, |part| part.points().len());
        let note = format!(
            "note: goes on after {n} finished branches and {part} points of the next one\n"
        );
        terminal::err(&note);
    }
    let observer = Observer::new(None, arguments.output.quiet, listen);
    let mut nothing = KeepNothing;
    let mut lazy = checkpoint.as_mut().map(|checkpoint| Lazy { checkpoint, resumed, begun: false });
    let keep: &mut dyn Keep = match &mut lazy {
        Some(lazy) => lazy,
        None => &mut nothing,
    };
    let outcome =
        run_diagram(&case, arguments.report, saved, keep, &mut |at| observer.update_diagram(at));
    observer.finish();
    let result = match outcome {
        Ok(result) => result,
        Err(error) => return refuse(&error),
    };
    let exit = deliver(arguments, &case, &result, folder.as_ref());
    if let Some(checkpoint) = checkpoint {
        if let Some(error) = checkpoint.failure() {
            terminal::err(&format!("note: {error}\n"));
        }
        // what was interrupted goes on another time
        if exit != Exit::NotWritten
            && result.stopped_because != "interrupted"
            && let Err(error) = checkpoint.remove()
        {
            terminal::err(&format!("note: {error}\n"));
        }
    }
    exit
}

/// Makes the folder only when there is something to keep, so that bad input creates nothing.
struct Lazy<'c> {
    checkpoint: &'c mut Checkpoint,
    resumed: bool,
    begun: bool,
}

impl Lazy<'_> {
    fn begin(&mut self) {
        if !self.begun {
            self.begun = true;
            if let Err(error) = self.checkpoint.begin(self.resumed) {
                terminal::err(&format!("note: nothing is kept if this is stopped: {error}\n"));
            }
        }
    }
}

impl Keep for Lazy<'_> {
    fn branch(&mut self, branch: &DiagramBranch, seconds: f64) {
        self.begin();
        self.checkpoint.branch(branch, seconds);
    }

    fn is_due(&self) -> bool {
        self.checkpoint.is_due()
    }

    fn unfinished(&mut self, after: usize, branch: &Unfinished, seconds: f64) {
        self.begin();
        self.checkpoint.unfinished(after, branch, seconds);
    }
}

/// Write files, JSON and summary.
fn deliver(
    arguments: &DiagramArguments,
    case: &ResolvedCase,
    result: &DiagramResult,
    folder: Option<&Folder>,
) -> Exit {
    let mut made = Made::json(DIAGRAM, diagram_json(result));
    if folder.is_some() {
        made.file(CASE, case.to_toml());
        super::orbits::add_files(&mut made, case, result, !arguments.output.no_pictures);
        if arguments.report {
            let label =
                |id: usize| if id == 0 { "first branch".into() } else { format!("branch {id}") };
            let curves: Vec<(String, &TraceResult)> =
                result.branches.iter().map(|branch| (label(branch.id), &branch.trace)).collect();
            made.attempt(REPORT, report(case, &result.stopped_detail, &curves));
        }
    }
    let complete = result.followed;
    let summary = |written: Option<&Path>| diagram_summary(result, written);
    arguments.output.deliver(folder, made, &arguments.case.inputs(), summary, complete)
}
