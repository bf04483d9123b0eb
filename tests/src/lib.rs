//! Cross-crate tests live in `tests/`; this library is empty.

/// The code of every README and of the documentation, as tests.
#[cfg(doctest)]
mod readme {
    #[doc = include_str!("../../README.md")]
    struct Workspace;
    #[doc = include_str!("../../continuation/README.md")]
    struct Continuation;
    #[doc = include_str!("../../shell_contact/README.md")]
    struct ShellContact;
    #[doc = include_str!("../../problems/README.md")]
    struct Problems;
    #[doc = include_str!("../../identify/README.md")]
    struct Identify;
    #[doc = include_str!("../../docs/fit.md")]
    struct Fit;
    #[doc = include_str!("../../docs/library.md")]
    struct Library;
    #[doc = include_str!("../../cli/README.md")]
    struct Cli;
}
