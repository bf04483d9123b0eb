//! How to use the crate, how it works, and what to do when a trace fails.
//!
//! - [`tutorial`]: from a residual to branches, special points and saved results.
//! - [`methods`]: the algorithms, with equations, references and limits.
//! - [`troubleshooting`]: every error and refusal, what it means and what to do.
//!
//! The modules hold no code. All examples are tests.

#[doc = include_str!("../docs/tutorial.md")]
#[doc = "```"]
#[doc = include_str!("../docs/column.rs")]
#[doc = "```"]
#[doc = include_str!("../docs/tutorial_column.md")]
pub mod tutorial {}

#[doc = include_str!("../docs/methods.md")]
pub mod methods {}

#[doc = include_str!("../docs/troubleshooting.md")]
pub mod troubleshooting {}
