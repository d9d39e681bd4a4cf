//! Bilateral normal filtering (`zheng2011`).

use super::faces::{
    BilateralWidths, FaceGeometry, FaceLists, Faces, filter_normals, gaussian, mean_distance,
};
use super::vertex_update::{Border, fixed_vertices, move_vertices};
use super::{
    FaceNeighbors, NormalFilterError, check_iterations, check_positive, to_shape_order, unit_points,
};
use crate::linalg::conjugate_gradients;
use adwave::Progress;
use adwave::shape::PreparedGeometry;
use adwave::vector::{Vector, unit};
use rayon::prelude::*;

/// Scheme that filters the normals.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NormalScheme {
    /// Repeats the filter; each round takes its weights from the normals of the previous round.
    Local {
        /// Number of rounds.
        iterations: usize,
    },
    /// Minimizes `(1 − s)·‖n − P n‖² + s·‖n − n⁰‖²`, where P is the filter with the weights of the noisy normals n⁰.
    Global {
        /// Weight s of the noisy normals, in (0, 1]; the smaller it is, the smoother is the result.
        smoothness: f64,
    },
}

/// Parameters of [`bilateral_normals`]. The defaults are those in the program of `zhang2015`, which contains this
/// method as well. The authors of the method choose the range weight for each mesh, from 0.2 to 0.6.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BilateralParams {
    /// Faces over which is averaged; by default those that share a vertex.
    pub neighbors: FaceNeighbors,
    /// Width σ_c, in mean distances of the centroids of faces that share an edge; 1 by default.
    pub sigma_c: f64,
    /// Width σ_s, a distance of unit normals, which is 2 sin of half the angle between them; 0.35 by default.
    pub sigma_s: f64,
    /// Scheme that filters the normals; local with 20 rounds by default.
    pub scheme: NormalScheme,
    /// Number of rounds of the vertex update; 10 by default.
    pub vertex_iterations: usize,
    /// Movement of the vertices at the border; fixed by default.
    pub border: Border,
}

impl Default for BilateralParams {
    fn default() -> Self {
        Self {
            neighbors: FaceNeighbors::ByVertex,
            sigma_c: 1.0,
            sigma_s: 0.35,
            scheme: NormalScheme::Local { iterations: 20 },
            vertex_iterations: 10,
            border: Border::Fixed,
        }
    }
}

impl BilateralParams {
    /// Sets the width of the range weight.
    #[must_use]
    pub fn with_sigma_s(self, sigma_s: f64) -> Self {
        Self { sigma_s, ..self }
    }

    /// Sets the scheme that filters the normals.
    #[must_use]
    pub fn with_scheme(self, scheme: NormalScheme) -> Self {
        Self { scheme, ..self }
    }

    /// Sets the number of rounds of the vertex update.
    #[must_use]
    pub fn with_vertex_iterations(self, vertex_iterations: usize) -> Self {
        Self { vertex_iterations, ..self }
    }

    fn check(&self) -> Result<(), NormalFilterError> {
        check_positive("sigma_c", self.sigma_c)?;
        check_positive("sigma_s", self.sigma_s)?;
        check_iterations("vertex iterations", self.vertex_iterations)?;
        match self.scheme {
            NormalScheme::Local { iterations } => check_iterations("normal iterations", iterations),
            NormalScheme::Global { smoothness } if smoothness > 0.0 && smoothness <= 1.0 => Ok(()),
            NormalScheme::Global { smoothness: value } => {
                Err(NormalFilterError::Parameter { name: "smoothness", value, wanted: "in (0, 1]" })
            }
        }
    }
}

/// Relative residual to which the equations of the global scheme are solved.
const RESIDUAL: f64 = 1e-8;
const MAX_CG_ITERATIONS: usize = 100_000;

/// Denoises a mesh by bilateral filtering of its normals; returns positions in model units, in the order of the shape.
///
/// The normals are filtered by `n_f ← unit(Σ_g A_g · e^(−‖c_f − c_g‖²/2σ_c²) · e^(−‖n_f − n_g‖²/2σ_s²) · n_g)` over the
/// neighbors g, where A are the areas and c the centroids of the noisy mesh. Then
/// [`update_vertices`](super::update_vertices) moves the vertices. Faces without area start without a normal and
/// without weight, and take the normals of their neighbors. The normals of neighbors with opposite orientation have the
/// largest possible distance. O(rounds · pairs of neighbors).
///
/// # Errors
/// [`NormalFilterError`].
///
/// ```
/// use adwave::{Progress, sample::{NoiseSigma, Sample}, shape::*};
/// use adwave_baselines::normal_filter::{BilateralParams, bilateral_normals};
/// let mut sphere = Sample::from_name("sphere", Some(500))?;
/// sphere.add_noise(NoiseSigma::MeanEdge(0.1), 1)?;
/// let shape = Shape::Mesh(Mesh::new(sphere.points.clone(), sphere.faces)?);
/// let geometry = PreparedGeometry::new(&shape, WeldMode::default(), Progress::none())?;
/// let points = bilateral_normals(&geometry, &BilateralParams::default(), Progress::none())?;
/// let roughness = |points: &[[f64; 3]]| points.iter().map(|p| (adwave::vector::norm(p) - 1.0).abs()).sum::<f64>();
/// assert!(roughness(&points) < 0.7 * roughness(&sphere.points));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn bilateral_normals(
    geometry: &PreparedGeometry,
    params: &BilateralParams,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, NormalFilterError> {
    params.check()?;
    let faces = Faces::new(geometry)?;
    let (mut points, unit) = unit_points(geometry);
    let measures = faces.measure(&points);
    let neighbors = faces.neighbors(params.neighbors);
    let space = params.sigma_c * mean_distance(&faces.pairs_across_edges(), &measures.centroids);
    let widths = BilateralWidths { space, range: params.sigma_s };
    let normals = match params.scheme {
        NormalScheme::Local { iterations } => local(&measures, &neighbors, widths, iterations, progress)?,
        NormalScheme::Global { smoothness } => {
            global(&measures, &neighbors, widths, smoothness, progress.quiet())?
        }
    };
    let stays = fixed_vertices(&faces, points.len(), params.border);
    for _ in 0..params.vertex_iterations {
        progress.check()?;
        points = move_vertices(&faces, &points, &normals, &stays);
    }
    Ok(to_shape_order(geometry, &points, unit))
}

fn local(
    measures: &FaceGeometry,
    neighbors: &FaceLists,
    widths: BilateralWidths,
    iterations: usize,
    progress: Progress<'_>,
) -> Result<Vec<Vector>, NormalFilterError> {
    let mut normals = measures.normals.clone();
    for round in 0..iterations {
        progress.step(round as u64, iterations as u64)?;
        normals = filter_normals(measures, &normals, &normals, neighbors, widths);
    }
    Ok(normals)
}

/// Solves `((1 − s)·MᵀM + s) n = s·n⁰`, `M = I − D⁻¹KA`, by conjugate gradients. The matrix K of the weights without
/// areas is symmetric, so that `Mᵀy = y − AKD⁻¹y` needs no transposed matrix.
fn global(
    measures: &FaceGeometry,
    neighbors: &FaceLists,
    widths: BilateralWidths,
    smoothness: f64,
    progress: Progress<'_>,
) -> Result<Vec<Vector>, NormalFilterError> {
    let (normals, centroids, areas) = (&measures.normals, &measures.centroids, &measures.areas);
    let n = normals.len();
    let kernel: Vec<Vec<f64>> = (0..n)
        .into_par_iter()
        .map(|f| {
            let weight = |&g: &u32| {
                let g = g as usize;
                gaussian(&centroids[f], &centroids[g], widths.space)
                    * gaussian(&normals[f], &normals[g], widths.range)
            };
            neighbors.list(f).iter().map(weight).collect()
        })
        .collect();
    let product = |x: &[f64], f: usize| -> f64 {
        neighbors.list(f).iter().zip(&kernel[f]).map(|(&g, k)| k * x[g as usize]).sum()
    };
    let inverse: Vec<f64> = (0..n)
        .into_par_iter()
        .map(|f| {
            let sum = product(areas, f);
            if sum > 0.0 { 1.0 / sum } else { 0.0 }
        })
        .collect();
    let apply = |x: &[f64], y: &mut [f64]| {
        let weighted: Vec<f64> = x.iter().zip(areas).map(|(x, a)| x * a).collect();
        let moved: Vec<f64> = (0..n)
            .into_par_iter()
            // A face whose neighbors have no weight keeps its normal.
            .map(|f| if inverse[f] > 0.0 { x[f] - inverse[f] * product(&weighted, f) } else { 0.0 })
            .collect();
        let scaled: Vec<f64> = moved.iter().zip(&inverse).map(|(m, i)| m * i).collect();
        y.par_iter_mut().enumerate().for_each(|(f, y)| {
            let back = moved[f] - areas[f] * product(&scaled, f);
            *y = (1.0 - smoothness) * back + smoothness * x[f];
        });
    };
    let mut found = vec![[0.0; 3]; n];
    for c in 0..3 {
        let noisy: Vec<f64> = normals.iter().map(|v| smoothness * v[c]).collect();
        let (x, _) = conjugate_gradients(apply, &noisy, RESIDUAL, MAX_CG_ITERATIONS, progress)?;
        found.iter_mut().zip(x).for_each(|(v, x)| v[c] = x);
    }
    Ok(found.iter().zip(normals).map(|(v, noisy)| unit(v).unwrap_or(*noisy)).collect())
}
