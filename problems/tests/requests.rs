//! What is asked of a problem is checked, and refused by key, value and what is allowed.

#![allow(clippy::unwrap_used, clippy::panic)]

use problems::{Allowed, ProblemError, Request, find};
use std::ops::ControlFlow;

#[track_caller]
fn refused(name: &str, change: impl Fn(&mut Request), key: &str, value: f64) -> Allowed {
    let entry = find(name).unwrap();
    let mut request = entry.request();
    change(&mut request);
    match entry.trace(&request, &mut |_| ControlFlow::Continue(())) {
        Err(ProblemError::OutOfRange { key: k, value: v, allowed }) => {
            assert_eq!((k.as_str(), v.to_bits()), (key, value.to_bits()));
            allowed
        }
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn bad_values_are_named() {
    let change = |k: usize, to: f64| move |request: &mut Request| request.parameters[k] = to;
    assert_eq!(
        refused("shallow-arch", change(0, -1.0), "parameters.rise", -1.0),
        Allowed::Above(0.0)
    );
    refused("shallow-arch", change(1, f64::NAN), "parameters.asymmetry", f64::NAN);
    refused("cusp", change(0, f64::INFINITY), "parameters.lambda", f64::INFINITY);
    refused("jkr-load", change(1, 0.0), "parameters.radius", 0.0);
    refused("pressurised-sphere", change(1, 0.6), "parameters.poisson", 0.6);
    refused("pressurised-sphere", change(0, 0.0), "parameters.bending", 0.0);
    refused("euler-column", |r| r.elements = 2, "mesh.elements", 2.0);
    refused("mittelmann", |r| r.elements = 5000, "mesh.elements", 5000.0);
    refused("pitchfork", |r| r.start = 1.0, "path.start", 1.0);
    refused("mittelmann", |r| r.start = 0.5, "path.start", 0.5);
    // the range depends on other values
    let allowed = refused("jkr-load", |r| r.start = -5.0, "path.start", -5.0);
    assert!(allowed.holds(-4.7123) && !allowed.holds(-4.7124), "{allowed}");
    let allowed = refused("jkr-grip", |r| r.start = -1.7, "path.start", -1.7);
    assert!(allowed.holds(-1.6087) && !allowed.holds(-1.6088), "{allowed}");
}

#[test]
fn errors_read_as_sentences() {
    let entry = find("euler-column").unwrap();
    let request = Request { elements: 2, ..entry.request() };
    let error = entry.trace(&request, &mut |_| ControlFlow::Continue(())).unwrap_err();
    assert_eq!(error.to_string(), "mesh.elements = 2: must be a whole number from 8 to 100000");
    let request = Request { parameters: vec![1.0], ..entry.request() };
    let error = entry.trace(&request, &mut |_| ControlFlow::Continue(())).unwrap_err();
    assert_eq!(error.to_string(), "euler-column takes 0 further parameters, not 1");
    assert!(find("euler").is_none());
}

#[test]
fn ranges_hold_what_they_say() {
    for (allowed, inside, outside, words) in [
        (Allowed::Any, 1e300, f64::NAN, "a finite number"),
        (Allowed::Above(0.0), 1e-9, 0.0, "positive"),
        (Allowed::Above(2.0), 2.1, 2.0, "greater than 2"),
        (Allowed::Below(0.0), -1.0, 0.0, "negative"),
        (Allowed::Below(3.0), 2.9, 3.0, "less than 3"),
        (Allowed::AtLeast(0.0), 0.0, -1e-9, "at least 0"),
        (Allowed::Within(0.0, 1.0), 1.0, 1.1, "from 0 to 1"),
        (Allowed::Count(8, 9), 9.0, 8.5, "a whole number from 8 to 9"),
    ] {
        assert!(allowed.holds(inside) && !allowed.holds(outside), "{allowed}");
        assert!(!allowed.holds(f64::INFINITY));
        assert_eq!(allowed.to_string(), words);
    }
}
