//! From what a file says to the shape that the mathematics works on.

use adwave::shape::{Graph, GraphError, Mesh, PointCloud, Shape, ShapeError};
use adwave::{ClassifiedError, ErrorKind};
use std::collections::BTreeMap;
use std::sync::Arc;

use crate::{Direction, Edges, ShapeFile};

/// What the content of a file is taken as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ShapeKind {
    /// Points and faces.
    Mesh,
    /// Points alone.
    Cloud,
    /// The file's own edges with their weights; without any, the edges of the faces with weight 1.
    Graph,
}

/// Why what a file holds cannot be changed or used as asked.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum ShapeFileError {
    /// New points are not as many as the vertices.
    #[error("there are {found} points for {n_vertices} vertices; give one point per vertex")]
    PointCount {
        /// How many points were given.
        found: usize,
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// A new position that is none.
    #[error("vertex {vertex} would be at ({}, {}, {}); are gains, lengths or noise that large meant?", .point[0], .point[1], .point[2])]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// Where it would be.
        point: [f64; 3],
    },
    /// A field does not have one row per vertex or face.
    #[error("field `{name}` has {found} rows for {n} {of}; give one row for each")]
    FieldRows {
        /// Its name.
        name: String,
        /// How many rows it has.
        found: usize,
        /// How many vertices or faces there are.
        n: usize,
        /// `vertices` or `faces`.
        of: &'static str,
    },
    /// A field's values do not make whole rows.
    #[error("field `{name}` has {found} values, which are not whole rows of {n_channels} channels")]
    FieldValues {
        /// Its name.
        name: String,
        /// How many values there are.
        found: usize,
        /// How many channels each row shall have.
        n_channels: usize,
    },
    /// A part of the file was asked for that it does not have.
    #[error("the part to keep has {what}")]
    Subset {
        /// What is wrong with it.
        what: &'static str,
    },
    /// A mesh was asked for.
    #[error("there are no faces to take it as a mesh")]
    NoFaces,
    /// A graph was asked for.
    #[error("there are no edges to take it as a graph")]
    NoEdges,
    /// The points or faces are no shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The edges are no graph.
    #[error(transparent)]
    Graph(#[from] GraphError),
}

impl ClassifiedError for ShapeFileError {
    /// Always the input's.
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

impl ShapeFile {
    /// What the content is when nothing else is asked for: a mesh where there are faces, a graph where there are edges alone, else
    /// a cloud.
    pub fn kind(&self) -> ShapeKind {
        if !self.faces.is_empty() {
            ShapeKind::Mesh
        } else if self.edges.pairs.is_empty() {
            ShapeKind::Cloud
        } else {
            ShapeKind::Graph
        }
    }

    /// The shape that the file holds; both share points and faces.
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

    /// The shape that the content is when taken as `kind`; both share points and faces.
    ///
    /// # Errors
    /// As [`to_shape`](Self::to_shape), and when the file lacks the faces of a mesh or the edges of a graph.
    pub fn to_shape_as(&self, kind: ShapeKind) -> Result<Shape, ShapeFileError> {
        Ok(match kind {
            ShapeKind::Mesh if self.faces.is_empty() => return Err(ShapeFileError::NoFaces),
            ShapeKind::Mesh => {
                Shape::Mesh(Mesh::from_shared(Arc::clone(&self.points), Arc::clone(&self.faces))?)
            }
            ShapeKind::Cloud => Shape::Cloud(PointCloud::from_shared(Arc::clone(&self.points))?),
            ShapeKind::Graph => Shape::Graph(self.to_graph()?),
        })
    }

    /// [`to_shape`](Self::to_shape) of a file that is of no further use: everything but points and faces is dropped.
    ///
    /// # Errors
    /// As [`to_shape`](Self::to_shape).
    pub fn into_shape(self) -> Result<Shape, ShapeFileError> {
        let kind = self.kind();
        self.into_shape_as(kind)
    }

    /// [`to_shape_as`](Self::to_shape_as) of a file that is of no further use.
    ///
    /// # Errors
    /// As [`to_shape_as`](Self::to_shape_as).
    pub fn into_shape_as(self, kind: ShapeKind) -> Result<Shape, ShapeFileError> {
        self.to_shape_as(kind)
    }

    fn to_graph(&self) -> Result<Graph, ShapeFileError> {
        let list: Vec<(u32, u32, f64)> = if self.edges.pairs.is_empty() {
            self.edges_of_faces().into_iter().map(|[a, b]| (a, b, 1.0)).collect()
        } else {
            weighted(&self.edges).collect()
        };
        if list.is_empty() {
            return Err(ShapeFileError::NoEdges);
        }
        Ok(Graph::new(self.n_vertices, &list)?)
    }

    /// Whether the edges are the entries of a matrix M that is not symmetric, of which [`to_shape`](Self::to_shape) takes
    /// (M + Mᵀ)/2. O(edges log edges).
    ///
    /// ```
    /// use adwave_io::{ReadLimits, read_bytes};
    /// let matrix = |entries: &str| {
    ///     let text = format!("%%MatrixMarket matrix coordinate real general\n2 2 2\n{entries}");
    ///     read_bytes(text.into_bytes(), Some("a.mtx"), &ReadLimits::default()).unwrap()
    /// };
    /// assert!(!matrix("1 2 3\n2 1 3\n").is_unsymmetric());
    /// assert!(matrix("1 2 3\n2 1 4\n").is_unsymmetric());
    /// ```
    pub fn is_unsymmetric(&self) -> bool {
        let edges = self.edges();
        if edges.direction == Direction::Both {
            return false;
        }
        let mut sums: BTreeMap<[u32; 2], f64> = BTreeMap::new();
        for (k, pair) in edges.pairs.iter().enumerate().filter(|(_, [a, b])| a != b) {
            *sums.entry(*pair).or_default() += edges.weights.get(k).copied().unwrap_or(1.0);
        }
        let is_matched = |(&[a, b], weight): (&[u32; 2], &f64)| {
            let other = sums.get(&[b, a]).copied().unwrap_or(0.0);
            (weight - other).abs() <= 1e-12 * weight.abs().max(other.abs())
        };
        !sums.iter().all(is_matched)
    }

    /// The distinct undirected edges of the faces, smaller vertex first, in order.
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

/// A matrix that lists both directions has every edge twice; half of each makes the edge, so that a matrix M that is not
/// symmetric gives the graph of (M + Mᵀ)/2.
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
        // What is changed in the file stays as it was in the shape.
        file.set_points(vec![[7.0; 3]; 4]).unwrap();
        assert_eq!((mesh.points()[2], file.points()[2]), ([1.0, 1.0, 0.0], [7.0; 3]));
    }
}
