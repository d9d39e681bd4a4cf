//! Stereolithography, binary or text.

use std::io::Write;

use adwave::{Cancelled, Progress};

use crate::original::Original;
use crate::progress::{all, at_row};
use crate::text::push_f64;
use crate::{Field, FieldValues, Format, Precision, ShapeFile, WriteError, WriteReport};

/// Writes the faces as triangles, polygons split into fans.
pub(crate) fn write_stl(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    // An STL of no triangles comes from an STL of none; a cloud would vanish.
    if shape.faces.is_empty() && !shape.points.is_empty() {
        return Err(WriteError::CannotHold { format, what: "points without faces".into() });
    }
    report.leave_vertex_fields(shape, &[]);
    let normal = shape.face_fields.iter().find(|f| f.name == "normal" && f.n_channels == 3 && !shape.moved);
    let attribute = shape.face_fields.iter().find_map(|f| match &f.values {
        FieldValues::U16(values) if f.name == "attribute" && format == Format::Stl => Some(values),
        _ => None,
    });
    let held: &[&str] = if attribute.is_some() { &["normal", "attribute"] } else { &["normal"] };
    report.leave_face_fields(shape, held);
    let mut triangles = Vec::new();
    for (f, face) in shape.faces.iter().enumerate() {
        at_row(progress, f as u64, shape.faces.len() as u64)?;
        if face.len() < 3 {
            report.leave_out("faces of fewer than three corners");
        } else if face.len() > 3 {
            report.leave_out("polygons (as triangles)");
        }
        for w in face.windows(2).skip(1) {
            triangles.push((f, [face[0], w[0], w[1]]));
        }
    }
    let header = match shape.original.as_deref() {
        Some(Original::StlHeader(header)) => header.clone(),
        _ => Vec::new(),
    };
    if format == Format::StlAscii {
        return write_ascii(shape, &triangles, normal, &header, out, progress);
    }
    if shape.precision == Precision::F64 && !is_single(shape, progress)? {
        report.leave_out("digits of coordinates beyond 32-bit floats");
    }
    let n = u32::try_from(triangles.len());
    let n = n.map_err(|_| WriteError::CannotHold { format, what: "2^32 triangles".into() })?;
    let mut head = if header.starts_with(b"solid") { Vec::new() } else { header };
    head.resize(80, 0);
    out.write_all(&head)?;
    out.write_all(&n.to_le_bytes())?;
    for (row, &(f, corners)) in triangles.iter().enumerate() {
        at_row(progress, row as u64, triangles.len() as u64)?;
        let mut record = [0; 50];
        let normal = normal_of(shape, normal, f, corners);
        let xyz = normal.into_iter().chain(corners.into_iter().flat_map(|v| shape.points[v as usize]));
        for (slot, x) in record.chunks_exact_mut(4).zip(xyz) {
            slot.copy_from_slice(&(x as f32).to_le_bytes());
        }
        record[48..].copy_from_slice(&attribute.map_or(0, |a| a[f]).to_le_bytes());
        out.write_all(&record)?;
    }
    Ok(())
}

fn is_single(shape: &ShapeFile, progress: Progress<'_>) -> Result<bool, Cancelled> {
    let is_single = |x: f64| f64::from(x as f32).to_bits() == x.to_bits() || x.is_nan();
    all(shape.points.len(), progress, |i| shape.points[i].into_iter().all(is_single))
}

/// The file's normal while the points are the file's, else the one of the corners.
fn normal_of(shape: &ShapeFile, normal: Option<&Field>, f: usize, corners: [u32; 3]) -> [f64; 3] {
    if let Some(normal) = normal {
        return [0, 1, 2].map(|c| normal.get(f, c));
    }
    let [a, b, c] = corners.map(|v| shape.points[v as usize]);
    let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = cross[0].hypot(cross[1]).hypot(cross[2]);
    // Zero stands for "not given" in an STL.
    if length > 0.0 && length.is_finite() { cross.map(|x| x / length) } else { [0.0; 3] }
}

fn write_ascii(
    shape: &ShapeFile,
    triangles: &[(usize, [u32; 3])],
    normal: Option<&Field>,
    header: &[u8],
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let name = if header.starts_with(b"solid") { header } else { b"solid" };
    let mut text = name.to_vec();
    text.push(b'\n');
    let push = |text: &mut Vec<u8>, keyword: &str, xyz: [f64; 3]| {
        text.extend_from_slice(keyword.as_bytes());
        for x in xyz {
            text.push(b' ');
            push_f64(text, x);
        }
        text.push(b'\n');
    };
    for (row, &(f, corners)) in triangles.iter().enumerate() {
        at_row(progress, row as u64, triangles.len() as u64)?;
        push(&mut text, "facet normal", normal_of(shape, normal, f, corners));
        text.extend_from_slice(b"outer loop\n");
        for v in corners {
            push(&mut text, "vertex", shape.points[v as usize]);
        }
        text.extend_from_slice(b"endloop\nendfacet\n");
        out.write_all(&text)?;
        text.clear();
    }
    text.extend_from_slice(b"end");
    text.extend_from_slice(name);
    text.push(b'\n');
    Ok(out.write_all(&text)?)
}
