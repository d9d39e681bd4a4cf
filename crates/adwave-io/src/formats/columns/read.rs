//! Rows of numbers, one a point: XYZ, TXT, CSV, PTS, PWN. What separates them, whether a count or names stand
//! before them, and what the columns without names mean is found from the rows.
//!
//! An own parser rather than a CSV library: rows here may be separated by any number of blanks and have remarks and
//! counts between them, and the file must be written again byte for byte.

use adwave::{Cancelled, Progress};

use crate::formats::columns::meaning::{is_color_byte, name_columns};
use crate::formats::columns::{CSV, ColumnsSource};
use crate::model::grouping::group;
use crate::model::text_rows::{Separator, TextRows};
use crate::progress::{BYTES_PER_STEP, all, collect};
use crate::text::{is_blank, line_end, parse_f64, parse_u64, show};
use crate::{Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};

/// Numbers of a file before their meaning is known.
struct Table {
    separator: Separator,
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
    let names = name_columns(&table.names, &table.values, k, n, progress)?;
    let position = |axis: &str| names.iter().position(|name| name == axis).unwrap_or(0);
    let columns = [position("x"), position("y"), position("z")];
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
    let others = (0..k).filter(|c| !columns.contains(c)).map(|c| Ok((names[c].clone(), column(c)?)));
    shape.vertex_fields = group(others.collect::<Result<_, Cancelled>>()?, progress)?.0;
    shape.vertex_fields.extend(normals);
    let is_csv = name.is_some_and(|name| CSV.matches_name(std::path::Path::new(name)));
    shape.format = Some(if table.count.is_some() {
        Format::PTS
    } else if is_csv || table.separator == Separator::Byte(b',') {
        Format::CSV
    } else {
        Format::XYZ
    });
    shape.set_source(ColumnsSource(TextRows {
        rows: table.rows,
        columns,
        separator: table.separator,
        names: table.names_line,
        bytes,
    }));
    Ok(shape)
}

/// Splits a row into its values.
fn cells(line: &[u8], separator: Separator) -> impl Iterator<Item = &[u8]> {
    line.split(move |&b| match separator {
        Separator::Blanks | Separator::BlanksUntilRemark => is_blank(b),
        Separator::Byte(s) => b == s,
        Separator::OverLines => crate::text::is_space(b),
    })
    .map(<[u8]>::trim_ascii)
    .filter(move |cell| separator != Separator::Blanks || !cell.is_empty())
}

fn parse(bytes: &[u8], progress: Progress<'_>) -> Result<Table, ReadError> {
    let mut table = Table {
        separator: Separator::Blanks,
        names: Vec::new(),
        names_line: None,
        n_columns: 0,
        values: Vec::new(),
        rows: Vec::new(),
        count: None,
    };
    let mut position = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut separator = None;
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
        if separator.is_none() && parse_u64(line).is_none() {
            separator = Some(find_separator(line));
        }
        table.separator = separator.unwrap_or(Separator::Blanks);
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

fn find_separator(line: &[u8]) -> Separator {
    let present = [b';', b','].into_iter().find(|b| line.contains(b));
    present.map_or(Separator::Blanks, Separator::Byte)
}

/// Takes the words of a line as names of columns, unless they are numbers.
fn note_names(table: &mut Table, line: &[u8], start: usize, length: usize) {
    let separator = find_separator(line);
    let names: Vec<String> = cells(line, separator)
        .map(|cell| String::from_utf8_lossy(cell).trim_matches(['"', '\'']).trim().to_string())
        .collect();
    if names.len() >= 3 && names.iter().all(|n| parse_f64(n.as_bytes()).is_none()) {
        table.names = names;
        table.names_line = Some((start, start + length));
    }
}

fn row(bytes: &[u8], table: &mut Table, line: &[u8], start: usize) -> Result<(), ReadError> {
    let first = table.values.len();
    let mut n = 0;
    let mut bad = None;
    for cell in cells(line, table.separator) {
        n += 1;
        match parse_f64(cell) {
            Some(x) => table.values.push(x),
            None if cell.is_empty() => table.values.push(f64::NAN),
            None => {
                bad = Some(cell);
                break;
            }
        }
    }
    if let Some(cell) = bad {
        table.values.truncate(first);
        if table.rows.is_empty() && table.count.is_none() && table.names.is_empty() {
            note_names(table, line, start, line.len());
            if !table.names.is_empty() {
                return Ok(());
            }
        }
        let message = format!("expected a number, got {}; correct it", show(cell));
        return Err(ReadError::in_line(bytes, start, message));
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
            return Err(ReadError::in_line(bytes, start, message));
        }
        table.n_columns = n;
    }
    if n != table.n_columns {
        let message = format!(
            "all rows must have the same number of values, got {n} after {}; make them \
                              equal",
            table.n_columns
        );
        return Err(ReadError::in_line(bytes, start, message));
    }
    table.rows.push(start as u64);
    Ok(())
}

/// Compares the rows with the count before them. Twice as many rows of three numbers are points followed by normals.
fn check_count(bytes: &[u8], table: &mut Table) -> Result<Option<Field>, ReadError> {
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
    Err(ReadError::in_line(bytes, bytes.len(), message))
}
