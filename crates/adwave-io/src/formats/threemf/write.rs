//! 3MF writer: objects of triangles, with colors of their vertices or of their faces.

use std::io::Write;

use adwave::Progress;
use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

use crate::formats::threemf::UNITS;
use crate::model::f32_limits::triangles_with_faces;
use crate::model::instances::{ObjectRange, object_ranges};
use crate::progress::report_row;
use crate::text::push_f64;
use crate::{Field, FieldValues, ShapeFile, WriteError, WriteReport};

const TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
    <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
    <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
const RELATIONS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
    <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

/// Field with colors in bytes.
fn color(fields: &[Field]) -> Option<(&Field, &[u8])> {
    fields.iter().find_map(|field| match &field.values {
        FieldValues::U8(values) if field.name == "color" && matches!(field.n_channels, 3 | 4) => {
            Some((field, values.as_slice()))
        }
        _ => None,
    })
}

/// Writes the shape.
pub(crate) fn write_3mf(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let is_whole = shape.faces.iter().all(|f| f.len() == 3);
    let of_vertices = color(&shape.vertex_fields).filter(|_| !shape.faces.is_empty());
    let of_faces = color(&shape.face_fields).filter(|_| of_vertices.is_none() && is_whole);
    report.report_vertex_fields(shape, of_vertices.map(|_| "color").as_slice());
    let (objects, has_objects) = object_ranges(shape);
    let held = [of_faces.map(|_| "color"), has_objects.then_some("object")];
    report.report_face_fields(shape, &held.into_iter().flatten().collect::<Vec<_>>());
    if !shape.edges.pairs.is_empty() {
        report.report_dropped("edges");
    }
    if of_vertices.is_some() {
        let mut is_used = vec![false; shape.n_vertices];
        shape.faces.corners().iter().for_each(|&v| is_used[v as usize] = true);
        if !is_used.iter().all(|&used| used) {
            // They are written anyway, for readers of palettes.
            report.report_dropped("colors of vertices without a face");
            report.report_dropped("vertex field `color`");
        }
    }
    let mut zip = ZipWriter::new_stream(out);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(3))
        .last_modified_time(zip::DateTime::default());
    let failed = |e: zip::result::ZipError| match e {
        zip::result::ZipError::Io(e) => WriteError::from(e),
        other => WriteError::Io(std::io::Error::other(other)),
    };
    for (name, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        zip.start_file(name, options).map_err(failed)?;
        zip.write_all(text.as_bytes())?;
    }
    zip.start_file("3D/3dmodel.model", options.large_file(true)).map_err(failed)?;
    let content = Content { shape, objects, of_vertices, of_faces };
    model(&content, report, &mut zip, progress)?;
    zip.finish().map_err(failed)?;
    Ok(())
}

type Colors<'a> = Option<(&'a Field, &'a [u8])>;

/// Everything that is written into the model.
struct Content<'a> {
    shape: &'a ShapeFile,
    objects: Vec<ObjectRange>,
    of_vertices: Colors<'a>,
    of_faces: Colors<'a>,
}

fn model(
    content: &Content<'_>,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let Content { shape, of_vertices, of_faces, .. } = *content;
    let unit = shape.unit.as_ref().unwrap_or(&UNITS[0]);
    write!(
        out,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"{unit}\" xml:lang=\"en-US\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
         xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\">\n<resources>\n",
    )?;
    let mut text = Vec::new();
    if let Some((field, values)) = of_vertices.or(of_faces) {
        out.write_all(b"<m:colorgroup id=\"2\">\n")?;
        for (row, color) in values.chunks_exact(field.n_channels).enumerate() {
            report_row(progress, row as u64, field.len() as u64)?;
            text.clear();
            text.extend_from_slice(b"<m:color color=\"#");
            for byte in color {
                write!(text, "{byte:02X}")?;
            }
            text.extend_from_slice(b"\"/>\n");
            out.write_all(&text)?;
        }
        out.write_all(b"</m:colorgroup>\n")?;
    }
    let triangles = triangles_with_faces(shape, report);
    // Number 2 is the group of colors.
    let id = |k: usize| if k == 0 { 1 } else { k + 2 };
    for (k, object) in content.objects.iter().enumerate() {
        write!(out, "<object id=\"{}\" type=\"model\">\n<mesh>\n<vertices>\n", id(k))?;
        for i in object.vertices.clone() {
            report_row(progress, i as u64, shape.points.len() as u64)?;
            text.clear();
            text.extend_from_slice(b"<vertex");
            for (name, &x) in ["x", "y", "z"].iter().zip(&shape.points[i]) {
                write!(text, " {name}=\"")?;
                push_f64(&mut text, x);
                text.push(b'"');
            }
            text.extend_from_slice(b"/>\n");
            out.write_all(&text)?;
        }
        out.write_all(b"</vertices>\n<triangles>\n")?;
        let at = |f: usize| triangles.partition_point(|(face, _)| *face < f);
        for (row, &(f, corners)) in triangles[at(object.faces.start)..at(object.faces.end)].iter().enumerate()
        {
            report_row(progress, row as u64, triangles.len() as u64)?;
            text.clear();
            let [a, b, c] = corners.map(|v| v as usize - object.vertices.start);
            write!(text, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"")?;
            if of_vertices.is_some() {
                let [a, b, c] = corners;
                write!(text, " pid=\"2\" p1=\"{a}\" p2=\"{b}\" p3=\"{c}\"")?;
            } else if of_faces.is_some() {
                write!(text, " pid=\"2\" p1=\"{f}\"")?;
            }
            text.extend_from_slice(b"/>\n");
            out.write_all(&text)?;
        }
        out.write_all(b"</triangles>\n</mesh>\n</object>\n")?;
    }
    out.write_all(b"</resources>\n<build>\n")?;
    for k in 0..content.objects.len() {
        writeln!(out, "<item objectid=\"{}\"/>", id(k))?;
    }
    out.write_all(b"</build>\n</model>\n")?;
    Ok(())
}
