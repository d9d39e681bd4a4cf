//! Rows of numbers, one row per point: XYZ, TXT, CSV, PTS, PWN. The separator, a preceding count or row of names, and
//! the meaning of columns without names are inferred from the rows.
//!
//! The parser is our own instead of a CSV library: values may be separated by any number of blanks, comments and
//! counts may stand between the rows, and the file must be written again byte for byte.

use adwave::{Cancelled, Progress};

use crate::formats::columns::cells::{RowStyle, cells, number, unquoted};
use crate::formats::columns::meaning::{TableValues, is_color_byte, name_columns};
use crate::formats::columns::{CSV, ColumnsSource};
use crate::model::grouping::group;
use crate::model::text_rows::{DecimalMark, Separator, TextRows};
use crate::progress::{BYTES_PER_STEP, all, collect};
use crate::text::{line_end, parse_f64, parse_u64, show};
use crate::{
    CoordinateSystem, CoordinateSystemKind, Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile,
};
use std::sync::Arc;

/// Numbers of a file before their meaning is known.
struct NumberTable {
    style: RowStyle,
    /// First word in each column of text, and the position of its row.
    words: Vec<Option<(String, usize)>>,
    names: Vec<String>,
    /// Position of the line of names.
    names_line: Option<(usize, usize)>,
    n_columns: usize,
    /// Values, row by row.
    values: Vec<f64>,
    rows: Vec<u64>,
    /// Sum of the counts before blocks of rows.
    count: Option<u64>,
}

/// Reads rows of numbers.
pub(crate) fn read_columns(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    name: Option<&str>,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut table = parse(&bytes, progress)?;
    limits.check_points(table.rows.len() as u64)?;
    let normals = check_count(&bytes, &mut table)?;
    let (n, k) = (table.rows.len(), table.n_columns);
    let words: Vec<Option<String>> =
        table.words.iter().map(|word| word.as_ref().map(|(text, _)| text.clone())).collect();
    let values = TableValues { values: &table.values, n_columns: k, n_rows: n, words: &words };
    let meanings = name_columns(&table.names, &values, progress)?;
    let (names, columns) = (meanings.names, meanings.axes);
    for c in columns {
        if let Some((word, start)) = table.words.get(c).and_then(Option::as_ref) {
            return Err(word_error(&bytes, *start, word));
        }
    }
    let points = collect(n, progress, |i| columns.map(|c| table.values[i * k + c]))?;
    let mut shape = ShapeFile::from_cloud(points);
    let is_color = |c: &usize| {
        matches!(
            names[*c].to_ascii_lowercase().as_str(),
            "red" | "green" | "blue" | "alpha" | "r" | "g" | "b" | "a"
        )
    };
    // All channels get the same type: bytes only if every channel has bytes.
    let mut has_bytes = true;
    for c in (0..k).filter(is_color) {
        has_bytes &= all(n, progress, |i| is_color_byte(table.values[i * k + c]))?;
    }
    let column = |c: usize| {
        let value = |i: usize| table.values[i * k + c];
        Ok(if is_color(&c) && has_bytes {
            FieldValues::U8(collect(n, progress, |i| value(i) as u8)?)
        } else {
            FieldValues::F64(collect(n, progress, value)?)
        })
    };
    let is_field = |c: &usize| !columns.contains(c) && words.get(*c).is_none_or(Option::is_none);
    let others = (0..k).filter(is_field).map(|c| Ok((names[c].clone(), column(c)?)));
    shape.vertex_fields = group(others.collect::<Result<_, Cancelled>>()?, progress)?.0;
    shape.vertex_fields.extend(normals);
    shape.notes.extend(meanings.note);
    if meanings.are_named_degrees && has_degrees(shape.points(), progress)? {
        shape.coordinate_system = Some(Arc::new(CoordinateSystem {
            name: "by the names of the columns".to_owned(),
            kind: CoordinateSystemKind::Geographic,
            unit: None,
        }));
    }
    if words.iter().any(Option::is_some) {
        shape.extras.push("columns of text".into());
    }
    let is_csv = name.is_some_and(|name| CSV.matches_name(std::path::Path::new(name)));
    shape.format = Some(if table.count.is_some() {
        Format::PTS
    } else if is_csv || table.style.separator == Separator::Byte(b',') {
        Format::CSV
    } else {
        Format::XYZ
    });
    shape.set_source(ColumnsSource(TextRows {
        rows: table.rows,
        columns,
        separator: table.style.separator,
        decimal: table.style.decimal,
        names: table.names_line,
        bytes,
    }));
    Ok(shape)
}

/// True if x is within ±360 and y within ±90, as longitudes and latitudes are. Rows without a position do not count.
fn has_degrees(points: &[[f64; 3]], progress: Progress<'_>) -> Result<bool, Cancelled> {
    all(points.len(), progress, |i| {
        let [x, y, _] = points[i].map(f64::abs);
        (x <= 360.0 && y <= 90.0) || is_placeholder(points[i])
    })
}

/// True for records without a position: not a number, or one of the numbers that programs write for "no data".
fn is_placeholder(point: [f64; 3]) -> bool {
    point.iter().any(|c| c.is_nan() || *c <= -9999.0)
}

/// Error for a word where a coordinate belongs.
fn word_error(bytes: &[u8], start: usize, word: &str) -> ReadError {
    let comma = if word.contains(',') {
        "; a decimal comma needs rows separated by semicolons, tabs or blanks"
    } else {
        "; correct it"
    };
    ReadError::line_error(bytes, start, format!("expected a number, got {word}{comma}"))
}

fn parse(bytes: &[u8], progress: Progress<'_>) -> Result<NumberTable, ReadError> {
    let mut table = NumberTable {
        style: RowStyle { separator: Separator::Blanks, decimal: DecimalMark::Point },
        words: Vec::new(),
        names: Vec::new(),
        names_line: None,
        n_columns: 0,
        values: Vec::new(),
        rows: Vec::new(),
        count: None,
    };
    let mut position = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut style = None;
    let mut asked = 0;
    while position < bytes.len() {
        if position >= asked {
            progress.step(position as u64, bytes.len() as u64)?;
            asked = position + BYTES_PER_STEP;
        }
        let end = line_end(bytes, position);
        let line = &bytes[position..end];
        let start = position + line.iter().take_while(|b| b.is_ascii_whitespace()).count();
        position = end + 1;
        let line = line.trim_ascii();
        let remark = line.strip_prefix(b"#").or_else(|| line.strip_prefix(b"//"));
        if line.is_empty() || remark.is_some() {
            // Some programs write the names of the columns as a comment.
            if let Some(remark) = remark.filter(|_| table.rows.is_empty()) {
                note_names(&mut table, remark, start, line.len());
            }
            continue;
        }
        // A count before the rows does not reveal the separator.
        if style.is_none() && parse_u64(line).is_none() {
            style = Some(RowStyle::from_line(line));
        }
        table.style = style.unwrap_or(table.style);
        // A row of names shows the separator, not the decimal mark.
        if table.rows.is_empty() {
            let own = RowStyle::from_line(line);
            if own.decimal == DecimalMark::Comma && table.style.separator != Separator::Byte(b',') {
                table.style = RowStyle { separator: table.style.separator, ..own };
                style = Some(table.style);
            }
        }
        row(bytes, &mut table, line, start)?;
    }
    if table.rows.is_empty() {
        table.n_columns = table.names.len();
    }
    if table.names.len() != table.n_columns {
        table.names.clear();
        table.names_line = None;
    }
    Ok(table)
}

/// Takes the words of a line as names of columns, unless they are numbers.
fn note_names(table: &mut NumberTable, line: &[u8], start: usize, length: usize) {
    let names: Vec<String> = cells(line, RowStyle::from_line(line).separator)
        .into_iter()
        .map(|cell| String::from_utf8_lossy(unquoted(cell)).trim().to_string())
        .collect();
    if names.len() >= 3 && names.iter().all(|n| parse_f64(n.as_bytes()).is_none()) {
        table.names = names;
        table.names_line = Some((start, start + length));
    }
}

fn row(bytes: &[u8], table: &mut NumberTable, line: &[u8], start: usize) -> Result<(), ReadError> {
    let first = table.values.len();
    let row_cells = cells(line, table.style.separator);
    let n = row_cells.len();
    let mut word = None;
    for (c, cell) in row_cells.iter().enumerate() {
        let value = number(cell, table.style.decimal);
        table.values.push(value.unwrap_or(f64::NAN));
        if value.is_none() {
            word.get_or_insert(c);
        }
    }
    if let Some(c) = word {
        let decimal = table.style.decimal;
        let is_word = |cell: &[u8]| number(cell, decimal).is_none();
        let n_words = row_cells.iter().filter(|cell| is_word(cell)).count();
        if table.rows.is_empty() && table.count.is_none() && table.names.is_empty() {
            note_names(table, line, start, line.len());
            if !table.names.is_empty() {
                table.values.truncate(first);
                return Ok(());
            }
        }
        // In rows that blanks separate, a backslash continues a line and `#` begins a remark.
        let is_risky = !matches!(table.style.separator, Separator::Byte(_))
            && row_cells.iter().any(|cell| is_word(cell) && cell.iter().any(|b| matches!(b, b'\\' | b'#')));
        if n - n_words < 3 || is_risky {
            return Err(word_error(bytes, start, &show(row_cells[c])));
        }
        table.words.resize(n.max(table.words.len()), None);
        for (c, cell) in row_cells.iter().enumerate().filter(|(_, cell)| is_word(cell)) {
            table.words[c].get_or_insert_with(|| (show(unquoted(cell)), start));
        }
    }
    if n == 1
        && let Some(count) = parse_u64(line)
    {
        // The number of points that follow.
        table.values.truncate(first);
        table.count = Some(table.count.unwrap_or(0).saturating_add(count));
        return Ok(());
    }
    if table.n_columns == 0 {
        if n < 3 {
            let message = format!("a row needs x, y and z, got {n} numbers; add the missing ones");
            return Err(ReadError::line_error(bytes, start, message));
        }
        table.n_columns = n;
    }
    if n != table.n_columns {
        let message = format!(
            "all rows must have the same number of values, got {n} after {}; make them \
                              equal",
            table.n_columns
        );
        return Err(ReadError::line_error(bytes, start, message));
    }
    table.rows.push(start as u64);
    Ok(())
}

/// Compares the rows with the count before them. Twice as many rows of three numbers are points followed by normals.
fn check_count(bytes: &[u8], table: &mut NumberTable) -> Result<Option<Field>, ReadError> {
    let Some(count) = table.count else { return Ok(None) };
    let n = table.rows.len() as u64;
    if n == count {
        return Ok(None);
    }
    if table.n_columns == 3 && Some(n) == count.checked_mul(2) {
        let normals = table.values.split_off(3 * count as usize);
        table.rows.truncate(count as usize);
        return Ok(Some(Field::new("normal", 3, FieldValues::F64(normals))));
    }
    let message = format!("the count is {count}, but there are {n} rows; correct the count");
    Err(ReadError::line_error(bytes, bytes.len(), message))
}
