//! The only place that writes to the terminal.

use std::io::{self, ErrorKind, IsTerminal, Write};

/// Write to standard output. A reader that went away (a closed pipe) is not an error.
///
/// # Errors
/// When standard output cannot be written for another reason, for example a full disk.
pub(crate) fn out(text: &str) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// Write to standard error; there is nobody left to tell if that fails.
pub(crate) fn err(text: &str) {
    let mut stderr = io::stderr().lock();
    let _ = stderr.write_all(text.as_bytes()).and_then(|()| stderr.flush());
}

/// An error, one line or a few.
pub(crate) fn error(message: &dyn std::fmt::Display) {
    err(&format!("error: {message}\n"));
}

/// Whether somebody watches standard error.
pub(crate) fn watched() -> bool {
    io::stderr().is_terminal()
}
