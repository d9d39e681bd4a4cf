//! Mesh saliency: the difference between the mean curvature at one scale and at twice that scale.
//!
//! Source: `lee2005`. Strength: five fixed scales relative to the size of the model, without parameters. Weaknesses:
//! balls in space mix sheets that do not touch, the cost grows with the vertex density, and the signal is always the
//! curvature of a mesh.

use adwave::shape::{PreparedGeometry, Shape, WeldMode, diagonal, one_ring};
use adwave::vector::{cross, dot, norm, subtract};
use adwave::{Cancelled, Progress};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;
use thiserror::Error;

/// Reason for which the saliency cannot be computed.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum LeeError {
    /// The shape has no faces and therefore no curvature.
    #[error("mesh saliency needs a mesh; this shape is a cloud or a graph")]
    NotAMesh,
    /// The caller cancelled the call.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Widths σ of the five scales, in multiples of ε.
const SCALES: [f64; 5] = [2.0, 3.0, 4.0, 5.0, 6.0];
/// Length ε, as a fraction of the bounding box's diagonal.
const EPSILON: f64 = 0.003;
/// Radius of the Gaussian's support, in σ.
const CUT: f64 = 2.0;
/// Widths that occur as σ or 2σ, in multiples of ε.
const WIDTHS: [f64; 8] = [2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0];
/// Number of vertices processed between two checks of the progress handle.
const AT_A_TIME: usize = 8192;

/// Saliency of the vertices and its intermediate results, in the order of the shape.
#[derive(Clone, Debug, PartialEq)]
pub struct LeeSaliency {
    /// Saliency `Σ_i N(𝒮_i)`, at least 0.
    pub saliency: Vec<f64>,
    /// Mean curvature in 1 / model units, positive where the surface bulges along its normals.
    pub curvature: Vec<f64>,
    /// Maps `𝒮_i = |G(H, σ_i) − G(H, 2σ_i)|` of the scales, before normalization.
    pub scales: Vec<Vec<f64>>,
    /// Widths σ_i of the scales, in model units.
    pub sigma: [f64; 5],
}

/// Computes the saliency of a mesh. O(n log n + pairs of vertices closer than 7.2 % of the diagonal).
///
/// `G(H, σ)(v) = Σ H(x) e^(−|x−v|²/2σ²) / Σ e^(−|x−v|²/2σ²)` over `|x − v| ≤ 2σ`. The normalization scales each map to
/// [0, 1] and multiplies it by `(1 − m̄)²`, where m̄ is the mean of its local maxima other than the largest. Mean
/// curvature is the trace of Taubin's tensor, the area-weighted mean of `2 n·(v − x)/|v − x|²` over the one-ring.
///
/// # Errors
/// [`LeeError`].
pub fn lee_saliency(shape: &Shape, progress: Progress<'_>) -> Result<LeeSaliency, LeeError> {
    if !shape.is_mesh() {
        return Err(LeeError::NotAMesh);
    }
    let geometry = PreparedGeometry::new(shape, WeldMode::default(), progress.quiet())?;
    let size = diagonal(geometry.points());
    // In units of ε every relevant length is of the order of one.
    let epsilon = if size > 0.0 { EPSILON * size } else { 1.0 };
    let points: Vec<[f64; 3]> = geometry.points().iter().map(|p| p.map(|c| c / epsilon)).collect();
    let ring = one_ring(points.len(), geometry.triangles());
    let curvature = mean_curvature(&points, geometry.triangles());
    let gaussians = gaussians(&points, &curvature, progress)?;
    let mut saliency = vec![0.0; points.len()];
    let mut scales = Vec::new();
    for sigma in SCALES {
        let at = |width: f64| WIDTHS.iter().position(|&w| w == width).expect("a width of the list");
        let (fine, coarse) = (at(sigma), at(2.0 * sigma));
        let map: Vec<f64> = gaussians.iter().map(|g| (g[fine] - g[coarse]).abs()).collect();
        for (sum, value) in saliency.iter_mut().zip(normalize_map(&map, &ring)) {
            *sum += value;
        }
        scales.push(geometry.vertex_map().scatter(&map.iter().map(|v| v / epsilon).collect::<Vec<_>>(), 1));
    }
    let curvature: Vec<f64> = curvature.iter().map(|h| h / epsilon).collect();
    Ok(LeeSaliency {
        saliency: geometry.vertex_map().scatter(&saliency, 1),
        curvature: geometry.vertex_map().scatter(&curvature, 1),
        scales,
        sigma: SCALES.map(|s| s * epsilon),
    })
}

/// Computes the mean curvature by Taubin's tensor (`taubin1995tensor`), whose trace is the mean of the directional
/// curvatures. With the normals of [`sphere_normals`] it is exact on a sphere; area-weighted normals would leave an
/// error of first order in the edge length.
fn mean_curvature(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<f64> {
    let normals = sphere_normals(points, triangles);
    let mut sum = vec![(0.0, 0.0); points.len()];
    for t in triangles {
        let [a, b, c] = t.map(|v| points[v as usize]);
        let (u, v) = (subtract(&b, &a), subtract(&c, &a));
        let area = norm(&cross(&u, &v));
        for k in 0..3 {
            let x = t[k] as usize;
            for y in [t[(k + 1) % 3], t[(k + 2) % 3]] {
                let d = subtract(&points[x], &points[y as usize]);
                let length = dot(&d, &d);
                if length > 0.0 {
                    sum[x].0 += area * 2.0 * dot(&normals[x], &d) / length;
                    sum[x].1 += area;
                }
            }
        }
    }
    sum.into_iter().map(|(h, w)| if w > 0.0 { h / w } else { 0.0 }).collect()
}

/// Computes unit normals `Σ (a × b)/(|a|²|b|²)` over the triangles at a vertex, where a and b are their edges at this
/// vertex. They are exact if all these edges end on a sphere through the vertex (`max1999`).
fn sphere_normals(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<[f64; 3]> {
    let mut sum = vec![[0.0; 3]; points.len()];
    for t in triangles {
        for k in 0..3 {
            let [x, y, z] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]].map(|v| points[v as usize]);
            let (a, b) = (subtract(&y, &x), subtract(&z, &x));
            let weight = dot(&a, &a) * dot(&b, &b);
            if weight > 0.0 {
                let n = cross(&a, &b);
                for c in 0..3 {
                    sum[t[k] as usize][c] += n[c] / weight;
                }
            }
        }
    }
    sum.into_iter()
        .map(|n| {
            let length = norm(&n);
            if length > 0.0 { n.map(|c| c / length) } else { n }
        })
        .collect()
}

/// Computes `G(H, σ)` for all widths at every vertex.
fn gaussians(points: &[[f64; 3]], h: &[f64], progress: Progress<'_>) -> Result<Vec<[f64; 8]>, Cancelled> {
    let reach = CUT * WIDTHS[WIDTHS.len() - 1];
    let tree: ImmutableKdTree<f64, 3> =
        ImmutableKdTree::new_from_slice(points).expect("the tree is built from finitely many finite points");
    let mut all = Vec::with_capacity(points.len());
    for (piece, chunk) in points.chunks(AT_A_TIME).enumerate() {
        progress.step((piece * AT_A_TIME) as u64, points.len() as u64)?;
        let part: Vec<[f64; 8]> = chunk
            .par_iter()
            .map(|p| {
                let mut near: Vec<(f64, u32)> = tree
                    .query(p)
                    .within::<SquaredEuclidean<f64>>(reach * reach * (1.0 + 1e-12))
                    .unsorted()
                    .execute()
                    .into_iter()
                    .map(|hit| (hit.distance, hit.item))
                    .collect();
                // The order of summation is fixed.
                near.sort_unstable_by_key(|e| e.1);
                let (mut sum, mut total) = ([0.0; 8], [0.0; 8]);
                for (squared, y) in near {
                    for (k, width) in WIDTHS.iter().enumerate() {
                        if squared <= CUT * CUT * width * width {
                            let g = (-squared / (2.0 * width * width)).exp();
                            sum[k] += g * h[y as usize];
                            total[k] += g;
                        }
                    }
                }
                std::array::from_fn(|k| if total[k] > 0.0 { sum[k] / total[k] } else { 0.0 })
            })
            .collect();
        all.extend(part);
    }
    Ok(all)
}

/// Scales a map to [0, 1] and promotes maps with a few strong peaks (`itti1998`).
fn normalize_map(map: &[f64], ring: &adwave::shape::Adjacency) -> Vec<f64> {
    let top = map.iter().copied().fold(0.0, f64::max);
    if top <= 0.0 {
        return vec![0.0; map.len()];
    }
    let is_peak = |x: usize| !ring.row(x).is_empty() && ring.row(x).iter().all(|&y| map[y as usize] < map[x]);
    let peaks: Vec<f64> =
        (0..map.len()).filter(|&x| is_peak(x) && map[x] < top).map(|x| map[x] / top).collect();
    let mean = if peaks.is_empty() { 0.0 } else { peaks.iter().sum::<f64>() / peaks.len() as f64 };
    map.iter().map(|v| v / top * (1.0 - mean).powi(2)).collect()
}

#[cfg(test)]
mod tests;
