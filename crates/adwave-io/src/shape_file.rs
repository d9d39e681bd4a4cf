//! The central type: what a file says of a shape.

use std::sync::Arc;

use adwave::shape::Polygons;

use crate::original::Original;
use crate::{Field, Format};

/// The number type of the coordinates in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 32-bit floating point.
    F32,
    /// 64-bit floating point, or text.
    F64,
}

/// Whether an edge is listed once for both directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// `[a, b]` stands for both directions.
    #[default]
    Both,
    /// `[a, b]` is the matrix entry of row a, column b alone; the other direction has its own entry.
    RowToColumn,
}

/// The edges of a graph or wire frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Edges {
    /// Two vertex indices each.
    pub pairs: Vec<[u32; 2]>,
    /// One weight an edge, or empty when the file has none.
    pub weights: Vec<f64>,
    /// Whether each pair stands for both directions.
    pub direction: Direction,
}

/// A shape with everything its file said of it: vertices and faces in the file's order, every attribute as a named
/// field, and what is needed to write the same file again with other coordinates.
///
/// With faces it is a mesh, without a point cloud; a MatrixMarket matrix is a graph that has edges and no points.
///
/// ```
/// use adwave_io::{Format, ReadLimits, ShapeFile, read_bytes, write_bytes};
/// let text = b"# kept\nv 0 0 0\nv 1.50 0 0\nv 0 1 0\nf 1 2 3\n";
/// let mut shape = read_bytes(text.to_vec(), Some("a.obj"), &ReadLimits::default()).unwrap();
/// let mut points = shape.points().to_vec();
/// points[0][2] = 0.25;
/// shape.set_points(points);
/// let mut out = Vec::new();
/// write_bytes(&shape, Format::Obj, &mut out).unwrap();
/// assert_eq!(out, b"# kept\nv 0 0 0.25\nv 1.50 0 0\nv 0 1 0\nf 1 2 3\n");
/// ```
#[derive(Clone, Debug)]
pub struct ShapeFile {
    pub(crate) n_vertices: usize,
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) faces: Polygons,
    pub(crate) edges: Edges,
    pub(crate) vertex_fields: Vec<Field>,
    pub(crate) face_fields: Vec<Field>,
    pub(crate) format: Option<Format>,
    pub(crate) precision: Precision,
    /// What only the original bytes hold, named for the report of what another format leaves out.
    pub(crate) extras: Vec<String>,
    pub(crate) original: Option<Arc<Original>>,
    /// How many vertex fields the original has.
    pub(crate) n_original_fields: usize,
    /// Vertex fields that are not as in the original.
    pub(crate) edited: Vec<String>,
    /// Whether the points are as in the original.
    pub(crate) moved: bool,
}

impl ShapeFile {
    pub(crate) fn empty() -> Self {
        Self {
            n_vertices: 0,
            points: Vec::new(),
            faces: Polygons::new(),
            edges: Edges::default(),
            vertex_fields: Vec::new(),
            face_fields: Vec::new(),
            format: None,
            precision: Precision::F64,
            extras: Vec::new(),
            original: None,
            n_original_fields: 0,
            edited: Vec::new(),
            moved: false,
        }
    }

    /// A mesh that comes from no file.
    pub fn from_mesh(points: Vec<[f64; 3]>, faces: Polygons) -> Self {
        Self { n_vertices: points.len(), points, faces, ..Self::empty() }
    }

    /// A point cloud that comes from no file.
    pub fn from_cloud(points: Vec<[f64; 3]>) -> Self {
        Self::from_mesh(points, Polygons::new())
    }

    /// A graph without coordinates that comes from no file.
    pub fn from_graph(n_vertices: usize, edges: Edges) -> Self {
        Self { n_vertices, edges, ..Self::empty() }
    }

    /// Number of vertices; of a graph without coordinates too.
    pub fn n_vertices(&self) -> usize {
        self.n_vertices
    }

    /// The vertices in the file's order; empty for a graph without coordinates. An STL has three for each triangle.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// The faces in the file's order, with the corners that the file gives: a face of one or two corners, or with a
    /// corner twice, is kept as it is.
    pub fn faces(&self) -> &Polygons {
        &self.faces
    }

    /// The edges that the file lists itself (OBJ lines, PLY edges, matrix entries), not those of the faces.
    pub fn edges(&self) -> &Edges {
        &self.edges
    }

    /// The attributes of the vertices, [`n_vertices`](Self::n_vertices) rows each.
    pub fn vertex_fields(&self) -> &[Field] {
        &self.vertex_fields
    }

    /// The attributes of the faces, one row a face each.
    pub fn face_fields(&self) -> &[Field] {
        &self.face_fields
    }

    /// The attribute of the vertices of that name.
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.vertex_fields.iter().find(|f| f.name == name)
    }

    /// Names of the vertices' attributes.
    pub fn field_names(&self) -> Vec<&str> {
        self.vertex_fields.iter().map(|f| f.name.as_str()).collect()
    }

    /// The format that the bytes had; `None` when the shape comes from no file.
    pub fn format(&self) -> Option<Format> {
        self.format
    }

    /// The number type of the coordinates in the file.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Chooses the number type that coordinates are written in where the format has a choice.
    pub fn set_precision(&mut self, precision: Precision) {
        if precision != self.precision {
            self.original = None;
        }
        self.precision = precision;
    }

    /// What the file has besides points, faces and fields; only a file of the same format keeps it.
    pub fn extras(&self) -> &[String] {
        &self.extras
    }

    /// Replaces the coordinates of all vertices.
    ///
    /// # Panics
    /// When there are not as many points as vertices.
    pub fn set_points(&mut self, points: Vec<[f64; 3]>) {
        assert_eq!(points.len(), self.n_vertices, "one point for each vertex");
        self.points = points;
        self.moved = true;
    }

    /// Adds an attribute of the vertices, in place of one of the same name.
    ///
    /// # Panics
    /// When the field does not have one row a vertex.
    pub fn add_vertex_field(&mut self, field: Field) {
        assert_eq!(field.len(), self.n_vertices, "one row for each vertex");
        if !self.edited.contains(&field.name) {
            self.edited.push(field.name.clone());
        }
        match self.vertex_fields.iter_mut().find(|f| f.name == field.name) {
            Some(old) => *old = field,
            None => self.vertex_fields.push(field),
        }
    }

    /// Adds an attribute of the faces, in place of one of the same name.
    ///
    /// # Panics
    /// When the field does not have one row a face.
    pub fn add_face_field(&mut self, field: Field) {
        assert_eq!(field.len(), self.faces.len(), "one row for each face");
        // The original's faces are copied as they are, so they cannot carry another attribute.
        self.original = None;
        match self.face_fields.iter_mut().find(|f| f.name == field.name) {
            Some(old) => *old = field,
            None => self.face_fields.push(field),
        }
    }

    /// Forgets the original bytes: frees their memory, and writing makes a plain new file.
    pub fn forget_original(&mut self) {
        self.original = None;
    }
}
