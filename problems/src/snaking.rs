//! Homoclinic snaking of the Swift-Hohenberg equation with nonlinearities of order 3 and 5:
//!
//! ```text
//! 0 = ru − (1 + ∂²)²u + 2u³ − u⁵  on [0, 20π],   u′ = u‴ = 0 at both ends
//! ```
//! (Burke & Knobloch, *Phys. Lett. A* 360 (2007) 681.) A localised pattern grows by a wave with
//! every pair of folds, between `r = −0.6267844628` (right) and `−0.7126459377` (left), on which the
//! folds settle exponentially. The first ones: −0.70045886570, −0.62596230188, −0.71242164638,
//! −0.62677580719, −0.71264227842, −0.62678437139 (fourth-order collocation in AUTO-07p). The trace
//! starts from the weakly nonlinear solution `√(−4r/3) sech(√(−r)x/2) cos x` and ends when the
//! pattern is about to fill the interval.
//!
//! **Discretisation.** Central differences of order `2M` on nodes that include both ends, `u`
//! continued evenly. `W(1 + ∂²)²`, with the trapezoid weights `W`, is then symmetric; everything is
//! multiplied by `W`.

use crate::visit::hand;
use crate::{Allowed, Elements, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, Name, ParamId, Parameter, Problem, Stability, Watch, names};
use std::f64::consts::PI;

/// Half width `M` of the difference formula.
const HALF_WIDTH: usize = 6;
/// Length of the interval.
const LENGTH: f64 = 20.0 * PI;

/// See the module.
#[derive(Debug, Clone)]
pub struct Snaking {
    h: f64,
    weights: Vec<f64>,
    stencil: [f64; HALF_WIDTH + 1],
    /// `W(1 + ∂²)²`.
    operator: SymmetricBand,
}

static PARAMETERS: [Parameter; 1] = [Parameter::new("r", "", 0.1)];

/// `1 + ∂²` by central differences of order `2M`: the middle coefficient and those to either side,
/// `2(−1)^{k+1}(M!)²/(k²(M − k)!(M + k)!h²)`.
fn stencil(h: f64) -> [f64; HALF_WIDTH + 1] {
    let mut c = [0.0; HALF_WIDTH + 1];
    let mut ratio = 1.0;
    for k in 1..=HALF_WIDTH {
        // (M!)²/((M − k)!(M + k)!)
        ratio *= (HALF_WIDTH - k + 1) as f64 / (HALF_WIDTH + k) as f64;
        let sign = if k % 2 == 1 { 2.0 } else { -2.0 };
        c[k] = sign * ratio / ((k * k) as f64 * h * h);
    }
    c[0] = 1.0 - 2.0 * c[1..].iter().sum::<f64>();
    c
}

/// The node that node `i` is the mirror image of, if it lies beyond an end.
fn reflect(i: isize, last: usize) -> usize {
    let i = i.unsigned_abs();
    if i > last { 2 * last - i } else { i }
}

impl Snaking {
    /// With `intervals` between the nodes, at least as many as the difference formula is wide.
    pub fn new(intervals: usize) -> Self {
        let intervals = intervals.max(2 * HALF_WIDTH);
        let (n, h) = (intervals + 1, LENGTH / intervals as f64);
        let mut weights = vec![h; n];
        weights[0] = 0.5 * h;
        weights[n - 1] = 0.5 * h;
        let c = stencil(h);
        let mut operator = SymmetricBand::new(n, 2 * HALF_WIDTH);
        // W(1 + ∂²)² = (1 + ∂²)ᵀW(1 + ∂²), row by row
        let wide = HALF_WIDTH as isize;
        for (k, weight) in weights.iter().enumerate() {
            let at =
                |offset: isize| (reflect(k as isize + offset, intervals), c[offset.unsigned_abs()]);
            for (i, a) in (-wide..=wide).map(at) {
                for (j, b) in (-wide..=wide).map(at).filter(|(j, _)| *j <= i) {
                    operator.add(i, j, weight * a * b);
                }
            }
        }
        Snaking { h, weights, stencil: c, operator }
    }

    /// `(1 + ∂²)u` at node `i`, from differences: a smooth `u` loses no digits to the spacing.
    #[inline]
    fn helmholtz(&self, u: impl Fn(usize) -> f64, i: usize) -> f64 {
        let last = self.weights.len() - 1;
        let mut sum = u(i);
        for k in (1..=HALF_WIDTH).rev() {
            let (left, right) = if i >= k && i + k <= last {
                (u(i - k), u(i + k))
            } else {
                let (i, k) = (i as isize, k as isize);
                (u(reflect(i - k, last)), u(reflect(i + k, last)))
            };
            sum += self.stencil[k] * ((right - u(i)) + (left - u(i)));
        }
        sum
    }

    /// The weakly nonlinear localised solution at `r < 0`.
    pub fn guess(&self, r: f64) -> Vec<f64> {
        let (amplitude, decay) = ((-4.0 * r / 3.0).sqrt(), 0.5 * (-r).sqrt());
        let x = (0..self.weights.len()).map(|i| i as f64 * self.h);
        x.map(|x| amplitude / (decay * x).cosh() * x.cos()).collect()
    }
}

impl Problem for Snaking {
    type Jacobian = SymmetricBand;

    fn dim(&self) -> usize {
        self.weights.len()
    }

    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }

    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.dim(), 2 * HALF_WIDTH)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        for (i, r) in r.iter_mut().enumerate() {
            *r = self.helmholtz(|j| u[j], i);
        }
        // (1 + ∂²)u, of which `behind` keeps the values that r has lost, the nearest first
        let mut behind = [0.0; HALF_WIDTH];
        for (i, u) in u.iter().enumerate() {
            let v = |j: usize| if j >= i { r[j] } else { behind[i - j - 1] };
            let applied = self.helmholtz(v, i);
            behind.rotate_right(1);
            behind[0] = r[i];
            let square = u * u;
            let growth = u * (p[0] + square * (2.0 - square));
            r[i] = self.weights[i] * (growth - applied);
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        j.set_zero();
        j.axpy(-1.0, &self.operator);
        for (i, (u, w)) in u.iter().zip(&self.weights).enumerate() {
            let square = u * u;
            j.add(i, i, w * (p[0] + square * (6.0 - 5.0 * square)));
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        _p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        self.metric(u, out);
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        for ((y, x), w) in y.iter_mut().zip(x).zip(&self.weights) {
            *y = w * x;
        }
    }

    fn mass(&self, m: &mut SymmetricBand) -> bool {
        for (i, w) in self.weights.iter().enumerate() {
            m.add(i, i, *w);
        }
        true
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }

    /// `√∫u²`, and `u` in the middle of the pattern, `x = 0`.
    fn observables(&self) -> &[Name] {
        names!["norm", "u_0"]
    }

    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out[0] = u.iter().zip(&self.weights).map(|(u, w)| w * u * u).sum::<f64>().sqrt();
        out[1] = u[0];
        Ok(())
    }
}

const AUTO: &str = "fourth-order collocation, AUTO-07p, to 1e-8";

/// `√∫u²` at which the trace ends: after 17 folds.
const FILLED: f64 = 5.15;

pub(crate) static ENTRY: Entry = Entry {
    name: "swift-hohenberg-snaking",
    summary: "localised patterns of the Swift-Hohenberg equation that snake through 17 folds",
    parameter: "r",
    axes: &[("r", "driving r"), ("norm", "norm of u"), ("u_0", "u at the left end")],
    start: -0.03,
    start_allowed: Allowed::Within(-0.6, -1e-3),
    end: -1.0,
    parameters: &[],
    elements: Some(Elements { default: 600, least: 64, most: 20_000, what: "intervals" }),
    known: &[
        Known::fold(-0.700_458_865_70, 1e-8, AUTO),
        Known::fold(-0.625_962_301_88, 1e-8, AUTO),
        Known::fold(-0.712_421_646_38, 1e-8, AUTO),
        Known::fold(-0.626_775_807_19, 1e-8, AUTO),
        Known::fold(-0.712_642_278_42, 1e-8, AUTO),
        Known::fold(-0.626_784_371_39, 1e-8, AUTO),
        Known::fold(-0.712_645_937_7, 1e-8, AUTO),
        Known::fold(-0.626_784_462_8, 1e-8, AUTO),
    ],
    id: Id::Snaking,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let problem = Snaking::new(request.elements);
    let setup = Setup::new(ENTRY.parameter, problem.guess(request.start), request);
    Ok(hand(visitor, &problem, setup.watching(Watch::stop_at("norm", FILLED))))
}
