//! Biorthogonal diffusion wavelets.
//!
//! Source: `maggioni2005`. The scaling functions of the next level are those of this level after `2^j` more steps;
//! pivoted QR selects as many as are independent. They are not orthogonalized, so they remain as local as powers of T.
//! The dual basis follows by inversion (eq. 12) (eq. 13) (eq. 14):
//!
//! ```text
//! φ_{j+1,k} = T^(2^j) φ_{j,s(k)} / norm,   Φ_{j+1} = Q R,   Φ̃_{j+1} = Q R^(−T),
//! Φ̃ᵀΦ = I,   f = Σ ⟨f, φ̃⟩ φ + wavelets
//! ```
//! Q is stored in addition to Φ. With coordinates in Φ itself, the condition numbers of the levels, up to 1/ε each,
//! would multiply; with Q only one of them has an effect. The wavelets are an orthonormal basis of the orthogonal
//! complement of `V_{j+1}` in `V_j`.
//!
//! Strength: local scaling functions whose number decreases from level to level. Weaknesses: the duals are neither
//! local nor well conditioned, the wavelets do not have zero mean, and the cost is that of diffusion wavelets plus an
//! inversion.

use super::dense::{Dense, dual, rank_revealing};
use super::orthogonal::split;
use super::{Coefficients, MultiscaleError, MultiscaleParams, check_length, symmetric_walk};
use adwave::Progress;
use adwave::operator::Diffusion;

/// Local scaling functions, their duals, and wavelets of each level.
#[derive(Clone, Debug)]
pub struct BiorthogonalDiffusionWavelets {
    root: Vec<f64>,
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    /// Orthonormal basis of the level's space, in that of the previous level.
    q: Dense,
    /// Wavelets in the orthonormal basis of the previous level.
    w: Dense,
    /// Scaling functions in the orthonormal basis of the level: the factor R.
    r: Dense,
    /// Duals of the scaling functions in the same basis: the matrix R^(−T).
    dual: Dense,
}

impl BiorthogonalDiffusionWavelets {
    /// Builds the wavelets of a reversible `walk`, in the order of its rows. O(n³) for the first level, less for each
    /// further level.
    ///
    /// # Errors
    /// [`MultiscaleError`].
    pub fn new(
        walk: &Diffusion,
        params: &MultiscaleParams,
        progress: Progress<'_>,
    ) -> Result<Self, MultiscaleError> {
        params.check(walk.n_vertices())?;
        let (mut t, root) = symmetric_walk(walk)?;
        let mut levels: Vec<Level> = Vec::new();
        let mut diffused = t.clone();
        for level in 0..params.levels {
            progress.step(level as u64, params.levels as u64)?;
            if t.rows <= 1 {
                break;
            }
            diffused.normalize_columns();
            let parts = rank_revealing(&diffused, params.precision)?;
            let tq = t.multiply(&parts.q);
            t = tq.transpose_multiply(&tq);
            diffused = t.multiply(&parts.r);
            // ΦᵀΦ̃ = I by inversion (eq. 14): Φ = Q R gives Φ̃ = Q R^(−T), of which this is R^(−T)
            let dual = dual(&Dense::identity(parts.r.rows), &parts.r);
            levels.push(Level { q: parts.q, w: parts.complement, r: parts.r, dual });
        }
        Ok(Self { root, levels })
    }

    /// Number of levels that were built.
    pub fn n_levels(&self) -> usize {
        self.levels.len()
    }

    /// Number of scaling functions on each level from 0 on.
    pub fn ranks(&self) -> Vec<usize> {
        std::iter::once(self.root.len()).chain(self.levels.iter().map(|l| l.q.columns)).collect()
    }

    /// Computes the coefficients `(⟨√π f, φ̃_J⟩, wavelet coefficients)` of a signal f, one value per row of the walk.
    ///
    /// # Errors
    /// [`MultiscaleError::Length`].
    pub fn analyze(&self, signal: &[f64]) -> Result<Coefficients, MultiscaleError> {
        check_length(self.root.len(), signal.len())?;
        let mut scaling: Vec<f64> = signal.iter().zip(&self.root).map(|(f, r)| f * r).collect();
        let mut wavelets = Vec::new();
        for level in &self.levels {
            wavelets.push(level.w.apply_transposed(&scaling));
            scaling = level.q.apply_transposed(&scaling);
        }
        if let Some(last) = self.levels.last() {
            scaling = last.dual.apply_transposed(&scaling);
        }
        Ok(Coefficients { scaling, wavelets })
    }

    /// Reconstructs the signal from its coefficients, `f = Σ ⟨f, φ̃⟩ φ + wavelets` on all levels (eq. 13).
    ///
    /// # Errors
    /// [`MultiscaleError::Length`].
    pub fn synthesize(&self, coefficients: &Coefficients) -> Result<Vec<f64>, MultiscaleError> {
        check_length(self.levels.len(), coefficients.wavelets.len())?;
        let mut scaling = coefficients.scaling.clone();
        if let Some(last) = self.levels.last() {
            check_length(last.r.columns, scaling.len())?;
            scaling = last.r.apply(&scaling);
        }
        for (level, w) in self.levels.iter().zip(&coefficients.wavelets).rev() {
            check_length(level.q.columns, scaling.len())?;
            check_length(level.w.columns, w.len())?;
            let fine = level.w.apply(w);
            scaling = level.q.apply(&scaling).iter().zip(&fine).map(|(a, b)| a + b).collect();
        }
        check_length(self.root.len(), scaling.len())?;
        Ok(scaling.iter().zip(&self.root).map(|(s, r)| s / r).collect())
    }

    /// Returns the scaling functions of a level (from 1), of unit length in the symmetric form.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn scaling_functions(&self, level: usize) -> Vec<Vec<f64>> {
        split(&self.ambient(level).multiply(&self.levels[level - 1].r))
    }

    /// Returns the functions dual to the scaling functions of a level (from 1).
    ///
    /// # Panics
    /// If there is no such level.
    pub fn dual_functions(&self, level: usize) -> Vec<Vec<f64>> {
        split(&self.duals(level))
    }

    /// Returns the wavelets of a level (from 1).
    ///
    /// # Panics
    /// If there is no such level.
    pub fn wavelets(&self, level: usize) -> Vec<Vec<f64>> {
        split(&self.ambient(level - 1).multiply(&self.levels[level - 1].w))
    }

    /// Largest `|⟨φ̃_i, φ_k⟩ − δ_ik|` on a level (from 1), the error of `⟨φ̃_i, φ_k⟩ = δ_ik` (eq. 12).
    pub fn biorthogonality_defect(&self, level: usize) -> f64 {
        self.duals(level).defect(&self.ambient(level).multiply(&self.levels[level - 1].r))
    }

    fn duals(&self, level: usize) -> Dense {
        self.ambient(level).multiply(&self.levels[level - 1].dual)
    }

    /// Returns the orthonormal basis of a level's space.
    fn ambient(&self, level: usize) -> Dense {
        let mut basis = Dense::identity(self.root.len());
        for (k, level) in self.levels[..level].iter().enumerate() {
            basis = if k == 0 { level.q.clone() } else { basis.multiply(&level.q) };
        }
        basis
    }
}
