//! How well a fit knows what it says.
//!
//! The covariance is that of the linearised problem, priors included, with the data's part widened by `χ²/dof`
//! and by the autocorrelation of the residuals where these exceed what white noise of the assumed size has. The
//! lever's stiffness is one of the unknowns, with its calibration as prior.
//!
//! Where the parabola is not to be trusted the profile is computed ([`profile`]): the least cost with one
//! combination held.

pub mod profile;
pub mod verdict;

use crate::fit::Fitted;
use crate::parameters::{Key, Parameters};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// What is reported beside what is fitted: combinations of the logarithms of the moduli.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derived {
    /// Young's modulus of the homogeneous shell, `ln E = 3/2 ln χ − 1/2 ln k_b + …`.
    Young,
    /// Its thickness, `ln h = 1/2 ln k_b − 1/2 ln χ + …`.
    Thickness,
    /// `√(χ k_b)`, which the slope of the first contact fixes.
    ForceScale,
}

/// What a number in the report is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A fitted parameter.
    Key(Key),
    /// A combination.
    Derived(Derived),
}

impl Quantity {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Key(key) => key.name(),
            Quantity::Derived(Derived::Young) => "young",
            Quantity::Derived(Derived::Thickness) => "thickness",
            Quantity::Derived(Derived::ForceScale) => "sqrt_chi_kb",
        }
    }

    /// The quantity of that name.
    pub fn of(name: &str) -> Option<Quantity> {
        [Derived::Young, Derived::Thickness, Derived::ForceScale]
            .into_iter()
            .map(Quantity::Derived)
            .chain(Key::ALL.into_iter().map(Quantity::Key))
            .find(|q| q.name() == name)
    }

    /// Its SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::Key(key) => key.unit(),
            Quantity::Derived(Derived::Young) => "Pa",
            Quantity::Derived(Derived::Thickness) => "m",
            Quantity::Derived(Derived::ForceScale) => "N",
        }
    }

    /// Its value.
    pub fn value(self, p: &Parameters) -> f64 {
        match self {
            Quantity::Key(key) => p[key],
            Quantity::Derived(Derived::Young) => p.young(),
            Quantity::Derived(Derived::Thickness) => p.thickness(),
            Quantity::Derived(Derived::ForceScale) => p.force_scale(),
        }
    }

    /// Whether its coordinate is its logarithm.
    pub fn is_logarithmic(self) -> bool {
        match self {
            Quantity::Key(key) => key.is_logarithmic(),
            Quantity::Derived(_) => true,
        }
    }

    /// The value that lies `offset` away in the coordinate.
    pub fn shifted(self, value: f64, offset: f64) -> f64 {
        if self.is_logarithmic() { value * offset.exp() } else { value + offset }
    }

    /// Its coordinate as a combination of the free ones; `None` when nothing of it is free.
    pub fn along(self, free: &[Key]) -> Option<DVector<f64>> {
        let mut along = DVector::zeros(free.len());
        let mut add = |key: Key, amount: f64| {
            if let Some(k) = free.iter().position(|f| *f == key) {
                along[k] += amount;
            }
        };
        let (chi, bending) = match self {
            Quantity::Key(key) => {
                add(key, 1.0);
                (0.0, 0.0)
            }
            Quantity::Derived(Derived::Young) => (1.5, -0.5),
            Quantity::Derived(Derived::Thickness) => (-0.5, 0.5),
            Quantity::Derived(Derived::ForceScale) => (0.5, 0.5),
        };
        add(Key::Chi, chi);
        add(Key::Bending, bending);
        along.iter().any(|a| *a != 0.0).then_some(along)
    }
}

/// The linearised uncertainty of a fit.
#[derive(Debug, Clone)]
pub struct Linear {
    /// Covariance of the free coordinates, priors included; what is at a bound has none.
    pub covariance: DMatrix<f64>,
    /// Condition number of the normal matrix, scaled to a unit diagonal.
    pub condition: f64,
    /// Which coordinates are at a bound.
    pub at_bound: Vec<bool>,
    /// Which coordinate is the lever's stiffness, if it is free.
    lever: Option<usize>,
}

impl Linear {
    /// Standard deviation of a combination.
    pub fn sd(&self, along: &DVector<f64>) -> f64 {
        along.dot(&(&self.covariance * along)).max(0.0).sqrt()
    }

    /// What would be left of it if the lever's stiffness were known exactly.
    pub fn sd_at_known_lever(&self, along: &DVector<f64>) -> f64 {
        let of_lever = self.lever.map_or(0.0, |k| {
            let variance = self.covariance[(k, k)];
            let shared = self.covariance.column(k).dot(along);
            if variance > 0.0 { shared * shared / variance } else { 0.0 }
        });
        (self.sd(along).powi(2) - of_lever).max(0.0).sqrt()
    }
}

/// Computes it.
pub fn linear(fitted: &Fitted<'_>) -> Linear {
    let objective = &fitted.objective;
    let n = objective.free.len();
    let best = &fitted.best;
    let mut at_bound = vec![false; n];
    for (k, (low, high)) in objective.bounds.iter().enumerate() {
        let width = 1e-6 * (high - low).min(1e6);
        at_bound[k] = best.x[k] <= low + width || best.x[k] >= high - width;
    }
    let inner: Vec<usize> = (0..n).filter(|k| !at_bound[*k]).collect();
    let (inverse, condition) = inverse(&best.at.normal, &inner);
    let lever = objective.free.iter().position(|key| *key == Key::SpringConstant);
    Linear { covariance: inverse, condition, at_bound, lever }
}

/// Inverse of a normal matrix over the coordinates `inner`, zero elsewhere, and its condition number when it is
/// scaled to a unit diagonal. Directions that nothing is known of have a variance of 1e14 of their scale, not
/// infinity.
pub(crate) fn inverse(normal: &DMatrix<f64>, inner: &[usize]) -> (DMatrix<f64>, f64) {
    let (n, m) = (normal.nrows(), inner.len());
    let scale: Vec<f64> =
        inner.iter().map(|&k| normal[(k, k)].sqrt().max(f64::MIN_POSITIVE)).collect();
    let scaled =
        DMatrix::from_fn(m, m, |i, j| normal[(inner[i], inner[j])] / (scale[i] * scale[j]));
    let eigen = SymmetricEigen::new(scaled);
    let largest = eigen.eigenvalues.iter().fold(0.0_f64, |m, x| m.max(*x));
    let least = eigen.eigenvalues.iter().fold(f64::INFINITY, |m, x| m.min(*x));
    let floor = 1e-14 * largest;
    let mut inverse = DMatrix::zeros(n, n);
    for i in 0..m {
        for j in 0..m {
            let mut sum = 0.0;
            for k in 0..m {
                let (v, l) = (&eigen.eigenvectors, eigen.eigenvalues[k].max(floor));
                sum += v[(i, k)] * v[(j, k)] / l;
            }
            inverse[(inner[i], inner[j])] = sum / (scale[i] * scale[j]);
        }
    }
    (inverse, if least > 0.0 { largest / least } else { f64::INFINITY })
}
