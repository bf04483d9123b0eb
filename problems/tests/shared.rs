//! Threads may share the problems of the catalogue; those of a bare residual are what their functions are.

use continuation::samples::Cusp;
use problems::{
    arch::ShallowArch, chan::Chan, enz::Enz, euler_column::EulerColumn, jkr,
    mittelmann::Mittelmann, ode::Ode, pressurised_sphere::PressurisedSphere, snaking::Snaking,
    swift_hohenberg::SwiftHohenberg,
};

#[test]
fn problems_are_send_and_sync() {
    fn shared<T: Send + Sync>() {}
    shared::<ShallowArch>();
    shared::<Chan>();
    shared::<Cusp>();
    shared::<EulerColumn>();
    shared::<jkr::LoadControl>();
    shared::<jkr::GripControl>();
    shared::<Mittelmann>();
    shared::<Ode<Enz, 2>>();
    shared::<PressurisedSphere>();
    shared::<Snaking>();
    shared::<SwiftHohenberg>();
}
