//! Diffusion wavelets.
//!
//! Source: `coifman2006`. In the basis of `V_j` the operator `T^(2^j)` is a matrix T_j. Its rank-revealing QR gives
//! `V_{j+1}`, the wavelets span the complement, and `T_{j+1} = (T_j Q)ᵀ(T_j Q)`.
//!
//! Strengths: an orthonormal basis, as many coefficients as vertices, and fewer scaling coefficients on each level.
//! Weaknesses: the functions are not local, the construction is dense and cubic (the sparse Gram-Schmidt of the
//! literature fills in if most columns are chosen, as they are on the first levels), and the wavelets do not have
//! zero mean by construction.

use super::dense::{Dense, rank_revealing};
use super::{Coefficients, MultiscaleError, MultiscaleParams, check_length, symmetric_walk};
use crate::linalg::SymmetricMatrix;
use crate::sgwt::largest_eigenvalue;
use adwave::Progress;
use adwave::operator::Diffusion;

/// Orthonormal scaling functions and wavelets of each level.
#[derive(Clone, Debug)]
pub struct DiffusionWavelets {
    root: Vec<f64>,
    levels: Vec<Level>,
}

/// Bases of one level. They are `None` if its space equals that of the previous level, so that the scaling functions do
/// not change and there are no wavelets.
#[derive(Clone, Debug)]
struct Level(Option<LevelBases>);

#[derive(Clone, Debug)]
struct LevelBases {
    /// Scaling functions in the basis of those of the previous level.
    q: Dense,
    /// Wavelets in the basis of the scaling functions of the previous level.
    w: Dense,
}

impl DiffusionWavelets {
    /// Builds the wavelets of a reversible `walk`, in the order of its rows. O(n³) for the first level, less for each
    /// further level.
    ///
    /// # Errors
    /// [`MultiscaleError`].
    ///
    /// ```
    /// use adwave::{Decomposer, Progress, operator::OperatorParams, shape::{Graph, Shape}};
    /// use adwave_baselines::multiscale::{DiffusionWavelets, MultiscaleParams};
    /// let edges: Vec<_> = (0..9).map(|i| (i, i + 1, 1.0)).collect();
    /// let shape = Shape::Graph(Graph::new(10, &edges)?);
    /// let decomposer = Decomposer::new(&shape);
    /// let rows = decomposer.rows("a basis")?;
    /// let wavelets = DiffusionWavelets::new(rows, &MultiscaleParams::default(), Progress::none())?;
    /// let signal: Vec<f64> = (0..10).map(|i| f64::from(i * i)).collect();
    /// let back = wavelets.synthesize(&wavelets.analyze(&signal)?)?;
    /// assert!(signal.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-12));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        walk: &Diffusion,
        params: &MultiscaleParams,
        progress: Progress<'_>,
    ) -> Result<Self, MultiscaleError> {
        params.check(walk.n_vertices())?;
        let (mut t, root) = symmetric_walk(walk)?;
        let (n, mut least) = (t.rows, smallest_eigenvalue(&t)?);
        let mut levels: Vec<Level> = Vec::new();
        for level in 0..params.levels {
            progress.step(level as u64, params.levels as u64)?;
            if t.rows <= 1 {
                break;
            }
            // The remainder of a column is at least the smallest singular value, so no column would be dropped.
            if t.rows == n && least > FULL_RANK * params.precision {
                levels.push(Level(None));
                t = t.multiply(&t);
                least *= least;
                continue;
            }
            let parts = rank_revealing(&t, params.precision)?;
            let tq = t.multiply(&parts.q);
            t = tq.transpose_multiply(&tq);
            levels.push(Level(Some(LevelBases { q: parts.q, w: parts.complement })));
            least = 0.0;
        }
        Ok(Self { root, levels })
    }

    /// Number of levels that were built.
    pub fn n_levels(&self) -> usize {
        self.levels.len()
    }

    /// Number of scaling functions on each level from 0 on, which is the rank.
    pub fn ranks(&self) -> Vec<usize> {
        let mut ranks = vec![self.root.len()];
        for level in &self.levels {
            ranks.push(level.0.as_ref().map_or(ranks[ranks.len() - 1], |parts| parts.q.columns));
        }
        ranks
    }

    /// Computes the coefficients `(⟨√π f, φ_J⟩, ⟨√π f, ψ_j⟩)` of a signal f. The map is orthogonal: the squared
    /// coefficients sum to n times the π-weighted mean square of f.
    ///
    /// # Errors
    /// [`MultiscaleError::Length`].
    pub fn analyze(&self, signal: &[f64]) -> Result<Coefficients, MultiscaleError> {
        check_length(self.root.len(), signal.len())?;
        let mut scaling: Vec<f64> = signal.iter().zip(&self.root).map(|(f, r)| f * r).collect();
        let mut wavelets = Vec::new();
        for level in &self.levels {
            let Level(Some(parts)) = level else {
                wavelets.push(Vec::new());
                continue;
            };
            wavelets.push(parts.w.apply_transposed(&scaling));
            scaling = parts.q.apply_transposed(&scaling);
        }
        Ok(Coefficients { scaling, wavelets })
    }

    /// Reconstructs the signal from its coefficients.
    ///
    /// # Errors
    /// [`MultiscaleError::Length`].
    pub fn synthesize(&self, coefficients: &Coefficients) -> Result<Vec<f64>, MultiscaleError> {
        check_length(self.levels.len(), coefficients.wavelets.len())?;
        let mut scaling = coefficients.scaling.clone();
        for (level, w) in self.levels.iter().zip(&coefficients.wavelets).rev() {
            let Level(Some(parts)) = level else {
                check_length(0, w.len())?;
                continue;
            };
            check_length(parts.q.columns, scaling.len())?;
            check_length(parts.w.columns, w.len())?;
            let fine = parts.w.apply(w);
            scaling = parts.q.apply(&scaling).iter().zip(&fine).map(|(a, b)| a + b).collect();
        }
        check_length(self.root.len(), scaling.len())?;
        Ok(scaling.iter().zip(&self.root).map(|(s, r)| s / r).collect())
    }

    /// Returns the scaling functions of a level (from 0), one after another, each of unit length in the symmetric form.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn scaling_functions(&self, level: usize) -> Vec<Vec<f64>> {
        split(&self.ambient(level))
    }

    /// Returns the wavelets of a level (from 1): a basis of the complement of its space in that of the previous level.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn wavelets(&self, level: usize) -> Vec<Vec<f64>> {
        match &self.levels[level - 1].0 {
            Some(parts) => split(&self.ambient(level - 1).multiply(&parts.w)),
            None => Vec::new(),
        }
    }

    /// Largest `|⟨φ_i, φ_k⟩ − δ_ik|` among the scaling functions of a level.
    pub fn orthogonality_defect(&self, level: usize) -> f64 {
        let functions = self.ambient(level);
        functions.defect(&functions)
    }

    fn ambient(&self, level: usize) -> Dense {
        let mut functions: Option<Dense> = None;
        for parts in self.levels[..level].iter().filter_map(|level| level.0.as_ref()) {
            functions = Some(functions.map_or_else(|| parts.q.clone(), |f| f.multiply(&parts.q)));
        }
        functions.unwrap_or_else(|| Dense::identity(self.root.len()))
    }
}

#[cfg(test)]
impl DiffusionWavelets {
    pub(super) fn ambient_for_test(&self, level: usize) -> Dense {
        self.ambient(level)
    }
}

/// Ratio of the smallest eigenvalue, whose bound is an estimate, to the precision above which the rank counts as full.
const FULL_RANK: f64 = 10.0;

/// Lower bound of the smallest eigenvalue of T, whose largest is 1; 0 if the bound is not positive.
fn smallest_eigenvalue(t: &Dense) -> Result<f64, MultiscaleError> {
    let entries = (0..t.columns).flat_map(|j| (0..=j).map(move |i| (i, j)));
    let entries: Vec<_> = entries
        .map(|(i, j)| (i as u32, j as u32, f64::from(u8::from(i == j)) - t.get(i, j)))
        .filter(|e| e.2 != 0.0)
        .collect();
    let complement = SymmetricMatrix::from_halves(t.columns, &entries)?;
    Ok((1.0 - largest_eigenvalue(&complement)).max(0.0))
}

pub(super) fn split(functions: &Dense) -> Vec<Vec<f64>> {
    (0..functions.columns).map(|j| functions.column(j).to_vec()).collect()
}
