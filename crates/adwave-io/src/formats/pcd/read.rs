//! Reader of Point Cloud Library files: text, binary and compressed.

use crate::WriteError;
use crate::model::binary_rows::CoordinateRows;
use crate::model::context::WriteContext;
use crate::model::source_document::SourceDocument;
use crate::model::source_document::Update;
use adwave::Progress;
use std::sync::Arc;

use crate::model::field::ByteOrder;
use crate::model::grouping::group;
use crate::model::text_rows::{DecimalMark, Separator, TextRows};
use crate::progress::{collect, report_row};
use crate::text::{line_end, parse_f32, parse_f64, parse_u64, show, words};
use crate::{CoordinatePrecision, Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile, ValueType};

/// Content kept from a PCD for its update.
#[derive(Debug)]
pub(crate) struct PcdSource {
    /// Seven numbers: position and rotation of the sensor.
    pub(crate) viewpoint: String,
    pub(crate) width: u64,
    pub(crate) height: u64,
    /// Fields in the order of the file.
    pub(crate) layout: Vec<PcdField>,
    /// Rows of a text PCD.
    pub(crate) rows: Option<CoordinateRows>,
}

/// Field of a file, to write it again in its place.
#[derive(Clone, Debug)]
pub(crate) struct PcdField {
    pub(crate) name: String,
    /// Type as in the header: `F`, `I` or `U`.
    pub(crate) kind: char,
    pub(crate) value_type: ValueType,
    pub(crate) cells: Vec<PcdCell>,
}

/// Content of one number of a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum PcdCell {
    /// Coordinate 0, 1 or 2.
    Axis(usize),
    /// Color in one number.
    PackedColor,
    /// Channel of the field of that name.
    Channel(String, usize),
    /// Bytes without a meaning.
    Padding,
}

impl SourceDocument for PcdSource {
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        match &self.rows {
            Some(rows) => rows.update_coordinates(shape, context),
            None => Ok(Update::DoesNotFit),
        }
    }

    /// The view point; the points are one row and no longer an image.
    fn subset(&self, vertices: &[u32]) -> Option<Arc<dyn SourceDocument>> {
        let (viewpoint, width) = (self.viewpoint.clone(), vertices.len() as u64);
        let layout = self.layout.clone();
        Some(Arc::new(Self { viewpoint, width, height: 1, layout, rows: None }))
    }
}

/// Number within a row.
struct PcdColumn {
    name: String,
    value_type: ValueType,
    /// Offset in a binary row.
    offset: usize,
}

struct PcdHeader {
    columns: Vec<PcdColumn>,
    /// `(offset, bytes, count)` of each field in a row.
    fields: Vec<(usize, usize)>,
    /// Fields as they are written again; the cells are filled when the columns are grouped.
    layout: Vec<PcdField>,
    row_bytes: usize,
    n_points: u64,
    width: u64,
    height: u64,
    viewpoint: String,
    kind: Vec<u8>,
    body: usize,
}

/// Reads a PCD.
pub(crate) fn read_pcd(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let header = parse_header(&bytes)?;
    limits.check_points(header.n_points)?;
    let mut values: Vec<FieldValues> = header.columns.iter().map(|c| c.value_type.empty()).collect();
    let mut rows = None;
    match header.kind.as_slice() {
        b"ascii" => rows = Some(read_rows(&bytes, &header, &mut values, progress)?),
        b"binary" => {
            let plain = &bytes[header.body..];
            check_rows(&bytes, &header)?;
            let rows = plain.chunks_exact(header.row_bytes.max(1)).take(header.n_points as usize);
            for (i, row) in rows.enumerate() {
                report_row(progress, i as u64, header.n_points)?;
                for (column, list) in header.columns.iter().zip(&mut values) {
                    list.push_bytes(&row[column.offset..], ByteOrder::Little);
                }
            }
        }
        b"binary_compressed" => {
            let plain = unpack(&bytes, &header, progress)?;
            read_field_by_field(&plain, &header, &mut values, progress)?;
        }
        other => {
            let message = format!("DATA must be ascii, binary or binary_compressed, got {}", show(other));
            return Err(ReadError::line_error(&bytes, header.body.saturating_sub(1), message));
        }
    }
    let mut header = header;
    let mut shape = to_shape(&mut header, values, progress)?;
    shape.format = Some(match header.kind.as_slice() {
        b"ascii" => Format::PCD_ASCII,
        b"binary" => Format::PCD,
        _ => Format::PCD_COMPRESSED,
    });
    let axis = |name: &str| header.columns.iter().position(|c| c.name == name).unwrap_or(usize::MAX);
    let rows = rows.map(|rows| {
        let columns = [axis("x"), axis("y"), axis("z")];
        CoordinateRows::Text(TextRows {
            decimal: DecimalMark::Point,
            bytes,
            rows,
            columns,
            separator: Separator::Blanks,
            names: None,
        })
    });
    let PcdHeader { viewpoint, width, height, layout, .. } = header;
    let original = PcdSource { viewpoint, width, height, layout, rows };
    shape.set_source(original);
    Ok(shape)
}

fn parse_header(bytes: &[u8]) -> Result<PcdHeader, ReadError> {
    let mut position = 0;
    let mut lists: [Vec<String>; 4] = Default::default();
    let (mut width, mut height, mut points) = (None, None, None);
    let mut viewpoint = "0 0 0 1 0 0 0".to_string();
    let kind = loop {
        if position >= bytes.len() {
            return Err(ReadError::line_error(
                bytes,
                bytes.len(),
                "the header has no DATA line; get the whole file",
            ));
        }
        let start = position;
        let end = line_end(bytes, start);
        position = end + 1;
        let mut parts = words(&bytes[start..end]);
        let Some(keyword) = parts.next() else { continue };
        let mut count = || {
            let word = parts.next().unwrap_or(b"");
            let wrong = || {
                ReadError::line_error(
                    bytes,
                    start,
                    format!("the number of points must be an integer, got {}", show(word)),
                )
            };
            parse_u64(word).map(Some).ok_or_else(wrong)
        };
        match keyword.to_ascii_uppercase().as_slice() {
            b"WIDTH" => width = count()?,
            b"HEIGHT" => height = count()?,
            b"POINTS" => points = count()?,
            b"DATA" => break parts.next().unwrap_or(b"").to_ascii_lowercase(),
            b"VIEWPOINT" => {
                viewpoint = parts.map(|w| String::from_utf8_lossy(w)).collect::<Vec<_>>().join(" ");
            }
            keyword => {
                let names: [&[u8]; 5] = [b"FIELDS", b"SIZE", b"TYPE", b"COUNT", b"COLUMNS"];
                if let Some(which) = names.iter().position(|n| *n == keyword) {
                    lists[which % 4] = parts.map(|w| String::from_utf8_lossy(w).into_owned()).collect();
                }
            }
        }
    };
    let mut header = PcdHeader {
        columns: Vec::new(),
        fields: Vec::new(),
        layout: Vec::new(),
        row_bytes: 0,
        n_points: 0,
        width: 0,
        height: 1,
        viewpoint,
        kind,
        body: position.min(bytes.len()),
    };
    let size = width.map(|w: u64| w.saturating_mul(height.unwrap_or(1)));
    let Some(n_points) = points.or(size) else {
        return Err(ReadError::Whole(
            "the PCD header has neither POINTS nor WIDTH; add the number of points".into(),
        ));
    };
    header.n_points = n_points;
    (header.width, header.height) = match (width, height) {
        (Some(w), Some(h)) if w.checked_mul(h) == Some(n_points) => (w, h),
        _ => (n_points, 1),
    };
    // Some programs write everything in upper case.
    let has_lower = ["x", "y", "z"].iter().any(|axis| lists[0].iter().any(|name| name == axis));
    for name in lists[0].iter_mut().filter(|name| !has_lower && matches!(name.as_str(), "X" | "Y" | "Z")) {
        name.make_ascii_lowercase();
    }
    columns(&mut header, &lists)?;
    Ok(header)
}

fn columns(
    header: &mut PcdHeader,
    [names, sizes, types, counts]: &[Vec<String>; 4],
) -> Result<(), ReadError> {
    for (i, name) in names.iter().enumerate() {
        let (size, kind) =
            (sizes.get(i).map_or("4", String::as_str), types.get(i).map_or("F", String::as_str));
        let count: usize = counts.get(i).map_or(Ok(1), |c| c.parse()).unwrap_or(0);
        let value_type = match (kind.to_ascii_uppercase().as_str(), size) {
            ("U", "1") => ValueType::U8,
            ("U", "2") => ValueType::U16,
            ("U", "4") => ValueType::U32,
            ("U", "8") => ValueType::U64,
            ("I", "1") => ValueType::I8,
            ("I", "2") => ValueType::I16,
            ("I", "4") => ValueType::I32,
            ("I", "8") => ValueType::I64,
            ("F", "4") => ValueType::F32,
            ("F", "8") => ValueType::F64,
            _ => {
                let message = format!("PCD field {name:?} has the unknown type {kind:?} of {size:?} bytes");
                return Err(ReadError::Whole(message));
            }
        };
        if !(1..=4096).contains(&count) {
            return Err(ReadError::Whole(format!("the COUNT of PCD field {name:?} must be in 1..=4096")));
        }
        let n_bytes = value_type.n_bytes();
        header.fields.push((header.row_bytes, n_bytes * count));
        let kind = kind.chars().next().map_or('F', |c| c.to_ascii_uppercase());
        let cells = vec![PcdCell::Padding; count];
        header.layout.push(PcdField { name: name.clone(), kind, value_type, cells });
        for c in 0..count {
            let name = if count == 1 { name.clone() } else { format!("{name}_{c}") };
            header.columns.push(PcdColumn { name, value_type, offset: header.row_bytes + c * n_bytes });
        }
        header.row_bytes += n_bytes * count;
    }
    for axis in ["x", "y", "z"] {
        if !header.columns.iter().any(|c| c.name == axis) {
            return Err(ReadError::Whole(format!("the PCD needs the fields x, y and z, but has no {axis}")));
        }
    }
    Ok(())
}

fn check_rows(bytes: &[u8], header: &PcdHeader) -> Result<(), ReadError> {
    let remaining = (bytes.len() - header.body) as u64;
    let row = header.row_bytes.max(1) as u64;
    if remaining / row >= header.n_points {
        return Ok(());
    }
    Err(ReadError::Truncated {
        end: bytes.len() as u64,
        needed: (header.body as u64).saturating_add(header.n_points.saturating_mul(row)),
        element: "point".into(),
        row: remaining / row,
    })
}

fn read_rows(
    bytes: &[u8],
    header: &PcdHeader,
    values: &mut [FieldValues],
    progress: Progress<'_>,
) -> Result<Vec<u64>, ReadError> {
    let mut rows = Vec::new();
    let mut position = header.body;
    while position < bytes.len() && (rows.len() as u64) < header.n_points {
        let start = position;
        let end = line_end(bytes, start);
        position = end + 1;
        let line = &bytes[start..end];
        let mut parts = words(line);
        let Some(blanks) = line.iter().position(|&b| !crate::text::is_space(b)) else { continue };
        let row = rows.len();
        report_row(progress, row as u64, header.n_points)?;
        for (column, list) in header.columns.iter().zip(&mut *values) {
            let word = parts.next().ok_or_else(|| {
                let n = header.columns.len();
                ReadError::line_error(
                    bytes,
                    start,
                    format!("point {row} needs {n} values; add the missing ones"),
                )
            })?;
            let fits = match list {
                FieldValues::F32(v) => parse_f32(word).map(|x| v.push(x)).is_some(),
                other => parse_f64(word).is_some_and(|x| other.push_f64(x)),
            };
            if !fits {
                let name = &column.name;
                let message =
                    format!("{} does not fit field {name:?} of point {row}; correct it", show(word));
                return Err(ReadError::line_error(bytes, start, message));
            }
        }
        rows.push((start + blanks) as u64);
    }
    if (rows.len() as u64) < header.n_points {
        let message =
            format!("the file ends at point {} of {}; get the whole file", rows.len(), header.n_points);
        return Err(ReadError::line_error(bytes, bytes.len(), message));
    }
    Ok(rows)
}

fn unpack(bytes: &[u8], header: &PcdHeader, progress: Progress<'_>) -> Result<Vec<u8>, ReadError> {
    let size = |at: usize| {
        let b = bytes.get(at..at + 4)?;
        Some(u64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])))
    };
    let start = header.body + 8;
    let truncated = |needed: u64| ReadError::Truncated {
        end: bytes.len() as u64,
        needed,
        element: "point".into(),
        row: 0,
    };
    let (Some(n_packed), Some(n_plain)) = (size(header.body), size(header.body + 4)) else {
        return Err(truncated(start as u64));
    };
    if n_packed > (bytes.len() - start) as u64 {
        return Err(truncated(start as u64 + n_packed));
    }
    // Three bytes encode at most 264.
    if Some(n_plain) != header.n_points.checked_mul(header.row_bytes as u64) || n_plain > 88 * n_packed + 264
    {
        let n = header.n_points;
        let message = format!("{n} points do not fit {n_plain} uncompressed bytes; get an undamaged file");
        return Err(ReadError::byte_error(header.body + 4, message));
    }
    crate::formats::pcd::lzf::decompress(
        &bytes[start..start + n_packed as usize],
        n_plain as usize,
        progress,
    )?
    .map_err(|at| ReadError::byte_error(start + at, "the LZF compression is damaged; get an undamaged file"))
}

/// Reads compressed points, which are stored field by field: all of the first field, all of the second, …
fn read_field_by_field(
    plain: &[u8],
    header: &PcdHeader,
    values: &mut [FieldValues],
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let n = header.n_points as usize;
    for (column, list) in header.columns.iter().zip(values) {
        let field = header.fields.iter().rfind(|f| f.0 <= column.offset).copied().unwrap_or((0, 1));
        let first = n * field.0 + (column.offset - field.0);
        for i in 0..n {
            report_row(progress, i as u64, header.n_points)?;
            list.push_bytes(&plain[first + i * field.1..], ByteOrder::Little);
        }
    }
    Ok(())
}

fn to_shape(
    header: &mut PcdHeader,
    values: Vec<FieldValues>,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let n = header.n_points as usize;
    let mut xyz: [Option<FieldValues>; 3] = [const { None }; 3];
    let mut columns = Vec::new();
    let mut colors = None;
    let mut cells = vec![PcdCell::Padding; header.columns.len()];
    // Positions in the header of the columns that are grouped.
    let mut places = Vec::new();
    for (k, (column, list)) in header.columns.iter().zip(values).enumerate() {
        match column.name.as_str() {
            axis @ ("x" | "y" | "z") => {
                let axis = usize::from(axis.as_bytes()[0] - b'x');
                xyz[axis] = Some(list);
                cells[k] = PcdCell::Axis(axis);
            }
            // Only padding between fields.
            "_" => {}
            name @ ("rgb" | "rgba") if column.value_type.n_bytes() == 4 => {
                colors = Some(unpack_color(&list, if name == "rgb" { 3 } else { 4 }, progress)?);
                cells[k] = PcdCell::PackedColor;
            }
            name => {
                columns.push((name.to_string(), list));
                places.push(k);
            }
        }
    }
    let [Some(x), Some(y), Some(z)] = xyz else {
        return Err(ReadError::Whole("the PCD has no x, y and z".into()));
    };
    let mut shape = ShapeFile::from_cloud(collect(n, progress, |i| [x.get(i), y.get(i), z.get(i)])?);
    let single = [&x, &y, &z].iter().all(|c| c.value_type() == ValueType::F32);
    shape.precision = if single { CoordinatePrecision::F32 } else { CoordinatePrecision::F64 };
    let (fields, members) = group(columns, progress)?;
    for (name, positions) in members {
        for (channel, position) in positions.into_iter().enumerate() {
            cells[places[position]] = PcdCell::Channel(name.clone(), channel);
        }
    }
    let mut cells = cells.into_iter();
    for field in &mut header.layout {
        field.cells = cells.by_ref().take(field.cells.len()).collect();
    }
    shape.vertex_fields = fields;
    shape.vertex_fields.extend(colors);
    Ok(shape)
}

/// Unpacks a color, which is stored as the bits of a float or as an integer: blue in the lowest byte.
fn unpack_color(list: &FieldValues, n_channels: usize, progress: Progress<'_>) -> Result<Field, ReadError> {
    let bits = |i: usize| match list {
        FieldValues::F32(v) => v[i].to_bits(),
        other => other.get(i) as i64 as u32,
    };
    let mut colors = Vec::with_capacity(list.len() * n_channels);
    for i in 0..list.len() {
        report_row(progress, i as u64, list.len() as u64)?;
        let [blue, green, red, alpha] = bits(i).to_le_bytes();
        colors.extend_from_slice(&[red, green, blue, alpha][..n_channels]);
    }
    Ok(Field::new("color", n_channels, FieldValues::U8(colors)))
}
