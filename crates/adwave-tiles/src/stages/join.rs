//! Join: the results of all tiles in one file.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave_io::{LasReader, WriteError, atomic_write_with, rewrite_mesh};

use crate::bytes::u32_at;
use crate::error::TilesError;
use crate::files::NumberedName;
use crate::index::scratch_buckets::ScratchBuckets;
use crate::params::Params;
use crate::sources::cloud;
use crate::sources::input_shape::InputShape;
use crate::sources::mesh::{open_unchanged, result_row_bytes};

/// Scratch file with the result rows of consecutive vertices of a mesh.
pub(crate) const PART_NAME: NumberedName = NumberedName { prefix: "part-", n_digits: 4, suffix: ".bin" };

/// Records or rows that are read at a time.
const RECORDS_AT_A_TIME: usize = 1 << 19;
const ROWS_AT_A_TIME: usize = 1 << 15;

/// Writes the points of all tiles of a cloud to `path`, in the order of the curve.
pub(crate) fn join_cloud(
    shape: &InputShape,
    params: &Params,
    tiles: &[PathBuf],
    path: &Path,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    let mut writer = cloud::create_writer(shape, params, path)?;
    let mut records = Vec::new();
    let mut n = 0;
    for tile in tiles {
        let mut reader = LasReader::open(tile)?;
        loop {
            progress.step(n, shape.n_points)?;
            records.clear();
            let n_read = reader.read(RECORDS_AT_A_TIME, &mut records)?;
            if n_read == 0 {
                break;
            }
            n += n_read as u64;
            writer.write(&records)?;
        }
    }
    if n != shape.n_points {
        return Err(TilesError::Input(format!(
            "the tiles have {n} points instead of {}; delete the work folder and start again",
            shape.n_points
        )));
    }
    Ok(writer.finish()?)
}

/// The result rows of a mesh, and the memory to sort them with.
pub(crate) struct MeshJoin<'a> {
    pub(crate) shape: &'a InputShape,
    pub(crate) params: &'a Params,
    /// Files of all tiles.
    pub(crate) tiles: &'a [PathBuf],
    /// Folder for scratch files, which are used if the rows do not fit into memory.
    pub(crate) folder: &'a Path,
    /// Bytes of rows that may be in memory.
    pub(crate) memory: usize,
}

impl MeshJoin<'_> {
    /// Writes the mesh with its results to `path`, in its own order and format.
    pub(crate) fn write(&self, path: &Path, progress: Progress<'_>) -> Result<(), TilesError> {
        let file = &self.shape.files[0];
        drop(open_unchanged(file)?);
        let mut rows = self.sort_rows(progress)?;
        let mut failure = None;
        let (changes_positions, fields) = (self.params.changes_positions(), self.params.field_names());
        let mut vertex = 0;
        let mut edit = |points: &mut [[f64; 3]], values: &mut [Vec<f32>]| {
            for (i, point) in points.iter_mut().enumerate() {
                let mut row = &rows.row(vertex, progress)?[4..];
                if changes_positions {
                    let (coordinates, rest) = row.split_at(24);
                    for (c, bytes) in point.iter_mut().zip(coordinates.as_chunks::<8>().0) {
                        *c = f64::from_le_bytes(*bytes);
                    }
                    row = rest;
                }
                for (values, bytes) in values.iter_mut().zip(row.as_chunks::<4>().0) {
                    values[i] = f32::from_le_bytes(*bytes);
                }
                vertex += 1;
            }
            Ok::<(), TilesError>(())
        };
        let result = atomic_write_with(path, progress, |out| {
            let n = rewrite_mesh(&file.path, &fields, out, progress, &mut edit);
            let check = n.and_then(|n| if n == self.shape.n_points { Ok(()) } else { Err(file.changed()) });
            check.map_err(|error| {
                failure = Some(error);
                WriteError::from(std::io::Error::other("the mesh could not be written"))
            })
        });
        match failure {
            Some(error) => Err(error),
            None => Ok(result?),
        }
    }

    /// Distributes the rows to parts that fit into memory.
    fn sort_rows(&self, progress: Progress<'_>) -> Result<RowsInFileOrder, TilesError> {
        let row_bytes = result_row_bytes(self.params);
        let n = self.shape.n_points as usize;
        let vertices_per_part = (self.memory / row_bytes).clamp(1, n.max(1));
        let parts = if vertices_per_part >= n {
            vec![self.tiles.to_vec()]
        } else {
            let n_parts = n.div_ceil(vertices_per_part);
            let paths: Vec<PathBuf> =
                (0..n_parts).map(|part| PART_NAME.path(self.folder, part as u64)).collect();
            let mut buckets = ScratchBuckets::create(paths.clone(), self.memory / 4)?;
            let part = |row: &[u8]| (u32_at(row, 0) as usize / vertices_per_part).min(n_parts - 1);
            visit_rows(self.tiles, row_bytes, progress, |row| buckets.push(part(row), row))?;
            buckets.finish()?;
            paths.into_iter().map(|path| vec![path]).collect()
        };
        Ok(RowsInFileOrder {
            parts,
            vertices_per_part,
            n_vertices: n,
            row_bytes,
            next_part: 0,
            first: 0,
            rows: Vec::new(),
        })
    }
}

/// Result rows in the order of the file, one part in memory at a time.
struct RowsInFileOrder {
    /// Files that have the rows of each part, in any order.
    parts: Vec<Vec<PathBuf>>,
    vertices_per_part: usize,
    n_vertices: usize,
    row_bytes: usize,
    next_part: usize,
    /// First vertex of the part in memory.
    first: usize,
    rows: Vec<u8>,
}

impl RowsInFileOrder {
    /// The row of a vertex; vertices must be requested in ascending order.
    fn row(&mut self, vertex: usize, progress: Progress<'_>) -> Result<&[u8], TilesError> {
        while (vertex - self.first) * self.row_bytes >= self.rows.len() {
            self.load_next_part(progress)?;
        }
        Ok(&self.rows[(vertex - self.first) * self.row_bytes..][..self.row_bytes])
    }

    fn load_next_part(&mut self, progress: Progress<'_>) -> Result<(), TilesError> {
        let Some(files) = self.parts.get(self.next_part) else {
            return Err(TilesError::Input(
                "the mesh has more vertices than when the job was planned; delete the work folder and start again"
                    .into(),
            ));
        };
        let row_bytes = self.row_bytes;
        self.first = self.next_part * self.vertices_per_part;
        let n = self.vertices_per_part.min(self.n_vertices - self.first);
        self.rows.clear();
        self.rows.resize(n * row_bytes, 0);
        let (first, rows) = (self.first, &mut self.rows);
        let mut n_rows = 0;
        visit_rows(files, row_bytes, progress, |row| {
            let i = (u32_at(row, 0) as usize).checked_sub(first).filter(|&i| i < n);
            if let Some(i) = i {
                rows[i * row_bytes..][..row_bytes].copy_from_slice(row);
                n_rows += 1;
            }
            Ok(())
        })?;
        if n_rows != n {
            let path = files.first().map_or_else(PathBuf::new, Clone::clone);
            return Err(TilesError::broken(&path, format!("it has the results of {n_rows} of {n} vertices")));
        }
        self.next_part += 1;
        Ok(())
    }
}

fn visit_rows(
    files: &[PathBuf],
    row_bytes: usize,
    progress: Progress<'_>,
    mut visit: impl FnMut(&[u8]) -> Result<(), TilesError>,
) -> Result<(), TilesError> {
    let mut rows = Vec::with_capacity(ROWS_AT_A_TIME * row_bytes);
    for path in files {
        let mut file = File::open(path).map_err(TilesError::io(path))?;
        loop {
            progress.check()?;
            rows.clear();
            let part = (&mut file).take((ROWS_AT_A_TIME * row_bytes) as u64).read_to_end(&mut rows);
            if part.map_err(TilesError::io(path))? == 0 {
                break;
            }
            let complete = rows.chunks_exact(row_bytes);
            if !complete.remainder().is_empty() {
                return Err(TilesError::broken(path, "the file is too short"));
            }
            complete.into_iter().try_for_each(&mut visit)?;
        }
    }
    Ok(())
}
