//! Closed parts inside of others, found by rays along x.
//!
//! A ray from a vertex of a part crosses the surface of another part an odd number of times if the vertex is inside of
//! it. Triangles are cut by the plane through the vertex across z, and the cuts by the line along x in that plane. A
//! corner in the plane counts as above it, and the cut of an edge is computed from its smaller vertex, so that the cuts
//! of a closed part are closed lines, whatever lies on the ray.

use crate::{Cancelled, Progress, parallel};

/// Largest number of slabs.
const MOST_SLABS: usize = 1 << 12;

/// Closed part of a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClosedPart {
    /// Index of the part.
    pub(super) part: u32,
    /// A welded vertex of the part.
    pub(super) vertex: u32,
    /// Enclosed volume in cubed model units.
    pub(super) volume: f64,
}

/// Triangles by slabs of equal thickness across z.
struct Slabs {
    low: f64,
    thickness: f64,
    /// Indices of the triangles that meet each slab.
    triangles: Vec<Vec<u32>>,
}

impl Slabs {
    fn new(points: &[[f64; 3]], triangles: &[[u32; 3]], is_used: impl Fn(&[u32; 3]) -> bool) -> Self {
        let range = |triangle: &[u32; 3]| {
            let z = triangle.map(|v| points[v as usize][2]);
            (z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2]))
        };
        let (mut low, mut high, mut sum, mut n) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0_usize);
        for triangle in triangles.iter().filter(|t| is_used(t)) {
            let (a, b) = range(triangle);
            (low, high, sum, n) = (low.min(a), high.max(b), sum + (b - a), n + 1);
        }
        // With slabs of the mean height of a triangle, a triangle is listed about twice.
        let height = sum / n.max(1) as f64;
        let n_slabs = if height > 0.0 { ((high - low) / height) as usize } else { 1 };
        let n_slabs = n_slabs.clamp(1, MOST_SLABS);
        let mut slabs =
            Self { low, thickness: (high - low) / n_slabs as f64, triangles: vec![Vec::new(); n_slabs] };
        for (t, triangle) in triangles.iter().enumerate().filter(|(_, t)| is_used(t)) {
            let (a, b) = range(triangle);
            for slab in slabs.index(a)..=slabs.index(b) {
                slabs.triangles[slab].push(t as u32);
            }
        }
        slabs
    }

    fn index(&self, z: f64) -> usize {
        let slab = (z - self.low) / self.thickness;
        // Not a number for a flat part, and a negative number becomes 0.
        (slab as usize).min(self.triangles.len() - 1)
    }
}

/// Finds the smallest of the closed parts around each of them, as an index into `solid`; `None` for outer ones.
pub(super) fn enclosing_parts(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    part_of: &[u32],
    solid: &[ClosedPart],
    progress: Progress<'_>,
) -> Result<Vec<Option<usize>>, Cancelled> {
    if solid.len() < 2 {
        return Ok(vec![None; solid.len()]);
    }
    let n_parts = part_of.iter().filter(|&&part| part != u32::MAX).max().map_or(0, |&part| part as usize + 1);
    let mut index_of = vec![usize::MAX; n_parts];
    for (k, closed) in solid.iter().enumerate() {
        index_of[closed.part as usize] = k;
    }
    let solid_of = |triangle: &[u32; 3]| index_of[part_of[triangle[0] as usize] as usize];
    let slabs = Slabs::new(points, triangles, |triangle| solid_of(triangle) != usize::MAX);
    parallel::try_collect(solid.len(), progress, |k| {
        let from = &points[solid[k].vertex as usize];
        let mut crossed: Vec<usize> = slabs.triangles[slabs.index(from[2])]
            .iter()
            .map(|&t| &triangles[t as usize])
            .filter(|triangle| solid_of(triangle) != k && is_crossed(points, triangle, from))
            .map(solid_of)
            .collect();
        crossed.sort_unstable();
        crossed
            .chunk_by(|a, b| a == b)
            .filter(|run| run.len() % 2 == 1)
            .map(|run| run[0])
            .min_by(|&a, &b| solid[a].volume.abs().total_cmp(&solid[b].volume.abs()))
    })
}

/// True if the ray from a point along x crosses a triangle.
fn is_crossed(points: &[[f64; 3]], triangle: &[u32; 3], from: &[f64; 3]) -> bool {
    let mut cuts = [[0.0; 2]; 3];
    let mut n_cuts = 0;
    for k in 0..3 {
        let (u, v) = (triangle[k], triangle[(k + 1) % 3]);
        let (a, b) = (&points[u.min(v) as usize], &points[u.max(v) as usize]);
        if (a[2] >= from[2]) != (b[2] >= from[2]) {
            let share = (from[2] - a[2]) / (b[2] - a[2]);
            cuts[n_cuts] = [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
            n_cuts += 1;
        }
    }
    let [a, b] = [cuts[0], cuts[1]];
    if n_cuts < 2 || (a[1] >= from[1]) == (b[1] >= from[1]) {
        return false;
    }
    a[0] + (from[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > from[0]
}
