//! Flags of the vertices of a mesh: used by a face, and with edges of faces that do not cancel there.

use super::Polygons;
use crate::rows::Pattern;
use crate::{Cancelled, Progress, parallel};

/// Flags of the vertices of a mesh.
pub(super) struct FaceFlags {
    /// True where the edges of faces do not cancel: at open borders, where faces disagree on the orientation, and at
    /// some other vertices.
    pub(super) is_open: Vec<bool>,
    /// True where a face with two different corners has a corner.
    pub(super) is_used: Vec<bool>,
}

/// Flags of one vertex.
#[derive(Clone, Copy, Default)]
struct VertexFlags {
    is_open: bool,
    is_used: bool,
}

impl FaceFlags {
    /// Flags of `n` vertices. O(corners).
    pub(super) fn new(n: usize, faces: &Polygons) -> Self {
        let (mut sums, mut is_used) = (vec![0_u64; n], vec![false; n]);
        visit_edges(faces, |[start, end]| {
            sums[start as usize] = sums[start as usize].wrapping_add(scramble(end));
            sums[end as usize] = sums[end as usize].wrapping_sub(scramble(start));
            is_used[start as usize] = true;
        });
        Self { is_open: sums.into_iter().map(|sum| sum != 0).collect(), is_used }
    }

    /// [`new`](Self::new) for triangles of which those at each vertex are known, on all threads.
    pub(super) fn from_triangles(
        triangles: &[[u32; 3]],
        at_vertex: &Pattern,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let flags: Vec<VertexFlags> = parallel::try_collect(at_vertex.n_rows(), progress, |x| {
            let (mut sum, mut is_used) = (0_u64, false);
            let (around, own) = (at_vertex.row(x), x as u32);
            for (k, &f) in around.iter().enumerate() {
                // A triangle with a repeated corner is listed once for each of them.
                if k > 0 && around[k - 1] == f {
                    continue;
                }
                let triangle = triangles[f as usize];
                for corner in (0..3).filter(|&corner| triangle[corner] == own) {
                    let [next, before] = [triangle[(corner + 1) % 3], triangle[(corner + 2) % 3]];
                    if next != own {
                        sum = sum.wrapping_add(scramble(next));
                        is_used = true;
                    }
                    if before != own {
                        sum = sum.wrapping_sub(scramble(before));
                    }
                }
            }
            VertexFlags { is_open: sum != 0, is_used }
        })?;
        let is_open = flags.iter().map(|flags| flags.is_open).collect();
        Ok(Self { is_open, is_used: flags.iter().map(|flags| flags.is_used).collect() })
    }
}

/// Calls `visit` for the directed edges `[start, end]` of all faces.
pub(super) fn visit_edges(faces: &Polygons, mut visit: impl FnMut([u32; 2])) {
    for face in faces.iter() {
        let mut start = face[face.len() - 1];
        for &end in face {
            if start != end {
                visit([start, end]);
            }
            start = end;
        }
    }
}

/// Hash that mixes all bits of a vertex (the finalizer of splitmix64).
fn scramble(x: u32) -> u64 {
    let mut x = u64::from(x).wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::super::adjacency::triangles_at_vertices;
    use super::*;

    #[test]
    fn flags_by_vertex_are_those_by_face() {
        // A closed tetrahedron, a border, a turned face, repeated corners, unused vertices.
        let cases: [&[[u32; 3]]; 5] = [
            &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]],
            &[[0, 1, 2], [0, 3, 1], [1, 3, 2]],
            &[[0, 1, 2], [0, 1, 3], [1, 3, 2], [0, 2, 3]],
            &[[0, 0, 2], [3, 1, 3], [4, 4, 4], [5, 6, 6]],
            &[],
        ];
        for triangles in cases {
            let faces = Polygons::from_triangles(triangles);
            let at_vertex = triangles_at_vertices(8, triangles, Progress::none()).expect("nobody stops it");
            let found = FaceFlags::from_triangles(triangles, &at_vertex, Progress::none());
            let (found, expected) = (found.expect("nobody stops it"), FaceFlags::new(8, &faces));
            assert_eq!((found.is_open, found.is_used), (expected.is_open, expected.is_used), "{triangles:?}");
        }
    }
}
