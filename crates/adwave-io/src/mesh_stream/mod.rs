//! Streaming of meshes that do not fit in memory: the vertices or the faces of a PLY or OBJ in the order of the file,
//! and rewriting of the file with new coordinates.
//!
//! The memory does not depend on the size of the file, nor on numbers in its header. Rows, errors and kept content
//! are the same as for files read at once; both use the same parsers.

mod obj;
mod ply;
mod rewrite;
#[cfg(test)]
mod tests;
mod window;

pub use rewrite::{VertexEdit, rewrite_mesh};

use std::path::{Path, PathBuf};

use adwave::shape::Polygons;

use crate::{ReadError, ValueType};
use obj::ObjStream;
use ply::PlyStream;
use window::FileWindow;

/// Reader of the vertices or the faces of a PLY or OBJ, in blocks in the order of the file.
///
/// ```
/// use adwave::shape::Polygons;
/// use adwave_io::MeshReader;
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("a.obj");
/// std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
/// let (mut points, mut faces) = (Vec::new(), Polygons::new());
/// let mut reader = MeshReader::open(&path).unwrap();
/// while reader.vertices(&mut points).unwrap() {}
/// assert_eq!((points.len(), reader.n_faces()), (3, 1));
/// let mut reader = MeshReader::open(&path).unwrap();
/// while reader.faces(3, &mut faces).unwrap() {}
/// assert_eq!(faces.get(0), [0, 1, 2]);
/// ```
pub struct MeshReader {
    path: PathBuf,
    source: StreamSource,
}

/// Property of the vertices of a PLY with one number each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexColumn {
    /// Index of the property.
    pub(in crate::mesh_stream) property: usize,
    pub(in crate::mesh_stream) value_type: ValueType,
}

impl VertexColumn {
    /// Returns true if the numbers are 32-bit floats.
    pub fn is_single_precision(&self) -> bool {
        self.value_type == ValueType::F32
    }
}

pub(in crate::mesh_stream) enum StreamSource {
    Ply(Box<PlyStream>),
    Obj(Box<ObjStream>),
}

impl MeshReader {
    /// Opens a file: a PLY is identified by its first bytes, an OBJ by its extension.
    ///
    /// # Errors
    /// The file cannot be read, is not a PLY or OBJ, or its header is damaged. The message is one line that begins
    /// with the file's name.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let source = StreamSource::open(path).map_err(|e| e.in_file(path))?;
        Ok(Self { path: path.to_path_buf(), source })
    }

    /// True if the file can store values at its vertices, as a PLY can.
    pub fn holds_fields(&self) -> bool {
        matches!(self.source, StreamSource::Ply(_))
    }

    /// Number of faces: for a PLY that of its header, where a strip counts as one; for an OBJ the number read so far.
    pub fn n_faces(&self) -> u64 {
        match &self.source {
            StreamSource::Ply(ply) => ply.n_faces(),
            StreamSource::Obj(obj) => obj.n_faces(),
        }
    }

    /// Appends the next vertices, about ten thousand, in model units; returns `false` at the end.
    ///
    /// # Errors
    /// The file is damaged or ends early; the message is one line with the file's name and the position.
    pub fn vertices(&mut self, points: &mut Vec<[f64; 3]>) -> Result<bool, ReadError> {
        let read = match &mut self.source {
            StreamSource::Ply(ply) => ply.vertices(points, &[], &mut Vec::new()),
            StreamSource::Obj(obj) => obj.vertices(points),
        };
        read.map_err(|e| e.in_file(&self.path))
    }

    /// Property of the vertices with one number each, of that name; `None` if there is none, as in every OBJ. The
    /// columns of a color, a normal or a texture coordinate are no fields of one number.
    pub fn column(&self, name: &str) -> Option<VertexColumn> {
        match &self.source {
            StreamSource::Ply(ply) => ply.column(name),
            StreamSource::Obj(_) => None,
        }
    }

    /// Returns true if the coordinates are 32-bit floats, as they may be in a PLY.
    pub fn has_single_precision(&self) -> bool {
        match &self.source {
            StreamSource::Ply(ply) => ply.has_single_precision(),
            StreamSource::Obj(_) => false,
        }
    }

    /// Names of the properties of the vertices with one number each.
    pub fn column_names(&self) -> Vec<String> {
        match &self.source {
            StreamSource::Ply(ply) => ply.column_names(),
            StreamSource::Obj(_) => Vec::new(),
        }
    }

    /// [`vertices`](Self::vertices), with the numbers of some properties: for each vertex one number for each of
    /// `columns` is appended to `values`.
    ///
    /// # Errors
    /// The errors of [`vertices`](Self::vertices).
    pub fn vertices_with(
        &mut self,
        points: &mut Vec<[f64; 3]>,
        columns: &[VertexColumn],
        values: &mut Vec<f64>,
    ) -> Result<bool, ReadError> {
        let read = match &mut self.source {
            StreamSource::Ply(ply) => ply.vertices(points, columns, values),
            StreamSource::Obj(obj) => obj.vertices(points),
        };
        read.map_err(|e| e.in_file(&self.path))
    }

    /// Appends the next faces, about ten thousand, of a mesh with `n_vertices` vertices; returns `false` at the end.
    /// Strips become triangles. One reader serves either vertices or faces.
    ///
    /// # Errors
    /// The errors of [`vertices`](Self::vertices), and a face that names a vertex that does not exist.
    pub fn faces(&mut self, n_vertices: u64, faces: &mut Polygons) -> Result<bool, ReadError> {
        let read = match &mut self.source {
            StreamSource::Ply(ply) => ply.faces(n_vertices, faces),
            StreamSource::Obj(obj) => obj.faces(n_vertices, faces),
        };
        read.map_err(|e| e.in_file(&self.path))
    }
}

impl StreamSource {
    fn open(path: &Path) -> Result<Self, ReadError> {
        let window = FileWindow::open(path)?;
        if window.rest().starts_with(b"ply") {
            return Ok(Self::Ply(Box::new(PlyStream::new(window)?)));
        }
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj")) {
            if memchr::memchr(b'\r', window.rest()).is_some()
                && memchr::memchr(b'\n', window.rest()).is_none()
            {
                return Err(ReadError::Whole(
                    "lines must not end with a carriage return alone; write the file again first (adwave \
                    convert IN -o OUT.obj)"
                        .into(),
                ));
            }
            return Ok(Self::Obj(Box::new(ObjStream::new(window))));
        }
        Err(ReadError::Whole("the file must be a PLY, which begins with `ply`, or an OBJ".into()))
    }
}
