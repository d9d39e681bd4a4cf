//! Distribution of the faces of a mesh to tiles, after the sort.
//!
//! Each tile gets all faces that have a corner in it, in the order of the mesh, with the vertex indices of their
//! corners, so that its neighbors and areas are those of the whole mesh.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave::shape::Polygons;

use crate::error::TilesError;
use crate::files::NumberedName;
use crate::index::blocks::{Blocks, VERTICES_IN_A_BLOCK};
use crate::index::face_lists::encode_face;
use crate::index::scratch_buckets::ScratchBuckets;
use crate::layout::index_in_file;
use crate::sources::input_shape::InputShape;
use crate::sources::mesh::open_unchanged;

/// File of the corners that a pass has resolved.
pub(crate) const CORNERS_NAME: NumberedName =
    NumberedName { prefix: "corners-", n_digits: 4, suffix: ".bin" };

/// Number of vertices whose indices may be in memory, out of `memory` bytes.
pub(crate) fn vertices_per_pass(memory: u64) -> usize {
    (memory as usize / 2 / size_of::<u32>()).max(1 << 16)
}

/// Vertex index of a corner that no pass has resolved yet; after the last pass, of a corner that takes no part.
const UNRESOLVED: u32 = u32::MAX;

/// The distribution of a mesh's faces.
///
/// The corners of a face are indices in the file. A pass over all faces replaces those of `vertices_per_pass` vertices
/// by the vertex indices along the curve, so that only these have to be in memory; the number of passes has no effect
/// on the result.
pub(crate) struct FaceDistributor<'a> {
    pub(crate) shape: &'a InputShape,
    pub(crate) blocks: &'a Blocks,
    pub(crate) blocks_per_tile: usize,
    /// Bytes of memory that the job may use.
    pub(crate) memory: u64,
    /// Folder of the corners between two passes.
    pub(crate) folder: &'a Path,
    pub(crate) vertices_per_pass: usize,
    pub(crate) progress: Progress<'a>,
}

impl FaceDistributor<'_> {
    /// Writes the face files of all tiles. Returns their lengths in bytes.
    pub(crate) fn distribute_faces(&self, face_files: Vec<PathBuf>) -> Result<Vec<u64>, TilesError> {
        let n = self.shape.n_points as usize;
        let pass_range =
            |pass: usize| pass * self.vertices_per_pass..((pass + 1) * self.vertices_per_pass).min(n);
        let n_passes = n.div_ceil(self.vertices_per_pass);
        let mut resolved: Option<CornerFile> = None;
        for pass in 1..n_passes {
            let path = CORNERS_NAME.path(self.folder, pass as u64);
            let file = File::create(&path).map_err(TilesError::io(&path))?;
            let mut out = BufWriter::with_capacity(BUFFER_BYTES, file);
            self.visit_faces(pass_range(pass - 1), resolved.take(), |face| {
                face.iter()
                    .try_for_each(|corner| out.write_all(&corner.to_le_bytes()))
                    .map_err(TilesError::io(&path))
            })?;
            out.flush().map_err(TilesError::io(&path))?;
            resolved = Some(CornerFile::open(path)?);
        }
        let mut writer = FaceWriter {
            buckets: ScratchBuckets::create(face_files, self.memory as usize / 8)?,
            vertices_per_tile: self.blocks_per_tile * VERTICES_IN_A_BLOCK,
            tiles: Vec::new(),
            bytes: Vec::new(),
        };
        self.visit_faces(pass_range(n_passes - 1), resolved, |face| writer.push(face))?;
        writer.buckets.finish()
    }

    /// Calls `visit` with the corners of every face as vertex indices, as far as they are `resolved` already or belong
    /// to the vertices `range` of the file.
    fn visit_faces(
        &self,
        range: Range<usize>,
        mut resolved: Option<CornerFile>,
        mut visit: impl FnMut(&[u32]) -> Result<(), TilesError>,
    ) -> Result<(), TilesError> {
        let first = range.start;
        let indices = self.vertex_indices(range)?;
        let mut reader = open_unchanged(&self.shape.files[0])?;
        let mut corners = Vec::new();
        loop {
            self.progress.check()?;
            let mut faces = Polygons::new();
            if !reader.faces(self.shape.n_points, &mut faces)? {
                return Ok(());
            }
            for face in faces.iter() {
                corners.clear();
                for &corner in face {
                    let before = resolved.as_mut().map_or(Ok(UNRESOLVED), CornerFile::next)?;
                    let index = (corner as usize).checked_sub(first).and_then(|i| indices.get(i));
                    corners.push(index.copied().unwrap_or(before));
                }
                visit(&corners)?;
            }
        }
    }

    /// Vertex indices of the vertices `range` of the file.
    fn vertex_indices(&self, range: Range<usize>) -> Result<Vec<u32>, TilesError> {
        let mut indices = vec![UNRESOLVED; range.len()];
        for block in 0..self.blocks.len() {
            self.progress.check()?;
            let records = self.blocks.read_records(block)?;
            let first = self.blocks.vertices(block).start;
            for (vertex, record) in self.blocks.with_vertices(&records) {
                let Some(vertex) = vertex else { continue };
                let i = (index_in_file(record) as usize).checked_sub(range.start);
                if let Some(index) = i.and_then(|i| indices.get_mut(i)) {
                    *index = (first + vertex) as u32;
                }
            }
        }
        Ok(indices)
    }
}

/// Bytes of a file's buffer.
const BUFFER_BYTES: usize = 1 << 20;

/// The corners of all faces after a pass, in a file that is deleted on drop.
struct CornerFile {
    file: BufReader<File>,
    path: PathBuf,
}

impl CornerFile {
    fn open(path: PathBuf) -> Result<Self, TilesError> {
        let file = File::open(&path).map_err(TilesError::io(&path))?;
        Ok(Self { file: BufReader::with_capacity(BUFFER_BYTES, file), path })
    }

    fn next(&mut self) -> Result<u32, TilesError> {
        let mut bytes = [0; 4];
        self.file.read_exact(&mut bytes).map_err(TilesError::io(&self.path))?;
        Ok(u32::from_le_bytes(bytes))
    }
}

impl Drop for CornerFile {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Writes each face to the files of the tiles of its corners.
struct FaceWriter {
    buckets: ScratchBuckets,
    vertices_per_tile: usize,
    /// Tiles of the current face.
    tiles: Vec<usize>,
    /// Encoding of the current face.
    bytes: Vec<u8>,
}

impl FaceWriter {
    fn push(&mut self, corners: &[u32]) -> Result<(), TilesError> {
        // A face of fewer corners has no triangles, and one with a corner that takes no part is left out.
        if corners.len() < 3 || corners.contains(&UNRESOLVED) {
            return Ok(());
        }
        self.bytes.clear();
        encode_face(corners, &mut self.bytes);
        self.tiles.clear();
        self.tiles.extend(corners.iter().map(|&vertex| vertex as usize / self.vertices_per_tile));
        self.tiles.sort_unstable();
        self.tiles.dedup();
        self.tiles.iter().try_for_each(|&tile| self.buckets.push(tile, &self.bytes))
    }
}
