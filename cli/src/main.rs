//! The binary `arclen`: bifurcation diagrams from the command line.
//!
//! `arguments` says what may be asked, `commands` does it with the libraries `study`, `pictures` and
//! `paper`; `advice` says what to do about their errors, `terminal` is the only place that prints.

mod advice;
mod arguments;
mod commands;
mod exit;
mod terminal;

use arguments::Arguments;
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    match Arguments::try_parse() {
        Ok(arguments) => commands::dispatch(&arguments).into(),
        Err(message) => {
            // help and version come this way too; a closed pipe is no reason to complain
            let _ = message.print();
            if message.use_stderr() { exit::Exit::BadInput } else { exit::Exit::Done }.into()
        }
    }
}
