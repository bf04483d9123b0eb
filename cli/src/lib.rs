//! The program `arclen`, as a function of its arguments: its binary and its Python package call it.
//!
//! `arguments` says what may be asked, `commands` does it with the libraries `study`, `pictures` and
//! `paper`; `advice` says what to do about their errors, `terminal` is the only place that prints.

pub mod advice;
mod arguments;
mod commands;
mod exit;
mod terminal;

use arguments::Arguments;
use clap::Parser;
use std::ffi::OsString;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Called when a computation begins that can be stopped: a flag that a request to stop sets, or why there
/// is none. Until then a signal ends the process as it would end any other.
pub type Listen<'a> = dyn Fn() -> Result<Arc<AtomicBool>, String> + 'a;

/// Does what the arguments, of which the first is the program's name, ask for; returns the exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>, listen: &Listen<'_>) -> u8 {
    let exit = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => commands::dispatch(&arguments, listen),
        Err(message) => {
            // help and version come this way too; a closed pipe is no reason to complain
            let _ = message.print();
            if message.use_stderr() { exit::Exit::BadInput } else { exit::Exit::Done }
        }
    };
    exit as u8
}
