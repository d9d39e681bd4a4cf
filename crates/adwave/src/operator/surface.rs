//! The diffusion operator of a surface: heat by its Laplace–Beltrami operator, in place of a walk over the mesh.

use super::spectrum::largest_eigenvalue;
use super::{Diffusion, OperatorParams, Semigroup};
use crate::laplacian::{Laplacian, LaplacianInfo};
use crate::parallel;
use crate::rows::try_for_entries;
use crate::shape::PreparedGeometry;
use crate::{Cancelled, Progress};

/// The share of vertices whose mass is raised.
const RAISED: f64 = 0.01;

/// No vertex has `τ·L(x,x)/M(x)` above this, so that no shape takes products without end: where edges are 1400 times shorter
/// than the mean, masses are raised however many vertices there are.
const MAX_RATE: f64 = 1e6;

/// Stages that are reported: weights, masses, operator.
const STAGES: u64 = 3;

/// What a surface needs for diffusion on it, in the analysis order.
#[derive(Clone, Debug)]
pub struct SurfaceDiffusion {
    /// `Φ₁ = I − M⁻¹L/λ`, of which bands take `exp(−n·rate·(I − Φ₁))` for n steps.
    pub diffusion: Diffusion,
    /// Areas of the welded vertices in squared model units (1 for a graph).
    pub areas: Vec<f64>,
    /// Mean length of edges in model units (1 for a graph).
    pub mean_length: f64,
    /// What was done to the shape on the way.
    pub info: SurfaceInfo,
}

/// What was done to a shape on the way to heat on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceInfo {
    /// What became of the triangles of a mesh.
    pub laplacian: LaplacianInfo,
    /// The part of all mass that was added to that of vertices which would set the cost for all.
    pub added_mass: f64,
}

/// Heat on the surface: `S_n = exp(−n·τ·M⁻¹L)`, M and L of [`Laplacian`].
///
/// One step is the time `τ = A/(4√3·N)`, A the area and N the number of vertices that have neighbors: as much as a step of
/// the walk (eq. 4) on equilateral triangles of that size, `σ² = 4τ = E²/2`. On a graph `σ² = ½`, as the walk has it.
///
/// `Φ₁ = I − M⁻¹L/λ` has entries ≥ 0, rows that sum to 1 and, λ being at least the largest eigenvalue of M⁻¹L, its own
/// eigenvalues in [0, 1]; it is reversible, with π = M. The number of products grows with √λ, which the smallest and thinnest
/// triangles set. So the mass of the 1 % of vertices with the largest `L(x,x)/M(x)` is raised until that is no larger than
/// elsewhere, and no larger than 10⁶/τ; not on a graph. O(n log n).
///
/// # Errors
/// [`Cancelled`].
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
    // What a step is: see above. A vertex without neighbors takes none, and changes nothing for the others.
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
    try_for_entries(&pattern, &mut values, &mut per_row, progress, |range, values, _| {
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
    let diffusion = Diffusion::of_heat(pattern, values, mass, step_length, semigroup, progress)?;
    progress.step(STAGES, STAGES)?;
    let added_mass = if total > 0.0 { added / total } else { 0.0 };
    Ok(SurfaceDiffusion { diffusion, areas, mean_length, info: SurfaceInfo { laplacian: info, added_mass } })
}

/// Raises masses until no vertex has a larger `stiffness/mass` than all but [`RAISED`] of them, or than [`MAX_RATE`] in a step.
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
    // Where more than that have no mass at all: the largest that is finite, or any.
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
