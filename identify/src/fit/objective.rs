//! What a fit makes small: weighted residuals, and what is known beforehand.
//!
//! ```text
//! 2 Φ = 1/w Σ_i ρ((y_i − F_i)²/σ²) + Σ_k ((x_k − m_k)/s_k)²
//! ```
//!
//! `ρ(t) = t`, or soft-L1 `2c²(√(1 + t/c²) − 1)` when robust. Priors are normal in the coordinate (the
//! logarithm, for positive quantities). `w ≥ 1` is by how much the variance of the data exceeds `σ²`, as
//! their residuals tell: it weakens what the data say, and not what was known beforehand.

use super::guide::{self, Guide};
use crate::attend::Attended;
use crate::data::Curve;
use crate::error::ModelError;
use crate::lever::LeverBranch;
use crate::model::{Model, Prediction};
use crate::parameters::{Key, Parameters};
use crate::uncertainty::{Derived, Quantity};
use nalgebra::{DMatrix, DVector};
use shell_contact::Resolution;

/// Knowledge of a quantity beforehand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Of what.
    pub key: Key,
    /// Its value, SI.
    pub value: f64,
    /// Standard deviation, SI.
    pub sd: f64,
}

impl Prior {
    /// Centre and standard deviation in the coordinate.
    pub fn in_coordinate(&self) -> (f64, f64) {
        (self.key.coordinate(self.value), self.sd / self.key.slope(self.value))
    }
}

/// Knowledge beforehand of what follows from the moduli, such as Young's modulus: normal in its logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DerivedPrior {
    /// Of what.
    pub of: Derived,
    /// Its value, SI.
    pub value: f64,
    /// Standard deviation, SI.
    pub sd: f64,
}

impl DerivedPrior {
    /// By how many standard deviations the parameters miss it.
    pub fn pull(&self, p: &Parameters) -> f64 {
        let value = Quantity::Derived(self.of).value(p);
        (value / self.value).ln() / self.relative_sd()
    }

    /// Standard deviation of the logarithm.
    pub fn relative_sd(&self) -> f64 {
        self.sd / self.value
    }
}

/// Where soft-L1 turns from squares to absolute values, in standard deviations.
const SOFT: f64 = 2.0;

/// A fit's problem.
#[derive(Debug, Clone)]
pub struct Objective<'a> {
    /// The curve.
    pub curve: &'a Curve,
    /// Samples that count.
    pub used: Vec<bool>,
    /// Noise of the force, N.
    pub noise: f64,
    /// `w`: the factor on its variance that the residuals call for ([`Objective::residuals`]).
    pub widened: f64,
    /// The model.
    pub model: Model,
    /// Values of all that is not free.
    pub base: Parameters,
    /// What is looked for.
    pub free: Vec<Key>,
    /// What is known of it.
    pub priors: Vec<Prior>,
    /// What is known of what follows from the moduli.
    pub derived: Vec<DerivedPrior>,
    /// Who waits.
    pub attended: Attended<'a>,
    /// Bounds, in the coordinates, of what is free.
    pub bounds: Vec<(f64, f64)>,
    /// Soft-L1 in place of squares.
    pub robust: bool,
    /// Jumps that lead a search.
    pub guide: Option<Guide>,
}

/// The objective at a place.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// `2Φ`.
    pub cost: f64,
    /// The sum over the data, before it is divided by `w`.
    pub chi2: f64,
    /// `JᵀJ/w` over the coordinates, priors included.
    pub normal: DMatrix<f64>,
    /// `Jᵀr/w`, with `r = (F − y)/σ`: half the gradient of the cost.
    pub gradient: DVector<f64>,
    /// The model at every sample.
    pub prediction: Prediction,
    /// The branch, and how well its mesh resolves it; none where the sums are those of another one.
    pub branch: Option<(LeverBranch, Resolution)>,
}

/// Autocorrelation below which residuals count as white.
pub const WHITE: f64 = 0.12;

/// Size and colour of the residuals of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residuals {
    /// `χ²` over degrees of freedom.
    pub chi2_dof: f64,
    /// Autocorrelation at the next sample.
    pub autocorrelation: f64,
}

impl Residuals {
    /// By what the variance of the data exceeds that of white noise of the assumed size.
    pub fn widened(&self) -> f64 {
        let correlated = if self.autocorrelation > WHITE {
            (1.0 + self.autocorrelation) / (1.0 - self.autocorrelation.min(0.98))
        } else {
            1.0
        };
        self.chi2_dof.max(1.0) * correlated
    }
}

impl Objective<'_> {
    /// The parameters at a place.
    pub fn parameters(&self, x: &DVector<f64>) -> Parameters {
        let mut p = self.base;
        for (key, x) in self.free.iter().zip(x.iter()) {
            p[*key] = key.value(*x);
        }
        p
    }

    /// The place of parameters.
    pub fn place(&self, p: &Parameters) -> DVector<f64> {
        DVector::from_iterator(self.free.len(), self.free.iter().map(|key| key.coordinate(p[*key])))
    }

    /// The nearest place within the bounds.
    pub fn clamp(&self, x: &mut DVector<f64>) {
        for (x, (low, high)) in x.iter_mut().zip(&self.bounds) {
            *x = x.clamp(*low, *high);
        }
    }

    /// Number of samples that count.
    pub fn count(&self) -> usize {
        self.used.iter().filter(|u| **u).count()
    }

    /// Cost, gradient and normal matrix.
    ///
    /// # Errors
    /// When the model has no value there.
    pub fn evaluate(&self, x: &DVector<f64>) -> Result<Evaluation, ModelError> {
        let p = self.parameters(x);
        let branch = self.model.branch_attended(self.curve, &p, &self.free, self.attended)?;
        Ok(self.evaluate_on(x, branch))
    }

    /// The same on a branch that was traced there.
    pub fn evaluate_on(
        &self,
        x: &DVector<f64>,
        (branch, resolution): (LeverBranch, Resolution),
    ) -> Evaluation {
        let mut evaluation = self.of_data(&branch, &self.parameters(x));
        self.add_priors(x, &mut evaluation);
        evaluation.branch = Some((branch, resolution));
        evaluation
    }

    /// What the data say of parameters, on their branch.
    pub fn of_data(&self, branch: &LeverBranch, p: &Parameters) -> Evaluation {
        let Some(guide) = &self.guide else {
            let weight = 1.0 / self.noise;
            return self.sum(self.model.predict(self.curve, branch, p, &self.free, weight));
        };
        let guided = guide.pair(self.curve, branch, p, &self.free, self.noise);
        let prediction = self.model.predict_on(self.curve, branch, p, &self.free, guided.way);
        let mut evaluation = self.sum(prediction);
        evaluation.cost += guided.cost;
        for (residual, by_key) in guided.folds {
            evaluation.cost += residual * residual;
            let row = DVector::from_vec(by_key);
            evaluation.gradient += &row * residual;
            evaluation.normal += &row * row.transpose();
        }
        evaluation
    }

    /// The sums over the samples.
    pub fn sum(&self, prediction: Prediction) -> Evaluation {
        let n = self.free.len();
        let weight = 1.0 / self.noise;
        let mut normal = DMatrix::zeros(n, n);
        let mut gradient = DVector::zeros(n);
        let mut chi2 = 0.0;
        let contact = self.free.iter().position(|key| *key == Key::Contact);
        let measured = self.curve.segments.iter().flat_map(|s| &s.force);
        for (i, y) in measured.enumerate() {
            if !self.used[i] {
                continue;
            }
            let row = &prediction.by_key[i * n..(i + 1) * n];
            let mut off = prediction.force[i] - y;
            let mut weight = weight;
            if let Some(guide) = &self.guide {
                let slope = contact.map_or(0.0, |k| row[k]);
                weight = guide.weight(self.noise, slope);
                if prediction.beyond[i] != 0.0 {
                    // as at the end of the stretch: what moves it is the residual of the fold
                    off -= self.model.nominal_spring_constant * prediction.beyond[i];
                    chi2 += (weight * off).powi(2).min(guide::UNREACHED * guide::UNREACHED);
                    continue;
                }
            }
            let r = weight * off;
            let (rho, w) = self.loss(r);
            chi2 += rho;
            let w = w / self.widened;
            let w2 = w * weight * weight;
            for a in 0..n {
                gradient[a] += w * weight * r * row[a];
                for b in 0..=a {
                    normal[(a, b)] += w2 * row[a] * row[b];
                }
            }
        }
        for a in 0..n {
            for b in 0..a {
                normal[(b, a)] = normal[(a, b)];
            }
        }
        let cost = chi2 / self.widened;
        Evaluation { cost, chi2, normal, gradient, prediction, branch: None }
    }

    /// What the residuals at a place say of the noise.
    pub fn residuals(&self, at: &Evaluation) -> Residuals {
        let mut first = 0;
        let (mut product, mut square) = (0.0, 0.0);
        for segment in &self.curve.segments {
            let mut last: Option<f64> = None;
            for (i, y) in segment.force.iter().enumerate() {
                if !self.used[first + i] {
                    last = None;
                    continue;
                }
                let r = ((y - at.prediction.force[first + i]) / self.noise).clamp(-4.0, 4.0);
                if let Some(last) = last {
                    product += last * r;
                }
                square += r * r;
                last = Some(r);
            }
            first += segment.force.len();
        }
        let dof = self.count().saturating_sub(self.free.len()).max(1) as f64;
        let autocorrelation = if square > 0.0 { product / square } else { 0.0 };
        Residuals { chi2_dof: at.chi2 / dof, autocorrelation }
    }

    /// `ρ(r²)` and its slope.
    fn loss(&self, r: f64) -> (f64, f64) {
        if !self.robust {
            return (r * r, 1.0);
        }
        let root = (1.0 + r * r / (SOFT * SOFT)).sqrt();
        (2.0 * SOFT * SOFT * (root - 1.0), 1.0 / root)
    }

    /// Adds what is known beforehand.
    pub(crate) fn add_priors(&self, x: &DVector<f64>, e: &mut Evaluation) {
        for prior in &self.priors {
            let Some(k) = self.free.iter().position(|key| *key == prior.key) else { continue };
            let (centre, sd) = prior.in_coordinate();
            let miss = (x[k] - centre) / sd;
            e.cost += miss * miss;
            e.gradient[k] += miss / sd;
            e.normal[(k, k)] += 1.0 / (sd * sd);
        }
        for prior in &self.derived {
            let Some(along) = Quantity::Derived(prior.of).along(&self.free) else { continue };
            let (miss, sd) = (prior.pull(&self.parameters(x)), prior.relative_sd());
            e.cost += miss * miss;
            e.gradient += &along * (miss / sd);
            e.normal += &along * along.transpose() / (sd * sd);
        }
    }
}
