//! MatrixMarket coordinate matrices, read as weighted graphs.

use adwave::Progress;

use crate::progress::at_row;
use crate::text::{line_end, line_of, parse_f64, parse_u64, show, words};
use crate::{Direction, Edges, Format, ReadError, ReadLimits, ShapeFile};

/// Type of an entry's value.
#[derive(PartialEq)]
enum Value {
    Pattern,
    Number,
}

/// Reads a square matrix as a graph: vertex i is row i, entry (i, j) is an edge with its weight.
pub(crate) fn read_mtx(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let (value, symmetry, mut position) = banner(bytes)?;
    let Some((start, size)) = next_line(bytes, &mut position) else {
        return Err(ReadError::in_line(
            bytes,
            bytes.len(),
            "the line of sizes is missing; get the whole file",
        ));
    };
    let sizes: Option<Vec<u64>> = words(size).map(parse_u64).collect();
    let Some([n_rows, n_columns, n_entries]) = sizes.as_deref().and_then(|s| <[u64; 3]>::try_from(s).ok())
    else {
        return Err(ReadError::in_line(bytes, start, "the line of sizes must be: rows columns entries"));
    };
    if n_rows != n_columns {
        let message = format!("a graph needs a square matrix, got {n_rows} × {n_columns}");
        return Err(ReadError::in_line(bytes, start, message));
    }
    limits.check_points(n_rows)?;
    // Vertices without edges take no bytes in the file, but memory in every later computation.
    let limit = 1_000_000 + 64 * bytes.len() as u64;
    if n_rows > limit {
        return Err(ReadError::Limit { what: "rows for the size of the file", found: n_rows, limit });
    }
    let entry_bytes = if value == Value::Pattern { 4 } else { 6 };
    let remaining = bytes.len().saturating_sub(position) as u64 + 1;
    if remaining / entry_bytes < n_entries {
        return Err(ReadError::Truncated {
            end: bytes.len() as u64,
            needed: (position as u64).saturating_add(n_entries.saturating_mul(entry_bytes)),
            element: "entry".into(),
            row: remaining / entry_bytes,
        });
    }
    let mut edges = Edges { direction: symmetry, ..Edges::default() };
    for entry in 0..n_entries {
        at_row(progress, entry, n_entries)?;
        let Some((start, line)) = next_line(bytes, &mut position) else {
            let message = format!("the file ends at entry {entry} of {n_entries}; get the whole file");
            return Err(ReadError::in_line(bytes, bytes.len(), message));
        };
        let wrong = |message: String| ReadError::Line { line: line_of(bytes, start), message };
        let mut values = words(line);
        let mut pair = [0; 2];
        for end in &mut pair {
            let word = values.next().unwrap_or(b"");
            let index = parse_u64(word).filter(|i| (1..=n_rows).contains(i));
            *end = index.ok_or_else(|| {
                wrong(format!("rows and columns must be in 1..={n_rows}, got {}; correct it", show(word)))
            })? as u32
                - 1;
        }
        edges.pairs.push(pair);
        if value == Value::Number {
            let word = values.next().unwrap_or(b"");
            edges.weights.push(parse_f64(word).ok_or_else(|| {
                wrong(format!("a weight must be a number, got {}; correct it", show(word)))
            })?);
        }
    }
    let mut shape = ShapeFile::from_graph(n_rows as usize, edges);
    shape.format = Some(Format::MTX);
    Ok(shape)
}

fn banner(bytes: &[u8]) -> Result<(Value, Direction, usize), ReadError> {
    let end = line_end(bytes, 0);
    let line = bytes[..end].to_ascii_lowercase();
    let parts: Vec<&[u8]> = words(&line).collect();
    let wrong = |message: String| Err(ReadError::Line { line: 1, message });
    let part = |i: usize| parts.get(i).copied().unwrap_or(b"");
    if part(1) != b"matrix" || part(2) != b"coordinate" {
        return wrong("a graph needs `matrix coordinate`; write the matrix in coordinate form".into());
    }
    let value = match part(3) {
        b"pattern" => Value::Pattern,
        b"real" | b"integer" | b"double" => Value::Number,
        other => {
            return wrong(format!("entries of kind {} cannot be weights; use real or pattern", show(other)));
        }
    };
    let direction = match part(4) {
        b"symmetric" => Direction::Both,
        b"general" => Direction::RowToColumn,
        other => {
            return wrong(format!("symmetry {} is not supported; use general or symmetric", show(other)));
        }
    };
    Ok((value, direction, end + 1))
}

/// Next line that is neither blank nor a comment.
fn next_line<'a>(bytes: &'a [u8], position: &mut usize) -> Option<(usize, &'a [u8])> {
    while *position < bytes.len() {
        let start = *position;
        let end = line_end(bytes, start);
        *position = end + 1;
        let line = bytes[start..end].trim_ascii();
        if !line.is_empty() && line[0] != b'%' {
            return Some((start, line));
        }
    }
    None
}
