//! The linear algebra that the baselines share: symmetric sparse matrices, their factorization, their smallest
//! eigenpairs, conjugate gradients.
//!
//! faer does the factorizing and the dense algebra, without threads; what runs on several threads is cut here into chunks
//! that do not depend on their number, so that the bits of a result do not either.

mod cg;
mod components;
mod dense;
mod lanczos;
mod ldlt;
mod panel;
mod slices;
mod symmetric;

pub use cg::{CgInfo, conjugate_gradients};
pub use components::{EigenInfo, EigenParams, Eigenpairs, smallest_eigenpairs};
pub(crate) use dense::symmetric_eigen;
pub use ldlt::Ldlt;
pub(crate) use panel::{add_product, gram};
pub use symmetric::SymmetricMatrix;

#[cfg(test)]
mod tests;

use adwave::Cancelled;
use thiserror::Error;

/// Why a system was not solved or eigenpairs were not found.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LinalgError {
    /// An entry of a matrix is NaN or infinite.
    #[error("entry ({row}, {column}) of the matrix is {value}; it must be finite")]
    NotFinite {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// An entry names a row or column that does not exist.
    #[error("entry ({row}, {column}) lies outside a matrix of {n} rows")]
    OutOfRange {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// Number of rows.
        n: usize,
    },
    /// A vector is not as long as the matrix has rows.
    #[error("{got} values were given where {expected} are needed")]
    Length {
        /// How many are needed.
        expected: usize,
        /// How many were given.
        got: usize,
    },
    /// The factorization met a pivot that is zero, or memory ran out.
    #[error("the matrix minus {shift} times the identity cannot be factorized: {what}")]
    Factorize {
        /// What was subtracted from the diagonal.
        shift: f64,
        /// What the factorization says.
        what: String,
    },
    /// A dense eigenproblem was not solved.
    #[error("the eigenvalues of a dense {n} × {n} matrix did not converge")]
    DenseEigen {
        /// Its number of rows.
        n: usize,
    },
    /// The eigenpairs did not converge within the cap.
    #[error(
        "{found} of {wanted} eigenpairs converged within {solves} solves; ask for fewer or a larger tolerance"
    )]
    NotConverged {
        /// How many converged.
        found: usize,
        /// How many were asked for.
        wanted: usize,
        /// Solves spent.
        solves: usize,
    },
    /// Conjugate gradients did not converge within the cap.
    #[error(
        "conjugate gradients are at a relative residual of {residual:e} after {iterations} iterations; allow more or a larger tolerance"
    )]
    CgNotConverged {
        /// Iterations done.
        iterations: usize,
        /// Relative residual reached.
        residual: f64,
    },
    /// Stopped on request.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
