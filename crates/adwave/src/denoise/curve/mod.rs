//! Denoising of the positions of a curve.
//!
//! Along each piece of the curve, a polynomial is fitted to the positions in a window around a vertex, before it, or
//! after it. Windows grow as long as their estimates agree within the noise (the rule of Lepski, as intersection of
//! confidence intervals in `katkovnik1999`), so that they end at corners and bends; the estimates of all sides and
//! degrees are averaged by their variances. At a corner the windows of either side reach up to it, and it stays sharp.
//! Where the curve is smooth, windows of fixed sizes do better; all are mixed by their estimated risk.
//!
//! The noise is estimated along each axis. Axes whose noise is alike share their windows; others have their own.

mod blend;
mod chains;
mod noise;
mod polynomial;
mod rounding;
mod track;

use super::params::CurveDenoising;
use super::{DenoiseError, DenoiseInfo, DenoiseParams, Denoised, FAR};
use crate::rows::Pattern;
use crate::shape::{Graph, PreparedGeometry, Shape, WeldMode, distance, places_without_noise};
use crate::vector::{add_scaled, norm, subtract};
use crate::{Progress, parallel};
use blend::{BLOCK, blended};
use chains::{Chain, chains};
use noise::{CurveNoise, noise_of};
use rounding::{rounding_noise, rounding_steps};
use track::{Positions, Track};

/// Removes noise from the positions of a curve, or of a graph with positions; end points stay. O(n).
pub(super) fn denoise_curve(
    geometry: &PreparedGeometry,
    params: &DenoiseParams,
    progress: Progress<'_>,
) -> Result<Denoised, DenoiseError> {
    let Some(original) = geometry.shape().points() else { return Err(DenoiseError::NoPositions) };
    let Some(edges) = geometry.curve_edges() else {
        let Some(graph) = geometry.shape().as_graph() else { return Err(DenoiseError::NoPositions) };
        let pairs = pairs(graph.adjacency());
        let Ok(curve) = Graph::curve(original.to_vec(), &pairs) else {
            return Err(DenoiseError::NoPositions);
        };
        let geometry = PreparedGeometry::new(&Shape::Graph(curve), WeldMode::EqualPositions, progress)?;
        return denoise_curve(&geometry, params, progress);
    };
    let (points, unit) = geometry.unit_points(progress)?;
    let chains = chains(edges);
    let n_edges = edges.nnz() / 2;
    let length = length_of(&points, edges);
    let places = places_without_noise(&points, edges);
    let positions = Positions { points: &points, places: places.as_deref().unwrap_or(&points[..]) };
    let mut noise = noise_of(&chains, positions, length / n_edges.max(1) as f64, progress)?;
    let steps = rounding_steps(&chains, &points);
    noise.raise_to(steps.map(rounding_noise));
    if let Some(given) = params.noise {
        noise.deviations = [given / unit; 3];
    }
    let found = noise;
    noise.deviations = noise.deviations.map(|s| s * params.strength);
    let is_idle = noise.typical() == 0.0 || n_edges == 0;
    let mut moves = if is_idle {
        vec![[0.0; 3]; points.len()]
    } else {
        moves(&chains, edges, positions, &noise, progress)?
    };
    let is_stopped: Vec<bool> = moves.iter_mut().map(|d| stop_far_move(d, &noise.deviations)).collect();
    let moved: Vec<[f64; 3]> = points.iter().zip(&moves).map(|(p, d)| add_scaled(p, 1.0, d)).collect();
    let length_after = length_of(&moved, edges);
    let mean_length = length_after / n_edges.max(1) as f64;
    let moves = geometry.vertex_map().scatter(&moves, 1);
    let info = DenoiseInfo {
        noise: found.typical() * unit,
        noise_in_edges: if mean_length > 0.0 { found.typical() / mean_length } else { 0.0 },
        kept: if is_idle { 1.0 } else { 0.0 },
        n_sampled: if is_idle { 0 } else { points.len() },
        n_far: is_stopped.into_iter().filter(|is| *is).count(),
        furthest: moves.iter().map(norm).fold(0.0, f64::max) * unit,
        curve: Some(CurveDenoising {
            noise_by_axis: found.deviations.map(|s| s * unit),
            rounding: steps.map(|step| step * unit),
            length: [length * unit, length_after * unit],
        }),
        ..DenoiseInfo::default()
    };
    let moved = |(p, d): (&[f64; 3], &[f64; 3])| if *d == [0.0; 3] { *p } else { add_scaled(p, unit, d) };
    let noise = vec![norm(&found.deviations) * unit; original.len()];
    let points = original.iter().zip(&moves).map(moved).collect();
    Ok(Denoised { points, outliers: Vec::new(), noise, info })
}

/// Shortens a move along each axis to three times the noise there. Returns whether it was longer.
fn stop_far_move(step: &mut [f64; 3], deviations: &[f64; 3]) -> bool {
    let mut is_far = false;
    for (d, s) in step.iter_mut().zip(deviations) {
        is_far |= d.abs() > FAR * s;
        *d = d.clamp(-FAR * s, FAR * s);
    }
    is_far
}

/// Total length of the edges between vertices at `points`.
fn length_of(points: &[[f64; 3]], edges: &Pattern) -> f64 {
    pairs(edges).iter().map(|[x, y]| distance(&points[*x as usize], &points[*y as usize])).sum()
}

/// Edges as pairs with the smaller vertex first.
fn pairs(edges: &Pattern) -> Vec<[u32; 2]> {
    let later = |x: u32| edges.row(x as usize).iter().filter(move |&&y| y > x).map(move |&y| [x, y]);
    (0..edges.n_rows() as u32).flat_map(later).collect()
}

/// Moves of the vertices from the estimates of their chains. Branches belong to several chains.
fn moves(
    chains: &[Chain],
    edges: &Pattern,
    positions: Positions<'_>,
    noise: &CurveNoise,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, DenoiseError> {
    let points = positions.points;
    let groups = noise.groups();
    let mut sums = vec![([0.0; 3], 0.0); points.len()];
    for chain in chains {
        let track = Track::new(chain, positions, noise.parameter);
        let n = chain.vertices.len();
        let blocks = parallel::try_collect(n.div_ceil(BLOCK), progress, |block| {
            blended(&track, block * BLOCK..((block + 1) * BLOCK).min(n), &groups)
        })?;
        for (&x, estimate) in chain.vertices.iter().zip(blocks.into_iter().flatten()) {
            let (sum, weight) = &mut sums[x as usize];
            let share = 1.0 / (estimate.variance * estimate.variance);
            *sum = add_scaled(sum, share, &subtract(&estimate.point, &points[x as usize]));
            *weight += share;
        }
    }
    let is_moved = |x: usize| edges.row(x).len() > 1;
    let mean = |(x, (sum, weight)): (usize, ([f64; 3], f64))| {
        if is_moved(x) && weight > 0.0 && weight.is_finite() { sum.map(|c| c / weight) } else { [0.0; 3] }
    };
    Ok(sums.into_iter().enumerate().map(mean).collect())
}
