//! Subdivision of triangles into four, and of polygons into quadrilaterals.

use adwave::shape::Polygons;
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

/// Mesh of quadrilaterals, made by cutting each polygon of n corners into n.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SubdividedPolygons {
    /// Number of vertices: those of the mesh come first, then one for each edge, then one for each face.
    pub n_vertices: usize,
    /// Quadrilaterals of each polygon: from each corner by the edge after it, the middle, and the edge before it.
    pub faces: Polygons,
    /// Ends of the edge of each new vertex on an edge.
    pub edges: Vec<[u32; 2]>,
}

/// Cuts each polygon of n corners of a mesh of `n_vertices` vertices into n quadrilaterals.
///
/// ```
/// use adwave::shape::Polygons;
/// let finer = adwave_subdivision::subdivide_polygons(3, &Polygons::from_triangles(&[[0, 1, 2]]));
/// assert_eq!((finer.n_vertices, finer.faces.get(0)), (7, [0, 3, 6, 5].as_slice()));
/// ```
pub fn subdivide_polygons(n_vertices: usize, faces: &Polygons) -> SubdividedPolygons {
    let mut midpoints: HashMap<[u32; 2], u32> = HashMap::with_capacity(faces.corners().len() / 2);
    let (mut edges, mut around) = (Vec::new(), Vec::with_capacity(faces.corners().len()));
    for corners in faces.iter() {
        for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let edge = [a.min(b), a.max(b)];
            around.push(*midpoints.entry(edge).or_insert_with(|| {
                edges.push(edge);
                (n_vertices + edges.len() - 1) as u32
            }));
        }
    }
    let mut finer = Polygons::with_capacity(around.len(), 4 * around.len());
    let (mut center, mut around) = ((n_vertices + edges.len()) as u32, around.as_slice());
    for corners in faces.iter() {
        let (own, rest) = around.split_at(corners.len());
        for (k, &corner) in corners.iter().enumerate() {
            finer.push(&[corner, own[k], center, own[(k + corners.len() - 1) % corners.len()]]);
        }
        (center, around) = (center + 1, rest);
    }
    SubdividedPolygons { n_vertices: center as usize, faces: finer, edges }
}
