//! Wavefront OBJ writer.

use std::borrow::Cow;
use std::collections::HashMap;
use std::io::Write;

use adwave::Progress;

use super::normals::{NewNormals, with_normals};
use crate::model::context::WriteContext;
use crate::model::source_document::Update;
use crate::model::text_rows::{RowEdit, TextRows};
use crate::progress::report_row;
use crate::text::push_f64;
use crate::{Field, FieldValues, ShapeFile, WriteError, WriteReport};

/// Writes the original with new coordinates, and with new colors if they were replaced.
pub(crate) fn update_obj(
    rows: &TextRows,
    shape: &ShapeFile,
    context: &mut WriteContext<'_>,
) -> Result<Update, WriteError> {
    // Points that have left the plane need a z each.
    if rows.columns[2] == usize::MAX && shape.points.iter().any(|p| p[2] != 0.0) {
        return Ok(Update::DoesNotFit);
    }
    let normals = new_normals(shape);
    let report = &mut context.report;
    for name in &shape.edited {
        match name.as_str() {
            "color" => {}
            "normal" if normals.is_some() => {}
            "normal" | "texcoord" => {
                report.report_dropped(format!("the new `{name}` (the original values are kept)"));
            }
            _ => report.report_dropped(format!("vertex field `{name}`")),
        }
    }
    let color = shape.field("color").filter(|f| shape.edited.contains(&f.name) && is_color(f));
    let append = |i: usize, buffer: &mut Vec<u8>| {
        if let Some(color) = color {
            push_color(color, i, buffer);
        }
    };
    // The color replaces any content after z.
    let dropped: &[usize] = if color.is_some() { &[3, 4, 5, 6, 7] } else { &[] };
    let edit = RowEdit { dropped, append: Some(&append) };
    let Some(list) = normals else {
        rows.write_all(shape, &edit, context.out, context.progress)?;
        return Ok(Update::Written);
    };
    let normals =
        if shape.faces.is_empty() { NewNormals::OfStatements(&list) } else { NewNormals::OfCorners(&list) };
    let mut text = Vec::with_capacity(rows.bytes.len());
    rows.write_all(shape, &edit, &mut text, context.progress)?;
    for part in with_normals(&text, &normals).chunks(crate::progress::BYTES_PER_STEP) {
        context.progress.step(0, 1)?;
        context.out.write_all(part)?;
    }
    Ok(Update::Written)
}

/// Normals that replace those of the text: one per corner of the faces, or per vertex of a cloud.
fn new_normals(shape: &ShapeFile) -> Option<Cow<'_, [[f64; 3]]>> {
    if let Some(normals) = &shape.corner_normals {
        return Some(Cow::Borrowed(normals));
    }
    let is_edited = shape.edited.iter().any(|name| name == "normal");
    let n_original = shape.n_original_fields;
    let is_own = shape.vertex_fields.iter().take(n_original).any(|field| field.name == "normal");
    let field = shape.field("normal").filter(|field| field.n_channels == 3 && is_edited && is_own)?;
    let values = field.to_f64();
    let of_vertex = values.as_chunks::<3>().0;
    Some(Cow::Owned(if shape.faces.is_empty() {
        of_vertex.to_vec()
    } else {
        shape.faces.corners().iter().map(|&v| of_vertex[v as usize]).collect()
    }))
}

fn is_color(field: &Field) -> bool {
    matches!(field.n_channels, 3 | 4)
}

/// Writes a color as numbers from 0 to 1.
fn push_color(color: &Field, i: usize, out: &mut Vec<u8>) {
    let scale = if matches!(color.values, FieldValues::U8(_)) { 255.0 } else { 1.0 };
    for c in 0..color.n_channels {
        out.push(b' ');
        push_f64(out, color.get(i, c) / scale);
    }
}

/// Writes a line of `keyword` and numbers.
fn push_line(out: &mut Vec<u8>, keyword: &str, numbers: impl Iterator<Item = f64>) {
    out.extend_from_slice(keyword.as_bytes());
    for x in numbers {
        out.push(b' ');
        push_f64(out, x);
    }
}

/// Different texture coordinates, and the number of those of each corner from 1; 0 where a corner has none.
fn number_texcoords(values: &[f64]) -> (Vec<[f64; 2]>, Vec<u64>) {
    let (mut list, mut known) = (Vec::new(), HashMap::new());
    let mut number = |uv: &[f64; 2]| {
        if !uv.iter().all(|x| x.is_finite()) {
            return 0;
        }
        *known.entry(uv.map(f64::to_bits)).or_insert_with(|| {
            list.push(*uv);
            list.len() as u64
        })
    };
    let numbers = values.as_chunks::<2>().0.iter().map(&mut number).collect();
    (list, numbers)
}

/// Writes points, colors, normals, texture coordinates, faces and edges.
pub(crate) fn write_obj(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let color = shape.field("color").filter(|f| is_color(f));
    let weight = shape.field("w").filter(|f| f.n_channels == 1 && color.is_none());
    let normal = shape.field("normal").filter(|f| f.n_channels == 3);
    let texcoord = shape.field("texcoord").filter(|f| matches!(f.n_channels, 2 | 3));
    let held: Vec<&str> =
        [color, weight, normal, texcoord].iter().flatten().map(|f| f.name.as_str()).collect();
    report.report_vertex_fields(shape, &held);
    report.report_face_fields(shape, &[]);
    if shape.points.is_empty() {
        // An empty file would not be recognized as an OBJ.
        writeln!(out, "# no vertices")?;
    }
    if shape.faces.iter().any(<[u32]>::is_empty) {
        report.report_dropped("faces without corners");
    }
    let mut line = Vec::new();
    for (i, point) in shape.points.iter().enumerate() {
        report_row(progress, i as u64, shape.points.len() as u64)?;
        line.clear();
        push_line(&mut line, "v", point.iter().copied().chain(weight.map(|w| w.get(i, 0))));
        if let Some(color) = color {
            push_color(color, i, &mut line);
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    let of_corners = shape.corner_texcoords().map(|values| number_texcoords(&values));
    for [u, v] in of_corners.iter().flat_map(|(list, _)| list) {
        line.clear();
        push_line(&mut line, "vt", [*u, *v].into_iter());
        line.push(b'\n');
        out.write_all(&line)?;
    }
    for (keyword, field) in [("vt", texcoord), ("vn", normal)] {
        let Some(field) = field else { continue };
        for i in 0..field.len() {
            line.clear();
            push_line(&mut line, keyword, (0..field.n_channels).map(|c| field.get(i, c)));
            line.push(b'\n');
            out.write_all(&line)?;
        }
    }
    for (f, face) in shape.faces.iter().enumerate().filter(|(_, face)| !face.is_empty()) {
        report_row(progress, f as u64, shape.faces.len() as u64)?;
        line.clear();
        line.push(b'f');
        let first = shape.faces.end(f) - face.len();
        for (k, &v) in face.iter().enumerate() {
            let v = u64::from(v) + 1;
            let of_corner = of_corners.as_ref().map(|(_, numbers)| numbers[first + k]).filter(|&t| t > 0);
            match (of_corner.or(texcoord.map(|_| v)), normal) {
                (None, None) => write!(line, " {v}")?,
                (Some(t), None) => write!(line, " {v}/{t}")?,
                (None, Some(_)) => write!(line, " {v}//{v}")?,
                (Some(t), Some(_)) => write!(line, " {v}/{t}/{v}")?,
            }
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    for [a, b] in &shape.edges.pairs {
        writeln!(out, "l {} {}", u64::from(*a) + 1, u64::from(*b) + 1)?;
    }
    if !shape.edges.weights.is_empty() {
        report.report_dropped("weights of edges");
    }
    Ok(())
}
