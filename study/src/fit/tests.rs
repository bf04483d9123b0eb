//! What is refused, as data and in words that are no command line's.

#![allow(clippy::unwrap_used)]

use super::lab::{Lab, Wishes, load};
use super::{Fault, Laws, Missing, SetupError, Source, Wish, fit_file, profiles};
use crate::case::Override;
use identify::{Attended, FitError, LawName, Profiles};
use std::sync::atomic::AtomicBool;

fn lab(keys: &[&str]) -> Lab {
    let overrides: Vec<Override> =
        keys.iter().map(|text| Override::given_by("--set", *text)).collect();
    load(None, "known", &overrides).unwrap()
}

const NOTHING: Wishes<'_> =
    Wishes { fix: &[], free: &[], prior: &[], only: None, range: None, robust: false };

/// What is asked for, and the refusal.
fn refusals() -> Vec<(SetupError, SetupError)> {
    let lever = "instrument.spring_constant=\"0.08 N/m\"";
    let radius = "physical.radius=\"1.5 um\"";
    let whole = lab(&[lever, radius]);
    let one = |text: &str| [text.to_owned()];
    let ask = |wishes: Wishes<'_>| whole.setup(LawName::Hooke, None, wishes).unwrap_err();
    let prior = |text: &str| ask(Wishes { prior: &one(text), ..NOTHING });
    let range = |text| ask(Wishes { range: Some(text), ..NOTHING });
    let text = str::to_owned;
    let unit = |text, dimension| crate::units::parse(text, dimension).unwrap_err();
    use crate::units::Dimension::{Length, Pressure};
    vec![
        (
            lab(&[]).setup(LawName::Hooke, None, NOTHING).unwrap_err(),
            Missing::SpringConstant.into(),
        ),
        (lab(&[lever]).setup(LawName::Hooke, None, NOTHING).unwrap_err(), Missing::Radius.into()),
        (
            ask(Wishes { fix: &one("chi"), ..NOTHING }),
            SetupError::NothingToKeep { name: text("chi") },
        ),
        (
            ask(Wishes { free: &one("chii"), ..NOTHING }),
            SetupError::UnknownKey {
                wish: Wish::Free,
                name: text("chii"),
                allowed: super::error::keys(),
            },
        ),
        (prior("radius"), SetupError::PriorForm { text: text("radius") }),
        (prior("radius=1 um:-1 um"), SetupError::PriorSign { name: text("radius") }),
        (
            prior("young=2 nm:1 nm"),
            SetupError::Quantity {
                wish: Wish::Prior,
                key: "young",
                text: text("2 nm"),
                error: unit("2 nm", Pressure),
            },
        ),
        (
            prior("poisson=half:0.1"),
            SetupError::Number { wish: Wish::Prior, key: "poisson", text: text("half") },
        ),
        (range("1 um"), SetupError::RangeForm { text: text("1 um") }),
        (range("1 um:1 um"), SetupError::RangeEmpty { text: text("1 um:1 um") }),
        (
            range("1:2"),
            SetupError::Quantity {
                wish: Wish::Range,
                key: "contact",
                text: text("1"),
                error: unit("1", Length),
            },
        ),
        (
            Lab::allows(LawName::Skalak, Wishes { free: &one("shell.b"), ..NOTHING }).unwrap_err(),
            SetupError::NoShare { wish: Wish::Free, law: LawName::Skalak },
        ),
        (
            profiles(Some("young, nothing")).unwrap_err(),
            SetupError::UnknownProfile { name: text("nothing") },
        ),
    ]
}

#[test]
fn refusals_are_data_and_name_no_option() {
    for (found, expected) in refusals() {
        assert_eq!(found, expected);
        let words = found.to_string();
        assert!(!words.contains("--") && words.contains(": "), "{words}");
    }
}

#[test]
fn it_is_said_whose_fault_it_is() {
    let stop = AtomicBool::new(true);
    let source = Source { path: "no such file".into(), number: None };
    let fit = |attended| {
        let profiles = &Profiles::None;
        fit_file(&source, &lab(&[]), Laws::Known, NOTHING, profiles, attended).unwrap_err()
    };
    let missing = fit(Attended::default());
    assert_eq!(missing.fault(), Fault::Input);
    assert!(missing.to_string().starts_with("no such file: cannot be read: "), "{missing}");
    let stopped = fit(Attended { stop: Some(&stop), ..Attended::default() });
    assert_eq!(stopped.fault(), Fault::Stopped);
    let error = FitError::NoStart;
    assert_eq!(super::Failure::Fit { curve: String::new(), error }.fault(), Fault::NotFound);
}
