//! `arclen check`: the resolved case, or what is wrong with it.

use super::Done;
use crate::arguments::CaseArguments;

/// Print the resolved case.
pub(super) fn check(arguments: &CaseArguments) -> Done {
    let loaded = super::loaded(arguments, &arguments.overrides(), false)?;
    Ok(super::print(&loaded.case.to_toml()))
}
