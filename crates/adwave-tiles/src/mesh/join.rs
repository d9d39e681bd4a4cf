//! The mesh again, with the results of all tiles.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave_io::{WriteError, atomic_write_with, rewrite_mesh};

use super::{open, result_bytes};
use crate::TilesError;
use crate::buckets::Buckets;
use crate::layout::u32_at;
use crate::plan::Plan;

/// The mesh with the results of `tiles` as `path`, in its own order and format. `memory` bytes of results are in memory at a time, by
/// way of files in `folder` where that is not all.
pub(crate) fn join(
    plan: &Plan,
    tiles: &[PathBuf],
    (folder, memory): (&Path, usize),
    path: &Path,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    drop(open(&plan.inputs[0])?);
    let row_bytes = result_bytes(&plan.params);
    let n = plan.n_points as usize;
    let most = (memory / row_bytes).clamp(1, n.max(1));
    let parts = if most >= n {
        vec![tiles.to_vec()]
    } else {
        let paths: Vec<PathBuf> =
            (0..n.div_ceil(most)).map(|part| folder.join(format!("part-{part:04}.bin"))).collect();
        let mut buckets = Buckets::new(paths.clone(), memory / 4)?;
        let part = |row: &[u8]| (u32_at(row, 0) as usize / most).min(paths.len() - 1);
        each_row(tiles, row_bytes, progress, |row| buckets.push(part(row), row))?;
        buckets.finish()?;
        paths.into_iter().map(|path| vec![path]).collect()
    };
    let mut results = Results { parts, most, n, row_bytes, first: 0, rows: Vec::new(), next_part: 0 };
    let mut failed = None;
    let (moves, fields) = (plan.params.moves(), plan.params.fields());
    let mut vertex = 0;
    let mut edit = |points: &mut [[f64; 3]], values: &mut [Vec<f32>]| {
        for (i, point) in points.iter_mut().enumerate() {
            set(results.row(vertex, progress)?, moves, point, values, i);
            vertex += 1;
        }
        Ok::<(), TilesError>(())
    };
    let written = atomic_write_with(path, progress, |out| {
        let n = rewrite_mesh(&plan.inputs[0].path, &fields, out, progress, &mut edit);
        let checked = n.and_then(|n| if n == plan.n_points { Ok(()) } else { Err(changed(plan)) });
        checked.map_err(|error| {
            failed = Some(error);
            WriteError::from(std::io::Error::other("it was not written"))
        })
    });
    match failed {
        Some(error) => Err(error),
        None => Ok(written?),
    }
}

fn changed(plan: &Plan) -> TilesError {
    TilesError::Input(format!(
        "{} has another number of vertices than when the work began; delete the folder and begin anew",
        plan.inputs[0].path.display()
    ))
}

/// What a row says of a vertex, which is the `i`-th of those whose coordinates and fields are asked for.
fn set(row: &[u8], moves: bool, point: &mut [f64; 3], values: &mut [Vec<f32>], i: usize) {
    let mut at = 4;
    if moves {
        let (coordinates, _) = row[at..].as_chunks::<8>();
        for (c, bytes) in point.iter_mut().zip(coordinates) {
            *c = f64::from_le_bytes(*bytes);
        }
        at += 24;
    }
    for (values, bytes) in values.iter_mut().zip(row[at..].as_chunks::<4>().0) {
        values[i] = f32::from_le_bytes(*bytes);
    }
}

/// The rows of all vertices, by the number of the vertex, those of a part of them in memory.
struct Results {
    /// The files in which the rows of each part are.
    parts: Vec<Vec<PathBuf>>,
    /// Vertices of a part, and of the mesh.
    most: usize,
    n: usize,
    row_bytes: usize,
    /// The first vertex whose row is in memory.
    first: usize,
    rows: Vec<u8>,
    next_part: usize,
}

impl Results {
    fn row(&mut self, vertex: usize, progress: Progress<'_>) -> Result<&[u8], TilesError> {
        while (vertex - self.first) * self.row_bytes >= self.rows.len() {
            self.next(progress)?;
        }
        Ok(&self.rows[(vertex - self.first) * self.row_bytes..][..self.row_bytes])
    }

    /// The next part.
    fn next(&mut self, progress: Progress<'_>) -> Result<(), TilesError> {
        let Some(files) = self.parts.get(self.next_part) else {
            return Err(TilesError::Input("the mesh has changed since the work began; begin anew".into()));
        };
        let row_bytes = self.row_bytes;
        self.first = self.next_part * self.most;
        let n = self.most.min(self.n - self.first);
        self.rows.clear();
        self.rows.resize(n * row_bytes, 0);
        let (first, rows) = (self.first, &mut self.rows);
        let mut seen = 0;
        each_row(files, row_bytes, progress, |row| {
            let i = (u32_at(row, 0) as usize).checked_sub(first).filter(|&i| i < n);
            if let Some(i) = i {
                rows[i * row_bytes..][..row_bytes].copy_from_slice(row);
                seen += 1;
            }
            Ok(())
        })?;
        if seen != n {
            let broken = files.first().map_or_else(PathBuf::new, Clone::clone);
            return Err(TilesError::broken(&broken, format!("it has results of {seen} vertices of {n}")));
        }
        self.next_part += 1;
        Ok(())
    }
}

/// Rows that are read at once.
const AT_A_TIME: usize = 1 << 15;

fn each_row(
    files: &[PathBuf],
    row_bytes: usize,
    progress: Progress<'_>,
    mut each: impl FnMut(&[u8]) -> Result<(), TilesError>,
) -> Result<(), TilesError> {
    let mut rows = Vec::with_capacity(AT_A_TIME * row_bytes);
    for path in files {
        let mut file = File::open(path).map_err(TilesError::io(path))?;
        loop {
            progress.check()?;
            rows.clear();
            let portion = (&mut file).take((AT_A_TIME * row_bytes) as u64).read_to_end(&mut rows);
            if portion.map_err(TilesError::io(path))? == 0 {
                break;
            }
            let whole = rows.chunks_exact(row_bytes);
            if !whole.remainder().is_empty() {
                return Err(TilesError::broken(path, "it is too short"));
            }
            whole.into_iter().try_for_each(&mut each)?;
        }
    }
    Ok(())
}
