//! PLY reader: text and both byte orders.
//!
//! The parser is our own: the crates store rows as maps from names to values, which takes many times the memory of
//! the file, and allocate the sizes stated in the header.

use crate::formats::ply::body::PlyBody;
use crate::formats::ply::fixed;
use crate::formats::ply::header::{Element, Encoding, PlyHeader, PlySource, PropertyKind, parse_header};
use crate::model::grouping::group;
use crate::model::source_document::CORNER_TEXCOORDS;
use crate::progress::{collect, report_row};
use crate::provenance::in_comments;
use crate::text::line_of;
use crate::{
    CoordinatePrecision, Direction, Edges, FieldValues, Format, ReadError, ReadLimits, ShapeFile, ValueType,
};
use adwave::Progress;
use std::sync::Arc;

/// Reads a PLY.
pub(crate) fn read_ply(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let header = parse_header(&bytes)?;
    let vertex = header.elements.iter().position(|e| e.name == "vertex");
    let n_vertices = vertex.map_or(0, |v| header.elements[v].n_rows);
    limits.check_points(n_vertices)?;
    let mut shape = ShapeFile::empty();
    shape.n_vertices = n_vertices as usize;
    shape.provenance = in_comments(&bytes, "comment adwave").map(Arc::new);
    shape.format = Some(if header.encoding == Encoding::Ascii { Format::PLY_ASCII } else { Format::PLY });
    let mut rows = (header.body, header.body);
    let mut field_properties = Vec::new();
    let mut body = PlyBody { bytes: &bytes, position: header.body, encoding: header.encoding, progress };
    for (e, element) in header.elements.iter().enumerate() {
        body.check_size(element)?;
        let start = body.position;
        match element.name.as_str() {
            _ if Some(e) == vertex => {
                field_properties = read_vertices(&mut body, element, &mut shape)?;
                rows = (start, body.position);
            }
            "face" => read_faces(&mut body, element, &mut shape)?,
            "tristrips" if !element.properties.is_empty() => read_strips(&mut body, element, &mut shape)?,
            "edge" if element.property("vertex1").is_some() && element.property("vertex2").is_some() => {
                read_edges(&mut body, element, &mut shape)?;
            }
            _ => {
                if element.min_row_bytes(header.encoding) > 0 {
                    for row in 0..element.n_rows {
                        report_row(progress, row, element.n_rows)?;
                        body.skip_row(element, row)?;
                    }
                }
                if element.n_rows > 0 {
                    shape.extras.push(format!("element `{}`", element.name));
                }
            }
        }
    }
    keep_fields_of_all_faces(&mut shape);
    name_comments(&bytes, &header, &mut shape);
    if let Some(vertex) = vertex {
        let original = PlySource { bytes, header, vertex, rows, field_properties };
        shape.set_source(original);
    }
    Ok(shape)
}

fn name_comments(bytes: &[u8], header: &PlyHeader, shape: &mut ShapeFile) {
    let is_comment = |&(start, end): &(usize, usize)| {
        bytes[start..end].starts_with(b"comment") || bytes[start..end].starts_with(b"obj_info")
    };
    if header.lines.iter().any(is_comment) {
        shape.extras.push("comments".into());
    }
}

/// Empty list for each scalar property, by its position; `None` for lists.
fn empty_columns(element: &Element) -> Vec<Option<FieldValues>> {
    let column = |kind| match kind {
        PropertyKind::Scalar(t) => Some(t.empty()),
        PropertyKind::List { .. } => None,
    };
    element.properties.iter().map(|p| column(p.kind)).collect()
}

/// Checks that vertices have coordinates; a file without vertices may omit them.
pub(crate) fn check_axes(element: &Element) -> Result<(), ReadError> {
    let is_number = |name: &&str| {
        element.property(name).is_some_and(|p| matches!(element.properties[p].kind, PropertyKind::Scalar(_)))
    };
    match ["x", "y", "z"].iter().find(|name| !is_number(name)) {
        Some(name) if element.n_rows > 0 => {
            let message = format!("element `vertex` needs the numbers x, y and z, but has no `{name}`");
            Err(ReadError::Line { line: element.line as u64 + 1, message })
        }
        _ => Ok(()),
    }
}

fn read_vertices(
    body: &mut PlyBody<'_>,
    element: &Element,
    shape: &mut ShapeFile,
) -> Result<Vec<(String, Vec<usize>)>, ReadError> {
    let mut columns = empty_columns(element);
    check_axes(element)?;
    if let Some(vertices) = fixed::read_vertices(body, element)? {
        shape.precision =
            if vertices.is_single { CoordinatePrecision::F32 } else { CoordinatePrecision::F64 };
        shape.points = vertices.points.into();
        let (fields, extras) = (&mut shape.vertex_fields, &mut shape.extras);
        return attach_columns(element, vertices.columns, fields, extras, body.progress);
    }
    for row in 0..element.n_rows {
        report_row(body.progress, row, element.n_rows)?;
        for (property, column) in element.properties.iter().zip(&mut columns) {
            match column {
                Some(column) => body.read_into(column, element, row)?,
                None => body.skip(property.kind, element, row)?,
            }
        }
    }
    let mut xyz = Vec::new();
    for name in ["x", "y", "z"] {
        let column = element.property(name).and_then(|p| columns[p].take());
        xyz.push(column.unwrap_or_else(|| ValueType::F32.empty()));
    }
    let single = xyz.iter().all(|c| c.value_type() == ValueType::F32);
    shape.precision = if single { CoordinatePrecision::F32 } else { CoordinatePrecision::F64 };
    shape.points =
        collect(shape.n_vertices, body.progress, |i| [xyz[0].get(i), xyz[1].get(i), xyz[2].get(i)])?.into();
    attach_columns(element, columns, &mut shape.vertex_fields, &mut shape.extras, body.progress)
}

/// Converts columns to fields; returns the properties that form each field.
fn attach_columns(
    element: &Element,
    columns: Vec<Option<FieldValues>>,
    fields: &mut Vec<crate::Field>,
    extras: &mut Vec<String>,
    progress: Progress<'_>,
) -> Result<Vec<(String, Vec<usize>)>, ReadError> {
    let mut positions = Vec::new();
    let mut named = Vec::new();
    for (p, (property, column)) in element.properties.iter().zip(columns).enumerate() {
        if let Some(column) = column {
            positions.push(p);
            named.push((property.name.clone(), column));
        } else if matches!(property.kind, PropertyKind::List { .. }) && !is_corner_list(&property.name) {
            extras.push(if texcoord_list(element) == Some(p) {
                CORNER_TEXCOORDS.to_owned()
            } else {
                format!("list `{}` of element `{}`", property.name, element.name)
            });
        }
    }
    let (made, mut members) = group(named, progress)?;
    *fields = made;
    for (_, columns) in &mut members {
        for column in columns {
            *column = positions[*column];
        }
    }
    Ok(members)
}

fn is_corner_list(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}

/// List of corners; a scalar property of that name does not count.
pub(crate) fn corner_list(element: &Element) -> Option<usize> {
    let is_list = |kind| matches!(kind, PropertyKind::List { .. });
    element.properties.iter().position(|p| is_corner_list(&p.name) && is_list(p.kind))
}

/// List of two texture coordinates for each corner of a face.
pub(crate) fn texcoord_list(element: &Element) -> Option<usize> {
    let is_list = |kind| matches!(kind, PropertyKind::List { item, .. } if !item.is_integer());
    (element.name == "face").then_some(())?;
    element.properties.iter().position(|p| p.name == "texcoord" && is_list(p.kind))
}

/// Drops the fields of one face element if the shape also has strips or a second list of faces.
fn keep_fields_of_all_faces(shape: &mut ShapeFile) {
    let n = shape.faces.len();
    let (kept, others): (Vec<_>, Vec<_>) =
        std::mem::take(&mut shape.face_fields).into_iter().partition(|field| field.len() == n);
    shape.face_fields = kept;
    shape.extras.extend(others.iter().map(|field| format!("field `{}` of some faces only", field.name)));
}

fn read_faces(body: &mut PlyBody<'_>, element: &Element, shape: &mut ShapeFile) -> Result<(), ReadError> {
    let mut columns = empty_columns(element);
    let corners = corner_list(element);
    if corners.is_none() && element.n_rows > 0 {
        let message = "element `face` has no list `vertex_indices`; its faces cannot be read".to_string();
        return Err(ReadError::Line { line: element.line as u64 + 1, message });
    }
    let mut first = 0;
    if let Some(corners) = corners
        && shape.faces.is_empty()
        && let Some(read) = fixed::read_faces(body, element, corners, shape.n_vertices)?
    {
        (shape.faces, columns, first) = (read.polygons.into(), read.columns, read.n_rows);
    }
    let mut face = Vec::new();
    for row in first..element.n_rows {
        report_row(body.progress, row, element.n_rows)?;
        let start = body.position;
        for (p, property) in element.properties.iter().enumerate() {
            match &mut columns[p] {
                Some(column) => body.read_into(column, element, row)?,
                None if Some(p) == corners => body.read_list(property.kind, element, row, &mut face)?,
                None => body.skip(property.kind, element, row)?,
            }
        }
        push_face(body, shape, &face, row, start)?;
    }
    let mut fields = Vec::new();
    attach_columns(element, columns, &mut fields, &mut shape.extras, body.progress)?;
    shape.face_fields.append(&mut fields);
    Ok(())
}

fn push_face(
    body: &PlyBody<'_>,
    shape: &mut ShapeFile,
    face: &[i64],
    row: u64,
    start: usize,
) -> Result<(), ReadError> {
    if let Some(&index) = face.iter().find(|&&v| v < 0 || v >= shape.n_vertices as i64) {
        return Err(ReadError::FaceIndex {
            place: place(body, start),
            face: row,
            index,
            n_vertices: shape.n_vertices as u64,
        });
    }
    if shape.faces.corners().len() + face.len() >= u32::MAX as usize {
        let found = (shape.faces.corners().len() + face.len()) as u64;
        return Err(ReadError::Limit { what: "corners of faces", found, limit: u32::MAX.into() });
    }
    let corners: Vec<u32> = face.iter().map(|&v| v as u32).collect();
    Arc::make_mut(&mut shape.faces).push(&corners);
    Ok(())
}

/// `line 12` or `byte 345`.
fn place(body: &PlyBody<'_>, start: usize) -> String {
    if body.encoding == Encoding::Ascii {
        let blanks = body.bytes[start..].iter().take_while(|b| b.is_ascii_whitespace()).count();
        format!("line {}", line_of(body.bytes, start + blanks))
    } else {
        format!("byte {start}")
    }
}

/// Triangles of a strip: each vertex after the second forms a triangle with the two before it, with alternating
/// orientation; −1 begins a new strip.
pub(crate) fn strip_triangles(
    strip: &[i64],
    mut each: impl FnMut([i64; 3]) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    for part in strip.split(|&v| v == -1) {
        for (i, w) in part.windows(3).enumerate() {
            each(if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })?;
        }
    }
    Ok(())
}

fn read_strips(body: &mut PlyBody<'_>, element: &Element, shape: &mut ShapeFile) -> Result<(), ReadError> {
    let list = corner_list(element);
    let mut strip = Vec::new();
    for row in 0..element.n_rows {
        report_row(body.progress, row, element.n_rows)?;
        let start = body.position;
        for (p, property) in element.properties.iter().enumerate() {
            if Some(p) != list {
                body.skip(property.kind, element, row)?;
                continue;
            }
            body.read_list(property.kind, element, row, &mut strip)?;
            strip_triangles(&strip, |triangle| push_face(body, shape, &triangle, row, start))?;
        }
    }
    if element.n_rows > 0 {
        shape.extras.push("triangle strips (as triangles)".into());
    }
    Ok(())
}

fn read_edges(body: &mut PlyBody<'_>, element: &Element, shape: &mut ShapeFile) -> Result<(), ReadError> {
    let ends = [element.property("vertex1"), element.property("vertex2")];
    for row in 0..element.n_rows {
        report_row(body.progress, row, element.n_rows)?;
        let start = body.position;
        let mut pair = [0_u32; 2];
        for (p, property) in element.properties.iter().enumerate() {
            let Some(end) = ends.iter().position(|&e| e == Some(p)) else {
                body.skip(property.kind, element, row)?;
                continue;
            };
            let PropertyKind::Scalar(t) = property.kind else {
                body.skip(property.kind, element, row)?;
                continue;
            };
            let index = body.read_integer(t, element, row)?;
            pair[end] =
                u32::try_from(index).ok().filter(|&v| (v as usize) < shape.n_vertices).ok_or_else(|| {
                    let n = shape.n_vertices;
                    ReadError::Whole(format!(
                        "{}: edge {row} names vertex {index}, but there are {n}; correct the edge",
                        place(body, start)
                    ))
                })?;
        }
        shape.edges.pairs.push(pair);
    }
    shape.edges =
        Edges { weights: Vec::new(), direction: Direction::Both, ..std::mem::take(&mut shape.edges) };
    if element.properties.len() > 2 && element.n_rows > 0 {
        shape.extras.push("properties of edges".into());
    }
    Ok(())
}
