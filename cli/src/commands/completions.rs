//! `arclen completions`: what a shell needs to complete the command line.

use crate::arguments::Arguments;
use crate::exit::Exit;
use clap::CommandFactory;
use clap_complete::Shell;

/// Print the script for a shell.
pub(super) fn completions(shell: Shell) -> Exit {
    // into memory first: the generator cannot report a failing writer
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "arclen", &mut script);
    super::print(&String::from_utf8_lossy(&script))
}
