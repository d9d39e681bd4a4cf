//! A surface as points that move and sites that have a normal: the triangles of a mesh, the points of a cloud.

use crate::operator::Sites;
use crate::parallel;
use crate::shape::{Adjacency, triangles_at_vertices, try_nearest_neighbors, try_one_ring};
use crate::signal::{aligned_normals, try_cloud_normals};
use crate::vector::{add_scaled, cross, dot, norm, subtract, unit};
use crate::{Cancelled, Progress, rows::Pattern};

/// Triangles at a vertex beyond which they do not count as neighbors of each other by it: their number of pairs would grow as
/// the square. Those that share an edge meet at its other end as well.
const MAX_VALENCE: usize = 64;

/// Nearest neighbors that a point of a cloud has.
pub(super) const NEIGHBORS: usize = 12;

/// Rows that a thread treats at a time.
const ROWS_AT_A_TIME: usize = 1 << 12;

/// A surface, or a part of one.
pub(super) struct Surface {
    pub(super) kind: Kind,
    /// Points next to each point.
    pub(super) ring: Adjacency,
    /// Sites next to each site, where these are not the points.
    of_triangles: Option<Adjacency>,
}

pub(super) enum Kind {
    Mesh {
        triangles: Vec<[u32; 3]>,
        at_vertex: Pattern,
    },
    /// With the normals of the points as they were given, which say the sides.
    Cloud {
        normals: Vec<[f64; 3]>,
    },
}

impl Surface {
    /// A mesh; `triangles` are put in the order of their first corners, so that neighbors are near in memory.
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
                let around = triangles[t].iter().map(|&v| at_vertex.of(v as usize));
                out.extend(around.filter(|at| at.len() <= MAX_VALENCE).flatten());
            },
        )?;
        Ok(Self { kind: Kind::Mesh { triangles, at_vertex }, ring, of_triangles: Some(graph) })
    }

    /// A cloud, and its nearest neighbors.
    pub(super) fn cloud(points: &[[f64; 3]], progress: Progress<'_>) -> Result<Self, Cancelled> {
        let near = try_nearest_neighbors(points, NEIGHBORS, progress)?;
        let normals = try_cloud_normals(points, &near, progress)?;
        let ring = near.adjacency.union_with_transpose(progress)?;
        Ok(Self::cloud_of_neighbors(ring, normals))
    }

    /// A cloud whose neighbors are known, and its normals but for their lengths.
    pub(super) fn cloud_of_neighbors(neighbors: Adjacency, normals: Vec<[f64; 3]>) -> Self {
        Self { kind: Kind::Cloud { normals }, ring: neighbors, of_triangles: None }
    }

    /// Sites next to each site.
    pub(super) fn graph(&self) -> &Adjacency {
        self.of_triangles.as_ref().unwrap_or(&self.ring)
    }

    pub(super) fn n_sites(&self) -> usize {
        self.graph().n_rows()
    }

    /// Where the sites are.
    pub(super) fn positions(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        match &self.kind {
            Kind::Mesh { triangles, .. } => parallel::try_collect(triangles.len(), progress, |t| {
                let [a, b, c] = triangles[t].map(|v| points[v as usize]);
                std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
            }),
            Kind::Cloud { .. } => Ok(points.to_vec()),
        }
    }

    /// What each site counts: the area of a triangle, 1 for a point.
    pub(super) fn areas(&self, points: &[[f64; 3]], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        match &self.kind {
            Kind::Mesh { triangles, .. } => parallel::try_collect(triangles.len(), progress, |t| {
                0.5 * norm(&doubled_area(points, triangles[t]))
            }),
            Kind::Cloud { .. } => Ok(vec![1.0; points.len()]),
        }
    }

    /// Unit normals of the sites; zero where there is none.
    pub(super) fn normals(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        match &self.kind {
            Kind::Mesh { triangles, .. } => parallel::try_collect(triangles.len(), progress, |t| {
                unit(&doubled_area(points, triangles[t])).unwrap_or_default()
            }),
            Kind::Cloud { normals } => aligned_normals(points, &self.ring, normals, progress),
        }
    }

    /// The points after `n` lazy steps of the walk to each neighbor alike.
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

    /// The mean of the neighbors of a point less the point: 0 without neighbors.
    pub(super) fn umbrella(&self, points: &[[f64; 3]], x: usize) -> [f64; 3] {
        let near = self.ring.of(x);
        let share = 1.0 / near.len().max(1) as f64;
        near.iter()
            .fold([0.0; 3], |sum, &y| add_scaled(&sum, share, &subtract(&points[y as usize], &points[x])))
    }

    /// Moves points so that the surface gets the normals of its sites: `times` steps of
    /// `v ← v + mean over its triangles of n·(n·(c − v))` with c the centroid (`sun2007`), and for clouds of
    /// `p ← p + n·mean over its neighbors of ½(n + n′)·(p′ − p)`, which a sphere with its own normals stands still under.
    pub(super) fn move_to(
        &self,
        points: &mut Vec<[f64; 3]>,
        normals: &[[f64; 3]],
        times: usize,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let mut heights = vec![0.0; if let Kind::Mesh { .. } = self.kind { self.n_sites() } else { 0 }];
        let mut next = points.clone();
        for _ in 0..times {
            if let Kind::Mesh { triangles, .. } = &self.kind {
                // n·c of each triangle.
                parallel::try_for_rows(&mut heights, 1, ROWS_AT_A_TIME, progress, |first, rows| {
                    for (t, height) in (first..).zip(rows) {
                        let [a, b, c] = triangles[t].map(|v| dot(&normals[t], &points[v as usize]));
                        *height = (a + b + c) / 3.0;
                    }
                })?;
            }
            parallel::try_for_rows(&mut next, 1, ROWS_AT_A_TIME, progress, |first, rows| {
                for (x, moved) in (first..).zip(rows) {
                    *moved = match &self.kind {
                        Kind::Mesh { at_vertex, .. } => {
                            moved_vertex(&points[x], at_vertex.of(x), normals, &heights)
                        }
                        Kind::Cloud { .. } => moved_point(points, x, self.ring.of(x), normals),
                    };
                }
            })?;
            std::mem::swap(points, &mut next);
        }
        Ok(())
    }

    /// The sites as a walk sees them.
    pub(super) fn sites<'a>(&'a self, positions: &'a [[f64; 3]], areas: &'a [f64]) -> Sites<'a> {
        Sites { neighbors: self.graph(), positions, areas }
    }
}

/// Twice the area of a triangle times its unit normal.
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
