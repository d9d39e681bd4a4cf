//! How far two surfaces are apart.

use crate::wedges::{doubled_area, length, minus};
use adwave::{Cancelled, Progress};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::TriMesh;
use rayon::prelude::*;

/// Distances from places on one surface to the nearest places of another, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OneSided {
    /// The greatest.
    pub greatest: f64,
    /// `√(Σ a d² / Σ a)` with the area a that each place stands for.
    pub rms: f64,
}

/// How far a simplified shape is from the original, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// From each vertex of the original to the nearest place of the simplified shape.
    pub of_original: OneSided,
    /// From places of the simplified shape to the nearest place of the original: of a mesh its vertices, which are the
    /// original's and 0 away, and of each triangle the center and the middles of the edges.
    pub of_simplified: OneSided,
}

impl Deviation {
    /// The greater of both sides: a lower bound of the Hausdorff distance, taken at the places that are looked at.
    pub fn greatest(&self) -> f64 {
        self.of_original.greatest.max(self.of_simplified.greatest)
    }

    /// The larger of both root mean squares by area.
    pub fn rms(&self) -> f64 {
        self.of_original.rms.max(self.of_simplified.rms)
    }

    pub(crate) fn times(self, unit: f64) -> Self {
        let times = |side: OneSided| OneSided { greatest: unit * side.greatest, rms: unit * side.rms };
        Self { of_original: times(self.of_original), of_simplified: times(self.of_simplified) }
    }
}

/// Triangles in a tree of boxes.
pub(crate) struct Surface(TriMesh);

impl Surface {
    /// O(triangles log triangles); `None` without triangles.
    pub(crate) fn new(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Option<Self> {
        let mut place = vec![u32::MAX; points.len()];
        let mut own = Vec::new();
        let mut named = |x: u32| {
            let place = &mut place[x as usize];
            if *place == u32::MAX {
                *place = own.len() as u32;
                let [x, y, z] = points[x as usize];
                own.push(Vector::new(x, y, z));
            }
            *place
        };
        let triangles = triangles.iter().map(|t| t.map(&mut named)).collect();
        TriMesh::new(own, triangles).ok().map(Self)
    }

    /// The distance to the nearest place, and its triangle. O(log triangles) where the surface is near.
    pub(crate) fn nearest(&self, p: [f64; 3]) -> (f64, u32) {
        let point = Vector::new(p[0], p[1], p[2]);
        let (found, (triangle, _)) = self.0.project_local_point_and_get_location(point, true);
        let q = found.point;
        (length(minus([q.x, q.y, q.z], p)), triangle)
    }
}

/// Places that a thread looks at in one go; the sums do not depend on the number of threads.
const AT_A_TIME: usize = 1 << 10;

/// Distances put together, and where they are beyond a limit, increasing.
pub(crate) struct Measured {
    pub(crate) side: OneSided,
    pub(crate) far: Vec<u32>,
}

/// Puts together what `places(k)` gives for k < n: pairs of a distance and its area.
fn gather<const N: usize>(
    n: usize,
    limit: f64,
    progress: Progress<'_>,
    places: impl Fn(usize) -> [(f64, f64); N] + Sync,
) -> Result<Measured, Cancelled> {
    let chunk = |c: usize| {
        progress.check()?;
        let (mut greatest, mut squares, mut area, mut far) = (0.0_f64, 0.0, 0.0, Vec::new());
        for k in c * AT_A_TIME..((c + 1) * AT_A_TIME).min(n) {
            let mut own = 0.0_f64;
            for (distance, a) in places(k) {
                own = own.max(distance);
                squares += a * distance * distance;
                area += a;
            }
            greatest = greatest.max(own);
            if own > limit {
                far.push(k as u32);
            }
        }
        Ok((greatest, squares, area, far))
    };
    let chunks: Vec<_> =
        (0..n.div_ceil(AT_A_TIME)).into_par_iter().map(chunk).collect::<Result<_, Cancelled>>()?;
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

/// From the vertices of a mesh, with a third of the area of each triangle round a vertex, to another surface, on which some of
/// them are.
pub(crate) fn from_vertices(
    points: &[[f64; 3]],
    areas: &[f64],
    is_on: &[bool],
    to: &Surface,
    limit: f64,
    progress: Progress<'_>,
) -> Result<Measured, Cancelled> {
    let distance = |x: usize| if is_on[x] { 0.0 } else { to.nearest(points[x]).0 };
    gather(points.len(), limit, progress, |x| [(distance(x), areas[x])])
}

/// From the centers and the middles of the edges of triangles to another surface, of which some of them are.
pub(crate) fn from_triangles(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    is_of: impl Fn([u32; 3]) -> bool + Sync,
    to: &Surface,
    limit: f64,
    progress: Progress<'_>,
) -> Result<Measured, Cancelled> {
    gather(triangles.len(), limit, progress, |t| {
        let corners = triangles[t].map(|x| points[x as usize]);
        let area = doubled_area(corners) / 8.0;
        if is_of(triangles[t]) {
            return [(0.0, area); 4];
        }
        let [a, b, c] = corners;
        let places = [center(&[a, b, c]), center(&[a, b]), center(&[b, c]), center(&[c, a])];
        places.map(|p| (to.nearest(p).0, area))
    })
}

/// The mean of points.
pub(crate) fn center(points: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|c| points.iter().map(|p| p[c]).sum::<f64>() / points.len() as f64)
}

/// A third of the area of the triangles round each vertex.
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
