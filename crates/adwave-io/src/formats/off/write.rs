//! Writer of the object file format: OFF, and with attributes `[ST][C][N]OFF`.

use std::io::Write;

use adwave::Progress;

use crate::progress::at_row;
use crate::text::push_f64;
use crate::{Field, ShapeFile, WriteError, WriteReport};

fn push_fields(line: &mut Vec<u8>, fields: &[&Field], i: usize) {
    for field in fields {
        for c in 0..field.n_channels {
            line.push(b' ');
            push_f64(line, field.get(i, c));
        }
    }
}

/// Writes points with normal, color and texture coordinate, and faces with color.
pub(crate) fn write_off(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let channels = |name: &str, n: &[usize]| shape.field(name).filter(|f| n.contains(&f.n_channels));
    let (normal, color, texcoord) =
        (channels("normal", &[3]), channels("color", &[3, 4]), channels("texcoord", &[2]));
    let held: Vec<&Field> = [normal, color, texcoord].into_iter().flatten().collect();
    report.leave_vertex_fields(shape, &held.iter().map(|f| f.name.as_str()).collect::<Vec<_>>());
    let face_color = shape.face_fields.iter().find(|f| f.name == "color" && matches!(f.n_channels, 3 | 4));
    let face_held: Vec<&Field> = face_color.into_iter().collect();
    report.leave_face_fields(shape, &face_held.iter().map(|f| f.name.as_str()).collect::<Vec<_>>());
    if !shape.edges.pairs.is_empty() {
        report.leave_out("edges");
    }
    let letter = |field: Option<&Field>, letters| if field.is_some() { letters } else { "" };
    writeln!(out, "{}{}{}OFF", letter(texcoord, "ST"), letter(color, "C"), letter(normal, "N"))?;
    writeln!(out, "{} {} 0", shape.points.len(), shape.faces.len())?;
    let mut line = Vec::new();
    for (i, point) in shape.points.iter().enumerate() {
        at_row(progress, i as u64, shape.points.len() as u64)?;
        line.clear();
        for (axis, &x) in point.iter().enumerate() {
            if axis > 0 {
                line.push(b' ');
            }
            push_f64(&mut line, x);
        }
        push_fields(&mut line, &held, i);
        line.push(b'\n');
        out.write_all(&line)?;
    }
    for (f, face) in shape.faces.iter().enumerate() {
        at_row(progress, f as u64, shape.faces.len() as u64)?;
        line.clear();
        write!(line, "{}", face.len())?;
        for v in face {
            write!(line, " {v}")?;
        }
        push_fields(&mut line, &face_held, f);
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}
