//! MatrixMarket coordinate matrices.

use crate::model::sparse_rows::SparseRows;
use std::io::{self, Write};

use adwave::Progress;

use crate::progress::{Watched, at_row};
use crate::text::push_f64;
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
            format: Format::MTX,
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
