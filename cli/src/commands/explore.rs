//! `arclen explore`: a page on the loopback interface on which the case is moved.

use super::Done;
use super::progress::requests;
use crate::Listen;
use crate::arguments::ExploreArguments;
use crate::exit::Exit;
use crate::terminal;
use explore::Explorer;
use std::process::{Command, Stdio};
use study::case::catalogue;

/// Serve the page until Ctrl-C.
pub(super) fn explore(arguments: &ExploreArguments, listen: &Listen<'_>) -> Done {
    let case = super::loaded(&arguments.case, &arguments.case.overrides(), false)?.case;
    let stop = requests(listen);
    let word = arguments.case.case.to_string_lossy();
    let words = arguments.case.words();
    let explorer = Explorer::new(&word, words, case, catalogue(), arguments.port, stop)
        .map_err(|error| super::refuse(&error))?;
    let url = explorer.url();
    let printed = super::print(&format!("{url}\n"));
    if printed != Exit::Done {
        return Err(printed);
    }
    terminal::err("Open this address in a browser on this computer; Ctrl-C ends it.\n");
    if !arguments.no_open && terminal::watched() {
        open(&url);
    }
    explorer.run();
    Ok(Exit::Done)
}

/// Shows the page in the user's browser, where there is one; the address is printed in any case.
fn open(url: &str) {
    let (program, words): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(target_os = "windows") {
        ("cmd", &["/C", "start", ""])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    let command = command.args(words).arg(url);
    let quiet = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let _ = quiet.spawn();
}
