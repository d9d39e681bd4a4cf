//! Diffusion wavelets and biorthogonal diffusion wavelets: bases of the ever smaller spaces that powers of a walk map into.
//!
//! Both walk `V_0 ⊇ V_1 ⊇ …` with `V_j` the range of `T^(2^j − 1)` up to a precision, T the symmetric form of the walk,
//! `T = Π^½ Φ₁ Π^(−½)`. They differ in the basis of `V_j`.

mod biorthogonal;
mod dense;
mod downsampled;
mod locality;
mod orthogonal;

pub use biorthogonal::BiorthogonalDiffusionWavelets;
pub use downsampled::{Downsampled, downsampled};
pub use locality::{Locality, locality};
pub use orthogonal::DiffusionWavelets;

use crate::linalg::LinalgError;
use adwave::Cancelled;
use adwave::operator::Diffusion;
use dense::Dense;
use thiserror::Error;

/// Most vertices: the bases of the first levels are dense, eight bytes an entry.
pub const MAX_VERTICES: usize = 6000;
/// Most levels: the steps of diffusion fit into 64 bits.
pub const MAX_LEVELS: usize = 62;

/// Why there are no diffusion wavelets.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MultiscaleError {
    /// Too many vertices for dense bases.
    #[error("{n} vertices are more than the {most} for which the bases, which are dense, are built", most = MAX_VERTICES)]
    TooLarge {
        /// Number of vertices.
        n: usize,
    },
    /// The operator is not reversible, or never stays at all.
    #[error("the diffusion operator is not reversible, so it has no symmetric form")]
    NotReversible,
    /// A precision or a number of levels out of range.
    #[error("precision {precision} and {levels} levels; it takes 1e-14 to 0.1, and 1 to {most} levels", most = MAX_LEVELS)]
    Params {
        /// The precision.
        precision: f64,
        /// The levels.
        levels: usize,
    },
    /// A signal or a list of coefficients has the wrong length.
    #[error("{got} values were given where {expected} are needed")]
    Length {
        /// How many are needed.
        expected: usize,
        /// How many were given.
        got: usize,
    },
    /// The linear algebra failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// Stopped on request.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Coefficients of a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Coefficients {
    /// In the scaling functions of the last level.
    pub scaling: Vec<f64>,
    /// In the wavelets of each level, fine to coarse.
    pub wavelets: Vec<Vec<f64>>,
}

/// How the spaces are built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultiscaleParams {
    /// ε: what is left of a column by the rank-revealing QR and counted as nothing; T has norm 1.
    pub precision: f64,
    /// Levels at most; fewer where the rank falls to 1.
    pub levels: usize,
}

impl Default for MultiscaleParams {
    fn default() -> Self {
        Self { precision: 1e-6, levels: 10 }
    }
}

impl MultiscaleParams {
    /// Sets ε.
    #[must_use]
    pub fn with_precision(self, precision: f64) -> Self {
        Self { precision, ..self }
    }

    /// Sets how many levels at most.
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

/// T, and √(nπ), between which and the walk it translates.
fn symmetric_walk(walk: &Diffusion) -> Result<(Dense, Vec<f64>), MultiscaleError> {
    let n = walk.n_vertices();
    if !walk.is_reversible() {
        return Err(MultiscaleError::NotReversible);
    }
    // A law that vanishes somewhere in the working precision would make the translation infinite.
    let root: Vec<f64> = walk.stationary().iter().map(|p| (p.max(1e-30) * n as f64).sqrt()).collect();
    let mut t = Dense::zeros(n, n);
    for x in 0..n {
        let (columns, weights) = walk.row(x);
        *t.at_mut(x, x) = walk.diagonal(x);
        for (&y, &w) in columns.iter().zip(weights) {
            *t.at_mut(x, y as usize) = root[x] * w / root[y as usize];
        }
    }
    // Both halves are equal but for rounding (and where the law was cut off).
    for x in 0..n {
        for y in 0..x {
            let mean = 0.5 * (t.at(x, y) + t.at(y, x));
            *t.at_mut(x, y) = mean;
            *t.at_mut(y, x) = mean;
        }
    }
    Ok((t, root))
}

fn check_length(expected: usize, got: usize) -> Result<(), MultiscaleError> {
    if expected == got { Ok(()) } else { Err(MultiscaleError::Length { expected, got }) }
}

#[cfg(test)]
mod tests;
