//! `arclen diagram`: a branch and all that leave it.

use super::progress::Observer;
use crate::arguments::DiagramArguments;
use crate::case::ResolvedCase;
use crate::exit::Exit;
use crate::output::{Checkpoint, DiagramResult, Folder, branch_csv, diagram_json, diagram_summary};
use crate::run::{Keep, Saved, run_diagram};
use crate::{pictures, terminal};
use continuation::diagram::{DiagramBranch, Unfinished};
use std::fs;
use std::path::{Path, PathBuf};

const DIAGRAM: &str = "diagram.json";
const CASE: &str = "case.toml";

/// Explore the diagram of a case.
pub(super) fn diagram(arguments: &DiagramArguments) -> Exit {
    let overrides = arguments.overrides();
    let case = match super::loaded(&arguments.case, &overrides, arguments.quiet) {
        Ok(loaded) => loaded.case,
        Err(exit) => return exit,
    };
    let refuse = |error: &dyn std::fmt::Display| {
        terminal::error(error);
        Exit::BadInput
    };
    let place = match (&arguments.out, arguments.json) {
        (Some(path), _) => Some(path.clone()),
        (None, true) => None,
        (None, false) => Some(Path::new(".").join("arclen-out").join(&case.name)),
    };
    let names = [DIAGRAM, CASE, pictures::DIAGRAM];
    let folder = match place.as_deref().map(|path| Folder::check(path, &names)).transpose() {
        Ok(folder) => folder,
        Err(error) => return refuse(&error),
    };
    let text = case.to_toml();
    let checkpoint = place.as_deref().map(|path| Checkpoint::check(path, &text)).transpose();
    let mut checkpoint = match checkpoint {
        Ok(checkpoint) => checkpoint,
        Err(error) => return refuse(&error),
    };
    let saved = match &checkpoint {
        Some(checkpoint) if !arguments.restart => match checkpoint.load() {
            Ok(saved) => saved,
            Err(error) => return refuse(&error),
        },
        _ => Saved::default(),
    };
    let resumed = saved != Saved::default();
    if resumed && !arguments.quiet {
        let n = saved.finished.len();
        let part = saved.unfinished.as_ref().map_or(0, |part| part.points().len());
        let note = format!(
            "note: goes on after {n} finished branches and {part} points of the next one\n"
        );
        terminal::err(&note);
    }
    let observer = Observer::new(None, arguments.quiet);
    let mut nowhere = Nowhere;
    let mut lazy = checkpoint.as_mut().map(|checkpoint| Lazy { checkpoint, resumed, begun: false });
    let keep: &mut dyn Keep = match &mut lazy {
        Some(lazy) => lazy,
        None => &mut nowhere,
    };
    let outcome = run_diagram(&case, saved, keep, &mut |at| observer.hear_of_diagram(at));
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

/// Keeps nothing, where no files are wanted.
struct Nowhere;

impl Keep for Nowhere {
    fn branch(&mut self, _: &DiagramBranch, _: f64) {}

    fn is_due(&self) -> bool {
        false
    }

    fn unfinished(&mut self, _: usize, _: &Unfinished, _: f64) {}
}

/// Write files, JSON and summary.
fn deliver(
    arguments: &DiagramArguments,
    case: &ResolvedCase,
    result: &DiagramResult,
    folder: Option<&Folder>,
) -> Exit {
    let mut failed = false;
    let mut complain = |error: &dyn std::fmt::Display| {
        terminal::error(error);
        failed = true;
    };
    let json = match diagram_json(result) {
        Ok(json) => json,
        Err(error) => {
            complain(&error);
            String::new()
        }
    };
    let mut written = None;
    if let Some(folder) = folder {
        let mut files = Vec::new();
        for branch in &result.branches {
            match branch_csv(&branch.trace.table) {
                Ok(table) => files.push((branch.csv(), table)),
                Err(error) => complain(&error),
            }
        }
        files.push((DIAGRAM.to_owned(), json.clone().into_bytes()));
        files.push((CASE.to_owned(), case.to_toml().into_bytes()));
        if !arguments.no_pictures {
            match pictures::draw_diagram(result) {
                Ok(Some(drawn)) => files.push((pictures::DIAGRAM.to_owned(), drawn)),
                Ok(None) => {}
                Err(error) => complain(&error),
            }
        }
        match folder.write(&files) {
            Ok(()) => {
                written = Some(folder.path());
                remove_others(folder.path(), result.branches.len());
            }
            Err(error) => complain(&error),
        }
    }
    let mut printed = Exit::Done;
    if arguments.json {
        printed = super::print(&json);
    }
    if !arguments.quiet {
        let summary = diagram_summary(result, written);
        if arguments.json {
            terminal::err(&summary);
        } else {
            printed = super::print(&summary);
        }
    }
    if failed || printed != Exit::Done {
        Exit::NotWritten
    } else if result.is_complete() {
        Exit::Done
    } else {
        Exit::StoppedEarly
    }
}

/// Removes the branches of an earlier diagram that had more of them.
fn remove_others(folder: &Path, branches: usize) {
    let path = |k: usize| -> PathBuf { folder.join(format!("branch-{k}.csv")) };
    for file in (branches..).map(path).take_while(|file| file.is_file()) {
        if fs::remove_file(file).is_err() {
            return;
        }
    }
}
