//! Differential coordinates, the positions of vertices relative to their neighbors, and the reconstruction of a surface
//! from them.
//!
//! Source: `sorkine2004`, `lipman2004`.
//!
//! ```text
//! δ = L f,  (L f)(x) = f(x) − Σ_y p(x,y) f(y),  Σ_y p(x,y) = 1
//! f = argmin ‖L f − δ‖² + Σ_a w_a² ‖f(a) − c(a)‖²
//! ```
//! Strength: when a handle is dragged, the details follow at the cost of one solve per move. Weaknesses: there is a
//! single band, details do not rotate with the handle, and the result depends on the positions of the anchors.

use crate::laplacian::{LaplacianMatrices, LaplacianParams};
use crate::linalg::{Ldlt, LinalgError, SymmetricMatrix};
use adwave::Progress;
use adwave::operator::Diffusion;
use adwave::shape::{PreparedGeometry, Shape, VertexMap, WeldMode, one_ring};
use rayon::prelude::*;
use thiserror::Error;

/// Weights of the mean over the neighbors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Weights {
    /// Equal weights for all neighbors: the umbrella operator.
    Uniform,
    /// Cotangent weights on the intrinsic Delaunay triangulation, so that no weight is negative; heat kernel weights
    /// on a cloud, edge weights on a graph.
    #[default]
    Cotangent,
}

/// Reason for which differential coordinates or their reconstruction cannot be computed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DifferentialError {
    /// The linear system could not be solved.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// A signal has the wrong length.
    #[error("expected {expected} values, got {got}")]
    Length {
        /// Number of values expected.
        expected: usize,
        /// Number of values given.
        got: usize,
    },
    /// An anchor names a vertex that does not exist or has an invalid weight.
    #[error(
        "anchor {anchor} (counted from 0) names vertex {vertex} with weight {weight}; the vertex must be \
        below {n_vertices} and the weight finite and above 0"
    )]
    BadAnchor {
        /// Index of the anchor.
        anchor: usize,
        /// Vertex of the anchor.
        vertex: usize,
        /// Weight of the anchor.
        weight: f64,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// A connected component has no anchor, so its position is undetermined.
    #[error("the component of vertex {vertex} has no anchor; add an anchor to it")]
    NoAnchor {
        /// Vertex of the component.
        vertex: usize,
    },
}

/// Operator `L = I − P` of a shape, where `P` is a mean over the neighbors. The row of a vertex without neighbors is
/// empty. The eigenvalues lie in [0, 2].
#[derive(Clone, Debug)]
pub struct Differential {
    offsets: Vec<usize>,
    columns: Vec<u32>,
    /// Weights p(x, y), one per stored neighbor.
    weights: Vec<f64>,
    vertex_map: VertexMap,
}

impl Differential {
    /// Builds the operator L of `shape`. O(n log n).
    ///
    /// # Errors
    /// [`DifferentialError::Linalg`] if weights overflow.
    ///
    /// ```
    /// use adwave::shape::{Graph, Shape};
    /// use adwave_baselines::differential::{Differential, Weights};
    /// let path = Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 3.0)])?);
    /// let l = Differential::new(&path, Weights::Cotangent)?;
    /// assert_eq!(l.coordinates(&[0.0, 0.0, 4.0], 1)?, [0.0, -3.0, 4.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(shape: &Shape, weights: Weights) -> Result<Self, DifferentialError> {
        let (rows, vertex_map): (Vec<Vec<(u32, f64)>>, VertexMap) =
            if let (Weights::Uniform, Shape::Mesh(_)) = (weights, shape) {
                let geometry = PreparedGeometry::new(shape, WeldMode::default(), Progress::none())
                    .map_err(LinalgError::from)?;
                let ring = one_ring(geometry.n_vertices(), geometry.triangles());
                let row = |x: usize| ring.row(x).iter().map(|&y| (y, 1.0)).collect();
                ((0..geometry.n_vertices()).map(row).collect(), geometry.vertex_map().clone())
            } else {
                let laplacian = LaplacianMatrices::new(shape, &LaplacianParams::default())?;
                let row = |x: usize| {
                    let (columns, values) = laplacian.stiffness.row(x);
                    let off = columns.iter().zip(values).filter(|&(&y, &s)| y as usize != x && s < 0.0);
                    off.map(|(&y, &s)| (y, if weights == Weights::Uniform { 1.0 } else { -s })).collect()
                };
                ((0..laplacian.n()).map(row).collect(), laplacian.vertex_map)
            };
        Ok(Self::from_rows(&rows, vertex_map))
    }

    /// Builds the operator L from a diffusion operator: `L = 2(I − Φ₁) = 2Ψ₁`, `Ψ₁(x,y) = −T(x,y)/2T(x,x)`,
    /// `Ψ₁(x,x) = ½` (eq. 16), so that `W_f(1)` is half the differential coordinate.
    pub fn from_diffusion(walk: &Diffusion, vertex_map: VertexMap) -> Self {
        let row = |x: usize| {
            let (columns, values) = walk.row(x);
            // K = 2(I − Φ₁) = I − P, whose diagonal P(x,x) = 2Φ₁(x,x) − 1 is 0 on the lazy walk.
            let stays = (!columns.is_empty()).then(|| (x as u32, 2.0 * walk.diagonal(x) - 1.0));
            let steps = columns.iter().copied().zip(values.iter().map(|w| 2.0 * w));
            steps.chain(stays.filter(|s| s.1 != 0.0)).collect()
        };
        Self::from_rows(&(0..walk.n_vertices()).map(row).collect::<Vec<_>>(), vertex_map)
    }

    fn from_rows(rows: &[Vec<(u32, f64)>], vertex_map: VertexMap) -> Self {
        let mut l = Self { offsets: vec![0], columns: Vec::new(), weights: Vec::new(), vertex_map };
        for row in rows {
            let total: f64 = row.iter().map(|e| e.1).sum();
            if total > 0.0 {
                l.columns.extend(row.iter().map(|e| e.0));
                l.weights.extend(row.iter().map(|e| e.1 / total));
            }
            l.offsets.push(l.columns.len());
        }
        l
    }

    /// Number of rows, that of the welded vertices.
    pub fn n(&self) -> usize {
        self.offsets.len() - 1
    }

    fn row(&self, x: usize) -> (&[u32], &[f64]) {
        let range = self.offsets[x]..self.offsets[x + 1];
        (&self.columns[range.clone()], &self.weights[range])
    }

    /// Computes `L f` for the welded vertices, row-major, n × n_channels.
    pub(crate) fn apply(&self, f: &[f64], n_channels: usize) -> Vec<f64> {
        let mut out = vec![0.0; f.len()];
        out.par_chunks_exact_mut(n_channels.max(1)).with_min_len(1024).enumerate().for_each(|(x, out)| {
            let (columns, weights) = self.row(x);
            let here = &f[x * n_channels..][..n_channels];
            for (&y, &p) in columns.iter().zip(weights) {
                for ((out, &there), &here) in
                    out.iter_mut().zip(&f[y as usize * n_channels..][..n_channels]).zip(here)
                {
                    *out += p * (here - there);
                }
            }
        });
        out
    }

    /// Computes `Lᵀ f` for the welded vertices, row-major, n × n_channels.
    fn apply_transposed(&self, f: &[f64], n_channels: usize) -> Vec<f64> {
        let mut out = vec![0.0; f.len()];
        for x in 0..self.n() {
            let (columns, weights) = self.row(x);
            for c in 0..n_channels {
                let here = f[x * n_channels + c];
                if !columns.is_empty() {
                    out[x * n_channels + c] += here;
                }
                for (&y, &p) in columns.iter().zip(weights) {
                    out[y as usize * n_channels + c] -= p * here;
                }
            }
        }
        out
    }

    /// Converts a signal from the vertices of the shape to the welded vertices.
    pub(crate) fn weld_signal(
        &self,
        signal: &[f64],
        n_channels: usize,
    ) -> Result<Vec<f64>, DifferentialError> {
        let expected = self.vertex_map.n_vertices() * n_channels;
        if signal.len() != expected || n_channels == 0 {
            return Err(DifferentialError::Length { expected, got: signal.len() });
        }
        Ok(self.vertex_map.mean(signal, n_channels))
    }

    /// Converts values from the welded vertices to the vertices of the shape.
    pub(crate) fn scatter(&self, values: &[f64], n_channels: usize) -> Vec<f64> {
        self.vertex_map.scatter(values, n_channels)
    }

    /// Computes `δ = L f` of a signal, n_vertices × n_channels, in the order of the shape. O(entries).
    ///
    /// # Errors
    /// [`DifferentialError::Length`].
    pub fn coordinates(&self, signal: &[f64], n_channels: usize) -> Result<Vec<f64>, DifferentialError> {
        let mean = self.weld_signal(signal, n_channels)?;
        Ok(self.vertex_map.scatter(&self.apply(&mean, n_channels), n_channels))
    }

    /// Computes the normal matrix `LᵀL + diag(extra)`.
    fn normal_matrix(&self, extra: &[f64]) -> Result<SymmetricMatrix, LinalgError> {
        let mut entries = Vec::new();
        for x in 0..self.n() {
            let (columns, weights) = self.row(x);
            if columns.is_empty() {
                continue;
            }
            let row: Vec<(u32, f64)> = std::iter::once((x as u32, 1.0))
                .chain(columns.iter().zip(weights).map(|(&y, &p)| (y, -p)))
                .collect();
            for (i, &(a, va)) in row.iter().enumerate() {
                entries.extend(row[i..].iter().map(|&(b, vb)| (a.min(b), a.max(b), va * vb)));
            }
        }
        Ok(SymmetricMatrix::from_halves(self.n(), &entries)?.add_diagonal(extra))
    }

    fn find_unanchored_component(&self, anchored: &[f64]) -> Option<usize> {
        let n = self.n();
        let mut stack: Vec<usize> = (0..n).filter(|&x| anchored[x] > 0.0).collect();
        let mut reached: Vec<bool> = anchored.iter().map(|&w| w > 0.0).collect();
        while let Some(x) = stack.pop() {
            for &y in self.row(x).0 {
                if !std::mem::replace(&mut reached[y as usize], true) {
                    stack.push(y as usize);
                }
            }
        }
        (0..self.vertex_map.n_vertices()).find(|&x| !reached[self.vertex_map.welded(x)])
    }
}

/// Soft constraint on the position, or the signal value, of one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// Vertex, in the order of the shape.
    pub vertex: usize,
    /// Weight w, above 0, relative to the weight 1 of every differential coordinate.
    pub weight: f64,
}

/// Factorization of `LᵀL + W²` for a set of anchors; each move of the anchors costs one solve.
#[derive(Debug)]
pub struct Reconstruction<'a> {
    differential: &'a Differential,
    anchors: Vec<Anchor>,
    factor: Ldlt,
}

impl<'a> Reconstruction<'a> {
    /// Prepares the reconstruction with `anchors`; costs one sparse factorization.
    ///
    /// # Errors
    /// [`DifferentialError`] for an anchor that does not exist, a component without an anchor, or a failed
    /// factorization.
    pub fn new(differential: &'a Differential, anchors: &[Anchor]) -> Result<Self, DifferentialError> {
        let n_vertices = differential.vertex_map.n_vertices();
        let mut squares = vec![0.0; differential.n()];
        for (index, &Anchor { vertex, weight }) in anchors.iter().enumerate() {
            if vertex >= n_vertices || !(weight.is_finite() && weight > 0.0) {
                return Err(DifferentialError::BadAnchor { anchor: index, vertex, weight, n_vertices });
            }
            squares[differential.vertex_map.welded(vertex)] += weight * weight;
        }
        if let Some(vertex) = differential.find_unanchored_component(&squares) {
            return Err(DifferentialError::NoAnchor { vertex });
        }
        let factor = Ldlt::new(&differential.normal_matrix(&squares)?, 0.0)?;
        Ok(Self { differential, anchors: anchors.to_vec(), factor })
    }

    /// Computes the signal whose differential coordinates are nearest to `coordinates` (n_vertices × n_channels), and
    /// whose values at the anchors are near `targets` (anchors × n_channels). The signal is in the order of the shape.
    /// Costs two sweeps through the factor.
    ///
    /// # Errors
    /// [`DifferentialError::Length`].
    pub fn solve(
        &self,
        coordinates: &[f64],
        targets: &[f64],
        n_channels: usize,
    ) -> Result<Vec<f64>, DifferentialError> {
        let l = self.differential;
        let delta = l.weld_signal(coordinates, n_channels)?;
        let expected = self.anchors.len() * n_channels;
        if targets.len() != expected {
            return Err(DifferentialError::Length { expected, got: targets.len() });
        }
        let mut right = l.apply_transposed(&delta, n_channels);
        for (anchor, target) in self.anchors.iter().zip(targets.chunks_exact(n_channels)) {
            let x = l.vertex_map.welded(anchor.vertex);
            for (c, &t) in target.iter().enumerate() {
                right[x * n_channels + c] += anchor.weight * anchor.weight * t;
            }
        }
        let n = l.n();
        let mut columns: Vec<f64> = (0..n_channels)
            .flat_map(|c| (0..n).map(move |x| (x, c)))
            .map(|(x, c)| right[x * n_channels + c])
            .collect();
        self.factor.solve_columns(&mut columns);
        for c in 0..n_channels {
            for x in 0..n {
                right[x * n_channels + c] = columns[c * n + x];
            }
        }
        Ok(l.vertex_map.scatter(&right, n_channels))
    }
}

#[cfg(test)]
mod tests;
