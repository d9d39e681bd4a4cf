//! Stereolithography writer, binary or text.

use std::io::Write;

use adwave::Progress;

use crate::formats::stl::read::StlSource;
use crate::model::f32_limits::{is_single, triangles_with_faces};
use crate::progress::report_row;
use crate::text::push_f64;
use crate::{CoordinatePrecision, Field, FieldValues, Format, ShapeFile, WriteError, WriteReport};

/// Writes the faces as triangles; polygons are split.
pub(crate) fn write_stl(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    // An STL without triangles comes from an STL without triangles; a cloud would vanish.
    if shape.faces.is_empty() && !shape.points.is_empty() {
        return Err(WriteError::CannotHold { format, what: "points without faces".into() });
    }
    report.report_vertex_fields(shape, &[]);
    let original = shape.source::<StlSource>();
    let normal = shape.face_fields.iter().find(|f| f.name == "normal" && f.n_channels == 3);
    let normals = TriangleNormals { shape, normal, original };
    let attribute = shape.face_fields.iter().find_map(|f| match &f.values {
        FieldValues::U16(values) if f.name == "attribute" && format == Format::STL => Some(values),
        _ => None,
    });
    let solids = solids(shape).filter(|_| format == Format::STL_ASCII);
    let held = [Some("normal"), attribute.map(|_| "attribute"), solids.as_ref().map(|_| "solid")];
    report.report_face_fields(shape, &held.into_iter().flatten().collect::<Vec<_>>());
    let triangles = triangles_with_faces(shape, report);
    if format == Format::STL_ASCII {
        return write_ascii(&normals, &triangles, solids.as_deref(), out, progress);
    }
    let coordinates = shape.points.as_flattened();
    if shape.precision == CoordinatePrecision::F64
        && !is_single(coordinates.len(), progress, |i| coordinates[i])?
    {
        report.report_dropped("digits of coordinates beyond 32-bit floats");
    }
    let n = u32::try_from(triangles.len());
    let n = n.map_err(|_| WriteError::CannotHold { format, what: "2^32 triangles".into() })?;
    // A header that begins like a text would mislead other readers.
    let header = original.map(|original| original.header.as_slice()).filter(|h| !h.starts_with(b"solid"));
    let mut head = header.unwrap_or(b"").to_vec();
    head.resize(80, 0);
    out.write_all(&head)?;
    out.write_all(&n.to_le_bytes())?;
    for (row, &(f, corners)) in triangles.iter().enumerate() {
        report_row(progress, row as u64, triangles.len() as u64)?;
        let mut record = [0; 50];
        let normal = normals.normal(f, corners);
        let xyz = normal.into_iter().chain(corners.into_iter().flat_map(|v| shape.points[v as usize]));
        for (slot, x) in record.chunks_exact_mut(4).zip(xyz) {
            slot.copy_from_slice(&(x as f32).to_le_bytes());
        }
        record[48..].copy_from_slice(&attribute.map_or(0, |a| a[f]).to_le_bytes());
        out.write_all(&record)?;
    }
    Ok(())
}

/// Normals of the triangles.
struct TriangleNormals<'a> {
    shape: &'a ShapeFile,
    normal: Option<&'a Field>,
    original: Option<&'a StlSource>,
}

impl TriangleNormals<'_> {
    /// Normal of the file if no corner of the triangle moved, else the normal of the corners.
    fn normal(&self, f: usize, corners: [u32; 3]) -> [f64; 3] {
        let points = corners.map(|v| self.shape.points[v as usize]);
        let stayed = |v: u32, p: [f64; 3]| {
            let old = self.original.and_then(|original| original.points.get(v as usize));
            old.is_some_and(|old| old.map(f64::to_bits) == p.map(f64::to_bits))
        };
        if let Some(normal) = self.normal
            && (!self.shape.moved || corners.into_iter().zip(points).all(|(v, p)| stayed(v, p)))
        {
            return [0, 1, 2].map(|c| normal.get(f, c));
        }
        let [a, b, c] = points;
        let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = cross[0].hypot(cross[1]).hypot(cross[2]);
        // Zero stands for "not given" in an STL.
        if length > 0.0 && length.is_finite() { cross.map(|x| x / length) } else { [0.0; 3] }
    }
}

/// Solid of each face, if they are consecutive and numbered from 0 without gaps, as a file can represent them.
fn solids(shape: &ShapeFile) -> Option<Vec<u32>> {
    let field = shape.face_fields.iter().find(|f| f.name == "solid" && f.n_channels == 1)?;
    let is_whole = field.values.value_type().is_integer() && shape.faces.iter().all(|f| f.len() >= 3);
    let numbers: Vec<u32> = (0..field.len()).map(|f| field.get(f, 0) as u32).collect();
    let mut next = 0;
    let in_order = (0..numbers.len()).all(|f| {
        let is_next = field.get(f, 0) == f64::from(next);
        next += u32::from(is_next);
        is_next || (next > 0 && field.get(f, 0) == f64::from(next - 1))
    });
    // A single solid is read without a field.
    (is_whole && in_order && next > 1).then_some(numbers)
}

fn write_ascii(
    normals: &TriangleNormals<'_>,
    triangles: &[(usize, [u32; 3])],
    solids: Option<&[u32]>,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let name = |solid: u32| {
        let own = normals.original.and_then(|original| original.solids.get(solid as usize));
        own.map_or(&b"solid"[..], Vec::as_slice)
    };
    let mut solid = 0;
    let mut text = name(solid).to_vec();
    text.push(b'\n');
    let push = |text: &mut Vec<u8>, keyword: &str, xyz: [f64; 3]| {
        text.extend_from_slice(keyword.as_bytes());
        for x in xyz {
            text.push(b' ');
            push_f64(text, x);
        }
        text.push(b'\n');
    };
    let end = |text: &mut Vec<u8>, solid: u32| {
        text.extend_from_slice(b"end");
        text.extend_from_slice(name(solid));
        text.push(b'\n');
    };
    for (row, &(f, corners)) in triangles.iter().enumerate() {
        report_row(progress, row as u64, triangles.len() as u64)?;
        if let Some(next) = solids.map(|solids| solids[f]).filter(|&next| next != solid) {
            end(&mut text, solid);
            text.extend_from_slice(name(next));
            text.push(b'\n');
            solid = next;
        }
        push(&mut text, "facet normal", normals.normal(f, corners));
        text.extend_from_slice(b"outer loop\n");
        for v in corners {
            push(&mut text, "vertex", normals.shape.points[v as usize]);
        }
        text.extend_from_slice(b"endloop\nendfacet\n");
        out.write_all(&text)?;
        text.clear();
    }
    end(&mut text, solid);
    Ok(out.write_all(&text)?)
}
