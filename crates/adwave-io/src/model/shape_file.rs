//! Content of a shape file, the central type of this crate.

use std::path::Path;
use std::sync::Arc;

use adwave::shape::Polygons;

use crate::model::brain_layout::BrainLayout;
use crate::model::float_steps::note_on_reading;
use crate::model::grid_layout::GridLayout;
use crate::model::partial::{FileRows, WholeFile};
use crate::model::source_document::SourceDocument;
use crate::model::units::{CoordinateSystem, LengthUnit};
use crate::provenance::Provenance;
use crate::{Field, Format, ShapeFileError, ValueType};

/// Name of the vertex field with the number of the scan.
pub(crate) const SCAN: &str = "scan";

/// Number type of the coordinates in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CoordinatePrecision {
    /// 32-bit floating point.
    F32,
    /// 64-bit floating point, or text.
    F64,
}

/// Directions that a listed edge represents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Direction {
    /// `[a, b]` represents both directions.
    #[default]
    Both,
    /// `[a, b]` is the matrix entry of row a and column b only; the other direction has its own entry.
    RowToColumn,
}

/// Edges of a graph or wire frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Edges {
    /// Two vertex indices each.
    pub pairs: Vec<[u32; 2]>,
    /// One weight per edge, or empty if the file has none.
    pub weights: Vec<f64>,
    /// Directions that each pair represents.
    pub direction: Direction,
}

/// A shape with the whole content of its file: vertices and faces in the file's order, every attribute as a named
/// field, and the data needed to write the same file again with other coordinates. Copies share points, faces and the
/// original bytes.
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
    /// Name of each vertex, all different; `None` if the file has none.
    pub(crate) vertex_names: Option<Arc<Vec<String>>>,
    pub(crate) vertex_fields: Vec<Field>,
    pub(crate) face_fields: Vec<Field>,
    /// Values of the file as a whole, such as a time.
    pub(crate) field_data: Vec<Field>,
    pub(crate) format: Option<Format>,
    pub(crate) precision: CoordinatePrecision,
    /// Places of an image or a volume, which are the vertices.
    pub(crate) grid: Option<Arc<GridLayout>>,
    /// Parts of the brain that the values belong to.
    pub(crate) brain: Option<Arc<BrainLayout>>,
    /// True if the places are those of a map, whose fields are the content.
    pub(crate) is_map: bool,
    /// Type of the numbers of a written grid; `None` for that of the original or of the values.
    pub(crate) value_type: Option<ValueType>,
    /// Unit of length of the coordinates, if it is known.
    pub(crate) unit: Option<LengthUnit>,
    pub(crate) coordinate_system: Option<Arc<CoordinateSystem>>,
    /// Anatomical structure, if the file states it.
    pub(crate) structure: Option<String>,
    /// Places from which the scans were taken whose numbers the vertex field [`SCAN`] has; empty for a single scan.
    pub(crate) viewpoints: Vec<[f64; 3]>,
    /// Content that only the original bytes have, named in the report of losses in other formats.
    pub(crate) extras: Vec<String>,
    /// Assumptions that reading made, one line each.
    pub(crate) notes: Vec<String>,
    pub(crate) original: Option<Arc<dyn SourceDocument>>,
    /// Number of vertex fields of the original.
    pub(crate) n_original_fields: usize,
    /// Names of vertex fields that differ from the original.
    pub(crate) edited: Vec<String>,
    /// True if the points differ from the original.
    pub(crate) moved: bool,
    /// Normals of the corners of all faces that differ from the original, NaN at corners without; `None` if they are
    /// those of the original.
    pub(crate) corner_normals: Option<Arc<Vec<[f64; 3]>>>,
    pub(crate) provenance: Option<Arc<Provenance>>,
    /// True if the provenance describes this shape instead of its file.
    pub(crate) is_new_provenance: bool,
    /// Rows of the file that are the vertices; `None` if all are.
    pub(crate) rows: Option<Arc<FileRows>>,
    /// File with the vertices that were left out.
    pub(crate) whole: Option<Arc<WholeFile>>,
}

/// Content of a shape file in separate parts; see [`ShapeFile::into_parts`].
#[derive(Clone, Debug)]
pub struct ShapeParts {
    /// Number of vertices, also for a graph without coordinates.
    pub n_vertices: usize,
    /// Vertices in the file's order; empty for a graph without coordinates.
    pub points: Vec<[f64; 3]>,
    /// Faces in the file's order.
    pub faces: Polygons,
    /// Edges listed in the file.
    pub edges: Edges,
    /// Vertex fields, one row per vertex each.
    pub vertex_fields: Vec<Field>,
    /// Face fields, one row per face each.
    pub face_fields: Vec<Field>,
    /// Format of the original bytes.
    pub format: Option<Format>,
    /// Number type of the coordinates in the file.
    pub precision: CoordinatePrecision,
}

impl ShapeFile {
    pub(crate) fn empty() -> Self {
        Self {
            n_vertices: 0,
            points: Arc::default(),
            faces: Arc::default(),
            edges: Edges::default(),
            vertex_names: None,
            vertex_fields: Vec::new(),
            face_fields: Vec::new(),
            field_data: Vec::new(),
            format: None,
            precision: CoordinatePrecision::F64,
            grid: None,
            brain: None,
            is_map: false,
            value_type: None,
            unit: None,
            coordinate_system: None,
            structure: None,
            viewpoints: Vec::new(),
            extras: Vec::new(),
            notes: Vec::new(),
            original: None,
            n_original_fields: 0,
            edited: Vec::new(),
            moved: false,
            corner_normals: None,
            provenance: None,
            is_new_provenance: false,
            rows: None,
            whole: None,
        }
    }

    /// Creates a mesh without an original file.
    pub fn from_mesh(points: Vec<[f64; 3]>, faces: Polygons) -> Self {
        Self { n_vertices: points.len(), points: Arc::new(points), faces: Arc::new(faces), ..Self::empty() }
    }

    /// Creates a point cloud without an original file.
    pub fn from_cloud(points: Vec<[f64; 3]>) -> Self {
        Self::from_mesh(points, Polygons::new())
    }

    /// Creates a graph without coordinates and without an original file.
    pub fn from_graph(n_vertices: usize, edges: Edges) -> Self {
        Self { n_vertices, edges, ..Self::empty() }
    }

    /// Creates a graph with coordinates and without an original file; without weights it is a curve.
    pub fn from_curve(points: Vec<[f64; 3]>, edges: Edges) -> Self {
        Self { edges, ..Self::from_cloud(points) }
    }

    /// Number of vertices, also for a graph without coordinates.
    pub fn n_vertices(&self) -> usize {
        self.n_vertices
    }

    /// Vertices in the file's order; empty for a graph without coordinates. An STL has three for each triangle.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Shared reference to the vertices, without a copy.
    pub fn shared_points(&self) -> Arc<Vec<[f64; 3]>> {
        Arc::clone(&self.points)
    }

    /// Faces in the file's order, with the corners given in the file: faces of one or two corners, or with a repeated
    /// corner, are kept unchanged.
    pub fn faces(&self) -> &Polygons {
        &self.faces
    }

    /// Edges listed in the file (OBJ lines, PLY edges, matrix entries), not those of the faces.
    pub fn edges(&self) -> &Edges {
        &self.edges
    }

    /// Names of the vertices, such as the ids of the nodes in a GraphML.
    pub fn vertex_names(&self) -> Option<&[String]> {
        self.vertex_names.as_deref().map(Vec::as_slice)
    }

    /// Vertex fields with [`n_vertices`](Self::n_vertices) rows each.
    pub fn vertex_fields(&self) -> &[Field] {
        &self.vertex_fields
    }

    /// Face fields with one row per face each.
    pub fn face_fields(&self) -> &[Field] {
        &self.face_fields
    }

    /// Vertex field of that name.
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.vertex_fields.iter().find(|f| f.name == name)
    }

    /// Names of the vertex fields.
    pub fn field_names(&self) -> Vec<&str> {
        self.vertex_fields.iter().map(|f| f.name.as_str()).collect()
    }

    /// Format of the original bytes; `None` without an original file.
    pub fn format(&self) -> Option<Format> {
        self.format
    }

    /// True if the content of the file are fields on places that are given, such as a map of the sky or of the earth.
    pub fn is_map(&self) -> bool {
        self.is_map
    }

    /// Number type of the coordinates in the file.
    pub fn precision(&self) -> CoordinatePrecision {
        self.precision
    }

    /// Sets the number type of written coordinates, for formats with a choice.
    pub fn set_precision(&mut self, precision: CoordinatePrecision) {
        if precision != self.precision {
            self.original = None;
        }
        self.precision = precision;
    }

    /// Anatomical structure stated by a GIFTI (`AnatomicalStructurePrimary`), such as `CortexLeft`.
    pub fn structure(&self) -> Option<&str> {
        self.structure.as_deref()
    }

    /// Content of the file besides points, faces and fields, which only a file of the same format keeps.
    pub fn extras(&self) -> &[String] {
        &self.extras
    }

    /// Assumptions that reading made about the file, one line each, such as the columns of a table that are
    /// coordinates.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The place from which each vertex was seen, if the file has scans from several places.
    pub fn viewpoints(&self) -> Option<Vec<[f64; 3]>> {
        let differ = self.viewpoints.windows(2).any(|pair| pair[0] != pair[1]);
        let scan = self.field(SCAN).filter(|_| differ)?;
        (0..self.n_vertices).map(|x| self.viewpoints.get(scan.get(x, 0) as usize).copied()).collect()
    }

    /// Replaces the coordinates of all vertices.
    ///
    /// # Errors
    /// [`ShapeFileError::PointCount`] if the number of points differs from that of the vertices,
    /// [`ShapeFileError::NotFinite`] if a point is not finite although the old one was.
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

    /// Adds a vertex field, or replaces the one of the same name.
    ///
    /// # Errors
    /// [`ShapeFileError`] if the field does not have complete rows, one per vertex.
    pub fn add_vertex_field(&mut self, field: Field) -> Result<(), ShapeFileError> {
        let rows = if self.grid.is_some() { "places" } else { "vertices" };
        check_rows(&field, self.n_vertices, rows)?;
        if !self.edited.contains(&field.name) {
            self.edited.push(field.name.clone());
        }
        if field.name == "normal" {
            self.corner_normals = None;
        }
        match self.vertex_fields.iter_mut().find(|f| f.name == field.name) {
            Some(old) => *old = field,
            None => self.vertex_fields.push(field),
        }
        Ok(())
    }

    /// Removes those vertex fields that were added since the file was read and whose names satisfy `is_dropped`.
    pub fn drop_added_fields(&mut self, is_dropped: impl Fn(&str) -> bool) {
        let mut index = 0;
        self.vertex_fields.retain(|field| {
            index += 1;
            index <= self.n_original_fields || !is_dropped(&field.name)
        });
        let fields = &self.vertex_fields;
        self.edited.retain(|name| !is_dropped(name) || fields.iter().any(|field| field.name == *name));
    }

    /// Adds a face field, or replaces the one of the same name.
    ///
    /// # Errors
    /// [`ShapeFileError`] if the field does not have complete rows, one per face.
    pub fn add_face_field(&mut self, field: Field) -> Result<(), ShapeFileError> {
        check_rows(&field, self.faces.len(), "faces")?;
        // The original faces are copied unchanged, so they cannot store another field.
        self.original = None;
        match self.face_fields.iter_mut().find(|f| f.name == field.name) {
            Some(old) => *old = field,
            None => self.face_fields.push(field),
        }
        Ok(())
    }

    /// Names of files that a copy of this shape in the same format refers to and that do not exist in a folder, such as
    /// libraries of materials.
    pub fn missing_references(&self, format: Format, folder: &Path) -> Vec<String> {
        let Some(source) = self.original.as_deref().filter(|_| self.format == Some(format)) else {
            return Vec::new();
        };
        source.references().into_iter().filter(|name| !folder.join(name).exists()).collect()
    }

    /// Converts to separate parts; the original bytes are dropped. Points and faces are copied only if a shape or
    /// another file shares them.
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

    /// Provenance of the shape, from its file or from [`set_provenance`](Self::set_provenance).
    pub fn provenance(&self) -> Option<&Provenance> {
        self.provenance.as_deref()
    }

    /// Sets the provenance, which is written if the format has room for it; see [`Provenance`].
    pub fn set_provenance(&mut self, provenance: Option<Provenance>) {
        self.is_new_provenance = provenance.is_some();
        self.provenance = provenance.map(Arc::new);
    }

    /// Provenance to be written into a file that has another one so far.
    pub(crate) fn new_provenance(&self) -> Option<&Provenance> {
        self.provenance().filter(|_| self.is_new_provenance)
    }

    /// Provenance that is valid for the present shape; `None` if the shape was changed after reading.
    pub(crate) fn valid_provenance(&self) -> Option<&Provenance> {
        let is_changed = self.moved || !self.edited.is_empty();
        self.provenance().filter(|_| self.is_new_provenance || !is_changed)
    }

    /// The shape as it was read: its fields are those of the file, with remarks on its coordinates.
    pub(crate) fn with_original_fields(mut self) -> Self {
        self.n_original_fields = self.vertex_fields.len();
        self.notes.extend(note_on_reading(&self));
        if let Some(system) = self.coordinate_system.as_deref().filter(|system| system.is_geographic()) {
            let name = &system.name;
            self.notes.push(format!(
                "coordinates are longitudes and latitudes in degrees ({name}), and distances between them are no \
                 lengths; project the file to meters before"
            ));
        }
        self
    }

    /// Drops the original bytes: frees their memory, and writing creates a plain new file.
    pub fn forget_original(&mut self) {
        self.original = None;
        self.forget_original_of_whole();
    }
}

/// The public parts of a field may have been changed since its creation, so its rows are counted again.
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
            "expected 4 points, one per vertex; got 5"
        );
        let gaze = Field::new("gaze", 2, FieldValues::F32(vec![0.0; 6]));
        assert_eq!(
            file.add_vertex_field(gaze.clone()).unwrap_err().to_string(),
            "field `gaze` needs 4 rows, one for each of the vertices; got 3"
        );
        assert_eq!(
            file.add_face_field(gaze.clone()).unwrap_err().to_string(),
            "field `gaze` needs 0 rows, one for each of the faces; got 3"
        );
        let broken = Field { n_channels: 0, ..gaze };
        assert_eq!(
            file.add_vertex_field(broken).unwrap_err().to_string(),
            "field `gaze` needs complete rows of 0 channels, got 6 values"
        );
        assert!(file.vertex_fields().is_empty());
    }
}
