//! Conversion of a file's content to a shape of the library.

use adwave::grid::GridError;
use adwave::shape::{Graph, GraphError, Mesh, PointCloud, Shape, ShapeError};
use adwave::{Cancelled, ClassifiedError, ErrorKind, named_values};
use std::sync::Arc;

use crate::{Direction, Edges, ShapeFile};

/// Kind of shape that the content of a file is interpreted as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ShapeKind {
    /// Points and faces.
    Mesh,
    /// Points alone.
    Cloud,
    /// The file's own edges, with their weights or, without weights and with positions, as a curve; without edges,
    /// those of the faces with weight 1.
    Graph,
}

named_values!(ShapeKind, "kind", {
    Mesh => "mesh", "";
    Cloud => "cloud", "";
    Graph => "graph", "";
});

/// Reasons for which the content of a file cannot be changed or used as requested.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeFileError {
    /// The number of new points differs from the number of vertices.
    #[error("expected {n_vertices} points, one per vertex; got {found}")]
    PointCount {
        /// Number of points given.
        found: usize,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// The number of flags differs from the number of faces.
    #[error("expected {n_faces} flags, one per face; got {found}")]
    FaceCount {
        /// Number of flags given.
        found: usize,
        /// Number of faces.
        n_faces: usize,
    },
    /// Faces of a selection, which is written with the rest of the file.
    #[error("faces are turned over in a whole file, and this is a part of one; leave out --only and --mask")]
    PartOfFile,
    /// A new position is not finite.
    #[error("new positions must be finite, but vertex {vertex} would be at ({}, {}, {}); reduce gains, \
            lengths or noise", .point[0], .point[1], .point[2])]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
        /// New position.
        point: [f64; 3],
    },
    /// The number of rows of a field differs from the number of vertices or faces.
    #[error("field `{name}` needs {n} rows, one for each of the {of}; got {found}")]
    FieldRows {
        /// Name of the field.
        name: String,
        /// Number of rows.
        found: usize,
        /// Number of vertices or faces.
        n: usize,
        /// `vertices` or `faces`.
        of: &'static str,
    },
    /// The values of a field do not form complete rows.
    #[error("field `{name}` needs complete rows of {n_channels} channels, got {found} values")]
    FieldValues {
        /// Name of the field.
        name: String,
        /// Number of values.
        found: usize,
        /// Number of channels per row.
        n_channels: usize,
    },
    /// The requested subset is not part of the file.
    #[error("the subset must not have {what}")]
    Subset {
        /// Fault of the subset.
        what: &'static str,
    },
    /// A selection keeps no vertex.
    #[error("the selection has no vertex; widen it")]
    EmptySelection,
    /// A mesh was requested, but there are no faces.
    #[error("the file has no faces, so it cannot be used as a mesh")]
    NoFaces,
    /// The file has an image or a volume (see [`ShapeFile::grid`]).
    #[error("the file holds an image or a volume, and a shape is needed")]
    NoShape,
    /// The file has values of the parts of a brain (see [`ShapeFile::brain`]).
    #[error(
        "the file holds values of the parts of a brain; give a surface as the shape, and this file as a field of it"
    )]
    NoShapeButParts,
    /// A graph was requested, but there are no edges.
    #[error("the file has no edges, so it cannot be used as a graph")]
    NoEdges,
    /// The points or faces do not form a shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The edges do not form a graph.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// The sizes, spacings or places without data do not form a grid.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for ShapeFileError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Cancelled(_) => ErrorKind::Cancelled,
            _ => ErrorKind::Input,
        }
    }
}

impl ShapeFile {
    /// Default kind of the content: a mesh if there are faces, a graph if there are only edges or vertices without
    /// coordinates, else a cloud.
    pub fn kind(&self) -> ShapeKind {
        if !self.faces.is_empty() {
            ShapeKind::Mesh
        } else if self.edges.pairs.is_empty() && self.points.len() == self.n_vertices {
            ShapeKind::Cloud
        } else {
            ShapeKind::Graph
        }
    }

    /// Converts to a shape; both share points and faces.
    ///
    /// ```
    /// use adwave::shape::Shape;
    /// use adwave_io::{ReadLimits, ShapeKind, read_bytes};
    /// let file = read_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(), None, &ReadLimits::default()).unwrap();
    /// assert!(matches!(file.to_shape()?, Shape::Mesh(_)));
    /// assert!(matches!(file.to_shape_as(ShapeKind::Graph)?, Shape::Graph(g) if g.n_nodes() == 3));
    /// # Ok::<(), adwave_io::ShapeFileError>(())
    /// ```
    ///
    /// # Errors
    /// [`ShapeFileError`]: a coordinate is not finite, an edge has a bad weight, or there are no vertices.
    pub fn to_shape(&self) -> Result<Shape, ShapeFileError> {
        self.to_shape_as(self.kind())
    }

    /// Converts to a shape of the given kind; both share points and faces.
    ///
    /// # Errors
    /// The errors of [`to_shape`](Self::to_shape), missing faces of a mesh or edges of a graph, and an image or a volume.
    pub fn to_shape_as(&self, kind: ShapeKind) -> Result<Shape, ShapeFileError> {
        if self.grid.is_some() {
            return Err(ShapeFileError::NoShape);
        }
        if self.brain.is_some() {
            return Err(ShapeFileError::NoShapeButParts);
        }
        Ok(match kind {
            ShapeKind::Mesh if self.faces.is_empty() => return Err(ShapeFileError::NoFaces),
            ShapeKind::Mesh => {
                Shape::Mesh(Mesh::from_shared(Arc::clone(&self.points), Arc::clone(&self.faces))?)
            }
            ShapeKind::Cloud => Shape::Cloud(self.to_cloud()?),
            ShapeKind::Graph => Shape::Graph(self.to_graph()?),
        })
    }

    /// The points, with the normals that the file has.
    fn to_cloud(&self) -> Result<PointCloud, ShapeFileError> {
        let cloud = PointCloud::from_shared(Arc::clone(&self.points))?;
        let normals = self.field("normal").filter(|field| field.n_channels == 3).map(|f| f.values.to_f64());
        Ok(match normals {
            Some(normals) if normals.len() == 3 * self.points.len() => {
                cloud.with_normals(normals.as_chunks().0.to_vec())
            }
            _ => cloud,
        })
    }

    /// Consuming variant of [`to_shape`](Self::to_shape): everything but points and faces is dropped.
    ///
    /// # Errors
    /// The errors of [`to_shape`](Self::to_shape).
    pub fn into_shape(self) -> Result<Shape, ShapeFileError> {
        let kind = self.kind();
        self.into_shape_as(kind)
    }

    /// Consuming variant of [`to_shape_as`](Self::to_shape_as).
    ///
    /// # Errors
    /// The errors of [`to_shape_as`](Self::to_shape_as).
    pub fn into_shape_as(self, kind: ShapeKind) -> Result<Shape, ShapeFileError> {
        self.to_shape_as(kind)
    }

    /// The edges with their weights. Edges of the file with positions and without weights are a curve; weights, or the
    /// edges of faces, decide the steps even if there are positions. If the steps do not follow from the positions and
    /// some of these are not finite, the graph has no positions.
    fn to_graph(&self) -> Result<Graph, ShapeFileError> {
        let has_positions = self.points.len() == self.n_vertices && !self.points.is_empty();
        if has_positions && !self.edges.pairs.is_empty() && self.edges.weights.is_empty() {
            return Ok(Graph::curve(Arc::clone(&self.points), &self.edges.pairs)?);
        }
        let list: Vec<(u32, u32, f64)> = if self.edges.pairs.is_empty() {
            self.edges_of_faces().into_iter().map(|[a, b]| (a, b, 1.0)).collect()
        } else {
            weighted(&self.edges).collect()
        };
        if list.is_empty() {
            return Err(ShapeFileError::NoEdges);
        }
        let graph = Graph::new(self.n_vertices, &list)?;
        if !has_positions {
            return Ok(graph);
        }
        Ok(graph.clone().with_positions(Arc::clone(&self.points)).unwrap_or(graph))
    }

    /// Distinct undirected edges of the faces, smaller vertex first, in ascending order.
    fn edges_of_faces(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> = self
            .faces
            .iter()
            .flat_map(|face| (0..face.len()).map(|k| [face[k], face[(k + 1) % face.len()]]))
            .map(|[a, b]| [a.min(b), a.max(b)])
            .filter(|[a, b]| a != b)
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

/// Weighted edges for a graph. A matrix that lists both directions has every edge twice, and each entry contributes
/// half, so that an unsymmetric matrix M gives the graph of (M + Mᵀ)/2.
fn weighted(edges: &Edges) -> impl Iterator<Item = (u32, u32, f64)> {
    let part = if edges.direction == Direction::RowToColumn { 0.5 } else { 1.0 };
    let weight = move |k: usize| part * edges.weights.get(k).copied().unwrap_or(1.0);
    edges.pairs.iter().enumerate().map(move |(k, &[a, b])| (a, b, weight(k)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::shape::Polygons;

    fn square() -> ShapeFile {
        let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        ShapeFile::from_mesh(points, Polygons::from_triangles(&[[0, 1, 2], [0, 2, 3]]))
    }

    #[test]
    fn a_file_is_what_it_holds_or_what_is_asked_for() {
        assert_eq!(square().kind(), ShapeKind::Mesh);
        assert!(matches!(square().to_shape_as(ShapeKind::Cloud), Ok(Shape::Cloud(_))));
        let Ok(Shape::Graph(graph)) = square().to_shape_as(ShapeKind::Graph) else { panic!("no graph") };
        assert_eq!(graph.neighbors(0).collect::<Vec<_>>(), [(1, 1.0), (2, 1.0), (3, 1.0)]);
        let cloud = ShapeFile::from_cloud(vec![[0.0; 3]]);
        assert_eq!(cloud.to_shape_as(ShapeKind::Mesh).unwrap_err(), ShapeFileError::NoFaces);
        assert_eq!(cloud.to_shape_as(ShapeKind::Graph).unwrap_err(), ShapeFileError::NoEdges);
        // Vertices without coordinates are no cloud.
        let isolated = ShapeFile::from_graph(3, Edges::default());
        assert_eq!(isolated.into_shape().unwrap_err(), ShapeFileError::NoEdges);
        let pairs = vec![[0, 1], [1, 0]];
        for (direction, weight) in [(Direction::Both, 2.0), (Direction::RowToColumn, 1.0)] {
            let edges = Edges { pairs: pairs.clone(), direction, ..Edges::default() };
            let Ok(Shape::Graph(graph)) = ShapeFile::from_graph(2, edges).into_shape() else {
                panic!("no graph")
            };
            assert_eq!(graph.neighbors(0).collect::<Vec<_>>(), [(1, weight)]);
        }
    }

    #[test]
    fn a_file_and_its_shape_share_points_and_faces() {
        let mut file = square();
        let Ok(Shape::Mesh(mesh)) = file.to_shape() else { panic!("no mesh") };
        assert_eq!(mesh.points().as_ptr(), file.points().as_ptr());
        assert_eq!(mesh.faces().corners().as_ptr(), file.faces().corners().as_ptr());
        // Changes to the file do not affect the shape.
        file.set_points(vec![[7.0; 3]; 4]).unwrap();
        assert_eq!((mesh.points()[2], file.points()[2]), ([1.0, 1.0, 0.0], [7.0; 3]));
    }
}
