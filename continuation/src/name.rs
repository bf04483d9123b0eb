//! Names of parameters and observables.

use crate::problem::Parameter;
use std::borrow::Cow;

/// A name of a parameter or an observable: a literal, or one that a program makes as it runs.
pub type Name = Cow<'static, str>;

/// Literals as names, in a constant or a static.
///
/// ```
/// use continuation::{Name, literals};
///
/// static SHAPE: [Name; 2] = literals(["height", "width"]);
/// assert_eq!(SHAPE[1], "width");
/// ```
pub const fn literals<const N: usize>(list: [&'static str; N]) -> [Name; N] {
    let mut names = [const { Name::Borrowed("") }; N];
    let mut k = 0;
    while k < N {
        // an assignment would drop what it replaces, which a constant cannot
        std::mem::forget(std::mem::replace(&mut names[k], Name::Borrowed(list[k])));
        k += 1;
    }
    names
}

/// A slice of [`literals`], as [`Problem::observables`](crate::Problem::observables) returns it: `names!["height", "width"]`.
#[macro_export]
macro_rules! names {
    ($($name:expr),* $(,)?) => {
        const { &$crate::literals([$($name),*]) }
    };
}

/// The names of parameters, for messages.
pub(crate) fn listed(parameters: &[Parameter]) -> String {
    parameters.iter().map(|one| &one.name[..]).collect::<Vec<_>>().join(", ")
}
