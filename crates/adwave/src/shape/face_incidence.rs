//! Faces at each vertex, and the neighbors, the area and the normal that it has from them.
//!
//! No rule for a face of more than three corners starts at one of them, so the result does not depend on which corner
//! the file names first. With the mean `c` of the corners `v_0 … v_(n−1)` and `e_k = ½·(v_k − c) × (v_(k+1) − c)`:
//!
//! * the vector area is `N = Σ e_k`, which has the direction of the best-fitting plane, and for a planar face of any
//!   outline the length of its area;
//! * the area of the face is `|N|`, and corner k gets the share `½·(|e_(k−1)| + |e_k|)/Σ|e|` of it, which on a
//!   triangle is a third;
//! * a vertex gets its share of the area as the weight of the normal `N/|N|`;
//! * the neighbors of a corner are the corner before it and the corner after it.

use super::area::{mixed_voronoi, triangle_area};
use super::surface::doubled_normal;
use super::{
    Adjacency, MeshArea, Polygons, enclosed_volume, surface_area, triangles_at_vertices, try_mesh_areas,
    try_one_ring, vertex_normals,
};
use crate::parallel::{self, expect_not_cancelled};
use crate::rows::{Pattern, incidence};
use crate::{Cancelled, Progress};
use nalgebra::Vector3;

/// Number of faces that a thread measures at a time.
const FACES_AT_A_TIME: usize = 1 << 12;

/// Faces with the corners of each vertex.
pub(crate) enum FaceIncidence<'a> {
    /// All triangles, and the triangles at each vertex.
    Triangles { triangles: &'a [[u32; 3]], at_vertex: Pattern },
    /// Polygons, the indices in [`Polygons::corners`] of the corners at each vertex, and the face of each corner.
    Polygons { faces: &'a Polygons, at_vertex: Pattern, face_of: Vec<u32> },
}

impl<'a> FaceIncidence<'a> {
    /// Sorts the corners of `faces` by their vertices. O(corners).
    pub(crate) fn new(
        n_vertices: usize,
        faces: &'a Polygons,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        if let Some(triangles) = faces.triangles() {
            let at_vertex = triangles_at_vertices(n_vertices, triangles, progress)?;
            return Ok(Self::Triangles { triangles, at_vertex });
        }
        let corners = faces.corners();
        let at_vertex = incidence(n_vertices, corners.len(), progress, |k| &corners[k..=k])?;
        let mut face_of = Vec::with_capacity(corners.len());
        for f in 0..faces.len() {
            face_of.resize(faces.end(f), f as u32);
        }
        Ok(Self::Polygons { faces, at_vertex, face_of })
    }

    /// Ends of the sides of faces at each vertex: the one-ring of the mesh.
    pub(crate) fn ring(&self, progress: Progress<'_>) -> Result<Adjacency, Cancelled> {
        let (faces, at_vertex, face_of) = match self {
            Self::Triangles { triangles, at_vertex } => return try_one_ring(triangles, at_vertex, progress),
            Self::Polygons { faces, at_vertex, face_of } => (faces, at_vertex, face_of),
        };
        let corners = faces.corners();
        let ends = |&k: &u32| {
            let (k, f) = (k as usize, face_of[k as usize] as usize);
            let (start, end) = (if f == 0 { 0 } else { faces.end(f - 1) }, faces.end(f));
            let before = if k == start { end - 1 } else { k - 1 };
            let after = if k + 1 == end { start } else { k + 1 };
            [corners[before], corners[after]]
        };
        Adjacency::from_neighbors(
            at_vertex.n_rows(),
            progress,
            || (),
            |(), x, out| out.extend(at_vertex.row(x).iter().flat_map(ends).filter(|&y| y as usize != x)),
        )
    }

    /// Areas of the vertices in squared units of `points`; ≥ 0. [`MeshArea::MixedVoronoi`] concerns triangles; a
    /// polygon is shared by the rule of this module.
    pub(crate) fn areas(
        &self,
        points: &[[f64; 3]],
        kind: MeshArea,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let (faces, at_vertex, face_of) = match self {
            Self::Triangles { triangles, at_vertex } => {
                return try_mesh_areas(points, triangles, at_vertex, kind, progress);
            }
            Self::Polygons { faces, at_vertex, face_of } => (faces, at_vertex, face_of),
        };
        let shares = corner_areas(points, faces, progress)?;
        parallel::try_collect(points.len(), progress, |x| {
            let share = |&k: &u32| match *faces.get(face_of[k as usize] as usize) {
                [a, b, c] if kind == MeshArea::MixedVoronoi => mixed_voronoi(points, [a, b, c], x as u32),
                _ => shares[k as usize],
            };
            at_vertex.row(x).iter().map(share).sum()
        })
    }

    /// Sums of the normals around the vertices, each twice as long as the area of a triangle, or six times as long
    /// as the share of a polygon.
    pub(crate) fn normal_sums(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        match self {
            Self::Triangles { triangles, at_vertex } => parallel::try_collect(points.len(), progress, |x| {
                let around = at_vertex.row(x).iter();
                around.map(|&f| doubled_normal(points, triangles[f as usize])).sum::<Vector3<f64>>().into()
            }),
            Self::Polygons { faces, at_vertex, face_of } => {
                let shares = corner_areas(points, faces, progress)?;
                let normals: Vec<[f64; 3]> = parallel::try_collect(faces.len(), progress, |f| {
                    vector_area(points, faces.get(f)).try_normalize(0.0).unwrap_or_default().into()
                })?;
                parallel::try_collect(points.len(), progress, |x| {
                    let normal = |&k: &u32| {
                        let f = face_of[k as usize] as usize;
                        match *faces.get(f) {
                            [a, b, c] => doubled_normal(points, [a, b, c]),
                            _ => 6.0 * shares[k as usize] * Vector3::from(normals[f]),
                        }
                    };
                    at_vertex.row(x).iter().map(normal).sum::<Vector3<f64>>().into()
                })
            }
        }
    }

    /// Unit normals of the vertices; zero if they vanish or there is no face.
    pub(crate) fn normals(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        let mut normals = self.normal_sums(points, progress)?;
        for normal in &mut normals {
            *normal = Vector3::from(*normal).try_normalize(0.0).unwrap_or_default().into();
        }
        Ok(normals)
    }
}

/// Vector area of a face of three corners or more (see the module); zero for fewer corners.
pub(crate) fn vector_area(points: &[[f64; 3]], corners: &[u32]) -> Vector3<f64> {
    if let [a, b, c] = *corners {
        return 0.5 * doubled_normal(points, [a, b, c]);
    }
    let (_, offsets) = centered(points, corners);
    (0..offsets.len()).map(|k| 0.5 * offsets[k].cross(&offsets[(k + 1) % offsets.len()])).sum()
}

/// Mean of the corners of a face, and the corners relative to it.
pub(super) fn centered(points: &[[f64; 3]], corners: &[u32]) -> (Vector3<f64>, Vec<Vector3<f64>>) {
    let Some(&first) = corners.first() else { return (Vector3::zeros(), Vec::new()) };
    // Measured from a corner, because far from the origin the mean would lose digits.
    let origin = Vector3::from(points[first as usize]);
    let mut offsets: Vec<Vector3<f64>> =
        corners.iter().map(|&v| Vector3::from(points[v as usize]) - origin).collect();
    let mean = offsets.iter().sum::<Vector3<f64>>() / corners.len() as f64;
    for offset in &mut offsets {
        *offset -= mean;
    }
    (origin + mean, offsets)
}

/// Share of each corner of `faces` in the area of its face, in squared units of `points`.
fn corner_areas(
    points: &[[f64; 3]],
    faces: &Polygons,
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    let chunks = parallel::try_map_chunks(
        faces.len(),
        FACES_AT_A_TIME,
        progress,
        || (),
        |(), range| {
            let mut shares = Vec::with_capacity(4 * range.len());
            for f in range {
                match *faces.get(f) {
                    [a, b, c] => {
                        let [a, b, c] = [a, b, c].map(|v| &points[v as usize]);
                        shares.extend([triangle_area(a, b, c) / 3.0; 3]);
                    }
                    ref corners => push_shares(points, corners, &mut shares),
                }
            }
            shares
        },
    )?;
    Ok(chunks.concat())
}

/// Appends the shares of the corners of a polygon.
fn push_shares(points: &[[f64; 3]], corners: &[u32], shares: &mut Vec<f64>) {
    let (_, offsets) = centered(points, corners);
    let n = offsets.len();
    let sectors: Vec<Vector3<f64>> = (0..n).map(|k| 0.5 * offsets[k].cross(&offsets[(k + 1) % n])).collect();
    let area = sectors.iter().sum::<Vector3<f64>>().norm();
    let sizes: Vec<f64> = sectors.iter().map(Vector3::norm).collect();
    let total: f64 = sizes.iter().sum();
    let share = |k: usize| 0.5 * (sizes[(k + n - 1) % n] + sizes[k]) / total * area;
    shares.extend((0..n).map(|k| if total > 0.0 { share(k) } else { 0.0 }));
}

/// Ends of the sides of faces at each vertex: the one-ring of a polygon mesh. O(corners).
///
/// # Panics
/// If a face names a vertex that does not exist.
///
/// ```
/// use adwave::shape::{Polygons, face_ring};
/// let square: Polygons = [[0, 1, 2, 3].as_slice()].into_iter().collect();
/// assert_eq!(face_ring(4, &square).row(0), [1, 3]);
/// ```
pub fn face_ring(n_vertices: usize, faces: &Polygons) -> Adjacency {
    let none = Progress::none();
    expect_not_cancelled(FaceIncidence::new(n_vertices, faces, none).and_then(|at| at.ring(none)))
}

/// Areas of the vertices of a polygon mesh, in squared units of `points`; ≥ 0. They do not depend on the first
/// corner of a face. O(corners).
///
/// A triangle is shared as [`mesh_areas`](super::mesh_areas) does. A polygon of more corners has the length of its
/// vector area as area; each corner gets half of the two sectors beside it, between the mean of the corners and the
/// sides of the polygon, all scaled to sum to that area.
///
/// ```
/// use adwave::shape::{MeshArea, Polygons, face_areas};
/// let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
/// let square: Polygons = [[0, 1, 2, 3].as_slice()].into_iter().collect();
/// assert_eq!(face_areas(&points, &square, MeshArea::Barycentric), [1.0; 4]);
/// ```
pub fn face_areas(points: &[[f64; 3]], faces: &Polygons, kind: MeshArea) -> Vec<f64> {
    let none = Progress::none();
    let areas = FaceIncidence::new(points.len(), faces, none).and_then(|at| at.areas(points, kind, none));
    expect_not_cancelled(areas)
}

/// Unit normals of the vertices of a polygon mesh, by the right-hand rule: the mean of the normals of the faces,
/// weighted by the area of the face that belongs to the vertex; zero if it vanishes. O(corners).
pub fn face_vertex_normals(points: &[[f64; 3]], faces: &Polygons) -> Vec<[f64; 3]> {
    if let Some(triangles) = faces.triangles() {
        return vertex_normals(points, triangles);
    }
    let none = Progress::none();
    let normals = FaceIncidence::new(points.len(), faces, none).and_then(|at| at.normals(points, none));
    expect_not_cancelled(normals)
}

/// Area of a polygon mesh in squared units of `points`: the sum of the lengths of the vector areas of its faces.
/// O(corners).
pub fn total_face_area(points: &[[f64; 3]], faces: &Polygons) -> f64 {
    match faces.triangles() {
        Some(triangles) => surface_area(points, triangles),
        None => parallel::sum(faces.len(), |f| vector_area(points, faces.get(f)).norm()),
    }
}

/// Volume enclosed by a closed polygon mesh, in cubed units of `points`: `⅓ Σ c·N` with the mean c of the corners and
/// the vector area N of each face, which is the mean over all fans of the face; positive if normals point outwards.
/// Meaningless for an open surface. O(corners).
///
/// ```
/// use adwave::shape::{Polygons, enclosed_face_volume};
/// let corner = |i: u32| [0, 1, 2].map(|c| f64::from(i >> c & 1));
/// let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
/// let cube: Polygons = sides.iter().map(<[u32; 4]>::as_slice).collect();
/// let points: Vec<_> = (0..8).map(corner).collect();
/// assert!((enclosed_face_volume(&points, &cube) - 1.0).abs() < 1e-15);
/// ```
pub fn enclosed_face_volume(points: &[[f64; 3]], faces: &Polygons) -> f64 {
    if let Some(triangles) = faces.triangles() {
        return enclosed_volume(points, triangles);
    }
    // Measured from a point of the surface, because far from the origin the terms would cancel.
    let Some(origin) = points.first().map(|p| Vector3::from(*p)) else { return 0.0 };
    parallel::sum(faces.len(), |f| {
        let corners = faces.get(f);
        (centered(points, corners).0 - origin).dot(&vector_area(points, corners)) / 3.0
    })
}
