//! The binary `arclen`: bifurcation diagrams from the command line. The library does the work; here are
//! the signals of the process.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Signals that come closer than this are one request: a terminal that closes and a system that shuts
/// down send several.
const ONE_REQUEST: Duration = Duration::from_millis(500);

fn main() -> ExitCode {
    cli::run(std::env::args_os(), &stop_on_signals).into()
}

/// A flag that Ctrl-C sets, and so do SIGTERM and SIGHUP.
fn stop_on_signals() -> Result<Arc<AtomicBool>, String> {
    let stop = Arc::new(AtomicBool::new(false));
    let heard = Arc::clone(&stop);
    let mut first: Option<Instant> = None;
    // the second request does not wait for the current step
    let handler = move || {
        heard.store(true, Ordering::SeqCst);
        if first.get_or_insert_with(Instant::now).elapsed() > ONE_REQUEST {
            std::process::exit(130);
        }
    };
    ctrlc::set_handler(handler).map_err(|error| error.to_string())?;
    Ok(stop)
}
