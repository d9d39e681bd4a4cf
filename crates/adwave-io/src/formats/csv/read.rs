//! Values at vertices from a table: one row per vertex, one column per field.

use crate::files::read::parse_file;
use std::path::Path;

use adwave::Progress;

use crate::progress::report_row;
use crate::text::{parse_f64, show};
use crate::{Field, FieldValues, ReadError, ReadLimits};

/// Reads the columns of a table with cells separated by commas, semicolons or tabs. A first row that contains a word
/// names the columns; otherwise the names are `1`, `2` and so on. An empty cell, `NA` and `nan` are NaN. Columns with
/// words are left out. Numbers may have decimal commas unless these separate the cells.
///
/// # Errors
/// The file cannot be read, no column has numbers alone, or rows differ in length. The message is one line with the
/// file's name.
pub fn read_csv_fields(path: &Path, limits: &ReadLimits) -> Result<Vec<Field>, ReadError> {
    read_csv_fields_with(path, limits, Progress::none())
}

/// [`read_csv_fields`] with progress and cancellation.
///
/// # Errors
/// The errors of [`read_csv_fields`], and [`ReadError::Cancelled`].
pub fn read_csv_fields_with(
    path: &Path,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<Field>, ReadError> {
    parse_file(path, limits, progress, |bytes| fields(parse(&bytes, limits, progress)?))
}

/// Numbers of a table, row after row, with the names of its columns.
#[derive(Clone, Debug, PartialEq)]
pub struct CsvMatrix {
    /// Values, rows × columns.
    pub values: Vec<f64>,
    /// Names of the columns; empty if the table has no row of names.
    pub names: Vec<String>,
    /// Number of columns.
    pub n_columns: usize,
}

/// Reads all numbers of a table, as [`read_csv_fields`] reads its columns. A first column of words, or one without a name
/// beside named ones, has the names of the rows and is left out; a word in another column is an error, as is a first row of
/// a word and numbers, which may be names of columns or not.
///
/// # Errors
/// The file cannot be read, a cell is no number, or rows differ in length. The message is one line with the file's name.
pub fn read_csv_matrix(
    path: &Path,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<CsvMatrix, ReadError> {
    parse_file(path, limits, progress, |bytes| matrix(parse(&bytes, limits, progress)?))
}

fn matrix(mut table: TableColumns) -> Result<CsvMatrix, ReadError> {
    let is_unnamed = table.names.first().is_some_and(String::is_empty);
    if let Some((first, others)) = table.names.split_first()
        && !is_unnamed
        && !others.is_empty()
        && others.iter().all(|name| parse_f64(name.as_bytes()).is_some())
    {
        let message = format!(
            "{} beside numbers may name a row or the columns; leave it empty above numbers that name columns, or write a \
             row of names above it",
            show(first.as_bytes())
        );
        return Err(ReadError::Line { line: 1, message });
    }
    if table.values.len() > 1 && (is_unnamed || table.words[0].is_some()) {
        table.values.remove(0);
        table.words.remove(0);
        table.names.drain(..table.names.len().min(1));
    }
    if let Some((c, (line, word))) = table.words.iter().enumerate().find_map(|(c, w)| Some((c, w.as_ref()?)))
    {
        return Err(no_number(*line, table.names.get(c).map_or(&(c + 1).to_string(), |name| name), word));
    }
    let (n_columns, n_rows) = (table.values.len(), table.values[0].len());
    let values = (0..n_rows).flat_map(|row| table.values.iter().map(move |column| column[row])).collect();
    Ok(CsvMatrix { values, names: table.names, n_columns })
}

fn no_number(line: u64, column: &str, word: &str) -> ReadError {
    let message = format!("column {column} must have a number, got {word}; correct it");
    ReadError::Line { line, message }
}

/// [`read_csv_fields`] from bytes.
///
/// # Errors
/// The errors of [`read_csv_fields`], without the file's name.
///
/// ```
/// use adwave_io::{ReadLimits, parse_csv_fields};
/// let fields = parse_csv_fields(b"depth;gaze\n1;\n2;0.5\n", &ReadLimits::default()).unwrap();
/// assert_eq!((fields[0].name.as_str(), fields[0].to_f64()), ("depth", vec![1.0, 2.0]));
/// assert!(fields[1].get(0, 0).is_nan());
/// ```
pub fn parse_csv_fields(bytes: &[u8], limits: &ReadLimits) -> Result<Vec<Field>, ReadError> {
    fields(parse(bytes, limits, Progress::none())?)
}

/// Columns of a table.
struct TableColumns {
    /// Names; none if the first row has numbers alone.
    names: Vec<String>,
    values: Vec<Vec<f64>>,
    /// First word of each column, with its line.
    words: Vec<Option<(u64, String)>>,
}

fn parse(bytes: &[u8], limits: &ReadLimits, progress: Progress<'_>) -> Result<TableColumns, ReadError> {
    let first_line = &bytes[..crate::text::line_end(bytes, 0)];
    let delimiter = [b'\t', b';', b','].into_iter().find(|d| first_line.contains(d)).unwrap_or(b',');
    let body = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .from_reader(body);
    // The position after `\r\n` is that before `\n`, on the line before.
    let line_at = |at: &csv::Position| at.line() + u64::from(body.get(at.byte() as usize) == Some(&b'\n'));
    let mut names: Vec<String> = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut words: Vec<Option<(u64, String)>> = Vec::new();
    let mut record = csv::ByteRecord::new();
    for row in 0.. {
        report_row(progress, row, 0)?;
        match reader.read_byte_record(&mut record) {
            Ok(true) => {}
            Ok(false) => break,
            Err(error) => {
                let line = error.position().map_or(0, line_at);
                return Err(ReadError::Line { line, message: row_error(&error) });
            }
        }
        let line = record.position().map_or(0, line_at);
        let cells: Vec<Option<f64>> = record.iter().map(number).collect();
        if columns.is_empty() {
            columns = vec![Vec::new(); cells.len()];
            words = vec![None; cells.len()];
            if cells.contains(&None) {
                names = record.iter().map(|name| String::from_utf8_lossy(name).into_owned()).collect();
                continue;
            }
        }
        for (c, cell) in cells.into_iter().enumerate() {
            let value = cell.or_else(|| with_comma(record.get(c)?, delimiter));
            if value.is_none() && words[c].is_none() {
                words[c] = Some((line, show(record.get(c).unwrap_or_default())));
            }
            columns[c].push(value.unwrap_or(f64::NAN));
        }
        limits.check_points(columns[0].len() as u64)?;
    }
    if columns.first().is_none_or(Vec::is_empty) {
        return Err(ReadError::Whole("the table has no row of numbers; it needs one row per vertex".into()));
    }
    Ok(TableColumns { names, values: columns, words })
}

fn fields(table: TableColumns) -> Result<Vec<Field>, ReadError> {
    let TableColumns { names, values, words } = table;
    let name =
        |c: usize| names.get(c).filter(|n| !n.is_empty()).cloned().unwrap_or_else(|| (c + 1).to_string());
    if let Some((c, Some((line, word)))) =
        words.iter().enumerate().find(|_| words.iter().all(Option::is_some))
    {
        return Err(no_number(*line, &(c + 1).to_string(), word));
    }
    // Columns of text have no numbers.
    let of_numbers = values.into_iter().enumerate().filter(|(c, _)| words[*c].is_none());
    Ok(of_numbers.map(|(c, v)| Field::new(name(c), 1, FieldValues::F64(v))).collect())
}

/// Number with a decimal comma, in a table that is not separated by commas.
fn with_comma(cell: &[u8], delimiter: u8) -> Option<f64> {
    if delimiter == b',' || cell.contains(&b'.') {
        return None;
    }
    let with_point: Vec<u8> = cell.iter().map(|&b| if b == b',' { b'.' } else { b }).collect();
    parse_f64(&with_point)
}

pub(super) fn number(cell: &[u8]) -> Option<f64> {
    match cell {
        b"" | b"NA" | b"N/A" | b"null" => Some(f64::NAN),
        _ => parse_f64(cell),
    }
}

fn row_error(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!(
                "all rows must have the same number of cells, got {len} after {expected_len}; make \
                    them equal"
            )
        }
        _ => format!("the table cannot be read ({})", crate::text::one_line(error)),
    }
}
