//! Welding of vertices at equal positions.

use crate::topology::renamed;
use crate::{BorderCorners, Hierarchy, QuadParams, SubdivisionError};
use adwave::Progress;
use adwave::shape::{Mesh, Polygons, VertexMap, WeldMode, triangulate};

/// Mesh in which vertices at equal positions are one vertex. Files split vertices along the seams of a
/// texture, and a seam must not cut a hierarchy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WeldedMesh {
    /// Welded vertex of each vertex of the mesh.
    pub of_vertex: Vec<u32>,
    /// First vertex of the mesh at each welded vertex, increasing.
    pub vertices: Vec<u32>,
    /// Faces, as welded vertices.
    pub faces: Polygons,
    /// Triangles of the faces, as welded vertices: the faces themselves if all are triangles.
    pub triangles: Vec<[u32; 3]>,
}

impl WeldedMesh {
    /// Welds the vertices of a mesh. O(n log n).
    ///
    /// ```
    /// use adwave::shape::{Mesh, Polygons};
    /// let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0; 3]];
    /// let mesh = Mesh::new(points, Polygons::from_triangles(&[[3, 1, 2]]))?;
    /// let welded = adwave_subdivision::WeldedMesh::new(&mesh);
    /// assert_eq!((welded.vertices, welded.triangles), (vec![0, 1, 2], vec![[0, 1, 2]]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(mesh: &Mesh) -> Self {
        let map = VertexMap::new(mesh.points(), WeldMode::EqualPositions);
        let (mut places, mut vertices) = (vec![u32::MAX; map.n_welded()], Vec::with_capacity(map.n_welded()));
        let place = |v: usize| {
            let place = &mut places[map.welded(v)];
            if *place == u32::MAX {
                *place = vertices.len() as u32;
                vertices.push(v as u32);
            }
            *place
        };
        let of_vertex: Vec<u32> = (0..mesh.points().len()).map(place).collect();
        let faces = renamed(mesh.faces(), |v| of_vertex[v as usize]);
        let triangles = if let Some(triangles) = faces.triangles() {
            triangles.to_vec()
        } else {
            let points: Vec<[f64; 3]> = vertices.iter().map(|&v| mesh.points()[v as usize]).collect();
            triangulate(&points, &faces)
        };
        Self { of_vertex, vertices, faces, triangles }
    }

    /// Finds the levels of the mesh: those of triangles, or of polygons with the positions and these creases, which are
    /// pairs of vertices of the mesh.
    ///
    /// # Errors
    /// As for [`Hierarchy::from_faces`].
    pub fn hierarchy(
        &self,
        mesh: &Mesh,
        creases: &[[u32; 2]],
        corners: BorderCorners,
        progress: Progress<'_>,
    ) -> Result<Hierarchy, SubdivisionError> {
        let points = self.points(mesh);
        let n_vertices = mesh.points().len();
        for &[a, b] in creases {
            if a.max(b) as usize >= n_vertices {
                return Err(SubdivisionError::NoEdge { a, b });
            }
        }
        let creases: Vec<[u32; 2]> =
            creases.iter().map(|pair| pair.map(|v| self.of_vertex[v as usize])).collect();
        let params = QuadParams { points: Some(&points), creases: &creases, corners };
        Hierarchy::from_faces(points.len(), &self.faces, &params, progress)
    }

    /// Positions of the welded vertices.
    pub fn points(&self, mesh: &Mesh) -> Vec<[f64; 3]> {
        self.vertices.iter().map(|&v| mesh.points()[v as usize]).collect()
    }

    /// Values of the welded vertices, from `n_channels` values per vertex of the mesh.
    ///
    /// # Errors
    /// [`SubdivisionError::Seam`] if the values of two copies of a vertex differ, because a hierarchy could not restore
    /// them.
    pub fn gather(&self, values: &[f64], n_channels: usize) -> Result<Vec<f64>, SubdivisionError> {
        let row = |v: usize| &values[v * n_channels..][..n_channels];
        for (v, &welded) in self.of_vertex.iter().enumerate() {
            let first = self.vertices[welded as usize];
            if row(v) != row(first as usize) && !row(v).iter().any(|x| x.is_nan()) {
                return Err(SubdivisionError::Seam { vertex: v as u32, first });
            }
        }
        Ok(self.vertices.iter().flat_map(|&v| row(v as usize).iter().copied()).collect())
    }

    /// Values of all vertices of the mesh, from `n_channels` values per welded vertex.
    pub fn scatter(&self, values: &[f64], n_channels: usize) -> Vec<f64> {
        let row = |v: u32| values[v as usize * n_channels..][..n_channels].iter().copied();
        self.of_vertex.iter().flat_map(|&v| row(v)).collect()
    }
}
