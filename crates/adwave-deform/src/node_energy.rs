//! Energy of the nodes: the surface stretches as little as possible, and the rotations of neighbors differ little.
//!
//! `E(T, R) = Σ_s a_s Σ_k w_k(s) ‖∇S′(s) − R_k ∇S(s)‖² + ε Σ_k m_k ‖L_k − R_k‖² + β Σ_{k<l} K_kl ‖R_k − R_l‖²`
//!
//! Each column (node or region) maps a point to `L_k (x − c_k) + t_k` and has a rotation R_k of its own.
//! `S′ = Σ_k w_k (L_k (x − c_k) + t_k)` is linear in T = (L, t). The gradient at a sample is the least-squares gradient
//! over its neighbors in their plane, so that the shapes of triangles do not matter; `m_k = Σ_s a_s w_k` and
//! `K_kl = Σ_s a_s w_k w_l`. All sums over samples are done once, so that a step costs the same on any number of
//! vertices.

use crate::DeformError;
use crate::coarse_base::{BlendRow, CoarseBase};
use crate::regions::BoundRows;
use crate::rotation::{Matrix, add_outer, image, symmetric_eigen};
use adwave::Progress;
use adwave::vector::{Vector, dot, subtract};
use rayon::prelude::*;

/// Weight ε of the deformation of a node itself, which determines the maps where a flat base leaves them open.
const OWN_SHAPE: f64 = 0.02;

/// Eigenvalue of a plane's moments, relative to the largest, below which the samples lie on a line.
const LINE: f64 = 1e-6;

/// Number of columns that a thread takes at a time, at least.
const COLUMNS_AT_A_TIME: usize = 32;

/// Number of samples that a thread takes at a time.
const SAMPLES_AT_A_TIME: usize = 256;

/// Affine map of a column: images of the three unit vectors and of the center.
pub(crate) type ColumnMap = [Vector; 4];

/// Quadratic and linear forms of the energy, by blocks of pairs of columns.
pub(crate) struct NodeEnergy {
    pub(crate) centers: Vec<Vector>,
    pub(crate) masses: Vec<f64>,
    /// Start of each column's blocks.
    pub(crate) offsets: Vec<usize>,
    pub(crate) columns: Vec<u32>,
    /// Q: 4 × 4 numbers a block.
    stretch: Vec<[[f64; 4]; 4]>,
    /// Linear form C: a vector for each of the four numbers of a column.
    pull: Vec<[Vector; 4]>,
    /// β K.
    bend: Vec<f64>,
    /// Block of columns (l, k) for each block of columns (k, l).
    mirror: Vec<u32>,
    constant: f64,
}

/// Values of the columns at one sample and their gradients.
struct SampleTerms {
    area: f64,
    /// Rank of the plane of the gradient.
    rank: f64,
    own: Vec<(u32, f64)>,
    gradients: Vec<(u32, [Vector; 4])>,
}

impl NodeEnergy {
    /// Sums over the samples. `beta` is the squared bending length in distances of nodes.
    pub(crate) fn new(
        base: &CoarseBase,
        bound: &BoundRows,
        beta: f64,
        progress: Progress<'_>,
    ) -> Result<Self, DeformError> {
        let mut centers = base.centers();
        centers.extend(bound.regions.iter().map(|region| region.center));
        let n = centers.len();
        let terms: Vec<Vec<SampleTerms>> = (0..base.samples.len().div_ceil(SAMPLES_AT_A_TIME))
            .into_par_iter()
            .map(|chunk| {
                let end = base.samples.len().min((chunk + 1) * SAMPLES_AT_A_TIME);
                let samples = chunk * SAMPLES_AT_A_TIME..end;
                if progress.is_cancelled() {
                    return Vec::new();
                }
                samples.filter_map(|s| sample_terms(base, bound, &centers, s)).collect()
            })
            .collect();
        progress.check()?;
        let (offsets, columns) = pattern(n, terms.iter().flatten());
        let mut energy = Self {
            masses: vec![0.0; n],
            stretch: vec![[[0.0; 4]; 4]; columns.len()],
            pull: vec![[[0.0; 3]; 4]; columns.len()],
            bend: vec![0.0; columns.len()],
            mirror: Vec::new(),
            constant: 0.0,
            centers,
            offsets,
            columns,
        };
        for term in terms.iter().flatten() {
            energy.add_sample(term);
        }
        energy.finish(beta);
        let mirror = (0..n as u32)
            .flat_map(|k| (energy.offsets[k as usize]..energy.offsets[k as usize + 1]).map(move |b| (k, b)))
            .map(|(k, b)| energy.block(energy.columns[b], k) as u32)
            .collect();
        energy.mirror = mirror;
        Ok(energy)
    }

    pub(crate) fn n_columns(&self) -> usize {
        self.centers.len()
    }

    /// Number of the block of columns `k` and `l`.
    fn block(&self, k: u32, l: u32) -> usize {
        let start = self.offsets[k as usize];
        let row = &self.columns[start..self.offsets[k as usize + 1]];
        start + row.binary_search(&l).expect("the pattern has all pairs of a sample")
    }

    fn add_sample(&mut self, term: &SampleTerms) {
        let area = term.area;
        for (k, g) in &term.gradients {
            for (l, h) in &term.gradients {
                let block = self.block(*k, *l);
                for (row, u) in self.stretch[block].iter_mut().zip(g) {
                    for (entry, v) in row.iter_mut().zip(h) {
                        *entry += area * dot(u, v);
                    }
                }
            }
        }
        for &(k, w) in &term.own {
            self.masses[k as usize] += area * w;
            self.constant += area * w * term.rank;
            for (l, h) in &term.gradients {
                let block = self.block(k, *l);
                for (sum, v) in self.pull[block].iter_mut().zip(h) {
                    for c in 0..3 {
                        sum[c] += area * w * v[c];
                    }
                }
            }
            for &(l, v) in term.own.iter().filter(|(l, _)| *l != k) {
                let block = self.block(k, l);
                self.bend[block] += area * w * v;
            }
        }
    }

    /// Adds the terms of the nodes themselves.
    fn finish(&mut self, beta: f64) {
        for k in 0..self.n_columns() {
            let block = self.block(k as u32, k as u32);
            let weight = OWN_SHAPE * self.masses[k];
            for c in 0..3 {
                self.stretch[block][c][c] += weight;
                self.pull[block][c][c] += weight;
            }
            self.constant += 3.0 * weight;
            for b in self.offsets[k]..self.offsets[k + 1] {
                self.bend[b] *= beta;
                // Each pair has two blocks.
                self.constant += 3.0 * self.bend[b];
            }
        }
    }

    /// Products of the blocks of column `k` with other columns' maps: row k of Q·T.
    fn stretch_row(&self, k: usize, maps: &[ColumnMap]) -> ColumnMap {
        let mut sum = [[0.0; 3]; 4];
        for b in self.offsets[k]..self.offsets[k + 1] {
            let map = &maps[self.columns[b] as usize];
            for (out, row) in sum.iter_mut().zip(&self.stretch[b]) {
                for (q, v) in row.iter().zip(map) {
                    for c in 0..3 {
                        out[c] += q * v[c];
                    }
                }
            }
        }
        sum
    }

    /// Q·T.
    pub(crate) fn stretch(&self, maps: &[ColumnMap]) -> Vec<ColumnMap> {
        self.each_column(|k| self.stretch_row(k, maps))
    }

    /// `C_k(T)`, the matrix that rotation k is fitted to, without the rotations of neighbors.
    pub(crate) fn fit_matrices(&self, maps: &[ColumnMap]) -> Vec<Matrix> {
        let row = |k: usize| {
            let mut sum = [[0.0; 3]; 3];
            for b in self.offsets[k]..self.offsets[k + 1] {
                for (v, c) in maps[self.columns[b] as usize].iter().zip(&self.pull[b]) {
                    add_outer(&mut sum, 1.0, v, c);
                }
            }
            sum
        };
        self.each_column(row)
    }

    /// Values of all columns, by several threads.
    pub(crate) fn each_column<T: Send>(&self, value: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
        (0..self.n_columns()).into_par_iter().with_min_len(COLUMNS_AT_A_TIME).map(value).collect()
    }

    /// Transpose of [`fit_matrices`](Self::fit_matrices) applied to matrices.
    pub(crate) fn pull_back(&self, matrices: &[Matrix]) -> Vec<ColumnMap> {
        self.each_column(|l| {
            let mut sum = [[0.0; 3]; 4];
            for b in self.offsets[l]..self.offsets[l + 1] {
                let matrix = &matrices[self.columns[b] as usize];
                for (sum, c) in sum.iter_mut().zip(&self.pull[self.mirror[b] as usize]) {
                    let v = image(matrix, c);
                    for i in 0..3 {
                        sum[i] += v[i];
                    }
                }
            }
            sum
        })
    }

    /// `β Σ_l K_kl M_l` for matrices M.
    pub(crate) fn bend_row(&self, k: usize, matrices: &[Matrix]) -> Matrix {
        let mut sum = [[0.0; 3]; 3];
        for b in self.offsets[k]..self.offsets[k + 1] {
            let (weight, matrix) = (self.bend[b], &matrices[self.columns[b] as usize]);
            for (row, other) in sum.iter_mut().zip(matrix) {
                for c in 0..3 {
                    row[c] += weight * other[c];
                }
            }
        }
        sum
    }

    /// Weights β K_kl of the neighbors of column `k`.
    pub(crate) fn bends(&self, k: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        (self.offsets[k]..self.offsets[k + 1]).map(|b| (self.columns[b] as usize, self.bend[b]))
    }

    /// Entries of Q: row, column, the four by four numbers.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = (usize, usize, &[[f64; 4]; 4])> + '_ {
        (0..self.n_columns()).flat_map(move |k| {
            (self.offsets[k]..self.offsets[k + 1])
                .map(move |b| (k, self.columns[b] as usize, &self.stretch[b]))
        })
    }

    /// The energy, 0 at rest.
    pub(crate) fn value(&self, maps: &[ColumnMap], rotations: &[Matrix]) -> f64 {
        let products = self.stretch(maps);
        let quadratic: f64 = maps.iter().zip(&products).map(|(a, b)| inner(a, b)).sum();
        let fitted = self.fit_matrices(maps);
        let linear: f64 = rotations
            .iter()
            .enumerate()
            .map(|(k, r)| {
                let bend = self.bend_row(k, rotations);
                (0..3).map(|i| dot(&r[i], &fitted[k][i]) + 0.5 * dot(&r[i], &bend[i])).sum::<f64>()
            })
            .sum();
        quadratic - 2.0 * linear + self.constant
    }
}

/// Sum of the products of two maps' numbers.
fn inner(a: &ColumnMap, b: &ColumnMap) -> f64 {
    a.iter().zip(b).map(|(u, v)| dot(u, v)).sum()
}

/// Gradients of the four functions of each column at sample `s`; `None` for a sample of a part that follows another.
fn sample_terms(base: &CoarseBase, bound: &BoundRows, centers: &[Vector], s: usize) -> Option<SampleTerms> {
    let x = base.samples[s] as usize;
    let own = |x: usize| {
        let BlendRow { columns, weights } = bound.rows.row(x);
        columns.iter().copied().zip(weights.iter().copied()).collect::<Vec<_>>()
    };
    let at = own(x);
    if at.iter().any(|(k, _)| *k as usize >= centers.len()) {
        return None;
    }
    let around = base.sample_neighbors.row(s);
    let mut moments = [[0.0; 3]; 3];
    for &t in around {
        let e = subtract(&base.points[base.samples[t as usize] as usize], &base.points[x]);
        let squared = dot(&e, &e);
        if squared > 0.0 {
            add_outer(&mut moments, 1.0 / squared, &e, &e);
        }
    }
    let (inverse, rank) = plane_inverse(&moments);
    let value = |x: usize, k: u32, w: f64| {
        let d = subtract(&base.points[x], &centers[k as usize]);
        [w * d[0], w * d[1], w * d[2], w]
    };
    let mut gradients: Vec<(u32, [Vector; 4])> = Vec::new();
    let mut add = |k: u32, values: [f64; 4], covector: &Vector| {
        let known = gradients.iter().position(|(l, _)| *l == k);
        let slot = known.unwrap_or(gradients.len());
        if known.is_none() {
            gradients.push((k, [[0.0; 3]; 4]));
        }
        for (sum, v) in gradients[slot].1.iter_mut().zip(values) {
            for c in 0..3 {
                sum[c] += v * covector[c];
            }
        }
    };
    let mut total = [0.0; 3];
    for &t in around {
        let y = base.samples[t as usize] as usize;
        let e = subtract(&base.points[y], &base.points[x]);
        let squared = dot(&e, &e);
        if squared == 0.0 {
            continue;
        }
        let covector = image(&inverse, &e.map(|c| c / squared));
        total = [0, 1, 2].map(|c| total[c] - covector[c]);
        for (k, w) in own(y) {
            add(k, value(y, k, w), &covector);
        }
    }
    for &(k, w) in &at {
        add(k, value(x, k, w), &total);
    }
    Some(SampleTerms { area: base.sample_areas[s], rank, own: at, gradients })
}

/// Pseudo-inverse of moments in the plane of the two largest eigenvalues, and the rank.
fn plane_inverse(moments: &Matrix) -> (Matrix, f64) {
    let (values, vectors) = symmetric_eigen(*moments);
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    let (mut inverse, mut rank) = ([[0.0; 3]; 3], 0.0);
    for &k in &order[..2] {
        if values[k] > LINE * values[order[0]] && values[k] > 0.0 {
            let v = [0, 1, 2].map(|i| vectors[i][k]);
            add_outer(&mut inverse, 1.0 / values[k], &v, &v);
            rank += 1.0;
        }
    }
    (inverse, rank)
}

/// Pairs of columns that share a sample, and each with itself.
fn pattern<'a>(n: usize, terms: impl Iterator<Item = &'a SampleTerms>) -> (Vec<usize>, Vec<u32>) {
    let mut rows: Vec<Vec<u32>> = (0..n as u32).map(|k| vec![k]).collect();
    let mut present = vec![Vec::new(); n];
    for term in terms {
        for (k, _) in &term.gradients {
            let row: &mut Vec<u32> = &mut present[*k as usize];
            row.extend(term.gradients.iter().map(|(l, _)| *l));
            if row.len() > 1 << 12 {
                row.sort_unstable();
                row.dedup();
            }
        }
        // A sample whose neighbors coincide with it has values without gradients.
        for (k, _) in &term.own {
            present[*k as usize].extend(term.own.iter().map(|(l, _)| *l));
            present[*k as usize].extend(term.gradients.iter().map(|(l, _)| *l));
        }
    }
    let mut offsets = vec![0];
    let mut columns = Vec::new();
    for (row, mut found) in rows.iter_mut().zip(present) {
        row.append(&mut found);
        row.sort_unstable();
        row.dedup();
        columns.extend_from_slice(row);
        offsets.push(columns.len());
    }
    (offsets, columns)
}
