//! Regions derived from the surface and from other regions: by normals, by connection, enlarged, blurred.

use super::front::FrontSource;
use super::{Length, Region, RegionError, RegionWeights, SurfaceMetric, smooth_rise, weights::welded};
use crate::shape::Adjacency;
use crate::{Cancelled, Progress, parallel};
use nalgebra::Vector3;

/// Number of steps of a blur per squared (length / rms edge length): the lazy walk of `k` steps over edges of
/// length `h` spreads by `σ² = k h²/4` in each direction of a surface.
const STEPS: f64 = 4.0;
/// Largest blur in edge lengths: about 20 000 products.
const WIDEST_BLUR: f64 = 2000.0;
/// Remainder of the walk's polynomial, relative to its largest coefficient, that is omitted.
const NEGLIGIBLE: f64 = 1e-10;

/// Weights `S(n·d / (|d| · falloff))` with the normal n of each vertex.
pub(super) fn facing_weights(
    metric: &SurfaceMetric,
    direction: &[f64; 3],
    falloff: f64,
    progress: Progress<'_>,
) -> Result<RegionWeights, RegionError> {
    let Some(toward) =
        Vector3::from(*direction).try_normalize(0.0).filter(|d| d.iter().all(|c| c.is_finite()))
    else {
        let value = direction.iter().copied().find(|c| !c.is_finite()).unwrap_or(0.0);
        return Err(RegionError::BadNumber { what: "the direction", value, must: "finite, and not 0" });
    };
    if !(0.0..=1.0).contains(&falloff) {
        return Err(RegionError::BadNumber {
            what: "the falloff",
            value: falloff,
            must: "a cosine, in [0, 1]",
        });
    }
    if metric.triangles().is_empty() {
        return Err(RegionError::NeedsFaces("facing"));
    }
    let normals = metric.normals(progress)?;
    Ok(RegionWeights::Welded(parallel::try_collect(normals.len(), progress, |x| {
        let cosine = toward.dot(&Vector3::from(normals[x]));
        if falloff > 0.0 { smooth_rise(cosine / falloff) } else { f64::from(cosine > 0.0) }
    })?))
}

/// Weights that are 1 in the connected component of a vertex.
pub(super) fn component(
    metric: &SurfaceMetric,
    vertex: u32,
    progress: Progress<'_>,
) -> Result<RegionWeights, RegionError> {
    let neighbors = metric.neighbors();
    let mut seen = vec![false; neighbors.n_rows()];
    let mut found = vec![welded(metric, vertex)? as u32];
    seen[found[0] as usize] = true;
    let mut next = 0;
    while next < found.len() {
        if next.is_multiple_of(1 << 14) {
            progress.check()?;
        }
        for &y in neighbors.row(found[next] as usize) {
            if !std::mem::replace(&mut seen[y as usize], true) {
                found.push(y);
            }
        }
        next += 1;
    }
    found.sort_unstable();
    Ok(RegionWeights::Sparse { weights: vec![1.0; found.len()], vertices: found })
}

/// Weights `S(max_y 2 t(y) − d(x, y)/by)` with r = S(t), by one search in which a vertex y starts with the distance
/// `2 by (1 − t(y))`.
pub(super) fn grow(
    metric: &SurfaceMetric,
    weights: &RegionWeights,
    by: Length,
    progress: Progress<'_>,
) -> Result<RegionWeights, RegionError> {
    let by = by.to_model_units(metric.diagonal());
    if !(by.is_finite() && by > 0.0) {
        return Err(RegionError::BadNumber { what: "the growth", value: by, must: "above 0" });
    }
    let sources: Vec<(usize, f64)> = match weights {
        RegionWeights::Everywhere => return Ok(RegionWeights::Everywhere),
        RegionWeights::Sparse { vertices, weights } => {
            vertices.iter().map(|&x| x as usize).zip(weights.iter().copied()).collect()
        }
        other => other.to_mean(metric.vertex_map()).into_iter().enumerate().collect(),
    };
    let sources: Vec<FrontSource> = sources
        .into_iter()
        .filter(|(_, r)| *r > 0.0)
        .map(|(x, r)| metric.vertex_source(x, 2.0 * by * (1.0 - depth(r))))
        .collect();
    let within = metric.find_within(&sources, 2.0 * by, progress)?;
    let weights = within.distances.into_iter().map(|d| smooth_rise(2.0 - d / by)).collect();
    Ok(RegionWeights::Sparse { vertices: within.vertices, weights })
}

/// The t in [0, 1] at which the rise S is `r`, to within 1e-12.
fn depth(r: f64) -> f64 {
    if r >= 1.0 {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if smooth_rise(middle) < r { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Applies [`blur`] to the weights of a region.
pub(super) fn blur_weights(
    metric: &SurfaceMetric,
    weights: &RegionWeights,
    by: Length,
    progress: Progress<'_>,
) -> Result<RegionWeights, RegionError> {
    if matches!(weights, RegionWeights::Everywhere) {
        return Ok(RegionWeights::Everywhere);
    }
    let r = weights.to_mean(metric.vertex_map());
    Ok(RegionWeights::Welded(blur(metric, &r, by.to_model_units(metric.diagonal()), progress)?))
}

/// Mean of `r` at the end of a lazy random walk over the edges: `L^k r` with `L = (1 + P)/2`, where P is the mean
/// over the neighbors and `k = 4 (by/h)²` rounded up, h the root mean square edge length.
///
/// In Chebyshev polynomials `L^k = Σ_d C(2k, k + d) 2^−2k T_|d|(P)`, d from −k to k. The coefficients are those of
/// a fair walk on the line; those beyond about 6.5 standard deviations are omitted. That takes about 10 by/h
/// products instead of k.
pub(super) fn blur(
    metric: &SurfaceMetric,
    r: &[f64],
    by: f64,
    progress: Progress<'_>,
) -> Result<Vec<f64>, RegionError> {
    let edges = by / metric.rms_length(progress)?.max(f64::MIN_POSITIVE);
    if !(0.0..=WIDEST_BLUR).contains(&edges) {
        let what = "the length of the blur, in lengths of an edge,";
        return Err(RegionError::BadNumber { what, value: edges, must: "at most 2000" });
    }
    let n_steps = (STEPS * edges * edges).ceil();
    let coefficients = walk_coefficients(n_steps);
    let neighbors = metric.neighbors();
    let mut sum: Vec<f64> = r.iter().map(|r| coefficients[0] * r).collect();
    let mut before = r.to_vec();
    let mut here = neighbor_mean(neighbors, r, progress, |_, mean| mean)?;
    for &c in &coefficients[1..] {
        for (sum, t) in sum.iter_mut().zip(&here) {
            *sum += c * t;
        }
        let next = neighbor_mean(neighbors, &here, progress, |x, mean| 2.0 * mean - before[x])?;
        (before, here) = (here, next);
    }
    for value in &mut sum {
        *value = value.clamp(0.0, 1.0);
    }
    Ok(sum)
}

/// Computes `then(x, mean over the neighbors of x)`; a vertex without neighbors uses its own value.
fn neighbor_mean(
    neighbors: &Adjacency,
    r: &[f64],
    progress: Progress<'_>,
    then: impl Fn(usize, f64) -> f64 + Sync + Send,
) -> Result<Vec<f64>, Cancelled> {
    parallel::try_collect(r.len(), progress, |x| {
        let around = neighbors.row(x);
        let mean = if around.is_empty() {
            r[x]
        } else {
            around.iter().map(|&y| r[y as usize]).sum::<f64>() / around.len() as f64
        };
        then(x, mean)
    })
}

/// Coefficients of `T_0 … T_D` in `((1 + y)/2)^k`, which sum to 1.
fn walk_coefficients(n_steps: f64) -> Vec<f64> {
    let mut parts = vec![1.0];
    let mut d = 0.0;
    loop {
        let next = parts[parts.len() - 1] * (n_steps - d) / (n_steps + d + 1.0);
        if next < NEGLIGIBLE {
            break;
        }
        parts.push(next);
        d += 1.0;
    }
    for part in &mut parts[1..] {
        *part *= 2.0;
    }
    let total: f64 = parts.iter().sum();
    parts.iter().map(|part| part / total).collect()
}

impl Region {
    /// The region reduced by `by` at its boundary: the complement of the enlarged complement.
    #[must_use]
    pub fn shrink(self, by: Length) -> Self {
        let outside = Self::Not(Box::new(self));
        Self::Not(Box::new(Self::Grown { by, region: Box::new(outside) }))
    }
}

#[cfg(test)]
mod tests {
    use super::walk_coefficients;

    #[test]
    fn the_walks_polynomial_is_its_power() {
        for k in [0.0, 1.0, 2.0, 7.0, 100.0] {
            let coefficients = walk_coefficients(k);
            for y in [-1.0, -0.3, 0.0, 0.5, 0.99, 1.0_f64] {
                let angle = y.acos();
                let sum: f64 = (0..).zip(&coefficients).map(|(d, c)| c * (f64::from(d) * angle).cos()).sum();
                assert!((sum - (0.5 * (1.0 + y)).powf(k)).abs() < 1e-8, "{k} {y}: {sum}");
            }
        }
        assert_eq!(walk_coefficients(0.0), [1.0]);
        // ((1 + y)/2)² = (1 + 2y + y²)/4 = 3/8 + y/2 + T_2/8
        assert_eq!(walk_coefficients(2.0), [3.0 / 8.0, 0.5, 0.125]);
    }
}
