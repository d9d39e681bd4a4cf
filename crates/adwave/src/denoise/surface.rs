//! A mesh as movable points and sites with normals: its triangles.

use crate::operator::Sites;
use crate::parallel;
use crate::shape::{Adjacency, triangles_at_vertices, try_one_ring};
use crate::vector::{add_scaled, cross, dot, norm, subtract, unit};
use crate::{Cancelled, Progress, rows::Pattern};

/// Number of triangles at a vertex beyond which they are not neighbors through it, because the number of pairs
/// grows quadratically. Those that share an edge meet at its other end too.
const MAX_VALENCE: usize = 64;

/// Factors of the two steps of a round of the linear filter, the usual ones.
const LINEAR_FACTORS: [f64; 2] = [0.5, -0.53];

/// Number of rows that a thread processes at a time.
const ROWS_AT_A_TIME: usize = 1 << 12;

/// A mesh, or a part of one.
pub(super) struct NoisySurface {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) at_vertex: Pattern,
    /// Neighbors of each point.
    pub(super) ring: Adjacency,
    /// Neighbors of each triangle.
    of_triangles: Adjacency,
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
        Ok(Self { triangles, at_vertex, ring, of_triangles: graph })
    }

    /// Neighbors of each site.
    pub(super) fn graph(&self) -> &Adjacency {
        &self.of_triangles
    }

    pub(super) fn n_sites(&self) -> usize {
        self.graph().n_rows()
    }

    /// Position of each site: the centroid of a triangle.
    pub(super) fn positions(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        parallel::try_collect(self.triangles.len(), progress, |t| {
            let [a, b, c] = self.triangles[t].map(|v| points[v as usize]);
            std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
        })
    }

    /// Weight of each site: the area of a triangle.
    pub(super) fn areas(&self, points: &[[f64; 3]], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        parallel::try_collect(self.triangles.len(), progress, |t| {
            0.5 * norm(&doubled_area(points, self.triangles[t]))
        })
    }

    /// Unit normal of each site; zero if there is none.
    pub(super) fn normals(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        parallel::try_collect(self.triangles.len(), progress, |t| {
            unit(&doubled_area(points, self.triangles[t])).unwrap_or_default()
        })
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

    /// The points after `rounds` of the linear filter of `taubin1995signal`, alternating steps that shrink and inflate;
    /// a fraction of a round contributes this fraction of its change.
    pub(super) fn linear_filtered(
        &self,
        points: &[[f64; 3]],
        rounds: f64,
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        let mut now = points.to_vec();
        let mut left = rounds;
        while left > 0.0 {
            let share = left.min(1.0);
            let mut next = now.clone();
            for factor in LINEAR_FACTORS {
                next = parallel::try_collect(next.len(), progress, |x| {
                    add_scaled(&next[x], factor, &self.umbrella(&next, x))
                })?;
            }
            now = parallel::try_collect(now.len(), progress, |x| {
                add_scaled(&now[x], share, &subtract(&next[x], &now[x]))
            })?;
            left -= 1.0;
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
    /// `v ← v + mean over its triangles of n·(n·(c − v))` with the centroid c (`sun2007`).
    pub(super) fn move_to(
        &self,
        points: &mut Vec<[f64; 3]>,
        normals: &[[f64; 3]],
        times: usize,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let mut heights = vec![0.0; self.n_sites()];
        let mut next = points.clone();
        for _ in 0..times {
            // The value n·c of each triangle.
            parallel::try_visit_rows(&mut heights, 1, ROWS_AT_A_TIME, progress, |first, rows| {
                for (t, height) in (first..).zip(rows) {
                    let [a, b, c] = self.triangles[t].map(|v| dot(&normals[t], &points[v as usize]));
                    *height = (a + b + c) / 3.0;
                }
            })?;
            parallel::try_visit_rows(&mut next, 1, ROWS_AT_A_TIME, progress, |first, rows| {
                for (x, moved) in (first..).zip(rows) {
                    *moved = moved_vertex(&points[x], self.at_vertex.row(x), normals, &heights);
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
