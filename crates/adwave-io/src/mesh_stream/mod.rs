//! Meshes in portions: the vertices or the faces of a PLY or OBJ in the order of the file, for those that do not fit in memory, and
//! the same file written again with other coordinates.
//!
//! What is in memory at a time does not depend on the size of the file, nor on what a header says about it. A row, an error and
//! what is kept of the file are those of the readers that read a file whole; both use the same parsers.

mod obj;
mod ply;
mod rewrite;
#[cfg(test)]
mod tests;
mod window;

pub use rewrite::{VertexEdit, rewrite_mesh};

use std::path::{Path, PathBuf};

use adwave::shape::Polygons;

use crate::ReadError;
use obj::ObjStream;
use ply::PlyStream;
use window::Window;

/// The vertices or the faces of a PLY or OBJ, read in portions in the order of the file.
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
    source: Source,
}

pub(in crate::mesh_stream) enum Source {
    Ply(Box<PlyStream>),
    Obj(Box<ObjStream>),
}

impl MeshReader {
    /// Opens a file: a PLY by its first bytes, an OBJ by its ending.
    ///
    /// # Errors
    /// One line that begins with the file's name: it cannot be read, is no PLY or OBJ, or its header is broken.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let source = Source::open(path).map_err(|e| e.in_file(path))?;
        Ok(Self { path: path.to_path_buf(), source })
    }

    /// Whether the file can hold values at its vertices: a PLY can.
    pub fn holds_fields(&self) -> bool {
        matches!(self.source, Source::Ply(_))
    }

    /// How many faces there are: of a PLY those that its header promises, a strip being one, of an OBJ those that went by so far.
    pub fn n_faces(&self) -> u64 {
        match &self.source {
            Source::Ply(ply) => ply.n_faces(),
            Source::Obj(obj) => obj.n_faces(),
        }
    }

    /// Appends the next vertices, some ten thousand, in model units; `false` when there were none left.
    ///
    /// # Errors
    /// One line that begins with the file's name and says where it is broken or ends early.
    pub fn vertices(&mut self, points: &mut Vec<[f64; 3]>) -> Result<bool, ReadError> {
        let read = match &mut self.source {
            Source::Ply(ply) => ply.vertices(points),
            Source::Obj(obj) => obj.vertices(points),
        };
        read.map_err(|e| e.in_file(&self.path))
    }

    /// Appends the next faces, some ten thousand, of a mesh of `n_vertices` vertices; `false` when there were none left. Strips
    /// come as triangles. Of one reader either vertices are asked for or faces.
    ///
    /// # Errors
    /// As [`vertices`](Self::vertices), and where a face names a vertex that is not there.
    pub fn faces(&mut self, n_vertices: u64, faces: &mut Polygons) -> Result<bool, ReadError> {
        let read = match &mut self.source {
            Source::Ply(ply) => ply.faces(n_vertices, faces),
            Source::Obj(obj) => obj.faces(n_vertices, faces),
        };
        read.map_err(|e| e.in_file(&self.path))
    }
}

impl Source {
    fn open(path: &Path) -> Result<Self, ReadError> {
        let window = Window::open(path)?;
        if window.rest().starts_with(b"ply") {
            return Ok(Self::Ply(Box::new(PlyStream::new(window)?)));
        }
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj")) {
            if memchr::memchr(b'\r', window.rest()).is_some()
                && memchr::memchr(b'\n', window.rest()).is_none()
            {
                return Err(ReadError::Whole(
                    "has lines that end with a carriage return alone; write it again first (adwave convert IN -o OUT.obj)"
                        .into(),
                ));
            }
            return Ok(Self::Obj(Box::new(ObjStream::new(window))));
        }
        Err(ReadError::Whole("is no PLY or OBJ: it does not begin with `ply`; give one".into()))
    }
}
