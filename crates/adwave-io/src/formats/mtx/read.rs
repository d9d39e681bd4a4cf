//! MatrixMarket coordinate matrices, read as weighted graphs.

use adwave::Progress;

use super::lines::MatrixLines;
use crate::limits::most_numbered;
use crate::text::stream::TextStream;
use crate::text::tokens::check_rows;
use crate::{Edges, Format, ReadError, ReadLimits, ShapeFile};

/// Reads a square matrix as a graph: vertex i is row i, entry (i, j) is an edge with its weight.
pub(crate) fn read_mtx(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut matrix = MatrixLines::new(TextStream::new(bytes, u64::MAX))?;
    let (n_rows, n_columns, n_entries) = (matrix.n_rows, matrix.n_columns, matrix.n_entries);
    if n_rows != n_columns {
        let message = format!("a graph needs a square matrix, got {n_rows} × {n_columns}");
        return Err(matrix.stream.wrong(message));
    }
    limits.check_points(n_rows)?;
    let limit = most_numbered(bytes.len());
    if n_rows > limit {
        return Err(ReadError::Limit { what: "rows for the size of the file", found: n_rows, limit });
    }
    let entry_bytes = if matrix.is_pattern { 4 } else { 6 };
    check_rows(bytes.len(), matrix.stream.n_bytes() as usize, n_entries, entry_bytes, "entry", 1)?;
    let mut edges = Edges { direction: matrix.direction, ..Edges::default() };
    while let Some(entry) = matrix.next_entry(progress)? {
        edges.pairs.push(entry.place);
        edges.weights.extend(entry.value);
    }
    let mut shape = ShapeFile::from_graph(n_rows as usize, edges);
    shape.format = Some(Format::MTX);
    Ok(shape)
}
