//! `arclen diagram`: a branch and all that leave it.

use super::Done;
use super::progress::Observer;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::DiagramArguments;
use crate::terminal;
use continuation::diagram::{DiagramBranch, Unfinished};
use pictures::results;
use std::path::Path;
use study::case::{PictureCase, ResolvedCase};
use study::record::diagram_summary;
use study::run::{Keep, KeepNothing, Saved, run_diagram};
use study::store::Checkpoint;

/// Explore the diagram of a case.
pub(super) fn diagram(arguments: &DiagramArguments, listen: &Listen<'_>) -> Done {
    let output = &arguments.output;
    let case = super::loaded(&arguments.case, &arguments.overrides(), output.quiet)?.case;
    let inputs = arguments.case.inputs();
    let folder = output.folder(&case.name, &results::diagram_names(), &inputs)?;
    let refuse = |error: &dyn Advised| super::refuse(&error.advised());
    // another look of its pictures makes no other diagram
    let plain = ResolvedCase { picture: PictureCase::default(), ..case.clone() };
    let text = plain.to_toml();
    let checkpoint = folder.as_ref().map(|folder| Checkpoint::check(folder.path(), &text));
    let mut checkpoint = checkpoint.transpose().map_err(|error| refuse(&error))?;
    let saved = match &checkpoint {
        Some(checkpoint) if !arguments.restart => {
            let (saved, damaged) = checkpoint.load().map_err(|error| refuse(&error))?;
            super::report_damage(&damaged);
            saved
        }
        _ => Saved::default(),
    };
    let resumed = saved != Saved::default();
    if resumed && !output.quiet {
        let n = saved.finished.len();
        let part = saved.unfinished.as_ref().map_or(0, |part| part.points().len());
        let note = format!(
            "note: goes on after {n} finished branches and {part} points of the next one\n"
        );
        terminal::err(&note);
    }
    let observer = Observer::new(None, output.quiet, listen);
    let mut nothing = KeepNothing;
    let mut lazy = checkpoint.as_mut().map(|checkpoint| Lazy { checkpoint, resumed, begun: false });
    let keep: &mut dyn Keep = match &mut lazy {
        Some(lazy) => lazy,
        None => &mut nothing,
    };
    let outcome =
        run_diagram(&case, arguments.report, saved, keep, &mut |at| observer.update_diagram(at));
    observer.finish();
    let result = outcome.map_err(|error| refuse(&error))?;
    let made = results::diagram(&case, &result, output.wanted(folder.as_ref(), arguments.report));
    let summary = |written: Option<&Path>| diagram_summary(&case, &result, written);
    let done = output.deliver(folder.as_ref(), made, &inputs, summary, result.followed);
    if let Some(checkpoint) = checkpoint {
        if let Some(error) = checkpoint.failure() {
            terminal::err(&format!("note: {error}\n"));
        }
        // what was interrupted goes on another time
        if done.is_ok()
            && result.stopped_because != "interrupted"
            && let Err(error) = checkpoint.remove()
        {
            terminal::err(&format!("note: {error}\n"));
        }
    }
    done
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
