use continuation::linalg::{Matrix, SymmetricBand};
use continuation::{EvalError, Name, ParamId, Parameter, Problem, Stability, names};

/// A column of length 1 whose ends stay vertical: −θ″ = λ sin θ, θ(0) = θ(1) = 0, with `n` interior
/// nodes. Energy: Σ (θ_{i+1} − θ_i)² / (2h) + λ h Σ cos θ_i.
pub struct Column {
    pub n: usize,
}

impl Column {
    fn h(&self) -> f64 {
        1.0 / (self.n as f64 + 1.0)
    }
}

static PARAMETERS: [Parameter; 1] = [Parameter::new("load", "", 10.0)];

impl Problem for Column {
    type Jacobian = SymmetricBand;

    fn dim(&self) -> usize {
        self.n
    }

    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }

    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.n, 1)
    }

    // the gradient of the energy
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let h = self.h();
        let at = |i: usize| if i == 0 || i > self.n { 0.0 } else { u[i - 1] };
        for i in 1..=self.n {
            r[i - 1] = (2.0 * at(i) - at(i - 1) - at(i + 1)) / h - p[0] * h * at(i).sin();
        }
        Ok(())
    }

    // its Hessian; `j` still holds the entries of the last call
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        let h = self.h();
        j.set_zero();
        for i in 0..self.n {
            j.add(i, i, 2.0 / h - p[0] * h * u[i].cos());
            if i > 0 {
                j.add(i, i - 1, -1.0 / h); // and its mirror image
            }
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        for (o, u) in out.iter_mut().zip(u) {
            *o = -self.h() * u.sin();
        }
        Ok(())
    }

    // |θ|² = ∫ θ² ds, on every mesh the same
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        for (y, x) in y.iter_mut().zip(x) {
            *y = self.h() * x;
        }
    }

    // negative eigenvalues of the Hessian are unstable
    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    fn observables(&self) -> &[Name] {
        names!["angle", "sway", "height"]
    }

    // the angle at the middle; how far the upper end moves sideways; how high it stands
    fn observe(&self, u: &[f64], _: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out[0] = u[self.n / 2];
        out[1] = self.h() * u.iter().map(|u| u.sin()).sum::<f64>();
        out[2] = self.h() * (1.0 + u.iter().map(|u| u.cos()).sum::<f64>());
        Ok(())
    }
}
