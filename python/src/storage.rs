//! One matrix type for every storage that a Python user may choose.
//!
//! The engine is generic over the matrix. With an enum it is compiled once, which keeps the wheel small; a
//! `match` for each operation on a whole matrix costs nothing.

use continuation::linalg::{Band, Dense, Matrix, OutsidePattern, Sparse, Spectrum, SymmetricPart};
use continuation::{EvalError, Facts};

/// Largest number of entries of a matrix: 1 GB, some ten of which a trace may hold.
const MOST_ENTRIES: usize = 1 << 27;

/// A dense, banded or sparse matrix.
#[derive(Debug, Clone)]
pub(crate) enum Storage {
    Dense(Dense),
    Band(Band),
    Sparse(Box<Sparse>),
}
use Storage as S;

macro_rules! each {
    ($self:expr, $m:pat => $call:expr) => {
        match $self {
            Storage::Dense($m) => $call,
            Storage::Band($m) => $call,
            Storage::Sparse($m) => $call,
        }
    };
}

impl Storage {
    /// An empty matrix; `None` where it would not fit into memory.
    pub(crate) fn dense(n: usize) -> Option<Self> {
        (n.checked_mul(n)? <= MOST_ENTRIES).then(|| S::Dense(Dense::new(n)))
    }

    /// The same with diagonals below and above the main one.
    pub(crate) fn band(n: usize, below: usize, above: usize) -> Option<Self> {
        let (below, above) = (below.min(n.saturating_sub(1)), above.min(n.saturating_sub(1)));
        // with the fill of the pivots
        let width = 2 * below + above + 1;
        (n.checked_mul(width)? <= MOST_ENTRIES).then(|| S::Band(Band::new(n, below, above)))
    }

    /// The same with a pattern.
    pub(crate) fn sparse(n: usize, pattern: &[(usize, usize)]) -> Result<Self, OutsidePattern> {
        Ok(S::Sparse(Box::new(Sparse::new(n, pattern)?)))
    }

    /// Whether there is a place for an entry.
    pub(crate) fn holds(&self, row: usize, column: usize) -> bool {
        let n = self.dim();
        row < n
            && column < n
            && match self {
                S::Dense(_) => true,
                S::Band(band) => {
                    let (below, above) = band.bandwidths();
                    row <= column + below && column <= row + above
                }
                S::Sparse(sparse) => sparse.position(row, column).is_some(),
            }
    }

    /// Adds to an entry; false where there is no place for it.
    pub(crate) fn add(&mut self, row: usize, column: usize, value: f64) -> bool {
        if !self.holds(row, column) {
            return false;
        }
        match self {
            S::Dense(dense) => dense.add(row, column, value),
            S::Band(band) => band.add(row, column, value),
            S::Sparse(sparse) => return sparse.add(row, column, value).is_ok(),
        }
        true
    }

    /// The name by which the Python side knows it.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            S::Dense(_) => "dense",
            S::Band(_) => "band",
            S::Sparse(_) => "sparse",
        }
    }
}

impl Matrix for Storage {
    fn dim(&self) -> usize {
        each!(self, m => m.dim())
    }
    fn set_zero(&mut self) {
        each!(self, m => m.set_zero());
    }
    fn mul(&self, x: &[f64], y: &mut [f64]) {
        each!(self, m => m.mul(x, y));
    }
    fn mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        each!(self, m => m.mul_transpose(x, y));
    }
    fn axpy(&mut self, a: f64, other: &Self) {
        match (self, other) {
            (S::Dense(m), S::Dense(other)) => m.axpy(a, other),
            (S::Band(m), S::Band(other)) => m.axpy(a, other),
            (S::Sparse(m), S::Sparse(other)) => m.axpy(a, other),
            // all matrices of a problem are copies of one
            _ => {}
        }
    }
    fn norm(&self) -> f64 {
        each!(self, m => m.norm())
    }
    fn factor(&mut self, floor: f64) -> Facts {
        each!(self, m => m.factor(floor))
    }
    fn solve(&mut self, x: &mut [f64]) {
        each!(self, m => m.solve(x));
    }
    fn solve_transpose(&mut self, x: &mut [f64]) {
        each!(self, m => m.solve_transpose(x));
    }
    fn misplaced(&self) -> Option<OutsidePattern> {
        each!(self, m => m.misplaced())
    }
    fn entries(&self, visit: &mut dyn FnMut(usize, usize, f64)) -> bool {
        each!(self, m => m.entries(visit))
    }
    fn add_identity(&mut self, a: f64) -> bool {
        each!(self, m => m.add_identity(a))
    }
    fn spectrum(&self, mass: Option<&Self>) -> Option<Vec<(f64, f64)>> {
        match (self, mass) {
            (S::Dense(m), None) => m.spectrum(None),
            (S::Dense(m), Some(S::Dense(mass))) => m.spectrum(Some(mass)),
            _ => None,
        }
    }
    fn spectrum_with_errors(&self, mass: Option<&Self>) -> Option<Spectrum> {
        match (self, mass) {
            (S::Dense(m), None) => m.spectrum_with_errors(None),
            (S::Dense(m), Some(S::Dense(mass))) => m.spectrum_with_errors(Some(mass)),
            _ => None,
        }
    }
    fn symmetric_part(&mut self) -> Option<SymmetricPart> {
        each!(self, m => m.symmetric_part())
    }
    fn complex(&self, imaginary: &Self) -> Option<Self> {
        match (self, imaginary) {
            (S::Dense(m), S::Dense(other)) => m.complex(other).map(S::Dense),
            (S::Band(m), S::Band(other)) => m.complex(other).map(S::Band),
            (S::Sparse(m), S::Sparse(other)) => m.complex(other).map(|m| S::Sparse(Box::new(m))),
            _ => None,
        }
    }
}

/// Copies a Jacobian that the engine took by differences.
pub(crate) fn assign<M: Matrix>(
    out: &mut Storage,
    pick: impl FnOnce(&mut Storage) -> Option<&mut M>,
    assemble: impl FnOnce(&mut M) -> Result<(), EvalError>,
) -> Result<(), EvalError> {
    // the storage is made with the problem: the other variant does not occur
    pick(out).map_or(Ok(()), assemble)
}
