//! Diffusion operator of a surface or a curve: heat by its Laplace–Beltrami operator, instead of a walk.

use super::dispersion::mean_dispersion;
use super::spectrum::largest_eigenvalue;
use super::{Diffusion, EndPoints, Masses, OperatorParams, Semigroup};
use crate::laplacian::{Laplacian, LaplacianInfo};
use crate::parallel;
use crate::rows::{CompressedRows, try_visit_entries};
use crate::shape::{PreparedGeometry, Shape, sphere_radius, squared_distance};
use crate::{Cancelled, Progress};

/// Share of vertices whose mass is raised.
const RAISED: f64 = 0.01;

/// Largest `τ·L(x,x)/M(x)` of a vertex, which limits the number of products for every shape: if edges are 1400
/// times shorter than the mean, masses are raised whatever the number of their vertices.
const MAX_RATE: f64 = 1e6;

/// Relative rounding of a quotient and a product.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Number of reported stages: weights, masses, operator.
const STAGES: u64 = 3;

/// Diffusion operator of a surface with its areas, in the analysis order.
#[derive(Clone, Debug)]
pub struct SurfaceDiffusion {
    /// The operator `Φ₁ = I − M⁻¹L/λ`; n steps of the bands are `exp(−n·rate·(I − Φ₁))`.
    pub diffusion: Diffusion,
    /// Areas of the welded vertices in squared model units (1 for a graph; lengths in model units on a curve).
    pub areas: Vec<f64>,
    /// Mean edge length in model units (1 for a graph).
    pub mean_length: f64,
    /// Changes made to the shape.
    pub info: SurfaceInfo,
}

/// Changes made to a shape for the heat operator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceInfo {
    /// Changes made to the triangles of a mesh.
    pub laplacian: LaplacianInfo,
    /// Share of the total mass that was added to vertices which would dominate the cost.
    pub added_mass: f64,
    /// Number of vertices whose mass was raised.
    pub n_raised: usize,
}

/// Heat on the surface: `S_n = exp(−n·τ·M⁻¹L)`, with M and L of [`Laplacian`].
///
/// One step is the time `τ = A/(4√3·N)`, with the area A and the number N of vertices that have neighbors. This
/// equals a step of the walk (eq. 4) on equilateral triangles of that size, `σ² = 4τ = E²/2`. On a graph `σ² = ½`,
/// as for the walk. On a curve of length ℓ, `τ = (ℓ/N)²/4`: half of the mean edge length squared is the variance
/// along the curve after a step, and σ² = 4τ as on a surface, so that the kernel is `exp(−d²/σ²)` on both.
///
/// With [`EndPoints::Keep`] the rows of the end points of a curve are those of the identity: an end keeps its value,
/// and a straight line its shape up to the ends. Such a row has no part in the bound of the error, which is at most
/// doubled.
///
/// `Φ₁ = I − M⁻¹L/λ` has entries ≥ 0 and rows that sum to 1. Since λ is at least the largest eigenvalue of M⁻¹L,
/// its eigenvalues are in [0, 1]; it is reversible, with π = M. The number of products grows with √λ, which the
/// smallest and thinnest triangles determine. So the mass of the 1 % of vertices with the largest `L(x,x)/M(x)` is
/// raised until this is no larger than elsewhere, and no larger than 10⁶/τ; not on a graph. With [`Masses::Exact`] only
/// the second bound holds. O(n log n).
///
/// A mesh slows down short waves. On a mesh of a sphere about the origin, such as a map of the sky, this is made up for to
/// first order where [`OperatorParams::corrects_dispersion`] asks for it: `S_n = exp(−n·τ·(A + κA²))`, `A = M⁻¹L`, with the
/// mean κ of the mesh's fourth-order error, or as much of it as improves all places. Then a value may leave the range of
/// the signal by the size of the error that is left.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
pub fn surface_diffusion(
    geometry: &PreparedGeometry,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<SurfaceDiffusion, Cancelled> {
    progress.step(0, STAGES)?;
    let laplacian = Laplacian::new(geometry, params.neighbors, progress)?;
    progress.step(1, STAGES)?;
    let (mean_length, info) = (laplacian.mean_length(), *laplacian.info());
    let is_curve = geometry.curve_edges().is_some();
    let is_graph =
        matches!(geometry.shape(), Shape::Graph(graph) if graph.cell_areas().is_none()) && !is_curve;
    let areas = laplacian.areas();
    let (weights, mut mass, unit) = laplacian.into_parts();
    let n = mass.len();
    let stiffness = parallel::try_collect(n, progress, |x| weights.row(x).1.iter().sum::<f64>())?;
    let total = parallel::try_sum(n, progress, |x| mass[x])?;
    // Length of a step; see above. A vertex without neighbors takes no step and does not affect the others.
    let n_moving = parallel::try_sum(n, progress, |x| if stiffness[x] > 0.0 { 1.0 } else { 0.0 })?;
    let tau = if is_graph {
        let mean_degree = parallel::try_sum(n, progress, |x| stiffness[x])? / n_moving.max(1.0);
        0.5 / mean_degree.max(f64::MIN_POSITIVE)
    } else if is_curve {
        0.25 * (total / n_moving.max(1.0)).powi(2)
    } else {
        total / (4.0 * 3.0_f64.sqrt() * n_moving.max(1.0))
    };
    let n_raised = if is_graph { 0 } else { raise(&mut mass, &stiffness, tau, params.masses, progress)? };
    let added = parallel::try_sum(n, progress, |x| mass[x])? - total;
    progress.step(2, STAGES)?;
    let lambda = largest_eigenvalue(&weights, &mass, &stiffness, progress)?;
    let is_sphere = || geometry.shape().is_mesh() && sphere_radius(geometry.points()).is_some();
    let dispersion = if params.corrects_dispersion && is_sphere() {
        lambda * mean_dispersion(&geometry.unit_points(progress)?.0, &weights, &mass, progress)?
    } else {
        0.0
    };
    let hop_square = if is_graph { mean_hop_square(geometry, &weights) } else { 0.0 };
    let (pattern, mut values) = weights.into_parts();
    let is_kept = kept_ends(geometry, params.end_points);
    let moves = lambda > 0.0;
    let mut per_row = vec![(); n];
    try_visit_entries(&pattern, &mut values, &mut per_row, progress, |range, values, _| {
        let first = pattern.range(range.start).start;
        for x in range {
            let entries = pattern.range(x);
            for w in &mut values[entries.start - first..entries.end - first] {
                *w = if moves && !is_kept[x] { *w / (mass[x] * lambda) } else { 0.0 };
            }
        }
    })?;
    let step_length = match (is_graph, moves) {
        (_, false) => 0.0,
        (true, true) => (0.5 * hop_square).sqrt(),
        (false, true) => 2.0 * tau.sqrt() * unit,
    };
    let semigroup = Semigroup::Heat { rate: if moves { tau * lambda } else { 1.0 }, dispersion };
    let diffusion = Diffusion::from_heat_weights(pattern, values, mass, step_length, semigroup, progress)?;
    progress.step(STAGES, STAGES)?;
    let added_mass = if total > 0.0 { added / total } else { 0.0 };
    let info = SurfaceInfo { laplacian: info, added_mass, n_raised };
    Ok(SurfaceDiffusion { diffusion, areas, mean_length, info })
}

/// Mean square length of the edges of a graph with equal weight per unit of edge weight; 1 without positions.
fn mean_hop_square(geometry: &PreparedGeometry, weights: &CompressedRows<f64>) -> f64 {
    let points = geometry.points();
    let (mut sum, mut squares) = (0.0, 0.0);
    for x in 0..points.len() {
        let (columns, weights) = weights.row(x);
        for (&y, w) in columns.iter().zip(weights) {
            sum += w;
            squares += w * squared_distance(&points[x], &points[y as usize]);
        }
    }
    if sum > 0.0 { squares / sum } else { 1.0 }
}

/// Flags of the welded vertices that keep their values.
fn kept_ends(geometry: &PreparedGeometry, end_points: EndPoints) -> Vec<bool> {
    let mut is_kept = vec![false; geometry.n_vertices()];
    if end_points == EndPoints::Keep {
        for x in geometry.curve_ends() {
            is_kept[x] = true;
        }
    }
    is_kept
}

/// Raises masses until no vertex has a larger `stiffness/mass` than all but [`RAISED`] of them (unless masses are to be
/// exact), or than [`MAX_RATE`] per step. Returns the number of raised masses.
fn raise(
    mass: &mut [f64],
    stiffness: &[f64],
    tau: f64,
    masses: Masses,
    progress: Progress<'_>,
) -> Result<usize, Cancelled> {
    let mut rates: Vec<f64> =
        mass.iter().zip(stiffness).filter(|(_, s)| **s > 0.0).map(|(m, s)| s / m).collect();
    progress.check()?;
    let share = match masses {
        Masses::Raised => RAISED,
        Masses::Exact => 0.0,
    };
    let kept = ((1.0 - share) * rates.len() as f64) as usize;
    if rates.is_empty() {
        return Ok(0);
    }
    let kept = kept.min(rates.len() - 1);
    rates.select_nth_unstable_by(kept, f64::total_cmp);
    let largest = |of: &[f64]| of.iter().copied().filter(|r| r.is_finite()).fold(0.0, f64::max);
    // If more vertices have no mass at all, the largest finite value is used, or any.
    let cap = match rates[kept] {
        cap if cap.is_finite() => cap,
        _ => largest(&rates),
    };
    let most = if tau > 0.0 { MAX_RATE / tau } else { f64::INFINITY };
    let cap = if cap > 0.0 { cap.min(most) } else { most.min(1.0) };
    let mut n_raised = 0;
    for (m, s) in mass.iter_mut().zip(stiffness) {
        let least = s / cap;
        // The vertex that sets the bound is as it was, up to rounding.
        n_raised += usize::from(*m < least * (1.0 - ROUNDING));
        *m = m.max(least);
    }
    Ok(n_raised)
}
