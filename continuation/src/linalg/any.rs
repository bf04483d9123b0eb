//! A matrix of unknown type: what is written for it is compiled once, and not again for every storage in every
//! program that uses it. An indirect call for each operation is what it costs.

use super::{Facts, Matrix, OutsidePattern, Spectrum, SymmetricPart};
use std::any::Any;

/// The operations of a [`Matrix`] whose type is known to itself alone.
trait Operations: Any + Send + Sync {
    fn copy(&self) -> Box<dyn Operations>;
    fn dim(&self) -> usize;
    fn set_zero(&mut self);
    fn mul(&self, x: &[f64], y: &mut [f64]);
    fn mul_transpose(&self, x: &[f64], y: &mut [f64]);
    fn axpy(&mut self, a: f64, other: &AnyMatrix);
    fn norm(&self) -> f64;
    fn factor(&mut self, floor: f64) -> Facts;
    fn solve(&mut self, x: &mut [f64]);
    fn solve_transpose(&mut self, x: &mut [f64]);
    fn prefers_solves(&self) -> bool;
    fn misplaced(&self) -> Option<OutsidePattern>;
    fn entries(&self, visit: &mut dyn FnMut(usize, usize, f64)) -> bool;
    fn add_identity(&mut self, a: f64) -> bool;
    fn spectrum(&self, mass: Option<&AnyMatrix>) -> Option<Vec<(f64, f64)>>;
    fn spectrum_with_errors(&self, mass: Option<&AnyMatrix>) -> Option<Spectrum>;
    fn symmetric_part(&mut self) -> Option<SymmetricPart>;
    fn complex(&self, imaginary: &AnyMatrix) -> Option<AnyMatrix>;
}

impl<J: Matrix> Operations for J {
    fn copy(&self) -> Box<dyn Operations> {
        Box::new(self.clone())
    }

    fn dim(&self) -> usize {
        Matrix::dim(self)
    }

    fn set_zero(&mut self) {
        Matrix::set_zero(self);
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) {
        Matrix::mul(self, x, y);
    }

    fn mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        Matrix::mul_transpose(self, x, y);
    }

    fn axpy(&mut self, a: f64, other: &AnyMatrix) {
        Matrix::axpy(self, a, other.get());
    }

    fn norm(&self) -> f64 {
        Matrix::norm(self)
    }

    fn factor(&mut self, floor: f64) -> Facts {
        Matrix::factor(self, floor)
    }

    fn solve(&mut self, x: &mut [f64]) {
        Matrix::solve(self, x);
    }

    fn solve_transpose(&mut self, x: &mut [f64]) {
        Matrix::solve_transpose(self, x);
    }

    fn prefers_solves(&self) -> bool {
        Matrix::prefers_solves(self)
    }

    fn misplaced(&self) -> Option<OutsidePattern> {
        Matrix::misplaced(self)
    }

    fn entries(&self, visit: &mut dyn FnMut(usize, usize, f64)) -> bool {
        Matrix::entries(self, visit)
    }

    fn add_identity(&mut self, a: f64) -> bool {
        Matrix::add_identity(self, a)
    }

    fn spectrum(&self, mass: Option<&AnyMatrix>) -> Option<Vec<(f64, f64)>> {
        Matrix::spectrum(self, mass.map(AnyMatrix::get))
    }

    fn spectrum_with_errors(&self, mass: Option<&AnyMatrix>) -> Option<Spectrum> {
        Matrix::spectrum_with_errors(self, mass.map(AnyMatrix::get))
    }

    fn symmetric_part(&mut self) -> Option<SymmetricPart> {
        Matrix::symmetric_part(self)
    }

    fn complex(&self, imaginary: &AnyMatrix) -> Option<AnyMatrix> {
        Matrix::complex(self, imaginary.get()).map(AnyMatrix::new)
    }
}

/// A [`Matrix`] whose type only its problem knows: the cores of the extended systems of
/// [`crate::codim2`].
pub struct AnyMatrix(Box<dyn Operations>);

impl AnyMatrix {
    pub(crate) fn new<J: Matrix>(matrix: J) -> Self {
        AnyMatrix(Box::new(matrix))
    }

    /// The matrix itself. All of a problem's matrices are of one type.
    pub(crate) fn get<J: Matrix>(&self) -> &J {
        let any: &dyn Any = &*self.0;
        any.downcast_ref().unwrap_or_else(|| foreign())
    }

    /// The matrix itself if it is of this type.
    pub(crate) fn downcast<J: Matrix>(&self) -> Option<&J> {
        let any: &dyn Any = &*self.0;
        any.downcast_ref()
    }

    pub(crate) fn get_mut<J: Matrix>(&mut self) -> &mut J {
        let any: &mut dyn Any = &mut *self.0;
        any.downcast_mut().unwrap_or_else(|| foreign())
    }
}

fn foreign() -> ! {
    unreachable!("the matrix of one problem was given to another")
}

impl Clone for AnyMatrix {
    fn clone(&self) -> Self {
        AnyMatrix(self.0.copy())
    }
}

impl Matrix for AnyMatrix {
    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn set_zero(&mut self) {
        self.0.set_zero();
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) {
        self.0.mul(x, y);
    }

    fn mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        self.0.mul_transpose(x, y);
    }

    fn axpy(&mut self, a: f64, other: &Self) {
        self.0.axpy(a, other);
    }

    fn norm(&self) -> f64 {
        self.0.norm()
    }

    fn factor(&mut self, floor: f64) -> Facts {
        self.0.factor(floor)
    }

    fn solve(&mut self, x: &mut [f64]) {
        self.0.solve(x);
    }

    fn solve_transpose(&mut self, x: &mut [f64]) {
        self.0.solve_transpose(x);
    }

    fn prefers_solves(&self) -> bool {
        self.0.prefers_solves()
    }

    fn misplaced(&self) -> Option<OutsidePattern> {
        self.0.misplaced()
    }

    fn entries(&self, visit: &mut dyn FnMut(usize, usize, f64)) -> bool {
        self.0.entries(visit)
    }

    fn add_identity(&mut self, a: f64) -> bool {
        self.0.add_identity(a)
    }

    fn spectrum(&self, mass: Option<&Self>) -> Option<Vec<(f64, f64)>> {
        self.0.spectrum(mass)
    }

    fn spectrum_with_errors(&self, mass: Option<&Self>) -> Option<Spectrum> {
        self.0.spectrum_with_errors(mass)
    }

    fn symmetric_part(&mut self) -> Option<SymmetricPart> {
        self.0.symmetric_part()
    }

    fn complex(&self, imaginary: &Self) -> Option<Self> {
        self.0.complex(imaginary)
    }
}
