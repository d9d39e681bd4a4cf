//! DMAT reader. The file has the numbers of columns and rows, then the values column by column; a binary file begins
//! with `0 0`.

use std::path::Path;

use adwave::Progress;

use crate::files::read::read_file;
use crate::limits::decompress;
use crate::model::field::{ByteOrder, Number};
use crate::progress::{collect, report_row};
use crate::text::line_end;
use crate::text::tokens::{Tokens, check_rows};
use crate::{Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};

/// Matrix, column by column.
struct DmatMatrix {
    n_columns: usize,
    n_rows: usize,
    values: Vec<f64>,
    is_binary: bool,
}

/// True if the bytes begin like a matrix of this format: two counts, then numbers on separate lines.
pub(crate) fn begins_as_dmat(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(256)];
    let mut lines = head.split(|&b| b == b'\n');
    let numbers = |line: Option<&[u8]>| {
        let words: Vec<&[u8]> = crate::text::words(line?).collect();
        words.iter().all(|w| crate::text::parse_f64(w).is_some()).then_some(words.len())
    };
    let first = lines.next();
    let are_counts = first.is_some_and(|l| crate::text::words(l).all(|w| w.iter().all(u8::is_ascii_digit)));
    if !are_counts || numbers(first) != Some(2) {
        return false;
    }
    if head.starts_with(b"0 0\n") || head.starts_with(b"0 0\r") {
        return numbers(lines.next()) == Some(2);
    }
    // The last line may be truncated.
    let is_empty = first.is_some_and(|l| crate::text::words(l).any(|w| w.iter().all(|&b| b == b'0')));
    !is_empty
        && numbers(lines.next()) == Some(1)
        && lines.next().is_none_or(|l| matches!(numbers(Some(l)), Some(0 | 1)))
}

fn parse(bytes: &[u8], progress: Progress<'_>) -> Result<DmatMatrix, ReadError> {
    let mut tokens = Tokens::new(bytes, if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 });
    let mut counts = [tokens.count("the size", 0)?, tokens.count("the size", 0)?];
    let is_binary = counts == [0, 0] && tokens.clone().next().is_some();
    if is_binary {
        counts = [tokens.count("the size", 0)?, tokens.count("the size", 0)?];
    }
    let [n_columns, n_rows] = counts;
    let n = n_columns.checked_mul(n_rows).filter(|&n| n <= bytes.len() as u64);
    let n = n.ok_or_else(|| ReadError::Truncated {
        end: bytes.len() as u64,
        needed: n_columns.saturating_mul(n_rows).saturating_mul(2),
        element: "matrix".into(),
        row: 0,
    })?;
    let values = if is_binary {
        let start = (line_end(bytes, tokens.position) + 1).min(bytes.len());
        check_rows(bytes.len(), start, n, 8, "matrix", 0)?;
        let rows = &bytes[start..];
        collect(n as usize, progress, |k| f64::from_bytes(&rows[8 * k..], ByteOrder::Little))?
    } else {
        tokens.check(n, 2, "matrix")?;
        let mut values = Vec::with_capacity(n as usize);
        for k in 0..n {
            report_row(progress, k, n)?;
            values.push(tokens.number("number", k)?);
        }
        values
    };
    Ok(DmatMatrix { n_columns: n_columns as usize, n_rows: n_rows as usize, values, is_binary })
}

/// Reads a matrix of three columns as points.
pub(crate) fn read_dmat(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let DmatMatrix { n_columns, n_rows, values, is_binary } = parse(bytes, progress)?;
    if n_columns != 3 {
        return Err(ReadError::Whole(format!(
            "points need a matrix of 3 columns, got {n_columns}; use the matrix as a field of a shape"
        )));
    }
    limits.check_points(n_rows as u64)?;
    let point = |i: usize| [values[i], values[n_rows + i], values[2 * n_rows + i]];
    let mut shape = ShapeFile::from_cloud(collect(n_rows, progress, point)?);
    shape.format = Some(if is_binary { Format::DMAT_BINARY } else { Format::DMAT });
    Ok(shape)
}

/// Reads the matrix in a file, compressed or not, as a field with a row per vertex and a channel per column.
///
/// # Errors
/// The file cannot be read, is not a DMAT, is malformed, or is empty. The message is one line with the file's name.
pub fn read_dmat_field(path: &Path, limits: &ReadLimits) -> Result<Field, ReadError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.split('.').next().unwrap_or("dmat").to_owned();
    read_file(path, limits, Progress::none())
        .and_then(|bytes| decompress(bytes, limits, Progress::none()))
        .and_then(|bytes| parse_dmat_field(&bytes, &name))
        .map_err(|e| e.in_file(path))
}

/// Reads the matrix in bytes as a field of that name.
///
/// # Errors
/// The errors of [`read_dmat_field`], without the file's name.
///
/// ```
/// let field = adwave_io::parse_dmat_field(b"2 3\n1\n2\n3\n10\n20\n30\n", "a").unwrap();
/// assert_eq!((field.n_channels, field.to_f64()), (2, vec![1.0, 10.0, 2.0, 20.0, 3.0, 30.0]));
/// ```
pub fn parse_dmat_field(bytes: &[u8], name: &str) -> Result<Field, ReadError> {
    let DmatMatrix { n_columns, n_rows, values, .. } = parse(bytes, Progress::none())?;
    if n_columns == 0 {
        return Err(ReadError::Whole("the matrix has no columns; it needs at least one".into()));
    }
    let value = |k: usize| values[(k % n_columns) * n_rows + k / n_columns];
    let values = FieldValues::F64((0..values.len()).map(value).collect());
    Ok(Field::new(name, n_columns, values))
}
