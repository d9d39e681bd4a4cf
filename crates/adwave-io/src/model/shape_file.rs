//! The central type: what a file says of a shape.

use std::sync::Arc;

use adwave::shape::Polygons;

use crate::model::source_document::SourceDocument;
use crate::provenance::Provenance;
use crate::{Field, Format, ShapeFileError};

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
    /// One weight per edge, or empty when the file has none.
    pub weights: Vec<f64>,
    /// Whether each pair stands for both directions.
    pub direction: Direction,
}

/// A shape with everything its file said of it: vertices and faces in the file's order, every attribute as a named
/// field, and what is needed to write the same file again with other coordinates. Copies share points, faces and the original
/// bytes.
///
/// With faces it is a mesh, without a point cloud; a MatrixMarket matrix is a graph that has edges and no points.
///
/// ```
/// use adwave_io::{Format, ReadLimits, ShapeFile, read_bytes, write_bytes};
/// let text = b"# kept\nv 0 0 0\nv 1.50 0 0\nv 0 1 0\nf 1 2 3\n";
/// let mut shape = read_bytes(text.to_vec(), Some("a.obj"), &ReadLimits::default()).unwrap();
/// let mut points = shape.points().to_vec();
/// points[0][2] = 0.25;
/// shape.set_points(points)?;
/// let mut out = Vec::new();
/// write_bytes(&shape, Format::OBJ, &mut out).unwrap();
/// assert_eq!(out, b"# kept\nv 0 0 0.25\nv 1.50 0 0\nv 0 1 0\nf 1 2 3\n");
/// # Ok::<(), adwave_io::ShapeFileError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ShapeFile {
    pub(crate) n_vertices: usize,
    pub(crate) points: Arc<Vec<[f64; 3]>>,
    pub(crate) faces: Arc<Polygons>,
    pub(crate) edges: Edges,
    pub(crate) vertex_fields: Vec<Field>,
    pub(crate) face_fields: Vec<Field>,
    pub(crate) format: Option<Format>,
    pub(crate) precision: Precision,
    /// The part of the anatomy, where the file names it.
    pub(crate) structure: Option<String>,
    /// What only the original bytes hold, named for the report of what another format leaves out.
    pub(crate) extras: Vec<String>,
    pub(crate) original: Option<Arc<dyn SourceDocument>>,
    /// How many vertex fields the original has.
    pub(crate) n_original_fields: usize,
    /// Vertex fields that are not as in the original.
    pub(crate) edited: Vec<String>,
    /// Whether the points are as in the original.
    pub(crate) moved: bool,
    pub(crate) provenance: Option<Arc<Provenance>>,
    /// Whether that is about this shape, and not what its file says of itself.
    pub(crate) is_new_provenance: bool,
}

/// What a file says of a shape, each part on its own; see [`ShapeFile::into_parts`].
#[derive(Clone, Debug)]
pub struct ShapeParts {
    /// Number of vertices; of a graph without coordinates too.
    pub n_vertices: usize,
    /// The vertices in the file's order; empty for a graph without coordinates.
    pub points: Vec<[f64; 3]>,
    /// The faces in the file's order.
    pub faces: Polygons,
    /// The edges that the file lists itself.
    pub edges: Edges,
    /// The attributes of the vertices, one row per vertex each.
    pub vertex_fields: Vec<Field>,
    /// The attributes of the faces, one row per face each.
    pub face_fields: Vec<Field>,
    /// The format that the bytes had.
    pub format: Option<Format>,
    /// The number type of the coordinates in the file.
    pub precision: Precision,
}

impl ShapeFile {
    pub(crate) fn empty() -> Self {
        Self {
            n_vertices: 0,
            points: Arc::default(),
            faces: Arc::default(),
            edges: Edges::default(),
            vertex_fields: Vec::new(),
            face_fields: Vec::new(),
            format: None,
            precision: Precision::F64,
            structure: None,
            extras: Vec::new(),
            original: None,
            n_original_fields: 0,
            edited: Vec::new(),
            moved: false,
            provenance: None,
            is_new_provenance: false,
        }
    }

    /// A mesh that comes from no file.
    pub fn from_mesh(points: Vec<[f64; 3]>, faces: Polygons) -> Self {
        Self { n_vertices: points.len(), points: Arc::new(points), faces: Arc::new(faces), ..Self::empty() }
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

    /// The vertices, to be used elsewhere without a copy.
    pub fn shared_points(&self) -> Arc<Vec<[f64; 3]>> {
        Arc::clone(&self.points)
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

    /// The attributes of the faces, one row per face each.
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

    /// The part of the anatomy that a GIFTI names (`AnatomicalStructurePrimary`), such as `CortexLeft`.
    pub fn structure(&self) -> Option<&str> {
        self.structure.as_deref()
    }

    /// What the file has besides points, faces and fields; only a file of the same format keeps it.
    pub fn extras(&self) -> &[String] {
        &self.extras
    }

    /// Replaces the coordinates of all vertices.
    ///
    /// # Errors
    /// [`ShapeFileError::PointCount`] when there are not as many points as vertices, [`ShapeFileError::NotFinite`] when one is at no
    /// place where the old one was at one.
    pub fn set_points(&mut self, points: Vec<[f64; 3]>) -> Result<(), ShapeFileError> {
        if points.len() != self.n_vertices {
            return Err(ShapeFileError::PointCount { found: points.len(), n_vertices: self.n_vertices });
        }
        let is_finite = |p: &[f64; 3]| p.iter().all(|c| c.is_finite());
        let lost =
            |vertex: &usize| !is_finite(&points[*vertex]) && self.points.get(*vertex).is_some_and(is_finite);
        if let Some(vertex) = (0..points.len()).find(lost) {
            return Err(ShapeFileError::NotFinite { vertex, point: points[vertex] });
        }
        self.points = Arc::new(points);
        self.moved = true;
        Ok(())
    }

    /// Adds an attribute of the vertices, in place of one of the same name.
    ///
    /// # Errors
    /// [`ShapeFileError`] when the field does not have whole rows, one per vertex.
    pub fn add_vertex_field(&mut self, field: Field) -> Result<(), ShapeFileError> {
        check_rows(&field, self.n_vertices, "vertices")?;
        if !self.edited.contains(&field.name) {
            self.edited.push(field.name.clone());
        }
        match self.vertex_fields.iter_mut().find(|f| f.name == field.name) {
            Some(old) => *old = field,
            None => self.vertex_fields.push(field),
        }
        Ok(())
    }

    /// Adds an attribute of the faces, in place of one of the same name.
    ///
    /// # Errors
    /// [`ShapeFileError`] when the field does not have whole rows, one per face.
    pub fn add_face_field(&mut self, field: Field) -> Result<(), ShapeFileError> {
        check_rows(&field, self.faces.len(), "faces")?;
        // The original's faces are copied as they are, so they cannot carry another attribute.
        self.original = None;
        match self.face_fields.iter_mut().find(|f| f.name == field.name) {
            Some(old) => *old = field,
            None => self.face_fields.push(field),
        }
        Ok(())
    }

    /// Gives everything away; the original bytes are dropped. Points and faces are copied where a shape or another file uses
    /// them too.
    ///
    /// ```
    /// use adwave_io::ShapeFile;
    /// let parts = ShapeFile::from_cloud(vec![[0.0, 1.0, 2.0]]).into_parts();
    /// assert_eq!((parts.n_vertices, parts.points.as_flattened()), (1, &[0.0, 1.0, 2.0][..]));
    /// ```
    pub fn into_parts(self) -> ShapeParts {
        ShapeParts {
            n_vertices: self.n_vertices,
            points: Arc::unwrap_or_clone(self.points),
            faces: Arc::unwrap_or_clone(self.faces),
            edges: self.edges,
            vertex_fields: self.vertex_fields,
            face_fields: self.face_fields,
            format: self.format,
            precision: self.precision,
        }
    }

    /// Where the shape came from, as its file says or as [`set_provenance`](Self::set_provenance) has it.
    pub fn provenance(&self) -> Option<&Provenance> {
        self.provenance.as_deref()
    }

    /// Says where the shape came from, to be written where the format has room for it; see [`Provenance`].
    pub fn set_provenance(&mut self, provenance: Option<Provenance>) {
        self.is_new_provenance = provenance.is_some();
        self.provenance = provenance.map(Arc::new);
    }

    /// What is to be written into a file that says something else so far.
    pub(crate) fn new_provenance(&self) -> Option<&Provenance> {
        self.provenance().filter(|_| self.is_new_provenance)
    }

    /// What holds of the shape as it is: nothing, when it was changed after its file said something.
    pub(crate) fn valid_provenance(&self) -> Option<&Provenance> {
        let is_changed = self.moved || !self.edited.is_empty();
        self.provenance().filter(|_| self.is_new_provenance || !is_changed)
    }

    /// The shape as it was read: its fields are those of the file.
    pub(crate) fn with_original_fields(mut self) -> Self {
        self.n_original_fields = self.vertex_fields.len();
        self
    }

    /// Forgets the original bytes: frees their memory, and writing makes a plain new file.
    pub fn forget_original(&mut self) {
        self.original = None;
    }
}

/// The field's public parts may have been changed since it was made, so its rows are counted anew.
fn check_rows(field: &Field, n: usize, of: &'static str) -> Result<(), ShapeFileError> {
    let (found, n_channels) = (field.values.len(), field.n_channels);
    if n_channels == 0 || !found.is_multiple_of(n_channels) {
        return Err(ShapeFileError::FieldValues { name: field.name.clone(), found, n_channels });
    }
    if found / n_channels != n {
        return Err(ShapeFileError::FieldRows { name: field.name.clone(), found: found / n_channels, n, of });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FieldValues;

    #[test]
    fn wrong_lengths_are_errors_that_name_the_numbers() {
        let mut file = ShapeFile::from_cloud(vec![[0.0; 3]; 4]);
        assert_eq!(
            file.set_points(vec![[0.0; 3]; 5]).unwrap_err().to_string(),
            "there are 5 points for 4 vertices; give one point per vertex"
        );
        let gaze = Field::new("gaze", 2, FieldValues::F32(vec![0.0; 6]));
        assert_eq!(
            file.add_vertex_field(gaze.clone()).unwrap_err().to_string(),
            "field `gaze` has 3 rows for 4 vertices; give one row for each"
        );
        assert_eq!(
            file.add_face_field(gaze.clone()).unwrap_err().to_string(),
            "field `gaze` has 3 rows for 0 faces; give one row for each"
        );
        let broken = Field { n_channels: 0, ..gaze };
        assert_eq!(
            file.add_vertex_field(broken).unwrap_err().to_string(),
            "field `gaze` has 6 values, which are not whole rows of 0 channels"
        );
        assert!(file.vertex_fields().is_empty());
    }
}
