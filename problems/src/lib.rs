//! The catalogue: bifurcation problems with known answers, each to be had by its name.
//!
//! Every problem has a module that gives the equation, its discretisation, where it comes from and
//! what is known of it. An [`Entry`] carries the defaults and the known special points as data; a
//! [`Visitor`] does with any of them what it likes, without naming one. Nothing but the public
//! interface of [`continuation`] is used.
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! let column = problems::find("euler-column").ok_or("no such problem")?;
//! let mut request = column.request();
//! request.settings.target = Some(9.5);
//! let branch = column.trace(&request, &mut |_| ControlFlow::Continue(()))?;
//! assert!(branch.stopped.reason.is_complete());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod ab;
pub mod abc;
pub mod arch;
pub mod bratu;
pub mod brusselator;
pub mod chan;
pub mod co_oxidation;
pub mod crossings;
pub mod cusp;
mod entry;
pub mod enz;
pub mod euler_column;
pub mod fitzhugh_nagumo;
mod grid;
pub mod jkr;
pub mod lorenz;
pub mod mittelmann;
pub mod ode;
pub mod plp;
pub mod pp2;
pub mod ppp;
pub mod pressurised_sphere;
pub mod roessler;
pub mod snaking;
pub mod swift_hohenberg;
pub mod van_der_pol;
mod visit;

pub use entry::{Allowed, Constant, Elements, Entry, Known, On, ProblemError, Request};
pub use visit::{Observer, Setup, Visitor};

/// All problems of the catalogue, by name.
pub fn catalogue() -> &'static [&'static Entry] {
    &ENTRIES
}

/// The problem of this name.
pub fn find(name: &str) -> Option<&'static Entry> {
    ENTRIES.into_iter().find(|entry| entry.name == name)
}

/// One table: the entry, what identifies it, what builds it.
macro_rules! entries {
    ($count:literal: $($id:ident, $entry:path, $visit:path;)*) => {
        static ENTRIES: [&Entry; $count] = [$(&$entry),*];

        /// Which problem an entry is.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum Id {
            $(
                #[doc = stringify!($entry)]
                $id,
            )*
        }

        impl Id {
            /// Builds the problem and hands it to the visitor.
            fn visit<V: Visitor>(
                self,
                request: &Request,
                visitor: V,
            ) -> Result<V::Output, ProblemError> {
                match self {
                    $(Id::$id => $visit(request, visitor),)*
                }
            }
        }
    };
}

entries! { 25:
    Ab, ab::ENTRY, ab::visit;
    Abc, abc::ENTRY, abc::visit;
    Bratu, bratu::ENTRY, bratu::visit;
    Brusselator, brusselator::ENTRY, brusselator::visit;
    Chan, chan::ENTRY, chan::visit;
    CoOxidation, co_oxidation::ENTRY, co_oxidation::visit;
    Cusp, cusp::ENTRY, cusp::visit;
    Enz, enz::ENTRY, enz::visit;
    EulerColumn, euler_column::ENTRY, euler_column::visit;
    FitzHughNagumo, fitzhugh_nagumo::ENTRY, fitzhugh_nagumo::visit;
    JkrGrip, jkr::GRIP_ENTRY, jkr::grip;
    JkrLoad, jkr::LOAD_ENTRY, jkr::load;
    Lorenz, lorenz::ENTRY, lorenz::visit;
    Mittelmann, mittelmann::ENTRY, mittelmann::visit;
    Pitchfork, crossings::PITCHFORK, crossings::pitchfork;
    Plp, plp::ENTRY, plp::visit;
    Pp2, pp2::ENTRY, pp2::visit;
    Ppp, ppp::ENTRY, ppp::visit;
    PressurisedSphere, pressurised_sphere::ENTRY, pressurised_sphere::visit;
    Roessler, roessler::ENTRY, roessler::visit;
    ShallowArch, arch::ENTRY, arch::visit;
    SwiftHohenberg, swift_hohenberg::ENTRY, swift_hohenberg::visit;
    Snaking, snaking::ENTRY, snaking::visit;
    Transcritical, crossings::TRANSCRITICAL, crossings::transcritical;
    VanDerPol, van_der_pol::ENTRY, van_der_pol::visit;
}
