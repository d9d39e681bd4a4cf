//! Diffusion operator of a surface: heat by its Laplace–Beltrami operator, instead of a walk over the mesh.

use super::spectrum::largest_eigenvalue;
use super::{Diffusion, OperatorParams, Semigroup};
use crate::laplacian::{Laplacian, LaplacianInfo};
use crate::parallel;
use crate::rows::try_visit_entries;
use crate::shape::PreparedGeometry;
use crate::{Cancelled, Progress};

/// Share of vertices whose mass is raised.
const RAISED: f64 = 0.01;

/// Largest `τ·L(x,x)/M(x)` of a vertex, which limits the number of products for every shape: if edges are 1400
/// times shorter than the mean, masses are raised whatever the number of their vertices.
const MAX_RATE: f64 = 1e6;

/// Number of reported stages: weights, masses, operator.
const STAGES: u64 = 3;

/// Diffusion operator of a surface with its areas, in the analysis order.
#[derive(Clone, Debug)]
pub struct SurfaceDiffusion {
    /// The operator `Φ₁ = I − M⁻¹L/λ`; n steps of the bands are `exp(−n·rate·(I − Φ₁))`.
    pub diffusion: Diffusion,
    /// Areas of the welded vertices in squared model units (1 for a graph).
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
}

/// Heat on the surface: `S_n = exp(−n·τ·M⁻¹L)`, with M and L of [`Laplacian`].
///
/// One step is the time `τ = A/(4√3·N)`, with the area A and the number N of vertices that have neighbors. This
/// equals a step of the walk (eq. 4) on equilateral triangles of that size, `σ² = 4τ = E²/2`. On a graph `σ² = ½`,
/// as for the walk.
///
/// `Φ₁ = I − M⁻¹L/λ` has entries ≥ 0 and rows that sum to 1. Since λ is at least the largest eigenvalue of M⁻¹L,
/// its eigenvalues are in [0, 1]; it is reversible, with π = M. The number of products grows with √λ, which the
/// smallest and thinnest triangles determine. So the mass of the 1 % of vertices with the largest `L(x,x)/M(x)` is
/// raised until this is no larger than elsewhere, and no larger than 10⁶/τ; not on a graph. O(n log n).
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
    let is_graph = geometry.points().is_empty();
    let (weights, mut mass, unit) = laplacian.into_parts();
    let n = mass.len();
    let areas = parallel::try_collect(n, progress, |x| mass[x] * unit * unit)?;
    let stiffness = parallel::try_collect(n, progress, |x| weights.row(x).1.iter().sum::<f64>())?;
    let total = parallel::try_sum(n, progress, |x| mass[x])?;
    // Length of a step; see above. A vertex without neighbors takes no step and does not affect the others.
    let n_moving = parallel::try_sum(n, progress, |x| if stiffness[x] > 0.0 { 1.0 } else { 0.0 })?;
    let tau = if is_graph {
        let mean_degree = parallel::try_sum(n, progress, |x| stiffness[x])? / n_moving.max(1.0);
        0.5 / mean_degree.max(f64::MIN_POSITIVE)
    } else {
        total / (4.0 * 3.0_f64.sqrt() * n_moving.max(1.0))
    };
    if !is_graph {
        raise(&mut mass, &stiffness, tau, progress)?;
    }
    let added = parallel::try_sum(n, progress, |x| mass[x])? - total;
    progress.step(2, STAGES)?;
    let lambda = largest_eigenvalue(&weights, &mass, &stiffness, progress)?;
    let (pattern, mut values) = weights.into_parts();
    let moves = lambda > 0.0;
    let mut per_row = vec![(); n];
    try_visit_entries(&pattern, &mut values, &mut per_row, progress, |range, values, _| {
        let first = pattern.range(range.start).start;
        for x in range {
            let entries = pattern.range(x);
            for w in &mut values[entries.start - first..entries.end - first] {
                *w = if moves { *w / (mass[x] * lambda) } else { 0.0 };
            }
        }
    })?;
    let step_length = match (is_graph, moves) {
        (_, false) => 0.0,
        (true, true) => 0.5_f64.sqrt(),
        (false, true) => 2.0 * tau.sqrt() * unit,
    };
    let semigroup = Semigroup::Heat { rate: if moves { tau * lambda } else { 1.0 } };
    let diffusion = Diffusion::from_heat_weights(pattern, values, mass, step_length, semigroup, progress)?;
    progress.step(STAGES, STAGES)?;
    let added_mass = if total > 0.0 { added / total } else { 0.0 };
    Ok(SurfaceDiffusion { diffusion, areas, mean_length, info: SurfaceInfo { laplacian: info, added_mass } })
}

/// Raises masses until no vertex has a larger `stiffness/mass` than all but [`RAISED`] of them, or than
/// [`MAX_RATE`] per step.
fn raise(mass: &mut [f64], stiffness: &[f64], tau: f64, progress: Progress<'_>) -> Result<(), Cancelled> {
    let mut rates: Vec<f64> =
        mass.iter().zip(stiffness).filter(|(_, s)| **s > 0.0).map(|(m, s)| s / m).collect();
    progress.check()?;
    let kept = ((1.0 - RAISED) * rates.len() as f64) as usize;
    if rates.is_empty() {
        return Ok(());
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
    for (m, s) in mass.iter_mut().zip(stiffness) {
        *m = m.max(s / cap);
    }
    Ok(())
}
