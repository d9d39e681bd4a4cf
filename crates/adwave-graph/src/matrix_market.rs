//! Matrices in MatrixMarket form, of any shape, read as a stream.

use crate::GraphWalkError;
use crate::edge_list::most_numbered;
use crate::lines::Lines;
use adwave::Progress;
use adwave::rows::CompressedRows;
use std::io::BufRead;

/// Lines between two checks for cancellation.
const LINES_AT_A_TIME: u64 = 1 << 14;

/// A sparse matrix with its number of columns.
#[derive(Clone, Debug, PartialEq)]
pub struct SparseMatrix {
    /// The entries.
    pub rows: CompressedRows<f64>,
    /// Number of columns.
    pub n_columns: usize,
}

/// Reads a MatrixMarket coordinate matrix (real, integer or pattern; general or symmetric). Repeated entries are added.
/// Memory: 16 bytes per entry of the file and 12 per entry of the result.
///
/// # Errors
/// [`GraphWalkError::BadLine`] for anything else, or if the call is cancelled.
///
/// ```
/// use adwave::Progress;
/// let text = "%%MatrixMarket matrix coordinate integer general\n2 3 2\n1 3 7\n2 1 5\n";
/// let matrix = adwave_graph::read_matrix_market(text.as_bytes(), Progress::none())?;
/// assert_eq!((matrix.n_columns, matrix.rows.get(0, 2)), (3, 7.0));
/// # Ok::<(), adwave_graph::GraphWalkError>(())
/// ```
pub fn read_matrix_market(
    lines: impl BufRead,
    progress: Progress<'_>,
) -> Result<SparseMatrix, GraphWalkError> {
    let mut lines = MatrixLines(Lines::new(lines));
    let banner = lines.next()?.unwrap_or_default().to_ascii_lowercase();
    let words: Vec<&str> = banner.split_whitespace().collect();
    let ["%%matrixmarket", "matrix", "coordinate", value, symmetry] = words[..] else {
        return Err(lines.wrong("it must begin with `%%MatrixMarket matrix coordinate`"));
    };
    let (is_pattern, is_symmetric) = (value == "pattern", symmetry == "symmetric");
    if !["real", "integer", "pattern", "double"].contains(&value) || !(is_symmetric || symmetry == "general")
    {
        return Err(lines.wrong("matrices are real, integer or pattern, and general or symmetric"));
    }
    let Some(sizes) = lines.next_entry()? else { return Err(lines.wrong("the line of sizes is missing")) };
    let sizes: Vec<u64> = sizes.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let [n_rows, n_columns, n_entries] = sizes[..] else {
        return Err(lines.wrong("the line of sizes must be: rows columns entries"));
    };
    if is_symmetric && n_rows != n_columns {
        return Err(lines.wrong("a symmetric matrix must be square"));
    }
    let mut entries: Vec<(u32, u32, f64)> = Vec::new();
    for entry in 0..n_entries {
        if entry % LINES_AT_A_TIME == 0 {
            progress.step(entry, n_entries)?;
        }
        let Some(text) = lines.next_entry()? else {
            return Err(
                lines.wrong(&format!("the file ends at entry {entry} of {n_entries}; get the whole file"))
            );
        };
        let parsed =
            parse_entry(&text, is_pattern).filter(|e| u64::from(e.0) < n_rows && u64::from(e.1) < n_columns);
        let Some((row, column, value)) = parsed else {
            return Err(lines.wrong(
                "an entry is `row column value` with row and column counted from 1, inside the matrix",
            ));
        };
        entries.push((row, column, value));
        if is_symmetric && row != column {
            entries.push((column, row, value));
        }
    }
    if n_rows.max(n_columns) > most_numbered(entries.len()).min(u64::from(u32::MAX) - 1) {
        return Err(GraphWalkError::Empty { n_rows, n_columns, n_entries });
    }
    progress.check()?;
    entries.sort_by_key(|e| (e.0, e.1));
    progress.check()?;
    let (mut offsets, mut columns, mut values) = (vec![0_usize; n_rows as usize + 1], Vec::new(), Vec::new());
    let mut last = None;
    for (row, column, value) in entries {
        match values.last_mut() {
            Some(sum) if last == Some((row, column)) => *sum += value,
            _ => {
                columns.push(column);
                values.push(value);
                offsets[row as usize + 1] += 1;
            }
        }
        last = Some((row, column));
    }
    for x in 0..n_rows as usize {
        offsets[x + 1] += offsets[x];
    }
    let rows = CompressedRows::new(offsets, columns, values, n_columns as usize)?;
    Ok(SparseMatrix { rows, n_columns: n_columns as usize })
}

/// Row, column (from 0) and value of a line.
fn parse_entry(text: &str, is_pattern: bool) -> Option<(u32, u32, f64)> {
    let mut words = text.split_whitespace();
    let mut index = || words.next()?.parse::<u32>().ok()?.checked_sub(1);
    let (row, column) = (index()?, index()?);
    let value = if is_pattern { 1.0 } else { words.next()?.parse().ok()? };
    Some((row, column, value))
}

/// Lines of a file, with errors that name them.
struct MatrixLines<R>(Lines<R>);

impl<R: BufRead> MatrixLines<R> {
    fn next(&mut self) -> Result<Option<String>, GraphWalkError> {
        match self.0.next() {
            Ok(text) => Ok(text.map(|text| String::from_utf8_lossy(text).into_owned())),
            Err(problem) => Err(self.wrong(&problem)),
        }
    }

    /// The next line that is neither empty nor a comment.
    fn next_entry(&mut self) -> Result<Option<String>, GraphWalkError> {
        loop {
            match self.next()? {
                Some(text) if text.is_empty() || text.starts_with('%') => {}
                text => return Ok(text),
            }
        }
    }

    fn wrong(&self, problem: &str) -> GraphWalkError {
        GraphWalkError::BadMatrixLine { line: self.0.number, problem: problem.to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<SparseMatrix, GraphWalkError> {
        read_matrix_market(text.as_bytes(), Progress::none())
    }

    #[test]
    fn symmetric_matrices_have_both_halves_and_patterns_ones() {
        let found =
            read("%%MatrixMarket matrix coordinate pattern symmetric\n% no\n3 3 2\n2 1\n3 3\n").unwrap();
        assert_eq!(found.rows.row(0), ([1].as_slice(), [1.0].as_slice()));
        assert_eq!(found.rows.row(1), ([0].as_slice(), [1.0].as_slice()));
        assert_eq!(found.rows.get(2, 2), 1.0);
        let repeated =
            read("%%MatrixMarket matrix coordinate real general\n1 2 2\n1 2 0.5\n1 2 2e0\n").unwrap();
        assert_eq!(repeated.rows.get(0, 1), 2.5);
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
            assert!(error.starts_with(&format!("line {line} ")), "{error}");
        }
        for sizes in ["999999999999 2 0", "3 4000000000 0", "99999999 3 0"] {
            let error = read(&format!("{banner}{sizes}\n")).unwrap_err();
            assert!(matches!(error, GraphWalkError::Empty { .. }), "{error}");
        }
    }
}
