#![doc = include_str!("../README.md")]

pub mod case;
mod closest;
pub mod fit;
pub mod record;
pub mod run;
pub mod store;
pub mod sweep;
pub mod units;
