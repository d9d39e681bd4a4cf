//! A surface as movable points and sites with normals: the triangles of a mesh, or the points of a cloud.

use crate::operator::Sites;
use crate::parallel;
use crate::shape::{Adjacency, Neighborhoods, triangles_at_vertices, try_nearest_neighbors, try_one_ring};
use crate::signal::{aligned_normals, try_cloud_normals};
use crate::vector::{add_scaled, cross, dot, norm, subtract, unit};
use crate::{Cancelled, Progress, rows::Pattern};

/// Number of triangles at a vertex beyond which they are not neighbors through it, because the number of pairs
/// grows quadratically. Those that share an edge meet at its other end too.
const MAX_VALENCE: usize = 64;

/// Number of nearest neighbors of a point of a cloud.
pub(super) const NEIGHBORS: usize = 12;

/// Number of rows that a thread processes at a time.
const ROWS_AT_A_TIME: usize = 1 << 12;

/// A surface, or a part of one.
pub(super) struct NoisySurface {
    pub(super) kind: SurfaceKind,
    /// Neighbors of each point.
    pub(super) ring: Adjacency,
    /// Neighbors of each site, if sites are not points.
    of_triangles: Option<Adjacency>,
}

pub(super) enum SurfaceKind {
    Mesh {
        triangles: Vec<[u32; 3]>,
        at_vertex: Pattern,
    },
    /// Given normals of the points, which determine the sides.
    Cloud {
        normals: Vec<[f64; 3]>,
    },
}

impl NoisySurface {
    /// A mesh; `triangles` are sorted by their first corners, so that neighbors are close in memory.
    pub(super) fn mesh(
        n_points: usize,
        mut triangles: Vec<[u32; 3]>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let key = |t: &[u32; 3]| (t[0].min(t[1]).min(t[2]), *t);
        parallel::sort_unstable_by(&mut triangles, progress, |a, b| key(a).cmp(&key(b)))?;
        let at_vertex = triangles_at_vertices(n_points, &triangles, progress)?;
        let ring = try_one_ring(&triangles, &at_vertex, progress)?;
        let graph = Adjacency::from_neighbors(
            triangles.len(),
            progress,
            || (),
            |(), t, out| {
                let around = triangles[t].iter().map(|&v| at_vertex.row(v as usize));
                out.extend(around.filter(|at| at.len() <= MAX_VALENCE).flatten());
            },
        )?;
        Ok(Self { kind: SurfaceKind::Mesh { triangles, at_vertex }, ring, of_triangles: Some(graph) })
    }

    /// A cloud with its nearest neighbors.
    pub(super) fn cloud(points: &[[f64; 3]], progress: Progress<'_>) -> Result<Self, Cancelled> {
        Self::cloud_of_nearest(points, &try_nearest_neighbors(points, NEIGHBORS, progress)?, progress)
    }

    /// A cloud with its nearest neighbors, if they are known.
    pub(super) fn cloud_of_nearest(
        points: &[[f64; 3]],
        near: &Neighborhoods,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let normals = try_cloud_normals(points, near, progress)?;
        let ring = near.adjacency.union_with_transpose(progress)?;
        Ok(Self::cloud_of_neighbors(ring, normals))
    }

    /// A cloud with known neighbors and normals of any length.
    pub(super) fn cloud_of_neighbors(neighbors: Adjacency, normals: Vec<[f64; 3]>) -> Self {
        Self { kind: SurfaceKind::Cloud { normals }, ring: neighbors, of_triangles: None }
    }

    /// Neighbors of each site.
    pub(super) fn graph(&self) -> &Adjacency {
        self.of_triangles.as_ref().unwrap_or(&self.ring)
    }

    pub(super) fn n_sites(&self) -> usize {
        self.graph().n_rows()
    }

    /// Position of each site.
    pub(super) fn positions(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        match &self.kind {
            SurfaceKind::Mesh { triangles, .. } => parallel::try_collect(triangles.len(), progress, |t| {
                let [a, b, c] = triangles[t].map(|v| points[v as usize]);
                std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
            }),
            SurfaceKind::Cloud { .. } => Ok(points.to_vec()),
        }
    }

    /// Weight of each site: the area of a triangle, 1 for a point.
    pub(super) fn areas(&self, points: &[[f64; 3]], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        match &self.kind {
            SurfaceKind::Mesh { triangles, .. } => parallel::try_collect(triangles.len(), progress, |t| {
                0.5 * norm(&doubled_area(points, triangles[t]))
            }),
            SurfaceKind::Cloud { .. } => Ok(vec![1.0; points.len()]),
        }
    }

    /// Unit normal of each site; zero if there is none.
    pub(super) fn normals(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        match &self.kind {
            SurfaceKind::Mesh { triangles, .. } => parallel::try_collect(triangles.len(), progress, |t| {
                unit(&doubled_area(points, triangles[t])).unwrap_or_default()
            }),
            SurfaceKind::Cloud { normals } => aligned_normals(points, &self.ring, normals, progress),
        }
    }

    /// The points after `n` lazy steps of the walk with equal weights.
    pub(super) fn smoothed(
        &self,
        points: &[[f64; 3]],
        n: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        let mut now = points.to_vec();
        for _ in 0..n {
            now = parallel::try_collect(now.len(), progress, |x| {
                add_scaled(&now[x], 0.5, &self.umbrella(&now, x))
            })?;
        }
        Ok(now)
    }

    /// Mean of the neighbors of a point minus the point; 0 without neighbors.
    pub(super) fn umbrella(&self, points: &[[f64; 3]], x: usize) -> [f64; 3] {
        let near = self.ring.row(x);
        let share = 1.0 / near.len().max(1) as f64;
        near.iter()
            .fold([0.0; 3], |sum, &y| add_scaled(&sum, share, &subtract(&points[y as usize], &points[x])))
    }

    /// Moves points so that the surface approaches the given normals of its sites: `times` steps of
    /// `v ← v + mean over its triangles of n·(n·(c − v))` with the centroid c (`sun2007`). For clouds:
    /// `p ← p + n·mean over its neighbors of ½(n + n′)·(p′ − p)`, under which a sphere with its own normals does
    /// not move.
    pub(super) fn move_to(
        &self,
        points: &mut Vec<[f64; 3]>,
        normals: &[[f64; 3]],
        times: usize,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let mut heights =
            vec![0.0; if let SurfaceKind::Mesh { .. } = self.kind { self.n_sites() } else { 0 }];
        let mut next = points.clone();
        for _ in 0..times {
            if let SurfaceKind::Mesh { triangles, .. } = &self.kind {
                // The value n·c of each triangle.
                parallel::try_visit_rows(&mut heights, 1, ROWS_AT_A_TIME, progress, |first, rows| {
                    for (t, height) in (first..).zip(rows) {
                        let [a, b, c] = triangles[t].map(|v| dot(&normals[t], &points[v as usize]));
                        *height = (a + b + c) / 3.0;
                    }
                })?;
            }
            parallel::try_visit_rows(&mut next, 1, ROWS_AT_A_TIME, progress, |first, rows| {
                for (x, moved) in (first..).zip(rows) {
                    *moved = match &self.kind {
                        SurfaceKind::Mesh { at_vertex, .. } => {
                            moved_vertex(&points[x], at_vertex.row(x), normals, &heights)
                        }
                        SurfaceKind::Cloud { .. } => moved_point(points, x, self.ring.row(x), normals),
                    };
                }
            })?;
            std::mem::swap(points, &mut next);
        }
        Ok(())
    }

    /// The sites as input of a guided walk.
    pub(super) fn sites<'a>(&'a self, positions: &'a [[f64; 3]], areas: &'a [f64]) -> Sites<'a> {
        Sites { neighbors: self.graph(), positions, areas }
    }
}

/// Unit normal of a triangle times twice its area.
fn doubled_area(points: &[[f64; 3]], corners: [u32; 3]) -> [f64; 3] {
    let [a, b, c] = corners.map(|v| &points[v as usize]);
    cross(&subtract(b, a), &subtract(c, a))
}

fn moved_vertex(v: &[f64; 3], around: &[u32], normals: &[[f64; 3]], heights: &[f64]) -> [f64; 3] {
    let share = 1.0 / around.len().max(1) as f64;
    around.iter().fold(*v, |moved, &t| {
        let n = &normals[t as usize];
        add_scaled(&moved, share * (heights[t as usize] - dot(n, v)), n)
    })
}

fn moved_point(points: &[[f64; 3]], x: usize, near: &[u32], normals: &[[f64; 3]]) -> [f64; 3] {
    let (p, n) = (&points[x], &normals[x]);
    let share = 1.0 / near.len().max(1) as f64;
    let height = |&y: &u32| {
        let (q, m) = (&points[y as usize], &normals[y as usize]);
        let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (n[k] + m[k]));
        share * dot(&middle, &subtract(q, p))
    };
    add_scaled(p, near.iter().map(height).sum(), n)
}
