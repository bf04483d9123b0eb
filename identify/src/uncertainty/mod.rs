//! How well a fit knows what it says.
//!
//! The covariance is that of the linearised problem, priors included, widened by `χ²/dof` and by the
//! autocorrelation of the residuals where these exceed what white noise of the assumed size has. The lever's
//! stiffness is not fitted: it is a quantity to consider. The estimate is the one at its nominal value, and
//! its uncertainty is carried over by `dx/d ln K = −N⁻¹ Jᵀ W J_K`.
//!
//! Where the parabola is not to be trusted the profile is computed ([`profile`]): the least cost with one
//! combination held.

pub mod profile;
pub mod verdict;

use crate::error::FitError;
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
    /// Covariance of the free coordinates, priors included, widened; what is at a bound has none.
    pub covariance: DMatrix<f64>,
    /// `dx/d ln K`.
    pub by_lever: DVector<f64>,
    /// Relative standard deviation of the lever's stiffness that is carried over.
    pub lever_sd: f64,
    /// Condition number of the normal matrix, scaled to a unit diagonal.
    pub condition: f64,
    /// By what variances were widened.
    pub widened: f64,
    /// `χ²` over degrees of freedom.
    pub chi2_dof: f64,
    /// Autocorrelation of the residuals at the next sample.
    pub autocorrelation: f64,
    /// Which coordinates are at a bound.
    pub at_bound: Vec<bool>,
}

impl Linear {
    /// Standard deviations of a combination: of the data and priors, and of the lever.
    pub fn sd(&self, along: &DVector<f64>) -> (f64, f64) {
        let own = along.dot(&(&self.covariance * along)).max(0.0).sqrt();
        (own, (along.dot(&self.by_lever) * self.lever_sd).abs())
    }

    /// The covariance with the lever's part.
    pub fn total(&self) -> DMatrix<f64> {
        let variance = self.lever_sd * self.lever_sd;
        &self.covariance + &self.by_lever * self.by_lever.transpose() * variance
    }
}

/// Autocorrelation below which residuals count as white.
pub const WHITE: f64 = 0.12;

/// Computes it.
///
/// # Errors
/// When the model has no value at the minimum.
pub fn linear(fitted: &Fitted<'_>, spring_constant_sd: f64) -> Result<Linear, FitError> {
    let objective = &fitted.objective;
    let n = objective.free.len();
    let best = &fitted.best;
    let p = objective.parameters(&best.x);
    let mut at_bound = vec![false; n];
    for (k, (low, high)) in objective.bounds.iter().enumerate() {
        let width = 1e-6 * (high - low).min(1e6);
        at_bound[k] = best.x[k] <= low + width || best.x[k] >= high - width;
    }
    let inner: Vec<usize> = (0..n).filter(|k| !at_bound[*k]).collect();
    let m = inner.len();
    let scale: Vec<f64> =
        inner.iter().map(|&k| best.at.normal[(k, k)].sqrt().max(f64::MIN_POSITIVE)).collect();
    let scaled =
        DMatrix::from_fn(m, m, |i, j| best.at.normal[(inner[i], inner[j])] / (scale[i] * scale[j]));
    let eigen = SymmetricEigen::new(scaled);
    let largest = eigen.eigenvalues.iter().fold(0.0_f64, |m, x| m.max(*x));
    let least = eigen.eigenvalues.iter().fold(f64::INFINITY, |m, x| m.min(*x));
    // directions that nothing is known of have a variance of 1e14 of their scale, not infinity
    let floor = 1e-14 * largest;
    let used = objective.count();
    let (autocorrelation, scatter) = residuals(fitted);
    let dof = used.saturating_sub(m).max(1) as f64;
    let chi2_dof = scatter / dof;
    let correlated = if autocorrelation > WHITE {
        (1.0 + autocorrelation) / (1.0 - autocorrelation.min(0.98))
    } else {
        1.0
    };
    let widened = chi2_dof.max(1.0) * correlated;
    let mut covariance = DMatrix::zeros(n, n);
    for i in 0..m {
        for j in 0..m {
            let mut sum = 0.0;
            for k in 0..m {
                let (v, l) = (&eigen.eigenvectors, eigen.eigenvalues[k].max(floor));
                sum += v[(i, k)] * v[(j, k)] / l;
            }
            covariance[(inner[i], inner[j])] = widened * sum / (scale[i] * scale[j]);
        }
    }
    let mut by_lever = DVector::zeros(n);
    let considered = !objective.free.contains(&Key::SpringConstant) && spring_constant_sd > 0.0;
    if considered {
        let mut keys = objective.free.clone();
        keys.push(Key::SpringConstant);
        let weight = 1.0 / objective.noise;
        let prediction =
            objective.model.predict(objective.curve, &fitted.branch, &p, &keys, weight);
        let mut pull = DVector::zeros(n);
        for i in (0..objective.used.len()).filter(|i| objective.used[*i]) {
            let row = &prediction.by_key[i * (n + 1)..(i + 1) * (n + 1)];
            for k in 0..n {
                pull[k] += weight * weight * row[k] * row[n];
            }
        }
        by_lever = -(&covariance * pull) / widened;
    }
    Ok(Linear {
        covariance,
        by_lever,
        lever_sd: if considered { spring_constant_sd } else { 0.0 },
        condition: if least > 0.0 { largest / least } else { f64::INFINITY },
        widened,
        chi2_dof,
        autocorrelation,
        at_bound,
    })
}

/// Autocorrelation of the weighted residuals at the next sample, and their sum of squares (or of soft-L1).
fn residuals(fitted: &Fitted<'_>) -> (f64, f64) {
    let objective = &fitted.objective;
    let mut first = 0;
    let (mut product, mut square) = (0.0, 0.0);
    for segment in &objective.curve.segments {
        let mut last: Option<f64> = None;
        for (i, y) in segment.force.iter().enumerate() {
            if !objective.used[first + i] {
                last = None;
                continue;
            }
            let r = ((y - fitted.best.at.prediction.force[first + i]) / objective.noise)
                .clamp(-4.0, 4.0);
            if let Some(last) = last {
                product += last * r;
            }
            square += r * r;
            last = Some(r);
        }
        first += segment.force.len();
    }
    (if square > 0.0 { product / square } else { 0.0 }, fitted.best.at.chi2)
}
