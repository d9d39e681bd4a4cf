//! AMF writer: objects of one volume each, with colors of their vertices and triangles.

use std::io::Write;

use adwave::Progress;

use crate::formats::amf::UNITS;
use crate::model::f32_limits::triangles_with_faces;
use crate::model::instances::object_ranges;
use crate::progress::report_row;
use crate::text::{escape_xml, push_f64};
use crate::{Field, FieldValues, LengthUnit, ShapeFile, WriteError, WriteReport};

fn color(fields: &[Field]) -> Option<&Field> {
    fields.iter().find(|f| f.name == "color" && matches!(f.n_channels, 3 | 4))
}

/// Writes a color as numbers from 0 to 1; a color that is not finite is omitted.
fn push_color(field: Option<&Field>, i: usize, out: &mut Vec<u8>) {
    let Some(field) = field else { return };
    let scale = if matches!(field.values, FieldValues::U8(_)) { 255.0 } else { 1.0 };
    let values = (0..field.n_channels).map(|c| field.get(i, c) / scale);
    if values.clone().take(3).any(f64::is_nan) {
        return;
    }
    out.extend_from_slice(b"<color>");
    for (name, x) in ['r', 'g', 'b', 'a'].into_iter().zip(values).filter(|(_, x)| !x.is_nan()) {
        push_element(out, name, |out| push_f64(out, x));
    }
    out.extend_from_slice(b"</color>");
}

fn push_element(out: &mut Vec<u8>, name: char, content: impl FnOnce(&mut Vec<u8>)) {
    out.extend([b'<', name as u8, b'>']);
    content(out);
    out.extend([b'<', b'/', name as u8, b'>']);
}

/// Writes the shape.
pub(crate) fn write_amf(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let is_whole = shape.faces.iter().all(|f| f.len() == 3);
    let of_vertices = color(&shape.vertex_fields);
    let of_faces = color(&shape.face_fields).filter(|_| is_whole);
    report.report_vertex_fields(shape, of_vertices.map(|_| "color").as_slice());
    let (objects, has_objects) = object_ranges(shape);
    let held = [of_faces.map(|_| "color"), has_objects.then_some("object")];
    report.report_face_fields(shape, &held.into_iter().flatten().collect::<Vec<_>>());
    if !shape.edges.pairs.is_empty() {
        report.report_dropped("edges");
    }
    let unit = match shape.unit.as_ref() {
        Some(unit) if *unit == LengthUnit::FOOT => "feet".into(),
        unit => escape_xml(unit.unwrap_or(&UNITS[0]).name()),
    };
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<amf unit=\"{unit}\" version=\"1.1\">")?;
    let triangles = triangles_with_faces(shape, report);
    let mut text = Vec::new();
    for (k, object) in objects.iter().enumerate() {
        write!(out, "<object id=\"{}\">\n<mesh>\n<vertices>\n", k + 1)?;
        for i in object.vertices.clone() {
            report_row(progress, i as u64, shape.points.len() as u64)?;
            text.clear();
            text.extend_from_slice(b"<vertex><coordinates>");
            for (name, x) in ['x', 'y', 'z'].into_iter().zip(shape.points[i]) {
                push_element(&mut text, name, |out| push_f64(out, x));
            }
            text.extend_from_slice(b"</coordinates>");
            push_color(of_vertices, i, &mut text);
            text.extend_from_slice(b"</vertex>\n");
            out.write_all(&text)?;
        }
        out.write_all(b"</vertices>\n<volume>\n")?;
        let at = |f: usize| triangles.partition_point(|(face, _)| *face < f);
        for (row, &(f, corners)) in triangles[at(object.faces.start)..at(object.faces.end)].iter().enumerate()
        {
            report_row(progress, row as u64, triangles.len() as u64)?;
            text.clear();
            text.extend_from_slice(b"<triangle>");
            push_color(of_faces, f, &mut text);
            let [a, b, c] = corners.map(|v| v as usize - object.vertices.start);
            writeln!(text, "<v1>{a}</v1><v2>{b}</v2><v3>{c}</v3></triangle>")?;
            out.write_all(&text)?;
        }
        out.write_all(b"</volume>\n</mesh>\n</object>\n")?;
    }
    out.write_all(b"</amf>\n")?;
    Ok(())
}
