//! The commands, one room each.

mod check;
mod completions;
mod cycle;
mod delivery;
mod diagram;
mod explore;
mod figure;
mod fit;
mod list;
mod map;
mod orbits;
mod progress;
mod sweep;
mod trace;

use crate::Listen;
use crate::advice::Advised;
use crate::arguments::{Arguments, CaseArguments, Command, OutputArguments};
use crate::exit::Exit;
use crate::terminal;
use std::path::PathBuf;
use study::case::{LoadedCase, Override, PictureCase, catalogue, load, picture_of};

/// How a command ended: `Err` where it could not go on.
type Done = Result<Exit, Exit>;

/// Do what was asked.
pub(crate) fn dispatch(arguments: &Arguments, listen: &Listen<'_>) -> Exit {
    let done = match &arguments.command {
        Command::Trace(arguments) => trace::trace(arguments, listen),
        Command::Diagram(arguments) => diagram::diagram(arguments, listen),
        Command::Explore(arguments) => explore::explore(arguments, listen),
        Command::Fit(arguments) => fit::fit(arguments, listen),
        Command::Figure(arguments) => figure::figure(arguments, listen),
        Command::Orbits(arguments) => orbits::orbits(arguments, listen),
        Command::Cycle(arguments) => cycle::cycle(arguments, listen),
        Command::Check(arguments) => check::check(arguments),
        Command::Map(arguments) => map::map(arguments, listen),
        Command::Sweep(arguments) => sweep::sweep(arguments, listen),
        Command::Merge(arguments) => sweep::merge(arguments),
        Command::List => Ok(list::list()),
        Command::Completions { shell } => Ok(completions::completions(*shell)),
    };
    done.unwrap_or_else(|exit| exit)
}

/// The case asked for, or the exit code after saying what is wrong with it.
fn loaded(
    arguments: &CaseArguments,
    overrides: &[Override],
    quiet: bool,
) -> Result<LoadedCase, Exit> {
    let loaded = load(&arguments.case, overrides, &catalogue());
    let loaded = loaded.map_err(|error| refuse(&error.advised()))?;
    if !quiet {
        for note in &loaded.notes {
            terminal::err(&format!("note: {note}\n"));
        }
    }
    Ok(loaded)
}

/// How pictures look that belong to no single case, or the exit code after saying what is wrong with it.
fn look(output: &OutputArguments) -> Result<PictureCase, Exit> {
    let looks: Vec<Override> = output.looks().collect();
    picture_of(&looks).map_err(|error| refuse(&error.advised()))
}

/// Say what is wrong with what was asked for.
fn refuse(message: &dyn std::fmt::Display) -> Exit {
    terminal::error(message);
    Exit::BadInput
}

/// Say which of the files that were kept are no longer what was written.
fn report_damage(damaged: &[PathBuf]) {
    for path in damaged {
        let path = path.display();
        terminal::err(&format!(
            "warning: {path}: damaged; set aside as {path}.damaged, and what it held is computed \
             again\n"
        ));
    }
}

/// Print on standard output; the exit code tells whether that worked.
fn print(text: &str) -> Exit {
    match terminal::out(text) {
        Ok(()) => Exit::Done,
        Err(error) => {
            terminal::error(&format!("standard output: cannot be written: {error}"));
            Exit::NotWritten
        }
    }
}
