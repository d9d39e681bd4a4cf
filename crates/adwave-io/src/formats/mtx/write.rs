//! MatrixMarket coordinate matrices.

use std::io::{self, Write};

use adwave::Progress;

use crate::progress::{Watched, at_row};
use crate::text::{push_f32, push_f64};
use crate::{Direction, Format, ShapeFile, WriteError, WriteReport, atomic_write_with};

/// Writes the edges as a matrix, with their weights if they have some.
pub(crate) fn write_mtx(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let edges = &shape.edges;
    if edges.pairs.is_empty() && !shape.points.is_empty() {
        return Err(WriteError::CannotHold {
            format: Format::Mtx,
            what: "a shape without edges of its own".into(),
        });
    }
    for (is_there, what) in [(!shape.points.is_empty(), "coordinates"), (!shape.faces.is_empty(), "faces")] {
        if is_there {
            report.leave_out(what);
        }
    }
    report.leave_vertex_fields(shape, &[]);
    report.leave_face_fields(shape, &[]);
    let kind = if edges.weights.is_empty() { "pattern" } else { "real" };
    let symmetry = if edges.direction == Direction::Both { "symmetric" } else { "general" };
    let n = shape.n_vertices;
    writeln!(out, "%%MatrixMarket matrix coordinate {kind} {symmetry}\n{n} {n} {}", edges.pairs.len())?;
    for (e, &[a, b]) in edges.pairs.iter().enumerate() {
        at_row(progress, e as u64, edges.pairs.len() as u64)?;
        // A symmetric matrix is written as its lower triangle.
        let (row, column) = if edges.direction == Direction::Both { (a.max(b), a.min(b)) } else { (a, b) };
        write_entry(out, row, column, |line| {
            if let Some(&weight) = edges.weights.get(e) {
                line.push(b' ');
                push_f64(line, weight);
            }
        })?;
    }
    Ok(())
}

fn write_entry(
    out: &mut dyn Write,
    row: u32,
    column: u32,
    write_value: impl FnOnce(&mut Vec<u8>),
) -> io::Result<()> {
    let mut line = format!("{} {}", u64::from(row) + 1, u64::from(column) + 1).into_bytes();
    write_value(&mut line);
    line.push(b'\n');
    out.write_all(&line)
}

/// A sparse matrix to be written, borrowed as three lists: row `i` has the columns `indices[offsets[i]..offsets[i + 1]]`.
#[derive(Clone, Copy, Debug)]
pub struct SparseRows<'a> {
    /// Number of columns.
    pub n_columns: usize,
    /// Where each row begins, and the end of the last.
    pub offsets: &'a [usize],
    /// The column of each entry.
    pub indices: &'a [u32],
    /// The value of each entry.
    pub values: MatrixValues<'a>,
}

/// The values of a matrix, borrowed.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)] // the names are the types
pub enum MatrixValues<'a> {
    F32(&'a [f32]),
    F64(&'a [f64]),
}

impl MatrixValues<'_> {
    /// How many values there are.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes value `i` as text: the shortest decimal that reads back to the same value of its type.
    fn write_text(&self, i: usize, out: &mut Vec<u8>) {
        match self {
            Self::F32(v) => push_f32(out, v[i]),
            Self::F64(v) => push_f64(out, v[i]),
        }
    }
}

impl SparseRows<'_> {
    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// The lists may come from anyone: an error where they contradict each other.
    pub(crate) fn check(&self) -> Result<(), WriteError> {
        let n = self.values.len();
        let is_sound = self.indices.len() == n
            && self.offsets.is_sorted()
            && self.offsets.first().is_none_or(|&first| first == 0)
            && self.offsets.last().copied().unwrap_or(0) == n;
        if is_sound {
            return Ok(());
        }
        let shape = vec![self.n_rows(), self.n_columns];
        Err(WriteError::ArrayShape { name: "of sparse rows".into(), found: n as u64, shape })
    }
}

/// Writes a matrix as a MatrixMarket file, `coordinate real general`.
///
/// # Errors
/// As [`atomic_write`](crate::atomic_write).
pub fn write_matrix_market(path: &std::path::Path, matrix: &SparseRows<'_>) -> Result<(), WriteError> {
    write_matrix_market_with(path, matrix, Progress::none())
}

/// [`write_matrix_market`] with progress and cancellation.
///
/// # Errors
/// The errors of [`write_matrix_market`], and [`WriteError::Cancelled`].
pub fn write_matrix_market_with(
    path: &std::path::Path,
    matrix: &SparseRows<'_>,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    matrix.check()?;
    atomic_write_with(path, progress, |out| {
        let out = &mut Watched::new(out, progress);
        let (n_rows, n_columns, n) = (matrix.n_rows(), matrix.n_columns, matrix.values.len());
        writeln!(out, "%%MatrixMarket matrix coordinate real general\n{n_rows} {n_columns} {n}")?;
        for row in 0..n_rows {
            at_row(progress, row as u64, n_rows as u64)?;
            for entry in matrix.offsets[row]..matrix.offsets[row + 1] {
                write_entry(out, row as u32, matrix.indices[entry], |line| {
                    line.push(b' ');
                    matrix.values.write_text(entry, line);
                })?;
            }
        }
        Ok(())
    })
}
