//! Feature map: critical points of a function smoothed by the heat kernel at several scales.
//!
//! Source: reference 45 of `houqin2013`. `f_t = e^(−tΔ) f`; the number of sign changes of `f_t − f_t(x)` around the
//! link of x distinguishes maxima, minima and saddles. Strength: the points are topologically meaningful and obey
//! Euler's formula. Weakness: features on a slope are missed, because they are not critical points of `f_t` at any
//! scale.

use crate::laplacian::{LaplacianMatrices, LaplacianParams};
use crate::linalg::{LinalgError, SymmetricMatrix};
use crate::sgwt::{Polynomial, apply_polynomials, largest_eigenvalue};
use adwave::Progress;
use adwave::shape::{PreparedGeometry, Shape, WeldMode, one_ring};
use thiserror::Error;

/// Reason for which a feature map cannot be computed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum FeatureMapError {
    /// The shape has no faces and therefore no vertex links.
    #[error("critical points need a mesh; this shape is a cloud or a graph")]
    NotAMesh,
    /// The signal has the wrong length or is not finite.
    #[error("the signal must have {expected} finite values, one per vertex; got {got} values")]
    Signal {
        /// Number of values expected.
        expected: usize,
        /// Number of values given.
        got: usize,
    },
    /// A time is negative, not finite or too long.
    #[error(
        "time {index} must be finite, at least 0 and short enough for a polynomial of degree {most} to \
        represent e^(−tΔ); got {time}"
    )]
    Time {
        /// Index of the time.
        index: usize,
        /// Value of the time, in squared model units.
        time: f64,
        /// Largest degree of the polynomial.
        most: usize,
    },
    /// A linear algebra step failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

/// Kind of a critical point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CriticalKind {
    /// All neighbors have smaller values.
    Maximum,
    /// All neighbors have larger values.
    Minimum,
    /// The sign changes at least four times around the link.
    Saddle,
}

/// Critical point of a smoothed signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalPoint {
    /// Vertex in the order of the shape, the first of those at its position.
    pub vertex: usize,
    /// Kind of the point.
    pub kind: CriticalKind,
    /// Multiplicity: 1 for maxima and minima, m for a saddle with 2m + 2 sign changes.
    pub multiplicity: usize,
    /// Smoothed value at the vertex.
    pub value: f64,
}

/// Critical points at one scale.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureLevel {
    /// Time t, in squared model units.
    pub time: f64,
    /// Smoothed function, in the order of the shape.
    pub smoothed: Vec<f64>,
    /// Critical points in ascending order of the welded vertex.
    pub points: Vec<CriticalPoint>,
    /// Sum `Σ index(x)` of the indices, which is the Euler characteristic of the mesh.
    pub index_sum: i64,
}

/// Largest error of `e^(−tΔ)`, relative to the function.
const ACCURACY: f64 = 1e-10;
/// Largest degree of the polynomial, for which the largest t is about 5·10⁵ / λ_max.
const MAX_DEGREE: usize = 8192;

/// Finds the critical points of `signal` (one value per vertex) after smoothing for each of `times` (squared model
/// units). Ties between equal values are broken by vertex index, so that every function is in general position
/// (`edelsbrunner1990`). O(n · √(t·λ_max)) for each time.
///
/// # Errors
/// [`FeatureMapError`].
pub fn feature_map(
    shape: &Shape,
    signal: &[f64],
    times: &[f64],
    progress: Progress<'_>,
) -> Result<Vec<FeatureLevel>, FeatureMapError> {
    if !shape.is_mesh() {
        return Err(FeatureMapError::NotAMesh);
    }
    if signal.len() != shape.n_vertices() || signal.iter().any(|v| !v.is_finite()) {
        return Err(FeatureMapError::Signal { expected: shape.n_vertices(), got: signal.len() });
    }
    let laplacian = LaplacianMatrices::new(shape, &LaplacianParams::default())?;
    let geometry =
        PreparedGeometry::new(shape, WeldMode::default(), progress.quiet()).map_err(LinalgError::from)?;
    let mut first_vertex = vec![usize::MAX; laplacian.n()];
    for x in 0..shape.n_vertices() {
        let class = laplacian.vertex_map.welded(x);
        first_vertex[class] = first_vertex[class].min(x);
    }
    let heat = Heat::new(&laplacian);
    let mean = laplacian.vertex_map.mean(signal, 1);
    let mut levels = Vec::new();
    for (index, &time) in times.iter().enumerate() {
        let bad = || FeatureMapError::Time { index, time, most: MAX_DEGREE };
        if !(time.is_finite() && time >= 0.0) {
            return Err(bad());
        }
        let smoothed = heat.flow(&mean, time, progress)?.ok_or_else(bad)?;
        let (mut points, index_sum) = critical_points(geometry.triangles(), &smoothed);
        for p in &mut points {
            p.vertex = first_vertex[p.vertex];
        }
        levels.push(FeatureLevel {
            time,
            smoothed: laplacian.vertex_map.scatter(&smoothed, 1),
            points,
            index_sum,
        });
    }
    Ok(levels)
}

/// Heat flow of the symmetric matrix `M^(−½) S M^(−½)`.
struct Heat {
    matrix: SymmetricMatrix,
    root: Vec<f64>,
    lambda_max: f64,
}

impl Heat {
    fn new(laplacian: &LaplacianMatrices) -> Self {
        // A vertex without mass has no row in S and keeps its value.
        let root: Vec<f64> = laplacian.mass.iter().map(|&m| if m > 0.0 { m.sqrt() } else { 1.0 }).collect();
        let inverse: Vec<f64> = root.iter().map(|r| 1.0 / r).collect();
        let matrix = laplacian.stiffness.scale_symmetrically(&inverse);
        let lambda_max = largest_eigenvalue(&matrix);
        Self { matrix, root, lambda_max }
    }

    /// Computes `e^(−tΔ) f`; `None` if the degree of the polynomial would be too high.
    fn flow(&self, f: &[f64], time: f64, progress: Progress<'_>) -> Result<Option<Vec<f64>>, LinalgError> {
        let stiff = time * self.lambda_max;
        if stiff <= 0.0 {
            return Ok(Some(f.to_vec()));
        }
        // The degree grows with the square root of the stiffness.
        let mut degree = 16 + (4.0 * stiff.sqrt()) as usize;
        let polynomial = loop {
            if degree > MAX_DEGREE {
                return Ok(None);
            }
            let p = Polynomial::interpolate(|l| (-time * l).exp(), self.lambda_max, degree);
            if p.error <= ACCURACY {
                break p;
            }
            degree *= 2;
        };
        let scaled: Vec<f64> = f.iter().zip(&self.root).map(|(f, r)| f * r).collect();
        let mut out = apply_polynomials(&self.matrix, &[polynomial], &scaled, progress)?;
        Ok(out.pop().map(|o| o.iter().zip(&self.root).map(|(o, r)| o / r).collect()))
    }
}

/// Finds the critical points of a function on triangles, and the sum of their indices.
///
/// The index of x is `1 − (lower neighbors) + (triangles whose highest corner is x)`, the Euler characteristic of its
/// lower star; inside a surface this equals `1 − ½(sign changes around the link)`. The indices sum to the Euler
/// characteristic of any triangle complex, including those with a boundary and non-manifold ones.
pub fn critical_points(triangles: &[[u32; 3]], f: &[f64]) -> (Vec<CriticalPoint>, i64) {
    let ring = one_ring(f.len(), triangles);
    let lower = |y: u32, x: u32| (f[y as usize], y) < (f[x as usize], x);
    let mut distinct: Vec<[u32; 3]> = triangles
        .iter()
        .filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
        .map(|t| {
            let mut sorted = *t;
            sorted.sort_unstable();
            sorted
        })
        .collect();
    distinct.sort_unstable();
    distinct.dedup();
    let (mut topped, mut changes) = (vec![0_i64; f.len()], vec![0_usize; f.len()]);
    for t in &distinct {
        for k in 0..3 {
            let (x, y, z) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            topped[x as usize] += i64::from(lower(y, x) && lower(z, x));
            changes[x as usize] += usize::from(lower(y, x) != lower(z, x));
        }
    }
    let (mut points, mut sum) = (Vec::new(), 0);
    for x in 0..f.len() as u32 {
        let neighbors = ring.row(x as usize);
        if neighbors.is_empty() {
            continue;
        }
        let below = neighbors.iter().filter(|&&y| lower(y, x)).count();
        let index = 1 - below as i64 + topped[x as usize];
        sum += index;
        let kind = if below == 0 {
            CriticalKind::Minimum
        } else if below == neighbors.len() && changes[x as usize] == 0 {
            CriticalKind::Maximum
        } else if index < 0 {
            CriticalKind::Saddle
        } else {
            continue;
        };
        let multiplicity = if kind == CriticalKind::Saddle { (-index) as usize } else { 1 };
        points.push(CriticalPoint { vertex: x as usize, kind, multiplicity, value: f[x as usize] });
    }
    (points, sum)
}

#[cfg(test)]
mod tests;
