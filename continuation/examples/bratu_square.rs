//! A large sparse problem: Bratu's equation in a square, to its fold and beyond.
//!
//! `cargo run --release -p arclen-continuation --example bratu_square -- 200`: 40,000 unknowns by five-point
//! differences, `Δu + λ eᵘ = 0` with `u = 0` on the edge, fold at 6.808124423 in the limit. Prints the
//! fold, extrapolated from the mesh and one of half as many intervals, and how many matrices were
//! assembled and factored.

#![allow(clippy::print_stdout)]

use continuation::linalg::{Matrix, Sparse};
use continuation::{
    EvalError, EventKind, Name, ParamId, Parameter, Problem, Settings, Stability, Tracer, Watch,
    names,
};
use std::ops::ControlFlow;

struct Square {
    side: usize,
    parameters: [Parameter; 1],
    empty: Sparse,
}

/// The inner nodes beside node `i`.
fn neighbours(side: usize, i: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (i % side, i / side);
    let all = [
        (x > 0).then(|| i - 1),
        (x + 1 < side).then_some(i + 1),
        (y > 0).then(|| i - side),
        (y + 1 < side).then_some(i + side),
    ];
    all.into_iter().flatten()
}

impl Square {
    fn new(side: usize) -> Result<Self, EvalError> {
        let pattern: Vec<(usize, usize)> = (0..side * side)
            .flat_map(|i| std::iter::once((i, i)).chain(neighbours(side, i).map(move |j| (i, j))))
            .collect();
        let empty = Sparse::new(side * side, &pattern)?;
        Ok(Square { side, parameters: [Parameter::new("lambda", "", 1.0)], empty })
    }

    /// Intervals to the square.
    fn inverse_area(&self) -> f64 {
        ((self.side + 1) as f64).powi(2)
    }
}

impl Problem for Square {
    type Jacobian = Sparse;

    fn dim(&self) -> usize {
        self.side * self.side
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> Sparse {
        self.empty.clone()
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        for (i, r) in r.iter_mut().enumerate() {
            let around: f64 = neighbours(self.side, i).map(|j| u[j]).sum();
            *r = self.inverse_area() * (around - 4.0 * u[i]) + p[0] * u[i].exp();
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Sparse) -> Result<(), EvalError> {
        j.set_zero();
        for (i, u) in u.iter().enumerate() {
            j.add(i, i, p[0] * u.exp() - 4.0 * self.inverse_area())?;
            for k in neighbours(self.side, i) {
                j.add(i, k, self.inverse_area())?;
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
        out.iter_mut().zip(u).for_each(|(o, u)| *o = u.exp());
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        y.iter_mut().zip(x).for_each(|(y, x)| *y = x / self.inverse_area());
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }

    fn observables(&self) -> &[Name] {
        names!["u_max"]
    }

    fn observe(&self, u: &[f64], _: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out[0] = u.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Ok(())
    }
}

fn fold(side: usize) -> Result<f64, Box<dyn std::error::Error>> {
    let problem = Square::new(side)?;
    let settings = Settings { domain: Some((0.0, 8.0)), ..Settings::default() };
    let branch = Tracer::new(&problem, "lambda", &vec![0.0; side * side], &[0.0], settings)?
        .watching(&[Watch::stop_at("u_max", 6.0)])?
        .run(&mut |_| ControlFlow::Continue(()));
    let fold = branch.events_of(&EventKind::Fold).next().ok_or("no fold")?;
    println!(
        "{side} x {side}: fold at {:.9}, ± {:.0e} along the branch, {:?} to {:?} unstable modes; {} \
         points, {} assemblies",
        fold.p,
        fold.error_estimate,
        fold.unstable_before,
        fold.unstable_after,
        branch.points.len(),
        branch.statistics.newton_iterations
    );
    Ok(fold.p)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let side = std::env::args().nth(1).map_or(Ok(60), |side| side.parse::<usize>())?.max(5) | 1;
    let (fine, coarse) = (fold(side)?, fold(side / 2)?);
    // second order: the error is in proportion to the square of the spacing
    let ratio = ((side + 1) as f64 / (side / 2 + 1) as f64).powi(2);
    println!("extrapolated: {:.7}", fine + (fine - coarse) / (ratio - 1.0));
    Ok(())
}
