//! Subdivision of triangles into four.

use std::collections::HashMap;

/// Triangle mesh, each triangle of which was cut into four at the midpoints of its edges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SubdividedMesh {
    /// Number of vertices: those of the mesh come first, then one for each edge.
    pub n_vertices: usize,
    /// Four triangles for each one: those at its corners, then the one in its middle.
    pub triangles: Vec<[u32; 3]>,
    /// Ends of the edge of each new vertex.
    pub parents: Vec<[u32; 2]>,
}

/// Cuts each triangle of a mesh of `n_vertices` vertices into four.
///
/// ```
/// let square = adwave_subdivision::subdivide(4, &[[0, 1, 2], [0, 2, 3]]);
/// assert_eq!((square.n_vertices, square.triangles.len()), (9, 8));
/// assert_eq!(square.triangles[..4], [[0, 4, 6], [1, 5, 4], [2, 6, 5], [4, 5, 6]]);
/// ```
pub fn subdivide(n_vertices: usize, triangles: &[[u32; 3]]) -> SubdividedMesh {
    let mut midpoints: HashMap<[u32; 2], u32> = HashMap::with_capacity(3 * triangles.len() / 2);
    let mut parents: Vec<[u32; 2]> = Vec::new();
    let mut finer = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let mut midpoint = |a: u32, b: u32| {
            let edge = [a.min(b), a.max(b)];
            *midpoints.entry(edge).or_insert_with(|| {
                parents.push(edge);
                (n_vertices + parents.len() - 1) as u32
            })
        };
        let (ab, bc, ca) = (midpoint(a, b), midpoint(b, c), midpoint(c, a));
        finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    SubdividedMesh { n_vertices: n_vertices + parents.len(), triangles: finer, parents }
}
