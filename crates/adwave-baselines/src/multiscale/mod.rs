//! Diffusion wavelets and biorthogonal diffusion wavelets: bases of the nested ranges of powers of a walk.
//!
//! Both use the spaces `V_0 ⊇ V_1 ⊇ …`, with `V_j` the range of `T^(2^j − 1)` up to a precision, where T is the
//! symmetric form of the walk, `T = Π^½ Φ₁ Π^(−½)`. They differ in the basis of `V_j`.

mod biorthogonal;
mod dense;
mod downsampled;
mod locality;
mod orthogonal;

pub use biorthogonal::BiorthogonalDiffusionWavelets;
pub use downsampled::{Downsampled, downsample};
pub use locality::{Locality, locality};
pub use orthogonal::DiffusionWavelets;

use crate::linalg::LinalgError;
use adwave::Cancelled;
use adwave::operator::{Diffusion, NoRows};
use dense::Dense;
use thiserror::Error;

/// Largest number of vertices; the bases of the first levels are dense, with eight bytes per entry.
pub const MAX_VERTICES: usize = 6000;
/// Largest number of levels, for which the diffusion steps fit into 64 bits.
pub const MAX_LEVELS: usize = 62;

/// Reason for which diffusion wavelets cannot be built.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MultiscaleError {
    /// The shape has too many vertices for dense bases.
    #[error("dense bases are limited to {most} vertices, got {n}", most = MAX_VERTICES)]
    TooLarge {
        /// Number of vertices.
        n: usize,
    },
    /// The operator is not reversible, or its walk never stays at a vertex.
    #[error("the diffusion operator is not reversible, so it has no symmetric form")]
    NotReversible,
    /// The operator has no rows.
    #[error(transparent)]
    NoRows(#[from] NoRows),
    /// The precision or the number of levels is out of range.
    #[error("precision must be in 1e-14..=0.1 and levels in 1..={most}, got precision {precision} and \
            {levels} levels", most = MAX_LEVELS)]
    Params {
        /// Precision.
        precision: f64,
        /// Number of levels.
        levels: usize,
    },
    /// A signal or a list of coefficients has the wrong length.
    #[error("expected {expected} values, got {got}")]
    Length {
        /// Number of values expected.
        expected: usize,
        /// Number of values given.
        got: usize,
    },
    /// A linear algebra step failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// The caller cancelled the call.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Coefficients of a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Coefficients {
    /// Coefficients of the scaling functions of the last level.
    pub scaling: Vec<f64>,
    /// Coefficients of the wavelets of each level, from fine to coarse.
    pub wavelets: Vec<Vec<f64>>,
}

/// Parameters of the construction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MultiscaleParams {
    /// Precision ε: remainder of a column in the rank-revealing QR that counts as zero; T has norm 1.
    pub precision: f64,
    /// Largest number of levels; there are fewer if the rank falls to 1.
    pub levels: usize,
}

impl Default for MultiscaleParams {
    fn default() -> Self {
        Self { precision: 1e-6, levels: 10 }
    }
}

impl MultiscaleParams {
    /// Sets the precision ε.
    #[must_use]
    pub fn with_precision(self, precision: f64) -> Self {
        Self { precision, ..self }
    }

    /// Sets the largest number of levels.
    #[must_use]
    pub fn with_levels(self, levels: usize) -> Self {
        Self { levels, ..self }
    }

    fn check(&self, n: usize) -> Result<(), MultiscaleError> {
        let &Self { precision, levels } = self;
        if !(1e-14..=0.1).contains(&precision) || levels == 0 || levels > MAX_LEVELS {
            return Err(MultiscaleError::Params { precision, levels });
        }
        if n > MAX_VERTICES {
            return Err(MultiscaleError::TooLarge { n });
        }
        Ok(())
    }
}

/// Returns T, and the factors √(nπ) that convert between T and the walk.
fn symmetric_walk(walk: &Diffusion) -> Result<(Dense, Vec<f64>), MultiscaleError> {
    let n = walk.n_vertices();
    if !walk.is_reversible() {
        return Err(MultiscaleError::NotReversible);
    }
    // A stationary distribution that vanishes somewhere in the working precision would make the factors infinite.
    let root: Vec<f64> = walk.stationary().iter().map(|p| (p.max(1e-30) * n as f64).sqrt()).collect();
    let mut t = Dense::zeros(n, n);
    for x in 0..n {
        let (columns, weights) = walk.row(x);
        *t.get_mut(x, x) = walk.diagonal(x);
        for (&y, &w) in columns.iter().zip(weights) {
            *t.get_mut(x, y as usize) = root[x] * w / root[y as usize];
        }
    }
    // Both halves are equal up to rounding (and to the cutoff of the stationary distribution).
    for x in 0..n {
        for y in 0..x {
            let mean = 0.5 * (t.get(x, y) + t.get(y, x));
            *t.get_mut(x, y) = mean;
            *t.get_mut(y, x) = mean;
        }
    }
    Ok((t, root))
}

fn check_length(expected: usize, got: usize) -> Result<(), MultiscaleError> {
    if expected == got { Ok(()) } else { Err(MultiscaleError::Length { expected, got }) }
}

#[cfg(test)]
mod tests;
