//! MatrixMarket matrices of any shape, read as a stream into sparse rows.

use std::io::BufRead;

use adwave::Progress;
use adwave::rows::CompressedRows;

use super::lines::MatrixLines;
use crate::limits::most_numbered;
use crate::text::stream::{LONGEST_LINE, TextStream};
use crate::{Direction, ReadError};

/// Reads a MatrixMarket coordinate matrix (real, integer or pattern; general or symmetric). Repeated entries are added.
/// Memory: 16 bytes per entry of the file and 12 per entry of the result.
///
/// # Errors
/// [`ReadError`] for anything else, for a matrix of which most rows or columns are empty, or if the call is cancelled.
///
/// ```
/// use adwave::Progress;
/// let text = "%%MatrixMarket matrix coordinate integer general\n2 3 2\n1 3 7\n2 1 5\n";
/// let matrix = adwave_io::read_matrix_market(text.as_bytes(), Progress::none())?;
/// assert_eq!((matrix.n_columns(), matrix.get(0, 2)), (3, 7.0));
/// # Ok::<(), adwave_io::ReadError>(())
/// ```
pub fn read_matrix_market(
    lines: impl BufRead,
    progress: Progress<'_>,
) -> Result<CompressedRows<f64>, ReadError> {
    let mut matrix = MatrixLines::new(TextStream::new(lines, LONGEST_LINE))?;
    let (n_rows, n_columns, n_entries) = (matrix.n_rows, matrix.n_columns, matrix.n_entries);
    let is_symmetric = matrix.direction == Direction::Both;
    if is_symmetric && n_rows != n_columns {
        return Err(matrix.stream.wrong("a symmetric matrix must be square"));
    }
    let mut entries: Vec<(u32, u32, f64)> = Vec::new();
    while let Some(entry) = matrix.next_entry(progress)? {
        let ([row, column], value) = (entry.place, entry.value.unwrap_or(1.0));
        entries.push((row, column, value));
        if is_symmetric && row != column {
            entries.push((column, row, value));
        }
    }
    if n_rows.max(n_columns) > most_numbered(entries.len()).min(u64::from(u32::MAX) - 1) {
        return Err(ReadError::Whole(format!(
            "the matrix has {n_rows} rows and {n_columns} columns for {n_entries} entries; leave out empty ones"
        )));
    }
    progress.check()?;
    entries.sort_by_key(|e| (e.0, e.1));
    progress.check()?;
    CompressedRows::from_sorted(n_rows as usize, n_columns as usize, entries)
        .map_err(|error| ReadError::Whole(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<CompressedRows<f64>, ReadError> {
        read_matrix_market(text.as_bytes(), Progress::none())
    }

    #[test]
    fn symmetric_matrices_have_both_halves_and_patterns_ones() {
        let found =
            read("%%MatrixMarket matrix coordinate pattern symmetric\n% no\n3 3 2\n2 1\n3 3\n").unwrap();
        assert_eq!(found.row(0), ([1].as_slice(), [1.0].as_slice()));
        assert_eq!(found.row(1), ([0].as_slice(), [1.0].as_slice()));
        assert_eq!(found.get(2, 2), 1.0);
        let repeated =
            read("%%MatrixMarket matrix coordinate real general\n1 2 2\n1 2 0.5\n1 2 2e0\n").unwrap();
        assert_eq!(repeated.get(0, 1), 2.5);
    }

    #[test]
    fn anything_else_is_refused_with_its_line() {
        let banner = "%%MatrixMarket matrix coordinate real general\n";
        for (text, line) in [
            (String::new(), 1),
            ("1 2\n".to_owned(), 1),
            (banner.replace("real", "complex"), 1),
            (format!("{banner}2 2\n"), 2),
            (format!("{banner}2 2 2\n1 1 1\n"), 4),
            (format!("{banner}2 2 1\n3 1 1\n"), 3),
            (format!("{banner}2 2 1\n0 1 1\n"), 3),
            (format!("{banner}2 2 1\n1 1 x\n"), 3),
            (format!("{banner}2 2 1\n1 1 1e400x\n"), 3),
            (format!("{}2 3 0\n", banner.replace("general", "symmetric")), 2),
        ] {
            let error = read(&text).unwrap_err().to_string();
            assert!(error.starts_with(&format!("line {line}: ")), "{error}");
        }
        for sizes in ["999999999999 2 0", "3 4000000000 0", "99999999 3 0"] {
            let error = read(&format!("{banner}{sizes}\n")).unwrap_err();
            assert!(error.to_string().contains("leave out empty ones"), "{error}");
        }
    }
}
