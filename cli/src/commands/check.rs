//! `arclen check`: the resolved case, or what is wrong with it.

use crate::arguments::CaseArguments;
use crate::exit::Exit;

/// Print the resolved case.
pub(super) fn check(arguments: &CaseArguments) -> Exit {
    match super::loaded(arguments, &arguments.overrides(), false) {
        Ok(loaded) => super::print(&loaded.case.to_toml()),
        Err(exit) => exit,
    }
}
