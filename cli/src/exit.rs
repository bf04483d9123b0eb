//! Exit codes, all of them.

/// How the program ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Exit {
    /// Everything that was asked for was done.
    Done = 0,
    /// The computation is complete but its results could not be written.
    NotWritten = 1,
    /// Usage or input error: nothing was created.
    BadInput = 2,
    /// The computation stopped early: files are complete for what was computed.
    StoppedEarly = 3,
}
