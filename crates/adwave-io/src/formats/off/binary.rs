//! Binary OFF: `OFF BINARY`, then 32-bit numbers, big-endian as in Geomview or little-endian as CGAL writes them.

use crate::formats::off::OffSource;
use crate::model::binary_rows::CoordinateRows;
use std::io::Write;

use adwave::Progress;
use adwave::shape::Polygons;

use crate::bytes::cursor::Cursor;
use crate::formats::off::read::{OffLayout, divide};
use crate::model::binary_rows::{BinaryRows, Run};
use crate::model::field::{ByteOrder, Number};
use crate::progress::{all, collect, report_row};
use crate::{
    CoordinatePrecision, Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile, WriteError,
    WriteReport,
};

/// Layout named by the first line, and the start of the numbers; `None` if the file is not a binary OFF.
pub(crate) fn head(bytes: &[u8]) -> Option<(OffLayout, usize)> {
    let end = memchr::memchr(b'\n', &bytes[..bytes.len().min(256)])?;
    let mut words = crate::text::words(&bytes[..end]);
    let (letters, rest) = crate::formats::off::split_keyword(words.next()?)?;
    let is_binary = rest.is_empty() && words.next() == Some(b"BINARY");
    (is_binary && !letters.contains(&b'n')).then(|| (OffLayout::from_letters(letters), end + 1))
}

/// Order of the bytes of the numbers, of which a vertex has `per_vertex`: the one whose counts fit the file, first that
/// of Geomview.
fn byte_order(numbers: &[u8], per_vertex: usize) -> ByteOrder {
    let fits = |order: ByteOrder| {
        let count = |k: usize| {
            let bytes = numbers.get(4 * k..4 * k + 4)?;
            u64::try_from(i32::from_bytes(bytes, order)).ok()
        };
        let (Some(n_vertices), Some(n_faces), Some(_)) = (count(0), count(1), count(2)) else { return false };
        // A face has a number of corners and one of colors at least.
        12 + 4 * per_vertex as u64 * n_vertices + 8 * n_faces <= numbers.len() as u64
    };
    if !fits(ByteOrder::Big) && fits(ByteOrder::Little) { ByteOrder::Little } else { ByteOrder::Big }
}

/// Reads a binary OFF.
pub(crate) fn read_off_binary(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let Some((layout, start)) = head(&bytes) else {
        return Err(ReadError::byte_error(0, "the head of a binary OFF is invalid; get the whole file"));
    };
    let order = byte_order(&bytes[start..], layout.n_numbers());
    let mut cursor = Cursor::new(&bytes, start, order);
    let mut count = |what: &str| {
        let place = cursor.position;
        let n = cursor.i32(what)?;
        u32::try_from(n)
            .map(u64::from)
            .map_err(|_| ReadError::byte_error(place, format!("{what} must not be negative")))
    };
    let (n_vertices, n_faces) = (count("the number of vertices")?, count("the number of faces")?);
    count("the number of edges")?;
    limits.check_points(n_vertices)?;
    let mut parts = vec![("", 3)];
    for (is_there, name, n) in [
        (layout.has_w, "w", 1),
        (layout.has_normal, "normal", 3),
        (layout.has_color, "color", 4),
        (layout.has_texcoord, "texcoord", 2),
    ] {
        if is_there {
            parts.push((name, n));
        }
    }
    let stride = 4 * parts.iter().map(|(_, n)| n).sum::<usize>();
    let first = cursor.position;
    let rows = cursor.rows(n_vertices, stride as u64, "vertex")?;
    let n = n_vertices as usize;
    let number = |at: usize| f32::from_bytes(&rows[at..], order);
    let point = |i: usize| [0, 4, 8].map(|at| f64::from(number(stride * i + at)));
    let mut shape = ShapeFile::from_cloud(collect(n, progress, point)?);
    shape.format = Some(Format::OFF_BINARY);
    shape.precision = CoordinatePrecision::F32;
    let mut offset = 12;
    for &(name, n_channels) in &parts[1..] {
        let value = |k: usize| number(stride * (k / n_channels) + offset + 4 * (k % n_channels));
        let values = FieldValues::F32(collect(n * n_channels, progress, value)?);
        shape.vertex_fields.push(Field::new(name, n_channels, values));
        offset += 4 * n_channels;
    }
    read_faces(&mut cursor, n_faces, order, &mut shape, progress)?;
    if divide(&mut shape) {
        // Divided coordinates have the precision of the file, or are written as text.
        let rounded: Vec<[f64; 3]> = shape.points.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
        if rounded.as_flattened().iter().all(|x| x.is_finite()) {
            shape.points = rounded.into();
            shape.precision = CoordinatePrecision::F32;
        } else {
            shape.format = Some(Format::OFF);
        }
    } else {
        let runs = vec![Run { start: first, n, stride }];
        let rows = BinaryRows { bytes, runs, is_double: false, n_axes: 3, order };
        shape.set_source(OffSource(CoordinateRows::Binary(rows)));
    }
    Ok(shape)
}

/// Reads faces: a count, the corners, the number of color components, and these.
fn read_faces(
    cursor: &mut Cursor<'_>,
    n: u64,
    order: ByteOrder,
    shape: &mut ShapeFile,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    crate::text::tokens::check_rows(cursor.bytes.len(), cursor.position, n, 8, "face", 0)?;
    let mut faces = Polygons::new();
    let (mut colors, mut ends) = (Vec::new(), Vec::with_capacity(n as usize));
    let mut face = Vec::new();
    for row in 0..n {
        report_row(progress, row, n)?;
        let n_corners: u32 = cursor.number("face", row)?;
        let start = cursor.position;
        let corners = cursor.rows(n_corners.into(), 4, "face")?;
        face.clear();
        for (k, bytes) in corners.chunks_exact(4).enumerate() {
            let index = i32::from_bytes(bytes, order);
            if index < 0 || index as usize >= shape.n_vertices {
                return Err(ReadError::FaceIndex {
                    place: format!("byte {}", start + 4 * k),
                    face: row,
                    index: index.into(),
                    n_vertices: shape.n_vertices as u64,
                });
            }
            face.push(index as u32);
        }
        faces.push(&face);
        let n_numbers: u32 = cursor.number("face", row)?;
        if n_numbers > 4 {
            let message = format!(
                "the color of face {row} must have at most 4 numbers, got {n_numbers}; get the \
                        file again"
            );
            return Err(ReadError::byte_error(cursor.position - 4, message));
        }
        let numbers = cursor.rows(n_numbers.into(), 4, "face")?;
        colors.extend(numbers.chunks_exact(4).map(|b| f32::from_bytes(b, order)));
        ends.push(colors.len());
    }
    shape.faces = faces.into();
    let mut sizes = ends.iter().scan(0, |start, &end| Some(end - std::mem::replace(start, end)));
    let longest = sizes.clone().max().unwrap_or(0);
    if longest > 0 && sizes.all(|size| size == longest) {
        let name = if longest == 1 { "color_index" } else { "color" };
        shape.face_fields.push(Field::new(name, longest, FieldValues::F32(colors)));
    } else if longest > 0 {
        shape.extras.push("colors of faces".into());
    }
    Ok(())
}

/// Fields of 32-bit floats, as they are in the file.
fn singles(fields: &[Field], name: &str, n_channels: &[usize]) -> Option<usize> {
    fields.iter().position(|f| {
        f.name == name && n_channels.contains(&f.n_channels) && matches!(f.values, FieldValues::F32(_))
    })
}

/// Writes points, and the 32-bit float fields that the format supports.
pub(crate) fn write_off_binary(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let held: Vec<&Field> = [("normal", 3), ("color", 4), ("texcoord", 2)]
        .into_iter()
        .filter_map(|(name, n)| Some(&shape.vertex_fields[singles(&shape.vertex_fields, name, &[n])?]))
        .collect();
    let names: Vec<&str> = held.iter().map(|f| f.name.as_str()).collect();
    report.report_vertex_fields(shape, &names);
    let of_faces = singles(&shape.face_fields, "color", &[3, 4]).map(|k| &shape.face_fields[k]);
    report.report_face_fields(shape, of_faces.map(|_| "color").as_slice());
    if !shape.edges.pairs.is_empty() {
        report.report_dropped("edges");
    }
    let is_single = |i: usize| shape.points[i].iter().all(|&x| f64::from(x as f32) == x || x.is_nan());
    if shape.precision == CoordinatePrecision::F64 && !all(shape.points.len(), progress, is_single)? {
        report.report_dropped("digits of coordinates beyond 32-bit floats");
    }
    let counts = [shape.points.len(), shape.faces.len()].map(i32::try_from);
    let [Ok(n_vertices), Ok(n_faces)] = counts else {
        let what = "2^31 vertices or faces".into();
        return Err(WriteError::CannotHold { format: Format::OFF_BINARY, what });
    };
    let letter = |name: &str, letters| if names.contains(&name) { letters } else { "" };
    let letters = [letter("texcoord", "ST"), letter("color", "C"), letter("normal", "N")].concat();
    writeln!(out, "{letters}OFF BINARY")?;
    for count in [n_vertices, n_faces, 0] {
        out.write_all(&count.to_be_bytes())?;
    }
    let mut row = Vec::new();
    for (i, point) in shape.points.iter().enumerate() {
        report_row(progress, i as u64, shape.points.len() as u64)?;
        row.clear();
        row.extend(point.iter().flat_map(|&x| (x as f32).to_be_bytes()));
        for field in &held {
            for c in 0..field.n_channels {
                field.values.write_bytes(i * field.n_channels + c, ByteOrder::Big, &mut row);
            }
        }
        out.write_all(&row)?;
    }
    for (f, face) in shape.faces.iter().enumerate() {
        report_row(progress, f as u64, shape.faces.len() as u64)?;
        row.clear();
        row.extend_from_slice(&(face.len() as u32).to_be_bytes());
        row.extend(face.iter().flat_map(|v| v.to_be_bytes()));
        let n_numbers = of_faces.map_or(0, |field| field.n_channels);
        row.extend_from_slice(&(n_numbers as u32).to_be_bytes());
        for c in 0..n_numbers {
            row.extend_from_slice(&(of_faces.map_or(0.0, |field| field.get(f, c)) as f32).to_be_bytes());
        }
        out.write_all(&row)?;
    }
    Ok(())
}
