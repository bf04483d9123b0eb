//! Why there is no page.

use std::io;

/// Why an explorer cannot begin.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExploreError {
    /// The port cannot be had.
    #[error("port {port} of the loopback interface cannot be opened: {source}")]
    Port {
        /// Which; 0 is any.
        port: u16,
        /// What the system says.
        source: io::Error,
    },
    /// The system gives no random numbers.
    #[error("no secret token for the page: {0}")]
    Token(getrandom::Error),
}
