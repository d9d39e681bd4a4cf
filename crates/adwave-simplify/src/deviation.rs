//! Distances between two surfaces.

use crate::wedges::{doubled_area, length, minus};
use adwave::{Cancelled, Progress};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::TriMesh;
use rayon::prelude::*;

/// One-sided distance: from sample points of one surface to the nearest points of another, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OneSided {
    /// Largest distance.
    pub greatest: f64,
    /// Root mean square `√(Σ a d² / Σ a)`, where a is the area that a sample point represents.
    pub rms: f64,
}

/// Two-sided distance of a simplified shape from the original, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// From each vertex of the original to the nearest point of the simplified shape.
    pub of_original: OneSided,
    /// From the simplified shape to the nearest point of the original: from the center and the edge midpoints of each
    /// triangle. Vertices are those of the original, at distance 0.
    pub of_simplified: OneSided,
}

impl Deviation {
    /// Larger of both largest distances, a lower bound of the Hausdorff distance.
    pub fn greatest(&self) -> f64 {
        self.of_original.greatest.max(self.of_simplified.greatest)
    }

    /// Larger of both root mean squares.
    pub fn rms(&self) -> f64 {
        self.of_original.rms.max(self.of_simplified.rms)
    }

    /// Scales all distances.
    pub(crate) fn scaled_by(self, unit: f64) -> Self {
        let times = |side: OneSided| OneSided { greatest: unit * side.greatest, rms: unit * side.rms };
        Self { of_original: times(self.of_original), of_simplified: times(self.of_simplified) }
    }
}

/// Triangles in a bounding volume hierarchy.
pub(crate) struct TriangleSurface(TriMesh);

impl TriangleSurface {
    /// Builds the hierarchy in O(triangles log triangles); `None` without triangles.
    pub(crate) fn new(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Option<Self> {
        let mut index = vec![u32::MAX; points.len()];
        let mut used = Vec::new();
        let mut compact = |x: u32| {
            let index = &mut index[x as usize];
            if *index == u32::MAX {
                *index = used.len() as u32;
                let [x, y, z] = points[x as usize];
                used.push(Vector::new(x, y, z));
            }
            *index
        };
        let triangles = triangles.iter().map(|t| t.map(&mut compact)).collect();
        TriMesh::new(used, triangles).ok().map(Self)
    }

    /// Returns the distance to the nearest point and its triangle, in O(log triangles) for points near the surface.
    pub(crate) fn nearest(&self, p: [f64; 3]) -> (f64, u32) {
        let point = Vector::new(p[0], p[1], p[2]);
        let (projection, (triangle, _)) = self.0.project_local_point_and_get_location(point, true);
        let q = projection.point;
        (length(minus([q.x, q.y, q.z], p)), triangle)
    }
}

/// Items that a thread processes at a time; the sums do not depend on the number of threads.
const ITEMS_PER_CHUNK: usize = 1 << 10;

/// One-sided distance, and the items beyond a limit, increasing.
pub(crate) struct Measured {
    pub(crate) side: OneSided,
    pub(crate) far: Vec<u32>,
}

/// Accumulates the distances and areas of the samples of n items.
fn accumulate<const N: usize>(
    n: usize,
    limit: f64,
    progress: Progress<'_>,
    samples: impl Fn(usize) -> [(f64, f64); N] + Sync,
) -> Result<Measured, Cancelled> {
    let chunk = |c: usize| {
        progress.check()?;
        let (mut greatest, mut squares, mut area, mut far) = (0.0_f64, 0.0, 0.0, Vec::new());
        for k in c * ITEMS_PER_CHUNK..((c + 1) * ITEMS_PER_CHUNK).min(n) {
            let mut item_max = 0.0_f64;
            for (distance, a) in samples(k) {
                item_max = item_max.max(distance);
                squares += a * distance * distance;
                area += a;
            }
            greatest = greatest.max(item_max);
            if item_max > limit {
                far.push(k as u32);
            }
        }
        Ok((greatest, squares, area, far))
    };
    let chunks: Vec<_> =
        (0..n.div_ceil(ITEMS_PER_CHUNK)).into_par_iter().map(chunk).collect::<Result<_, Cancelled>>()?;
    let (mut greatest, mut squares, mut area, mut far) = (0.0_f64, 0.0, 0.0, Vec::new());
    for chunk in chunks {
        greatest = greatest.max(chunk.0);
        squares += chunk.1;
        area += chunk.2;
        far.extend(chunk.3);
    }
    let rms = if area > 0.0 { f64::sqrt(squares / area) } else { 0.0 };
    Ok(Measured { side: OneSided { greatest, rms }, far })
}

/// Measures distances from the vertices of a mesh, weighted by `areas`, to another surface; those of `is_on` lie on it.
pub(crate) fn measure_vertices(
    points: &[[f64; 3]],
    areas: &[f64],
    is_on: &[bool],
    to: &TriangleSurface,
    limit: f64,
    progress: Progress<'_>,
) -> Result<Measured, Cancelled> {
    let distance = |x: usize| if is_on[x] { 0.0 } else { to.nearest(points[x]).0 };
    accumulate(points.len(), limit, progress, |x| [(distance(x), areas[x])])
}

/// Measures distances from the centers and edge midpoints of triangles to another surface, which contains those of `is_of`.
pub(crate) fn measure_triangles(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    is_of: impl Fn([u32; 3]) -> bool + Sync,
    to: &TriangleSurface,
    limit: f64,
    progress: Progress<'_>,
) -> Result<Measured, Cancelled> {
    accumulate(triangles.len(), limit, progress, |t| {
        let corners = triangles[t].map(|x| points[x as usize]);
        let area = doubled_area(corners) / 8.0;
        if is_of(triangles[t]) {
            return [(0.0, area); 4];
        }
        let [a, b, c] = corners;
        let samples = [center(&[a, b, c]), center(&[a, b]), center(&[b, c]), center(&[c, a])];
        samples.map(|p| (to.nearest(p).0, area))
    })
}

/// Mean of points.
pub(crate) fn center(points: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|c| points.iter().map(|p| p[c]).sum::<f64>() / points.len() as f64)
}

/// Vertex areas: a third of the area of the adjacent triangles.
pub(crate) fn vertex_areas(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; points.len()];
    for triangle in triangles {
        let share = doubled_area(triangle.map(|x| points[x as usize])) / 6.0;
        for &x in triangle {
            areas[x as usize] += share;
        }
    }
    areas
}
