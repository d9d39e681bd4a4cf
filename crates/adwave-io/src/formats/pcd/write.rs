//! Writer of Point Cloud Library files, binary or text.

use crate::formats::pcd::read::{PcdCell, PcdField, PcdSource};
use std::io::Write;

use adwave::Progress;

use crate::model::field::ByteOrder;
use crate::model::grouping::one_word;
use crate::progress::report_row;
use crate::text::{push_f32, push_f64};
use crate::{CoordinatePrecision, Field, FieldValues, Format, ShapeFile, ValueType, WriteError, WriteReport};

/// True for a color of bytes, which is packed into one number for the library.
fn is_packed(field: &Field) -> bool {
    field.name == "color" && matches!(field.n_channels, 3 | 4) && matches!(field.values, FieldValues::U8(_))
}

fn pack_color(field: &Field, i: usize) -> u32 {
    let byte = |c: usize| if c < field.n_channels { field.get(i, c) as u8 } else { 0 };
    u32::from_le_bytes([byte(2), byte(1), byte(0), byte(3)])
}

/// Numbers beside each other in a row that have one name.
struct Column {
    name: String,
    kind: char,
    value_type: ValueType,
    cells: Vec<WrittenCell>,
}

/// Content of one number of a row.
#[derive(Clone, Copy)]
enum WrittenCell {
    Axis(usize),
    /// Color in one number: the place of the field.
    Packed(usize),
    /// Place of the field, and the channel.
    Channel(usize, usize),
    Padding,
}

fn kind_letter(value_type: ValueType) -> char {
    match value_type {
        ValueType::F32 | ValueType::F64 => 'F',
        ValueType::I8 | ValueType::I16 | ValueType::I32 | ValueType::I64 => 'I',
        _ => 'U',
    }
}

/// Columns of a field that the original file does not have.
fn new_columns(place: usize, field: &Field) -> Vec<Column> {
    let value_type = field.values.value_type();
    let kind = kind_letter(value_type);
    let three = |names: [&str; 3]| {
        let column = |(c, name): (usize, &str)| Column {
            name: name.to_owned(),
            kind,
            value_type,
            cells: vec![WrittenCell::Channel(place, c)],
        };
        names.into_iter().enumerate().map(column).collect()
    };
    match (field.name.as_str(), field.n_channels) {
        _ if is_packed(field) => {
            let name = if field.n_channels == 3 { "rgb" } else { "rgba" };
            // An integer in both forms: as a float some bit patterns would be NaN, which text cannot represent.
            let cells = vec![WrittenCell::Packed(place)];
            vec![Column { name: name.into(), kind: 'U', value_type: ValueType::U32, cells }]
        }
        ("normal", 3) => three(["normal_x", "normal_y", "normal_z"]),
        ("color", 3) => three(["red", "green", "blue"]),
        (name, n) => {
            let cells = (0..n).map(|c| WrittenCell::Channel(place, c)).collect();
            vec![Column { name: one_word(name), kind, value_type, cells }]
        }
    }
}

/// Column of the original file, if the shape still has its fields with the types that they had.
fn kept_column(shape: &ShapeFile, old: &PcdField, coordinate: ValueType, is_text: bool) -> Option<Column> {
    let mut value_type = old.value_type;
    let mut kind = old.kind;
    let mut name = old.name.as_str();
    let mut cells = Vec::with_capacity(old.cells.len());
    for cell in &old.cells {
        cells.push(match cell {
            PcdCell::Axis(axis) => {
                (value_type, kind) = (coordinate, 'F');
                WrittenCell::Axis(*axis)
            }
            PcdCell::PackedColor => {
                let place = shape.vertex_fields.iter().position(is_packed)?;
                let n_channels = shape.vertex_fields[place].n_channels;
                // As a float a color with its fourth byte may be NaN, which text cannot represent.
                if is_text && n_channels == 4 {
                    (value_type, kind) = (ValueType::U32, 'U');
                }
                // The name says whether there is a fourth byte.
                name = match (name, n_channels) {
                    ("rgba", 3) => "rgb",
                    ("rgb", 4) => "rgba",
                    (same, _) => same,
                };
                WrittenCell::Packed(place)
            }
            PcdCell::Channel(name, channel) => {
                let is_same = |field: &Field| {
                    field.name == *name
                        && *channel < field.n_channels
                        && field.values.value_type() == old.value_type
                };
                WrittenCell::Channel(shape.vertex_fields.iter().position(is_same)?, *channel)
            }
            PcdCell::Padding => WrittenCell::Padding,
        });
    }
    Some(Column { name: name.to_owned(), kind, value_type, cells })
}

/// Columns of the file: those of the original in their order, then those of new fields.
fn columns(shape: &ShapeFile, is_text: bool) -> Vec<Column> {
    let coordinate =
        if shape.precision == CoordinatePrecision::F32 { ValueType::F32 } else { ValueType::F64 };
    let layout = shape.source::<PcdSource>().map(|source| source.layout.as_slice()).unwrap_or_default();
    let mut all: Vec<Column> =
        layout.iter().filter_map(|old| kept_column(shape, old, coordinate, is_text)).collect();
    if all.is_empty() {
        all.extend(["x", "y", "z"].into_iter().enumerate().map(|(axis, name)| Column {
            name: name.to_owned(),
            kind: 'F',
            value_type: coordinate,
            cells: vec![WrittenCell::Axis(axis)],
        }));
    }
    for (place, field) in shape.vertex_fields.iter().enumerate() {
        let is_written = |cell: &WrittenCell| match *cell {
            WrittenCell::Packed(at) => at == place,
            WrittenCell::Channel(at, channel) => at == place && channel + 1 == field.n_channels,
            WrittenCell::Axis(_) | WrittenCell::Padding => false,
        };
        if !all.iter().flat_map(|column| &column.cells).any(is_written) {
            all.extend(new_columns(place, field));
        }
    }
    all
}

/// Writes points and all vertex fields, with the sensor pose and the image size of the original PCD.
pub(crate) fn write_pcd(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    if !shape.faces.is_empty() {
        report.report_dropped("faces");
    }
    report.report_face_fields(shape, &[]);
    if !shape.edges.pairs.is_empty() {
        report.report_dropped("edges");
    }
    let all = columns(shape, format == Format::PCD_ASCII);
    let list =
        |part: &dyn Fn(&Column) -> String| all.iter().map(|c| format!(" {}", part(c))).collect::<String>();
    let n = shape.points.len() as u64;
    let (viewpoint, width, height) = match shape.source::<PcdSource>() {
        Some(pcd) => (pcd.viewpoint.as_str(), pcd.width, pcd.height),
        _ => ("0 0 0 1 0 0 0", n, 1),
    };
    let encoding = match format {
        Format::PCD => "binary",
        Format::PCD_COMPRESSED => "binary_compressed",
        _ => "ascii",
    };
    writeln!(out, "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7")?;
    writeln!(
        out,
        "FIELDS{}\nSIZE{}",
        list(&|c| c.name.clone()),
        list(&|c| c.value_type.n_bytes().to_string())
    )?;
    writeln!(out, "TYPE{}\nCOUNT{}", list(&|c| c.kind.into()), list(&|c| c.cells.len().to_string()))?;
    writeln!(out, "WIDTH {width}\nHEIGHT {height}\nVIEWPOINT {viewpoint}\nPOINTS {n}\nDATA {encoding}")?;
    if format == Format::PCD_COMPRESSED {
        return write_compressed(shape, &all, out, progress);
    }
    let mut row = Vec::new();
    for i in 0..shape.points.len() {
        report_row(progress, i as u64, n)?;
        row.clear();
        if format == Format::PCD {
            binary_row(shape, &all, i, &mut row);
        } else {
            text_row(shape, &all, i, &mut row);
        }
        out.write_all(&row)?;
    }
    Ok(())
}

/// Writes compressed points field by field: all of the first field, all of the second, …
fn write_compressed(
    shape: &ShapeFile,
    columns: &[Column],
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let (n, mut rows) = (shape.points.len(), Vec::new());
    for i in 0..n {
        report_row(progress, i as u64, n as u64)?;
        binary_row(shape, columns, i, &mut rows);
    }
    let stride: usize = columns.iter().map(Column::n_bytes).sum();
    let mut plain = Vec::with_capacity(rows.len());
    let mut start = 0;
    for column in columns {
        let size = column.n_bytes();
        for i in 0..n {
            report_row(progress, i as u64, n as u64)?;
            plain.extend_from_slice(&rows[i * stride + start..][..size]);
        }
        start += size;
    }
    drop(rows);
    let packed = super::lzf::compress(&plain, progress)?;
    let sizes = [packed.len(), plain.len()].map(u32::try_from);
    let [Ok(n_packed), Ok(n_plain)] = sizes else {
        let what = "4 GiB of points".into();
        return Err(WriteError::CannotHold { format: Format::PCD_COMPRESSED, what });
    };
    out.write_all(&[n_packed.to_le_bytes(), n_plain.to_le_bytes()].concat())?;
    Ok(out.write_all(&packed)?)
}

impl Column {
    /// Bytes in a row.
    fn n_bytes(&self) -> usize {
        self.value_type.n_bytes() * self.cells.len()
    }
}

fn binary_row(shape: &ShapeFile, columns: &[Column], i: usize, row: &mut Vec<u8>) {
    for column in columns {
        for cell in &column.cells {
            match *cell {
                WrittenCell::Axis(axis) => match shape.precision {
                    CoordinatePrecision::F32 => {
                        row.extend_from_slice(&(shape.points[i][axis] as f32).to_le_bytes());
                    }
                    CoordinatePrecision::F64 => row.extend_from_slice(&shape.points[i][axis].to_le_bytes()),
                },
                WrittenCell::Packed(place) => {
                    row.extend_from_slice(&pack_color(&shape.vertex_fields[place], i).to_le_bytes());
                }
                WrittenCell::Channel(place, channel) => {
                    let field = &shape.vertex_fields[place];
                    field.values.write_bytes(i * field.n_channels + channel, ByteOrder::Little, row);
                }
                WrittenCell::Padding => row.resize(row.len() + column.value_type.n_bytes(), 0),
            }
        }
    }
}

fn text_row(shape: &ShapeFile, columns: &[Column], i: usize, row: &mut Vec<u8>) {
    let start = row.len();
    for column in columns {
        for cell in &column.cells {
            if row.len() > start {
                row.push(b' ');
            }
            match *cell {
                WrittenCell::Axis(axis) => match shape.precision {
                    CoordinatePrecision::F32 => push_f32(row, shape.points[i][axis] as f32),
                    CoordinatePrecision::F64 => push_f64(row, shape.points[i][axis]),
                },
                WrittenCell::Packed(place) => {
                    let bits = pack_color(&shape.vertex_fields[place], i);
                    if column.value_type == ValueType::F32 {
                        push_f32(row, f32::from_bits(bits));
                    } else {
                        row.extend_from_slice(bits.to_string().as_bytes());
                    }
                }
                WrittenCell::Channel(place, channel) => {
                    let field = &shape.vertex_fields[place];
                    field.values.write_text(i * field.n_channels + channel, row);
                }
                WrittenCell::Padding => row.push(b'0'),
            }
        }
    }
    row.push(b'\n');
}
