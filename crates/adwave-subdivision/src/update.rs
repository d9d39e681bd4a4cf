//! Updates of a lifting step: a combination of the coarse scaling functions around a midpoint is subtracted from its
//! wavelet, so that the integral is 0 and the norm is least.
//!
//! A step has the synthesis `f = S·c` at d = 0, where the rows of S at midpoints are the prediction. The wavelet of
//! midpoint i is `ψ_i = δ_i − Σ_k u_k φ_k` over the coarse vertices k of its support, with φ_k the columns of S. The
//! masses of the coarse vertices are the integrals of the φ_k, `m_c = Sᵀ m_f`, and their inner products on the mesh are
//! `G = Sᵀ M S`. Here M are the inner products of the finer level, at first the masses of the mesh. The weights solve
//!
//! ```text
//! G u = Sᵀ M δ_i − μ m_c,     Σ_k u_k m_c(k) = m_f(i)
//! ```
//!
//! Inner products that are small relative to the norms are left out: this changes the weights a little, but not the
//! integral.

use crate::even_solve::EvenRule;
use crate::rows::{Entry, RowBuilder, product, transpose, without_small};
use adwave::rows::CompressedRows;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Number of midpoints that a thread takes at a time.
const AT_A_TIME: usize = 1024;

/// Inner products of two functions below this share of the product of their norms are left out.
const DROP: f64 = 1e-4;

/// Share of the diagonal that is added to it, so that the smallest supports can be solved.
const RIDGE: f64 = 1e-12;

/// Synthesis of one step without details: rows at the coarse vertices (the identity if there is no rule) and at the
/// midpoints.
pub(crate) struct Synthesis<'a> {
    pub(crate) even: Option<&'a EvenRule>,
    pub(crate) prediction: &'a CompressedRows<f64>,
    pub(crate) n_coarse: usize,
}

/// Result of the least squares.
pub(crate) struct Update {
    /// Weights of each coarse vertex, with one column for each midpoint.
    pub(crate) rows: CompressedRows<f64>,
    /// Masses of the coarse vertices.
    pub(crate) masses: Vec<f64>,
    /// Inner products of the coarse scaling functions on the mesh.
    pub(crate) products: CompressedRows<f64>,
    /// Norms of the wavelets of the midpoints on the mesh.
    pub(crate) norms: Vec<f64>,
}

impl Synthesis<'_> {
    /// Returns all rows of S: those of the coarse vertices, then those of the midpoints.
    fn rows(&self) -> CompressedRows<f64> {
        let mut rows = RowBuilder::new();
        let mut entries = Vec::new();
        for v in 0..self.n_coarse {
            match self.even {
                None => entries.push(Entry { column: v as u32, value: 1.0 }),
                Some(rule) => {
                    let (own, (columns, weights)) = rule.row(v);
                    entries.push(Entry { column: v as u32, value: own });
                    let others = columns.iter().zip(weights);
                    entries.extend(others.map(|(&column, &value)| Entry { column, value }));
                }
            }
            rows.push_row(&mut entries);
        }
        for i in 0..self.prediction.n_rows() {
            let (columns, weights) = self.prediction.row(i);
            let row = columns.iter().zip(weights);
            entries.extend(row.map(|(&column, &value)| Entry { column, value }));
            rows.push_row(&mut entries);
        }
        rows.finish(self.n_coarse)
    }

    /// Computes the least squares update on the support of each midpoint, for masses and inner products of the finer
    /// level.
    pub(crate) fn update(
        &self,
        supports: &CompressedRows<f64>,
        fine_masses: &[f64],
        fine_products: &CompressedRows<f64>,
        progress: Progress<'_>,
    ) -> Result<Update, Cancelled> {
        let rows = self.rows();
        let columns = transpose(&rows);
        progress.check()?;
        let mut masses = vec![0.0; self.n_coarse];
        for (k, mass) in masses.iter_mut().enumerate() {
            let (fine, weights) = columns.row(k);
            *mass = fine.iter().zip(weights).map(|(&x, s)| fine_masses[x as usize] * s).sum();
        }
        let mixed = product(&columns, fine_products, progress)?;
        let products = without_small(&product(&mixed, &rows, progress)?, DROP);
        let by_midpoint = transpose(&mixed);
        let n = self.prediction.n_rows();
        let gram = GramMatrices { products: &products, by_fine: &by_midpoint, masses: &masses };
        let chunk = |chunk: usize| -> Result<Vec<Solved>, Cancelled> {
            progress.check()?;
            let mut system = LocalSystem::new(&gram);
            let range = chunk * AT_A_TIME..((chunk + 1) * AT_A_TIME).min(n);
            let solved = range.map(|i| {
                let x = self.n_coarse + i;
                let fine = FineFunction { index: x, mass: fine_masses[x], square: fine_products.get(x, x) };
                system.solve(&fine, supports.row(i).0)
            });
            Ok(solved.collect())
        };
        let n_chunks = n.div_ceil(AT_A_TIME);
        let solved: Result<Vec<Vec<Solved>>, Cancelled> = if n_chunks <= 1 {
            (0..n_chunks).map(chunk).collect()
        } else {
            (0..n_chunks).into_par_iter().map(chunk).collect()
        };
        let (mut weights, mut norms, mut entries) = (RowBuilder::new(), Vec::with_capacity(n), Vec::new());
        for (i, one) in solved?.into_iter().flatten().enumerate() {
            let row = supports.row(i).0.iter().zip(one.weights);
            entries.extend(row.map(|(&column, value)| Entry { column, value }));
            weights.push_row(&mut entries);
            norms.push(one.norm);
        }
        progress.check()?;
        Ok(Update { rows: transpose(&weights.finish(self.n_coarse)), masses, products, norms })
    }
}

/// Inner products of coarse functions with each other and with fine functions, and the integrals of the coarse
/// functions.
struct GramMatrices<'a> {
    products: &'a CompressedRows<f64>,
    /// Inner products with fine functions, a row for each fine function and a column for each coarse function.
    by_fine: &'a CompressedRows<f64>,
    masses: &'a [f64],
}

/// Scaling function of the finer level with its integral and the square of its norm.
struct FineFunction {
    index: usize,
    mass: f64,
    square: f64,
}

/// Weights of one midpoint, and the norm of its wavelet.
struct Solved {
    weights: Vec<f64>,
    norm: f64,
}

/// Least squares problem of one midpoint after another, which reuses its memory.
struct LocalSystem<'a> {
    gram: &'a GramMatrices<'a>,
    /// Place of each coarse vertex in the current support, or `usize::MAX`.
    places: Vec<usize>,
    /// Inner products on the current support; their Cholesky factor is `factor`.
    products: Vec<f64>,
    factor: Vec<f64>,
}

impl<'a> LocalSystem<'a> {
    fn new(gram: &'a GramMatrices<'a>) -> Self {
        let places = vec![usize::MAX; gram.masses.len()];
        Self { gram, places, products: Vec::new(), factor: Vec::new() }
    }

    /// Computes the weights of a fine function on its support.
    fn solve(&mut self, fine: &FineFunction, support: &[u32]) -> Solved {
        let size = support.len();
        for (place, &k) in support.iter().enumerate() {
            self.places[k as usize] = place;
        }
        self.products.clear();
        self.products.resize(size * size, 0.0);
        for (place, &k) in support.iter().enumerate() {
            let (others, values) = self.gram.products.row(k as usize);
            for (&other, value) in others.iter().zip(values) {
                let other = self.places[other as usize];
                if other != usize::MAX {
                    self.products[place * size + other] = *value;
                }
            }
        }
        let mut right = vec![0.0; size];
        let (coarse, values) = self.gram.by_fine.row(fine.index);
        for (&k, value) in coarse.iter().zip(values) {
            let place = self.places[k as usize];
            if place != usize::MAX {
                right[place] = *value;
            }
        }
        for &k in support {
            self.places[k as usize] = usize::MAX;
        }
        let own: Vec<f64> = support.iter().map(|&k| self.gram.masses[k as usize]).collect();
        let weights = self.constrained(&right, &own, fine.mass);
        let mut square = fine.square;
        for (i, u) in weights.iter().enumerate() {
            let row = self.products[i * size..][..size].iter().zip(&weights);
            square += u * (row.map(|(g, w)| g * w).sum::<f64>() - 2.0 * right[i]);
        }
        Solved { weights, norm: square.max(0.0).sqrt() }
    }

    /// Computes the weights for which the wavelet has the least norm and integral 0; from the masses alone if the Gram
    /// matrix has no factor.
    fn constrained(&mut self, right: &[f64], own: &[f64], mass: f64) -> Vec<f64> {
        let by_mass = || {
            let square: f64 = own.iter().map(|m| m * m).sum();
            let scale = if square > 0.0 { mass / square } else { 0.0 };
            own.iter().map(|m| scale * m).collect::<Vec<f64>>()
        };
        if !self.factorize(own.len()) {
            return by_mass();
        }
        let (free, across) = (self.back_substitute(right), self.back_substitute(own));
        let dot = |a: &[f64]| a.iter().zip(own).map(|(a, m)| a * m).sum::<f64>();
        let multiplier = (dot(&free) - mass) / dot(&across);
        let mut weights: Vec<f64> = free.iter().zip(&across).map(|(f, a)| f - multiplier * a).collect();
        if weights.iter().any(|u| !u.is_finite()) {
            return by_mass();
        }
        // Once more for what rounding has left of the integral.
        let rest = (mass - dot(&weights)) / dot(&across);
        weights.iter_mut().zip(&across).for_each(|(u, a)| *u += rest * a);
        weights
    }

    /// Computes Cholesky's factor of the Gram matrix; `false` if the matrix is not positive definite.
    fn factorize(&mut self, size: usize) -> bool {
        self.factor.clear();
        self.factor.extend_from_slice(&self.products);
        let ridge = RIDGE * (0..size).map(|i| self.products[i * size + i]).fold(0.0, f64::max);
        for i in 0..size {
            for j in 0..=i {
                let mut sum = self.factor[i * size + j];
                for k in 0..j {
                    sum -= self.factor[i * size + k] * self.factor[j * size + k];
                }
                if i == j {
                    let pivot = sum + ridge;
                    if pivot.is_nan() || pivot <= 0.0 {
                        return false;
                    }
                    self.factor[i * size + i] = pivot.sqrt();
                } else {
                    self.factor[i * size + j] = sum / self.factor[j * size + j];
                }
            }
        }
        size > 0
    }

    fn back_substitute(&self, right: &[f64]) -> Vec<f64> {
        let size = right.len();
        let mut x = right.to_vec();
        for i in 0..size {
            for k in 0..i {
                x[i] -= self.factor[i * size + k] * x[k];
            }
            x[i] /= self.factor[i * size + i];
        }
        for i in (0..size).rev() {
            for k in i + 1..size {
                x[i] -= self.factor[k * size + i] * x[k];
            }
            x[i] /= self.factor[i * size + i];
        }
        x
    }
}
