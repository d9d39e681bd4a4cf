//! The prepared object: a shape with its walk, ready to split any number of signals.

use crate::Progress;
use crate::bands::{
    Bands, BandsError, BandsParams, Schedule, check_signal, decompose, default_levels, weighted_bands,
};
use crate::basis::{BasisError, SparseRow, one_vertex};
use crate::filter::{Edit, FilterError};
use crate::operator::{Diffusion, OperatorParams, local_operator};
use crate::shape::{Adjacency, Domain, Health, Shape, health};
use rayon::prelude::*;

/// The functions of one vertex on one level, one value a vertex of the shape; welded vertices have the value of the one
/// vertex that they are, so sums are over the vertices of the analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexFunctions {
    /// φ: ≥ 0, sums to 1.
    pub scaling_function: Vec<f64>,
    /// ψ: sums to 0.
    pub wavelet: Vec<f64>,
    /// How many vertices of the analysis φ reaches.
    pub support: usize,
}

/// A shape with its walk. Preparing costs O(n log n) once; each signal then costs its products only.
///
/// ```
/// use adwave::bands::{BandsParams, Schedule};
/// use adwave::{Decomposer, Progress, operator::OperatorParams};
/// use adwave::shape::{PointCloud, Shape};
/// let points: Vec<_> = (0..100).map(|i| [f64::from(i), 0.0, 0.0]).collect();
/// let shape = Shape::Cloud(PointCloud::new(points.clone())?);
/// let decomposer = Decomposer::new(&shape, &OperatorParams::default());
/// let bands = decomposer.decompose(points.as_flattened(), 3, &Schedule::dyadic(4)?, &BandsParams::default(), Progress::none())?;
/// assert_eq!(bands.steps, [0, 1, 2, 4, 8]);
/// let rebuilt = bands.reconstruct();
/// assert!(rebuilt.iter().zip(points.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Decomposer {
    domain: Domain,
    diffusion: Diffusion,
    /// Areas of the vertices of the analysis.
    areas: Vec<f64>,
    mean_length: f64,
    diagonal: f64,
}

impl Decomposer {
    /// Welds the shape and builds its walk. O(n log n).
    pub fn new(shape: &Shape, params: &OperatorParams) -> Self {
        let domain = Domain::new(shape, params.weld);
        let operator = local_operator(shape, &domain, params);
        let (areas, mean_length) = (operator.areas.clone(), operator.mean_length);
        Self { domain, diffusion: Diffusion::new(operator), areas, mean_length, diagonal: shape.diagonal() }
    }

    /// The vertices of the analysis and how they belong to those of the shape.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// One step of the walk, Φ₁, in the numbering of [`domain`](Self::domain).
    pub fn diffusion(&self) -> &Diffusion {
        &self.diffusion
    }

    /// The vertices that one step of the walk can reach, in the numbering of [`domain`](Self::domain).
    pub fn neighbours(&self) -> &Adjacency {
        self.diffusion.neighbours()
    }

    /// Number of vertices of the shape.
    pub fn n_vertices(&self) -> usize {
        self.domain.weld.n_vertices()
    }

    /// Length of the bounding box's diagonal in model units; 0 for a graph.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// `E`, the mean length of edges or the mean distance to the nearest neighbours, in model units.
    pub fn mean_length(&self) -> f64 {
        self.mean_length
    }

    /// The area of every vertex of the shape in squared model units; welded vertices share theirs equally.
    pub fn areas(&self) -> Vec<f64> {
        let mut shares = vec![0_u32; self.domain.n_vertices()];
        for &class in self.domain.weld.classes() {
            shares[class as usize] += 1;
        }
        let share: Vec<f64> = self.areas.iter().zip(shares).map(|(a, n)| a / f64::from(n)).collect();
        self.domain.weld.scatter(&share, 1)
    }

    /// Counts of what the shape consists of.
    pub fn health(&self, shape: &Shape) -> Health {
        health(shape, &self.domain, self.neighbours())
    }

    /// The number of dyadic levels to take where none is asked for, and why (see [`default_levels`]).
    pub fn default_levels(&self) -> (usize, String) {
        default_levels(self.diffusion.step_length(), self.diagonal)
    }

    /// Splits `signal` (n_vertices × n_channels, row-major, in the order of the shape) into bands.
    ///
    /// # Errors
    /// As [`decompose`].
    pub fn decompose(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        params: &BandsParams,
        progress: Progress<'_>,
    ) -> Result<Bands, BandsError> {
        decompose(&self.diffusion, &self.domain.weld, signal, n_channels, schedule, params, progress)
    }

    /// The scaling function and the wavelet of one vertex of the shape on the last level of `schedule`, as functions on the
    /// vertices of the shape; see [`one_vertex`].
    ///
    /// # Errors
    /// [`BasisError`] when there is no such vertex, or when cancelled.
    pub fn basis_of_vertex(
        &self,
        vertex: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<VertexFunctions, BasisError> {
        let n_vertices = self.n_vertices();
        if vertex >= n_vertices {
            return Err(BasisError::NoVertex { vertex, n_vertices });
        }
        let class = self.domain.weld.class_of(vertex);
        let steps = schedule.steps_from_zero();
        let [.., before, last] = steps[..] else { unreachable!("a schedule has a level") };
        let functions = one_vertex(&self.diffusion, class, before, last, 0.0, progress)?;
        let dense = |row: &SparseRow| self.domain.weld.scatter(&row.to_dense(self.domain.n_vertices()), 1);
        Ok(VertexFunctions {
            scaling_function: dense(&functions.scaling),
            wavelet: dense(&functions.wavelet),
            support: functions.scaling.columns.len(),
        })
    }

    /// Edits a signal: `f′ = f + Σ_j (Γ(j,x) − 1)·W_f(j,x)` with `Γ(j,x) = Π_layers (1 + r(x)·(g_j − 1))`.
    ///
    /// The same as eq. 18, since `f = S_f(J) + Σ_j W_f(j)`, and exact where nothing is edited: a vertex outside all regions
    /// keeps its value to the last bit. The order of the layers does not matter.
    ///
    /// One layer by itself costs about as much as its coarsest band; several cost all bands.
    ///
    /// # Errors
    /// [`FilterError`] when gains or regions do not fit, or the bands cannot be computed.
    pub fn filter(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        edit: &Edit<'_>,
        params: &BandsParams,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, FilterError> {
        let n_levels = schedule.n_levels();
        let mut resolved = Vec::with_capacity(edit.layers.len());
        for (k, layer) in edit.layers.iter().enumerate() {
            let gains = layer.gains.resolve(n_levels)?;
            let weights = layer
                .region
                .weights(self, edit.field, edit.field_names)
                .map_err(|source| FilterError::Region { layer: k + 1, source })?;
            resolved.push((gains, weights));
        }
        check_signal(signal, self.n_vertices(), n_channels)?;
        let mut edited = signal.to_vec();
        if let [(gains, weights)] = resolved.as_slice() {
            // Γ − 1 = r·(g − 1): the region's weight stands before the sum over the bands, which is one polynomial of Φ₁.
            let factors: Vec<f64> = gains.iter().map(|g| g - 1.0).collect();
            let (weld, diffusion) = (&self.domain.weld, &self.diffusion);
            let (change, _) =
                weighted_bands(diffusion, weld, signal, n_channels, schedule, &factors, params, progress)?;
            edited.par_chunks_mut(n_channels).with_min_len(1 << 12).enumerate().for_each(|(x, row)| {
                for (value, change) in row.iter_mut().zip(&change[x * n_channels..]) {
                    *value += weights[x] * change;
                }
            });
            return Ok(edited);
        }
        let bands = self.decompose(signal, n_channels, schedule, params, progress)?;
        edited.par_chunks_mut(n_channels).with_min_len(1 << 12).enumerate().for_each(|(x, row)| {
            for (j, band) in bands.wavelet.iter().enumerate() {
                let gamma: f64 = resolved.iter().map(|(gains, r)| 1.0 + r[x] * (gains[j] - 1.0)).product();
                if gamma != 1.0 {
                    for (value, w) in row.iter_mut().zip(&band[x * n_channels..]) {
                        *value += (gamma - 1.0) * w;
                    }
                }
            }
        });
        Ok(edited)
    }
}
