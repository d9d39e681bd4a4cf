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
    parse_file(path, limits, progress, |bytes| parse(&bytes, limits, progress))
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
    parse(bytes, limits, Progress::none())
}

fn parse(bytes: &[u8], limits: &ReadLimits, progress: Progress<'_>) -> Result<Vec<Field>, ReadError> {
    let first_line = &bytes[..crate::text::line_end(bytes, 0)];
    let delimiter = [b'\t', b';', b','].into_iter().find(|d| first_line.contains(d)).unwrap_or(b',');
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .from_reader(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes));
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
                let line = error.position().map_or(0, csv::Position::line);
                return Err(ReadError::Line { line, message: row_error(&error) });
            }
        }
        let line = record.position().map_or(0, csv::Position::line);
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
    let name =
        |c: usize| names.get(c).filter(|n| !n.is_empty()).cloned().unwrap_or_else(|| (c + 1).to_string());
    if let Some((c, Some((line, word)))) =
        words.iter().enumerate().find(|_| words.iter().all(Option::is_some))
    {
        let message = format!("column {} must have a number, got {word}; correct it", c + 1);
        return Err(ReadError::Line { line: *line, message });
    }
    // Columns of text have no numbers.
    let of_numbers = columns.into_iter().enumerate().filter(|(c, _)| words[*c].is_none());
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
