//! Bytes of a binary file with the positions of its coordinates, kept so that the file can be written again with new
//! coordinates.

use std::io::Write;
use std::ops::Range;

use adwave::Progress;

use crate::model::context::WriteContext;
use crate::model::field::ByteOrder;
use crate::model::source_document::Update;
use crate::model::text_rows::{RowEdit, TextRows};
use crate::progress::at_row;
use crate::{ShapeFile, WriteError};

/// Range of vertices whose coordinates are equally spaced in the file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// Byte offset of the first vertex's x.
    pub(crate) start: usize,
    /// Number of vertices.
    pub(crate) n: usize,
    /// Bytes from one vertex to the next.
    pub(crate) stride: usize,
}

/// Binary file in which x, y and z of each vertex are adjacent.
#[derive(Debug)]
pub(crate) struct BinaryRows {
    pub(crate) bytes: Vec<u8>,
    /// Vertex ranges in the order of the file.
    pub(crate) runs: Vec<Run>,
    /// True for 64-bit numbers, false for 32-bit numbers.
    pub(crate) is_double: bool,
    /// Number of coordinates per vertex: 3, or 2 in the plane.
    pub(crate) n_axes: usize,
    pub(crate) order: ByteOrder,
}

/// A text or a binary file with its coordinates in place.
#[derive(Debug)]
pub(crate) enum CoordinateRows {
    Text(TextRows),
    Binary(BinaryRows),
}

impl CoordinateRows {
    /// Updates a document of which nothing but coordinates can change.
    pub(crate) fn update_coordinates(
        &self,
        shape: &ShapeFile,
        context: &mut WriteContext<'_>,
    ) -> Result<Update, WriteError> {
        if !shape.edited.is_empty() {
            return Ok(Update::DoesNotFit);
        }
        self.write_all(shape, context)?;
        Ok(Update::Written)
    }

    /// Writes the whole original with the coordinates of the shape.
    pub(crate) fn write_all(
        &self,
        shape: &ShapeFile,
        context: &mut WriteContext<'_>,
    ) -> Result<(), WriteError> {
        match self {
            Self::Text(rows) => rows.write_all(shape, &RowEdit::default(), context.out, context.progress),
            Self::Binary(rows) => rows.write_range(0..rows.bytes.len(), shape, context.out, context.progress),
        }
    }
}

impl BinaryRows {
    /// Where the rows begin.
    pub(crate) fn first(&self) -> usize {
        self.runs.first().map_or(self.bytes.len(), |run| run.start)
    }

    /// Writes these bytes of the original, in which all rows lie, with the coordinates of the shape.
    pub(crate) fn write_range(
        &self,
        range: Range<usize>,
        shape: &ShapeFile,
        out: &mut dyn Write,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        const ROWS: usize = 4096;
        let (mut copied, mut vertex) = (range.start, 0);
        let mut buffer = Vec::new();
        for run in &self.runs {
            let mut row = 0;
            while row < run.n {
                at_row(progress, vertex as u64, shape.n_vertices as u64)?;
                let n = ROWS.min(run.n - row);
                let start = run.start + row * run.stride;
                let end = start + (n - 1) * run.stride + self.n_row_bytes();
                out.write_all(&self.bytes[copied..start])?;
                buffer.clear();
                buffer.extend_from_slice(&self.bytes[start..end]);
                for (slot, point) in buffer.chunks_mut(run.stride).zip(&shape.points[vertex..vertex + n]) {
                    self.put(&mut slot[..self.n_row_bytes()], *point);
                }
                out.write_all(&buffer)?;
                copied = end;
                row += n;
                vertex += n;
            }
        }
        Ok(out.write_all(&self.bytes[copied..range.end])?)
    }

    fn n_row_bytes(&self) -> usize {
        self.n_axes * if self.is_double { 8 } else { 4 }
    }

    fn put(&self, row: &mut [u8], point: [f64; 3]) {
        let is_little = self.order == ByteOrder::Little;
        for (slot, x) in row.chunks_exact_mut(if self.is_double { 8 } else { 4 }).zip(point) {
            // The bits of NaN coordinates stay unchanged.
            if x.is_nan() {
                continue;
            }
            match (self.is_double, is_little) {
                (true, true) => slot.copy_from_slice(&x.to_le_bytes()),
                (true, false) => slot.copy_from_slice(&x.to_be_bytes()),
                (false, true) => slot.copy_from_slice(&(x as f32).to_le_bytes()),
                (false, false) => slot.copy_from_slice(&(x as f32).to_be_bytes()),
            }
        }
    }
}
