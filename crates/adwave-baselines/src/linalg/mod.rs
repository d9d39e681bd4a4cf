//! Linear algebra shared by the baselines: symmetric sparse matrices, their factorization, their smallest eigenpairs,
//! and conjugate gradients.
//!
//! The library faer does the factorization and the dense algebra, without threads. Multithreaded work is divided here
//! into chunks that do not depend on the number of threads, so that results are bit-identical for any number of
//! threads.

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

/// Reason for which a system cannot be solved or eigenpairs cannot be computed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum LinalgError {
    /// An entry of a matrix is NaN or infinite.
    #[error("entry ({row}, {column}) of the matrix must be finite, got {value}")]
    NotFinite {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// Value of the entry.
        value: f64,
    },
    /// An entry has a row or column that does not exist.
    #[error("entry ({row}, {column}) must lie inside a matrix of {n} rows")]
    OutOfRange {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// Number of rows.
        n: usize,
    },
    /// The length of a vector differs from the number of rows.
    #[error("expected {expected} values, got {got}")]
    Length {
        /// Number of values expected.
        expected: usize,
        /// Number of values given.
        got: usize,
    },
    /// The factorization met a zero pivot, or memory ran out.
    #[error("the matrix minus {shift} times the identity cannot be factorized: {what}")]
    Factorize {
        /// Multiple of the identity that was subtracted.
        shift: f64,
        /// Reason of the failure.
        what: String,
    },
    /// A dense eigenproblem could not be solved.
    #[error("the eigenvalues of a dense {n} × {n} matrix did not converge")]
    DenseEigen {
        /// Number of rows.
        n: usize,
    },
    /// The eigenpairs did not converge within the largest number of solves.
    #[error(
        "{found} of {wanted} eigenpairs converged within {solves} solves; request fewer or set a larger \
        tolerance"
    )]
    NotConverged {
        /// Number of converged eigenpairs.
        found: usize,
        /// Number of requested eigenpairs.
        wanted: usize,
        /// Number of solves spent.
        solves: usize,
    },
    /// Conjugate gradients did not converge within the largest number of iterations.
    #[error(
        "conjugate gradients reached a relative residual of {residual:e} after {iterations} iterations; \
        allow more iterations or a larger tolerance"
    )]
    CgNotConverged {
        /// Number of iterations.
        iterations: usize,
        /// Relative residual reached.
        residual: f64,
    },
    /// The caller cancelled the call.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
