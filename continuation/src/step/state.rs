//! A solution with its tangent and everything that events are read from.

use serde::{Deserialize, Serialize};

/// A solution on the branch. Storage is allocated once and reused.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// Unknowns.
    pub(crate) u: Vec<f64>,
    /// Continued parameter.
    pub(crate) p: f64,
    /// Unknowns' part of the tangent, of unit length in the scaled metric.
    pub(crate) tu: Vec<f64>,
    /// Parameter's part of the tangent.
    pub(crate) tp: f64,
    /// `M tu`.
    pub(crate) mtu: Vec<f64>,
    /// Length of the tangent in the problem's metric.
    pub(crate) length: f64,
    /// Sign of the determinant of the Jacobian bordered by the tangent.
    pub(crate) orientation: i8,
    /// Number of unstable modes.
    pub(crate) unstable: Option<usize>,
    /// Number of eigenvalues on the unstable side, also where the problem does not call them so.
    pub(crate) count: Option<usize>,
    /// Whether that number is certain.
    pub(crate) certified: bool,
    /// The eigenvalues asked for.
    pub(crate) eigenvalues: Vec<(f64, f64)>,
    /// Real part of the complex pair of eigenvalues nearest to the imaginary axis; NaN without
    /// one, or where the spectrum is not known.
    pub(crate) pair: f64,
    /// Its imaginary part.
    pub(crate) frequency: f64,
    /// Number of unstable complex pairs, where the spectrum is known.
    pub(crate) unstable_pairs: usize,
    /// Whether an eigenvalue lies on the border of stability to rounding: the state is a special
    /// point itself.
    pub(crate) critical: bool,
    /// Real eigenvalue nearest to zero; NaN without one, or where the spectrum is not known.
    pub(crate) real: f64,
    /// Reciprocal of the real eigenvalue farthest from zero, 0 where there is none: passes zero where
    /// an eigenvalue passes infinity. NaN where the spectrum is not known.
    #[serde(default)]
    pub(crate) far: f64,
    /// Number of complex pairs, where the spectrum is known.
    pub(crate) pairs: usize,
    /// Observables.
    pub(crate) values: Vec<f64>,
    /// Derivatives of the observables along the tangent (per scaled arclength).
    pub(crate) slopes: Vec<f64>,
}

impl State {
    pub(crate) fn new(n: usize, observables: usize) -> Self {
        State {
            u: vec![0.0; n],
            p: 0.0,
            tu: vec![0.0; n],
            tp: 0.0,
            mtu: vec![0.0; n],
            length: 1.0,
            orientation: 0,
            unstable: None,
            count: None,
            certified: false,
            eigenvalues: Vec::new(),
            pair: f64::NAN,
            frequency: f64::NAN,
            real: f64::NAN,
            far: f64::NAN,
            pairs: 0,
            unstable_pairs: 0,
            critical: false,
            values: vec![0.0; observables],
            slopes: vec![0.0; observables],
        }
    }

    /// Copies without allocating.
    pub(crate) fn copy_from(&mut self, other: &State) {
        self.u.copy_from_slice(&other.u);
        self.tu.copy_from_slice(&other.tu);
        self.mtu.copy_from_slice(&other.mtu);
        self.values.copy_from_slice(&other.values);
        self.slopes.copy_from_slice(&other.slopes);
        self.p = other.p;
        self.tp = other.tp;
        self.length = other.length;
        self.orientation = other.orientation;
        self.unstable = other.unstable;
        self.count = other.count;
        self.certified = other.certified;
        self.eigenvalues.clone_from(&other.eigenvalues);
        self.pair = other.pair;
        self.frequency = other.frequency;
        self.real = other.real;
        self.far = other.far;
        self.pairs = other.pairs;
        self.unstable_pairs = other.unstable_pairs;
        self.critical = other.critical;
    }

    /// Multiplies the tangent, and all that is measured along it.
    pub(crate) fn scale_tangent(&mut self, factor: f64) {
        self.tu.iter_mut().for_each(|x| *x *= factor);
        self.mtu.iter_mut().for_each(|x| *x *= factor);
        self.slopes.iter_mut().for_each(|x| *x *= factor);
        self.tp *= factor;
        self.length *= factor.abs();
    }
}
