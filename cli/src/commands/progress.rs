//! Progress of a trace on a terminal, and requests to stop.

use crate::Listen;
use crate::terminal;
use indicatif::{ProgressBar, ProgressStyle};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use study::case::PathCase;
use study::run::{DiagramProgress, Progress};

const LENGTH: u64 = 1000;

/// A flag that is set when somebody asks for a stop.
pub(super) fn requests(listen: &Listen<'_>) -> Arc<AtomicBool> {
    listen().unwrap_or_else(|error| {
        terminal::err(&format!("note: Ctrl-C will not keep what was computed: {error}\n"));
        Arc::default()
    })
}

/// Shows how far a fit is, and has the request to stop it.
pub(super) struct FitWatch {
    bar: Option<ProgressBar>,
    stop: Arc<AtomicBool>,
}

impl FitWatch {
    /// Of one curve, or of several.
    pub(super) fn new(curves: usize, quiet: bool, listen: &Listen<'_>) -> Self {
        let stop = requests(listen);
        let bar = (!quiet && terminal::watched()).then(|| {
            let (length, template) = match curves {
                1 => (LENGTH, "{bar:32} {elapsed} {msg}"),
                _ => (curves as u64, "{bar:32} {pos} of {len} curves, {elapsed}, {eta} to go"),
            };
            let bar = ProgressBar::new(length);
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar
        });
        FitWatch { bar, stop }
    }

    /// Shows how far one fit is.
    pub(super) fn update(&self, progress: identify::Progress) {
        if let Some(bar) = &self.bar {
            bar.set_position((progress.share * LENGTH as f64) as u64);
            bar.set_message(progress.stage.name());
        }
    }

    /// One of several is done.
    pub(super) fn done(&self) {
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
    }

    /// The request to stop.
    pub(super) fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Clears the line.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Shows progress and asks for a stop after a signal.
pub(super) struct Observer {
    bar: Option<ProgressBar>,
    path: Option<PathCase>,
    farthest: f64,
    stop: Arc<AtomicBool>,
}

impl Observer {
    /// An observer; a quiet one, or one whom nobody watches, shows nothing.
    pub(super) fn new(path: Option<PathCase>, quiet: bool, listen: &Listen<'_>) -> Self {
        let stop = requests(listen);
        let bar = (!quiet && terminal::watched()).then(|| {
            let bar = ProgressBar::new(LENGTH);
            // how far a diagram is from its end nobody knows
            let template = if path.is_some() { "{bar:32} {msg}" } else { "{elapsed} {msg}" };
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar
        });
        Observer { bar, path, farthest: 0.0, stop }
    }

    /// Shows a point; whether to go on.
    pub(super) fn update(&mut self, progress: Progress) -> ControlFlow<()> {
        if let (Some(bar), Some(path)) = (&self.bar, self.path) {
            let PathCase { start, end, .. } = path;
            let done = ((progress.parameter - start) / (end - start)).clamp(0.0, 1.0);
            // a branch that turns back has not lost ground
            self.farthest = self.farthest.max(done);
            bar.set_position((self.farthest * LENGTH as f64) as u64);
            bar.set_message(format!(
                "{} points, {} special; at {:.5}",
                progress.points, progress.events, progress.parameter
            ));
        }
        self.flow()
    }

    /// Shows a point of a diagram; whether to go on.
    pub(super) fn update_diagram(&self, progress: DiagramProgress) -> ControlFlow<()> {
        if let Some(bar) = &self.bar {
            bar.set_message(format!(
                "{} branches, {} waiting; on this one {} points, at {:.5}",
                progress.branches,
                progress.waiting,
                progress.branch.points,
                progress.branch.parameter
            ));
        }
        self.flow()
    }

    /// The request to stop, for work that goes on elsewhere.
    pub(super) fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Show a message.
    pub(super) fn say(&self, message: String) {
        if let Some(bar) = &self.bar {
            bar.set_message(message);
        }
    }

    fn flow(&self) -> ControlFlow<()> {
        if self.stop.load(Ordering::SeqCst) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Clear the line.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
